//! Scenes: glTF files and built-in shapes in; triangles, materials, textures, lights and cameras in millimetres out.
//!
//! A scene is *flat*: every node's mesh is baked into world space, right-handed, +Y up, in mm relative to
//! [`Scene::origin`], which is kept in f64 so that f32 positions stay exact to 60 nanometres a metre wherever in the
//! world the object lies. The triangles of one material are one contiguous [`Draw`]. What a file leaves undefined
//! (missing or zero normals, degenerate or duplicate triangles, NaN) is defined here, counted, and said once in
//! [`Scene::warnings`]; what contradicts itself is refused with one line naming the place.

mod atlas;
mod bake;
mod camera;
mod convex;
mod environment;
mod error;
mod gltf;
mod light;
mod material;
mod mesh_curvature;
mod mips;
mod normals;
mod shape;
mod shape_mesh;
mod tangents;

use std::path::Path;
use std::sync::Arc;

use glam::{DVec3, Vec3};

pub use atlas::{Atlas, Filled, Seam, gutter};
pub(crate) use camera::framing_distance;
pub use camera::{Camera, Projection};
pub use convex::is_convex;
pub use environment::Environment;
pub use error::SceneError;
pub use light::{Light, LightKind, direction_from};
pub use material::{Alpha, Coat, Filter, MAPS, Material, Scattering, Sheen, Specular, Texture, Wrap};
pub use mesh_curvature::vertex_curvature;
pub use mips::Mips;
pub use shape::{ShapeSpec, shape_curvature, shape_normal};

/// Everything a frame can draw, in mm, relative to [`origin`](Self::origin).
#[derive(Clone, Debug)]
pub struct Scene {
    /// The file's stem, or the shape's text.
    pub name: String,
    /// World position, mm, that all stored positions are relative to: the centre of the world bounding box.
    pub origin: DVec3,
    /// Bounding box of the drawn triangles, mm, relative to the origin. One point at zero where nothing is drawn.
    pub bounds: Aabb,
    /// Vertex positions, mm, finite.
    pub positions: Vec<[f32; 3]>,
    /// Unit vertex normals, as many as positions.
    pub normals: Vec<[f32; 3]>,
    /// Unit tangents and the bitangent's sign (bitangent = sign * normal x tangent); empty if no material has a normal
    /// map, else as many as positions.
    pub tangents: Vec<[f32; 4]>,
    /// Texture coordinates, v downwards; empty if no texture is used (and `keep_uvs` is off), else as many as positions.
    pub uvs: Vec<[f32; 2]>,
    /// Second coordinates, for the textures that [`Material::second_uvs`] names; empty if there are none, else as many as
    /// positions.
    pub second_uvs: Vec<[f32; 2]>,
    /// Linear RGBA, not negative, that multiplies the base colour; empty if no vertex has a colour, else as many as positions.
    pub colors: Vec<[f32; 4]>,
    /// Triangles, counter-clockwise seen from the front; every index is below `positions.len()`.
    pub indices: Vec<u32>,
    /// Runs of `indices`, one for each material, in the order of `materials`.
    pub draws: Vec<Draw>,
    /// The materials that are drawn.
    pub materials: Vec<Material>,
    /// The textures that the materials name.
    pub textures: Vec<Texture>,
    /// Lights of the file; none for shapes.
    pub lights: Vec<Light>,
    /// Cameras of the file; none for shapes.
    pub cameras: Vec<Camera>,
    /// Light from all around, instead of the settings' ambient; no file brings it.
    pub environment: Option<Arc<Environment>>,
    /// What was ignored, repaired or assumed, each once, with counts; for people to read.
    pub warnings: Vec<String>,
}

/// One run of triangles with one material.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Draw {
    /// Index into [`Scene::materials`].
    pub material: usize,
    /// First entry of [`Scene::indices`].
    pub first_index: u32,
    /// Entries, a positive multiple of 3.
    pub index_count: u32,
}

/// An axis-aligned box, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Smallest corner.
    pub min: Vec3,
    /// Largest corner.
    pub max: Vec3,
}

impl Aabb {
    /// The smallest box around finite points; one point at zero if there are none.
    pub fn around(points: &[[f32; 3]]) -> Self {
        let mut points = points.iter().map(|&p| Vec3::from(p));
        let first = points.next().unwrap_or(Vec3::ZERO);
        let start = Self { min: first, max: first };
        points.fold(start, |b, p| Self { min: b.min.min(p), max: b.max.max(p) })
    }

    /// Middle of the box, mm.
    pub fn center(&self) -> Vec3 {
        self.min.midpoint(self.max)
    }

    /// Edges of the box, mm, none negative.
    pub fn size(&self) -> Vec3 {
        self.max - self.min
    }
}

