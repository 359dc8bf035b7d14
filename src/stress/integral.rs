//! Pre-integration at every stiffness: D(mu, k) itself, the closed form of `moments`, the ring, the table on the device.

use super::studio::{mixture, wax};
use super::{Bench, Measure, Measured, probe};
use crate::skin::lut::{Integral, Lut};
use crate::skin::profile::{Gaussian, Profile};
use crate::skin::quadrature::integrate;
use crate::skin::{moments, ring, sphere};
use std::f64::consts::PI;

/// k = r^2 / v of the rows, half a decade apart.
fn stiffness() -> impl Iterator<Item = f64> {
    (-16..=28).map(|e| 10f64.powf(f64::from(e) / 2.))
}

/// The mean of max(0, n.l) under a von Mises-Fisher lobe by plain two-dimensional quadrature over its own window: no
/// series, no recurrence, no density in closed form. Right to 1e-9 for k up to 1e6; beyond, the planar limit to 1/k.
fn by_quadrature(mu: f64, k: f64) -> f64 {
    if k > 1e6 {
        return moments::rectified(mu, k.powf(-0.5));
    }
    let (sin_mu, reach) = ((1. - mu * mu).max(0.).sqrt(), (40. / k).min(2.));
    // x = 1 - cos psi, so that the lobe is exp(-k x); in steps, for the kink where the terminator is met.
    let steps = 64;
    let mean = |x: f64| {
        let (a, b) = (mu * (1. - x), sin_mu * (x * (2. - x)).max(0.).sqrt());
        if a >= b {
            a
        } else if a <= -b {
            0.
        } else {
            let p = (-a / b).acos();
            (a * p + b * p.sin()) / PI
        }
    };
    let panel = |i: usize, f: &dyn Fn(f64) -> f64| {
        // Quadratic steps: a sharp lobe's terminator lies near x = 0.
        let at = |i: usize| reach * (i as f64 / steps as f64).powi(2);
        integrate(at(i), at(i + 1), f)
    };
    let weight = |x: f64| (-k * x).exp();
    let (mut sum, mut mass) = (0., 0.);
    for i in 0..steps {
        sum += panel(i, &|x| mean(x) * weight(x));
        mass += panel(i, &weight);
    }
    sum / mass
}

/// 2 int D dmu - 1 by panels that narrow towards the terminator.
fn excess(d: impl Fn(f64) -> f64, sharpest: f64) -> f64 {
    let mut edges = vec![0., 1.];
    let mut e = sharpest.clamp(1e-12, 1.);
    while e < 1. {
        edges.push(e);
        e *= 4.;
    }
    edges.sort_by(f64::total_cmp);
    let half = |sign: f64| edges.windows(2).map(|w| integrate(w[0], w[1], |x| d(sign * x))).sum::<f64>();
    2. * (half(1.) + half(-1.)) - 1.
}

/// Of a family D(mu, k): how far outside 0..1, how far it falls as mu rises, its energy; and those of `wrong`.
fn family(d: &dyn Fn(f64, f64) -> f64, wrong: &dyn Fn(f64, f64) -> f64, energy: bool) -> Vec<Measure> {
    let measure = |d: &dyn Fn(f64, f64) -> f64| {
        let (mut out, mut fall, mut off) = (0f64, 0f64, 0f64);
        let worse = |m: f64, x: f64| if x.is_nan() { f64::INFINITY } else { m.max(x) };
        for k in stiffness() {
            let mut before = f64::NEG_INFINITY;
            for i in -200..=200 {
                // Dense at the terminator.
                let mu = (f64::from(i) / 200.).powi(3);
                let value = d(mu, k);
                out = worse(out, (-value).max(value - 1.));
                fall = worse(fall, if before.is_finite() { before - value } else { 0. });
                before = value;
            }
            if energy {
                off = worse(off, excess(|mu| d(mu, k), 4. / k.sqrt()).abs());
            }
        }
        (out, fall, off)
    };
    let (out, fall, off) = measure(d);
    let (wrong_out, wrong_fall, wrong_off) = measure(wrong);
    let mut all = vec![
        Measure::new("outside 0..1", out, wrong_out, "k = 1e-8 .. 1e14, 401 cosines each"),
        Measure::new("falls with mu by", fall, wrong_fall, ""),
    ];
    if energy {
        all.push(Measure::new("|2 int D dmu - 1|", off, wrong_off, ""));
    }
    all
}

