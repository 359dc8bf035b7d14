//! Truth against what is known in closed form: sphere, plane, cylinder; its own estimate against its true error. Every check
//! has a twin that feeds it something wrong and sees it caught.

use pdss::frame::{Inputs, Output};
use pdss::scene::{Camera, Light, LightKind, Scene, direction_from};
use pdss::settings::{Settings, Size};
use pdss::skin::profile::{Gaussian, Profile};
use pdss::skin::sphere;
use pdss::truth::eye::{Eye, Seen};
use pdss::truth::surface::Surface;
use pdss::truth::{self, Effort, Truth, Window, lighting, metrics};
use std::f64::consts::PI;

type Outcome = Result<(), Box<dyn std::error::Error>>;

struct Solved {
    truth: Truth,
    seen: Vec<Option<Seen>>,
    light: glam::DVec3,
}

struct Asked<'a> {
    shape: &'a str,
    profile: Profile,
    light: [f64; 2],
    /// Instead of the directional one.
    other: Option<Light>,
    camera: Option<[f64; 3]>,
    shadows: bool,
    window: Option<Window>,
    effort: Effort,
}

fn asked(shape: &str, profile: Profile, light: [f64; 2]) -> Asked<'_> {
    Asked { shape, profile, light, other: None, camera: None, shadows: false, window: None, effort: EFFORT }
}

const SIZE: u32 = 40;
const EFFORT: Effort = Effort { samples: 200_000, max_error: 1e-3, opening: 0.12 };

fn solve(ask: &Asked<'_>) -> Result<Solved, Box<dyn std::error::Error>> {
    let mut scene = Scene::shape(ask.shape)?;
    scene.assign_profile(None, 0)?;
    let camera = match ask.camera {
        Some([yaw, pitch, mm]) => Camera::orbit(yaw, pitch, mm, None, 30., &scene),
        None => Camera::default_for(&scene, 30., 1.),
    };
    let direction = direction_from(ask.light[0], ask.light[1]);
    let light = ask.other.clone().unwrap_or_else(|| Light::directional(ask.light[0], ask.light[1], 1.));
    let settings =
        Settings { size: Size { width: SIZE, height: SIZE }, no_shadows: !ask.shadows, ..Settings::default() };
    let profiles = vec![ask.profile.clone()];
    let inputs =
        Inputs { scene: &scene, camera, lights: vec![light], profiles, settings, timing: None, output: Output::Linear };
    let truth = truth::solve(&inputs, ask.window, &ask.effort, |_| ())?;
    let w = truth.window;
    let eye = Eye::new(&inputs.camera, [SIZE; 2], &scene);
    let surface = Surface::new(&scene, &inputs.camera, [inputs.settings.size.width, inputs.settings.size.height]);
    let seen = eye.see(&surface, w.x.into(), w.y.into(), w.width as usize, w.height as usize);
    Ok(Solved { truth, seen, light: direction })
}

/// Root mean square and greatest difference from what a function of the place says.
fn apart(s: &Solved, exact: impl Fn(&Seen) -> [f64; 3]) -> (f64, f64) {
    let errors: Vec<f64> = s
        .seen
        .iter()
        .zip(&s.truth.pixels)
        .filter_map(|(seen, p)| Some((exact(seen.as_ref()?), p)))
        .flat_map(|(e, p)| (0..3).map(move |c| f64::from(p[c]) - e[c]))
        .collect();
    assert!(errors.len() > 300, "{} values are no comparison", errors.len());
    let square: f64 = errors.iter().map(|e| e * e).sum();
    ((square / errors.len() as f64).sqrt(), errors.iter().fold(0., |m: f64, e| m.max(e.abs())))
}

fn skin() -> Result<Profile, Box<dyn std::error::Error>> {
    Ok(Profile::resolve("skin")?)
}

fn text_profile(body: &str) -> Result<Profile, Box<dyn std::error::Error>> {
    Ok(Profile::parse(body, "test", "test")?)
}

