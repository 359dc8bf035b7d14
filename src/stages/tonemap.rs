//! tonemap: hdr -> ldr.

use super::tiles;
use crate::frame::setup::{Output, Setup};
use crate::plan::{Domain, Plan};
use crate::settings::ToneMap;
use crate::shaders;

/// Adds the pass, unless the picture stays linear.
pub fn add(plan: &mut Plan, s: &Setup) {
    if s.output == Output::Linear {
        plan.leave_out("tonemap", "the picture is kept linear", 4 * s.pixels());
        return;
    }
    let curve = u32::from(s.settings.tone_map == ToneMap::Linear);
    plan.compute("tonemap", &shaders::TONEMAP, Domain::Tiles(tiles::SURFACE)).constant("CURVE", curve);
}
