//! Materials of a file: factors, and which texture stands in which slot with which UVs.

use glam::{DAffine2, DMat2, DVec2};

use super::json::At;
use super::{gloss, scattering};
use crate::scene::error::Fault;
use crate::scene::material::{Alpha, Material};

/// Places of a texture in a material, in the order in which they decide on the UVs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Slot {
    BaseColor,
    Normal,
    MetallicRoughness,
    Occlusion,
    Emission,
    ScatterMask,
    Thickness,
    Coat,
    CoatRoughness,
    Sheen,
    SheenRoughness,
    Specular,
    SpecularColor,
}

impl Slot {
    /// Its place in [`MAPS`].
    pub fn map(self) -> usize {
        match self {
            Self::BaseColor => 0,
            Self::MetallicRoughness => 1,
            Self::Normal => 2,
            other => other as usize,
        }
    }

    /// Whether its RGB is a colour.
    pub fn is_color(self) -> bool {
        matches!(self, Self::BaseColor | Self::Emission | Self::Sheen | Self::SpecularColor)
    }
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
    /// Slots in use, with the first or the second UVs.
    pub slots: Vec<SlotUse>,
    pub uvs: [Uvs; 2],
    /// Slots left out because their UVs are a third kind.
    pub dropped: usize,
    /// A line for each value that makes no sense, with the one that is taken.
    pub odd: Vec<String>,
}

/// All materials of the file.
pub(super) fn read_materials(root: &At, textures: usize, mm_per_unit: f64) -> Result<Vec<MaterialSource>, Fault> {
    let list = root.list("materials")?;
    list.iter().enumerate().map(|(index, at)| read_material(at, index, textures, mm_per_unit)).collect()
}

/// What a primitive without a material wears: glTF's default is a metal, which nobody means who leaves it out.
pub(super) fn default_material() -> MaterialSource {
    let mut material = Material::new("default");
    material.roughness = 1.0;
    MaterialSource { material, slots: Vec::new(), uvs: [Uvs::PLAIN; 2], dropped: 0, odd: Vec::new() }
}

fn read_material(at: &At, index: usize, textures: usize, mm_per_unit: f64) -> Result<MaterialSource, Fault> {
    let name = at.text("name")?.filter(|name| !name.is_empty());
    let name = name.map_or_else(|| format!("material {index}"), str::to_owned);
    let mut material = Material::new(&name);
    let odd = &mut Vec::new();
    material.metallic = 1.0;
    material.roughness = 1.0;
    material.double_sided = at.flag("doubleSided")?;
    material.alpha = match at.text("alphaMode")? {
        None | Some("OPAQUE") => Alpha::Opaque,
        Some("BLEND") => Alpha::Blend,
        Some("MASK") => Alpha::Mask(unit(at, "alphaCutoff", 0.5, odd)?),
        Some(other) => {
            return Err(Fault::new(
                at.place("alphaMode"),
                format!("there is no mode '{other}'; OPAQUE, MASK and BLEND are"),
            ));
        }
    };
    if let Some(ior) = at.extension("KHR_materials_ior")? {
        let given = ior.number("ior")?.unwrap_or(1.5);
        // 0 is the extension's own word for a surface that reflects all.
        material.ior = if given == 0.0 { 0.0 } else { within(&ior, "ior", given, 1.0, f64::INFINITY, odd) };
    }
    (material.translucent, material.scattering) = scattering::read(at, mm_per_unit, odd)?;
    let mut slots = Vec::new();
    scattering::read_inside(at, &mut material, mm_per_unit, &mut slots, textures, odd)?;
    gloss::read(at, &mut material, &mut slots, textures, odd)?;
    let mut take = |of: &At, key: &str, slot: Slot, factor: &str| {
        let found = read_slot(of, key, slot, factor, textures);
        found.map(|found| slots.extend(found))
    };
    let specular_glossiness = at.extension("KHR_materials_pbrSpecularGlossiness")?;
    if let Some(of) = &specular_glossiness {
        // The nearest dielectric: its diffuse colour and its gloss; a coloured highlight is lost.
        material.metallic = 0.0;
        material.base_color = color(of, "diffuseFactor", odd)?;
        material.roughness = 1.0 - unit(of, "glossinessFactor", 1.0, odd)?;
        take(of, "diffuseTexture", Slot::BaseColor, "")?;
    }
    take(at, "normalTexture", Slot::Normal, "scale")?;
    if let Some(of) = at.object("pbrMetallicRoughness")?
        && specular_glossiness.is_none()
    {
        material.base_color = color(&of, "baseColorFactor", odd)?;
        material.metallic = unit(&of, "metallicFactor", 1.0, odd)?;
        material.roughness = unit(&of, "roughnessFactor", 1.0, odd)?;
        take(&of, "baseColorTexture", Slot::BaseColor, "")?;
        let slot = Slot::MetallicRoughness;
        take(&of, "metallicRoughnessTexture", slot, "")?;
    }
    take(at, "occlusionTexture", Slot::Occlusion, "strength")?;
    material.unlit = at.extension("KHR_materials_unlit")?.is_some();
    let strength = match at.extension("KHR_materials_emissive_strength")? {
        Some(of) => {
            let given = of.number("emissiveStrength")?.unwrap_or(1.0);
            within(&of, "emissiveStrength", given, 0.0, f64::INFINITY, odd)
        }
        None => 1.0,
    };
    let emission = at.numbers::<3>("emissiveFactor")?.unwrap_or([0.0; 3]);
    material.emission = emission.map(|e| strength * within(at, "emissiveFactor", e, 0.0, 1.0, odd));
    take_seen(&mut slots, at, "emissiveTexture", Slot::Emission, textures, material.emission != [0.0; 3])?;
    Ok(MaterialSource { odd: std::mem::take(odd), ..agree_on_uvs(material, slots) })
}

