//! What a file says of a surface's gloss beside roughness: KHR_materials_specular, KHR_materials_clearcoat, KHR_materials_sheen.

use super::json::At;
use super::materials::{Slot, SlotUse, take_seen, unit, within};
use crate::scene::error::Fault;
use crate::scene::material::{Coat, Material, Sheen, Specular};

/// Factors into the material, textures into the slots. Values that make no sense are said in `odd`.
pub(super) fn read(
    at: &At,
    material: &mut Material,
    slots: &mut Vec<SlotUse>,
    textures: usize,
    odd: &mut Vec<String>,
) -> Result<(), Fault> {
    let mut take = |of: &At, key, slot, seen| take_seen(slots, of, key, slot, textures, seen);
    if let Some(of) = at.extension("KHR_materials_specular")? {
        let factor = unit(&of, "specularFactor", 1.0, odd)?;
        let color = of.numbers::<3>("specularColorFactor")?.unwrap_or([1.0; 3]);
        let color = color.map(|c| within(&of, "specularColorFactor", c, 0.0, f64::INFINITY, odd));
        material.specular = Specular { factor, color, ..material.specular };
        take(&of, "specularTexture", Slot::Specular, factor > 0.0)?;
        take(&of, "specularColorTexture", Slot::SpecularColor, factor > 0.0 && color != [0.0; 3])?;
    }
    if let Some(of) = at.extension("KHR_materials_clearcoat")? {
        let factor = unit(&of, "clearcoatFactor", 0.0, odd)?;
        let roughness = unit(&of, "clearcoatRoughnessFactor", 0.0, odd)?;
        material.coat = Coat { factor, roughness, ..Coat::default() };
        take(&of, "clearcoatTexture", Slot::Coat, factor > 0.0)?;
        take(&of, "clearcoatRoughnessTexture", Slot::CoatRoughness, factor > 0.0 && roughness > 0.0)?;
        if of.object("clearcoatNormalTexture")?.is_some() && factor > 0.0 {
            odd.push(format!("{}: not read; the coat is as smooth as the mesh", of.place("clearcoatNormalTexture")));
        }
    }
    if let Some(of) = at.extension("KHR_materials_sheen")? {
        let color = of.numbers::<3>("sheenColorFactor")?.unwrap_or([0.0; 3]);
        let color = color.map(|c| within(&of, "sheenColorFactor", c, 0.0, 1.0, odd));
        let roughness = unit(&of, "sheenRoughnessFactor", 0.0, odd)?;
        material.sheen = Sheen { color, roughness, ..Sheen::default() };
        let seen = color != [0.0; 3];
        take(&of, "sheenColorTexture", Slot::Sheen, seen)?;
        take(&of, "sheenRoughnessTexture", Slot::SheenRoughness, seen && roughness > 0.0)?;
    }
    Ok(())
}
