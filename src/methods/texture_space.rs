//! Texture-space diffusion (d'Eon, Luebke & Enderton 2007; d'Eon & Luebke 2007): irradiance is drawn over the texture
//! coordinates, blurred there by a cascade of Gaussians whose widths follow how the coordinates stretch, and read back.

use crate::frame::setup::Setup;
use crate::plan::Plan;
use crate::settings::{Quality, Settings};
use crate::skin::profile::{Gaussian, Profile, fewer};
use crate::stages::{combine, entrance, gather, gbuffer, irradiance, layer, sheets, tiles, unwrap};

/// The frame.
pub fn frame(p: &mut Plan, s: &Setup) {
    entrance::add(p, s); //   meshes                          -> shadow entrance
    unwrap::add(p, s); //     meshes shadow                   -> sheet0 stretch
    sheets::add(p, s); //     sheet0 stretch                  -> sheet1..
    gbuffer::add(p, s); //    meshes                          -> viewz normal albedo material chart bumped
    layer::add(p, s); //      viewz                           -> viewz of each, of several profiles
    tiles::add(p, s); //      viewz                           -> tile lists
    irradiance::add(p, s); // G-buffer shadow                 -> irradiance reflected
    gather::add(p, s); //     viewz normal chart irradiance sheets shadow entrance -> scattered
    combine::add(p, s); //    G-buffer scattered reflected    -> ldr or exr
}

/// Side of a sheet in texels, most Gaussians, and taps a sigma. High is the chapter's: 2048, six, and seven taps one sigma apart
/// (GPU Gems 3, chapter 14); below it halves the side and merges Gaussians, above it doubles the side and the taps.
pub fn effort(quality: Quality) -> (u32, usize, u32) {
    match quality {
        Quality::Low => (512, 3, 1),
        Quality::Medium => (1024, 4, 1),
        Quality::High => (2048, 6, 1),
        Quality::Ultra => (4096, 6, 2),
    }
}

/// How far the taps of the widest Gaussian reach, mm.
pub fn reach_mm(profile: &Profile) -> f64 {
    3. * profile.gaussians().gaussians.iter().map(|g| g.variance.sqrt()).fold(0., f64::max)
}

/// A Gaussian narrower than this many texels is not told from a point.
const LEAST_SIGMA_TEXELS: f64 = 0.5;

/// Entry 0 holds the weight of what neither a texel of `texel_mm` nor a pixel can tell from a point, the others a Gaussian
/// each: weight, and the sigma (mm) that its pair of passes adds to the pair before.
pub fn kernel(settings: &Settings, profile: &Profile, least_sigma_mm: f64, texel_mm: f64) -> Vec<[f64; 4]> {
    let least = least_sigma_mm.max(LEAST_SIGMA_TEXELS * texel_mm);
    let few = fewer(&profile.gaussians().gaussians, effort(settings.quality).1, least.powi(2));
    let (narrow, wide): (Vec<Gaussian>, Vec<Gaussian>) = few.into_iter().partition(|g| g.variance.sqrt() < least);
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
