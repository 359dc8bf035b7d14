//! inert: meshes that do not scatter -> inert. Small depth maps, from the lights with a slot: what is nearest there is not gathered.

use crate::frame::setup::Setup;
use crate::frame::uniforms::InertPush;
use crate::gpu::pipeline::Raster;
use crate::plan::{Geometry, Plan};
use crate::{shaders, targets};
use ash::vk;

/// Adds the passes, where light is gathered from maps that hold more than what scatters.
pub fn add(plan: &mut Plan, s: &Setup) {
    if !s.mass {
        return;
    }
    let (side, layers) = (s.shadows.size / s.sparse_step, s.shadows.slotted_layers());
    if !s.inert {
        plan.leave_out("inert", "everything that casts a shadow scatters", 4 * u64::from(side * side * layers));
        return;
    }
    let format = targets::describe("inert").map_or(vk::Format::D32_SFLOAT, |t| t.format);
    plan.image_as("inert", format, [side; 2], layers);
    for layer in 0..layers {
        let state = Raster {
            depth: format,
            compare: vk::CompareOp::GREATER,
            streams: vec![(0, vk::Format::R32G32B32_SFLOAT)],
            ..Raster::default()
        };
        let name = if layers == 1 { "inert".to_owned() } else { format!("inert{layer}") };
        let depth = Some(("inert".to_owned(), Some(layer), 0.));
        plan.raster(&name, &shaders::INERT_VERT, None, state, Vec::new(), depth, Geometry::Inert)
            .push(&InertPush { layer, shift: 1. / s.shadows.size as f32 });
    }
}