#[test]
fn a_sphere_is_the_series_and_the_estimate_is_honest() -> Outcome {
    let gaussians = skin()?.gaussians().gaussians;
    for radius in [0.5, 1., 2., 5., 10., 20., 50., 100., 1000.] {
        let s = solve(&asked(&format!("shape:sphere:{radius}"), skin()?, [70., 20.]))?;
        let mu = |seen: &Seen| seen.place.position.normalize().dot(s.light);
        let (rms, max) = apart(&s, |seen| sphere::exitance_normalised(mu(seen), radius, &gaussians));
        let (unnormalised, _) = apart(&s, |seen| sphere::exitance(mu(seen), radius, &gaussians));
        let (lambert, _) = apart(&s, |seen| [mu(seen).max(0.); 3]);
        let own = s.truth.error;
        println!(
            "radius {radius:6}: rms {rms:.1e} max {max:.1e}, estimated {:.1e}; lambert {lambert:.1e} off, {:.1} s",
            own.rms, s.truth.seconds
        );
        assert!(rms < 8e-4, "radius {radius}: {rms:e}");
        assert!(rms < 3. * own.rms && own.rms < 3. * rms.max(2e-5), "radius {radius}: {rms:e} is not {own:?}");
        assert!(lambert > rms, "the twin: at {radius} lambert would pass");
        assert!(radius > 2. || unnormalised > 10. * rms, "the twin: the mass at {radius} goes unnoticed");
    }
    Ok(())
}

#[test]
fn burley_and_narrow_profiles_are_theirs() -> Outcome {
    let burley = text_profile("burley_d_mm = [1.0, 0.3, 0.05]")?;
    let s = solve(&asked("shape:sphere:10", burley.clone(), [90., 0.]))?;
    let fit = burley.gaussians().gaussians;
    let mu = |seen: &Seen| seen.place.position.normalize().dot(s.light);
    let exact = |seen: &Seen| [1.0, 0.3, 0.05].map(|d: f64| sphere::burley(mu(seen), d / 10.));
    let ((rms, _), (fitted, _)) =
        (apart(&s, exact), apart(&s, |seen| sphere::exitance_normalised(mu(seen), 10., &fit)));
    println!("burley: rms {rms:.1e}, estimated {:.1e}; its Gaussians {fitted:.1e} off", s.truth.error.rms);
    assert!(rms < 5e-4, "{rms:e}");
    // A delta beside a wide Gaussian, and one so narrow that no sample can see it.
    let mixed = "gaussians = [{ variance_mm2 = 0.0, weight = [1, 0, 0.5] }, { variance_mm2 = 1e-12, weight = [0, 1, 0] }, \
                 { variance_mm2 = 4.0, weight = [0, 0, 0.5] }]";
    let s = solve(&asked("shape:sphere:10", text_profile(mixed)?, [90., 0.]))?;
    let mu = |seen: &Seen| seen.place.position.normalize().dot(s.light);
    let wide = [Gaussian { variance: 4., weight: [0.5; 3] }];
    let (mass, value) = (sphere::mass(10., &wide)[0], |m: f64| sphere::exitance(m, 10., &wide)[0]);
    let exact = |seen: &Seen| {
        let c = mu(seen);
        [c.max(0.), c.max(0.), (0.5 * c.max(0.) + value(c)) / (0.5 + mass)]
    };
    let (rms, max) = apart(&s, exact);
    println!("deltas: rms {rms:.1e} max {max:.1e}");
    assert!(rms < 5e-4, "{rms:e}");
    let (wrong, _) = apart(&s, |seen| [mu(seen).max(0.); 3]);
    assert!(wrong > 10. * rms, "the twin: without the wide Gaussian {wrong:e}");
    Ok(())
}

#[test]
fn a_plane_is_lambert() -> Outcome {
    let window = Some(Window { x: 14, y: 14, width: 12, height: 12 });
    let s = solve(&Asked { window, ..asked("shape:plane", skin()?, [30., 40.]) })?;
    let (rms, _) = apart(&s, |_| [s.light.y; 3]);
    let (wrong, _) = apart(&s, |_| [s.light.y * 1.001; 3]);
    assert!(rms < 1e-6 && wrong > 1e-4, "plane {rms:e}, twin {wrong:e}");
    Ok(())
}