/// A D that fails in every respect: sampled by five nodes over a fixed window, as the ring of 2011 is.
fn sampled(mu: f64, k: f64) -> f64 {
    let angle = mu.clamp(-1., 1.).acos();
    let node = |i: i32| f64::from(i) * PI / 2.5;
    let weight = |x: f64| (-k * (1. - x.cos())).exp();
    let (sum, mass) = (-2..=2).fold((0., 0.), |(s, m), i| {
        let x = node(i);
        (s + (angle + x).cos().max(0.) * weight(x), m + weight(x))
    });
    1.002 * sum / mass
}

/// The sphere's series and density: bounds, order, energy, and an independent quadrature.
pub fn gaussian(_: &Bench) -> Measured {
    let mut all = family(&sphere::vmf, &|mu, k| sampled(mu, k) - 1e-3 * (300. * mu).cos(), true);
    let apart = |f: fn(f64, f64) -> f64| {
        let mut worst = 0f64;
        for k in stiffness() {
            for i in -20..=20 {
                let mu = f64::from(i) / 20. * if k > 100. { 4. / k.sqrt() } else { 1. };
                let limit = if k > 1e6 { 1. / k } else { 0. };
                worst = worst.max((f(mu, k) - by_quadrature(mu, k)).abs() - limit);
            }
        }
        worst
    };
    all.push(Measure::new(
        "|D - quadrature|",
        apart(sphere::vmf),
        apart(|mu, k| sphere::vmf(mu, 1.01 * k)),
        "by two-dimensional panels; beyond k = 1e6 the planar limit, less its own 1/k; wrong: k 1 % off",
    ));
    Ok(all)
}

/// Burley's profile on a sphere; k stands for 1 / (d H)^2.
pub fn burley(_: &Bench) -> Measured {
    Ok(family(&|mu, k| sphere::burley(mu, k.powf(-0.5)), &|mu, k| sampled(mu, k) - 1e-3 * (300. * mu).cos(), true))
}

/// The ring: light is kept on a ring, where int D dtheta = 2.
pub fn ring(_: &Bench) -> Measured {
    let d = |theta: f64, k: f64| ring::von_mises(theta.cos(), k);
    let off = |factor: f64| {
        let mut worst = 0f64;
        for k in stiffness() {
            // In elevation e over the terminator: narrow panels where the lobe is.
            let mut edges = vec![0., PI / 2.];
            let mut e = (4. / k.sqrt()).clamp(1e-12, PI / 2.);
            while e < PI / 2. {
                edges.push(e);
                e *= 4.;
            }
            edges.sort_by(f64::total_cmp);
            let sum: f64 =
                edges.windows(2).map(|w| integrate(w[0], w[1], |e| 2. * (d(PI / 2. - e, k) + d(PI / 2. + e, k)))).sum();
            worst = worst.max((factor * sum / 2. - 1.).abs());
        }
        worst
    };
    let mut all = family(&|mu, k| ring::von_mises(mu, k), &|mu, k| sampled(mu, k) - 1e-3 * (300. * mu).cos(), false);
    all.push(Measure::new("|int D dtheta / 2 - 1|", off(1.), off(1.01), "over a turn"));
    Ok(all)
}

/// The closed form of `moments` on its own terms: E max(0, X) - E max(0, -X) = E X, and the energy of a planar Gaussian.
pub fn rectified(_: &Bench) -> Measured {
    let apart = |f: &dyn Fn(f64, f64) -> f64| {
        let mut worst = 0f64;
        for e in -14..=2 {
            let s = 10f64.powi(e);
            for i in -40..=40 {
                let c = f64::from(i) / 4. * s;
                worst = worst.max(((f(c, s) - f(-c, s)) - c).abs() / s);
            }
        }
        worst
    };
    let fast = |c: f64, s: f64| f64::from(moments::rectified_fast(c as f32, s as f32));
    let against = |bend: f64| {
        let mut worst = 0f64;
        for e in -6..=1 {
            let s = 10f64.powi(e);
            for i in -60..=60 {
                let c = f64::from(i) / 10. * s;
                worst = worst.max((fast(c, s) - moments::rectified(c, s * bend)).abs() / s);
            }
        }
        worst
    };
    Ok(vec![
        Measure::new(
            "odd part / s",
            apart(&moments::rectified),
            apart(&|c, s| moments::rectified(c, s) + 1e-9 * c.max(0.)),
            "E max(0,X) - E max(0,-X) - E X",
        ),
        Measure::new("fast - exact / s", against(1.), against(1.01), "the shader's cubic; wrong: spread 1 % off"),
    ])
}

