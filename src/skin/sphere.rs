//! Pre-integration on a sphere lit by one distant light, unshadowed: exact, at every stiffness.
//!
//! A Gaussian of *chord* distance, exp(-c^2 / 2v), on a sphere of radius r is exp(-k (1 - cos psi)) with k = r^2 / v:
//! a von Mises-Fisher lobe of normals. So what leaves the sphere is the mean of max(0, n.l) under that lobe, a
//! function D(mu, k) of two numbers. It is computed in two ways, both free of sampling and of stiffness:
//!
//! - k <= 256: the Legendre series sum f_l A_l(k) P_l(mu), with f_l the clamped cosine's coefficients and
//!   A_l = I_{l+1/2}(k) / I_{1/2}(k) from the continued fraction of the ratios, run backwards (Miller).
//! - k > 256: the density of the one component n.l, which is analytic, in one Gauss-Legendre panel over its window.
//!
//! Both are right to 1e-14 where they meet and hold 1e-10 from k = 0 to infinity.

use super::profile::Gaussian;
use super::quadrature::{integrate, integrate_from_kink};
use std::f64::consts::PI;

/// Sharpness up to which the Legendre series is summed; it would need about 7 sqrt(k) terms.
const SERIES_UP_TO: f64 = 256.0;
/// exp(-37) is below half a last bit of 1: what lies further out in a lobe does not exist in f64.
const NEGLIGIBLE: f64 = 37.0;
/// A radius of nothing, yet one whose square is not 0: the limits come out of the formulas themselves.
const LEAST_RADIUS_MM: f64 = 1e-100;

/// Mean of max(0, n.l) for n von Mises-Fisher distributed with sharpness `k` around an axis at cosine `mu` from l.
///
/// `mu` in -1..1 (clamped), `k` = r^2 / v in 0..=infinity (a negative one counts as 0). Result in 0..1; absolute error
/// below 1e-13. k = 0 gives 1/4 (the whole sphere's mean) and k = infinity max(0, mu), both to the bit. NaN gives NaN.
pub fn vmf(mu: f64, k: f64) -> f64 {
    if mu.is_nan() || k.is_nan() {
        return f64::NAN;
    }
    let mu = mu.clamp(-1.0, 1.0);
    if k == f64::INFINITY {
        mu.max(0.0)
    } else if k <= SERIES_UP_TO {
        series(mu, k.max(0.0))
    } else {
        // max(0, x) = x + max(0, -x), and the lobe's mean of n.l is A_1 mu: only the far side needs an integral.
        mu.max(0.0) * (1.0 - 1.0 / k) + far_side(-mu.abs(), k)
    }
}

/// Exitance of a sphere of radius `radius_mm` at cosine `mu`, per channel, *with* the energy that a sphere loses.
///
/// A plane holds all of a Gaussian; a sphere of radius r holds 1 - exp(-2k) of it, so small spheres come out dark.
/// `radius_mm` >= 0 (its sign is ignored). See [`exitance_normalised`] for the quotient by that mass.
pub fn exitance(mu: f64, radius_mm: f64, gaussians: &[Gaussian]) -> [f64; 3] {
    mixture(mu, radius_mm, gaussians).0
}

/// [`exitance`] divided by the kernel's [`mass`] on that sphere: what every screen-space method approximates.
///
/// A channel without any weight gives 0. At radius 0 the limit: 1/4, unless the channel has a Gaussian of variance 0.
pub fn exitance_normalised(mu: f64, radius_mm: f64, gaussians: &[Gaussian]) -> [f64; 3] {
    let (sum, mass) = mixture(mu, radius_mm, gaussians);
    std::array::from_fn(|c| if mass[c] > 0.0 { sum[c] / mass[c] } else { 0.0 })
}

/// The share of each channel's kernel that a sphere of radius `radius_mm` holds: sum of w (1 - exp(-2 r^2 / v)).
pub fn mass(radius_mm: f64, gaussians: &[Gaussian]) -> [f64; 3] {
    let mut mass = [0.0; 3];
    for g in gaussians {
        let held = held(sharpness(radius_mm, g.variance));
        (0..3).for_each(|c| mass[c] += g.weight[c] * held);
    }
    mass
}

