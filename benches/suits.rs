//! What suits the device: each shape of tile, each way to load, and fragment shaders, against compute shaders over 8 x 8 that load
//! storage images, stage by stage.
//!
//! `cargo bench --bench suits [-- [SCENE] [WIDTHxHEIGHT] [-o FILE]]`. All run in turn, frame by frame, and each frame gives ratios to
//! its neighbour's stages, so that other work on the machine touches both. The medians belong into `src/gpu/suit.rs`, where a device
//! has one that is well below 1.

#[path = "common/mod.rs"]
mod common;

use pdss::frame::{FrameError, Inputs, Output, Renderer};
use pdss::gpu::suit::{Loads, Screen, Tile};
use pdss::gpu::timing::TimingMode;
use pdss::gpu::{Gpu, Options};
use pdss::scene::{Camera, Light, LoadOptions, Scene};
use pdss::settings::{Method, Quality, Settings, Size};
use pdss::skin::profile::Profile;
use std::collections::BTreeMap;

const ROUNDS: usize = 15;
const WARM_UP: usize = 2;
const SUITS: [(Tile, Loads, Screen); 7] = [
    (Tile::Square, Loads::Storage, Screen::Compute),
    (Tile::Broad, Loads::Storage, Screen::Compute),
    (Tile::Flat, Loads::Storage, Screen::Compute),
    (Tile::Row, Loads::Storage, Screen::Compute),
    (Tile::Square, Loads::Sampled, Screen::Compute),
    (Tile::Square, Loads::Storage, Screen::Fragment),
    (Tile::Square, Loads::Sampled, Screen::Fragment),
];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (arguments, output) = common::arguments();
    let parsed = |a: &String| pdss::settings::parse_size(a);
    let size = arguments.iter().find_map(|a| parsed(a).ok()).unwrap_or(Size { width: 1650, height: 1080 });
    let name = arguments.iter().find(|a| parsed(a).is_err()).map_or("bust", String::as_str);
    let gpu = Gpu::open(&Options::default())?;
    let mut scene = Scene::open(name, &LoadOptions::default())?;
    scene.assign_profile(None, 0)?;
    let mut methods = serde_json::Map::new();
    for method in [Method::Pdss, Method::Moments, Method::Separable, Method::Burley] {
        let frame = |(tile, loads, screen): (Tile, Loads, Screen)| {
            let (tile, loads, screen) = (Some(tile), Some(loads), Some(screen));
            let inputs = Inputs {
                camera: Camera::default_for(&scene, 30., f64::from(size.width) / f64::from(size.height)),
                scene: &scene,
                lights: vec![Light::directional(60., 25., 1.), Light::directional(-70., 10., 0.2)],
                profiles: Profile::resolve("skin").into_iter().collect(),
                settings: Settings { method, quality: Quality::High, size, tile, loads, screen, ..Settings::default() },
                timing: Some(TimingMode::Isolated),
                output: Output::Ldr,
            };
            Renderer::new(&gpu, inputs)
        };
        let mut frames = SUITS.into_iter().map(frame).collect::<Result<Vec<_>, _>>()?;
        let mut ratios: Vec<BTreeMap<String, Vec<f64>>> = vec![BTreeMap::new(); SUITS.len()];
        let mut first: BTreeMap<String, Vec<f64>> = BTreeMap::new();
        for round in 0..WARM_UP + ROUNDS {
            let times = frames.iter_mut().map(times).collect::<Result<Vec<_>, _>>()?;
            if round < WARM_UP {
                continue;
            }
            for (stage, ns) in &times[0] {
                first.entry(stage.clone()).or_default().push(ns * 1e-6);
                for (all, here) in ratios.iter_mut().zip(&times) {
                    all.entry(stage.clone()).or_default().push(here[stage] / ns);
                }
            }
        }
        let medians = |all: BTreeMap<String, Vec<f64>>| -> BTreeMap<String, f64> {
            all.into_iter().map(|(stage, values)| (stage, (median(values) * 1e3).round() * 1e-3)).collect()
        };
        let mut record = serde_json::Map::new();
        record.insert("ms".to_owned(), serde_json::json!(medians(first)));
        for ((tile, loads, screen), all) in SUITS.into_iter().zip(ratios).skip(1) {
            let [width, height] = tile.sides();
            record.insert(format!("{width}x{height} {loads:?} {screen:?}"), serde_json::json!(medians(all)));
        }
        methods.insert(format!("{method:?}"), record.into());
    }
    let info = gpu.info();
    let record = serde_json::json!({
        "schema": 1, "bench": "suits", "device": info.name, "driver": info.driver, "commit": common::commit(), "scene": name,
        "size": [size.width, size.height], "rounds": ROUNDS, "methods": methods,
    });
    common::write(&record, output)?;
    Ok(gpu.close()?)
}

/// Nanoseconds of each stage that has a time, and of all that run over tiles together.
fn times(frame: &mut Renderer) -> Result<BTreeMap<String, f64>, FrameError> {
    frame.run()?;
    let mut times: BTreeMap<String, f64> =
        frame.times()?.into_iter().filter_map(|(stage, ns)| Some((stage, ns?))).collect();
    let tiled =
        |stage: &String| !["shadow", "gbuffer", "clear", "reset"].iter().any(|raster| stage.starts_with(raster));
    let all = times.iter().filter(|(stage, _)| tiled(stage)).map(|t| t.1).sum();
    times.insert("all of these, without rasterised ones".to_owned(), all);
    Ok(times)
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}
