//! irradiance: G-buffer, shadow -> irradiance, reflected. For methods that scatter light itself.

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
    let lit = s.settings.view == View::Final;
    plan.image("irradiance", s.size);
    if s.glossy {
        plan.image("reflected", s.size);
    } else if lit {
        plan.leave_out("reflected", "no material reflects anything", 8 * s.pixels());
    }
    let pass = plan
        .compute("irradiance", &shaders::IRRADIANCE, tiles::surface())
        .constant("FINAL", u32::from(lit))
        .constant("SHADOWS", u32::from(!s.shadows.matrices.is_empty()))
        .constant("AMBIENT", u32::from(lit && s.ambient))
        .constant("PRE", u32::from(s.pre_textured()))
        .bind("normal", s.shading_normal());
    s.specialise_lights(pass);
    s.specialise_facets(pass, true);
    s.specialise_sky(pass);
    s.specialise_gloss(pass);
    if !s.glossy {
        pass.absent("reflected");
    }
    if s.shadows.matrices.is_empty() {
        pass.bind("shadow", "no shadow");
    }
}
