//! The estimators against surfaces whose curvature is known.
mod analytic;

use analytic::{Picture, Shape, Shot};
use pdss::skin::curvature::{Curvature, Estimator, FOOTPRINT_BOUND, estimate, estimate_f32};

fn shot(shape: Shape, distance: f64, turn: [f64; 2]) -> Shot {
    // 0.37 mm a pixel at 500 mm.
    Shot { shape, size: [640, 480], focal: 1344.0, distance, turn, perspective: true }
}

fn shots() -> Vec<(&'static str, Shot)> {
    vec![
        ("sphere 60", shot(Shape::Sphere(60.0), 500.0, [0.0, 0.0])),
        ("torus 70/25", shot(Shape::Torus(70.0, 25.0), 560.0, [0.0, 50.0])),
        ("torus, steep", shot(Shape::Torus(70.0, 25.0), 560.0, [20.0, 15.0])),
        ("cylinder 40", shot(Shape::Cylinder(40.0), 500.0, [0.0, 20.0])),
        ("ellipsoid", shot(Shape::Ellipsoid(80.0, 50.0, 35.0), 500.0, [30.0, 20.0])),
        ("saddle 40", shot(Shape::Saddle(40.0), 560.0, [25.0, 40.0])),
        ("plane", shot(Shape::Plane, 500.0, [0.0, 30.0])),
        ("torus, ortho", Shot { perspective: false, ..shot(Shape::Torus(70.0, 25.0), 560.0, [0.0, 50.0]) }),
    ]
}

#[derive(Debug, Clone, Copy)]
struct Errors {
    median: f64,
    p99: f64,
    max: f64,
    n: usize,
}

/// Errors over the covered pixels inside or outside the silhouette band.
fn errors(p: &Picture, inside: bool, error: impl Fn(usize) -> f64) -> Errors {
    let mut e: Vec<f64> = p.covered().filter(|i| p.band[*i] == inside).map(error).collect();
    e.sort_by(f64::total_cmp);
    let at = |q: f64| e.get(((e.len() as f64 * q) as usize).min(e.len().saturating_sub(1))).copied().unwrap_or(0.0);
    Errors { median: at(0.5), p99: at(0.99), max: at(1.0), n: e.len() }
}

/// r |H - truth|, r the sharpest radius.
fn of_h(p: &Picture, c: &[Curvature], inside: bool) -> Errors {
    errors(p, inside, |i| (c[i].h - p.h[i]).abs() / p.shape.sharpest())
}

/// r^2 |K - truth|.
fn of_k(p: &Picture, c: &[Curvature], inside: bool) -> Errors {
    errors(p, inside, |i| (c[i].k - p.k[i]).abs() / p.shape.sharpest().powi(2))
}

#[test]
fn table() {
    println!("{:14} {:8} {:>32}   {:>32}   {:>22}", "r|dH|", "", "outside: median p99 max", "band: median p99 max", "r^2|dK| median p99");
    for (name, shot) in shots() {
        let p = shot.take();
        for e in Estimator::ALL {
            let c = estimate(e, &p.g);
            let (out, band, k) = (of_h(&p, &c, false), of_h(&p, &c, true), of_k(&p, &c, false));
            let sure = errors(&p, false, |i| 1.0 - c[i].confidence);
            println!(
                "{name:14} {:8} {:10.2e} {:10.2e} {:10.2e}   {:10.2e} {:10.2e} {:10.2e}   {:10.2e} {:10.2e} n {} {} doubt p99 {:.3} max {:.3}",
                e.name(), out.median, out.p99, out.max, band.median, band.p99, band.max, k.median, k.p99, out.n, band.n, sure.p99, sure.max
            );
        }
    }
    let _ = (FOOTPRINT_BOUND, estimate_f32);
}
