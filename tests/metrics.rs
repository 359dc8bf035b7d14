//! Error metrics: each catches a wrong picture, FLIP against the authors' own program, bands against closed forms.

use pdss::frame::{Inputs, Output};
use pdss::scene::{Camera, Light, Scene};
use pdss::settings::{Settings, Size};
use pdss::skin::profile::Profile;
use pdss::truth::flip::{self, Exposures};
use pdss::truth::{self, Effort, bands::band, metrics};

type Outcome = Result<(), Box<dyn std::error::Error>>;

const SIZE: [usize; 2] = [64, 48];

/// A wave, an edge and dots, in a channel each.
fn drawn(shift: f64, scale: f64) -> Vec<[f64; 3]> {
    let pixel = |i: usize| {
        let (x, y) = (i % SIZE[0], i / SIZE[0]);
        let (u, v) = (x as f64, y as f64);
        let wave = 0.5 + 0.5 * (0.37 * (u + shift)).sin() * (0.23 * v).cos();
        let edge = if u + 0.5 * v > 40. + shift { 0.8 } else { 0.1 };
        let dots = if (x * 7 + y * 13).is_multiple_of(11) { 0.6 } else { 0. };
        [wave, edge, (0.2 + dots + 0.3 * wave).min(1.)].map(|c| c * scale)
    };
    (0..SIZE[0] * SIZE[1]).map(pixel).collect()
}

fn mean(map: &[f64]) -> f64 {
    map.iter().sum::<f64>() / map.len() as f64
}

/// Greatest distance from what the authors' program gives: its mean, and five of its pixels.
fn apart(map: &[f64], all: f64, five: [f64; 5]) -> f64 {
    let at = [(0, 0), (5, 40), (31, 20), (40, 10), (63, 47)];
    let far = at.iter().zip(five).map(|(&(x, y), e)| (map[y * SIZE[0] + x] - e).abs()).fold(0., f64::max);
    far.max((mean(map) - all).abs())
}

/// Expected numbers: flip-evaluator 1.7 (NVIDIA, f32) on these pictures in linear RGB, its defaults.
#[test]
fn flip_is_that_of_its_authors() {
    let (a, b) = (drawn(0., 1.), drawn(1.5, 0.9));
    let map = flip::ldr(SIZE, &a, &b);
    let off = apart(&map, 0.353_565_1, [0.307_855, 0.351_204, 0.798_508, 0.490_967, 0.217_452]);
    let (grey, lighter) = (vec![[0.25; 3]; a.len()], vec![[0.275; 3]; a.len()]);
    let flat = apart(&flip::ldr(SIZE, &grey, &lighter), 0.104_947_5, [0.104_945; 5]);
    let (a, b) = (drawn(0., 6.), drawn(1.5, 5.4));
    let exposures = Exposures::of(&a, |_| true).expect("it is not black");
    let bright = apart(
        &flip::hdr(SIZE, &a, &b, exposures),
        0.274_398_4,
        [0.189_203, 0.469_224, 0.699_969, 0.367_358, 0.088_739],
    );
    let ends = (exposures.first + 1.278_522_4).abs().max((exposures.last + 0.798_716_8).abs());
    println!("FLIP off by {off:.1e}, flat by {flat:.1e}, HDR by {bright:.1e}; exposures by {ends:.1e}");
    // Their weights of luminance have four digits, these all.
    assert!(off < 1e-4 && flat < 1e-4 && bright < 1e-4 && ends < 1e-4 && exposures.count == 2);
    // Twins: another pair of pictures, and the same pair a pixel aside, are told from the expected ones.
    let other = apart(&map, 0.274_398_4, [0.189_203, 0.469_224, 0.699_969, 0.367_358, 0.088_739]);
    let moved = apart(&flip::ldr(SIZE, &drawn(0., 1.), &drawn(2.5, 0.9)), 0.353_565_1, [0.; 5]);
    assert!(other > 0.02 && moved > 0.02, "{other} {moved}");
}

