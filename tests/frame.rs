//! The whole frame in many combinations on a small picture: no message of the validation layers, finite pixels, something to see.
//!
//! `PDSS_TEST_DRIVERS` (paths of ICD files, a colon between them) runs the same on other drivers, a child process each.
mod studio;

use ash::vk;
use clap::ValueEnum;
use glam::Vec3;
use gpu_allocator::MemoryLocation;
use pdss::frame::{FrameError, Output, Renderer};
use pdss::gpu::{Buffer, Gpu, GpuError, Options};
use pdss::scene::{Camera, Light, LightKind, LoadOptions, Scene};
use pdss::settings::{
    Curvature, Integral, Kernels, Method, Quality, Resolution, SeparableKernel, Settings, Spared, Texturing, ToneMap,
    Transmittance, View,
};
use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;
use std::sync::Arc;
use studio::{Picture, Set};

const SIZE: [u32; 2] = [96, 64];
const VIEWS: [View; 14] = [
    View::Final,
    View::Albedo,
    View::Normal,
    View::ShadingNormal,
    View::Position,
    View::Depth,
    View::Material,
    View::Curvature,
    View::SoftNormal,
    View::SoftCurvature,
    View::Ao,
    View::Lit,
    View::Irradiance,
    View::Scatter,
];
const QUALITIES: [Quality; 4] = [Quality::Low, Quality::Medium, Quality::High, Quality::Ultra];
const RESOLUTIONS: [Option<Resolution>; 4] =
    [None, Some(Resolution::Full), Some(Resolution::Half), Some(Resolution::Quarter)];
const ESTIMATORS: [Curvature; 5] =
    [Curvature::Vergne, Curvature::Trace, Curvature::Metric, Curvature::Fit, Curvature::VergneMended];

/// Ways to light the scene.
const LIGHTS: [&str; 7] = ["one", "two", "point", "spot", "none", "no shadows", "three"];

fn lights(kind: &str) -> Vec<Light> {
    let at = |kind| Light { kind, color: [1., 0.9, 0.8], intensity: 0.05, range_mm: Some(2000.) };
    let position = Vec3::new(-90., 150., 120.);
    let key = Light::directional(-40., 35., 1.);
    let point = at(LightKind::Point { position });
    let direction = -position.normalize();
    let spot = at(LightKind::Spot { position, direction, inner_cos: 0.95, outer_cos: 0.8 });
    match kind {
        "two" => vec![key, Light::directional(60., 10., 0.5)],
        "point" => vec![point],
        "spot" => vec![spot],
        "none" => Vec::new(),
        "three" => vec![key, point, spot],
        _ => vec![key],
    }
}

/// What is wrong with a picture.
fn verdict(picture: &Picture, dark: bool) -> Result<(), String> {
    if picture.texels.len() != picture.size[0] * picture.size[1] {
        return Err(format!("{} texels, {:?} asked for", picture.texels.len(), picture.size));
    }
    let wrong = picture.texels.iter().flatten().filter(|x| !x.is_finite()).count();
    if wrong > 0 {
        return Err(format!("{wrong} numbers are not finite"));
    }
    let covered = picture.covered().count();
    if covered * 10 < picture.texels.len() {
        return Err(format!("{covered} pixels covered"));
    }
    if covered == picture.texels.len() {
        return Err("no background".into());
    }
    let seen = picture.covered().filter(|i| picture.texels[*i][..3].iter().any(|x| *x != 0.)).count();
    if !dark && seen * 4 < covered {
        return Err(format!("{seen} of {covered} covered pixels hold anything"));
    }
    if picture.texels.iter().any(|t| t[3] == 0. && *t != [0.; 4]) {
        return Err("something on the background".into());
    }
    Ok(())
}

/// A combination that the frame refuses, rightly.
fn refused(set: &Set) -> bool {
    let (s, lit) = (&set.settings, !set.lights.is_empty() && !set.settings.no_shadows);
    match s.view {
        View::SoftNormal | View::SoftCurvature | View::Ao => !matches!(s.method, Method::Pdss | Method::Moments),
        View::Lit => !lit,
        _ => false,
    }
}

