use crate::twin::piecewise;
use pdss::skin::occlusion::{Combine, Falloff, bowl, combine, from_mean, patch, trough};
use std::f64::consts::{FRAC_PI_2, PI};

const FALLOFFS: [Falloff; 3] = [Falloff::Hard, Falloff::Quadratic, Falloff::Linear];

fn counts(falloff: Falloff, t: f64) -> f64 {
    match falloff {
        _ if t >= 1.0 => 0.0,
        Falloff::Hard => 1.0,
        Falloff::Quadratic => 1.0 - t * t,
        Falloff::Linear => 1.0 - t,
    }
}

/// A ray at angle a from the normal of a bowl's bottom ends after 2 cos a radii.
fn bowl_by_rays(curvature: f64, reach: f64, falloff: Falloff) -> f64 {
    let distance = |a: f64| 2.0 * a.cos() / -curvature / reach;
    let kink = (-0.5 * curvature * reach).min(1.0).acos();
    piecewise(vec![0.0, kink, FRAC_PI_2], |a| 2.0 * a.cos() * a.sin() * counts(falloff, distance(a)))
}

/// The same in a cylinder along x, by stratified rays about the normal z: (y, z) is left where y^2 + (z-1)^2 = 1.
fn trough_by_rays(curvature: f64, reach: f64, falloff: Falloff) -> f64 {
    let n = 1200;
    let mut sum = 0.0;
    for i in 0..n {
        for j in 0..n {
            // Cosine-weighted: uniform over the disc.
            let (radius, turn) =
                (((f64::from(i) + 0.5) / f64::from(n)).sqrt(), (f64::from(j) + 0.5) / f64::from(n) * FRAC_PI_2);
            let (y, z) = (radius * turn.sin(), (1.0 - radius * radius).sqrt());
            sum += counts(falloff, 2.0 * z / (y * y + z * z) / -curvature / reach);
        }
    }
    sum / f64::from(n * n)
}

#[test]
fn bowls_hide_what_rays_say() {
    let mut worst = 0.0_f64;
    for falloff in FALLOFFS {
        for reach in [0.1, 1.0, 1.9, 2.0, 3.0, 20.0] {
            worst = worst.max((bowl(-0.7, reach / 0.7, falloff) - bowl_by_rays(-0.7, reach / 0.7, falloff)).abs());
        }
    }
    let other = (bowl(-1.0, 1.0, Falloff::Linear) - bowl_by_rays(-1.0, 1.0, Falloff::Quadratic)).abs();
    println!("bowl against quadrature of rays: {worst:.1e}; with the wrong falloff {other:.2}");
    assert!(worst < 1e-12 && other > 0.03);
}

#[test]
fn troughs_hide_what_rays_say() {
    let mut worst = 0.0_f64;
    for falloff in FALLOFFS {
        for reach in [0.3, 1.0, 1.7, 2.0, 2.5, 9.0] {
            worst = worst.max((trough(-1.0, reach, falloff) - trough_by_rays(-1.0, reach, falloff)).abs());
        }
    }
    let as_bowl = (bowl(-1.0, 1.0, Falloff::Hard) - trough_by_rays(-1.0, 1.0, Falloff::Hard)).abs();
    println!("trough against rays: {worst:.1e}; taken for a bowl {as_bowl:.2}");
    assert!(worst < 1e-3 && as_bowl > 0.1);
    // Visibilities of a trough by Monte Carlo, to its noise.
    for (kr, visible) in [(0.5, 0.9767), (1.0, 0.9012), (1.5, 0.756), (2.0, 0.425)] {
        assert!((1.0 - trough(-1.0, kr, Falloff::Hard) - visible).abs() < 1e-3);
    }
    // Against a much finer quadrature of the same integral, where it is hardest: just beyond the kink.
    for c in [0.5, 0.999, 1.0, 1.001, 1.3, 40.0] {
        let slice = |a: f64| a.sin().powi(2) * (1.0 - (1.0 - (c * a.sin()).powi(2).min(1.0)).sqrt());
        let kink = (1.0_f64 / c).min(1.0).asin();
        let exact = 4.0 / PI * piecewise(vec![0.0, kink, FRAC_PI_2], slice);
        assert!((trough(-1.0, 2.0 * c, Falloff::Hard) - exact).abs() < 1e-9, "c = {c}");
    }
}

#[test]
fn a_patch_is_exact_where_it_says_so() {
    for falloff in FALLOFFS {
        for reach in [0.2, 1.0, 2.5] {
            assert!((patch(-0.8, 0.64, reach, falloff) - bowl(-0.8, reach, falloff)).abs() < 1e-15);
        }
        let (small, exact) = (patch(-0.005, 0.0, 1.0, falloff), trough(-0.01, 1.0, falloff));
        assert!((small / exact - 1.0).abs() < 1e-4);
    }
    let short = |kr: f64| trough(-1.0, kr, Falloff::Hard) - patch(-0.5, 0.0, kr, Falloff::Hard);
    let up_to = |end: i32| (0..=end).map(|i| short(f64::from(i) / 100.0)).fold(0.0, f64::max);
    println!("patch in a trough: short by {:.3} up to kR = 1.5, {:.3} up to 2", up_to(150), up_to(200));
    assert!(up_to(150) < 0.035 && up_to(200) < 0.205);
}

#[test]
fn only_the_concave_hides() {
    for falloff in FALLOFFS {
        assert_eq!([bowl(0.5, 3.0, falloff), trough(0.5, 3.0, falloff), patch(0.5, 0.2, 3.0, falloff)], [0.0; 3]);
        assert_eq!(from_mean(0.5, 3.0, falloff), 0.0);
        // A saddle with principal curvatures -a and a counts as a trough of curvature a.
        assert!((patch(0.0, -0.09, 1.0, falloff) - patch(-0.15, 0.0, 1.0, falloff)).abs() < 1e-15);
        assert!(bowl(-1e9, 1e9, falloff) > 0.999 && bowl(-1e9, 1e9, falloff) <= 1.0);
        let (low, high) = (bowl(-0.5, 1.0, falloff), patch(-0.5, 0.0, 1.0, falloff));
        assert!((low..=high).contains(&from_mean(-0.5, 1.0, falloff)));
    }
}

#[test]
fn levels_combine() {
    assert_eq!(combine(&[], Combine::Product), 1.0);
    assert_eq!(combine(&[], Combine::Max), 1.0);
    let levels = [(1.0, 0.5), (0.5, 0.4), (1.0, 7.0)];
    assert!((combine(&levels[..2], Combine::Product) - 0.4).abs() < 1e-15);
    assert!((combine(&levels[..2], Combine::Max) - 0.5).abs() < 1e-15);
    assert_eq!(combine(&levels, Combine::Product), 0.0);
}
