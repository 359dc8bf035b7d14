//! light: G-buffer, blurred levels, table, shadow -> ldr or exr. The only stage that knows a
//! method from another. Tone mapping reads its own pixel alone, so it is part of this dispatch.

use super::{tiles, transmittance};
use crate::frame::setup::Setup;
use crate::frame::uniforms::MAX_LEVELS;
use crate::plan::Plan;
use crate::settings::{Method, Spared, View};
use crate::shaders;

const STRIDES: [&str; MAX_LEVELS] = ["STRIDE0", "STRIDE1", "STRIDE2", "STRIDE3", "STRIDE4", "STRIDE5"];
const SOFT: [&str; MAX_LEVELS] = ["soft0", "soft1", "soft2", "soft3", "soft4", "soft5"];
const SOFTLIT: [&str; MAX_LEVELS] = ["softlit0", "softlit1", "softlit2", "softlit3", "softlit4", "softlit5"];

/// Adds the pass, where the picture is a lit one.
pub fn add(plan: &mut Plan, s: &Setup) {
    if !s.lit_view() {
        return;
    }
    let method = if s.diffuses { s.settings.method } else { Method::Lambert };
    let shader = match method {
        Method::Pdss => &shaders::LIGHT_PDSS,
        Method::Moments => &shaders::LIGHT_MOMENTS,
        Method::Wrap => &shaders::LIGHT_WRAP,
        _ => &shaders::LIGHT_LAMBERT,
    };
    let levels = s.levels.levels.len();
    // `moments` finds that light in the light's own view.
    let gaussians = if matches!(method, Method::Pdss | Method::Wrap) { transmittance::said(plan, s) } else { 0 };
    tiles::background(plan, s);
    // What a shared slot holds does not tell one light's shadow, which gloss and irradiance ask for.
    let alone = s.settings.view == View::Irradiance || s.glossy;
    let look_up = s.shadows.look_up() || s.shadows.shared() && alone;
    let pass = plan
        .compute("light", shader, tiles::surface())
        .constant("OUTPUT", s.lit_output())
        .constant("OWN", u32::from(s.is_further()))
        .constant("LOOK_UP", u32::from(look_up))
        .constant("SLOTS", u32::from(s.shadows.slots > 0))
        .constant("CURVE", s.tone_curve())
        .constant("AO", u32::from(s.ao))
        .constant("AMBIENT", u32::from(s.ambient))
        .constant("LEVELS", levels as u32)
        .constant("STRIDED", u32::from(s.levels.levels.iter().any(|l| l.stride > 1)))
        .bind("normal", s.shading_normal())
        .bind("picture", s.picture());
    if matches!(method, Method::Pdss | Method::Wrap) {
        pass.constant("GAUSSIANS", gaussians).constant("THICKEST", s.thickest_mm.to_bits());
    }
    if method == Method::Moments {
        pass.constant("MASS", u32::from(s.mass)).constant("FIRST", s.levels.first_gathered());
        pass.constant("LOOSE", u32::from(s.shadows.scattered() < s.lights as usize));
        if !s.mass {
            pass.absent("mass");
        }
    }
    s.specialise_lights(pass);
    s.specialise_facets(pass, look_up);
    s.specialise_sky(pass);
    s.specialise_gloss(pass);
    for i in 0..MAX_LEVELS {
        if i < levels {
            pass.constant(STRIDES[i], s.levels.levels[i].stride);
        } else {
            pass.absent(SOFT[i]);
        }
        if i >= levels || s.shadows.slots == 0 {
            pass.absent(SOFTLIT[i]);
        }
    }
    if s.shadows.slots == 0 {
        pass.absent("lit");
    }
    let (none, read) = (s.shadows.matrices.is_empty(), look_up || gaussians > 0);
    let bound = read || s.settings.brings_back(Spared::ShadowMap);
    if none || !bound {
        pass.bind("shadow", "no shadow");
    }
    if !none && !bound {
        let why = "every light that casts has been looked up by visibility: other images may lie there";
        plan.leave_out("shadow while light runs", why, 0).back = Some(Spared::ShadowMap);
    }
}
