//! Meshes of a file: attributes and indices checked for every mesh, then read, compacted, for those that are drawn.

use super::accessor::{Accessor, Budget, Component};
use super::json::At;
use super::materials::Uvs;
use crate::scene::bake::LocalPrimitive;
use crate::scene::error::Fault;

/// How vertices become triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mode {
    List,
    Strip,
    Fan,
}

/// A primitive that can be drawn, its references checked, its elements not yet read.
pub(super) struct PrimitiveSource {
    pub path: String,
    mode: Mode,
    pub material: Option<usize>,
    position: usize,
    normal: Option<usize>,
    tangent: Option<usize>,
    /// Accessors of TEXCOORD_0, TEXCOORD_1, ...
    uv_sets: Vec<usize>,
    color: Option<usize>,
    /// Accessors of JOINTS_n and WEIGHTS_n, n from 0.
    pub joints: Vec<[usize; 2]>,
    pub targets: Vec<Target>,
    indices: Option<usize>,
}

/// A morph target: accessors of what it adds.
pub(super) struct Target {
    pub position: Option<usize>,
    pub normal: Option<usize>,
    pub tangent: Option<usize>,
}

/// A mesh and what was passed over in it.
#[derive(Default)]
pub(super) struct MeshSource {
    pub primitives: Vec<PrimitiveSource>,
    /// Primitives of points or lines.
    pub thin: usize,
    /// Primitives without positions.
    pub placeless: usize,
    /// Weights of the morph targets where no node says otherwise.
    pub weights: Vec<f64>,
}

impl MeshSource {
    /// Morph targets of its primitives.
    pub fn target_count(&self) -> usize {
        self.primitives.iter().map(|p| p.targets.len()).max().unwrap_or(0)
    }
}

/// All meshes of the file.
pub(super) fn read_meshes(root: &At, accessors: &[Accessor], materials: usize) -> Result<Vec<MeshSource>, Fault> {
    let mut meshes = Vec::new();
    for at in root.list("meshes")? {
        let mut mesh = MeshSource { weights: at.all_numbers("weights")?, ..MeshSource::default() };
        for primitive in at.list("primitives")? {
            read_primitive(&primitive, accessors, materials, &mut mesh)?;
        }
        meshes.push(mesh);
    }
    Ok(meshes)
}

fn read_primitive(at: &At, accessors: &[Accessor], materials: usize, mesh: &mut MeshSource) -> Result<(), Fault> {
    let mode = at.uint("mode")?.unwrap_or(4);
    let material = at.index("material", materials, "materials")?;
    let indices = at.index("indices", accessors.len(), "accessors")?;
    let Some(attributes) = at.object("attributes")? else {
        mesh.placeless += 1;
        return Ok(());
    };
    let attribute = |name: &str| attributes.index(name, accessors.len(), "accessors");
    let Some(position) = attribute("POSITION")? else {
        mesh.placeless += 1;
        return Ok(());
    };
    let count = accessors[position].count;
    for name in attributes.keys() {
        let place = attributes.place(name);
        let Some(accessor) = attribute(name)? else {
            continue;
        };
        let accessor = &accessors[accessor];
        let width: &[usize] = match name {
            "POSITION" | "NORMAL" => &[3],
            "TANGENT" => &[4],
            "COLOR_0" => &[3, 4],
            _ if name.starts_with("JOINTS_") || name.starts_with("WEIGHTS_") => &[4],
            _ if name.starts_with("TEXCOORD_") => &[2],
            _ => continue,
        };
        accessor.expect_width(width, &place)?;
        if accessor.component == Component::U32 {
            return Err(Fault::new(place, "attributes cannot be 32-bit integers"));
        }
        if accessor.count != count {
            return Err(Fault::new(place, format!("{} elements for {count} positions", accessor.count)));
        }
    }
    if let Some(indices) = indices {
        check_indices(&at.place("indices"), &accessors[indices], count)?;
    }
    let mode = match mode {
        4 => Mode::List,
        5 => Mode::Strip,
        6 => Mode::Fan,
        0..=3 => {
            mesh.thin += 1;
            return Ok(());
        }
        other => {
            return Err(Fault::new(at.place("mode"), format!("there is no mode {other}; 0 to 6 are")));
        }
    };
    let mut uv_sets = Vec::new();
    while let Some(set) = attribute(&format!("TEXCOORD_{}", uv_sets.len()))? {
        uv_sets.push(set);
    }
    let mut joints = Vec::new();
    while let (Some(joint), Some(weight)) =
        (attribute(&format!("JOINTS_{}", joints.len()))?, attribute(&format!("WEIGHTS_{}", joints.len()))?)
    {
        joints.push([joint, weight]);
    }
    let targets = at.list("targets")?.iter().map(|t| read_target(t, accessors, count)).collect::<Result<_, _>>()?;
    mesh.primitives.push(PrimitiveSource {
        path: at.path().to_owned(),
        mode,
        material,
        position,
        normal: attribute("NORMAL")?,
        tangent: attribute("TANGENT")?,
        uv_sets,
        color: attribute("COLOR_0")?,
        joints,
        targets,
        indices,
    });
    Ok(())
}

