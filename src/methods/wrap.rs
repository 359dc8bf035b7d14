//! Wrap lighting that conserves energy (McAuley; Hill 2011), the cheapest plausible choice: the clamped cosine is stretched beyond
//! the terminator by what a sphere of the surface's own curvature scatters. No blur and no table: one stage more than `lambert`.

use crate::frame::setup::Setup;
use crate::plan::Plan;
use crate::skin::burley::fit_d;
use crate::skin::profile::Profile;
use crate::stages::{curvature, gbuffer, layer, light, shadow, tiles};

/// The frame.
pub fn frame(p: &mut Plan, s: &Setup) {
    shadow::add(p, s); //    meshes                 -> shadow
    gbuffer::add(p, s); //   meshes                 -> viewz normal albedo material bumped
    layer::add(p, s); //     viewz                  -> viewz of each, of several profiles
    tiles::add(p, s); //     viewz                  -> tile lists
    curvature::add(p, s); // viewz normal           -> curvature
    light::add(p, s); //     G-buffer curvature     -> ldr or exr
}

/// Burley's distance of each channel, mm.
pub fn kernel(profile: &Profile) -> Vec<[f64; 4]> {
    let [r, g, b] = fit_d(profile);
    vec![[r, g, b, r.max(g).max(b)]]
}
