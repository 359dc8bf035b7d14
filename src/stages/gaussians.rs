//! gaussians: viewz, irradiance -> scattered. A pair of passes a Gaussian of the profile.
//!
//! The authors take seven taps a pass, a sigma apart. Ultra takes thirteen, half a sigma apart: what lies between two taps of a
//! wide Gaussian is then seen too.

use super::tiles;
use crate::frame::setup::Setup;
use crate::plan::Plan;
use crate::settings::{Quality, View};
use crate::shaders;

/// Adds the passes, where the picture shows scattered light.
pub fn add(plan: &mut Plan, s: &Setup) {
    if !s.lit_view() || s.settings.view == View::Irradiance {
        return;
    }
    for name in ["scattered", "across", "down"] {
        plan.image(name, s.size);
    }
    let (half, spacing) = if s.settings.quality == Quality::Ultra { (6, 0.5f32) } else { (3, 1.) };
    let mut source = "irradiance";
    for step in 1..s.kernel.len() as u32 - s.behind {
        plan.compute(&format!("gaussians{step} across"), &shaders::GAUSSIANS_ACROSS, tiles::scattering(1))
            .constant("STEP", step)
            .constant("HALF", half)
            .constant("SPACING", spacing.to_bits())
            .bind("source", source)
            .bind("target", "across");
        // The first starts the sum, with what is narrower than a pixel.
        let down = if step == 1 { &shaders::GAUSSIANS_FIRST } else { &shaders::GAUSSIANS_DOWN };
        plan.compute(&format!("gaussians{step} down"), down, tiles::scattering(1))
            .constant("STEP", step)
            .constant("HALF", half)
            .constant("SPACING", spacing.to_bits())
            .bind("source", "across")
            .bind("target", "down");
        source = "down";
    }
}
