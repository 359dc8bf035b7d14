//! Whole frames of every method: the same record as `pdss profile --format json`, one a method, in one file.
//!
//! `cargo bench --bench frames [-- [SCENE] [WIDTHxHEIGHT] [-o FILE]]`. Two files of one device are held against each other by
//! `pdss profile --compare OLD NEW`. Stages are timed alone (isolated); the frame's wall time is that of the same frames.

use clap::ValueEnum;
use pdss::frame::{Inputs, Output, Renderer};
use pdss::gpu::timing::TimingMode;
use pdss::gpu::{Gpu, Options};
use pdss::report::measure::{self, Warmup};
use pdss::report::record::{Record, Subject};
use pdss::scene::{Camera, Light, LoadOptions, Scene};
use pdss::settings::{Method, Quality, Settings, Size};
use pdss::skin::profile::Profile;
use std::path::Path;

const FRAMES: usize = 10;
const WARM_UP: usize = 3;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    let output = arguments.iter().position(|a| a == "-o").and_then(|i| arguments.get(i + 1)).cloned();
    let free = || arguments.iter().filter(|a| *a != "-o" && Some(*a) != output.as_ref());
    let size = free().find_map(|a| pdss::settings::parse_size(a).ok()).unwrap_or(Size { width: 1650, height: 1080 });
    let name = free().find(|a| pdss::settings::parse_size(a).is_err()).map_or("bust", String::as_str);
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
    let commit = std::process::Command::new("git").args(["rev-parse", "--short", "HEAD"]).output().ok();
    let commit = commit.filter(|o| o.status.success()).map(|o| String::from_utf8_lossy(&o.stdout).trim().to_owned());
    let info = gpu.info();
    let all = serde_json::json!({
        "schema": 1, "device": info.name, "driver": info.driver, "commit": commit, "records": records,
    });
    let text = serde_json::to_string_pretty(&all)? + "\n";
    match output {
        Some(path) => {
            let path = Path::new(&path);
            let mut file = tempfile::NamedTempFile::new_in(
                path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new(".")),
            )?;
            std::io::Write::write_all(&mut file, text.as_bytes())?;
            file.persist(path)?;
        }
        None => print!("{text}"),
    }
    Ok(gpu.close()?)
}
