//! sparse: shadow, inert -> sparse. The shadow maps of the lights with a slot, a texel in so many, small enough for a cache: what wide
//! levels gather from.

use crate::frame::setup::Setup;
use crate::plan::{Domain, Plan};
use crate::{shaders, targets};
use ash::vk;

/// Adds the pass, where light is gathered.
pub fn add(plan: &mut Plan, s: &Setup) {
    if !s.mass {
        return;
    }
    let (side, layers) = (s.shadows.size / s.sparse_step, s.shadows.slotted_layers());
    let format = targets::describe("sparse").map_or(vk::Format::R32_SFLOAT, |t| t.format);
    plan.image_as("sparse", format, [side; 2], layers);
    let pass = plan
        .compute("sparse", &shaders::SPARSE, Domain::Threads([side, side * layers]))
        .constant("STEP", s.sparse_step)
        .constant("INERT", u32::from(s.inert));
    if !s.inert {
        pass.bind("inert", "no shadow");
    }
}
