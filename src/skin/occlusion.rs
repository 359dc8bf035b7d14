//! Ambient occlusion from curvature: how much cosine-weighted sky a concave patch hides from its own points.
//!
//! Occlusion O = 1 - V in 0..1, occluders within a distance R. Only concave curvature hides anything; a saddle counts
//! with its concave direction alone. All of it is local: separate objects, and shapes that are not their own
//! quadric within R, are not seen. Curvatures are in 1/mm, convex positive; R in mm.
//!
//! With a hard cutoff, and for small curvature, O = R^2 (3 H^2 - K) / 8 when both principal curvatures are concave:
//! (H R)^2 / 4 in a bowl, 3/8 (H R)^2 in a trough. A cutoff f that fades with distance t is a mean of hard ones over
//! shorter radii, Int -f'(u) O(u R) du, which gives the factors 1/2 and 1/3 and the saturation below.

use super::quadrature::integrate;
use std::f64::consts::{FRAC_PI_2, PI};

/// Occlusion radius of a blurred level in sigmas of its blur.
pub const RADIUS_SIGMAS: f64 = 3.0;

/// How an occluder at distance t counts within the occlusion radius R.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Falloff {
    /// In full up to R. Small-curvature factor 1.
    Hard,
    /// 1 - (t/R)^2. Factor 1/2.
    Quadratic,
    /// 1 - t/R. Factor 1/3.
    Linear,
}

/// How the occlusions of several blur levels become one visibility.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Combine {
    /// V = product of (1 - w O): levels hide independently. They do not: what is near is within every radius.
    Product,
    /// V = 1 - max of w O: nothing is counted twice. What the renderer does.
    Max,
}

/// Occlusion in a spherical bowl of curvature `curvature` (negative: concave), exact for every radius.
///
/// With c = |curvature| R / 2: hard min(1, c)^2; quadratic c^2/2, from c = 1 on 1 - 1/(2c^2); linear c^2/3, then 1 -
/// 2/(3c).
pub fn bowl(curvature: f64, radius_mm: f64, falloff: Falloff) -> f64 {
    let c = 0.5 * (-curvature).max(0.0) * radius_mm;
    saturate(c * c, falloff)
}

/// Occlusion at the bottom of a trough, a cylinder seen from inside; `curvature` is that across it (H is half of it).
///
/// Exact for every radius to 1e-9: (2/pi) Int sin^2 a (1 - sqrt(1 - min(1, c sin a)^2)) da over 0..pi, with a the angle
/// from the axis. Small curvature: 3 c^2 / 8.
pub fn trough(curvature: f64, radius_mm: f64, falloff: Falloff) -> f64 {
    let c = 0.5 * (-curvature).max(0.0) * radius_mm;
    if c == 0.0 || c.is_nan() {
        return 0.0;
    }
    match falloff {
        Falloff::Hard => hard_trough(c),
        // The kink at c u = 1, where the far wall comes into reach, ends a panel.
        Falloff::Quadratic => fade(c, |u| 2.0 * u * hard_trough(c * u)),
        Falloff::Linear => fade(c, |u| hard_trough(c * u)),
    }
}

/// Occlusion of a patch of mean curvature `mean` (1/mm) and Gaussian curvature `gauss` (1/mm^2), saturating at 1.
///
/// With a, b the concave parts of the principal curvatures: q = R^2 (3a^2 + 3b^2 + 2ab) / 32, which is R^2 (3H^2 - K)/8
/// where both are concave, put through the bowl's own saturation. Exact for a bowl at every R and for every patch as
/// H R -> 0; in a trough too small by .035 at most up to |k| R = 1.5 and by .2 at |k| R = 2, where the far wall appears.
pub fn patch(mean: f64, gauss: f64, radius_mm: f64, falloff: Falloff) -> f64 {
    // H^2 < K is no surface, only noise: it reads as an umbilic.
    let spread = (mean * mean - gauss).max(0.0).sqrt();
    let (a, b) = ((spread - mean).max(0.0), (-spread - mean).max(0.0));
    saturate(radius_mm * radius_mm * (3.0 * (a * a + b * b) + 2.0 * a * b) / 32.0, falloff)
}

/// Occlusion from mean curvature alone: 5/16 (H R)^2, midway between bowl (1/4) and trough (3/8), saturating at 1.
pub fn from_mean(mean: f64, radius_mm: f64, falloff: Falloff) -> f64 {
    let hr = (-mean).max(0.0) * radius_mm;
    saturate(5.0 / 16.0 * hr * hr, falloff)
}

/// Visibility in 0..1 from several levels' (weight 0..1, occlusion 0..1). No level: 1.
pub fn combine(levels: &[(f64, f64)], how: Combine) -> f64 {
    let shares = levels.iter().map(|&(weight, occlusion)| (weight * occlusion).clamp(0.0, 1.0));
    match how {
        Combine::Product => shares.map(|o| 1.0 - o).product(),
        Combine::Max => 1.0 - shares.fold(0.0, f64::max),
    }
}

/// A bowl's occlusion by its hard, unsaturated one, q = c^2.
fn saturate(q: f64, falloff: Falloff) -> f64 {
    let within = q <= 1.0;
    match falloff {
        Falloff::Hard => q.min(1.0),
        Falloff::Quadratic if within => q / 2.0,
        Falloff::Quadratic => 1.0 - 0.5 / q,
        Falloff::Linear if within => q / 3.0,
        Falloff::Linear => 1.0 - 2.0 / (3.0 * q.sqrt()),
    }
}

/// The trough's integral with a hard cutoff, c = |k| R / 2.
fn hard_trough(c: f64) -> f64 {
    // 1 - sqrt(1 - s^2) = s^2 / (1 + sqrt(1 - s^2)) keeps its digits at small s.
    let slice = |a: f64| {
        let s2 = (c * a.sin()).powi(2).min(1.0);
        a.sin().powi(2) * s2 / (1.0 + (1.0 - s2).sqrt())
    };
    // Beyond the angle where the whole slice is out of sight the root is 0; it starts there like a square root.
    let full = if c > 1.0 { (1.0 / c).asin() } else { FRAC_PI_2 };
    let part = integrate(0.0, 1.0, |t| 2.0 * t * full * slice(full * (1.0 - t * t)));
    4.0 / PI * (part + integrate(full, FRAC_PI_2, slice))
}

/// Int f(u) du over 0..1, split where c u = 1 and refined towards that kink from both sides.
fn fade(c: f64, mut f: impl FnMut(f64) -> f64) -> f64 {
    let kink = (1.0 / c).min(1.0);
    let below = integrate(0.0, 1.0, |t| 2.0 * t * kink * f(kink * (1.0 - t * t)));
    below + integrate(0.0, 1.0, |t| 2.0 * t * (1.0 - kink) * f(kink + (1.0 - kink) * t * t))
}
