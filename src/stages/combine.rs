//! combine: viewz, normal, albedo, material, irradiance, scattered, reflected -> ldr or exr. The end of every method that
//! scatters light itself.

use super::tiles;
use crate::frame::setup::Setup;
use crate::plan::Plan;
use crate::settings::View;
use crate::shaders;

/// Adds the pass, where the picture is a lit one.
pub fn add(plan: &mut Plan, s: &Setup) {
    if !s.lit_view() {
        return;
    }
    let view = s.settings.view;
    tiles::background(plan, s);
    let pass = plan
        .compute("combine", &shaders::COMBINE, tiles::surface())
        .constant("OUTPUT", s.lit_output())
        .constant("OWN", u32::from(s.is_further()))
        .constant("PRE", u32::from(s.pre_textured()))
        .constant("CURVE", s.tone_curve())
        .bind("normal", s.shading_normal())
        .bind("picture", s.picture());
    s.specialise_gloss(pass);
    if !s.glossy {
        pass.absent("reflected");
    }
    if view == View::Irradiance {
        pass.absent("scattered");
    }
}
