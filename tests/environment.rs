//! Light from a picture of the sky, on the device: as much as many lights cast, white in a white furnace, turned as the object
//! would be, linear; and files that are no skies.
mod studio;

use glam::{Mat3, Vec3};
use pdss::frame::{Renderer, meter};
use pdss::gpu::Gpu;
use pdss::scene::{Alpha, Camera, Environment, Light, LightKind, SceneError};
use pdss::settings::{Ambient, Method, Quality, View};
use pdss::skin::profile::Profile;
use pdss::skin::sky::direction;
use std::path::Path;
use std::sync::Arc;
use studio::{Picture, Set, settings};

const SIZE: [u32; 2] = [64, 64];
const METHODS: [Method; 9] = [
    Method::Lambert,
    Method::Wrap,
    Method::Preintegrated,
    Method::TextureSpace,
    Method::Gaussians,
    Method::Separable,
    Method::Burley,
    Method::Pdss,
    Method::Moments,
];

/// A sky of three bands, positive everywhere.
fn gentle(d: Vec3) -> [f32; 3] {
    let q = d.x * d.y - 0.4 * d.z * d.x + 0.3 * d.z * d.z;
    [1. + 0.4 * d.y + 0.3 * q, 0.8 - 0.3 * d.x + 0.2 * d.z * d.y, 0.9 + 0.5 * d.z - 0.2 * q]
}

fn sky(radiance: impl Fn(Vec3) -> [f32; 3]) -> Environment {
    let width = 256;
    let texel = |i: usize| {
        let at = [i % width, i / width].map(|x| x as f64 + 0.5);
        let [x, y, z] = direction([at[0] / width as f64, at[1] / (width / 2) as f64]);
        radiance(Vec3::new(x as f32, y as f32, z as f32))
    };
    Environment::new("sky", width, (0..width * width / 2).map(texel).collect()).expect("a sky")
}

/// A matt white sphere of 12 mm, nothing around it, under a sky.
fn ball(method: Method, environment: Option<Environment>) -> Set {
    let mut set = Set::new("shape:sphere:12", 90., settings(method, View::Final, SIZE));
    set.scene = studio::thinned(&set.scene);
    set.settings.quality = Quality::High;
    set.settings.no_shadows = true;
    set.settings.no_ao = true;
    set.settings.ambient = Ambient { up: [0.; 3], down: [0.; 3] };
    set.lights.clear();
    change(&mut set, |scene| scene.environment = environment.map(Arc::new));
    set
}

fn change(set: &mut Set, how: impl FnOnce(&mut pdss::scene::Scene)) {
    let mut scene = (*set.scene).clone();
    how(&mut scene);
    set.scene = Arc::new(scene);
}

fn colored(mut set: Set, color: f32, metallic: f32, roughness: f32) -> Set {
    change(&mut set, |scene| {
        for m in &mut scene.materials {
            (m.base_color, m.metallic, m.roughness) = ([color, color, color, 1.], metallic, roughness);
        }
    });
    set
}

/// What the surface's own colour sends back, without gloss: white less black.
fn diffuse(gpu: &Arc<Gpu>, set: &Set) -> Picture {
    let white = colored(set.clone(), 1., 0., 1.).linear(gpu);
    let black = colored(set.clone(), 0., 0., 1.).linear(gpu);
    let minus = |(a, b): (&[f32; 4], &[f32; 4])| [a[0] - b[0], a[1] - b[1], a[2] - b[2], a[3]];
    Picture { size: white.size, texels: white.texels.iter().zip(&black.texels).map(minus).collect() }
}

/// Largest difference over the largest value.
fn apart(a: &Picture, b: &Picture) -> f64 {
    let most = b.covered().flat_map(|i| b.texels[i][..3].to_vec()).fold(0f32, f32::max);
    let one = |i: usize| (0..3).map(|c| (a.texels[i][c] - b.texels[i][c]).abs()).fold(0f32, f32::max);
    f64::from(b.covered().map(one).fold(0f32, f32::max) / most)
}

