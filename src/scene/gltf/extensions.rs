//! Which versions and extensions are understood, which may be passed over with a word, and which stop the reading.

use super::json::At;
use crate::scene::error::Fault;

/// Read and obeyed.
const SUPPORTED: [&str; 19] = [
    "EXT_meshopt_compression",
    "EXT_texture_webp",
    "KHR_draco_mesh_compression",
    "KHR_lights_punctual",
    "KHR_materials_clearcoat",
    "KHR_materials_diffuse_transmission",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_scatter",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_unlit",
    "KHR_materials_volume",
    "KHR_materials_volume_scatter",
    "KHR_mesh_quantization",
    "KHR_meshopt_compression",
    "KHR_texture_basisu",
    "KHR_texture_transform",
];
/// Carry nothing that a still picture shows.
const HARMLESS: [&str; 4] = ["KHR_animation_pointer", "KHR_xmp", "KHR_xmp_json_ld", "EXT_mesh_features"];

/// Refuses versions other than 2.0.
pub(super) fn check_version(root: &At) -> Result<(), Fault> {
    let asset = root.required(root.object("asset")?, "asset")?;
    let version = asset.required(asset.text("version")?, "version")?;
    if version.split('.').next() != Some("2") {
        return Err(Fault::new("asset.version", format!("'{version}' is not supported; glTF 2.0 is")));
    }
    match asset.text("minVersion")? {
        Some(least) if least != "2.0" => {
            Err(Fault::new("asset.minVersion", format!("the file needs glTF {least}; 2.0 is supported")))
        }
        _ => Ok(()),
    }
}

/// Refuses required extensions without which the file would be misread; returns a word on those passed over.
pub(super) fn check_extensions(root: &At) -> Result<Vec<String>, Fault> {
    // Appearance only: the plain metallic-roughness material stands in.
    let cosmetic = |name: &str| name.starts_with("KHR_materials_") || HARMLESS.contains(&name);
    let mut refused = Vec::new();
    let mut ignored = Vec::new();
    for name in root.texts("extensionsRequired")? {
        if SUPPORTED.contains(&name) {
        } else if cosmetic(name) {
            ignored.push(name);
        } else {
            refused.push(name);
        }
    }
    if !refused.is_empty() {
        return Err(Fault::new(
            "extensionsRequired",
            format!("{} not supported; save the file again without it", refused.join(", ")),
        ));
    }
    for name in root.texts("extensionsUsed")? {
        if !SUPPORTED.contains(&name) && !ignored.contains(&name) {
            ignored.push(name);
        }
    }
    if ignored.is_empty() {
        return Ok(Vec::new());
    }
    Ok(vec![format!("extensions ignored: {}", ignored.join(", "))])
}
