//! Gauss-Legendre quadrature of one fixed order.

use std::f64::consts::PI;
use std::sync::LazyLock;

/// Nodes a panel. 64 integrate a Gaussian window of +-8.6 sigma, or a cosine over half a turn, to the last bits of f64.
const NODES: usize = 64;

/// (node, weight) on [-1, 1].
static RULE: LazyLock<[(f64, f64); NODES]> = LazyLock::new(legendre_rule);

/// The integral of `f` over [a, b]; 0 where the interval is empty or reversed.
pub(crate) fn integrate(a: f64, b: f64, mut f: impl FnMut(f64) -> f64) -> f64 {
    let (half, middle) = (0.5 * (b - a), 0.5 * (a + b));
    // Written so that a NaN bound, too, is an empty interval.
    if half > 0.0 { half * RULE.iter().map(|&(x, w)| w * f(middle + half * x)).sum::<f64>() } else { 0.0 }
}

/// The integral over [a, b] of an `f` that behaves as a half-integer power of the distance to `a`.
///
/// The substitution x = a + (b - a) t^2 turns that power into a whole one.
pub(crate) fn integrate_from_kink(a: f64, b: f64, mut f: impl FnMut(f64) -> f64) -> f64 {
    let width = b - a;
    if width == 0.0 { 0.0 } else { integrate(0.0, 1.0, |t| 2.0 * t * width.abs() * f(a + width * t * t)) }
}

/// Newton's method on P_n from the usual cosine guess; the roots come in pairs of opposite sign.
fn legendre_rule() -> [(f64, f64); NODES] {
    let n = NODES as f64;
    let mut rule = [(0.0, 0.0); NODES];
    for i in 0..NODES / 2 {
        let mut x = (PI * (i as f64 + 0.75) / (n + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..8 {
            let (p, q) = legendre_pair(x);
            slope = n * (x * p - q) / (x * x - 1.0);
            x -= p / slope;
        }
        let weight = 2.0 / ((1.0 - x * x) * slope * slope);
        rule[i] = (-x, weight);
        rule[NODES - 1 - i] = (x, weight);
    }
    rule
}

/// (P_n(x), P_{n-1}(x)) by the three-term recurrence.
fn legendre_pair(x: f64) -> (f64, f64) {
    let (mut before, mut p) = (1.0, x);
    for l in 2..=NODES {
        let l = l as f64;
        (before, p) = (p, ((2.0 * l - 1.0) * x * p - (l - 1.0) * before) / l);
    }
    (p, before)
}
