//! sheets: sheet0, stretch -> sheet1... A pair of passes over texture coordinates for each Gaussian of the profile.

use super::seams;
use crate::frame::setup::Setup;
use crate::methods::texture_space;
use crate::plan::{Domain, Plan};
use crate::settings::View;
use crate::shaders;

/// Adds the passes, where the picture shows scattered light.
pub fn add(plan: &mut Plan, s: &Setup) {
    if !s.lit_view() || s.settings.view == View::Irradiance {
        return;
    }
    let (side, _, fine) = texture_space::effort(s.settings.quality);
    let size = [side; 2];
    for name in ["sheetacross", "stretchacross"] {
        plan.image(name, size);
    }
    if s.kernel.len() > 1 {
        seams::add(plan, s, "sheet0");
    }
    for step in 1..s.kernel.len() as u32 {
        let (source, target) = (format!("sheet{}", step - 1), format!("sheet{step}"));
        plan.image(&target, size);
        plan.compute(&format!("sheet{step} across"), &shaders::SHEETS_ACROSS, Domain::Threads(size))
            .constant("STEP", step)
            .constant("FINE", fine)
            .bind("source", source)
            .bind("target", "sheetacross")
            .bind("target_stretch", "stretchacross");
        seams::add(plan, s, "sheetacross");
        plan.compute(&format!("sheet{step} down"), &shaders::SHEETS_DOWN, Domain::Threads(size))
            .constant("STEP", step)
            .constant("FINE", fine)
            .bind("source", "sheetacross")
            .bind("stretch", "stretchacross")
            .bind("target", target.as_str())
            .bind("target_stretch", "stretch");
        if step + 1 < s.kernel.len() as u32 {
            seams::add(plan, s, &target);
        }
    }
}
