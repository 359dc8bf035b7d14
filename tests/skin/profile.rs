use crate::twin::apart;
use pdss::scene::Scattering;
use pdss::skin::profile::{Fit, Gaussian, MAX_LEVELS, MAX_RADIUS_ENERGY, Profile, ProfileError, Shape, single_albedo};
use pdss::skin::sphere::{burley as burley_on_sphere, exitance_normalised};
use std::f64::consts::TAU;
use std::time::Instant;

fn burley(d: [f64; 3]) -> Profile {
    let (name, source) = (String::from("test"), String::new());
    Profile { name, source, shape: Shape::Burley { d }, ior: 1.4, albedo: None, lobes: None }
}

#[test]
fn every_built_in_resolves_under_its_own_name() {
    assert_eq!(Profile::names().len(), 13);
    for name in Profile::names() {
        let profile = Profile::resolve(name).unwrap();
        assert_eq!(profile.name, name);
        assert!(!profile.source.is_empty() && profile.max_radius_mm() > 0.0);
    }
    assert_eq!(Profile::resolve("milk").unwrap(), Profile::resolve("wholemilk").unwrap());
    assert_eq!(Profile::resolve("skin").unwrap().gaussians().error, 0.0);
}

#[test]
fn measured_coefficients_give_the_published_distances() {
    let known = [
        ("skin1", [0.677, 0.333, 0.201]),
        ("skin2", [0.661, 0.315, 0.225]),
        ("marble", [0.425, 0.343, 0.287]),
        ("wholemilk", [0.380, 0.299, 0.231]),
        ("skimmilk", [1.308, 0.750, 0.417]),
        ("cream", [0.131, 0.177, 0.266]),
        ("apple", [0.412, 0.392, 0.305]),
        ("potato", [1.29, 1.01, 0.513]),
        ("ketchup", [1.31, 0.236, 0.163]),
    ];
    for (name, expected) in known {
        let Shape::Burley { d } = Profile::resolve(name).unwrap().shape else { panic!("{name} is no Burley profile") };
        let error = apart(d, expected);
        println!("{name}: d = {d:.4?}, {error:.1e} from the table");
        assert!(error < if d[0] > 1.0 { 5.1e-3 } else { 5.1e-4 }, "{name}: {d:?}");
    }
}

/// Int 2 pi r f(r) dr by the trapezoid rule over log r.
fn planar(f: impl Fn(f64) -> [f64; 3]) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for i in 0..24_000 {
        let r = (-25.0 + 0.00125 * f64::from(i)).exp();
        let value = f(r);
        (0..3).for_each(|c| sum[c] += 0.00125 * TAU * r * r * value[c]);
    }
    sum
}

#[test]
fn profiles_are_normalised_and_know_their_moments() {
    for name in Profile::names() {
        let profile = Profile::resolve(name).unwrap();
        let energy = planar(|r| profile.radial(r));
        let mean = planar(|r| profile.radial(r).map(|x| r * x));
        let variance = planar(|r| profile.radial(r).map(|x| 0.5 * r * r * x));
        assert!(apart(energy, [1.0; 3]) < 1e-6, "{name}: {energy:?}");
        assert!(apart(mean, profile.mean_radius_mm()) < 1e-6 * mean[0].max(1.0), "{name}");
        assert!(apart(variance, profile.mean_variance()) < 1e-6 * variance[0].max(1.0), "{name}");
        let edge = profile.max_radius_mm();
        let inside = planar(|r| if r < edge { profile.radial(r) } else { [0.0; 3] });
        assert!(apart(inside, profile.enclosed(edge)) < 2e-3, "{name}: {inside:?}");
        let least = profile.enclosed(edge).into_iter().fold(1.0, f64::min);
        assert!((least - MAX_RADIUS_ENERGY).abs() < 1e-9);
        let double = profile.scaled(2.0);
        assert!((double.max_radius_mm() / edge - 2.0).abs() < 1e-9);
        assert!((double.radial(1.0)[0] * 4.0 / profile.radial(0.5)[0] - 1.0).abs() < 1e-12);
    }
    // 16.6 d, Christensen & Burley's own figure for 99.7 %.
    assert!((burley([1.0; 3]).max_radius_mm() - 16.6).abs() < 0.05);
}

fn check_fit(name: &str, profile: &Profile) -> Fit {
    let start = Instant::now();
    let fit = profile.gaussians();
    let took = start.elapsed();
    println!("{name}: {} levels, L1 error {:.4}, {:.1} ms", fit.gaussians.len(), fit.error, took.as_secs_f64() * 1e3);
    assert!(fit.gaussians.len() <= MAX_LEVELS);
    for c in 0..3 {
        let sum: f64 = fit.gaussians.iter().map(|g| g.weight[c]).sum();
        assert!((sum - 1.0).abs() < 1e-12, "{name}: channel {c} sums to {sum}");
        assert!(fit.gaussians.iter().all(|g| g.weight[c] >= 0.0 && g.variance >= 0.0));
    }
    assert_eq!(fit, profile.gaussians(), "the same twice");
    fit
}

