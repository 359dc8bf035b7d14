//! Burley's normalised diffusion (Christensen & Burley 2015), for methods that draw samples from it.
//!
//! R(r) = (e^{-r/d} + e^{-r/3d}) / (8 pi d r), with unit albedo. All of it is a function of r/d alone.

use super::profile::{Profile, Shape};

/// Share of the energy within `x` = r/d >= 0: 1 - e^{-x}/4 - 3 e^{-x/3}/4.
pub fn cdf(x: f64) -> f64 {
    -0.25 * ((-x).exp_m1() + 3.0 * (-x / 3.0).exp_m1())
}

/// The r/d within which a share `xi` of the energy lies; 0 at 0 and below, infinite at 1 and above.
///
/// The root of a cubic in e^{-x/3} (Golubev 2018), then one step of Newton's method for the digits that the logarithm of a
/// number near 1 has lost: cdf(inverse(xi)) is xi to 1e-15.
pub fn inverse_cdf(xi: f64) -> f64 {
    if xi <= 0.0 {
        return 0.0;
    }
    let u = 1.0 - xi;
    if u <= 0.0 {
        return f64::INFINITY;
    }
    let g = 1.0 + 4.0 * u * (2.0 * u + (1.0 + 4.0 * u * u).sqrt());
    let root = g.cbrt();
    let x = (3.0 * ((1.0 + 1.0 / root + root) / (4.0 * u)).ln()).max(0.0);
    let slope = 0.25 * ((-x).exp() + (-x / 3.0).exp());
    (x - (cdf(x) - xi) / slope).max(0.0)
}

/// How far wrap lighting reaches beyond the terminator of a sphere, `x` = d times its curvature, >= 0.
///
/// max(0, mu + w) / (1 + w)^2 (McAuley; Hill 2011) keeps the energy of max(0, mu) for every w up to 1; w is fitted so that it is near
/// what the sphere scatters, within .051 rms over mu, and never further from it than a plain cosine is.
pub fn wrap(x: f64) -> f64 {
    let t = x.powf(1.8307);
    5.3052 * t / (1.0 + 4.6665 * t)
}

/// Burley's distances d (mm) that come closest to a profile, per channel; 0 for a channel that is a delta.
///
/// Closest: the least square difference of the enclosed energies over log r, which no scale is favoured in. A profile that is
/// Burley's already keeps its own.
pub fn fit_d(profile: &Profile) -> [f64; 3] {
    if let Shape::Burley { d } = &profile.shape {
        return *d;
    }
    // Mean radius is 2.5 d: the fit lies near.
    let near = profile.mean_radius_mm().map(|r| r / 2.5);
    std::array::from_fn(|c| if near[c] > 0.0 { least(near[c], |d| apart(profile, c, near[c], d)) } else { 0.0 })
}

/// Steps of the sum over log r, over five decades around `near`.
const STEPS: i32 = 200;

fn apart(profile: &Profile, channel: usize, near: f64, d: f64) -> f64 {
    let one = |i: i32| {
        let r = near * 10f64.powf(f64::from(i) * 2.5 / f64::from(STEPS));
        (profile.enclosed(r)[channel] - cdf(r / d)).powi(2)
    };
    (-STEPS..=STEPS).map(one).sum()
}

/// The minimum of `f` over a tenth to ten times `near`, by golden section over the logarithm.
fn least(near: f64, f: impl Fn(f64) -> f64) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_895;
    let (mut low, mut high) = ((near * 0.1).ln(), (near * 10.0).ln());
    for _ in 0..60 {
        let (a, b) = (high - GOLDEN * (high - low), low + GOLDEN * (high - low));
        if f(a.exp()) < f(b.exp()) { high = b } else { low = a }
    }
    (0.5 * (low + high)).exp()
}
