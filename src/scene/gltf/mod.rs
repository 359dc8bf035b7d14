//! glTF 2.0, read by ourselves from the JSON: every count, offset, index and reference is checked against what is really
//! in the file before it is used, so malformed input ends in one line that names the place, never in a panic, and a
//! lying header allocates nothing.

mod accessor;
mod animation;
mod assemble;
mod basis;
mod container;
mod deform;
mod draco;
mod extensions;
mod gloss;
mod images;
mod json;
mod lights;
mod materials;
mod meshes;
mod meshopt;
mod nodes;
mod scattering;

use std::path::Path;

use glam::{DAffine3, DVec3};
use rayon::prelude::*;

use super::LoadOptions;
use super::bake::{self, LocalPrimitive, Tally};
use super::error::Fault;
use super::{Scene, SceneError};
use accessor::{Accessor, Budget};
use assemble::Wardrobe;
use deform::Deformer;
use json::At;
use lights::Placement;
use meshes::{Geometry, MeshSource};
use nodes::Node;

/// What reading may allocate besides 16 times the bytes of the file and its buffers.
const READ_FLOOR: u64 = 256 << 20;
/// The same for the flattened scene, in which a mesh stands once for each node that uses it.
const FLAT_FLOOR: u64 = 1 << 30;
/// Bytes of a baked vertex, and of a triangle while it is checked.
const VERTEX_BYTES: usize = 84;
const TRIANGLE_BYTES: usize = 24;

/// Reads a file; `mm_per_unit`, which is the one of `options`, is positive and finite.
pub(super) fn load(path: &Path, mm_per_unit: f64, options: &LoadOptions) -> Result<Scene, SceneError> {
    let file = path.display().to_string();
    let bytes = std::fs::read(path).map_err(|reason| SceneError::Read { file: file.clone(), reason })?;
    let name = path.file_stem().map(|stem| stem.to_string_lossy().into_owned());
    let folder = path.parent().unwrap_or(Path::new(""));
    let settings = Settings { folder, mm_per_unit, options };
    named(read(&bytes, &settings), name.unwrap_or_default(), &file)
}

/// Reads the bytes of a file that names no other; errors call it by `name`.
pub(super) fn load_bytes(
    bytes: &[u8],
    name: &str,
    mm_per_unit: f64,
    options: &LoadOptions,
) -> Result<Scene, SceneError> {
    let settings = Settings { folder: Path::new(""), mm_per_unit, options };
    named(read(bytes, &settings), name.to_owned(), name)
}

fn named(read: Result<Scene, Fault>, name: String, file: &str) -> Result<Scene, SceneError> {
    match read {
        Ok(scene) => Ok(Scene { name, ..scene }),
        Err(fault) => Err(fault.in_file(file)),
    }
}

struct Settings<'a> {
    /// Where relative URIs start.
    folder: &'a Path,
    mm_per_unit: f64,
    options: &'a LoadOptions,
}

