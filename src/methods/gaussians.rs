//! Screen-space diffusion by a sum of Gaussians (Jimenez, Sundstedt & Gutierrez 2009; Jimenez & Gutierrez 2010): irradiance is
//! blurred by a separable pair of passes for each Gaussian of the profile, and the results are weighted per channel.

use crate::frame::setup::Setup;
use crate::plan::Plan;
use crate::settings::Quality;
use crate::skin::profile::{Profile, fewer};
use crate::stages::{combine, gaussians, gbuffer, irradiance, layer, shadow, tiles, transmittance};

/// The frame.
pub fn frame(p: &mut Plan, s: &Setup) {
    shadow::add(p, s); //        meshes                          -> shadow
    gbuffer::add(p, s); //       meshes                          -> viewz normal albedo material bumped
    layer::add(p, s); //         viewz                           -> viewz of each, of several profiles
    tiles::add(p, s); //         viewz                           -> tile lists
    irradiance::add(p, s); //    G-buffer shadow                 -> irradiance reflected
    transmittance::add(p, s); // viewz normal albedo shadow      -> irradiance
    gaussians::add(p, s); //     viewz irradiance                -> scattered
    combine::add(p, s); //       G-buffer scattered reflected    -> ldr or exr
}

/// Gaussians at most: two for skin seen from afar, four as in GPU Pro 2010, then all of the six of d'Eon & Luebke 2007.
fn most(quality: Quality) -> usize {
    match quality {
        Quality::Low => 2,
        Quality::Medium => 4,
        Quality::High | Quality::Ultra => 6,
    }
}

/// Entry 0 holds the weight of what no pixel can tell from a point, the others a Gaussian each: weight, and the sigma (mm)
/// that its pair of passes adds to the pair before.
pub fn kernel(quality: Quality, profile: &Profile, least_sigma_mm: f64) -> Vec<[f64; 4]> {
    let few = fewer(&profile.gaussians().gaussians, most(quality), least_sigma_mm.powi(2));
    let (narrow, wide): (Vec<_>, Vec<_>) = few.into_iter().partition(|g| g.variance.sqrt() < least_sigma_mm);
    let mut entries = vec![[0.; 4]];
    for g in narrow {
        (0..3).for_each(|c| entries[0][c] += g.weight[c]);
    }
    let mut before = 0.;
    for g in wide {
        let [red, green, blue] = g.weight;
        entries.push([red, green, blue, (g.variance - before).sqrt()]);
        before = g.variance;
    }
    entries
}