fn read_target(at: &At, accessors: &[Accessor], count: usize) -> Result<Target, Fault> {
    let part = |name: &str| {
        let Some(index) = at.index(name, accessors.len(), "accessors")? else { return Ok(None) };
        accessors[index].expect_width(&[3], &at.place(name))?;
        if accessors[index].count != count {
            let reason = format!("{} elements for {count} positions", accessors[index].count);
            return Err(Fault::new(at.place(name), reason));
        }
        Ok(Some(index))
    };
    Ok(Target { position: part("POSITION")?, normal: part("NORMAL")?, tangent: part("TANGENT")? })
}

fn check_indices(place: &str, indices: &Accessor, vertices: usize) -> Result<(), Fault> {
    indices.expect_width(&[1], place)?;
    if !matches!(indices.component, Component::U8 | Component::U16 | Component::U32) {
        return Err(Fault::new(place, "indices must be unsigned integers"));
    }
    match indices.distinct_uints().find(|&i| i as usize >= vertices) {
        Some(index) => {
            Err(Fault::new(place, format!("{index} is out of range; the primitive has {vertices} vertices")))
        }
        None => Ok(()),
    }
}

/// What the material asks of a primitive's vertices.
#[derive(Clone, Copy)]
pub(super) struct Wanted {
    /// Index of the scene's material.
    pub material: usize,
    pub uvs: Option<Uvs>,
    pub second_uvs: Option<Uvs>,
    pub tangents: bool,
    /// The normal map reads the second UVs.
    pub tangents_second: bool,
    pub textured: bool,
}

/// A primitive's drawn vertices, and which of the file's each is.
pub(super) struct Geometry {
    pub local: LocalPrimitive,
    pub kept: Vec<usize>,
}