/// Exitance under Burley's normalised diffusion (Christensen & Burley 2015) on a sphere, divided by the kernel's mass.
///
/// The profile is (exp(-c/d) + exp(-c/3d)) / (8 pi d c) over chord distance c, and area on a sphere is 2 pi c dc, so the
/// answer depends on `mu` and `x` = d * curvature alone. `x` in 0..=infinity (a negative one counts as 0); x = 0 gives
/// max(0, mu) to the bit. Absolute error below 1e-10.
pub fn burley(mu: f64, x: f64) -> f64 {
    Burley::new(x).at(mu)
}

/// [`burley`] at one x: what does not depend on mu, computed once.
pub(super) struct Burley {
    x: f64,
    /// The chord, in radii, beyond which nothing is left of the wider exponential.
    reach: f64,
    /// Int of the two exponentials over all chords of the unit sphere, 0..2.
    mass: f64,
    /// R_1, the kernel's mean of cos psi = 1 - c^2/2.
    mean_cosine: f64,
}

impl Burley {
    pub(super) fn new(x: f64) -> Burley {
        // At 1e15 the exponentials are flat to the last bit; below 1e-14 `at` leaves them out.
        let x = if x.is_nan() { x } else { x.clamp(0.0, 1e15) };
        let mass = -x * ((-2.0 / x).exp_m1() + 3.0 * (-2.0 / (3.0 * x)).exp_m1());
        let mut lobe = Burley { x, reach: 3.0 * NEGLIGIBLE * x, mass, mean_cosine: 1.0 };
        let missing = integrate_from_kink(0.0, lobe.reach.min(2.0), |c| 0.5 * c * c * lobe.density(c));
        lobe.mean_cosine = 1.0 - missing / mass;
        lobe
    }

    pub(super) fn at(&self, mu: f64) -> f64 {
        if mu.is_nan() || self.x.is_nan() {
            return f64::NAN;
        }
        let mu = mu.clamp(-1.0, 1.0);
        // A profile of no width scatters nothing that f64 could hold.
        if self.x < 1e-14 {
            return mu.max(0.0);
        }
        // As for vmf: max(0, x) = x + max(0, -x), and the first term's mean is known.
        mu.max(0.0) * self.mean_cosine + self.far_side(mu.abs()) / self.mass
    }

    /// 2 pi c R(c) but for a constant, c in radii.
    fn density(&self, c: f64) -> f64 {
        (-c / self.x).exp() + (-c / (3.0 * self.x)).exp()
    }

    /// The numerator where the normal looks away from the light by a sine of `down` (0..1).
    fn far_side(&self, down: f64) -> f64 {
        let across = (1.0 - down * down).max(0.0).sqrt();
        // Light is first met at psi = asin(down); from pi minus that on, every azimuth is lit.
        let first = 2.0 * (0.5 * down.asin()).sin();
        let last = 2.0 * (0.5 * (PI - down.asin())).sin();
        let lit = |c: f64| {
            let cos_psi = 1.0 - 0.5 * c * c;
            let sin_psi = c * (1.0 - 0.25 * c * c).max(0.0).sqrt();
            self.density(c) * azimuth_mean(-down * cos_psi, across * sin_psi)
        };
        let end = first + self.reach;
        let middle = (0.5 * (first + last)).min(end);
        let mut sum = integrate_from_kink(first, middle, lit);
        if middle < end {
            sum += integrate_from_kink(last, middle, lit);
        }
        sum + integrate(last, end.min(2.0), |c| self.density(c) * down * (0.5 * c * c - 1.0))
    }
}

/// Mean over azimuth phi of max(0, a + b cos phi), b >= 0.
fn azimuth_mean(a: f64, b: f64) -> f64 {
    if a >= b {
        a
    } else if a <= -b {
        0.0
    } else {
        let p = (-a / b).acos();
        (a * p + b * p.sin()) / PI
    }
}