/// How a file is read.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LoadOptions {
    /// Millimetres in one unit of the file; 1000 if absent, since glTF is in metres. Positive and finite.
    pub mm_per_unit: Option<f64>,
    /// Keep the file's first UV set even where no texture is used, for methods that work in texture space.
    pub keep_uvs: bool,
    /// Where the file's animation is; absent: nodes stand as the file places them.
    pub pose: Option<Pose>,
}

/// A moment of an animation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Index into the file's animations.
    pub animation: usize,
    /// Seconds; before the first key and after the last the animation stands still.
    pub time: f64,
}

impl LoadOptions {
    fn checked_mm_per_unit(&self) -> Result<f64, SceneError> {
        match self.mm_per_unit.unwrap_or(1000.0) {
            mm if mm.is_finite() && mm > 0.0 => Ok(mm),
            value => Err(SceneError::Option {
                option: "mm_per_unit",
                value,
                reason: "it must be positive and finite, such as 1000 for metres",
            }),
        }
    }
}

impl Scene {
    /// A scene from what stands on the command line: `bust`, `shape:...` or the path of a glTF file.
    ///
    /// # Errors
    /// Those of [`Scene::bust`], [`Scene::shape`] and [`Scene::load`].
    pub fn open(arg: &str, options: &LoadOptions) -> Result<Self, SceneError> {
        match arg {
            "bust" => Self::bust(options),
            _ if arg.starts_with("shape:") => Self::shape(arg),
            _ => Self::load(Path::new(arg), options),
        }
    }

    /// The head and shoulders that come with the program (`assets/bust/README.md` says how they were made): true to
    /// size, facing +Z, with a camera for a portrait. It is whole in the binary: no file is looked for.
    ///
    /// # Errors
    /// Those of [`Scene::load`] that `options` can cause.
    pub fn bust(options: &LoadOptions) -> Result<Self, SceneError> {
        const FILE: &[u8] = include_bytes!("../../assets/bust.glb");
        gltf::load_bytes(FILE, "bust", options.checked_mm_per_unit()?, options)
    }

    /// Reads a `.gltf` or `.glb` file with the buffers and images it names. The default scene is used, else the first,
    /// else all root nodes.
    ///
    /// # Errors
    /// If a file cannot be read, breaks the format, requires an extension that is not supported, or is larger than
    /// the limits on memory (16 times its bytes and 256 MiB while reading). Never panics on malformed input.
    pub fn load(path: &Path, options: &LoadOptions) -> Result<Self, SceneError> {
        gltf::load(path, options.checked_mm_per_unit()?, options)
    }

    /// A built-in shape, such as `shape:torus:70,25` (mm), finely tessellated, with analytic normals and UVs, centred
    /// at the origin. Sizes left out take the defaults of [`ShapeSpec`].
    ///
    /// # Errors
    /// If the text names no shape or its sizes are out of range.
    pub fn shape(text: &str) -> Result<Self, SceneError> {
        Ok(shape_mesh::build(text, &text.parse::<ShapeSpec>()?))
    }

    /// Gives the profile with this index to the materials of this name. Without a name, to those of which the file says
    /// that light passes into them ([`Material::translucent`]), or, if it says so of none, to every opaque dielectric (see
    /// [`Material::is_opaque_dielectric`]).
    ///
    /// # Errors
    /// If no material has the name; the message lists those there are.
    pub fn assign_profile(&mut self, material_name: Option<&str>, profile: usize) -> Result<(), SceneError> {
        let mut found = false;
        let said = self.materials.iter().any(|m| m.translucent);
        for material in &mut self.materials {
            let chosen = match material_name {
                Some(name) => material.name == name,
                None => material.is_opaque_dielectric() && (material.translucent || !said),
            };
            found |= chosen;
            // What its mask lets nowhere in scatters nothing, and the frame need not ask.
            if chosen && material.scatter_mask > 0.0 {
                material.scatter = Some(profile);
            }
        }
        match material_name {
            Some(name) if !found => Err(SceneError::Material { name: name.to_owned(), known: self.material_names() }),
            _ => Ok(()),
        }
    }

    /// The drawn materials that say how light goes on inside them, each with that, the one of the most triangles first.
    pub fn scatterings(&self) -> Vec<(&Material, Scattering)> {
        let mut draws: Vec<_> = self.draws.iter().collect();
        draws.sort_by_key(|d| std::cmp::Reverse(d.index_count));
        let materials = draws.iter().filter_map(|d| self.materials.get(d.material));
        materials.filter_map(|m| Some((m, m.scattering?))).collect()
    }

    fn material_names(&self) -> String {
        if self.materials.is_empty() {
            return "no materials".to_owned();
        }
        let names: Vec<_> = self.materials.iter().map(|m| format!("'{}'", m.name)).collect();
        names.join(", ")
    }

    /// Triangles drawn.
    pub fn triangle_count(&self) -> usize {
        self.indices.len() / 3
    }
}
