use crate::twin::{apart, on_ring, table};
use pdss::skin::profile::{Gaussian, Profile};
use pdss::skin::ring::{Reading, exitance, von_mises};
use std::f64::consts::{FRAC_1_PI, PI, TAU};

fn skin() -> Vec<Gaussian> {
    Profile::resolve("skin").unwrap().gaussians().gaussians
}

/// The largest difference from the published ring, at one radius or at all.
fn worst_against_table(rows: &[Vec<f64>], f: impl Fn(f64, f64) -> [f64; 3]) -> f64 {
    let error = |row: &Vec<f64>| apart(f(row[1].to_radians(), row[0]), [row[2], row[3], row[4]]);
    rows.iter().map(error).fold(0.0, |m, e| if e.is_nan() { f64::INFINITY } else { e.max(m) })
}

#[test]
fn the_literal_ring_is_the_table() {
    let Some(rows) = table("ring.csv") else { return };
    let gaussians = skin();
    let error = worst_against_table(&rows, |t, r| exitance(t.cos(), r, &gaussians, Reading::Literal2011));
    let other = worst_against_table(&rows, |t, r| exitance(t.cos(), r, &gaussians, Reading::OneDimensional));
    println!("ring.csv: {error:.1e}; the other reading differs by {other:.3}");
    assert!(error < 1e-10);
    assert!(other > 0.01, "the two readings must not be interchangeable");
}

#[test]
fn the_table_catches_uniform_samples_on_a_stiff_ring() {
    let Some(rows) = table("ring.csv") else { return };
    let gaussians = skin();
    let stiff: Vec<_> = rows.into_iter().filter(|row| row[0] == 100.0).collect();
    // 200 uniform samples with one at 0: only that one is left, and it says max(0, cos).
    let uniform = |theta: f64, r: f64| {
        let (mut lit, mut all) = ([0.0; 3], [0.0; 3]);
        for i in -100..100 {
            let x = f64::from(i) / 200.0 * TAU;
            for g in &gaussians {
                let c = 2.0 * r * (0.5 * x).sin();
                let density = (-0.5 * c * c / g.variance).exp() / (TAU * g.variance);
                (0..3).for_each(|k| all[k] += g.weight[k] * density);
                (0..3).for_each(|k| lit[k] += g.weight[k] * density * (theta + x).cos().max(0.0));
            }
        }
        std::array::from_fn(|k| lit[k] / all[k])
    };
    let error = worst_against_table(&stiff, uniform);
    let collapsed =
        stiff.iter().map(|row| row[1].to_radians()).map(|t| apart(uniform(t, 100.0), [t.cos().max(0.0); 3]));
    let collapsed = collapsed.fold(0.0, f64::max);
    let ours = worst_against_table(&stiff, |t, r| exitance(t.cos(), r, &gaussians, Reading::Literal2011));
    println!("r = 100 mm, 200 uniform samples: {error:.1e} off, {collapsed:.1e} from lambert; ours {ours:.1e} off");
    assert!(collapsed < 1e-3 && error > 1e-4 && ours < 1e-10);
}

#[test]
fn both_readings_are_their_own_quadrature() {
    let gaussians = skin();
    for reading in [Reading::Literal2011, Reading::OneDimensional] {
        let mut worst = 0.0_f64;
        for radius in [0.01, 0.5, 3.0, 40.0, 1000.0, 1e5] {
            for degrees in (0..=36).map(|i| f64::from(i) * 5.0).chain([89.9, 90.02]) {
                let theta = f64::to_radians(degrees);
                let (mut lit, mut all) = ([0.0; 3], [0.0; 3]);
                for g in &gaussians {
                    let k = radius * radius / g.variance;
                    let (l, a) = on_ring(theta, 1.0 / k.sqrt(), |c| (-0.5 * k * c * c).exp());
                    let height = match reading {
                        Reading::Literal2011 => 1.0 / g.variance,
                        Reading::OneDimensional => g.variance.sqrt().recip(),
                    };
                    (0..3).for_each(|c| lit[c] += g.weight[c] * height * l);
                    (0..3).for_each(|c| all[c] += g.weight[c] * height * a);
                }
                let expected = std::array::from_fn(|c| lit[c] / all[c]);
                worst = worst.max(apart(exitance(theta.cos(), radius, &gaussians, reading), expected));
            }
        }
        println!("{reading:?} against tanh-sinh: {worst:.1e}");
        assert!(worst < 1e-10);
    }
}

#[test]
fn the_one_dimensional_ring_approaches_the_sphere_and_the_literal_one_does_not() {
    use pdss::skin::sphere::exitance_normalised;
    let gaussians = skin();
    let red = |reading, radius| exitance(0.0, radius, &gaussians, reading)[0];
    for (radius, within) in [(5.0, 0.025), (10.0, 0.007), (50.0, 0.0003)] {
        let sphere = exitance_normalised(0.0, radius, &gaussians)[0];
        let (literal, ring) = (red(Reading::Literal2011, radius), red(Reading::OneDimensional, radius));
        println!("terminator, red, {radius} mm: sphere {sphere:.4}, ring {ring:.4}, literal {literal:.4}");
        assert!((ring - sphere).abs() < within && literal < sphere / 3.0);
    }
}

#[test]
fn a_ring_has_its_limits() {
    for mu in [-1.0, -0.4, 0.0, 0.4, 1.0] {
        assert_eq!(von_mises(mu, 0.0), FRAC_1_PI);
        assert_eq!(von_mises(mu, f64::INFINITY), f64::max(mu, 0.0));
        assert!((von_mises(mu, 1e-300) - FRAC_1_PI).abs() < 1e-15);
        assert!((von_mises(mu, 1e30) - f64::max(mu, 0.0)).abs() < 1e-14);
        for reading in [Reading::Literal2011, Reading::OneDimensional] {
            assert!(apart(exitance(mu, f64::INFINITY, &skin(), reading), [f64::max(mu, 0.0); 3]) < 1e-15);
            assert!(apart(exitance(mu, 0.0, &skin(), reading), [1.0 / PI; 3]) < 1e-12);
        }
    }
    let with_delta =
        [Gaussian { variance: 0.0, weight: [1.0, 0.5, 0.0] }, Gaussian { variance: 1.0, weight: [0.0, 0.5, 1.0] }];
    let [alone, mixed, none] = exitance(0.0, 5.0, &with_delta, Reading::OneDimensional);
    println!("half a delta at the terminator: {mixed:.4} of {none:.4}");
    assert!(alone < 1e-15 && (mixed - 0.5 * none).abs() < 0.02 * none);
}
