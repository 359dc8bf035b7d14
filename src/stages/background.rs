//! background: viewz or depth, sky -> ldr or exr, where no surface is.

use crate::frame::setup::Setup;
use crate::plan::{Domain, Plan};
use crate::shaders;

/// Adds the pass, where a sky is drawn behind the scene. Forward methods have no viewz; their depth buffer says the same.
pub fn add(plan: &mut Plan, s: &Setup) {
    if !s.background {
        return;
    }
    let shader = if plan.has("viewz") { &shaders::BACKGROUND_SCREEN } else { &shaders::BACKGROUND_FORWARD };
    plan.compute("background", shader, Domain::Threads(s.size))
        .constant("CURVE", s.tone_curve())
        .bind("picture", s.picture());
}
