use crate::twin::{apart, on_sphere, table};
use pdss::skin::profile::{Gaussian, Profile};
use pdss::skin::sphere::{burley, exitance, exitance_normalised, mass, vmf};

fn skin() -> Vec<Gaussian> {
    Profile::resolve("skin").unwrap().gaussians().gaussians
}

/// The largest difference of `f(mu, k)` from quadrature over angles and sharpnesses.
fn worst_against_quadrature(f: impl Fn(f64, f64) -> f64) -> (f64, f64, f64) {
    let mut worst = (0.0, 0.0, 0.0);
    for k in [1e-8, 1e-3, 0.1, 1.0, 4.0, 10.0, 60.0, 255.9, 256.1, 300.0, 1e3, 1e4, 1e6, 1e9, 1e14] {
        let sigma = 1.0 / f64::sqrt(k);
        let near = [-6.0, -3.0, -1.0, -0.3, 0.0, 0.3, 1.0, 3.0, 6.0].map(|z| std::f64::consts::FRAC_PI_2 + z * sigma);
        let angles = (0..=18).map(|i| f64::from(i).to_radians() * 10.0).chain(near);
        for theta in angles.filter(|t| (0.0..=std::f64::consts::PI).contains(t)) {
            let expected = on_sphere(theta, sigma, |c| (-0.5 * k * c * c).exp());
            let error = (f(theta.cos(), k) - expected).abs();
            if error.is_nan() || error > worst.0 {
                worst = (error, theta.to_degrees(), k);
            }
        }
    }
    worst
}

#[test]
fn a_lobe_is_its_own_quadrature_at_every_sharpness() {
    let (error, angle, k) = worst_against_quadrature(vmf);
    println!("vmf against tanh-sinh: {error:.1e} at {angle:.2} degrees, k = {k:e}");
    assert!(error < 1e-10, "{error:e} at {angle} degrees, k = {k:e}");
}

#[test]
fn the_quadrature_catches_the_planar_limit() {
    let planar = |mu: f64, k: f64| pdss::skin::moments::rectified(mu, 1.0 / k.sqrt());
    let (error, ..) = worst_against_quadrature(|mu, k| if k > 256.0 { planar(mu, k) } else { vmf(mu, k) });
    println!("planar limit beyond k = 256: off by {error:.1e}");
    assert!(error > 1e-4 && error < 1.0 / 256.0);
}

#[test]
fn a_lobe_has_its_limits_to_the_bit() {
    for i in -10..=10 {
        let mu = f64::from(i) / 10.0;
        assert_eq!(vmf(mu, 0.0), 0.25);
        assert_eq!(vmf(mu, f64::INFINITY), mu.max(0.0));
        assert!((vmf(mu, 1e-300) - 0.25).abs() < 1e-15);
        assert!((vmf(mu, 1e300) - mu.max(0.0)).abs() < 1e-140);
    }
    assert!(vmf(f64::NAN, 1.0).is_nan() && vmf(0.0, f64::NAN).is_nan());
}

#[test]
fn the_two_ways_meet_without_a_step() {
    let step = (-1000..=1000).map(|i| f64::from(i) / 1000.0).map(|mu| {
        let slope = (vmf(mu, 256.02) - vmf(mu, 256.01)) / 0.01;
        (vmf(mu, 256.0 * (1.0 + 1e-12)) - vmf(mu, 256.0) - slope * 256e-12).abs()
    });
    let step = step.fold(0.0, f64::max);
    println!("step at k = 256: {step:.1e}");
    assert!(step < 2e-14);
}

#[test]
fn skin_on_a_sphere_is_the_table() {
    let Some(rows) = table("sphere.csv") else { return };
    let gaussians = skin();
    let (mut lost, mut normalised, mut unlike) = (0.0_f64, 0.0_f64, 0.0_f64);
    for row in &rows {
        let (radius, mu) = (row[0], row[1].to_radians().cos());
        let raw = exitance(mu, radius, &gaussians);
        lost = lost.max(apart(raw, [row[2], row[3], row[4]]));
        normalised = normalised.max(apart(exitance_normalised(mu, radius, &gaussians), [row[5], row[6], row[7]]));
        unlike = unlike.max(apart(raw, [row[5], row[6], row[7]]));
    }
    println!("sphere.csv: {lost:.1e} as it is, {normalised:.1e} normalised; mistaking one for the other {unlike:.2}");
    assert!(lost < 1e-10 && normalised < 1e-10);
    assert!(unlike > 0.1, "the two columns must not be interchangeable");
}

