//! visibility: viewz, normal, facet, shadow -> lit. Apart from `light`, because the blur scatters it.

use super::tiles;
use crate::frame::setup::Setup;
use crate::plan::Plan;
use crate::shaders;

/// Adds the pass, if a light has a slot.
pub fn add(plan: &mut Plan, s: &Setup) {
    if s.shadows.slots == 0 {
        plan.leave_out("visibility", "no shadow to scatter", 4 * s.pixels());
        return;
    }
    plan.image("lit", s.size);
    let shader = if s.detail { &shaders::VISIBILITY_GEO } else { &shaders::VISIBILITY_PLAIN };
    if s.detail {
        plan.image("litgeo", s.size);
    }
    let pass = plan.compute("visibility", shader, tiles::surface());
    s.specialise_lights(pass.bind("normal", s.shading_normal()));
    s.specialise_facets(pass, true);
}