#[test]
fn flip_is_nothing_for_the_same_and_grows_with_the_wrong() {
    let a = drawn(0., 1.);
    assert!(flip::ldr(SIZE, &a, &a).iter().all(|f| *f == 0.));
    let by = |scale: f64| mean(&flip::ldr(SIZE, &a, &drawn(0., scale)));
    let (near, far) = (by(0.99), by(0.8));
    let (ab, ba) = (flip::ldr(SIZE, &a, &drawn(3., 1.)), flip::ldr(SIZE, &drawn(3., 1.), &a));
    println!("1 % darker {near:.4}, 20 % {far:.4}");
    assert!(0. < near && near < far && far < 1. && ab == ba);
    let black = vec![[0.; 3]; a.len()];
    let worst = mean(&flip::ldr(SIZE, &black, &vec![[1.; 3]; a.len()]));
    assert!(worst > 0.9 && worst <= 1., "black to white: {worst}");
    assert!(Exposures::of(&black, |_| true).is_none());
    // One pixel is a picture, too.
    assert!(flip::ldr([1, 1], &[[0.2; 3]], &[[0.4; 3]])[0] > 0.1);
}

#[test]
fn the_comparer_sees_what_is_wrong_and_leaves_out_what_it_must() {
    let reference = vec![[0.5, 0.25, 1., 1.]; 100];
    let same = metrics::compare([10, 10], &reference, &reference, None).whole;
    assert_eq!((same.rmse, same.max, same.psnr_db, same.pixels), (0., 0., None, 100));
    let mut picture = reference.clone();
    picture[7] = [0.5, 0.55, 1., 1.];
    picture[8][3] = 0.;
    picture[9][0] = f32::NAN;
    let mut bands = vec![0u8; 100];
    bands[7] = 1;
    let c = metrics::compare([10, 10], &picture, &reference, Some(&bands));
    assert_eq!((c.whole.pixels, c.uncommon, c.not_finite), (98, 1, 1));
    let expected = (0.09f64 / (3. * 98.)).sqrt();
    assert!((c.whole.rmse - expected).abs() < 1e-7 && (c.whole.max - 0.3).abs() < 1e-6, "{:?}", c.whole);
    assert!((c.bands[0].1.rmse_rgb[1] - 0.3).abs() < 1e-6 && c.bands[0].1.pixels == 1 && c.bands[1].1.pixels == 0);
    assert!(c.whole.bias > 0. && c.whole.bias_rgb[0] == 0.);
    // What the eye sees: exactly where something is wrong; a pixel that does not count is wrong nowhere.
    assert!(same.flip == 0. && c.whole.flip > 0. && c.bands[0].1.flip > c.whole.flip, "{c:?}");
    let (mut a, mut b) = (reference.clone(), reference.clone());
    (a[44], b[44]) = ([9., 9., 9., 1.], [0.; 4]);
    assert_eq!(metrics::compare([10, 10], &a, &b, None).whole.flip, 0.);
    // Bands survive the way through a picture.
    let all: Vec<u8> = (0..16).collect();
    assert_eq!(metrics::bands_of(&metrics::bands_picture(&all)), all);
    let heat = metrics::heat(&picture, &reference, 0.3);
    assert_eq!((&heat[28..32], &heat[0..4], &heat[32..36]), (&[255u8; 4][..], &[0, 0, 0, 255][..], &[0u8; 4][..]));
}

