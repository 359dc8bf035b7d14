//! What runs on the processor: closed forms, tables, fits, the plan, and truth's gathering. `cargo bench --bench cpu`.

use criterion::{Criterion, criterion_group, criterion_main};
use glam::Vec3;
use pdss::frame::{Inputs, Output, Renderer};
use pdss::scene::{Camera, Light, LoadOptions, Scene};
use pdss::settings::{Method, Quality, Settings, Size};
use pdss::skin::lut::{Integral, Lut};
use pdss::skin::profile::Profile;
use pdss::skin::{mass, sphere};
use pdss::truth::{self, Effort};
use std::hint::black_box;

fn profile(name: &str) -> Profile {
    Profile::resolve(name).expect("a built-in profile")
}

fn torus() -> Scene {
    let mut scene = Scene::open("shape:torus:10,4", &LoadOptions::default()).expect("a shape");
    scene.assign_profile(None, 0).expect("a material");
    scene
}

fn inputs(scene: &Scene, method: Method, size: [u32; 2]) -> Inputs<'_> {
    Inputs {
        scene,
        camera: Camera::orbit(20., 30., 60., None, 30., scene),
        lights: vec![Light::directional(60., 25., 1.), Light::directional(-70., 10., 0.2)],
        profiles: vec![profile("skin")],
        settings: Settings {
            method,
            quality: Quality::High,
            size: Size { width: size[0], height: size[1] },
            ..Settings::default()
        },
        timing: None,
        output: Output::Linear,
    }
}

fn science(c: &mut Criterion) {
    let skin = profile("skin").gaussians().gaussians;
    c.bench_function("sphere series, soft (k = 10)", |b| b.iter(|| sphere::vmf(black_box(0.1), black_box(10.))));
    c.bench_function("sphere series, stiff (k = 1000)", |b| b.iter(|| sphere::vmf(black_box(0.1), black_box(1e3))));
    c.bench_function("exitance of a sphere, skin", |b| {
        b.iter(|| sphere::exitance_normalised(black_box(0.1), black_box(8.), &skin));
    });
    c.bench_function("table, sphere, skin", |b| b.iter(|| Lut::build(&profile("skin"), Integral::Sphere)));
    c.bench_function("fit of a measured profile", |b| b.iter(|| profile(black_box("skin1")).gaussians()));
}

fn frames(c: &mut Criterion) {
    let scene = torus();
    for method in [Method::Lambert, Method::Pdss, Method::Moments] {
        let inputs = inputs(&scene, method, [1650, 1080]);
        c.bench_function(&format!("plan, {method:?}, 102,400 triangles"), |b| {
            b.iter(|| Renderer::plan_only(black_box(&inputs)).expect("a plan"));
        });
    }
    let points: Vec<Vec3> = scene.positions.iter().map(|p| Vec3::from(*p)).collect();
    let corner = |i: u32| points[i as usize];
    let triangles: Vec<[Vec3; 3]> =
        scene.indices.chunks_exact(3).map(|t| [corner(t[0]), corner(t[1]), corner(t[2])]).collect();
    c.bench_function("mass of a Gaussian, 102,400 triangles", |b| {
        b.iter(|| mass::mass(&points, &triangles, black_box(2.)));
    });
    c.bench_function("truth, 64 x 64 pixels, 50,000 samples", |b| {
        let inputs = inputs(&scene, Method::Lambert, [64, 64]);
        let effort = Effort { samples: 50_000, ..Effort::default() };
        b.iter(|| truth::solve(&inputs, None, &effort, |_| ()).expect("a truth"));
    });
}

criterion_group! {
    name = cpu;
    config = Criterion::default().sample_size(10).measurement_time(std::time::Duration::from_secs(2)).warm_up_time(std::time::Duration::from_millis(500));
    targets = science, frames
}
criterion_main!(cpu);
