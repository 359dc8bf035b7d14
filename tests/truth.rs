//! Truth against what is known in closed form: sphere, plane, cylinder; its own estimate against its true error. Every check
//! has a twin that feeds it something wrong and sees it caught.

use pdss::frame::{Inputs, Output};
use pdss::scene::{Camera, Light, LightKind, Scene};
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
    camera: Option<[f64; 3]>,
    shadows: bool,
    window: Option<Window>,
}

fn asked(shape: &str, profile: Profile, light: [f64; 2]) -> Asked<'_> {
    Asked { shape, profile, light, camera: None, shadows: false, window: None }
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
    let light = Light::directional(ask.light[0], ask.light[1], 1.);
    let LightKind::Directional { direction } = light.kind else { return Err("a directional light".into()) };
    let settings =
        Settings { size: Size { width: SIZE, height: SIZE }, no_shadows: !ask.shadows, ..Settings::default() };
    let profile = Some(ask.profile.clone());
    let inputs =
        Inputs { scene: &scene, camera, lights: vec![light], profile, settings, timing: None, output: Output::Linear };
    let truth = truth::solve(&inputs, ask.window, &EFFORT, |_| ())?;
    let w = truth.window;
    let eye = Eye::new(&inputs.camera, [SIZE; 2], &scene);
    let surface = Surface::new(&scene, &inputs.camera);
    let seen = eye.see(&surface, w.x.into(), w.y.into(), w.width as usize, w.height as usize);
    Ok(Solved { truth, seen, light: direction.as_dvec3() })
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
fn a_plane_is_lambert_and_a_cylinder_its_ring() -> Outcome {
    let window = Some(Window { x: 14, y: 14, width: 12, height: 12 });
    let s = solve(&Asked { window, ..asked("shape:plane", skin()?, [30., 40.]) })?;
    let (rms, _) = apart(&s, |_| [s.light.y; 3]);
    let (wrong, _) = apart(&s, |_| [s.light.y * 1.001; 3]);
    assert!(rms < 1e-6 && wrong > 1e-4, "plane {rms:e}, twin {wrong:e}");

    let gaussians = skin()?.gaussians().gaussians;
    let radius = 5.;
    let s = solve(&Asked { camera: Some([10., 0., 40.]), ..asked("shape:cylinder:5", skin()?, [80., 0.]) })?;
    let mu = |seen: &Seen| seen.place.normal.dot(s.light);
    let (rms, max) = apart(&s, |seen| on_cylinder(mu(seen), radius, &gaussians));
    let (wrong, _) = apart(&s, |seen| sphere::exitance_normalised(mu(seen), radius, &gaussians));
    println!("cylinder: rms {rms:.1e} max {max:.1e}; as a sphere {wrong:.1e}");
    assert!(rms < 1e-3 && wrong > 3. * rms, "cylinder {rms:e}, twin {wrong:e}");
    Ok(())
}

/// A Gaussian of chord distance on an endless cylinder: along it a factor, around it exp(-k (1 - cos)), by midpoints.
fn on_cylinder(mu: f64, radius: f64, gaussians: &[Gaussian]) -> [f64; 3] {
    let theta = mu.clamp(-1., 1.).acos();
    let (mut lit, mut mass) = ([0.; 3], [0.; 3]);
    for g in gaussians {
        let k = radius * radius / g.variance;
        let end = (9. / k.sqrt()).min(PI);
        let step = end / 2000.;
        for i in -2000..2000 {
            let a = (f64::from(i) + 0.5) * step;
            let w = (-k * (1. - a.cos())).exp() * step * radius / (2. * PI * g.variance).sqrt();
            for c in 0..3 {
                mass[c] += g.weight[c] * w;
                lit[c] += g.weight[c] * w * (theta + a).cos().max(0.);
            }
        }
    }
    std::array::from_fn(|c| lit[c] / mass[c])
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
