use pdss::skin::profile::{Gaussian, Profile};
use pdss::skin::sky::{COSINE, Harmonics, direction, kept, knee, lobe, spread, table};
use pdss::skin::sphere;
use std::f64::consts::PI;

type V3 = [f64; 3];
const SIZE: [usize; 2] = [512, 256];

fn dot(a: V3, b: V3) -> f64 {
    (0..3).map(|i| a[i] * b[i]).sum()
}

fn unit(v: V3) -> V3 {
    v.map(|x| x / dot(v, v).sqrt())
}

fn place(x: usize, y: usize) -> V3 {
    direction([(x as f64 + 0.5) / SIZE[0] as f64, (y as f64 + 0.5) / SIZE[1] as f64])
}

fn project(radiance: impl Fn(V3) -> V3 + Sync) -> Harmonics {
    Harmonics::of_rows(SIZE[0], SIZE[1], |x, y| radiance(place(x, y)))
}

/// The mean of a weight times radiance over all directions, times 4 pi: quadrature that knows nothing of harmonics.
fn sum(radiance: impl Fn(V3) -> V3, weight: impl Fn(V3) -> f64) -> V3 {
    let mut out = [0.; 3];
    for y in 0..SIZE[1] {
        let edge = |y: usize| ((0.5 - y as f64 / SIZE[1] as f64) * PI).sin();
        let texel = (edge(y) - edge(y + 1)) * 2. * PI / SIZE[0] as f64;
        for x in 0..SIZE[0] {
            let d = place(x, y);
            let l = radiance(d);
            (0..3).for_each(|c| out[c] += l[c] * weight(d) * texel);
        }
    }
    out
}

fn normals() -> Vec<V3> {
    let one = |i: usize| {
        let z = 1. - (2 * i + 1) as f64 / 24.;
        let turn = 2.399963 * i as f64;
        let r = (1. - z * z).sqrt();
        [r * turn.cos(), z, r * turn.sin()]
    };
    (0..24).map(one).collect()
}

fn worst(a: impl Fn(V3) -> V3, b: impl Fn(V3) -> V3) -> f64 {
    let apart = |n: V3| (0..3).map(|c| (a(n)[c] - b(n)[c]).abs()).fold(0., f64::max);
    normals().into_iter().map(apart).fold(0., f64::max)
}

/// A sky that three bands hold whole, positive everywhere.
fn gentle(d: V3) -> V3 {
    let q = d[0] * d[1] - 0.4 * d[2] * d[0] + 0.3 * d[2] * d[2];
    [1. + 0.4 * d[1] + 0.3 * q, 0.8 - 0.3 * d[0] + 0.2 * d[2] * d[1], 0.9 + 0.5 * d[2] - 0.2 * q]
}

/// A sky with windows and a small hot lamp.
fn studio(d: V3) -> V3 {
    let window = if d[0] > 0.6 && d[1].abs() < 0.5 { 6. } else { 0. };
    let lamp = if dot(d, unit([-0.4, 0.7, 0.6])) > 0.99 { 60. } else { 0. };
    [0.2 + window, 0.25 + window + lamp, 0.3 + 0.8 * window + lamp]
}

#[test]
fn an_even_sky_gives_pi_everywhere_and_a_cosine_lobe_what_is_known() {
    let even = project(|_| [1., 0.5, 2.]);
    let off = worst(|n| even.irradiance(n), |_| [PI, 0.5 * PI, 2. * PI]);
    // L = 1 + d.a: E = pi + 2 pi/3 n.a.
    let a = unit([0.3, 0.8, -0.5]);
    let tilted = project(|d| [1. + dot(d, a); 3]);
    let lobe = worst(|n| tilted.irradiance(n), |n| [PI + 2. * PI / 3. * dot(n, a); 3]);
    // L = max(0, d.a), seen head on: 2 pi/3, of which three bands hold pi/4 + pi/3 + 5 pi/64.
    let clamped = project(|d| [dot(d, a).max(0.); 3]).irradiance(a)[0];
    let known = PI / 4. + PI / 3. + 5. * PI / 64.;
    println!(
        "even sky off {off:.1e}, cosine {lobe:.1e}, clamped cosine {clamped:.5} of {known:.5}; whole {:.5}",
        2. * PI / 3.
    );
    assert!(off < 1e-4 && lobe < 1e-4 && (clamped - known).abs() < 1e-4);
    assert!((clamped - 2. * PI / 3.).abs() > 1e-2, "the bound tells three bands from all");
}

