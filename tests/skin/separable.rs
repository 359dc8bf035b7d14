//! Kernels of one separable pair: the published centre weights, energy and width, convergence to the integral along a line.
use crate::twin::piecewise;
use pdss::skin::profile::{Gaussian, Profile};
use pdss::skin::separable::{Tap, of_authors, of_profile, transmitted};
use std::f64::consts::TAU;

fn skin() -> Vec<Gaussian> {
    Profile::resolve("skin").expect("built in").gaussians().gaussians
}

fn widest(list: &[Gaussian]) -> f64 {
    list.iter().map(|g| g.variance.sqrt()).fold(0., f64::max)
}

fn energy(taps: &[Tap], c: usize) -> f64 {
    taps[0].weight[c] + 2. * taps[1..].iter().map(|t| t.weight[c]).sum::<f64>()
}

/// Weight of the centre in the authors' own tables, recomputed to six digits.
const CENTRES: [(u32, [f64; 3]); 3] =
    [(25, [0.530605, 0.613514, 0.739601]), (17, [0.536343, 0.624624, 0.748867]), (11, [0.560479, 0.669086, 0.784728])];

#[test]
fn the_authors_centre_weights() {
    let sigma = widest(&skin());
    let apart = |taps: u32, centre: [f64; 3], row: &[Tap]| {
        let d = (0..3).map(|c| (row[0].weight[c] - centre[c]).abs()).fold(0., f64::max);
        println!("{taps} taps: centre {:.6?}, {d:.1e} from the authors'", row[0].weight);
        d
    };
    for (taps, centre) in CENTRES {
        let row = of_authors(sigma, taps);
        assert_eq!(row.len(), taps as usize / 2 + 1);
        assert!(apart(taps, centre, &row) < 5.5e-7, "six digits");
        for c in 0..3 {
            assert!((energy(&row, c) - 1.).abs() < 1e-12, "light is kept");
        }
        // The twin: two taps more are another kernel.
        assert!(apart(taps, centre, &of_authors(sigma, taps + 2)) > 1e-3);
    }
    // In mm: 3 for many taps, 2 for few, of the skin it was made for; twice the skin, twice the kernel.
    let end = |sigma, taps| of_authors(sigma, taps).last().expect("taps").offset_mm;
    assert!(
        (end(sigma, 25) - 3.).abs() < 1e-3
            && (end(sigma, 17) - 2.).abs() < 1e-3
            && (end(2. * sigma, 17) - 4.).abs() < 2e-3
    );
}

/// What a kernel makes of a step edge at distance x, taps between pixels: linear light between taps is what it is exact for.
fn edge(taps: &[Tap], c: usize, x: f64, ramp: f64) -> f64 {
    let light = |x: f64| (0.5 + x / ramp).clamp(0., 1.);
    let side = |t: &Tap| t.weight[c] * (light(x + t.offset_mm) + light(x - t.offset_mm));
    taps[0].weight[c] * light(x) + taps[1..].iter().map(side).sum::<f64>()
}

/// The same from the profile itself: each Gaussian along a line is one-dimensional, and the edge its integral.
fn exact_edge(list: &[Gaussian], c: usize, x: f64, ramp: f64) -> f64 {
    let rise = |v: f64, a: f64| {
        let s = v.sqrt();
        let z = a / s;
        a * 0.5 * libm::erfc(-z / std::f64::consts::SQRT_2) + s * (-0.5 * z * z).exp() / TAU.sqrt()
    };
    list.iter().map(|g| g.weight[c] * (rise(g.variance, x + ramp / 2.) - rise(g.variance, x - ramp / 2.)) / ramp).sum()
}

#[test]
fn the_profiles_kernel_converges_to_its_integral_along_a_line() {
    let list = skin();
    let error = |taps: u32, list: &[Gaussian]| {
        let row = of_profile(list, taps);
        for c in 0..3 {
            assert!((energy(&row, c) - 1.).abs() < 1e-12, "light is kept");
            assert!(row.iter().all(|t| t.weight[c] >= -1e-15), "no weight is negative");
        }
        let at = |i: i32| f64::from(i) * 0.05;
        let one = |x: f64, c: usize| (edge(&row, c, x, 1.) - exact_edge(&skin(), c, x, 1.)).powi(2);
        ((-200..=200).flat_map(|i| (0..3).map(move |c| one(at(i), c))).sum::<f64>() / 1203.).sqrt()
    };
    let errors: Vec<f64> = [11, 17, 25, 49, 97, 193].map(|taps| error(taps, &list)).into();
    println!("rms over a soft edge with 11, 17, 25, 49, 97, 193 taps: {errors:.6?}");
    assert!(errors.windows(2).all(|w| w[1] < w[0]), "more taps, less error");
    // What is left is the tail beyond three sigma.
    assert!(errors[5] < 3e-4);
    // The twin: a profile half as wide does not converge to this one.
    let narrow: Vec<Gaussian> = list.iter().map(|g| Gaussian { variance: g.variance / 4., ..*g }).collect();
    assert!(error(193, &narrow) > 10. * errors[5]);
}

/// The profile over distance in space, integrated over the far side of a slab `s` mm thick.
fn slab(profile: &Profile, s: f64) -> [f64; 3] {
    std::array::from_fn(|c| {
        let ring = |r: f64| TAU * r * profile.radial((r * r + s * s).sqrt())[c];
        piecewise(vec![0., 0.1, 0.3, 1., 3., 10., 30.], ring)
    })
}

#[test]
fn what_passes_through() {
    let (list, profile) = (skin(), Profile::resolve("skin").expect("built in"));
    for s in [0.2, 1., 3., 6.] {
        let (exact, own, published) = (slab(&profile, s), transmitted(&list, s, 2.), transmitted(&list, s, 1.));
        println!("{s} mm: a slab lets {exact:.5?} through, ours {own:.5?}, as published {published:.5?}");
        for c in 0..3 {
            assert!((exact[c] - own[c]).abs() < 1e-9);
        }
        assert!(exact[0] - published[0] > 1e-3, "the twin");
        assert!(own[0] > own[1] && own[1] >= own[2], "red goes furthest");
    }
    assert_eq!(transmitted(&list, 0., 1.).map(|t| (t * 1e9).round() / 1e9), [1.; 3]);
    let flat = vec![Gaussian { variance: 0., weight: [1.; 3] }];
    assert_eq!(transmitted(&flat, 1., 1.), [0.; 3]);
    assert_eq!(of_profile(&flat, 11), [Tap { offset_mm: 0., weight: [1.; 3] }]);
}
