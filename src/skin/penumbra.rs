//! What a diffusion profile makes of a shadow's edge (Penner & Borshukov 2011): S(u, c), the scattered visibility of a point of
//! a plane, from the share `u` of a disc around it that the light reaches, and the cosine `c` to the light.
//!
//! A hard shadow does not tell how far away its edge is; the lit share of a disc does, as long as the edge is straight:
//! u = F(x / R) at distance x from it, F the share of a unit disc beyond a chord ([`disc_share`]). On the surface the distance is
//! x / c. There a step, blurred by a Gaussian of variance v along one axis (the other is the edge's own), is
//! Phi(x / (c sqrt v)), so S = sum w Phi. What lies beyond the disc is not seen: S is stretched to reach 0 and 1 at its ends,
//! a stretch that vanishes where the disc is at least six sigma wide.
//!
//! The GLSL twin is `penumbra_look_up` in `glsl/common/penumbra.glsl`.

use super::profile::{Gaussian, Profile};
use half::f16;
use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// Texels across (lit share) and down (cosine).
pub const SIZE: [u32; 2] = [256, 32];

/// The disc's width in sigmas of the widest Gaussian. NVIDIA FaceWorks calls six ideal, for edges that are straight; on a face
/// they are not, and a wide disc takes the nose for the shadow of the cheek: on a scanned head close up, 64 taps, .0110 rms
/// at 1, .0113 at 2, .0124 at 3, .0138 at 6, .0131 with hard shadows, red best at 2.
pub const WIDTH_SIGMAS: f64 = 1.5;

/// Diameter of the disc for a profile, mm.
pub fn width_mm(profile: &Profile) -> f64 {
    WIDTH_SIGMAS * profile.gaussians().gaussians.iter().map(|g| g.variance.sqrt()).fold(0., f64::max)
}

/// Share of a unit disc on the near side of a chord at `x` from its centre, -1..1 (clamped): 0 at -1, 1 at 1.
pub fn disc_share(x: f64) -> f64 {
    let x = x.clamp(-1., 1.);
    0.5 + (x * (1. - x * x).sqrt() + x.asin()) / PI
}

/// Where that share is `u`, 0..1: the inverse, to 1e-15.
pub fn disc_place(u: f64) -> f64 {
    let (mut low, mut high) = (-1., 1.);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if disc_share(middle) < u { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// S per channel for a disc of `width_mm`; `u` and `cosine` in 0..1. At cosine 0 the edge's penumbra is endless: a step.
pub fn exact(gaussians: &[Gaussian], width_mm: f64, u: f64, cosine: f64) -> [f64; 3] {
    let radius = 0.5 * width_mm;
    let at = |x: f64| {
        let mut sum = [0.; 3];
        for g in gaussians {
            let sigma = g.variance.sqrt() * cosine.max(0.);
            let step = if sigma > 0. || x != 0. { phi(x / sigma) } else { 0.5 };
            (0..3).for_each(|c| sum[c] += g.weight[c] * step);
        }
        sum
    };
    let (here, first, last) = (at(radius * disc_place(u)), at(-radius), at(radius));
    std::array::from_fn(|c| if last[c] > first[c] { (here[c] - first[c]) / (last[c] - first[c]) } else { u })
}

/// The table as it is uploaded: RGBA16F, row by row from cosine 0.
pub fn table(profile: &Profile, width_mm: f64) -> Vec<f16> {
    let gaussians = profile.gaussians().gaussians;
    let place = |i: u32, n: u32| f64::from(i) / f64::from(n - 1);
    let texel = |x: u32, y: u32| {
        let [r, g, b] = exact(&gaussians, width_mm, place(x, SIZE[0]), place(y, SIZE[1]));
        [r, g, b, 1.].map(f16::from_f64)
    };
    (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).flat_map(move |x| texel(x, y)).collect::<Vec<_>>()).collect()
}

/// The normal distribution function.
fn phi(x: f64) -> f64 {
    0.5 * libm::erfc(-x * FRAC_1_SQRT_2)
}
