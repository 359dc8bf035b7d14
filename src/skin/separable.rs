//! Kernels of one separable pair of passes (Jimenez et al. 2015): a row of taps, the same along both axes.
//!
//! Taps lie at o^2 / range, o uniform: dense where a profile is steep. What weighs them is either of two:
//!
//! - [`of_profile`]: the profile's integral along a line, the paper's pre-integrated kernel, against the hat of each tap: exact
//!   for light that is linear between taps and changes along one axis only. Energy is exact at any number of taps.
//! - [`of_authors`]: the constants of the authors' own code, a skin profile of five Gaussians, tinted by a falloff and a strength
//!   a channel. Evaluated at the taps and weighted by the gap around each.
//!
//! A product of two rows is round only for a single Gaussian: what a point of light becomes has the shape of a cross.

use super::moments::rectified;
use super::profile::Gaussian;
use std::f64::consts::TAU;

/// A tap on one side; the first is the centre, the others are there twice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tap {
    /// Distance from the centre, mm, >= 0.
    pub offset_mm: f64,
    /// Weight per channel of this tap alone.
    pub weight: [f64; 3],
}

/// Range of the authors' kernel, mm: for more than 20 taps, and for fewer.
const AUTHORS_RANGE_MM: [f64; 2] = [3., 2.];
/// Sigma of the widest Gaussian of the skin that the authors' constants are for, mm: sqrt 7.41.
const AUTHORS_SIGMA_MM: f64 = 2.722_131_517_763_237;
/// How far a kernel of the profile reaches, in sigmas of the widest Gaussian.
const RANGE_SIGMAS: f64 = 3.;
/// Weight and variance (mm^2) of the authors' profile; the sharpest Gaussian of skin is left out as light that never entered.
const AUTHORS_PROFILE: [[f64; 2]; 5] = [[0.1, 0.0484], [0.118, 0.187], [0.113, 0.567], [0.358, 1.99], [0.078, 7.41]];
/// By how much each channel's radius is shortened.
const AUTHORS_FALLOFF: [f64; 3] = [1., 0.37, 0.3];
/// How much of each channel is scattered.
const AUTHORS_STRENGTH: [f64; 3] = [0.48, 0.41, 0.28];

/// Distances of one side's taps, the centre first.
fn offsets(taps: u32, range: f64) -> Vec<f64> {
    let half = (taps / 2).max(1);
    (0..=half).map(|i| range * (f64::from(i) / f64::from(half)).powi(2)).collect()
}

/// The kernel of a sum of Gaussians whose weights sum to 1 in each channel. `taps` is odd, 3 or more.
pub fn of_profile(gaussians: &[Gaussian], taps: u32) -> Vec<Tap> {
    let widest = gaussians.iter().map(|g| g.variance.sqrt()).fold(0., f64::max);
    if widest == 0. {
        return vec![Tap { offset_mm: 0., weight: [1.; 3] }];
    }
    let at = offsets(taps, RANGE_SIGMAS * widest);
    // Against hats the integral is a second difference of Int (t - o) G(t) dt over t > o, which is E max(0, X - o).
    let slope = |g: &Gaussian, i: usize| {
        let (sigma, gap) = (g.variance.sqrt(), at[i + 1] - at[i]);
        (rectified(-at[i], sigma) - rectified(-at[i + 1], sigma)) / gap
    };
    let last = at.len() - 1;
    let one = |g: &Gaussian, i: usize| match i {
        0 => 1. - 2. * slope(g, 0),
        // What lies beyond the range is given to its end.
        i if i == last => slope(g, i - 1),
        i => slope(g, i - 1) - slope(g, i),
    };
    let weigh = |i: usize| std::array::from_fn(|c| gaussians.iter().map(|g| g.weight[c] * one(g, i)).sum());
    at.iter().enumerate().map(|(i, o)| Tap { offset_mm: *o, weight: weigh(i) }).collect()
}

/// The authors' kernel, stretched as `widest_sigma_mm` is to skin's 2.72 mm. `taps` is odd, 3 or more.
pub fn of_authors(widest_sigma_mm: f64, taps: u32) -> Vec<Tap> {
    let at = offsets(taps, AUTHORS_RANGE_MM[usize::from(taps <= 20)]);
    let profile = |r: f64, c: usize| -> f64 {
        let r = r / (0.001 + AUTHORS_FALLOFF[c]);
        AUTHORS_PROFILE.iter().map(|[w, v]| w * (-0.5 * r * r / v).exp() / (TAU * v)).sum()
    };
    let last = at.len() - 1;
    let gap = |i: usize| match i {
        0 => at[1],
        i if i == last => (at[i] - at[i - 1]) / 2.,
        i => (at[i + 1] - at[i - 1]) / 2.,
    };
    let raw: Vec<[f64; 3]> = (0..=last).map(|i| std::array::from_fn(|c| gap(i) * profile(at[i], c))).collect();
    let sum = |c: usize| raw[0][c] + 2. * raw[1..].iter().map(|w| w[c]).sum::<f64>();
    let weigh = |i: usize| {
        std::array::from_fn(|c| {
            let (share, strength) = (raw[i][c] / sum(c), AUTHORS_STRENGTH[c]);
            if i == 0 { 1. - strength + strength * share } else { strength * share }
        })
    };
    let stretch = widest_sigma_mm / AUTHORS_SIGMA_MM;
    at.iter().enumerate().map(|(i, o)| Tap { offset_mm: o * stretch, weight: weigh(i) }).collect()
}

/// Share of the light that passes through `thickness_mm` of material: sum of w exp(-s^2 / (`widen` v)).
///
/// As published `widen` is 1 (Jimenez et al. 2010, variances as denominators). With 2 it is the profile over distance in space,
/// integrated over the far side of a slab.
pub fn transmitted(gaussians: &[Gaussian], thickness_mm: f64, widen: f64) -> [f64; 3] {
    let mut sum = [0.; 3];
    for g in gaussians {
        let left = if thickness_mm == 0. { 1. } else { (-thickness_mm * thickness_mm / (widen * g.variance)).exp() };
        (0..3).for_each(|c| sum[c] += g.weight[c] * left);
    }
    sum
}