/// The largest difference of exitance between a fit and Burley's own profile.
fn worst_on_spheres(d: [f64; 3], fit: &Fit) -> f64 {
    let radii = (0..=16).map(|i| 0.5 * 10_f64.powf(0.2 * f64::from(i)));
    let at =
        |mu: f64, r: f64| apart(exitance_normalised(mu, r, &fit.gaussians), d.map(|d| burley_on_sphere(mu, d / r)));
    let worst = |r: f64| (-20..=20).map(|i| at(f64::from(i) / 20.0, r)).fold(0.0, f64::max);
    radii.map(worst).fold(0.0, f64::max)
}

/// The L1 error of a fit, summed another way.
fn l1(profile: &Profile, gaussians: &[Gaussian]) -> f64 {
    let as_profile = Profile { shape: Shape::Gaussians(gaussians.to_vec()), ..profile.clone() };
    let apart =
        |r: f64| -> [f64; 3] { std::array::from_fn(|c| (profile.radial(r)[c] - as_profile.radial(r)[c]).abs()) };
    planar(apart).into_iter().fold(0.0, f64::max)
}

#[test]
fn burley_fits_six_gaussians() {
    for name in Profile::names() {
        let profile = Profile::resolve(name).unwrap();
        let fit = check_fit(name, &profile);
        assert!((l1(&profile, &fit.gaussians) - fit.error).abs() < 1e-4, "{name}: the error is not what it says");
        let Shape::Burley { d } = profile.shape else { continue };
        // Six levels for three channels: the further these lie apart, the fewer each has to itself.
        let spread = d.into_iter().fold(0.0, f64::max) / d.into_iter().fold(f64::INFINITY, f64::min);
        assert!(fit.error < 0.05 + 0.045 * spread.ln(), "{name}: {} at a spread of {spread}", fit.error);
        let shaded = worst_on_spheres(d, &fit);
        println!("  on spheres of 0.5 mm and more the exitance is off by {shaded:.4}");
        assert!(shaded < 0.25 * fit.error);
    }
    let grey = burley([0.5; 3]);
    let fit = check_fit("one distance", &grey);
    assert!(fit.error < 0.06);
    // A twin that must be told apart: the widest level dropped, its energy given to the next.
    let mut clipped = fit.gaussians.clone();
    let last = clipped.pop().unwrap();
    if let Some(g) = clipped.last_mut() {
        (0..3).for_each(|c| g.weight[c] += last.weight[c]);
    }
    assert!(l1(&grey, &clipped) > 1.5 * fit.error);
}

#[test]
fn the_stiff_and_the_empty_fit() {
    let stiff = check_fit("channels 1:100:10000", &burley([10.0, 0.1, 0.001]));
    assert!(stiff.error < 0.6);
    let tiny = check_fit("1e-9 mm", &burley([1e-9; 3]));
    let huge = check_fit("1e9 mm", &burley([1e9; 3]));
    assert!((tiny.error - huge.error).abs() < 1e-6, "the fit has a scale of its own");
    let none = check_fit("nothing", &burley([0.0; 3]));
    assert_eq!(none, Fit { gaussians: vec![Gaussian { variance: 0.0, weight: [1.0; 3] }], error: 0.0 });
    let some = check_fit("one channel without extent", &burley([1.0, 0.0, 1.0]));
    assert_eq!(some.gaussians[0], Gaussian { variance: 0.0, weight: [0.0, 1.0, 0.0] });
    let flat = Profile::resolve("skin").unwrap().scaled(0.0);
    assert_eq!((flat.max_radius_mm(), flat.mean_variance()), (0.0, [0.0; 3]));
    assert_eq!(flat.radial(0.1), [0.0; 3]);
    assert_eq!(flat.radial(0.0), [f64::INFINITY; 3]);
    // More Gaussians than levels: reduced, and honest about it.
    let many = (0..12).map(|i| Gaussian { variance: 0.01 * 2.0_f64.powi(i), weight: [1.0 / 12.0; 3] }).collect();
    let reduced = check_fit("twelve Gaussians", &Profile { shape: Shape::Gaussians(many), ..burley([0.0; 3]) });
    assert!(reduced.error < 0.05);
}

