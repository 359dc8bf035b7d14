//! What the library is held against, written by other means than the library's own.

use std::f64::consts::{FRAC_PI_2, PI};
use std::path::Path;

/// Tanh-sinh quadrature: indifferent to half-integer powers at the ends, and no relative of Gauss-Legendre.
pub fn tanh_sinh(a: f64, b: f64, f: impl Fn(f64) -> f64) -> f64 {
    if b <= a {
        return 0.0;
    }
    let (half, middle, step) = (0.5 * (b - a), 0.5 * (a + b), 1.0 / 32.0);
    let node = |i: i32| {
        let t = f64::from(i) * step;
        let s = FRAC_PI_2 * t.sinh();
        let weight = FRAC_PI_2 * t.cosh() / s.cosh().powi(2);
        weight * f(middle + half * s.tanh())
    };
    half * step * (-120..=120).map(node).sum::<f64>()
}

/// [`tanh_sinh`] over the pieces between sorted break points.
pub fn piecewise(mut breaks: Vec<f64>, f: impl Fn(f64) -> f64) -> f64 {
    breaks.sort_by(f64::total_cmp);
    breaks.windows(2).map(|w| tanh_sinh(w[0], w[1], &f)).sum()
}

/// Mean of max(0, n.l) over a ring of normals at angle `psi` from an axis at angle `theta` from l.
fn azimuth_mean(theta: f64, psi: f64) -> f64 {
    let (a, b) = (theta.cos() * psi.cos(), theta.sin() * psi.sin());
    if a >= b.abs() {
        a
    } else if a <= -b.abs() {
        0.0
    } else {
        let p = (-a / b).acos();
        (a * p + b * p.sin()) / PI
    }
}

/// The surface integral over polar angle psi of a kernel of chord distance c on the unit sphere, normalised.
/// `scale` is the kernel's length: the integral is cut into pieces that grow with it.
pub fn on_sphere(theta: f64, scale: f64, kernel: impl Fn(f64) -> f64) -> f64 {
    let kink = (FRAC_PI_2 - theta).abs();
    let mut breaks = vec![0.0, kink, PI - kink, PI];
    breaks.extend((0..40).map(|i| scale * 1.7_f64.powi(i - 4)).take_while(|&x| x < PI));
    let weight = |psi: f64| kernel(2.0 * (0.5 * psi).sin()) * psi.sin();
    let lit = piecewise(breaks.clone(), |psi| weight(psi) * azimuth_mean(theta, psi));
    lit / piecewise(breaks, weight)
}

/// The ring integral of one kernel of chord distance on the unit circle: (lit, all).
pub fn on_ring(theta: f64, scale: f64, kernel: impl Fn(f64) -> f64) -> (f64, f64) {
    let mut breaks = vec![-PI, 0.0, PI, FRAC_PI_2 - theta, -FRAC_PI_2 - theta, 1.5 * PI - theta];
    let steps = || (0..40).map(|i| scale * 1.7_f64.powi(i - 4)).take_while(|&x| x < PI);
    breaks.extend(steps());
    breaks.extend(steps().map(|x| -x));
    breaks.retain(|x| x.abs() <= PI);
    let weight = |x: f64| kernel(2.0 * (0.5 * x).sin().abs());
    let lit = piecewise(breaks.clone(), |x| weight(x) * (theta + x).cos().max(0.0));
    (lit, piecewise(breaks, weight))
}

/// Rows of numbers of an oracle table; none, with a word about it, where the tables are not at hand.
pub fn table(name: &str) -> Option<Vec<Vec<f64>>> {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../shared/tables")).join(name);
    let Ok(text) = std::fs::read_to_string(&path) else {
        eprintln!("skipped: no table {}", path.display());
        return None;
    };
    let row = |line: &str| line.split(',').map(|x| x.parse().expect("a number")).collect::<Vec<f64>>();
    let rows: Vec<_> = text.lines().skip(1).map(row).collect();
    assert!(rows.len() > 1000, "{name} has only {} rows", rows.len());
    Some(rows)
}

/// The largest difference over triples.
pub fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|c| (a[c] - b[c]).abs()).fold(0.0, |m, x| if x.is_nan() { f64::NAN } else { x.max(m) })
}
