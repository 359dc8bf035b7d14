//! Rectified moments: E max(0, X) of a normal variable X with mean c and standard deviation s.
//!
//! With X = n.l over one Gaussian of the profile, c the blurred un-normalised n dotted with l and s its spread, this is
//! what that Gaussian scatters. E max(0, X) = s phi(c/s) + c Phi(c/s), phi and Phi the standard normal's density and
//! distribution. Written as max(0, c) + s h(|c|/s) with h(z) = phi(z) - z Phi(-z), nothing cancels and nothing is
//! divided that the limit does not need.
//!
//! For shaders h is 2 to the power of a cubic, one division and one `exp2`:
//!
//! ```glsl
//! // E max(0, X), X normal with mean c and standard deviation s >= 0. Error below 2.4e-5 s. s = 0 gives max(0, c).
//! float rectified(float c, float s) {
//!     float z = abs(c) / max(s, 1e-8);
//!     return max(c, 0.0) + s * exp2(-(1.3258326 + z * (1.8057098 + z * (0.421194 + z * 0.032454884))));
//! }
//! ```
//!
//! `highp` (32-bit) floats: z may reach 1e8, its cube 1e24, and exp2 of minus that is 0, as it should be.

use std::f64::consts::{FRAC_1_SQRT_2, TAU};

/// Coefficients of -log2 h(z), constant term first: a minimax fit of h over z >= 0, absolute error below 2.4e-5.
pub const FAST_COEFFICIENTS: [f32; 4] = [1.325_832_6, 1.805_709_8, 0.421_194, 0.032_454_884];
/// The least standard deviation that [`rectified_fast`] divides by.
pub const FAST_LEAST_SPREAD: f32 = 1e-8;

/// E max(0, X) for X normal with mean `c` and standard deviation `s` (its sign is ignored).
///
/// s = 0 gives max(0, c) to the bit. Relative error below 1e-13 wherever the result is a normal number, also far in the
/// dark tail, where the textbook's form with erf has no digit left. NaN gives NaN.
pub fn rectified(c: f64, s: f64) -> f64 {
    let s = s.abs();
    if c.is_nan() || s.is_nan() {
        f64::NAN
    } else if s == 0.0 {
        c.max(0.0)
    } else {
        c.max(0.0) + s * overshoot(c.abs() / s)
    }
}

/// The shader's approximation of [`rectified`], bit for bit the GLSL above up to the device's `exp2`.
///
/// Absolute error below 2.4e-5 `s`; `s` >= 0.
pub fn rectified_fast(c: f32, s: f32) -> f32 {
    let [p0, p1, p2, p3] = FAST_COEFFICIENTS;
    let z = c.abs() / s.max(FAST_LEAST_SPREAD);
    c.max(0.0) + s * (-(p0 + z * (p1 + z * (p2 + z * p3)))).exp2()
}

/// h(z) = phi(z) - z Phi(-z) for z >= 0.
fn overshoot(z: f64) -> f64 {
    let density = (-0.5 * z * z).exp() / TAU.sqrt();
    if z < 2.5 {
        return density - z * 0.5 * libm::erfc(z * FRAC_1_SQRT_2);
    }
    // Mills' ratio is 1/(z + K) with K = 1/(z + 2/(z + 3/(z + ...))), so h = phi K / (z + K): no difference is left.
    let mut k = 0.0;
    for n in (1..=120).rev() {
        k = n as f64 / (z + k);
    }
    density * k / (z + k)
}