/// Reads the drawn vertices of a primitive. Those that no triangle names are left out, so that primitives which share
/// one large array do not each carry it.
pub(super) fn read_geometry(
    source: &PrimitiveSource,
    accessors: &[Accessor],
    wanted: Wanted,
    budget: &mut Budget,
) -> Result<Geometry, Fault> {
    let position = &accessors[source.position];
    let indices = source.indices.map(|i| &accessors[i]);
    let corners = indices.map_or(position.count, |i| i.count);
    // An index, and at most one vertex for it.
    budget.take(&source.path, corners, 4)?;
    let mut compact = Compact::new(position.count, corners);
    let mut vertex = |i: usize| compact.place(indices.map_or(i, |a| a.uint(i) as usize));
    let triangles: Vec<[u32; 3]> = match source.mode {
        Mode::List => (0..corners / 3).map(|t| [0, 1, 2].map(|k| vertex(3 * t + k))).collect(),
        Mode::Strip => (2..corners)
            .map(|t| {
                // Every other triangle of a strip is turned over.
                let odd = t % 2;
                [vertex(t - 2), vertex(t - 1 + odd), vertex(t - odd)]
            })
            .collect(),
        Mode::Fan => (2..corners).map(|t| [vertex(t - 1), vertex(t), vertex(0)]).collect(),
    };
    let kept = compact.kept;
    budget.take(&source.path, kept.len(), if source.color.is_some() { 72 } else { 56 })?;
    let read_uvs = |uvs: Uvs| {
        let set = &accessors[*source.uv_sets.get(uvs.set)?];
        let read = |&v: &usize| {
            let uv = glam::DVec2::from_array(set.floats::<2>(v).map(f64::from));
            let uv = uvs.transform.transform_point2(uv).as_vec2();
            if uv.is_finite() { uv.to_array() } else { [0.0; 2] }
        };
        Some(kept.iter().map(read).collect())
    };
    let uvs = wanted.uvs.and_then(read_uvs);
    let second_uvs = wanted.second_uvs.and_then(read_uvs);
    let bumped = if wanted.tangents_second { wanted.second_uvs } else { wanted.uvs };
    let plain = bumped.is_none_or(|uvs| uvs.transform == Uvs::PLAIN.transform);
    let gather = |a: usize| kept.iter().map(|&v| accessors[a].floats(v)).collect();
    let local = LocalPrimitive {
        material: wanted.material,
        positions: kept.iter().map(|&v| position.floats(v)).collect(),
        normals: source.normal.map(gather),
        // Tangents of a file follow its UVs; turned UVs need their own.
        tangents: source
            .tangent
            .filter(|_| wanted.tangents && plain)
            .map(|a| kept.iter().map(|&v| accessors[a].floats(v)).collect()),
        uvs,
        second_uvs,
        colors: source.color.map(|a| kept.iter().map(|&v| color(&accessors[a], v)).collect()),
        triangles,
        remainder: match source.mode {
            Mode::List => corners % 3,
            _ => 0,
        },
        needs_tangents: wanted.tangents,
        tangents_second: wanted.tangents_second,
        needs_uvs: wanted.textured,
        needs_second: wanted.second_uvs.is_some(),
    };
    Ok(Geometry { local, kept })
}

/// A vertex's colour, linear; without an alpha of its own it covers.
fn color(accessor: &Accessor, vertex: usize) -> [f32; 4] {
    let [r, g, b, a] = accessor.floats::<4>(vertex);
    let a = if accessor.width == 3 { 1.0 } else { a };
    [r, g, b, a].map(|x| if x.is_finite() { x.max(0.0) } else { 1.0 })
}

/// Renumbers vertices in the order of their first use.
struct Compact {
    /// New number of an old vertex, or `u32::MAX`.
    dense: Vec<u32>,
    /// The same for a few vertices of a large array.
    few: std::collections::HashMap<usize, u32>,
    is_dense: bool,
    /// Old numbers in new order.
    kept: Vec<usize>,
}

impl Compact {
    fn new(vertices: usize, corners: usize) -> Self {
        // A table of all vertices is quickest, but not for three of a million.
        let is_dense = vertices <= corners.saturating_mul(2);
        Self {
            dense: vec![u32::MAX; if is_dense { vertices } else { 0 }],
            few: std::collections::HashMap::new(),
            is_dense,
            kept: Vec::new(),
        }
    }

    fn place(&mut self, old: usize) -> u32 {
        let next = self.kept.len() as u32;
        let new = if self.is_dense {
            let new = &mut self.dense[old];
            if *new == u32::MAX {
                *new = next;
            }
            *new
        } else {
            *self.few.entry(old).or_insert(next)
        };
        if new == next {
            self.kept.push(old);
        }
        new
    }
}
