//! entrance: meshes -> shadow, entrance. Shadow maps that also say at which texture coordinate light enters (modified translucent
//! shadow maps, d'Eon & Luebke 2007).

use super::shadow;
use crate::frame::setup::Setup;
use crate::plan::{Geometry, Plan};
use crate::settings::{Transmittance, View};
use crate::{shaders, targets};
use ash::vk;

/// Whether light is followed through thin parts.
pub fn wanted(s: &Setup) -> bool {
    s.lit_view()
        && s.settings.view != View::Irradiance
        && s.settings.through() != Transmittance::Off
        && !s.shadows.matrices.is_empty()
        && s.kernel.len() > 1
}

/// Adds the passes; plain shadow maps where light does not go through.
pub fn add(plan: &mut Plan, s: &Setup) {
    plan.once("entrance", |plan| all(plan, s));
}

fn all(plan: &mut Plan, s: &Setup) {
    if !wanted(s) {
        let why =
            if s.shadows.matrices.is_empty() { s.shadows.why_none } else { "nothing shows light that went through" };
        plan.leave_out("entrance", why, 0);
        shadow::add(plan, s);
        return;
    }
    let format = |name: &str| targets::describe(name).map_or(vk::Format::UNDEFINED, |t| t.format);
    plan.image_as("entrance", format("entrance"), [s.shadows.size; 2], s.shadows.matrices.len() as u32);
    shadow::layers(plan, s, |plan, name, layer, state| {
        let state = crate::gpu::pipeline::Raster {
            colors: vec![format("entrance")],
            streams: vec![(0, vk::Format::R32G32B32_SFLOAT), (1, vk::Format::R32G32B32_SFLOAT), (2, s.uv_format())],
            ..state
        };
        let colors = vec![("entrance".to_owned(), Some([u32::MAX; 4]))];
        let depth = Some(("shadow".to_owned(), Some(layer), 0.));
        let (vertex, fragment) = (&shaders::ENTRANCE_VERT, &shaders::ENTRANCE_FRAG);
        plan.raster(name, vertex, Some(fragment), state, colors, depth, Geometry::Casters).constant("LAYER", layer);
    });
}