#[test]
fn a_cylinder_is_its_fourier_series() -> Outcome {
    let gaussians = skin()?.gaussians().gaussians;
    for (radius, away) in [(1., 8.), (5., 40.), (10., 80.)] {
        let shape = format!("shape:cylinder:{radius}");
        let effort = Effort { samples: 400_000, max_error: 5e-4, ..EFFORT };
        let s = solve(&Asked { camera: Some([10., 0., away]), effort, ..asked(&shape, skin()?, [80., 0.]) })?;
        let mu = |seen: &Seen| seen.place.normal.dot(s.light);
        let (rms, max) = apart(&s, |seen| on_cylinder(mu(seen), radius, &gaussians));
        let (wrong, _) = apart(&s, |seen| sphere::exitance_normalised(mu(seen), radius, &gaussians));
        let own = s.truth.error.rms;
        println!("cylinder of {radius} mm: rms {rms:.1e} max {max:.1e}, estimated {own:.1e}; as a sphere {wrong:.1e}");
        assert!(rms < 1e-3 && rms < 3. * own && wrong > 3. * rms, "{radius} mm: {rms:e}, twin {wrong:e}");
    }
    Ok(())
}

/// A Gaussian of chord distance on an endless cylinder lit across its axis. Along the axis it is a factor of its own; around it
/// exp(-k (1 - cos a)), k = r^2 / v, whose Fourier coefficients are I_n(k) / I_0(k); the lit half cosine's are 1/pi, 1/2 and
/// 2/pi (-1)^(m+1) / (4 m^2 - 1) for n = 2 m.
fn on_cylinder(mu: f64, radius: f64, gaussians: &[Gaussian]) -> [f64; 3] {
    let theta = mu.clamp(-1., 1.).acos();
    let (mut lit, mut mass) = ([0.; 3], [0.; 3]);
    for g in gaussians {
        let k = radius * radius / g.variance;
        let (ratios, held) = bessel(k);
        let part = |(n, ratio): (usize, &f64)| {
            let share = match n {
                0 => 1. / PI,
                1 => 0.5,
                n if n % 4 == 2 => 2. / PI / ((n * n - 1) as f64),
                n if n % 4 == 0 => -2. / PI / ((n * n - 1) as f64),
                _ => 0.,
            };
            share * ratio * (n as f64 * theta).cos()
        };
        let value: f64 = ratios.iter().enumerate().map(part).sum();
        for c in 0..3 {
            mass[c] += g.weight[c] * held;
            lit[c] += g.weight[c] * held * value;
        }
    }
    std::array::from_fn(|c| lit[c] / mass[c])
}

/// I_n(k) / I_0(k) for n from 0, and the mass sqrt(2 pi k) exp(-k) I_0(k) that a Gaussian has around a cylinder: Miller's
/// recurrence downwards, made whole by exp(k) = I_0 + 2 (I_1 + I_2 + ..).
fn bessel(k: f64) -> (Vec<f64>, f64) {
    let top = (40. + 9. * k.sqrt()) as usize;
    let mut all = vec![0.; top + 2];
    all[top] = 1e-280;
    for n in (1..=top).rev() {
        all[n - 1] = all[n + 1] + 2. * n as f64 / k * all[n];
        if all[n - 1] > 1e200 {
            all.iter_mut().for_each(|x| *x *= 1e-200);
        }
    }
    let whole = all[0] + 2. * all[1..].iter().sum::<f64>();
    let held = (2. * PI * k).sqrt() * all[0] / whole;
    (all.iter().map(|x| x / all[0]).collect(), held)
}

