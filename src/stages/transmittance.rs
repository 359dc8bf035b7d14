//! transmittance: viewz, normal, albedo, shadow, irradiance -> irradiance. Light through thin parts.

use super::tiles;
use crate::frame::setup::Setup;
use crate::methods::separable::tap_rows;
use crate::plan::Plan;
use crate::settings::{Transmittance, View};
use crate::shaders;

/// Whether light through thin parts is asked for, and a shadow map or a file says how thick they are.
///
/// # Errors
/// Why not.
pub fn measures(s: &Setup) -> Result<(), &'static str> {
    match s.settings.through() {
        Transmittance::Off => Err("transmittance is off"),
        _ if s.shadows.matrices.is_empty() && s.thickest_mm == 0. => Err(s.shadows.why_none),
        _ => Ok(()),
    }
}

/// Adds the pass, where the picture shows scattered light and a shadow map says how thick things are.
pub fn add(plan: &mut Plan, s: &Setup) {
    if !s.lit_view() || s.settings.view == View::Irradiance {
        return;
    }
    if let Err(why) = measures(s) {
        plan.leave_out("transmittance", why, 0);
        return;
    }
    let (offset, widen): (f32, f32) = match s.settings.through() {
        Transmittance::Slab => (0., 2.),
        _ => (0.3, 1.),
    };
    let first = tap_rows(s.settings.quality).min(s.kernel.len() as u32);
    let pass = plan
        .compute("transmittance", &shaders::TRANSMITTANCE, tiles::scattering(1))
        .constant("FIRST", first)
        .constant("GAUSSIANS", s.kernel.len() as u32 - first)
        .constant("OFFSET", offset.to_bits())
        .constant("WIDEN", widen.to_bits())
        .constant("PRE", u32::from(s.pre_textured()))
        .constant("MASKED", u32::from(s.masked))
        .constant("THICKEST", s.thickest_mm.to_bits())
        .bind("normal", s.shading_normal());
    s.specialise_lights(pass);
    if s.thickest_mm == 0. {
        pass.absent("coat");
    }
    if s.shadows.matrices.is_empty() {
        pass.bind("shadow", "no shadow");
    }
}
