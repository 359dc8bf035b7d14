//! burley: viewz, irradiance -> scattered. One pass over a disc of samples.

use super::tiles;
use crate::frame::setup::Setup;
use crate::methods::burley::budget;
use crate::plan::Plan;
use crate::settings::View;
use crate::shaders;

/// Adds the pass, where the picture shows scattered light.
pub fn add(plan: &mut Plan, s: &Setup) {
    if !s.lit_view() || s.settings.view == View::Irradiance {
        return;
    }
    plan.image("scattered", s.size);
    plan.compute("burley", &shaders::BURLEY, tiles::scattering(1)).constant("BUDGET", budget(s.settings.quality));
}