/// The table on the device against the exact integral, one Gaussian at a time at every curvature, and its energy.
pub fn table(bench: &Bench) -> Measured {
    let mut all = Vec::new();
    for (quantity, profile) in [("wax: |table - D|", wax()), ("skin: |table - D|", Profile::resolve("skin")?)] {
        let list = profile.gaussians().gaussians;
        let lut = Lut::build(&profile, Integral::Sphere);
        let radii: Vec<f64> = (-6..=12).map(|e| 10f64.powf(f64::from(e) / 2.)).collect();
        let cosines: Vec<f64> = (-100..=100).map(|i| f64::from(i) / 100.).collect();
        let ask = |slip: f64| -> Vec<[f32; 4]> {
            let one = |r: &f64| {
                let k = 1. / r;
                cosines.iter().map(move |mu| [(mu + slip) as f32, k as f32, 0., 0.]).collect::<Vec<_>>()
            };
            radii.iter().flat_map(one).collect()
        };
        let exact: Vec<[f64; 3]> = radii
            .iter()
            .flat_map(|r| cosines.iter().map(|mu| sphere::exitance_normalised(*mu, *r, &list)).collect::<Vec<_>>())
            .collect();
        let worst = |queries: &[[f32; 4]]| -> Result<f64, super::StressError> {
            let got = probe::ask(&bench.gpu, &lut, queries)?;
            let one = |(a, want): (&[f32; 4], &[f64; 3])| {
                (0..3).map(|c| (f64::from(a[c]) - want[c]).abs()).fold(0., f64::max)
            };
            Ok(got.iter().zip(&exact).map(one).fold(0., |m, x| if x.is_nan() { f64::INFINITY } else { m.max(x) }))
        };
        let (figure, wrong) = (worst(&ask(0.))?, worst(&ask(0.75 / 129.))?);
        all.push(Measure::new(quantity, figure, wrong, "r = 1e-3 .. 1e6 mm; wrong: half a texel off"));
    }
    Ok(all)
}

/// Energy that the table's own interpolation and rounding make, per row: 2 int sample dmu.
pub fn table_energy(_: &Bench) -> Measured {
    let profile = wax();
    let lut = Lut::build(&profile, Integral::Sphere);
    let off = |factor: f64| {
        let mut worst = 0f64;
        for e in -6..=12 {
            let k = 10f64.powf(f64::from(-e) / 2.);
            for c in 0..3 {
                // A texel's piece is straight in mu: the trapezoid over 128 * 14 equal steps of 1/8 .. is exact.
                let n = 7168;
                let value = |i: i32| f64::from(lut.sample(2. * f64::from(i) / f64::from(n) - 1., k)[c]);
                let sum: f64 = (0..n).map(|i| 0.5 * (value(i) + value(i + 1))).sum();
                worst = worst.max((factor * sum * 4. / f64::from(n) - 1.).abs());
            }
        }
        worst
    };
    Ok(vec![Measure::new("|2 int D dmu - 1|", off(1.), off(1.01), "r = 1e-3 .. 1e6 mm")])
}

/// The kernel's own weights: whatever the profile's figures, they sum to one.
pub fn weights(_: &Bench) -> Measured {
    let mut worst = 0f64;
    let sums = |list: &[Gaussian]| {
        (0..3).map(|c| (list.iter().map(|g| g.weight[c]).sum::<f64>() - 1.).abs()).fold(0., f64::max)
    };
    for name in Profile::names() {
        for factor in [1e-9, 1., 1e9] {
            worst = worst.max(sums(&Profile::resolve(name)?.scaled(factor).gaussians().gaussians));
        }
    }
    let wrong = sums(&mixture("short", vec![(1., [0.5; 3]), (4., [0.4; 3])]).gaussians().gaussians);
    Ok(vec![Measure::new("|sum of weights - 1|", worst, wrong, "every built-in profile, lengths times 1e-9, 1, 1e9")])
}
