//! overlay: meshes, shadow -> exr. Emission, unlit and blended materials, over the lit picture.

use super::gbuffer::{self, Extra};
use crate::frame::setup::Setup;
use crate::gpu::pipeline::Raster;
use crate::plan::{Geometry, Plan};
use crate::shaders;
use ash::vk;

/// Adds the pass, where some material needs it.
pub fn add(plan: &mut Plan, s: &Setup) {
    if s.overlay.draws.is_empty() {
        if s.lit_view() {
            plan.leave_out("overlay", "no material is blended, unlit, or gives off light", 0);
        }
        return;
    }
    // What the picture shows is there already: equal depth passes.
    let state = Raster {
        compare: vk::CompareOp::GREATER_OR_EQUAL,
        over: true,
        ..gbuffer::state(s, &[s.picture()], Extra::None)
    };
    let colors = vec![(s.picture().to_owned(), None)];
    let depth = Some(("depth".to_owned(), None, 0.));
    let vertex = gbuffer::vertex(s, Extra::None);
    let pass = plan
        .raster("overlay", vertex, Some(&shaders::OVERLAY_FRAG), state, colors, depth, Geometry::Overlay)
        .constant("TINT", u32::from(s.colors))
        .constant("SHADOWS", u32::from(!s.shadows.matrices.is_empty()))
        .constant("AMBIENT", u32::from(s.ambient));
    s.specialise_lights(pass);
    s.specialise_sky(pass);
    s.specialise_gloss(pass);
    if s.shadows.matrices.is_empty() {
        pass.bind("shadow", "no shadow");
    }
}
