//! light: G-buffer, blurred levels, table, shadow -> hdr (or exr). The only stage that knows a method from another.

use super::tiles;
use crate::frame::setup::{Output, Setup};
use crate::frame::uniforms::MAX_LEVELS;
use crate::plan::{Domain, Plan};
use crate::settings::{Method, View};
use crate::shaders;

const STRIDES: [&str; MAX_LEVELS] = ["STRIDE0", "STRIDE1", "STRIDE2", "STRIDE3", "STRIDE4", "STRIDE5"];
const SOFT: [&str; MAX_LEVELS] = ["soft0", "soft1", "soft2", "soft3", "soft4", "soft5"];
const SOFTLIT: [&str; MAX_LEVELS] = ["softlit0", "softlit1", "softlit2", "softlit3", "softlit4", "softlit5"];

/// Adds the pass.
pub fn add(plan: &mut Plan, s: &Setup) {
    let method = if s.levels.levels.is_empty() { Method::Lambert } else { s.settings.method };
    let shader = match method {
        Method::Lambert => &shaders::LIGHT_LAMBERT,
        Method::Pdss => &shaders::LIGHT_PDSS,
        Method::Moments => &shaders::LIGHT_MOMENTS,
    };
    let target = if s.output == Output::Linear { "exr" } else { "hdr" };
    plan.image(target, s.size);
    let output = match s.settings.view {
        View::Scatter => 1,
        View::Irradiance => 2,
        View::Ao => 3,
        _ => 0,
    };
    let levels = if method == Method::Lambert { 0 } else { s.levels.levels.len() };
    let pass = plan
        .compute("light", shader, Domain::Tiles(tiles::SURFACE))
        .constant("OUTPUT", output)
        .constant("SHADOWS", u32::from(!s.shadows.matrices.is_empty()))
        .constant("SLOTS", u32::from(s.shadows.slots > 0))
        .constant("SPECULAR", 1)
        .constant("AO", u32::from(s.ao))
        .constant("AMBIENT", u32::from(s.ambient))
        .constant("LEVELS", levels as u32)
        .constant("STRIDED", u32::from(s.levels.levels.iter().any(|l| l.stride > 1)))
        .bind("normal", s.shading_normal())
        .bind("hdr", target);
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
    if s.shadows.matrices.is_empty() {
        pass.bind("shadow", "no shadow");
    }
}