#[test]
fn a_sky_lights_as_its_lights_do() {
    let gpu = studio::open();
    // As many directions as there may be lights, evenly over the sphere; each with its part of the solid angle.
    let lights: Vec<Light> = (0..128)
        .map(|i| {
            let y = 1. - (2. * i as f32 + 1.) / 128.;
            let (sin, cos) = (2.399_963_2 * i as f32).sin_cos();
            let r = (1. - y * y).sqrt();
            let from = Vec3::new(r * cos, y, r * sin);
            let color = gentle(from).map(|l| l * 4. * std::f32::consts::PI / 128.);
            Light { kind: LightKind::Directional { direction: from }, color, intensity: 1., range_mm: None }
        })
        .collect();
    for method in METHODS {
        let by_sky = diffuse(&gpu, &ball(method, Some(sky(gentle))));
        let mut lit = ball(method, None);
        lit.lights = lights.clone();
        let by_lights = diffuse(&gpu, &lit);
        let off = apart(&by_sky, &by_lights);
        println!("{method:?}: sky against 128 lights {off:.4} of the brightest");
        assert!(off < 0.008, "{method:?}");
        if method == Method::Moments {
            // A wrong twin: the sky seen in a mirror.
            let mirrored = ball(method, Some(sky(|d| gentle(d * Vec3::new(-1., 1., 1.)))));
            assert!(apart(&diffuse(&gpu, &mirrored), &by_lights) > 0.06);
        }
    }
    studio::close(gpu);
}

#[test]
fn a_white_furnace_stays_white() {
    let gpu = studio::open();
    for method in [Method::Lambert, Method::Preintegrated, Method::Gaussians, Method::Moments] {
        for (metallic, roughness) in [(0., 0.4), (1., 1.)] {
            let set = colored(ball(method, Some(sky(|_| [1.; 3]))), 1., metallic, roughness);
            let picture = set.linear(&gpu);
            let off = |p: &Picture, white: f32| {
                p.covered().flat_map(|i| p.texels[i][..3].to_vec()).map(|x| (x - white).abs()).fold(0., f32::max)
            };
            let grey = off(&colored(set, 0.95, metallic, roughness).linear(&gpu), 1.);
            let worst = off(&picture, 1.);
            println!(
                "{method:?}, metallic {metallic}, roughness {roughness}: |L - 1| {worst:.1e} (grey .95: {grey:.1e})"
            );
            assert!(worst < 1e-3 && grey > 3e-2, "{method:?} {metallic} {roughness}");
        }
    }
    studio::close(gpu);
}

/// Two lobes and hair take from diffuse light what they reflect: white stays white; and both are seen.
#[test]
fn skins_gloss_keeps_the_furnace_white() {
    let gpu = studio::open();
    for method in [Method::Lambert, Method::Preintegrated, Method::Separable, Method::Moments] {
        for (roughness, fuzz) in [(0.4, 0.), (0.4, 0.7)] {
            let mut set = colored(ball(method, Some(sky(|_| [1.; 3]))), 1., 0., roughness);
            set.profile = Some(Profile::resolve("skin").expect("built in"));
            set.settings.fuzz = fuzz;
            let white = set.linear(&gpu);
            let off =
                white.covered().flat_map(|i| white.texels[i][..3].to_vec()).map(|x| (x - 1.).abs()).fold(0., f32::max);
            println!("{method:?}, fuzz {fuzz}: |L - 1| {off:.1e}");
            assert!(off < 1e-3, "{method:?} {fuzz}");
            // Black skin shows what gloss alone reflects.
            let black = colored(set.clone(), 0., 0., roughness);
            let mut plain = black.clone();
            plain.profile = plain.profile.map(|p| Profile { lobes: None, ..p });
            plain.settings.fuzz = 0.;
            assert!(apart(&black.linear(&gpu), &plain.linear(&gpu)) > 0.02, "{method:?}: gloss is the profile's");
        }
    }
    studio::close(gpu);
}

#[test]
fn turning_the_sky_is_turning_eye_and_object_back_and_light_is_linear() {
    let gpu = studio::open();
    let hard = |d: Vec3| if d.x > 0.5 && d.y.abs() < 0.6 { [5., 4., 3.] } else { [0.2, 0.3, 0.4] };
    for method in [Method::Pdss, Method::Moments, Method::Gaussians] {
        let mut set = colored(ball(method, Some(sky(hard))), 0.8, 0., 0.4);
        let straight = set.linear(&gpu);
        change(&mut set, |scene| {
            let turned = Environment { rotation_deg: 50., ..sky(hard) };
            scene.environment = Some(Arc::new(turned));
        });
        let unturned_eye = set.linear(&gpu);
        // A sphere looks the same from everywhere: only the eye is turned with the sky.
        let turn = Mat3::from_rotation_y(50f32.to_radians());
        for axis in [&mut set.camera.eye, &mut set.camera.right, &mut set.camera.up, &mut set.camera.forward] {
            *axis = turn * *axis;
        }
        let turned = set.linear(&gpu);
        let (off, wrong) = (apart(&turned, &straight), apart(&unturned_eye, &straight));
        println!("{method:?}: turned with the sky {off:.1e}, sky alone {wrong:.2}");
        assert!(off < 2e-2 && wrong > 0.2);
        change(&mut set, |scene| {
            let bright = Environment { rotation_deg: 50., intensity: 3., ..sky(hard) };
            scene.environment = Some(Arc::new(bright));
        });
        let bright = set.linear(&gpu);
        let third = Picture { size: bright.size, texels: bright.texels.iter().map(|t| t.map(|x| x / 3.)).collect() };
        let off = apart(&third, &turned);
        println!("{method:?}: three times the light over three {off:.1e}");
        assert!(off < 2e-3);
    }
    studio::close(gpu);
}