#[test]
fn each_number_catches_its_own_wrong() {
    let reference = vec![[0.5, 0.5, 0.5, 1.]; 1000];
    let against = |wrong: &dyn Fn(usize) -> f32| {
        let picture: Vec<[f32; 4]> = (0..1000).map(|i| [0.5 + wrong(i), 0.5, 0.5, 1.]).collect();
        metrics::compare([40, 25], &picture, &reference, None).whole
    };
    let (spike, tint, noise) = (
        against(&|i| if i == 500 { 0.4 } else { 0. }),
        against(&|_| 0.01),
        against(&|i| if i % 2 == 0 { 0.01 } else { -0.01 }),
    );
    println!("spike {spike:?}\ntint {tint:?}\nnoise {noise:?}");
    // A single pixel: the greatest sees it, the percentile must not; a tint: the bias; noise: no bias, yet the rms.
    assert!((spike.max - 0.4).abs() < 1e-6 && spike.p99 < 1e-6 && spike.rmse > 0.);
    assert!((tint.bias_rgb[0] - 0.01).abs() < 1e-6 && tint.bias_rgb[1] == 0. && (tint.p99 - 0.01).abs() < 1e-6);
    assert!(noise.bias.abs() < 1e-8 && (noise.rmse - tint.rmse).abs() < 1e-7);
    // The eye tells a tint from noise of the same size a pixel wide.
    assert!(tint.flip > 1.5 * noise.flip, "{} {}", tint.flip, noise.flip);
    let psnr = tint.psnr_db.expect("there is an error");
    assert!((psnr - 20. * (0.5f64 / (0.01 / 3f64.sqrt())).log10()).abs() < 1e-3, "{psnr}");
    assert!((tint.rel_mse - 1e-4 / 3. / 0.26).abs() < 1e-8, "{}", tint.rel_mse);
    // The same difference counts for more where it is dark.
    let dark = vec![[0.05, 0.05, 0.05, 1.]; 1000];
    let picture: Vec<[f32; 4]> = dark.iter().map(|p| [p[0] + 0.01, p[1], p[2], 1.]).collect();
    let dim = metrics::compare([40, 25], &picture, &dark, None).whole;
    assert!(dim.rel_mse > 10. * tint.rel_mse && dim.flip > tint.flip, "{dim:?}");
}

/// Share of covered pixels whose concave band is what `hollow` says of their place in world, mm; and how many are.
fn concave(
    shape: &str,
    camera: [f64; 3],
    hollow: impl Fn(glam::DVec3) -> bool,
) -> Result<(f64, usize), Box<dyn std::error::Error>> {
    let mut scene = Scene::shape(shape)?;
    scene.assign_profile(None, 0)?;
    let camera = Camera::orbit(camera[0], camera[1], camera[2], None, 30., &scene);
    let settings = Settings { size: Size { width: 96, height: 96 }, no_shadows: true, ..Settings::default() };
    let (lights, profiles) = (vec![Light::directional(20., 30., 1.)], vec![Profile::resolve("skin")?]);
    let inputs = Inputs { scene: &scene, camera, lights, profiles, settings, timing: None, output: Output::Linear };
    let effort = Effort { samples: 100_000, max_error: 1., ..Effort::default() };
    let truth = truth::solve(&inputs, None, &effort, |_| ())?;
    let surface =
        truth::surface::Surface::new(&scene, &inputs.camera, [inputs.settings.size.width, inputs.settings.size.height]);
    let seen = truth::eye::Eye::new(&inputs.camera, [96; 2], &scene).see(&surface, 0, 0, 96, 96);
    let (mut right, mut all, mut marked) = (0, 0, 0);
    for (s, b) in seen.iter().zip(&truth.bands).filter_map(|(s, b)| Some((s.as_ref()?, b))) {
        // Neighbours beyond a silhouette are left out of the fit; what remains there is not asked.
        if b & band::SILHOUETTE != 0 {
            continue;
        }
        let marks = b & band::CONCAVE != 0;
        all += 1;
        marked += usize::from(marks);
        right += usize::from(marks == hollow(s.place.position));
    }
    assert!(all > 500, "{all} pixels are no test");
    Ok((right as f64 / f64::from(all), marked))
}

#[test]
fn what_is_concave_is_marked_and_nothing_else() -> Outcome {
    let (sphere, none) = concave("shape:sphere:10", [0., 0., 45.], |_| false)?;
    assert_eq!((sphere, none), (1., 0));
    // A torus of radii 7 and 5 mm: H = (1/5 + cos t / (7 + 5 cos t)) / 2, t around the tube from the outside.
    let length = Profile::resolve("skin")?.mean_radius_mm().into_iter().fold(0., f64::max);
    let mean = |p: glam::DVec3| {
        let c = (p.x.hypot(p.z) - 7.) / 5.;
        0.5 * (0.2 + c / (7. + 5. * c))
    };
    let torus = |least: f64| concave("shape:torus:7,5", [0., 60., 50.], move |p| mean(p) * length < least);
    let ((right, marked), (convex, _)) = (torus(-0.02)?, concave("shape:torus:7,5", [0., 60., 50.], |_| false)?);
    println!("torus: {right:.4} of pixels right, {marked} concave; taken for convex {convex:.4}");
    assert!(right > 0.97 && marked > 50 && convex < right - 0.02, "{right} {marked} {convex}");
    Ok(())
}