/// Draws one combination, and says what was wrong with it.
fn check(gpu: &Arc<Gpu>, name: &str, set: &Set) -> Option<String> {
    let before = gpu.messages().len();
    let dark = set.lights.is_empty() && matches!(set.settings.view, View::Scatter | View::Irradiance);
    let outcome = match Renderer::new(gpu, set.inputs()) {
        Err(FrameError::View { .. }) if refused(set) => Ok(()),
        Ok(_) if refused(set) => Err("this view should have been refused".to_owned()),
        Err(e) => Err(e.to_string()),
        Ok(mut renderer) => {
            // The pictures for people are drawn twice: the second run finds what the first has left behind.
            let again = |r: &mut Renderer| if set.settings.view == View::Final { r.run() } else { Ok(()) };
            let run = renderer.run().and_then(|()| again(&mut renderer)).and_then(|()| {
                let texels = match renderer.output() {
                    Output::Linear => renderer.linear()?,
                    Output::Ldr => {
                        renderer.ldr()?.chunks_exact(4).map(|t| [t[0], t[1], t[2], t[3]].map(f32::from)).collect()
                    }
                };
                Ok(Picture { size: set.size(), texels })
            });
            run.map_err(|e| e.to_string()).and_then(|picture| verdict(&picture, dark))
        }
    };
    let messages = gpu.messages().split_off(before);
    match (outcome, messages.as_slice()) {
        (Ok(()), []) => None,
        (Ok(()), list) => Some(format!("{name}: {} messages, the first: {}", list.len(), list[0])),
        (Err(e), list) => Some(format!("{name}: {e}; {} messages", list.len())),
    }
}

fn torus(method: Method, view: View, kind: &str) -> Set {
    let mut settings = studio::settings(method, view, SIZE);
    (settings.quality, settings.no_shadows) = (Quality::Low, kind == "no shadows");
    let mut set = Set::new("shape:torus:70,25", 420., settings);
    set.scene = studio::thinned(&set.scene);
    set.lights = lights(kind);
    set
}

/// Every view of every method, each with its own quality and lights; then every pair of method with quality, lights,
/// resolution, kernels, estimator, integral, output.
fn combinations() -> BTreeMap<String, Set> {
    let mut all = BTreeMap::new();
    let mut add = |what: String, set: Set| {
        drop(all.insert(format!("{:?} {:?} {what}", set.settings.method, set.settings.view), set))
    };
    for (m, method) in Method::value_variants().iter().copied().enumerate() {
        for (v, view) in VIEWS.into_iter().enumerate() {
            let kind = LIGHTS[(v + 2 * m) % 6];
            let mut set = torus(method, view, kind);
            set.settings.quality = QUALITIES[(v + m) % 2];
            add(format!("{:?}, lights: {kind}", set.settings.quality), set);
        }
        for (i, kind) in LIGHTS.into_iter().enumerate() {
            let mut set = torus(method, if i % 2 == 0 { View::Scatter } else { View::Final }, kind);
            set.settings.resolution = RESOLUTIONS[i % 4];
            add(format!("{:?}, lights: {kind}", set.settings.resolution), set);
        }
        let mut ldr = torus(method, View::Final, "two");
        ldr.output = Output::Ldr;
        ldr.settings.tone_map = if method == Method::Pdss { ToneMap::Linear } else { ToneMap::Neutral };
        add("8 bit".into(), ldr);
        let mut before = torus(method, View::Final, "one");
        before.settings.texturing = Texturing::PrePost;
        before.settings.transmittance = Some(Transmittance::Off);
        before.settings.separable_kernel = SeparableKernel::Authors;
        add("pre and post".into(), before);
        let mut bare = torus(method, View::Final, "two");
        bare.profile = None;
        add("no profile".into(), bare);
        let mut all_of_it = torus(method, View::Final, "two");
        all_of_it.settings.no_elide = vec![Spared::All];
        add("nothing left out".into(), all_of_it);
    }
    for method in [Method::Pdss, Method::Moments] {
        for (i, quality) in QUALITIES.into_iter().enumerate() {
            for resolution in [RESOLUTIONS[i], RESOLUTIONS[(i + 1) % 4]] {
                let mut set = torus(method, View::Scatter, LIGHTS[i % 2]);
                (set.settings.quality, set.settings.resolution) = (quality, resolution);
                set.settings.curvature = ESTIMATORS[i];
                set.settings.kernels = if i % 2 == 0 { Kernels::Spirv } else { Kernels::Glsl };
                add(format!("{quality:?}, {resolution:?}"), set);
            }
        }
    }
    for (estimator, kernels) in
        ESTIMATORS.map(|e| (e, Kernels::Glsl)).into_iter().chain([(Curvature::Metric, Kernels::Spirv)])
    {
        let mut set = torus(Method::Pdss, View::Curvature, "one");
        (set.settings.curvature, set.settings.kernels) = (estimator, kernels);
        add(format!("{estimator:?}, {kernels:?}"), set);
    }
    for integral in [Integral::Ring, Integral::RingLiteral] {
        let mut set = torus(Method::Pdss, View::Scatter, "one");
        set.settings.integral = integral;
        set.settings.passes = Some(7);
        add(format!("{integral:?}"), set);
    }
    all
}

