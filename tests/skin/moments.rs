use crate::twin::piecewise;
use pdss::skin::moments::{rectified, rectified_fast};
use std::f64::consts::TAU;

/// E max(0, X) by quadrature over the part of the density that is positive.
fn by_quadrature(c: f64, s: f64) -> f64 {
    let density = |x: f64| (-0.5 * ((x - c) / s).powi(2)).exp() / (s * TAU.sqrt());
    let breaks = (-40..=40).map(|i| c + s * f64::from(i)).filter(|&x| x > 0.0).chain([0.0]);
    piecewise(breaks.collect(), |x| x * density(x))
}

/// The largest relative error over the lit and the deeply dark.
fn worst(f: impl Fn(f64, f64) -> f64) -> f64 {
    let mut worst = 0.0_f64;
    for z in (-80..=80).map(|i| f64::from(i) / 4.0).chain([2.4999, 2.5001, -2.4999, -2.5001]) {
        for s in [1e-6, 0.03, 1.0] {
            let expected = by_quadrature(z * s, s);
            worst = worst.max((f(z * s, s) / expected - 1.0).abs());
        }
    }
    worst
}

#[test]
fn rectified_keeps_its_digits_in_the_dark() {
    let error = worst(rectified);
    let textbook = worst(|c, s| {
        let z = c / s;
        s * (-0.5 * z * z).exp() / TAU.sqrt() + c * 0.5 * (1.0 + libm::erf(z / std::f64::consts::SQRT_2))
    });
    println!("rectified: relative {error:.1e}; the textbook's form {textbook:.1e}");
    assert!(error < 1e-12);
    assert!(textbook > 1e-3, "the check must see cancellation");
}

#[test]
fn rectified_has_its_limits() {
    assert_eq!([rectified(0.3, 0.0), rectified(-0.3, 0.0), rectified(0.0, 0.0)], [0.3, 0.0, 0.0]);
    assert_eq!([rectified(1.0, 1e-300), rectified(-1.0, 1e-300)], [1.0, 0.0]);
    assert!((rectified(0.0, 1.0) - 1.0 / TAU.sqrt()).abs() < 1e-16);
    assert!(rectified(f64::NAN, 1.0).is_nan() && rectified(0.0, f64::NAN).is_nan());
}

#[test]
fn the_shader_form_is_close_enough() {
    let mut worst = 0.0_f64;
    for i in -200_000..=200_000 {
        let z = f64::from(i) / 10_000.0;
        worst = worst.max((f64::from(rectified_fast(z as f32, 1.0)) - rectified(f64::from(z as f32), 1.0)).abs());
    }
    println!("rectified_fast: {worst:.2e} s");
    // The remainder is f32's own rounding at |c| = 20 s.
    assert!(worst < 2.6e-5);
    assert_eq!([rectified_fast(0.3, 0.0), rectified_fast(-0.3, 0.0), rectified_fast(0.0, 0.0)], [0.3, 0.0, 0.0]);
    assert_eq!(rectified_fast(-1.0, 1e-20), 0.0);
}
