//! Materials of a file: factors, and which texture stands in which slot with which UVs.

use glam::{DAffine2, DMat2, DVec2};

use super::json::At;
use crate::scene::error::Fault;
use crate::scene::material::{Alpha, Material};

/// Places of a texture in a material, in the order in which they decide on the UVs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Slot {
    BaseColor,
    Normal,
    MetallicRoughness,
    Occlusion,
}

/// A texture in its slot.
#[derive(Clone, Debug)]
pub(super) struct SlotUse {
    pub slot: Slot,
    /// Index into the file's `textures`.
    pub texture: usize,
    /// Scale of a normal map, strength of occlusion.
    pub factor: f32,
    uvs: Uvs,
}

/// Which UVs a texture reads: one of the mesh's sets, transformed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Uvs {
    pub set: usize,
    pub transform: DAffine2,
}

impl Uvs {
    /// The first set as it is.
    pub const PLAIN: Self = Self { set: 0, transform: DAffine2::IDENTITY };
}

/// A material whose textures are still indices into the file.
pub(super) struct MaterialSource {
    pub material: Material,
    /// Slots in use, all with the same UVs.
    pub slots: Vec<SlotUse>,
    pub uvs: Uvs,
    /// Slots left out because their UVs differ from those of the others.
    pub dropped: usize,
}

/// All materials of the file.
pub(super) fn read_materials(root: &At, textures: usize) -> Result<Vec<MaterialSource>, Fault> {
    let list = root.list("materials")?;
    list.iter().enumerate().map(|(index, at)| read_material(at, index, textures)).collect()
}

/// What a primitive without a material wears: glTF's default is a metal, which nobody means who leaves it out.
pub(super) fn default_material() -> MaterialSource {
    let mut material = Material::new("default");
    material.roughness = 1.0;
    MaterialSource { material, slots: Vec::new(), uvs: Uvs::PLAIN, dropped: 0 }
}

fn read_material(at: &At, index: usize, textures: usize) -> Result<MaterialSource, Fault> {
    let name = at.text("name")?.filter(|name| !name.is_empty());
    let name = name.map_or_else(|| format!("material {index}"), str::to_owned);
    let mut material = Material::new(&name);
    material.metallic = 1.0;
    material.roughness = 1.0;
    material.double_sided = at.flag("doubleSided")?;
    material.alpha = match at.text("alphaMode")? {
        None | Some("OPAQUE") => Alpha::Opaque,
        Some("BLEND") => Alpha::Blend,
        Some("MASK") => Alpha::Mask(at.number("alphaCutoff")?.unwrap_or(0.5) as f32),
        Some(other) => {
            return Err(Fault::new(
                at.place("alphaMode"),
                format!("there is no mode '{other}'; OPAQUE, MASK and BLEND are"),
            ));
        }
    };
    if let Some(ior) = at.extension("KHR_materials_ior")? {
        let ior = ior.number("ior")?.unwrap_or(1.5) as f32;
        material.ior = if ior == 0.0 { 0.0 } else { ior.max(1.0) };
    }
    if let Some(through) = at.extension("KHR_materials_diffuse_transmission")? {
        material.translucent = through.number("diffuseTransmissionFactor")?.is_some_and(|part| part > 0.0);
    }
    let mut slots = Vec::new();
    let mut take = |of: &At, key: &str, slot: Slot, factor: &str| {
        let found = read_slot(of, key, slot, factor, textures);
        found.map(|found| slots.extend(found))
    };
    let specular_glossiness = at.extension("KHR_materials_pbrSpecularGlossiness")?;
    if let Some(of) = &specular_glossiness {
        // The nearest dielectric: its diffuse colour and its gloss; a coloured highlight is lost.
        material.metallic = 0.0;
        set_color(&mut material, of.numbers::<4>("diffuseFactor")?);
        material.roughness = 1.0 - unit(of.number("glossinessFactor")?, 1.0);
        take(of, "diffuseTexture", Slot::BaseColor, "")?;
    }
    take(at, "normalTexture", Slot::Normal, "scale")?;
    if let Some(of) = at.object("pbrMetallicRoughness")?
        && specular_glossiness.is_none()
    {
        set_color(&mut material, of.numbers::<4>("baseColorFactor")?);
        material.metallic = unit(of.number("metallicFactor")?, 1.0);
        material.roughness = unit(of.number("roughnessFactor")?, 1.0);
        take(&of, "baseColorTexture", Slot::BaseColor, "")?;
        let slot = Slot::MetallicRoughness;
        take(&of, "metallicRoughnessTexture", slot, "")?;
    }
    take(at, "occlusionTexture", Slot::Occlusion, "strength")?;
    // Not drawn, but a reference that leads nowhere is a fault of the file all the same.
    read_slot(at, "emissiveTexture", Slot::BaseColor, "", textures)?;
    Ok(agree_on_uvs(material, slots))
}

/// The scene has one set of UVs a vertex: the slots that read others are left out.
fn agree_on_uvs(material: Material, mut slots: Vec<SlotUse>) -> MaterialSource {
    let leader = slots.iter().min_by_key(|s| s.slot as usize);
    let uvs = leader.map_or(Uvs::PLAIN, |s| s.uvs);
    let all = slots.len();
    slots.retain(|s| s.uvs == uvs);
    MaterialSource { material, uvs, dropped: all - slots.len(), slots }
}

fn set_color(material: &mut Material, color: Option<[f64; 4]>) {
    if let Some(color) = color {
        material.base_color = color.map(|c| unit(Some(c), 1.0));
    }
}

fn unit(value: Option<f64>, default: f32) -> f32 {
    value.map_or(default, |v| (v as f32).clamp(0.0, 1.0))
}

fn read_slot(of: &At, key: &str, slot: Slot, factor: &str, textures: usize) -> Result<Option<SlotUse>, Fault> {
    let Some(at) = of.object(key)? else {
        return Ok(None);
    };
    let texture = at.required(at.index("index", textures, "textures")?, "index")?;
    let mut set = at.uint("texCoord")?.unwrap_or(0);
    let mut transform = DAffine2::IDENTITY;
    if let Some(t) = at.extension("KHR_texture_transform")? {
        set = t.uint("texCoord")?.unwrap_or(set);
        let offset = t.numbers::<2>("offset")?.unwrap_or([0.0; 2]);
        let scale = t.numbers::<2>("scale")?.unwrap_or([1.0; 2]);
        let (sin, cos) = t.number("rotation")?.unwrap_or(0.0).sin_cos();
        // The extension turns the other way than a right-handed plane, because v points down.
        transform = DAffine2 {
            matrix2: DMat2::from_cols(DVec2::new(cos, -sin) * scale[0], DVec2::new(sin, cos) * scale[1]),
            translation: DVec2::from_array(offset),
        };
    }
    let factor = match factor {
        "" => 1.0,
        key => at.number(key)?.unwrap_or(1.0) as f32,
    };
    Ok(Some(SlotUse { slot, texture, factor, uvs: Uvs { set: usize::try_from(set).unwrap_or(usize::MAX), transform } }))
}
