//! Burley's normalised diffusion by a disc of samples (Christensen & Burley 2015; Golubev 2018): irradiance is gathered from
//! points that are drawn as light spreads, weighted by how far they really are, in one pass.

use crate::frame::setup::Setup;
use crate::plan::Plan;
use crate::settings::Quality;
use crate::skin::burley::{fit_d, inverse_cdf};
use crate::skin::profile::{MAX_RADIUS_ENERGY, Profile};
use crate::stages::{burley, combine, gbuffer, irradiance, layer, shadow, tiles, transmittance};

/// The frame.
pub fn frame(p: &mut Plan, s: &Setup) {
    shadow::add(p, s); //        meshes                          -> shadow
    gbuffer::add(p, s); //       meshes                          -> viewz normal albedo material bumped
    layer::add(p, s); //         viewz                           -> viewz of each, of several profiles
    tiles::add(p, s); //         viewz                           -> tile lists
    irradiance::add(p, s); //    G-buffer shadow                 -> irradiance reflected
    transmittance::add(p, s); // viewz normal albedo shadow      -> irradiance
    burley::add(p, s); //        viewz irradiance                -> scattered
    combine::add(p, s); //       G-buffer scattered reflected    -> ldr or exr
}

/// Samples of a pixel at most: 20, 40 and 80 are the budgets of Unity's HDRP, which has no fourth.
pub fn budget(quality: Quality) -> u32 {
    match quality {
        Quality::Low => 20,
        Quality::Medium => 40,
        Quality::High => 80,
        Quality::Ultra => 320,
    }
}

/// Burley's distance of each channel, mm, and of the widest one; the radius that holds .997 of the widest one's energy, mm.
pub fn kernel(profile: &Profile) -> Vec<[f64; 4]> {
    let [r, g, b] = fit_d(profile);
    let widest = r.max(g).max(b);
    vec![[r, g, b, widest], [widest * inverse_cdf(MAX_RADIUS_ENERGY), 0., 0., 0.]]
}
