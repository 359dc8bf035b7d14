//! gaussians: viewz, irradiance -> scattered. A pair of passes a Gaussian of the profile.

use super::tiles;
use crate::frame::setup::Setup;
use crate::plan::{Domain, Plan};
use crate::settings::View;
use crate::shaders;

/// Adds the passes, where the picture shows scattered light.
pub fn add(plan: &mut Plan, s: &Setup) {
    if !s.lit_view() || s.settings.view == View::Irradiance {
        return;
    }
    for name in ["scattered", "across", "down"] {
        plan.image(name, s.size);
    }
    let mut source = "irradiance";
    for step in 1..s.kernel.len() as u32 {
        plan.compute(&format!("gaussians{step} across"), &shaders::GAUSSIANS_ACROSS, Domain::Tiles(tiles::scatter(1)))
            .constant("STEP", step)
            .bind("source", source)
            .bind("target", "across");
        // The first starts the sum, with what is narrower than a pixel.
        let down = if step == 1 { &shaders::GAUSSIANS_FIRST } else { &shaders::GAUSSIANS_DOWN };
        plan.compute(&format!("gaussians{step} down"), down, Domain::Tiles(tiles::scatter(1)))
            .constant("STEP", step)
            .bind("source", "across")
            .bind("target", "down");
        source = "down";
    }
}