/// The scanned head, with its maps: textures, normal map, several levels.
fn head() -> Option<Vec<(String, Set)>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/models/lps/LeePerrySmith.glb");
    if !path.exists() {
        eprintln!("skipped: {} is not there", path.display());
        return None;
    }
    let mut scene = Scene::load(&path, &LoadOptions::default()).expect("the head loads");
    scene.assign_profile(None, 0).expect("skin");
    let camera = Camera::default_for(&scene, 30., f64::from(SIZE[0]) / f64::from(SIZE[1]));
    let scene = Arc::new(scene);
    let set = |method, view| {
        let settings = Settings { no_elide: Vec::new(), ..studio::settings(method, view, SIZE) };
        let (scene, camera, profile) = (scene.clone(), camera.clone(), Some(studio::wax()));
        Set { scene, camera, lights: lights("two"), profile, settings, output: Output::Linear }
    };
    let all = [(Method::Lambert, View::Final), (Method::Pdss, View::Final), (Method::Moments, View::ShadingNormal)];
    Some(all.map(|(m, v)| (format!("head {m:?} {v:?}"), set(m, v))).into())
}

/// A leak has a name.
fn leak_is_named(gpu: &Arc<Gpu>) {
    let usage = vk::BufferUsageFlags::STORAGE_BUFFER;
    let kept = Buffer::new(gpu, "forgotten", 64, usage, MemoryLocation::GpuOnly).expect("a buffer");
    match gpu.clone().close() {
        Err(GpuError::Leak(names)) => assert_eq!(names, "forgotten"),
        other => panic!("a leak was not noticed: {other:?}"),
    }
    drop(kept);
}

#[test]
fn the_matrix() {
    let gpu = match Gpu::open(&Options { validate: true, device: None }) {
        Ok(gpu) => gpu,
        // Only where the parent named a driver may it be refused, in a line that says what it lacks.
        Err(GpuError::NoDevice(why)) if std::env::var_os("PDSS_TEST_CHILD").is_some() => {
            assert!(why.contains("it lacks ") && !why.contains('\n'), "{why}");
            println!("refused: {why}");
            return;
        }
        Err(e) => panic!("{e}"),
    };
    println!("driver: {} ({}), Vulkan {}", gpu.info().name, gpu.info().driver, gpu.info().api);
    let start = std::time::Instant::now();
    let mut all: Vec<(String, Set)> = combinations().into_iter().collect();
    all.extend(head().into_iter().flatten());
    let wrong: Vec<String> = all.iter().filter_map(|(name, set)| check(&gpu, name, set)).collect();
    println!("{} combinations, {} wrong, {:.1} s", all.len(), wrong.len(), start.elapsed().as_secs_f64());
    assert_eq!(wrong, Vec::<String>::new());
    leak_is_named(&gpu);
    studio::close(gpu);
}

#[test]
fn wrong_pictures_are_caught() {
    let size = [8, 8];
    let good = |_: usize| [0.5, 0.4, 0.3, 1.];
    let picture = |texel: &dyn Fn(usize) -> [f32; 4]| Picture { size, texels: (0..64).map(texel).collect() };
    let half = |f: &dyn Fn(usize) -> [f32; 4], i: usize| if i < 32 { f(i) } else { [0.; 4] };
    assert_eq!(verdict(&picture(&|i| half(&good, i)), false), Ok(()));
    let wrong: [&dyn Fn(usize) -> [f32; 4]; 6] = [
        &|_| [0.; 4],
        &good,
        &|i| if i == 5 { [f32::NAN, 0., 0., 1.] } else { half(&good, i) },
        &|i| if i == 5 { [0., f32::INFINITY, 0., 1.] } else { half(&good, i) },
        &|i| half(&|_| [0., 0., 0., 1.], i),
        &|i| if i == 60 { [0.1, 0., 0., 0.] } else { half(&good, i) },
    ];
    for (i, texel) in wrong.iter().enumerate() {
        let caught = verdict(&picture(texel), false);
        println!("{caught:?}");
        assert!(caught.is_err(), "wrong picture {i} passes");
    }
    assert!(verdict(&Picture { size, texels: vec![[0.; 4]; 63] }, true).is_err());
}

#[test]
fn other_drivers() {
    let Ok(list) = std::env::var("PDSS_TEST_DRIVERS") else {
        eprintln!("skipped: PDSS_TEST_DRIVERS names no other driver");
        return;
    };
    for icd in list.split(':').filter(|p| !p.is_empty()) {
        let this = std::env::current_exe().expect("a test has a path");
        let out = Command::new(this)
            .args(["--exact", "the_matrix", "--nocapture"])
            .env_remove("PDSS_TEST_DRIVERS")
            .env("PDSS_TEST_CHILD", "1")
            .env("VK_DRIVER_FILES", icd)
            .env("VK_ICD_FILENAMES", icd)
            .output()
            .expect("the child starts");
        let (said, also) = (String::from_utf8_lossy(&out.stdout), String::from_utf8_lossy(&out.stderr));
        println!("{icd}:\n{said}");
        assert!(out.status.success(), "{icd}: {}\n{said}\n{also}", out.status);
        assert!(said.contains("driver: ") || said.contains("refused: "), "{icd}: nothing ran");
    }
}
