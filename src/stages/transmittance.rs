//! transmittance: viewz, normal, albedo, shadow, irradiance -> irradiance. Light through thin parts.

use super::tiles;
use crate::frame::setup::Setup;
use crate::plan::Plan;
use crate::settings::{Transmittance, View};
use crate::shaders;

/// How many of the profile's Gaussians let light through from behind: all, where it is asked for and a shadow map or a file says
/// how thick things are.
///
/// # Errors
/// Why none does.
pub fn gaussians(s: &Setup) -> Result<u32, &'static str> {
    match s.settings.through() {
        Transmittance::Off => Err("transmittance is off"),
        _ if s.settings.view == View::Irradiance => Err("the view shows light as it arrives"),
        _ if s.shadows.matrices.is_empty() && s.thickest_mm == 0. => Err(s.shadows.why_none),
        _ => Ok(s.behind),
    }
}

/// The same; why there is none is said in the plan.
pub fn said(plan: &mut Plan, s: &Setup) -> u32 {
    gaussians(s).unwrap_or_else(|why| {
        plan.leave_out("transmittance", why, 0);
        0
    })
}

/// Adds the pass, where the picture shows scattered light and a shadow map says how thick things are.
pub fn add(plan: &mut Plan, s: &Setup) {
    let gaussians = if s.lit_view() { said(plan, s) } else { 0 };
    if gaussians == 0 {
        return;
    }
    let pass = plan
        .compute("transmittance", &shaders::TRANSMITTANCE, tiles::scattering(1))
        .constant("FIRST_GAUSSIAN", s.kernel.len() as u32 - gaussians)
        .constant("GAUSSIANS", gaussians)
        .constant("SLAB", u32::from(s.settings.through() == Transmittance::Slab))
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
