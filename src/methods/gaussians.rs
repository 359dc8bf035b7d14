//! Screen-space diffusion by a sum of Gaussians (Jimenez, Sundstedt & Gutierrez 2009; Jimenez & Gutierrez 2010): irradiance is
//! blurred by a separable pair of passes for each Gaussian of the profile, and the results are weighted per channel.

use crate::frame::setup::Setup;
use crate::plan::Plan;
use crate::skin::profile::Profile;
use crate::stages::{combine, gaussians, gbuffer, irradiance, shadow, tiles};

/// The frame.
pub fn frame(p: &mut Plan, s: &Setup) {
    shadow::add(p, s); //     meshes                          -> shadow
    gbuffer::add(p, s); //    meshes                          -> viewz normal albedo material bumped
    tiles::add(p, s); //      viewz                           -> tile lists
    irradiance::add(p, s); // G-buffer shadow                 -> irradiance reflected
    gaussians::add(p, s); //  viewz irradiance                -> scattered
    combine::add(p, s); //    G-buffer scattered reflected    -> ldr or exr
}

/// Entry 0 holds the weight of what no pixel can tell from a point, the others a Gaussian each: weight, and the sigma (mm)
/// that its pair of passes adds to the pair before.
pub fn kernel(profile: &Profile, least_sigma_mm: f64) -> Vec<[f64; 4]> {
    let mut gaussians = profile.gaussians().gaussians;
    gaussians.sort_by(|a, b| a.variance.total_cmp(&b.variance));
    let mut entries = vec![[0.; 4]];
    let mut before = 0.;
    for g in gaussians {
        if g.variance.sqrt() < least_sigma_mm {
            (0..3).for_each(|c| entries[0][c] += g.weight[c]);
        } else {
            let [r, green, b] = g.weight;
            entries.push([r, green, b, (g.variance - before).sqrt()]);
            before = g.variance;
        }
    }
    entries
}
