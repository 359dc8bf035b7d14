//! separable: viewz, irradiance -> scattered. One pair of passes.

use super::tiles;
use crate::frame::setup::Setup;
use crate::methods::separable::tap_rows;
use crate::plan::Plan;
use crate::settings::View;
use crate::shaders;

/// Adds the passes, where the picture shows scattered light.
pub fn add(plan: &mut Plan, s: &Setup) {
    if !s.lit_view() || s.settings.view == View::Irradiance {
        return;
    }
    let passes = [
        ("separable across", &shaders::SEPARABLE_ACROSS, "irradiance", "across"),
        ("separable down", &shaders::SEPARABLE_DOWN, "across", "scattered"),
    ];
    for (name, shader, source, target) in passes {
        plan.image(target, s.size);
        plan.compute(name, shader, tiles::scattering(1))
            .constant("ROWS", tap_rows(s.settings.quality))
            .constant("WIDEST", (s.levels.length_mm as f32).to_bits())
            .bind("source", source)
            .bind("target", target);
    }
}