#[test]
fn the_fourier_series_is_the_quadrature_of_its_kernel() -> Outcome {
    let gaussians = skin()?.gaussians().gaussians;
    let mut worst = 0f64;
    for (radius, mu) in [(0.5, 0.3f64), (1., -0.2), (5., 0.), (5., 0.9), (20., -0.05)] {
        let (mut lit, mut mass) = ([0.; 3], [0.; 3]);
        for g in &gaussians {
            let k = radius * radius / g.variance;
            let end = (9. / k.sqrt()).min(PI);
            let step = end / 20_000.;
            for i in -20_000..20_000 {
                let a = (f64::from(i) + 0.5) * step;
                let w = (-k * (1. - a.cos())).exp() * step * radius / (2. * PI * g.variance).sqrt();
                for c in 0..3 {
                    mass[c] += g.weight[c] * w;
                    lit[c] += g.weight[c] * w * (mu.acos() + a).cos().max(0.);
                }
            }
        }
        let series = on_cylinder(mu, radius, &gaussians);
        worst = (0..3).map(|c| (series[c] - lit[c] / mass[c]).abs()).fold(worst, f64::max);
    }
    let (ratios, held) = bessel(1.);
    println!("series against midpoints: {worst:.1e}");
    // I_0(1) = 1.266065877752008, I_1(1) = 0.565159103992485 (Abramowitz & Stegun 1964, table 9.8).
    assert!((ratios[1] - 0.565_159_103_992_485 / 1.266_065_877_752_008).abs() < 1e-14, "{}", ratios[1]);
    assert!((held - (2. * PI).sqrt() / 1f64.exp() * 1.266_065_877_752_008).abs() < 1e-14, "{held}");
    assert!(worst < 1e-7, "{worst:e}");
    Ok(())
}

/// A plane under a light of each kind, skin: its irradiance, written out here, blurred by each Gaussian in the plane.
#[test]
fn a_plane_under_each_kind_of_light_is_a_convolution() -> Outcome {
    let gaussians = skin()?.gaussians().gaussians;
    let (place, cone) = ([8., 12., -3.], [0.9f64, 0.6]);
    let position = glam::Vec3::new(8., 12., -3.);
    let light = |kind| Some(Light { kind, color: [1.; 3], intensity: 1e-4, range_mm: None });
    let point = LightKind::Point { position };
    let (inner_cos, outer_cos) = (cone[0] as f32, cone[1] as f32);
    let spot = LightKind::Spot { position, direction: glam::Vec3::NEG_Y, inner_cos, outer_cos };
    let direction = direction_from(30., 40.).as_vec3();
    let kinds = [("point", point), ("spot", spot), ("directional", LightKind::Directional { direction })];
    let falls = |name: &str, x: f64, z: f64| {
        if name == "directional" {
            return 1e-4 * f64::from(direction.y);
        }
        let square = (x - place[0]).powi(2) + place[1] * place[1] + (z - place[2]).powi(2);
        let cosine = place[1] / square.sqrt();
        let t = if name == "spot" { ((cosine - cone[1]) / (cone[0] - cone[1])).clamp(0., 1.) } else { 1. };
        1e-4 * 1e6 / square * cosine * t * t
    };
    let blurred = |name: &str, p: glam::DVec3| -> [f64; 3] {
        let mut sum = [0.; 3];
        for g in &gaussians {
            let (n, reach) = (32, 5. * g.variance.sqrt());
            let at = |i: i32| (f64::from(i) + 0.5) / f64::from(n) * reach;
            let (mut value, mut all) = (0., 0.);
            for (u, v) in (-n..n).flat_map(|i| (-n..n).map(move |k| (at(i), at(k)))) {
                let w = (-(u * u + v * v) / (2. * g.variance)).exp();
                all += w;
                value += w * falls(name, p.x + u, p.z + v);
            }
            (0..3).for_each(|c| sum[c] += g.weight[c] * value / all);
        }
        sum
    };
    let window = Some(Window { x: 14, y: 14, width: 12, height: 12 });
    let run = |kind| -> Result<Solved, Box<dyn std::error::Error>> {
        let camera = Some([20., 60., 100.]);
        solve(&Asked { window, camera, other: light(kind), shadows: true, ..asked("shape:plane", skin()?, [0.; 2]) })
    };
    for (k, (name, kind)) in kinds.iter().enumerate() {
        let s = run(*kind)?;
        let most = s.truth.pixels.iter().map(|p| f64::from(p[0])).fold(0., f64::max);
        let (rms, _) = apart(&s, |seen| blurred(name, seen.place.position));
        let (sharp, _) = apart(&s, |seen| [falls(name, seen.place.position.x, seen.place.position.z); 3]);
        let (other, _) = apart(&s, |seen| blurred(kinds[(k + 1) % 3].0, seen.place.position));
        println!(
            "{name}: rms {:.1e} of {most:.3}; unblurred {:.1e}, another light {:.1e}",
            rms / most,
            sharp / most,
            other / most
        );
        assert!(rms < 1e-3 * most && other > 10. * rms, "{name}: {rms:e} of {most}, another light {other:e}");
        assert!(*name == "directional" || sharp > 4. * rms, "{name}: the twin: unblurred {sharp:e} against {rms:e}");
    }
    Ok(())
}

