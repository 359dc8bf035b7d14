//! shadow: meshes -> shadow. One depth-only pass a layer: one a directional or spot light, six a point light.

use crate::frame::setup::Setup;
use crate::frame::shadows::spares;
use crate::frame::uniforms::MAX_LAYERS;
use crate::gpu::pipeline::Raster;
use crate::plan::{Geometry, Plan};
use crate::{shaders, targets};
use ash::vk;

/// Adds the passes.
pub fn add(plan: &mut Plan, s: &Setup) {
    plan.once("shadow", |plan| all(plan, s));
}

fn all(plan: &mut Plan, s: &Setup) {
    layers(plan, s, |plan, name, layer, state| {
        let depth = Some(("shadow".to_owned(), Some(layer), 0.));
        plan.raster(name, &shaders::SHADOW_VERT, None, state, Vec::new(), depth, Geometry::Depth).push(&layer);
    });
}

/// Declares the maps, and has a pass added for each of their layers: its name, its layer, its state.
pub fn layers(plan: &mut Plan, s: &Setup, pass: impl Fn(&mut Plan, &str, u32, Raster)) {
    let layers = s.shadows.matrices.len() as u32;
    if layers == 0 {
        plan.leave_out("shadow", s.shadows.why_none, 0).back = spares(&s.settings).filter(|_| s.shadows.far > 0);
        return;
    }
    if s.shadows.far > 0 {
        let bytes = 4 * u64::from(s.shadows.size).pow(2);
        plan.leave_out(&format!("shadow maps of {} lights", s.shadows.far), "they reach nothing", bytes).back =
            spares(&s.settings);
    }
    if s.shadows.beyond > 0 {
        let why = format!("{MAX_LAYERS} shadow layers are the limit: these lights shine through");
        plan.leave_out(&format!("shadows of {} lights", s.shadows.beyond), why, 0);
    }
    let format = targets::describe("shadow").map_or(vk::Format::D32_SFLOAT, |t| t.format);
    plan.image_as("shadow", format, [s.shadows.size; 2], layers);
    for layer in 0..layers {
        let state = Raster {
            depth: format,
            compare: vk::CompareOp::GREATER,
            // Slope bias away from the light (reversed depth); the rest is the receiver's normal offset.
            bias: Some((-1., 0.)),
            streams: vec![(0, vk::Format::R32G32B32_SFLOAT)],
            ..Raster::default()
        };
        let name = if layers == 1 { "shadow".to_owned() } else { format!("shadow{layer}") };
        pass(plan, &name, layer, state);
    }
}