/// (sum of w (1 - e^-2k) D(mu, k), sum of w (1 - e^-2k)) per channel.
fn mixture(mu: f64, radius_mm: f64, gaussians: &[Gaussian]) -> ([f64; 3], [f64; 3]) {
    let (mut sum, mut mass) = ([0.0; 3], [0.0; 3]);
    for g in gaussians {
        let k = sharpness(radius_mm, g.variance);
        let (held, value) = (held(k), vmf(mu, k));
        for c in 0..3 {
            mass[c] += g.weight[c] * held;
            sum[c] += g.weight[c] * held * value;
        }
    }
    (sum, mass)
}

/// k = r^2 / v; a Gaussian of variance 0 is a delta, infinitely sharp on any sphere.
pub(super) fn sharpness(radius_mm: f64, variance: f64) -> f64 {
    let r = radius_mm.abs().max(LEAST_RADIUS_MM);
    if variance > 0.0 { r * r / variance } else { f64::INFINITY }
}

/// 1 - exp(-2k), without the loss of every digit at small k.
fn held(k: f64) -> f64 {
    -(-2.0 * k).exp_m1()
}

/// The Legendre series, k <= 256.
fn series(mu: f64, k: f64) -> f64 {
    const MOST: usize = 192;
    if k == 0.0 {
        return 0.25;
    }
    // A_l falls as exp(-l(l+1)/2k) at large k and as k^l/(2l+1)!! at small: past this degree it is below 1e-17.
    let top = ((16.0 + 9.0 * k.sqrt()) as usize).min(MOST);
    // ratio_l = I_{l+1/2}/I_{l-1/2} = 1 / ((2l+1)/k + ratio_{l+1}); each step backwards damps the error of the start.
    let mut ratios = [0.0; MOST + 1];
    let mut ratio = 0.0;
    for l in (1..=top + 24).rev() {
        ratio = 1.0 / ((2 * l + 1) as f64 / k + ratio);
        if l <= top {
            ratios[l] = ratio;
        }
    }
    // f_0 = 1/4, f_1 = 1/2; beyond, only even degrees: f_l = -(2l+1)/2 P_l(0) / ((l-1)(l+2)).
    let mut sum = 0.25 + 0.5 * ratios[1] * mu;
    let mut attenuation = ratios[1];
    let (mut p_before, mut p) = (1.0, mu);
    let mut p_at_zero = 1.0;
    for (l, ratio) in ratios.iter().enumerate().take(top + 1).skip(2) {
        let n = l as f64;
        (p_before, p) = (p, ((2.0 * n - 1.0) * mu * p - (n - 1.0) * p_before) / n);
        attenuation *= ratio;
        if l % 2 == 0 {
            p_at_zero *= -(n - 1.0) / n;
            sum -= (n + 0.5) * p_at_zero / ((n - 1.0) * (n + 2.0)) * attenuation * p;
        }
    }
    sum
}

/// D(mu, k) for mu <= 0 and k > 256, from the density of x = n.l.
///
/// With x = sin e and mu = sin m, both elevations over the terminator, that density is proportional to
/// exp(k (cos(e - m) - 1)) i0(k cos e cos m), i0(z) = exp(-z) I_0(z): smooth everywhere, a bump as wide as k^-1/2.
/// Elevations, because near the terminator they keep the digits that an angle from the light would lose.
fn far_side(mu: f64, k: f64) -> f64 {
    let m = mu.asin();
    let window = 2.0 * (0.5 * NEGLIGIBLE / k).sqrt().asin();
    let cos_m = m.cos();
    let sum = integrate(0.0, m + window, |e| {
        let half = (0.5 * (e - m)).sin();
        let (sin_e, cos_e) = e.sin_cos();
        sin_e * cos_e * (-2.0 * k * half * half).exp() * scaled_bessel_i0(k * cos_e * cos_m)
    });
    k * sum
}

/// exp(-z) I_0(z) for z > 50 by Hankel's expansion, to the last bits of f64.
fn scaled_bessel_i0(z: f64) -> f64 {
    let mut term = 1.0;
    let mut sum = 1.0;
    for m in 1..=12 {
        let odd = (2 * m - 1) as f64;
        term *= odd * odd / (8.0 * m as f64 * z);
        sum += term;
    }
    sum / (2.0 * PI * z).sqrt()
}