#[test]
fn another_eye_sees_the_same_sky_without_recording() {
    let gpu = studio::open();
    for method in METHODS {
        let here = colored(ball(method, Some(sky(gentle))), 0.8, 0.3, 0.4);
        let mut there = here.clone();
        there.camera = Camera::orbit(120., 30., 90., None, 30., &there.scene);
        let (first, fresh) = (here.linear(&gpu), there.linear(&gpu));
        let mut renderer = Renderer::new(&gpu, here.inputs()).expect("a frame");
        assert!(renderer.look(&there.inputs()).expect("a plan"), "{method:?}");
        renderer.run().expect("it runs");
        let seen = Picture { texels: renderer.linear().expect("a picture"), ..fresh.clone() };
        let (off, moved) = (apart(&seen, &fresh), apart(&seen, &first));
        println!("{method:?}: {off:.1e} from a fresh frame, {moved:.2} from the first");
        assert!(off == 0. && moved > 0.05, "{method:?}");
    }
    studio::close(gpu);
}

#[test]
fn what_is_blended_is_lit_by_the_sky_as_what_is_not() {
    let gpu = studio::open();
    let opaque = colored(ball(Method::Lambert, Some(sky(gentle))), 0.8, 0., 0.5);
    let mut blended = opaque.clone();
    change(&mut blended, |scene| scene.materials.iter_mut().for_each(|m| m.alpha = Alpha::Blend));
    let mut dark = blended.clone();
    change(&mut dark, |scene| scene.environment = None);
    let want = opaque.linear(&gpu);
    let (off, wrong) = (apart(&blended.linear(&gpu), &want), apart(&dark.linear(&gpu), &want));
    println!("blended against opaque {off:.1e}; without the sky {wrong:.2}");
    assert!(off < 5e-3 && wrong > 0.1);
    studio::close(gpu);
}

#[test]
fn the_sky_behind_shows_where_nothing_is() {
    let gpu = studio::open();
    for method in [Method::Moments, Method::Preintegrated] {
        // Straight ahead of an eye in +Z lies -Z, the picture's edge: red; what is up is green.
        let painted = sky(|d| if d.z < -0.5 { [2., 0., 0.] } else { [0., 1. + d.y, 0.] });
        let mut set = ball(method, Some(Environment { background: Some(0.), ..painted }));
        set.camera = Camera::orbit(0., 0., 90., None, 30., &set.scene);
        let picture = set.linear(&gpu);
        let corner = picture.texels[0];
        assert!(corner[0] > 1.9 && corner[1] < 0.05 && corner[3] == 1., "{method:?}: {corner:?}");
        change(&mut set, |scene| {
            let e = scene.environment.as_deref().expect("a sky").clone();
            scene.environment = Some(Arc::new(Environment { background: None, ..e }));
        });
        assert_eq!(set.linear(&gpu).texels[0], [0.; 4], "{method:?}: none asked for");
    }
    studio::close(gpu);
}

fn refused(name: &str, bytes: &[u8]) -> String {
    let dir = tempfile::tempdir().expect("a place");
    let file = dir.path().join(name);
    std::fs::write(&file, bytes).expect("written");
    match Environment::load(&file) {
        Err(e @ (SceneError::Invalid { .. } | SceneError::Read { .. })) => e.to_string(),
        Err(e) => panic!("{name}: {e}"),
        Ok(_) => panic!("{name} was read"),
    }
}

/// A Radiance file of one flat colour, not run-length encoded.
fn hdr(width: u32, height: u32, texels: usize) -> Vec<u8> {
    let mut bytes = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n").into_bytes();
    bytes.extend([128, 64, 32, 129].repeat(texels));
    bytes
}