#[test]
fn a_sphere_gets_back_what_falls_on_it() {
    // 2 Int D dmu = 1 for every profile and radius, by the midpoint rule in mu.
    let gaussians = skin();
    for radius in [0.3, 1.0, 4.0, 30.0] {
        let n = 4000;
        let mut sum = [0.0; 3];
        for i in 0..n {
            let d = exitance_normalised((f64::from(i) + 0.5) / f64::from(n) * 2.0 - 1.0, radius, &gaussians);
            (0..3).for_each(|c| sum[c] += d[c] * 4.0 / f64::from(n));
        }
        println!("energy at {radius} mm: {sum:.7?}");
        assert!(apart(sum, [1.0; 3]) < 1e-6);
    }
}

#[test]
fn every_radius_has_its_limit() {
    let gaussians = skin();
    for mu in [-1.0, -0.3, 0.0, 0.7, 1.0] {
        assert_eq!(exitance_normalised(mu, f64::INFINITY, &gaussians), [f64::max(mu, 0.0); 3]);
        assert!(apart(exitance_normalised(mu, 0.0, &gaussians), [0.25; 3]) < 1e-15);
        assert!(apart(exitance_normalised(mu, 1e-12, &gaussians), [0.25; 3]) < 1e-12);
    }
    assert_eq!(mass(f64::INFINITY, &gaussians).map(|m| (m * 1e12).round()), [1e12; 3]);
    assert!(mass(1e-9, &gaussians)[0] < 1e-13);
    let deltas =
        [Gaussian { variance: 0.0, weight: [1.0, 0.5, 0.0] }, Gaussian { variance: 1.0, weight: [0.0, 0.5, 1.0] }];
    assert_eq!(exitance_normalised(0.6, 5.0, &deltas)[0], 0.6);
    assert_eq!(exitance_normalised(0.6, 0.0, &deltas), [0.6, 0.6, 0.25]);
    assert_eq!(exitance_normalised(0.6, 1.0, &[]), [0.0; 3]);
}

fn worst_burley(f: impl Fn(f64, f64) -> f64) -> (f64, f64, f64) {
    let mut worst = (0.0, 0.0, 0.0);
    for x in [1e-6, 1e-3, 0.01, 0.018, 0.05, 0.1, 0.3, 1.0, 2.0, 30.0, 1e5] {
        for degrees in (0..=36).map(|i| f64::from(i) * 5.0).chain([89.9, 90.1]) {
            let theta = f64::to_radians(degrees);
            // The profile times c, because the area element brings a c that the twin has as sin psi = c cos(psi/2).
            let expected =
                on_sphere(theta, x, |c| if c > 0.0 { ((-c / x).exp() + (-c / (3.0 * x)).exp()) / c } else { 0.0 });
            let error = (f(theta.cos(), x) - expected).abs();
            if error.is_nan() || error > worst.0 {
                worst = (error, degrees, x);
            }
        }
    }
    worst
}

#[test]
fn burley_on_a_sphere_is_its_own_quadrature() {
    let (error, angle, x) = worst_burley(burley);
    println!("Burley against tanh-sinh: {error:.1e} at {angle} degrees, x = {x}");
    assert!(error < 1e-10);
    let (error, ..) = worst_burley(|mu, x| burley(mu, 1.01 * x));
    println!("a profile 1 % too wide: {error:.1e}");
    assert!(error > 1e-4);
}

#[test]
fn burley_on_a_sphere_is_the_published_table() {
    // x, D at 0, 90 and 110 degrees, to the digits given.
    let known = [
        (0.01, 0.9993, 0.008, 0.0),
        (0.05, 0.9825, 0.0392, 0.0023),
        (0.1, 0.9344, 0.074, 0.0169),
        (0.2, 0.8281, 0.1194, 0.0524),
        (0.3, 0.7575, 0.143, 0.0764),
        (0.5, 0.6785, 0.1662, 0.1034),
        (1.0, 0.5946, 0.1875, 0.1321),
        (2.0, 0.539, 0.1996, 0.1511),
    ];
    let at = |degrees: f64, x| burley(degrees.to_radians().cos(), x);
    let worst = known.iter().map(|&(x, a, b, c)| apart([at(0.0, x), at(90.0, x), at(110.0, x)], [a, b, c]));
    let worst = worst.fold(0.0, f64::max);
    println!("Burley against the table: {worst:.1e}");
    assert!(worst <= 0.6e-4);
    assert_eq!(burley(0.4, 0.0), 0.4);
    assert_eq!(burley(-0.4, 0.0), 0.0);
    assert!((burley(0.4, f64::INFINITY) - burley(0.4, 1e9)).abs() < 1e-8);
}
