//! What a file says of the inside of a material: KHR_materials_volume with KHR_materials_volume_scatter (both spellings of its
//! colour), KHR_materials_scatter, or KHR_materials_diffuse_transmission.

use super::json::At;
use super::materials::{Slot, SlotUse, take_seen, unit, within};
use crate::scene::error::Fault;
use crate::scene::material::{Material, Scattering};

/// Whether light passes into a material, and how it goes on there where the file gives lengths. Values that make no sense are
/// said in `odd`.
pub(super) fn read(at: &At, mm_per_unit: f64, odd: &mut Vec<String>) -> Result<(bool, Option<Scattering>), Fault> {
    let through = at.extension("KHR_materials_diffuse_transmission")?;
    let diffuse = match &through {
        Some(t) => t.number("diffuseTransmissionFactor")?.is_some_and(|part| part > 0.0),
        None => false,
    };
    let volume_scatter = at.extension("KHR_materials_volume_scatter")?;
    let scatter = match at.extension("KHR_materials_scatter")? {
        Some(s) => Some(s.number("scatterStrengthFactor")?.unwrap_or(0.0)).filter(|s| *s > 0.0).map(|_| s),
        None => None,
    };
    let translucent = diffuse || volume_scatter.is_some() || scatter.is_some();
    let Some(volume) = at.extension("KHR_materials_volume")?.filter(|_| translucent) else {
        return Ok((translucent, None));
    };
    let mut color = |of: &At, key: &str, given: [f64; 3]| given.map(|c| f64::from(within(of, key, c, 0.0, 1.0, odd)));
    let attenuation = volume.numbers::<3>("attenuationColor")?.unwrap_or([1.0; 3]);
    let attenuation = color(&volume, "attenuationColor", attenuation);
    let (multiscatter, anisotropy) = match (&volume_scatter, &scatter, &through) {
        (Some(of), ..) | (None, Some(of), _) => {
            // The draft's first spelling, and its second.
            let key = if of.keys().any(|k| k == "multiscatterColor") {
                "multiscatterColor"
            } else {
                "multiscatterColorFactor"
            };
            let default = if volume_scatter.is_some() { 0.0 } else { 1.0 };
            let given = of.numbers::<3>(key)?.unwrap_or([default; 3]);
            let g = of.number("scatterAnisotropy")?.unwrap_or(0.0);
            (color(of, key, given), f64::from(within(of, "scatterAnisotropy", g, -0.99, 0.99, odd)))
        }
        (None, None, Some(of)) => {
            let key = "diffuseTransmissionColorFactor";
            (color(of, key, of.numbers::<3>(key)?.unwrap_or([1.0; 3])), 0.0)
        }
        (None, None, None) => return Ok((translucent, None)),
    };
    // Absent, light goes on for ever: nothing to make a profile from.
    let Some(distance) = volume.number("attenuationDistance")? else { return Ok((translucent, None)) };
    let distance_mm = distance * mm_per_unit;
    let clear = attenuation.iter().any(|c| *c >= 1.0);
    if !(distance_mm > 0.0 && distance_mm.is_finite()) || clear {
        let what = if clear { "attenuationColor" } else { "attenuationDistance" };
        let place = volume.place(what);
        odd.push(format!("{place}: light goes on for ever in a channel, or nowhere; the profile is not made from it"));
        return Ok((translucent, None));
    }
    Ok((translucent, Some(Scattering { distance_mm, attenuation, multiscatter, anisotropy })))
}

/// Where a material scatters, and how thick it is: KHR_materials_diffuse_transmission's factor, KHR_materials_volume's
/// thickness, and the textures of both.
pub(super) fn read_inside(
    at: &At,
    material: &mut Material,
    mm_per_unit: f64,
    slots: &mut Vec<SlotUse>,
    textures: usize,
    odd: &mut Vec<String>,
) -> Result<(), Fault> {
    let mut take = |of: &At, key, slot, seen| take_seen(slots, of, key, slot, textures, seen);
    if let Some(of) = at.extension("KHR_materials_diffuse_transmission")? {
        material.scatter_mask = unit(&of, "diffuseTransmissionFactor", 0.0, odd)?;
        take(&of, "diffuseTransmissionTexture", Slot::ScatterMask, material.scatter_mask > 0.0)?;
    }
    if let Some(of) = at.extension("KHR_materials_volume")? {
        let given = of.number("thicknessFactor")?.unwrap_or(0.0) * mm_per_unit;
        material.thickness_mm = within(&of, "thicknessFactor", given, 0.0, f64::INFINITY, odd);
        take(&of, "thicknessTexture", Slot::Thickness, material.thickness_mm > 0.0)?;
    }
    Ok(())
}
