//! The two twins of the curvature stage, GLSL and hand-written SPIR-V, against each other on the whole frame's own data.
//!
//! `cargo bench --bench kernels [-- WIDTHxHEIGHT]`. The twins run in turn, frame by frame, and each pair gives a ratio: on a
//! machine that others use, only ratios of neighbours mean something. Isolated timestamps: each stage alone on the device.

use pdss::frame::{Inputs, Output, Renderer};
use pdss::gpu::timing::TimingMode;
use pdss::gpu::{Gpu, Options};
use pdss::scene::{Camera, Light, LoadOptions, Scene};
use pdss::settings::{Kernels, Settings, Size};
use pdss::skin::profile::Profile;
use std::sync::Arc;

const PAIRS: usize = 60;
const WARM_UP: usize = 5;

type Fallible<T> = Result<T, Box<dyn std::error::Error>>;

fn main() -> Fallible<()> {
    let size = std::env::args().skip(1).find_map(|a| {
        let (w, h) = a.split_once('x')?;
        Some(Size { width: w.parse().ok()?, height: h.parse().ok()? })
    });
    let size = size.unwrap_or(Size { width: 1650, height: 1080 });
    let gpu = Gpu::open(&Options::default())?;
    let mut scene = Scene::open("shape:sphere:50", &LoadOptions::default())?;
    scene.assign_profile(None, 0)?;
    let mut twins = [frame(&gpu, &scene, size, Kernels::Glsl)?, frame(&gpu, &scene, size, Kernels::Spirv)?];
    let (mut times, mut ratios) = ([Vec::new(), Vec::new()], Vec::new());
    for pair in 0..WARM_UP + PAIRS {
        let mut ms = [0.; 2];
        // Who goes first alternates.
        for i in if pair % 2 == 0 { [0, 1] } else { [1, 0] } {
            twins[i].run()?;
            let of_stage = twins[i].times()?.into_iter().find(|(name, _)| name == "curvature").and_then(|t| t.1);
            ms[i] = of_stage.ok_or("the curvature stage has no time")? / 1e6;
        }
        if pair >= WARM_UP {
            (0..2).for_each(|i| times[i].push(ms[i]));
            ratios.push(ms[1] / ms[0]);
        }
    }
    let record = serde_json::json!({
        "bench": "curvature kernels", "device": gpu.info().name, "driver": gpu.info().driver,
        "size": [size.width, size.height], "pairs": PAIRS,
        "glsl_ms": median(&mut times[0]), "spirv_ms": median(&mut times[1]), "spirv_over_glsl": median(&mut ratios),
    });
    println!("{record:#}");
    drop(twins);
    Ok(gpu.close()?)
}

fn frame(gpu: &Arc<Gpu>, scene: &Scene, size: Size, kernels: Kernels) -> Fallible<Renderer> {
    let inputs = Inputs {
        scene,
        // Close enough that the sphere fills the picture.
        camera: Camera::orbit(0., 0., 110., None, 30., scene),
        lights: vec![Light::directional(60., 25., 1.)],
        profiles: vec![Profile::resolve("skin")?],
        settings: Settings { kernels, size, no_shadows: true, ..Settings::default() },
        timing: Some(TimingMode::Isolated),
        output: Output::Ldr,
    };
    Ok(Renderer::new(gpu, inputs)?)
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}
