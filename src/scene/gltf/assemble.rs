//! The materials and textures that are really used, and the joining of baked primitives into one scene.

use glam::DVec3;

use super::accessor::Budget;
use super::images::{Decoded, TextureSource};
use super::materials::{MaterialSource, Slot, Uvs, default_material};
use super::meshes::Wanted;
use crate::scene::bake::BakedPrimitive;
use crate::scene::error::Fault;
use crate::scene::material::{Material, Texture};
use crate::scene::tangents::across;
use crate::scene::{Aabb, Draw, Scene};

/// What the drawn primitives wear.
pub(super) struct Wardrobe {
    materials: Vec<Material>,
    /// First and second UVs of each material.
    uvs: Vec<[Uvs; 2]>,
    textures: Vec<Texture>,
    /// Scene's material for each of the file's, the default last; unused ones are meaningless.
    renumbered: Vec<usize>,
    keep_uvs: bool,
    pub warnings: Vec<String>,
}

impl Wardrobe {
    /// Picks the used materials (of the file's and the default one behind them) and loads their textures. `decode`
    /// decodes the wanted ones of the file's images.
    pub fn dress(
        sources: Vec<MaterialSource>,
        used: &[bool],
        textures: &[TextureSource],
        decode: impl FnOnce(&[bool]) -> Result<Vec<Option<Decoded>>, Fault>,
        budget: &mut Budget,
        keep_uvs: bool,
    ) -> Result<Self, Fault> {
        let mut renumbered = Vec::with_capacity(used.len());
        let mut picked = Vec::new();
        for (source, &used) in sources.into_iter().chain([default_material()]).zip(used) {
            renumbered.push(picked.len());
            if used {
                picked.push(source);
            }
        }
        let mut wardrobe = Self {
            materials: Vec::new(),
            uvs: Vec::new(),
            textures: Vec::new(),
            renumbered,
            keep_uvs,
            warnings: Vec::new(),
        };
        let slots = || picked.iter().flat_map(|source| &source.slots);
        let images = slots().filter_map(|slot| textures[slot.texture].image);
        let last = images.clone().max().map_or(0, |last| last + 1);
        let mut wanted = vec![false; last];
        images.for_each(|image| wanted[image] = true);
        let decoded = decode(&wanted)?;
        let damaged = decoded.iter().flatten().filter_map(|image| image.as_ref().err());
        wardrobe.warnings.extend(damaged.cloned());

        wardrobe.warnings.extend(picked.iter().flat_map(|source| source.odd.iter().cloned()));
        let dropped: usize = picked.iter().map(|source| source.dropped).sum();
        if dropped > 0 {
            wardrobe
                .warnings
                .push(format!("{dropped} textures left out that read a third kind of UVs in their material"));
        }
        let empty = slots().filter(|slot| textures[slot.texture].image.is_none()).count();
        if empty > 0 {
            wardrobe.warnings.push(format!("{empty} textures left out that have no image this program can read"));
        }
        let mut made: Vec<(usize, bool)> = Vec::new();
        for source in picked {
            wardrobe.add(source, textures, &decoded, &mut made, budget)?;
        }
        Ok(wardrobe)
    }

    /// Adds a material with those of its textures that could be decoded; `made` are the textures so far.
    fn add(
        &mut self,
        source: MaterialSource,
        textures: &[TextureSource],
        decoded: &[Option<Decoded>],
        made: &mut Vec<(usize, bool)>,
        budget: &mut Budget,
    ) -> Result<(), Fault> {
        let mut material = source.material;
        for slot in source.slots {
            let texture = &textures[slot.texture];
            let Some(Some(Ok(image))) = texture.image.map(|image| &decoded[image]) else {
                // Its factor is white where the texture is to be seen.
                if slot.slot == Slot::Emission {
                    material.emission = [0.0; 3];
                }
                continue;
            };
            let key = (slot.texture, slot.slot.is_color());
            let index = match made.iter().position(|m| *m == key) {
                Some(index) => index,
                None => {
                    self.textures.push(texture.build(image, key.1, budget)?);
                    made.push(key);
                    made.len() - 1
                }
            };
            match slot.slot {
                Slot::BaseColor => material.base_color_texture = Some(index),
                Slot::Emission => material.emission_texture = Some(index),
                Slot::Normal => material.normal_texture = Some((index, slot.factor)),
                Slot::MetallicRoughness => material.metallic_roughness_texture = Some(index),
                Slot::Occlusion => {
                    material.occlusion_texture = Some((index, slot.factor.clamp(0.0, 1.0)));
                }
                Slot::ScatterMask => match constant_alpha(&self.textures[index]) {
                    Some(alpha) => material.scatter_mask *= alpha,
                    None => material.scatter_mask_texture = Some(index),
                },
                Slot::Thickness => material.thickness_texture = Some(index),
                Slot::Coat => material.coat.factor_texture = Some(index),
                Slot::CoatRoughness => material.coat.roughness_texture = Some(index),
                Slot::Sheen => material.sheen.color_texture = Some(index),
                Slot::SheenRoughness => material.sheen.roughness_texture = Some(index),
                Slot::Specular => material.specular.factor_texture = Some(index),
                Slot::SpecularColor => material.specular.color_texture = Some(index),
            }
        }
        self.materials.push(material);
        self.uvs.push(source.uvs);
        Ok(())
    }