#[test]
fn broken_skies_are_refused_in_one_line() {
    let whole = hdr(4, 2, 8);
    let dir = tempfile::tempdir().expect("a place");
    let file = dir.path().join("a.hdr");
    std::fs::write(&file, &whole).expect("written");
    let sky = Environment::load(&file).expect("a sky");
    assert_eq!((sky.width, sky.height), (4, 2));
    assert!((sky.pixels[0][0] - 1.).abs() < 0.01 && (sky.pixels[7][1] - 0.5).abs() < 0.01);
    for (name, bytes, word) in [
        ("square.hdr", hdr(4, 4, 16), "twice as wide"),
        ("lies.hdr", hdr(60000, 30000, 8), "does not hold"),
        ("lfs.hdr", b"version https://git-lfs.github.com/spec/v1\noid sha256:0\n".to_vec(), "LFS"),
        ("empty.hdr", Vec::new(), "contents"),
        ("text.exr", b"not a picture at all".to_vec(), "contents"),
        ("sky.png", whole.clone(), ".hdr or .exr"),
    ] {
        let line = refused(name, &bytes);
        println!("{line}");
        assert!(line.contains(word) && line.contains(name) && !line.contains('\n'), "{line}");
    }
    for cut in 1..whole.len() {
        refused("cut.hdr", &whole[..cut]);
    }
    assert!(matches!(Environment::load(Path::new("none.hdr")), Err(SceneError::Read { .. })));
    let odd = Environment::new("odd", 2, vec![[f32::NAN, f32::INFINITY, 1.], [-1., 0., 0.]]).expect("mended");
    assert_eq!(odd.pixels, [[0., 65504., 1.], [0.; 3]]);
    assert_eq!(odd.warnings.len(), 2);
    assert!(Environment::new("few", 4, vec![[0.; 3]; 7]).is_err());
}

#[test]
fn a_meter_reads_the_sky_the_lights_and_where_the_eye_is() {
    let stops = |sky: &Environment, lights: &[Light], eye: &Camera| meter::stops(sky, lights, Vec3::ZERO, eye);
    let eye = |yaw: f64| ball_from(yaw).camera;
    let white = sky(|_| [1.; 3]);
    // A white surface under a white sky of radiance 1 shows 1.
    let plain = f64::from(stops(&white, &[], &eye(0.)));
    assert!(plain.abs() < 0.01, "{plain}");
    let bright = Environment { intensity: 8., ..white.clone() };
    assert!((f64::from(stops(&bright, &[], &eye(0.))) - (plain - 3.)).abs() < 1e-4);
    // As much light again from in front, the sun as bright as the sky's pi.
    let sun = Light::directional(0., 0., std::f32::consts::PI);
    let lit = f64::from(stops(&white, std::slice::from_ref(&sun), &eye(0.)));
    let behind = f64::from(stops(&white, std::slice::from_ref(&sun), &eye(180.)));
    println!("white sky {plain:.3}, sun in front {lit:.3}, behind {behind:.3} stops");
    assert!((plain - lit - 1.).abs() < 0.1 && behind > lit + 0.3 && behind < plain);
    // A lamp, and the scene as far from it somewhere else.
    let lamp =
        |x: f32| Light { kind: LightKind::Point { position: [x, 0., 1000.].into() }, intensity: 9., ..sun.clone() };
    let [near, moved, wrong] = [([0.; 3], 0.), ([4000., 0., 0.], 4000.), ([0.; 3], 4000.)]
        .map(|(place, x)| meter::stops(&white, &[lamp(x)], place.into(), &eye(0.)));
    assert!((near - moved).abs() < 1e-4 && (near - wrong).abs() > 0.3, "{near} {moved} {wrong}");
    // Sky and eye turned together see the same; the sky alone does not.
    let uneven = sky(|d| [if d.z > 0. { 4. } else { 0.1 }; 3]);
    let turned = Environment { rotation_deg: 70., ..uneven.clone() };
    let [a, b, wrong] = [stops(&uneven, &[], &eye(0.)), stops(&turned, &[], &eye(70.)), stops(&turned, &[], &eye(0.))];
    println!("half a sky {a:.3}, both turned {b:.3}, one turned {wrong:.3}");
    assert!((a - b).abs() < 1e-3 && (a - wrong).abs() > 0.05);
    assert_eq!(stops(&sky(|_| [0.; 3]), &[], &eye(0.)), 0.);
}

fn ball_from(yaw: f64) -> Set {
    let mut set = ball(Method::Lambert, None);
    set.camera = Camera::orbit(yaw, 0., 90., None, 30., &set.scene);
    set
}
