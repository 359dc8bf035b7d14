//! Burley's diffusion as samples: the inverse distribution, the fit to other profiles, wrap lighting.
use pdss::skin::burley::{cdf, fit_d, inverse_cdf, wrap};
use pdss::skin::profile::{Gaussian, Profile, Shape};
use pdss::skin::sphere;

#[test]
fn the_inverse_distribution() {
    let worst = |inverse: &dyn Fn(f64) -> f64| {
        let places = (1..20_000).map(|i| f64::from(i) / 20_000.).chain((3..16).flat_map(|e| {
            let small = 10f64.powi(-e);
            [small, 1. - small]
        }));
        places.map(|xi| (cdf(inverse(xi)) - xi).abs()).fold(0., f64::max)
    };
    // Xie et al. 2020: a fit, 2 % off in the median.
    let fitted = |xi: f64| ((2. - 2.5715) * xi - 2.) * (1. - xi).ln();
    let (own, other) = (worst(&inverse_cdf), worst(&fitted));
    println!("cdf(inverse(xi)) - xi: {own:.1e}; of the fit of Xie et al. {other:.1e}");
    assert!(own < 1e-12);
    assert!(other > 1e-3, "the twin");
    assert_eq!((inverse_cdf(0.), inverse_cdf(1.), inverse_cdf(-1.)), (0., f64::INFINITY, 0.));
    // Quantiles as published, in d.
    for (xi, x) in [(0.5, 1.55), (0.9, 6.06), (0.95, 8.13), (0.99, 12.95), (0.997, 16.6)] {
        assert!((inverse_cdf(xi) - x).abs() < 0.06, "{xi}: {}", inverse_cdf(xi));
    }
    // Small shares keep their digits: the density at 0 is 1/2.
    assert!((inverse_cdf(1e-12) / 2e-12 - 1.).abs() < 1e-9);
}

fn burley(d: [f64; 3]) -> Profile {
    Profile { name: "b".into(), source: String::new(), shape: Shape::Burley { d }, ior: 1.4, albedo: None, lobes: None }
}

#[test]
fn the_nearest_burley() {
    let d = [0.7, 0.3, 0.2];
    assert_eq!(fit_d(&burley(d)), d);
    // Through six Gaussians and back; all six serve one distance.
    let six = burley([0.5; 3]).gaussians();
    let back = fit_d(&Profile { shape: Shape::Gaussians(six.gaussians), ..burley(d) });
    println!("0.5 as Gaussians, {:.3} apart, and back: {:.4}", six.error, back[0]);
    assert!((back[0] / 0.5 - 1.).abs() < six.error);
    let skin = Profile::resolve("skin").expect("built in");
    let own = fit_d(&skin);
    let apart = |factor: f64, c: usize| {
        let at = |i: i32| 10f64.powf(f64::from(i) / 50.);
        (-100..100).map(|i| (skin.enclosed(at(i))[c] - cdf(at(i) / (own[c] * factor))).powi(2)).sum::<f64>()
    };
    println!("skin: d {own:.4?} mm, mean radius {:.3?} mm", skin.mean_radius_mm());
    for c in 0..3 {
        assert!(apart(1., c) < apart(1.03, c) && apart(1., c) < apart(0.97, c), "no other is nearer");
    }
    let still = Profile { shape: Shape::Gaussians(vec![Gaussian { variance: 0., weight: [1.; 3] }]), ..burley(d) };
    assert_eq!(fit_d(&still), [0.; 3]);
}

/// Energy kept, and near the sphere as far as was published; at no curvature a plain cosine.
#[test]
fn wrapped_cosines() {
    assert_eq!(wrap(0.), 0.);
    let lit = |mu: f64, w: f64| (mu + w).max(0.) / (1. + w).powi(2);
    let n = 4000;
    let mean = |f: &dyn Fn(f64) -> f64| {
        (0..n).map(|i| f(-1. + (f64::from(i) + 0.5) * 2. / f64::from(n))).sum::<f64>() / f64::from(n)
    };
    let mut worst = (0f64, 0f64);
    for x in [0.01, 0.022, 0.05, 0.1, 0.2, 0.3, 0.5, 1.] {
        let w = wrap(x);
        let rms = |w: f64| mean(&|mu| (lit(mu, w) - sphere::burley(mu, x)).powi(2)).sqrt();
        let energy = 4. * mean(&|mu| lit(mu, w));
        println!("x {x}: w {w:.3}, energy {energy:.5}, rms {:.4}; of a plain cosine {:.4}", rms(w), rms(0.));
        worst = (worst.0.max(rms(w)), worst.1.max(rms(0.)));
        assert!(rms(w) < rms(0.), "nearer than a plain cosine");
        if w <= 1. {
            assert!((energy - 1.).abs() < 1e-3);
        }
    }
    assert!(worst.0 < 0.055 && worst.1 > 0.1, "{worst:?}");
}