    /// What the file's material (or none) asks of vertices.
    pub fn wanted(&self, material: Option<usize>) -> Wanted {
        let last = self.renumbered.len() - 1;
        let material = self.renumbered[material.unwrap_or(last)];
        let wears = &self.materials[material];
        let [first, second] = self.uvs[material];
        Wanted {
            material,
            uvs: (wears.is_textured() || self.keep_uvs).then_some(first),
            second_uvs: (wears.second_uvs != 0).then_some(second),
            tangents: wears.normal_texture.is_some(),
            tangents_second: wears.second_uvs >> Slot::Normal.map() & 1 != 0,
            textured: wears.is_textured(),
        }
    }

    /// Joins primitives into a scene, material by material.
    pub fn assemble(mut self, primitives: Vec<BakedPrimitive>) -> Result<Scene, Fault> {
        let corners = || primitives.iter().flat_map(|p| &p.positions);
        let (min, max) =
            corners().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(min, max), &p| (min.min(p), max.max(p)));
        let vertices = corners().count();
        let indices: usize = primitives.iter().map(|p| 3 * p.triangles.len()).sum();
        if vertices.max(indices) > u32::MAX as usize {
            return Err(Fault::new(
                "nodes",
                format!("{vertices} vertices and {indices} indices pass the limit of 2^32 - 1"),
            ));
        }
        let has_tangents = self.materials.iter().any(|m| m.normal_texture.is_some());
        let has_uvs = self.materials.iter().any(Material::is_textured)
            || (self.keep_uvs && primitives.iter().any(|p| !p.uvs.is_empty()));
        let has_second = primitives.iter().any(|p| !p.second_uvs.is_empty());
        let has_colors = primitives.iter().any(|p| !p.colors.is_empty());
        let mut scene = Scene {
            name: String::new(),
            origin: if vertices > 0 { min.midpoint(max) } else { DVec3::ZERO },
            bounds: Aabb::around(&[]),
            positions: Vec::with_capacity(vertices),
            normals: Vec::with_capacity(vertices),
            tangents: Vec::with_capacity(if has_tangents { vertices } else { 0 }),
            uvs: Vec::with_capacity(if has_uvs { vertices } else { 0 }),
            second_uvs: Vec::with_capacity(if has_second { vertices } else { 0 }),
            colors: Vec::with_capacity(if has_colors { vertices } else { 0 }),
            indices: Vec::with_capacity(indices),
            draws: Vec::new(),
            materials: std::mem::take(&mut self.materials),
            textures: std::mem::take(&mut self.textures),
            lights: Vec::new(),
            cameras: Vec::new(),
            environment: None,
            warnings: Vec::new(),
        };
        let mut by_material: Vec<Vec<BakedPrimitive>> = Vec::new();
        by_material.resize_with(scene.materials.len(), Vec::new);
        for primitive in primitives {
            by_material[primitive.material].push(primitive);
        }
        for (material, primitives) in by_material.into_iter().enumerate() {
            let first_index = scene.indices.len() as u32;
            for primitive in primitives {
                let has = Has { tangents: has_tangents, uvs: has_uvs, second_uvs: has_second, colors: has_colors };
                append(&mut scene, primitive, has);
            }
            let index_count = scene.indices.len() as u32 - first_index;
            if index_count > 0 {
                scene.draws.push(Draw { material, first_index, index_count });
            }
        }
        scene.bounds = Aabb::around(&scene.positions);
        Ok(scene)
    }
}

/// What every vertex of the scene has, because some need it.
#[derive(Clone, Copy)]
struct Has {
    tangents: bool,
    uvs: bool,
    second_uvs: bool,
    colors: bool,
}

/// The alpha of a texture that has but one.
fn constant_alpha(texture: &Texture) -> Option<f32> {
    let first = *texture.rgba8.get(3)?;
    let same = texture.rgba8.iter().skip(3).step_by(4).all(|a| *a == first);
    same.then_some(f32::from(first) / 255.0)
}

fn append(scene: &mut Scene, primitive: BakedPrimitive, has: Has) {
    let base = scene.positions.len() as u32;
    let count = primitive.positions.len();
    let origin = scene.origin;
    let relative = |p: &DVec3| (*p - origin).as_vec3().to_array();
    scene.positions.extend(primitive.positions.iter().map(relative));
    if has.tangents && primitive.tangents.is_empty() {
        scene.tangents.extend(primitive.normals.iter().map(|&n| across(n)));
    } else if has.tangents {
        scene.tangents.extend(primitive.tangents);
    }
    if has.colors && primitive.colors.is_empty() {
        scene.colors.extend(std::iter::repeat_n([1.0; 4], count));
    } else if has.colors {
        scene.colors.extend(primitive.colors);
    }
    if has.uvs && primitive.uvs.is_empty() {
        scene.uvs.extend(std::iter::repeat_n([0.0; 2], count));
    } else if has.uvs {
        scene.uvs.extend(primitive.uvs);
    }
    if has.second_uvs && primitive.second_uvs.is_empty() {
        scene.second_uvs.extend(std::iter::repeat_n([0.0; 2], count));
    } else if has.second_uvs {
        scene.second_uvs.extend(primitive.second_uvs);
    }
    scene.normals.extend(primitive.normals);
    let corners = primitive.triangles.iter().flatten();
    scene.indices.extend(corners.map(|i| base + i));
}
