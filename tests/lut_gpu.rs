//! The look-up and the closed form as the device computes them, by a probe of `common/scattering.glsl`, against the tables
//! in f64.
mod studio;

use pdss::gpu::Gpu;
use pdss::skin::lut::{Integral, Lut};
use pdss::skin::moments;
use pdss::skin::profile::Profile;
use pdss::stress::probe::ask;
use std::path::Path;
use std::sync::Arc;

/// Answers of the device: the table's rgb at (mu, curvature), and rectified(mean, spread).
fn probe(gpu: &Arc<Gpu>, lut: &Lut, queries: &[[f32; 4]]) -> Vec<[f32; 4]> {
    ask(gpu, lut, queries).expect("the probe runs")
}

/// Radius, angle and colour of each line of a table in `shared/tables`; red stands in column `red`.
fn table(name: &str, red: usize) -> Option<Vec<(f64, f64, [f64; 3])>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/tables").join(name);
    let Ok(text) = std::fs::read_to_string(&path) else {
        eprintln!("skipped: {} is not there", path.display());
        return None;
    };
    let number = |s: &str| s.parse::<f64>().expect("a number");
    let row = |line: &str| {
        let v: Vec<f64> = line.split(',').map(number).collect();
        (v[0], v[1].to_radians().cos(), [v[red], v[red + 1], v[red + 2]])
    };
    Some(text.lines().skip(1).map(row).collect())
}

/// Largest error per radius, and over all.
fn errors(rows: &[(f64, f64, [f64; 3])], got: &[[f32; 4]]) -> (Vec<(f64, f64)>, f64) {
    let mut list: Vec<(f64, f64)> = Vec::new();
    for ((radius, _, want), got) in rows.iter().zip(got) {
        let e = (0..3).map(|c| (f64::from(got[c]) - want[c]).abs()).fold(0., f64::max);
        let e = if got.iter().any(|x| !x.is_finite()) { f64::INFINITY } else { e };
        match list.last_mut() {
            Some(last) if last.0 == *radius => last.1 = last.1.max(e),
            _ => list.push((*radius, e)),
        }
    }
    let worst = list.iter().map(|e| e.1).fold(0., f64::max);
    (list, worst)
}

/// Means and spreads from a deep shadow to full light, and where there is no spread at all.
fn variables() -> Vec<[f32; 4]> {
    let mut list = Vec::new();
    for i in -60..=60 {
        for s in [0f32, 1e-12, 1e-6, 1e-3, 0.01, 0.05, 0.1, 0.2, 0.5, 1., 10.] {
            list.push([0., 0., i as f32 / 60., s]);
        }
    }
    list
}

/// Largest error of `rectified` in units of the spread, the spread below 1e-7 counting as 1e-7.
fn of_rectified(queries: &[[f32; 4]], got: &[[f32; 4]], bend: f64) -> f64 {
    let one = |(q, a): (&[f32; 4], &[f32; 4])| {
        let (c, s) = (f64::from(q[2]), f64::from(q[3]));
        let error = (f64::from(a[3]) - moments::rectified(c, s * bend)).abs();
        // Rounding of c itself, which may be much larger than s.
        (error - 2e-7 * c.abs()).max(0.) / s.max(1e-7)
    };
    queries.iter().zip(got).map(one).fold(0., |m, e| if e.is_nan() { f64::INFINITY } else { m.max(e) })
}

#[test]
fn the_device_reads_the_tables_and_the_closed_form() {
    let gpu = studio::open();
    let skin = Profile::resolve("skin").expect("built in");
    for (name, red, integral) in [("sphere.csv", 5, Integral::Sphere), ("ring.csv", 2, Integral::RingLiteral)] {
        let Some(rows) = table(name, red) else { continue };
        let lut = Lut::build(&skin, integral);
        let ask = |slip: f64| rows.iter().map(|(r, mu, _)| [(mu + slip) as f32, (1. / r) as f32, 0., 0.]).collect();
        let queries: Vec<[f32; 4]> = ask(0.);
        let got = probe(&gpu, &lut, &queries);
        let (list, worst) = errors(&rows, &got);
        for (radius, e) in &list {
            println!("{name} {radius} mm: {e:.1e}");
        }
        let twin = |(q, a): (&[f32; 4], &[f32; 4])| {
            let want = lut.sample(f64::from(q[0]), f64::from(q[1]));
            (0..3).map(|c| (a[c] - want[c]).abs()).fold(0f32, f32::max)
        };
        let sampled = queries.iter().zip(&got).map(twin).fold(0., f32::max);
        println!("{name}: {} look-ups, largest error {worst:.1e}, against the f64 look-up {sampled:.1e}", rows.len());
        assert!(worst <= 1e-3, "{name}: {worst}");
        assert!(sampled < 2e-4, "{name}: the device does not sample what the twin does: {sampled}");
        // Half a texel off, and the other table, must not pass.
        let (_, slipped) = errors(&rows, &probe(&gpu, &lut, &ask(0.75 / 129.)));
        let other = if integral == Integral::Sphere { Integral::RingLiteral } else { Integral::Sphere };
        let (_, mistaken) = errors(&rows, &probe(&gpu, &Lut::build(&skin, other), &queries));
        println!("{name}: half a texel off {slipped:.1e}, of the other integral {mistaken:.1e}");
        assert!(slipped > 2e-3 && mistaken > 2e-3, "{name}: a wrong table passes");
    }
    let queries = variables();
    let lut = Lut { size: [2, 2], texels: vec![[0.; 4]; 4], knee_per_mm: 1. };
    let got = probe(&gpu, &lut, &queries);
    let (error, wrong) = (of_rectified(&queries, &got, 1.), of_rectified(&queries, &got, 1.01));
    println!("rectified: {} values, largest error {error:.1e} of the spread; spread 1 % off: {wrong:.1e}", got.len());
    assert!(error < 3e-5, "rectified: {error}");
    assert!(wrong > 1e-3, "a spread 1 % off passes: {wrong}");
    for (q, a) in queries.iter().zip(&got).filter(|(q, _)| q[3] == 0.) {
        assert_eq!(a[3].to_bits(), q[2].max(0.).to_bits(), "no spread is max(0, c), to the bit: {q:?}");
    }
    studio::close(gpu);
}
