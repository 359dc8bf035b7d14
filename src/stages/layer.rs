//! layer: viewz -> viewz of one profile. Only where several profiles scatter: each has stages of its own from here on, and to
//! each the others' surface is one that does not scatter.

use crate::frame::setup::Setup;
use crate::plan::{Domain, Plan, of_profile};
use crate::shaders;

/// Adds the pass, if there are several profiles.
pub fn add(plan: &mut Plan, s: &Setup) {
    let Some(k) = plan.profile else {
        if s.scatters {
            plan.leave_out("layer", "one profile: nobody asks by which a surface scatters", 4 * s.pixels());
        }
        return;
    };
    plan.image("viewz", s.size);
    // It reads the viewz that all share.
    plan.shared(|plan| {
        plan.compute(&of_profile("layer", k), &shaders::LAYER, Domain::Threads(s.size))
            .constant("PROFILE", k as u32)
            .bind("own", of_profile("viewz", k));
    });
}