fn read(bytes: &[u8], settings: &Settings) -> Result<Scene, Fault> {
    let (json, bin) = container::split(bytes)?;
    let json: serde_json::Value = serde_json::from_slice(json)
        .map_err(|e| Fault::new("JSON", format!("neither GLB nor well-formed JSON: {e}")))?;
    let root = At::root(&json)?;
    extensions::check_version(&root)?;
    let mut warnings = extensions::check_extensions(&root)?;

    let buffers = container::read_buffers(&root, bin, settings.folder)?;
    let input = bytes.len() as u64 + buffers.iter().map(|b| b.len() as u64).sum::<u64>();
    let mut budget = Budget::new(input.saturating_mul(16) + READ_FLOOR);
    let unpacked = meshopt::unpack(&root, &buffers, &mut budget)?;
    let views = accessor::read_views(&root, &buffers, &unpacked)?;
    let filled = draco::unpack(&root, &views, &mut budget)?;
    let accessors = accessor::read_accessors(&root, &views, &filled)?;
    let textures = images::read_textures(&root)?;
    let materials = materials::read_materials(&root, textures.len(), settings.mm_per_unit)?;
    let meshes = meshes::read_meshes(&root, &accessors, materials.len())?;
    let lights = lights::read_lights(&root)?;
    let cameras = lights::read_cameras(&root)?;
    let skins = deform::count_skins(&root)?;
    let counts = nodes::Counts { meshes: meshes.len(), cameras: cameras.len(), lights: lights.len(), skins };
    let mut nodes = nodes::read_nodes(&root, &counts)?;
    let skins = deform::read_skins(&root, nodes.len(), &accessors)?;
    if let Some(pose) = settings.options.pose {
        let targets: Vec<_> = meshes.iter().map(MeshSource::target_count).collect();
        animation::pose(&root, &accessors, pose.animation, pose.time, &mut nodes, &targets)?;
    }
    let (roots, note) = nodes::choose_scene(&root, &nodes)?;
    warnings.extend(note);
    let placed = nodes::walk(&nodes, &roots);

    let drawn = drawn_meshes(&meshes, &nodes, &placed);
    warnings.extend(passed_over(&meshes, &nodes, &placed, &drawn));
    let worn = |material: Option<usize>| material.unwrap_or(materials.len());
    let mut used = vec![false; materials.len() + 1];
    for (mesh, _) in meshes.iter().zip(&drawn).filter(|(_, drawn)| **drawn) {
        mesh.primitives.iter().for_each(|p| used[worn(p.material)] = true);
    }
    let wardrobe = Wardrobe::dress(
        materials,
        &used,
        &textures,
        |wanted| images::decode_images(&root, wanted, &views, settings.folder),
        &mut budget,
        settings.options.keep_uvs,
    )?;
    warnings.extend(wardrobe.warnings.iter().cloned());
    let read = |(mesh, drawn): (&MeshSource, &bool)| read_mesh(mesh, *drawn, &accessors, &wardrobe, &mut budget);
    let local: Vec<_> = meshes.iter().zip(&drawn).map(read).collect::<Result<_, _>>()?;

    let to_mm = DAffine3::from_scale(DVec3::splat(settings.mm_per_unit));
    let worlds = if skins.is_empty() { Vec::new() } else { deform::worlds(&nodes) };
    let deformer = Deformer { accessors: &accessors, skins: &skins, worlds: &worlds };
    let carried =
        || placed.iter().filter_map(|(node, world)| Some((&nodes[*node], nodes[*node].mesh?, to_mm * *world)));
    let deformed: Vec<_> = carried()
        .map(|(node, mesh, _)| deformer.of_node(node, &meshes[mesh], &local[mesh], &mut budget))
        .collect::<Result<_, _>>()?;
    let unweighted: usize = deformed.iter().flatten().map(|d| d.unweighted).sum();
    if unweighted > 0 {
        warnings.push(format!("{unweighted} vertices of skins without weights, left where they are stored"));
    }
    let instances: Vec<(Vec<&LocalPrimitive>, DAffine3)> = carried()
        .zip(&deformed)
        .map(|((_, mesh, world), deformed)| match deformed {
            Some(d) => (d.primitives.iter().collect(), if d.in_world { to_mm } else { world }),
            None => (local[mesh].iter().map(|g| &g.local).collect(), world),
        })
        .collect();
    let mut flat = Budget::new(input.saturating_mul(16) + FLAT_FLOOR);
    for primitive in instances.iter().flat_map(|(mesh, _)| mesh.iter()) {
        flat.take("nodes", primitive.positions.len(), VERTEX_BYTES)?;
        flat.take("nodes", primitive.triangles.len(), TRIANGLE_BYTES)?;
    }
    let baked: Vec<_> = instances.par_iter().map(|(primitives, world)| bake::bake(primitives, world)).collect();
    let mut tally = Tally::default();
    baked.iter().for_each(|(_, repairs)| tally.add(repairs));
    warnings.extend(tally.lines());

    let primitives: Vec<_> = baked.into_iter().flat_map(|(baked, _)| baked).collect();
    let mut scene = wardrobe.assemble(primitives)?;
    for (node, world) in &placed {
        let place = Placement { world: *world, mm_per_unit: settings.mm_per_unit, origin: scene.origin };
        let node = &nodes[*node];
        scene.lights.extend(node.light.map(|light| lights[light].place(&place)));
        let name = node.name.as_deref().unwrap_or("camera");
        scene.cameras.extend(node.camera.map(|c| cameras[c].place(&place, name)));
    }
    if scene.indices.is_empty() {
        warnings.push("the scene has no triangles".to_owned());
    }
    scene.warnings = warnings;
    Ok(scene)
}

/// Which meshes some node of the scene carries.
fn drawn_meshes(meshes: &[MeshSource], nodes: &[Node], placed: &[(usize, DAffine3)]) -> Vec<bool> {
    let mut drawn = vec![false; meshes.len()];
    for mesh in placed.iter().filter_map(|(node, _)| nodes[*node].mesh) {
        drawn[mesh] = true;
    }
    drawn
}

/// One line for each kind of thing in the drawn nodes that is not drawn as the file means it.
fn passed_over(meshes: &[MeshSource], nodes: &[Node], placed: &[(usize, DAffine3)], drawn: &[bool]) -> Vec<String> {
    let drawn_meshes = || meshes.iter().zip(drawn).filter(|(_, d)| **d).map(|(m, _)| m);
    let nodes = || placed.iter().map(|(node, _)| &nodes[*node]);
    let with_mesh = || nodes().filter(|n| n.mesh.is_some());
    let kinds = [
        (drawn_meshes().map(|m| m.thin).sum(), "primitives of points or lines left out"),
        (drawn_meshes().map(|m| m.placeless).sum(), "primitives without positions left out"),
        (with_mesh().filter(|n| n.instanced).count(), "instanced nodes drawn once"),
    ];
    let said = kinds.into_iter().filter(|&(count, _)| count > 0);
    said.map(|(count, what): (usize, _)| format!("{count} {what}")).collect()
}

fn read_mesh(
    mesh: &MeshSource,
    drawn: bool,
    accessors: &[Accessor],
    wardrobe: &Wardrobe,
    budget: &mut Budget,
) -> Result<Vec<Geometry>, Fault> {
    let primitives = mesh.primitives.iter().filter(|_| drawn);
    primitives.map(|p| meshes::read_geometry(p, accessors, wardrobe.wanted(p.material), budget)).collect()
}
