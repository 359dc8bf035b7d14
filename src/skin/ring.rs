//! The ring integral of Penner & Borshukov 2011, in the literal reading and in the one that conserves a cylinder.
//!
//! D(theta, r) = Int cos+(theta + x) R(2 r |sin(x/2)|) dx / Int R(2 r |sin(x/2)|) dx over a turn. For a Gaussian the
//! kernel is exp(-k (1 - cos x)), k = r^2 / v: a von Mises density, as wide as k^-1/2. Sampled uniformly it falls
//! between the samples as soon as k exceeds their number squared: 0/0 in f32, or, with a sample at x = 0, a silent and
//! right-looking max(0, cos theta). Here every Gaussian gets Gauss-Legendre panels on its own window, split at the
//! terminator, so no radius is stiff.

use super::profile::Gaussian;
use super::quadrature::integrate;
use super::sphere::sharpness;
use std::f64::consts::{FRAC_1_PI, PI, TAU};

/// What the ring's one-dimensional integral is given as R.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reading {
    /// The 2-D profile as published in 2011. In a 1-D integral a Gaussian's share becomes w / sigma, not w: too sharp,
    /// the red of six-Gaussian skin is 3.6 times too dark at the terminator.
    Literal2011,
    /// Each Gaussian integrated along the cylinder's axis first, w / sqrt(2 pi v): exact for an endless cylinder lit
    /// across its axis, up to 16 % too much energy on small spheres.
    OneDimensional,
}

/// exp(-37) is below half a last bit of 1.
const NEGLIGIBLE: f64 = 37.0;
/// Stands for variance 0, mm^2, where the literal reading's w / sigma would be infinite.
const LEAST_VARIANCE: f64 = 1e-60;

/// Mean of max(0, cos(theta + x)) for x von Mises distributed, density exp(k cos x); `mu` = cos theta.
///
/// `mu` in -1..1 (clamped), `k` = r^2 / v in 0..=infinity (a negative one counts as 0). k = 0 gives 1 / pi and
/// k = infinity max(0, mu), both to the bit. Absolute error below 1e-13. NaN gives NaN.
pub fn von_mises(mu: f64, k: f64) -> f64 {
    Lobe::new(k).at(mu)
}

/// Exitance of the ring of radius `radius_mm` at cosine `mu`, per channel, divided by the kernel's mass on the ring.
///
/// `radius_mm` >= 0 (its sign is ignored); any value, 0 and infinity included, has its limit. A channel without any
/// weight gives 0. In the literal reading this is the ring as published, to 1e-13.
pub fn exitance(mu: f64, radius_mm: f64, gaussians: &[Gaussian], reading: Reading) -> [f64; 3] {
    Mixture::new(radius_mm, gaussians, reading).at(mu)
}

/// [`exitance`] at one radius: what does not depend on mu, computed once.
pub(super) struct Mixture(Vec<(Lobe, [f64; 3])>);

impl Mixture {
    pub(super) fn new(radius_mm: f64, gaussians: &[Gaussian], reading: Reading) -> Mixture {
        let mut total = [0.0; 3];
        let mut lobes = Vec::with_capacity(gaussians.len());
        for g in gaussians {
            let lobe = Lobe::new(sharpness(radius_mm, g.variance));
            let variance = g.variance.max(LEAST_VARIANCE);
            // Per unit of arc length; a common factor of the radius is dropped, so a plane is no special case.
            let height = match reading {
                Reading::Literal2011 => 1.0 / (TAU * variance),
                Reading::OneDimensional => 1.0 / (TAU * variance).sqrt(),
            };
            // At infinite k the kernel's mass over the angle is sqrt(2 pi / k) = sqrt(2 pi v) / r.
            let arc = if lobe.k < 1e200 { lobe.mass * lobe.k.sqrt() } else { TAU.sqrt() };
            let share = g.weight.map(|w| w * height * arc * variance.sqrt());
            (0..3).for_each(|c| total[c] += share[c]);
            lobes.push((lobe, share));
        }
        for (_, share) in &mut lobes {
            *share = std::array::from_fn(|c| if total[c] > 0.0 { share[c] / total[c] } else { 0.0 });
        }
        Mixture(lobes)
    }

    pub(super) fn at(&self, mu: f64) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for (lobe, share) in &self.0 {
            let value = lobe.at(mu);
            (0..3).for_each(|c| sum[c] += share[c] * value);
        }
        sum
    }
}

/// The density exp(k cos x) on the circle.
struct Lobe {
    k: f64,
    /// Int exp(-k (1 - cos x)) dx over a turn.
    mass: f64,
    /// I_1(k) / I_0(k).
    mean_cosine: f64,
}

impl Lobe {
    fn new(k: f64) -> Lobe {
        let k = if k < 0.0 { 0.0 } else { k };
        if k == 0.0 || k == f64::INFINITY {
            return Lobe { k, mass: if k == 0.0 { TAU } else { 0.0 }, mean_cosine: if k == 0.0 { 0.0 } else { 1.0 } };
        }
        let density = |x: f64| (-k * one_minus_cos(x)).exp();
        let mass = 2.0 * integrate(0.0, window(k), density);
        // 1 - cos x is summed, not cos x, for the sake of sharp lobes.
        let missing = 2.0 * integrate(0.0, window(k), |x| one_minus_cos(x) * density(x));
        Lobe { k, mass, mean_cosine: 1.0 - missing / mass }
    }

    /// [`von_mises`] for this k.
    fn at(&self, mu: f64) -> f64 {
        if mu.is_nan() || self.k.is_nan() {
            return f64::NAN;
        }
        let mu = mu.clamp(-1.0, 1.0);
        if self.k == f64::INFINITY {
            mu.max(0.0)
        } else if self.k == 0.0 {
            FRAC_1_PI
        } else {
            // max(0, x) = x + max(0, -x): only the far side needs an integral of its own.
            mu.max(0.0) * self.mean_cosine + self.far_side(mu.abs().asin()) / self.mass
        }
    }

    /// The numerator for a point `depth` radians (0..pi/2) behind the terminator.
    fn far_side(&self, depth: f64) -> f64 {
        let w = window(self.k);
        let density = |x: f64| (-self.k * one_minus_cos(x)).exp();
        // Lit where the ring is turned towards the light by `depth` to `depth` + pi: up to half a turn that way ...
        let near = integrate(depth, w, |x| (x - depth).sin() * density(x));
        // ... and beyond half a turn, which is the last `depth` radians of the other way.
        near + integrate(PI - depth, w, |x| -(x + depth).sin() * density(x))
    }
}

/// Half-width beyond which exp(-k (1 - cos x)) is negligible; at most half a turn.
fn window(k: f64) -> f64 {
    2.0 * (0.5 * NEGLIGIBLE / k).sqrt().min(1.0).asin()
}

/// 1 - cos x without cancellation.
fn one_minus_cos(x: f64) -> f64 {
    let s = (0.5 * x).sin();
    2.0 * s * s
}