#[test]
fn a_bad_file_is_one_clear_line() {
    let shape = "burley_d_mm = [1, 1, 1]\n";
    for (text, line, says) in [
        (format!("{shape}colour = 3\n"), 2, "unknown field `colour`"),
        (String::from("\nburley_d_mm = [1.0, -1.0, 1.0]"), 2, "none may be negative"),
        (String::from("burley_d_mm = [nan, 1.0, 1.0]"), 1, "NaN"),
        (String::from("burley_d_mm = [1.0, 1.0]"), 1, "length"),
        (String::from("name = \"x\"\n"), 1, "exactly one of gaussians"),
        (format!("{shape}sigma_a_per_mm = [1, 1, 1]"), 2, "exactly one of gaussians"),
        (format!("{shape}ior = 0.5"), 2, "1..10"),
        (format!("{shape}ior = nan"), 2, "1..10"),
        (format!("{shape}albedo = [0.5, 1.5, 0.5]"), 2, "0..1"),
        (String::from("sigma_s_prime_per_mm = [1,1,1]\nsigma_a_per_mm = [1,1,1]"), 1, "needs albedo"),
        (String::from("albedo=[1,1,1]\nsigma_s_prime_per_mm = [0,1,1]\nsigma_a_per_mm = [0,1,1]"), 2, "infinite"),
        (
            String::from(
                "gaussians = [\n{ variance_mm2 = 1, weight = [1,1,1] },\n{ variance_mm2 = -1, weight = [1,1,1] }]",
            ),
            3,
            "negative",
        ),
        (String::from("gaussians = [{ variance_mm2 = 1, weight = [1,0,1] }]"), 1, "some energy"),
        (String::from("gaussians = []"), 1, "some energy"),
        (String::from("burley_d_mm = ["), 1, ""),
    ] {
        let error = Profile::parse(&text, "a.toml", "a").unwrap_err();
        let shown = error.to_string();
        println!("{shown}");
        assert!(shown.contains(says) && !shown.contains('\n'), "{shown:?} should say {says:?}");
        assert!(shown.starts_with(&format!("a.toml:{line}: ")), "{shown:?} should name line {line}");
        assert!(matches!(error, ProfileError::Invalid { .. }));
    }
    let unknown = Profile::resolve("skni").unwrap_err().to_string();
    assert!(unknown.contains("'skni'") && unknown.contains("skin1"), "{unknown}");
    let missing = Profile::resolve("no/such/file.toml").unwrap_err().to_string();
    assert!(missing.contains("no/such/file.toml"), "{missing}");
}

#[test]
fn a_good_file_is_read() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("wax.toml");
    std::fs::write(
        &path,
        "gaussians = [{ variance_mm2 = 2, weight = [1, 2, 3] }, { variance_mm2 = 4.0, weight = [1, 2, 1] }]",
    )
    .unwrap();
    let wax = Profile::resolve(path.to_str().unwrap()).unwrap();
    assert_eq!((wax.name.as_str(), wax.ior), ("wax", 1.4));
    assert_eq!(wax.mean_variance(), [3.0, 3.0, 2.5]);
    let text = "albedo = [1, 1, 1]\nsigma_s_prime_per_mm = [2, 2, 2]\nsigma_a_per_mm = [0, 0, 0]\nior = 1.3";
    let white = Profile::parse(text, "t", "t").unwrap();
    assert_eq!(white.albedo, Some([1.0; 3]));
    assert!(matches!(white.shape, Shape::Burley { d } if (d[0] - 0.5 / 1.04).abs() < 1e-12));
}

/// A volume is Burley's profile by its mean free path: of an isotropic one d = l / s(A), l = distance / -ln(colour).
#[test]
fn a_volume_has_the_distances_that_its_attenuation_gives() {
    let volume = |g: f64| Scattering {
        distance_mm: 2.0,
        attenuation: [(-1f64).exp(), (-2f64).exp(), (-4f64).exp()],
        multiscatter: [0.8, 0.5, 0.1],
        anisotropy: g,
    };
    let distances = |g: f64| match Profile::of_volume("wax", &volume(g), 1.4).shape {
        Shape::Burley { d } => d,
        Shape::Gaussians(_) => unreachable!("a volume is Burley's"),
    };
    // s(0.8) = 1.1, s(0.5) = 1.715, s(0.1) = 3.515; l = 2, 1, 0.5.
    let expected = [2.0 / 1.1, 1.0 / 1.715, 0.5 / 3.515];
    for (d, e) in distances(0.0).into_iter().zip(expected) {
        assert!((d / e - 1.0).abs() < 1e-12, "{d} where {e} should be");
    }
    // Nothing scatters at 0, all at 1; forward scattering carries light further, and only what scatters.
    assert!(single_albedo(0.0, 0.0) < 0.005 && single_albedo(1.0, 0.0) > 0.9999);
    let (ahead, still) = (distances(0.5), distances(0.0));
    for c in 0..3 {
        let albedo = single_albedo(volume(0.5).multiscatter[c], 0.5);
        let similar = 1.0 / (1.0 - 0.5 * albedo);
        assert!((ahead[c] / still[c] / similar - 1.0).abs() < 1e-12);
        assert!(similar > 1.05, "an anisotropy that is not read would pass");
    }
}
