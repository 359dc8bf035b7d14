//! Separable subsurface scattering (Jimenez et al. 2015): irradiance is blurred by one pair of passes, red, green and blue at
//! once; light that passes through thin parts is added before (Jimenez et al. 2010).

use crate::frame::setup::Setup;
use crate::plan::Plan;
use crate::settings::{Quality, SeparableKernel, Settings};
use crate::skin::profile::Profile;
use crate::skin::separable::{of_authors, of_profile};
use crate::stages::{combine, gbuffer, irradiance, layer, separable, shadow, tiles, transmittance};

/// The frame.
pub fn frame(p: &mut Plan, s: &Setup) {
    shadow::add(p, s); //        meshes                          -> shadow
    gbuffer::add(p, s); //       meshes                          -> viewz normal albedo material bumped
    layer::add(p, s); //         viewz                           -> viewz of each, of several profiles
    tiles::add(p, s); //         viewz                           -> tile lists
    irradiance::add(p, s); //    G-buffer shadow                 -> irradiance reflected
    transmittance::add(p, s); // viewz normal albedo shadow      -> irradiance
    separable::add(p, s); //     viewz irradiance                -> scattered
    combine::add(p, s); //       G-buffer scattered reflected    -> ldr or exr
}

/// Taps of a pass. The authors' code has 11, 17 and 25, for 720p and for low to high quality at 1080p.
fn taps(quality: Quality) -> u32 {
    match quality {
        Quality::Low => 11,
        Quality::Medium => 17,
        Quality::High => 25,
        Quality::Ultra => 49,
    }
}

/// Rows of the kernel that are taps.
pub fn tap_rows(quality: Quality) -> u32 {
    taps(quality) / 2 + 1
}

/// The taps of one side, the centre first: weight, offset in mm.
pub fn kernel(settings: &Settings, profile: &Profile) -> Vec<[f64; 4]> {
    let (gaussians, taps) = (profile.gaussians().gaussians, taps(settings.quality));
    let widest = gaussians.iter().map(|g| g.variance.sqrt()).fold(0., f64::max);
    let row = match settings.separable_kernel {
        SeparableKernel::Profile => of_profile(&gaussians, taps),
        SeparableKernel::Authors => of_authors(widest, taps),
    };
    let four = |[r, g, b]: [f64; 3], w: f64| [r, g, b, w];
    row.iter().map(|t| four(t.weight, t.offset_mm)).collect()
}