#[test]
fn the_two_halves_agree_as_the_estimate_says() -> Outcome {
    let s = solve(&Asked {
        shadows: true,
        camera: Some([0., 45., 60.]),
        ..asked("shape:torus:10,4", skin()?, [80., 15.])
    })?;
    let halves = &s.truth.halves;
    let differ = |scale: f64| {
        let squares =
            (halves[0].iter().flatten().zip(halves[1].iter().flatten())).map(|(a, b)| (0.5 * (a * scale - b)).powi(2));
        let covered = 3 * s.truth.pixels.iter().filter(|p| p[3] > 0.).count();
        (squares.sum::<f64>() / covered as f64).sqrt()
    };
    let (rms, noise) = (differ(1.), s.truth.error.noise);
    println!("half the difference of the halves {rms:.2e}, noise {noise:.2e}; one 1 % brighter {:.2e}", differ(1.01));
    assert!((rms / noise - 1.).abs() < 1e-9 && rms < 1e-3, "{rms:e} {noise:e}");
    assert!(halves[0] != halves[1], "independent samples do not agree to the bit");
    assert!(differ(1.01) > 3. * noise, "the twin: a biased half goes unnoticed");
    Ok(())
}

#[test]
fn a_convex_body_does_not_shade_itself_and_a_ring_does() -> Outcome {
    let profile = skin()?;
    let ask = |shape, shadows| {
        let camera = Some([0., 45., 80.]);
        Asked { shadows, camera, ..asked(shape, profile.clone(), [80., 15.]) }
    };
    let difference = |shape| -> Result<f64, Box<dyn std::error::Error>> {
        let (a, b) = (solve(&ask(shape, true))?, solve(&ask(shape, false))?);
        Ok(metrics::compare([SIZE; 2], &a.truth.pixels, &b.truth.pixels, None).whole.rmse)
    };
    let (sphere, torus) = (difference("shape:sphere:20")?, difference("shape:torus:10,4")?);
    println!("with and without shadows: sphere {sphere:.1e}, torus {torus:.1e}");
    assert!(sphere < 2e-4 && torus > 0.01, "sphere {sphere:e}, torus {torus:e}");
    Ok(())
}

#[test]
fn lights_have_the_units_of_the_shaders() {
    let at = |kind, range_mm, p: [f64; 3]| {
        let light = Light { kind, color: [1., 0.5, 0.], intensity: 8., range_mm };
        lighting::arrives(&light, p.into())
    };
    let point = LightKind::Point { position: glam::Vec3::ZERO };
    assert_eq!(at(point, None, [0., 2000., 0.]).irradiance, [2., 1., 0.], "8 cd at 2 m");
    assert_eq!(at(point, None, [0., 2000., 0.]).direction, glam::DVec3::NEG_Y);
    assert_eq!(at(point, Some(2000.), [0., 2000., 0.]).irradiance, [0.; 3], "faded at its range");
    assert_eq!(at(point, None, [0.; 3]).irradiance[0], 8e6, "held to 1 mm");
    let spot =
        LightKind::Spot { position: glam::Vec3::ZERO, direction: glam::Vec3::NEG_Y, inner_cos: 0.9, outer_cos: 0.8 };
    assert_eq!(at(spot, None, [0., -1000., 0.]).irradiance[0], 8.);
    assert_eq!(at(spot, None, [0., 1000., 0.]).irradiance[0], 0., "behind it");
    let half = at(spot, None, [(1f64 - 0.85 * 0.85).sqrt() * 1000., -850., 0.]).irradiance[0];
    assert!((half - 2.).abs() < 1e-4, "half way between the angles a quarter is left: {half}");
}
