//! The edge of a shadow after scattering, against a surface integral over the lit half of a plane.
use crate::twin::piecewise;
use pdss::skin::penumbra::{SIZE, disc_place, disc_share, exact, table};
use pdss::skin::profile::{Gaussian, Profile};
use std::f64::consts::{PI, TAU};

fn skin() -> Vec<Gaussian> {
    Profile::resolve("skin").expect("built in").gaussians().gaussians
}

/// Exitance `x` mm inside the lit half of a plane, red: the profile's share on rings of radius r, of which the angle
/// 2 acos(x/r) falls into the dark.
fn on_a_plane(gaussians: &[Gaussian], x: f64) -> f64 {
    let profile = |r: f64| {
        gaussians.iter().map(|g| g.weight[0] * (-r * r / (2. * g.variance)).exp() / (TAU * g.variance)).sum::<f64>()
    };
    let dark = |r: f64| if r > x.abs() { (x.abs() / r).acos() / PI } else { 0. };
    let breaks = vec![x.abs(), x.abs() + 0.05, x.abs() + 0.3, x.abs() + 1., x.abs() + 4., x.abs() + 30.];
    let lost = piecewise(breaks, |r| TAU * r * profile(r) * dark(r));
    if x >= 0. { 1. - lost } else { lost }
}

/// Largest difference over a grid of lit shares and cosines; `width` is what the table believes of a disc of 20 mm.
fn worst(width: f64) -> f64 {
    let (gaussians, radius) = (skin(), 10.);
    let mut worst = 0f64;
    for i in 1..20 {
        for cosine in [0.1, 0.5, 1.] {
            let u = f64::from(i) / 20.;
            // The place in the disc, found by counting chords, not by the library's inverse.
            let steps = 20_000;
            let half = |y: f64| (1. - y * y).max(0.).sqrt();
            let (mut x, mut share) = (-1., 0.);
            while share < u * PI {
                x += 2. / f64::from(steps);
                share += 2. * half(x - 1. / f64::from(steps)) * 2. / f64::from(steps);
            }
            let truth = on_a_plane(&gaussians, x * radius / cosine);
            worst = worst.max((exact(&gaussians, width, u, cosine)[0] - truth).abs());
        }
    }
    worst
}

#[test]
fn a_straight_edge_on_a_plane_is_scattered_exactly() {
    let (right, wrong) = (worst(20.), worst(16.));
    println!("largest difference from the surface integral {right:.1e}; of a table for another width {wrong:.1e}");
    // The oracle's place is found in steps of 1e-4 of the radius.
    assert!(right < 1e-3, "{right}");
    assert!(wrong > 0.01, "the twin is not caught: {wrong}");
}

#[test]
fn the_inverse_of_the_disc() {
    let back =
        (0..=1000).map(|i| f64::from(i) / 1000.).map(|u| (disc_share(disc_place(u)) - u).abs()).fold(0., f64::max);
    println!("share of place of share: {back:.1e}");
    assert!(back < 1e-12 && disc_share(-2.) == 0. && disc_share(2.) == 1.);
    assert!((disc_share(0.25) - 0.5 - 0.25).abs() > 0.05, "the twin: a square's share is not a disc's");
}

#[test]
fn the_table_ends_in_dark_and_light_and_is_a_step_at_grazing_light() {
    let profile = Profile::resolve("skin").expect("built in");
    let texels = table(&profile, 4.);
    assert_eq!(texels.len(), (4 * SIZE[0] * SIZE[1]) as usize);
    for row in texels.chunks_exact(4 * SIZE[0] as usize) {
        for c in 0..3 {
            let line: Vec<f32> = row.iter().skip(c).step_by(4).map(|h| h.to_f32()).collect();
            assert_eq!((line[0], line[line.len() - 1]), (0., 1.));
            assert!(line.windows(2).all(|w| w[0] <= w[1]), "not monotonic");
        }
    }
    let first: Vec<f32> = texels[..4 * SIZE[0] as usize].iter().step_by(4).map(|h| h.to_f32()).collect();
    assert!(first.iter().all(|s| *s == 0. || *s == 1.), "grazing light leaves no room to scatter");
}