/// The scene has two sets of UVs a vertex: the slots that read a third, or one of the two turned or scaled otherwise, are
/// left out.
fn agree_on_uvs(mut material: Material, mut slots: Vec<SlotUse>) -> MaterialSource {
    let leader =
        |of: &dyn Fn(&&SlotUse) -> bool| slots.iter().filter(of).min_by_key(|s| s.slot as usize).map(|s| s.uvs);
    let first = leader(&|_| true).unwrap_or(Uvs::PLAIN);
    let second = leader(&|s| s.uvs != first).unwrap_or(first);
    let all = slots.len();
    let fits = |s: &SlotUse| s.uvs == first || s.uvs == second;
    if slots.iter().any(|s| s.slot == Slot::Emission && !fits(s)) {
        // The factor alone would glow all over.
        material.emission = [0.0; 3];
    }
    slots.retain(fits);
    for s in slots.iter().filter(|s| s.uvs != first) {
        material.second_uvs |= 1 << s.slot.map();
    }
    MaterialSource { material, uvs: [first, second], dropped: all - slots.len(), slots, odd: Vec::new() }
}

/// Four numbers of 0..1, 1 where absent.
fn color(of: &At, key: &str, odd: &mut Vec<String>) -> Result<[f32; 4], Fault> {
    let given = of.numbers::<4>(key)?.unwrap_or([1.0; 4]);
    Ok(given.map(|c| within(of, key, c, 0.0, 1.0, odd)))
}

/// A number of 0..1.
pub(super) fn unit(of: &At, key: &str, default: f64, odd: &mut Vec<String>) -> Result<f32, Fault> {
    Ok(within(of, key, of.number(key)?.unwrap_or(default), 0.0, 1.0, odd))
}

/// A value brought into its range, which is said where it was outside.
pub(super) fn within(of: &At, key: &str, value: f64, least: f64, most: f64, odd: &mut Vec<String>) -> f32 {
    let taken = value.clamp(least, most).min(f64::from(f32::MAX));
    if taken != value {
        odd.push(format!("{}: {value} makes no sense; {taken} is taken", of.place(key)));
    }
    taken as f32
}

/// Takes a texture for its slot where it multiplies something. It is checked where it does not, too: a reference that leads
/// nowhere is a fault of the file.
pub(super) fn take_seen(
    slots: &mut Vec<SlotUse>,
    of: &At,
    key: &str,
    slot: Slot,
    textures: usize,
    seen: bool,
) -> Result<(), Fault> {
    let found = read_slot(of, key, slot, "", textures)?;
    slots.extend(found.filter(|_| seen));
    Ok(())
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
