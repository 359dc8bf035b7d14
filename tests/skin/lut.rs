use crate::twin::{apart, table};
use pdss::skin::lut::{Integral, Lut};
use pdss::skin::profile::{Gaussian, Profile, Shape};
use pdss::skin::{ring, sphere};
use std::time::Instant;

fn read(lut: &Lut, mu: f64, curvature: f64) -> [f64; 3] {
    lut.sample(mu, curvature).map(f64::from)
}

fn build(profile: &Profile, integral: Integral) -> Lut {
    let start = Instant::now();
    let lut = Lut::build(profile, integral);
    println!("{} {integral:?}: built in {:.0} ms", profile.name, start.elapsed().as_secs_f64() * 1e3);
    lut
}

/// The largest error against a table whose red stands in column `red`, per radius.
fn worst_per_radius(rows: &[Vec<f64>], red: usize, f: impl Fn(f64, f64) -> [f64; 3]) -> Vec<(f64, f64)> {
    let mut worst: Vec<(f64, f64)> = Vec::new();
    for row in rows {
        let error = apart(f(row[1].to_radians().cos(), 1.0 / row[0]), [row[red], row[red + 1], row[red + 2]]);
        match worst.last_mut() {
            Some(last) if last.0 == row[0] => last.1 = last.1.max(error),
            _ => worst.push((row[0], error)),
        }
    }
    worst
}

fn most(errors: &[(f64, f64)]) -> f64 {
    errors.iter().map(|e| e.1).fold(0.0, f64::max)
}

#[test]
fn the_look_up_is_both_tables_at_every_radius() {
    let skin = Profile::resolve("skin").unwrap();
    for (name, red, integral) in [("sphere.csv", 5, Integral::Sphere), ("ring.csv", 2, Integral::RingLiteral)] {
        let Some(rows) = table(name) else { return };
        let lut = build(&skin, integral);
        let errors = worst_per_radius(&rows, red, |mu, k| read(&lut, mu, k));
        for (radius, error) in &errors {
            println!("  {name} {radius} mm: {error:.1e}");
        }
        assert!(most(&errors) < 1e-3);
        // The same table read half a texel off, the commonest slip, must not pass.
        let [width, _] = lut.size.map(f64::from);
        let slipped = worst_per_radius(&rows, red, |mu, k| read(&lut, (mu + 0.75 / width).min(1.0), k));
        println!("  half a texel off: {:.1e}", most(&slipped));
        assert!(most(&slipped) > 2e-3);
    }
}

/// The largest error against the exact integral between the table's radii, too.
fn worst_against_exact(lut: &Lut, exact: impl Fn(f64, f64) -> [f64; 3]) -> (f64, f64, f64) {
    let mut worst = (0.0, 0.0, 0.0);
    for i in 0..=60 {
        let radius = 0.5 * 10_f64.powf(f64::from(i) * 0.07);
        for j in -120..=120 {
            let t = f64::from(j) / 120.0;
            let mu = t * t.abs();
            let error = apart(read(lut, mu, 1.0 / radius), exact(mu, radius));
            if error.is_nan() || error > worst.0 {
                worst = (error, mu, radius);
            }
        }
    }
    worst
}

#[test]
fn the_look_up_is_the_integral_between_the_tables() {
    let skin = Profile::resolve("skin").unwrap();
    let gaussians = skin.gaussians().gaussians;
    let lut = build(&skin, Integral::Sphere);
    let (error, mu, r) = worst_against_exact(&lut, |mu, r| sphere::exitance_normalised(mu, r, &gaussians));
    println!("  sphere: {error:.1e} at mu = {mu:.3}, r = {r:.2} mm");
    assert!(error < 1e-3);
    let (off, ..) = worst_against_exact(&lut, |mu, r| sphere::exitance_normalised(mu, 1.05 * r, &gaussians));
    println!("  against radii 5 % larger: {off:.1e}");
    assert!(off > 2e-3);
    for (integral, reading) in
        [(Integral::RingLiteral, ring::Reading::Literal2011), (Integral::Ring, ring::Reading::OneDimensional)]
    {
        let lut = build(&skin, integral);
        let (error, mu, r) = worst_against_exact(&lut, |mu, r| ring::exitance(mu, r, &gaussians, reading));
        println!("  {reading:?}: {error:.1e} at mu = {mu:.3}, r = {r:.2} mm");
        assert!(error < 1e-3);
    }
}

#[test]
fn burley_profiles_look_up_as_well() {
    for name in Profile::names() {
        let profile = Profile::resolve(name).unwrap();
        let Shape::Burley { d } = profile.shape else { continue };
        let lut = build(&profile, Integral::Sphere);
        let (error, mu, r) = worst_against_exact(&lut, |mu, r| d.map(|d| sphere::burley(mu, d / r)));
        println!("  {error:.1e} at mu = {mu:.3}, r = {r:.2} mm");
        assert!(error < 1e-3);
    }
}

#[test]
fn the_table_has_both_limits() {
    let skin = Profile::resolve("skin").unwrap();
    let lut = build(&skin, Integral::Sphere);
    for i in -1000..=1000 {
        let mu = f64::from(i) / 1000.0;
        assert!(apart(read(&lut, mu, 0.0), [mu.max(0.0); 3]) < 1e-7, "flat is not lambert at {mu}");
        assert_eq!(lut.sample(mu, f64::INFINITY), [0.25; 3]);
        assert_eq!(lut.sample(mu, -0.3), lut.sample(mu, 0.3));
    }
    let strange = [f64::NAN, f64::INFINITY, -f64::INFINITY, 1e300, -5.0];
    for x in strange {
        for y in strange {
            assert!(lut.sample(x, y).iter().all(|v| (0.0..=1.0).contains(v)), "{x} {y}");
        }
    }
    assert_eq!(lut.texels.len(), (lut.size[0] * lut.size[1]) as usize);
    assert!(lut.texels.iter().all(|t| t[3] == 1.0 && t.iter().all(|x| half::f16::from_f32(*x).to_f32() == *x)));
}

#[test]
fn profiles_without_extent_stay_lambert() {
    let delta = Gaussian { variance: 0.0, weight: [1.0; 3] };
    let flat = |shape| Profile { shape, ..Profile::resolve("skin").unwrap() };
    let burley = Shape::Burley { d: [0.0, 0.0, 1.0] };
    for profile in [flat(Shape::Gaussians(vec![delta])), flat(burley)] {
        for integral in [Integral::Sphere, Integral::Ring, Integral::RingLiteral] {
            let lut = build(&profile, integral);
            for (mu, curvature) in [(0.37, 0.0), (0.37, 2.0), (-0.2, 2.0), (0.9, f64::INFINITY), (0.0, 0.1)] {
                let [r, g, _] = read(&lut, mu, curvature);
                assert!(
                    (r - mu.max(0.0)).abs() < 1e-7 && (g - mu.max(0.0)).abs() < 1e-7,
                    "{integral:?} {mu} {curvature}"
                );
            }
        }
    }
}
