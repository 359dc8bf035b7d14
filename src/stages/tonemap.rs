//! tonemap: exr -> ldr. A stage of its own only where something is drawn over what lighting wrote.

use crate::frame::setup::{Output, Setup};
use crate::plan::{Domain, Plan};
use crate::settings::ToneMap;
use crate::shaders;

/// Adds the pass, where the picture is an 8-bit one that lighting could not finish.
pub fn add(plan: &mut Plan, s: &Setup) {
    if s.overlay.draws.is_empty() || s.output == Output::Linear {
        return;
    }
    plan.image("ldr", s.size);
    plan.compute("tonemap", &shaders::TONEMAP, Domain::Threads(s.size))
        .constant("CURVE", u32::from(s.settings.tone_map == ToneMap::Linear));
}
