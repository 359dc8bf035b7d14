//! gather: viewz, normal, chart, irradiance, sheets, shadow, entrance -> scattered. What texture space has diffused, back on the
//! screen.

use super::{entrance, tiles};
use crate::frame::setup::Setup;
use crate::plan::Plan;
use crate::settings::{Transmittance, View};
use crate::shaders;

/// Names that the shader has for sheets; a profile is at most six Gaussians.
pub const SHEETS: [&str; 6] = ["sheet1", "sheet2", "sheet3", "sheet4", "sheet5", "sheet6"];

/// Adds the pass, where the picture shows scattered light.
pub fn add(plan: &mut Plan, s: &Setup) {
    if !s.lit_view() || s.settings.view == View::Irradiance {
        return;
    }
    plan.image("scattered", s.size);
    let levels = s.kernel.len() - 1;
    let through = entrance::wanted(s);
    let shader = if through { &shaders::GATHER_THROUGH } else { &shaders::GATHER_PLAIN };
    let pass = plan
        .compute("gather", shader, tiles::scattering(1))
        .constant("LEVELS", levels as u32)
        .constant("SHEET_BORDER", s.border.to_bits());
    if through {
        pass.constant("SLAB", u32::from(s.settings.through() == Transmittance::Slab));
        pass.constant("THICKEST", s.thickest_mm.to_bits());
        if s.thickest_mm == 0. {
            pass.absent("coat");
        }
        s.specialise_lights(pass);
    }
    for name in SHEETS.into_iter().skip(levels) {
        pass.absent(name);
    }
}