#[test]
fn irradiance_is_the_skys_own_quadrature() {
    let cosine = |n: V3| move |d: V3| dot(n, d).max(0.);
    let held = project(gentle);
    let exact = worst(|n| held.irradiance(n), |n| sum(gentle, cosine(n)));
    // A wrong twin: band 2 as if the cosine kept as much of it as of band 1.
    let wrong =
        worst(|n| held.scattered(n, [[1.; 3], [1.; 3], [COSINE[1] / COSINE[2]; 3]]), |n| sum(gentle, cosine(n)));
    let hard = project(studio);
    let brightest = normals().into_iter().map(|n| sum(studio, cosine(n))[1]).fold(0., f64::max);
    let cut = worst(|n| hard.irradiance(n), |n| sum(studio, cosine(n)));
    println!(
        "three bands' own sky {exact:.1e} (wrong twin {wrong:.1e}); windows and a lamp {cut:.3} of {brightest:.3}"
    );
    assert!(exact < 1e-4 && wrong > 1e-2);
    assert!(cut < 0.08 * brightest, "what three bands leave out");
}

#[test]
fn turning_the_sky_is_turning_the_normal() {
    let sky = project(studio);
    let (s, c) = 0.7f64.sin_cos();
    // About y, then about x.
    let rows = [[c, 0., s], [s * s, c, -s * c], [-s * c, s, c * c]];
    let back = |n: V3| std::array::from_fn(|j| (0..3).map(|i| rows[i][j] * n[i]).sum());
    let off = worst(|n| sky.turned(rows).irradiance(n), |n| sky.irradiance(back(n)));
    let unturned = worst(|n| sky.irradiance(n), |n| sky.irradiance(back(n)));
    let form = sky.polynomial();
    let summed = |[x, y, z]: V3| -> V3 {
        let terms = [1., x, y, z, x * y, y * z, z * x, 2. * z * z - x * x - y * y, x * x - y * y];
        std::array::from_fn(|c| PI * (0..9).map(|i| form[i][c] * terms[i]).sum::<f64>())
    };
    let polynomial = worst(summed, |n| sky.irradiance(n));
    println!("turned {off:.1e} (not turned {unturned:.2}), as a polynomial {polynomial:.1e}");
    assert!(off < 1e-12 && polynomial < 1e-12 && unturned > 0.1);
}

#[test]
fn a_sun_is_smoothed_until_nothing_rings_and_a_gentle_sky_is_left_alone() {
    let sun = |d: V3| {
        let hot = if dot(d, unit([0.3, 0.5, 0.8])) > 0.995 { [900., 800., 600.] } else { [0.; 3] };
        [hot[0] + 0.2, hot[1] + 0.3, hot[2] + 0.5]
    };
    let least = |sky: &Harmonics| {
        let one = |c: usize| normals().into_iter().map(|n| sky.irradiance(n)[c]).fold(f64::INFINITY, f64::min);
        [one(0), one(1), one(2)]
    };
    let (rings, own) = (project(sun), [0.2 * PI, 0.3 * PI, 0.5 * PI]);
    let smooth = rings.without_ringing(own);
    let cosine = |n: V3| move |d: V3| dot(n, d).max(0.);
    let most = |f: &dyn Fn(V3) -> V3| normals().into_iter().map(|n| f(n)[0]).fold(0., f64::max);
    let peaks = [most(&|n| rings.irradiance(n)), most(&|n| smooth.irradiance(n)), most(&|n| sum(sun, cosine(n)))];
    println!("least {:?}, smoothed {:?}, own {own:?}; peaks {peaks:?}", least(&rings), least(&smooth));
    assert!(least(&rings)[0] < 0., "it rings");
    assert!(least(&smooth).iter().zip(own).all(|(have, own)| *have > 0.4 * own));
    assert!(peaks[1] > 0.7 * peaks[2], "not flattened");
    assert_eq!(rings.0[0], smooth.0[0], "the light is all there");
    let held = project(gentle);
    let small = normals()
        .into_iter()
        .map(|n| sum(gentle, cosine(n)))
        .fold([f64::INFINITY; 3], |m, e| std::array::from_fn(|c| m[c].min(e[c])));
    assert_eq!(held.without_ringing(small), held);
}

