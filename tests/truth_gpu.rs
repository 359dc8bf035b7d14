//! Truth sees the pixels that the renderer sees, and light falls on them alike: every kind of light, shadows, a normal map.
mod studio;

use pdss::frame::Renderer;
use pdss::gpu::{Gpu, GpuError, Options};
use pdss::scene::{Camera, Light, LightKind, LoadOptions, Scene};
use pdss::settings::{Method, View};
use pdss::truth::bands::band;
use pdss::truth::metrics::{self, Comparison};
use pdss::truth::{self, Effort};
use std::path::Path;
use std::sync::Arc;
use studio::Set;

const SIZE: [u32; 2] = [200, 160];

fn gpu() -> Option<Arc<Gpu>> {
    match Gpu::open(&Options { validate: true, device: None }) {
        Ok(gpu) => Some(gpu),
        Err(GpuError::NoDevice(_) | GpuError::NoValidation) => {
            println!("skipped: no device, or no validation layers");
            None
        }
        Err(e) => panic!("{e}"),
    }
}

fn set() -> Set {
    let mut set = Set::new("shape:torus:70,25", 420., studio::settings(Method::Lambert, View::Irradiance, SIZE));
    set.profile = None;
    set.output = pdss::frame::Output::Linear;
    set
}

/// What the renderer says of `set` against truth, but for silhouettes and shadows' edges; `lit` is what truth is lit by.
fn against(gpu: &Arc<Gpu>, set: &Set, lit: &[Light]) -> Comparison {
    let mut renderer = Renderer::new(gpu, set.inputs()).expect("a frame");
    renderer.run().expect("it runs");
    let mut picture = renderer.linear().expect("a picture");
    let mut inputs = set.inputs();
    inputs.lights = lit.to_vec();
    let truth = truth::solve(&inputs, None, &Effort::default(), |_| ()).expect("a truth");
    let uncommon = metrics::compare(SIZE, &picture, &truth.pixels, None).uncommon;
    let edge = |b: &u8| b & (band::SILHOUETTE | band::SHADOW_EDGE) != 0;
    picture.iter_mut().zip(&truth.bands).filter(|(_, b)| edge(b)).for_each(|(p, _)| p[3] = 0.);
    let inside = metrics::compare(SIZE, &picture, &truth.pixels, None);
    Comparison { uncommon, ..inside }
}

#[test]
fn every_kind_of_light_falls_as_it_does_in_the_renderer() {
    let Some(gpu) = gpu() else { return };
    let position = glam::Vec3::new(-170., 45., 40.);
    let near = |kind| Light { kind, color: [1., 0.9, 0.8], intensity: 0.05, range_mm: Some(2000.) };
    let direction = -position.normalize();
    let kinds = [
        ("directional", Light::directional(-80., 12., 1.)),
        ("point", near(LightKind::Point { position })),
        ("spot", near(LightKind::Spot { position, direction, inner_cos: 0.95, outer_cos: 0.8 })),
    ];
    let mut set = set();
    for (k, (name, light)) in kinds.iter().enumerate() {
        set.lights = vec![light.clone()];
        let right = against(&gpu, &set, &set.lights);
        let wrong = against(&gpu, &set, &[kinds[(k + 1) % 3].1.clone()]);
        let unshadowed = {
            set.settings.no_shadows = true;
            let inputs = set.inputs();
            let free = truth::solve(&inputs, None, &Effort::default(), |_| ()).expect("a truth");
            set.settings.no_shadows = false;
            let cast = truth::solve(&set.inputs(), None, &Effort::default(), |_| ()).expect("a truth");
            metrics::compare(SIZE, &cast.pixels, &free.pixels, None).whole.rmse
        };
        let (rms, p99, twin) = (right.whole.rmse, right.whole.p99, wrong.whole.p99);
        println!(
            "{name}: rms {rms:.1e} p99 {p99:.1e} over {} pixels, {} covered by one only; another light {twin:.1e}, without shadows {unshadowed:.1e}",
            right.whole.pixels, right.uncommon
        );
        // A shadow map's texel reaches beyond the band at its edges: a few pixels of hundreds are far off.
        assert!(p99 < 2e-4 && rms < 5e-3 && right.whole.pixels > 5000 && right.uncommon <= 2, "{name}: {right:?}");
        assert!(twin > 100. * p99 && unshadowed > 20. * rms, "{name}: the twins: {twin:e}, {unshadowed:e}");
    }
    assert_eq!(gpu.messages(), Vec::<String>::new());
}

#[test]
fn a_head_with_a_normal_map_has_the_same_pixels() {
    let Some(gpu) = gpu() else { return };
    let file = Path::new("../shared/models/derived/LeePerrySmith_textured_metres.glb");
    if !file.is_file() {
        println!("skipped: no {}", file.display());
        return;
    }
    let mut set = set();
    let scene = Scene::load(file, &LoadOptions::default()).expect("a head");
    // Close enough that a texel of the map covers a pixel or more: both read the finest level.
    set.camera = Camera::orbit(-20., 0., 150., None, 20., &scene);
    set.scene = Arc::new(scene);
    set.lights = vec![Light::directional(50., 30., 1.)];
    // Close up a texel of the shadow map covers many pixels; light alone is compared.
    set.settings.no_shadows = true;
    let close = against(&gpu, &set, &set.lights);
    let mut flat = (*set.scene).clone();
    flat.materials.iter_mut().for_each(|m| m.normal_texture = None);
    let bumped = set.scene.clone();
    let render = set.lights.clone();
    let without = {
        let truth = |set: &Set| truth::solve(&set.inputs(), None, &Effort::default(), |_| ()).expect("a truth").pixels;
        let with = truth(&set);
        set.scene = Arc::new(flat);
        let flat = truth(&set);
        set.scene = bumped;
        metrics::compare(SIZE, &with, &flat, None).whole.rmse
    };
    set.camera = Camera::orbit(-20., 0., 900., None, 20., &set.scene);
    let away = against(&gpu, &set, &render);
    println!(
        "close: rms {:.1e} p99 {:.1e}, {} covered by one only; 900 mm away {:.1e}; the map itself does {without:.1e}",
        close.whole.rmse, close.whole.p99, close.uncommon, away.whole.rmse
    );
    assert!(close.whole.rmse < 0.01 && close.uncommon <= 20, "{close:?}");
    assert!(without > 5. * close.whole.rmse, "the twin: without the map {without:e}");
    assert_eq!(gpu.messages(), Vec::<String>::new());
}
