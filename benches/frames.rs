//! Whole frames of every method: the same record as `pdss profile --format json`, one a method, in one file.
//!
//! `cargo bench --bench frames [-- [SCENE] [WIDTHxHEIGHT] [-o FILE]]`. Two files of one device are held against each other by
//! `pdss profile --compare OLD NEW`. Stages are timed alone (isolated); the frame's wall time is that of the same frames.

#[path = "common/mod.rs"]
mod common;

use clap::ValueEnum;
use pdss::frame::{Inputs, Output, Renderer};
use pdss::gpu::timing::TimingMode;
use pdss::gpu::{Gpu, Options};
use pdss::report::measure::{self, Warmup};
use pdss::report::record::{Record, Subject};
use pdss::scene::{Camera, Light, LoadOptions, Scene};
use pdss::settings::{Method, Quality, Settings, Size};
use pdss::skin::profile::Profile;

const FRAMES: usize = 10;
const WARM_UP: usize = 3;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (arguments, output) = common::arguments();
    let parsed = |a: &String| pdss::settings::parse_size(a);
    let size = arguments.iter().find_map(|a| parsed(a).ok()).unwrap_or(Size { width: 1650, height: 1080 });
    let name = arguments.iter().find(|a| parsed(a).is_err()).map_or("bust", String::as_str);
    let gpu = Gpu::open(&Options::default())?;
    let mut records = Vec::new();
    for method in Method::value_variants() {
        let options = LoadOptions { keep_uvs: *method == Method::TextureSpace, ..LoadOptions::default() };
        let mut scene = Scene::open(name, &options)?;
        scene.assign_profile(None, 0)?;
        for quality in [Quality::Medium, Quality::High] {
            let settings = Settings { method: *method, quality, size, ..Settings::default() };
            let profile = Profile::resolve("skin")?;
            let subject = Subject {
                scene: name.to_owned(),
                triangles: scene.triangle_count(),
                profile: Some(profile.name.clone()),
                lights: 2,
                settings: settings.clone(),
                timing: TimingMode::Isolated,
                validation: false,
                covered_pixels: None,
            };
            let inputs = Inputs {
                camera: Camera::default_for(&scene, 30., f64::from(size.width) / f64::from(size.height)),
                scene: &scene,
                lights: vec![Light::directional(60., 25., 1.), Light::directional(-70., 10., 0.2)],
                profiles: vec![profile],
                settings,
                timing: Some(TimingMode::Isolated),
                output: Output::Ldr,
            };
            let mut renderer = Renderer::new(&gpu, inputs)?;
            let (warmed, samples) = measure::measure(&mut renderer, Warmup::Exactly(WARM_UP), FRAMES, |_, _| {})?;
            let (plan, memory, cpu) = (renderer.plan(), renderer.memory(), renderer.cpu_times());
            let record = Record::new(gpu.info(), subject, plan, memory, cpu, warmed, samples);
            let wall = record.frame.wall_ms.map_or(f64::NAN, |s| s.median);
            eprintln!("{method:?} {quality:?}: {wall:.1} ms, {:.1} MiB", memory.0 as f64 / f64::from(1 << 20));
            records.push(record);
        }
    }
    let info = gpu.info();
    let all = serde_json::json!({
        "schema": 1, "device": info.name, "driver": info.driver, "commit": common::commit(), "records": records,
    });
    common::write(&all, output)?;
    Ok(gpu.close()?)
}