fn skin() -> Vec<Gaussian> {
    Profile::resolve("skin").unwrap().gaussians().gaussians
}

#[test]
fn a_sphere_scatters_a_sky_by_its_bands() {
    let (gaussians, sky) = (skin(), project(gentle));
    for radius in [1.5, 6., 40.] {
        let factors = kept(1. / radius, &gaussians);
        // Every direction of the sky through what a distant light leaves on that sphere.
        let by_lights = |n: V3| -> V3 {
            let rows: Vec<V3> =
                (0..=200).map(|i| sphere::exitance_normalised(f64::from(i) / 100. - 1., radius, &gaussians)).collect();
            let weight = |c: usize| {
                let rows = &rows;
                move |d: V3| {
                    let at = (dot(n, d) + 1.) * 100.;
                    let i = (at as usize).min(199);
                    rows[i][c] + (at - i as f64) * (rows[i + 1][c] - rows[i][c])
                }
            };
            std::array::from_fn(|c| sum(gentle, weight(c))[c])
        };
        let off = worst(|n| sky.scattered(n, factors), by_lights);
        let plain = worst(|n| sky.irradiance(n), by_lights);
        println!("radius {radius} mm: off {off:.1e}; unscattered {plain:.1e}; R_1 {:?}", factors[1]);
        assert!(off < 3e-4 && (plain > 2. * off || radius > 20.));
    }
    assert_eq!(kept(0., &gaussians), [[1.; 3]; 3], "a plane is lambert's");
    let flat = kept(1e-6, &gaussians);
    assert!(flat.iter().flatten().all(|r| (r - 1.).abs() < 1e-9));
    let point = kept(1e9, &gaussians);
    assert!(point[0] == [1.; 3] && point[1].iter().chain(&point[2]).all(|r| r.abs() < 1e-9));
}

#[test]
fn the_table_and_the_fit_hold_what_they_stand_for() {
    let gaussians = skin();
    let knee = knee(&gaussians);
    let texels = table(&gaussians, knee);
    let n = texels.len() / 2;
    let (mut off, mut nearest) = (0f64, 0f64);
    for i in 0..2000 {
        let curvature = f64::from(i) * 1e-3;
        let at = curvature / (curvature + knee) * (n - 1) as f64;
        let (base, t) = ((at as usize).min(n - 2), at.fract());
        for (band, want) in kept(curvature, &gaussians).iter().enumerate().skip(1) {
            for c in 0..3 {
                let [a, b] = [0, 1].map(|k| f64::from(texels[(band - 1) * n + base + k][c]));
                off = off.max((a + t * (b - a) - want[c]).abs());
                nearest = nearest.max((a - want[c]).abs());
            }
        }
    }
    // Against Legendre moments by quadrature, over sharpness.
    let (mut fit, mut square) = (0f64, 0f64);
    for i in 1..400 {
        let k = 1.05f64.powi(i - 150);
        let [_, first, second] = lobe(k);
        fit = fit.max((spread(first * first) * first * first - second).abs());
        square = square.max((first * first - second).abs());
    }
    println!("table off {off:.1e} (nearest texel {nearest:.1e}); spread off {fit:.1e} (the square alone {square:.1e})");
    assert!(off < 2e-3 && nearest > 5e-3);
    assert!(fit < 2e-3 && square > 2e-2);
}
