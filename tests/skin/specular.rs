use pdss::skin::specular::{Layers, Lobes, albedo, fuzz_albedo, look_up, sheen_albedo, split_sum};
use std::f64::consts::PI;

/// Share of a white sky that one bounce reflects, by midpoint quadrature over the light's own angles: no half vector drawn.
fn by_light(nv: f64, roughness: f64, f0: f64) -> f64 {
    const N: usize = 700;
    let a2 = roughness.powi(4);
    let v = [(1. - nv * nv).sqrt(), nv];
    let mut sum = 0.;
    for i in 0..N {
        let theta = (i as f64 + 0.5) / N as f64 * PI / 2.;
        let (s, nl) = theta.sin_cos();
        for j in 0..N {
            let phi = (j as f64 + 0.5) / N as f64 * PI;
            let l = [s * phi.cos(), s * phi.sin(), nl];
            let h = [l[0] + v[0], l[1], l[2] + v[1]];
            let length = (h[0] * h[0] + h[1] * h[1] + h[2] * h[2]).sqrt();
            let (nh, vh) = (h[2] / length, (h[0] * v[0] + h[2] * v[1]) / length);
            let d = nh * nh * (a2 - 1.) + 1.;
            let visibility = 0.5 / (nl * (nv * nv * (1. - a2) + a2).sqrt() + nv * (nl * nl * (1. - a2) + a2).sqrt());
            let f = a2 / (PI * d * d) * visibility * (f0 + (1. - f0) * (1. - vh).powi(5));
            sum += f * nl * s;
        }
    }
    sum * (PI / 2. / N as f64) * (2. * PI / N as f64)
}

/// The same of hair (Estevez & Kulla 2017): a lobe of (sin)^power, smoothly masked (Ashikhmin & Premoze 2007). Power 2 is fuzz.
fn hair_by_light(nv: f64, power: f64) -> f64 {
    const N: usize = 500;
    let across = (1. - nv * nv).sqrt();
    let mut sum = 0.;
    for i in 0..N * N {
        let theta = ((i / N) as f64 + 0.5) / N as f64 * PI / 2.;
        let phi = ((i % N) as f64 + 0.5) / N as f64 * PI;
        let (s, nl) = theta.sin_cos();
        let h = [s * phi.cos() + across, s * phi.sin(), nl + nv];
        let nh2 = h[2] * h[2] / (h[0] * h[0] + h[1] * h[1] + h[2] * h[2]);
        let d = (2. + power) * (1. - nh2).powf(power / 2.) / (2. * PI);
        sum += d / (4. * (nl + nv - nl * nv)) * nl * s;
    }
    sum * (PI / 2. / N as f64) * (2. * PI / N as f64)
}

#[test]
fn the_split_sum_is_the_lobes_own_integral() {
    let (mut off, mut wrong) = (0f64, 0f64);
    for roughness in [0.3, 0.5, 0.8, 1.] {
        for nv in [0.1, 0.4, 0.9] {
            for f0 in [0.028, 1.] {
                let [a, b] = split_sum(nv, roughness);
                let want = by_light(nv, roughness, f0);
                off = off.max((f0 * a + b - want).abs());
                // A wrong twin: alpha taken for roughness.
                let [a, b] = split_sum(nv, roughness.sqrt());
                wrong = wrong.max((f0 * a + b - want).abs());
            }
        }
    }
    println!("split sum against the light's own angles: {off:.1e}; with alpha for roughness {wrong:.1e}");
    assert!(off < 6e-3 && wrong > 0.1);
}

#[test]
fn the_table_is_the_split_sum_and_white_metal_stays_white() {
    let (mut off, mut fitted) = (0f64, 0f64);
    for i in 0..40 {
        for j in 4..=40 {
            let (nv, roughness) = ((f64::from(i) + 0.5) / 40., f64::from(j) / 40.);
            let (have, want) = (look_up(nv, roughness), split_sum(nv, roughness));
            off = off.max((0..2).map(|k| (have[k] - want[k]).abs()).fold(0., f64::max));
            // Karis' fit for mobiles (2014), which the table replaced.
            let a = (1. - roughness).powi(2).min((-9.28 * nv).exp2()) * (1. - roughness) + 0.0425 - 0.0275 * roughness;
            let fit = [-1.04 * a + 1.04 - 0.572 * roughness, 1.04 * a - 0.04 + 0.022 * roughness];
            fitted = fitted.max((0..2).map(|k| (fit[k] - want[k]).abs()).fold(0., f64::max));
            let metal = albedo(have, 1.);
            assert!((metal - 1.).abs() < 1e-12, "{metal}");
            assert!(albedo(have, 0.028) <= 1.);
        }
    }
    println!("table off {off:.1e}, Karis' fit {fitted:.1e}");
    assert!(off < 2e-2 && fitted > 0.1);
}

#[test]
fn two_lobes_take_what_both_reflect() {
    let lobes = Lobes { roughness: [0.75, 1.3], mix: 0.15 };
    let (nv, roughness, f0) = (0.4, 0.5, 0.028);
    let sharp = by_light(nv, roughness * 0.75, f0);
    let wide = by_light(nv, roughness * 1.3, f0);
    let want = 0.85 * sharp + 0.15 * wide;
    // The bounces that come back are below F0 of it.
    let have = lobes.albedo(nv, roughness, f0);
    println!("two lobes {have:.5}, by quadrature {want:.5}; one lobe {:.5}", by_light(nv, roughness, f0));
    assert!((have / want - 1.).abs() < 0.02);
    assert!((by_light(nv, roughness, f0) / want - 1.).abs() > 0.03, "one lobe would be seen");
}

#[test]
fn hair_reflects_what_its_fit_says() {
    let (mut off, mut straight) = (0f64, 0f64);
    for i in 0..=20 {
        let nv = (f64::from(i) / 20.).max(5e-3);
        let want = hair_by_light(nv, 2.);
        off = off.max((fuzz_albedo(nv) - want).abs());
        straight = straight.max((0.73 + nv * (0.083 - 0.73) - want).abs());
    }
    println!("fuzz off {off:.1e}; a straight line {straight:.1e}");
    assert!(off < 3e-2 && straight > 1e-1);
}

#[test]
fn sheen_reflects_its_own_integral_and_layers_take_what_they_reflect() {
    let (mut off, mut wrong) = (0f64, 0f64);
    for roughness in [0.3, 0.5, 0.7, 1.] {
        for nv in [0.1, 0.3, 0.6, 1.] {
            let want = hair_by_light(nv, 1. / (roughness * roughness));
            off = off.max((sheen_albedo(nv, roughness) - want).abs());
            wrong = wrong.max((sheen_albedo(nv, roughness.sqrt()) - want).abs());
        }
    }
    println!("sheen off {off:.1e}; with alpha for roughness {wrong:.1e}");
    assert!(off < 2e-3 && wrong > 5e-2);
    // The hair that was fitted is sheen of alpha 1/2.
    assert!((sheen_albedo(0.5, 0.5f64.sqrt()) - fuzz_albedo(0.5)).abs() < 5e-3);
    for nv in [0.01, 0.2, 0.7, 1.] {
        for roughness in [0.3, 0.6, 1.] {
            let all = Layers { coat: 1., coat_roughness: roughness, sheen: [1., 0.5, 0.], sheen_roughness: roughness };
            let (reflected, under) = all.shares(nv);
            assert!(reflected.iter().all(|r| r + under <= 1. + 1e-12 && under >= -1e-12), "{nv} {roughness}");
            assert!((reflected[0] + under - 1.).abs() < 1e-12 && reflected[2] + under < 1.);
        }
    }
}
