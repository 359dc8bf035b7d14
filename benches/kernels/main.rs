//! The kernels of the frame against the same kernels as plain Rust, on the frame's own data; and the two twins of the curvature
//! stage, GLSL and hand-written SPIR-V, against each other.
//!
//! `cargo bench --bench kernels [-- WIDTHxHEIGHT] [-o FILE]`. The Rust is single-precision, an array a component, split over as many
//! threads as there are cores; the compiler makes vectors of it, for AVX2 and FMA where the processor has them, as the driver
//! does. It reads and writes the same words as the kernels do, and its output is held against theirs first. All run in turn,
//! frame by frame, and each pair gives a ratio: on a machine that others use, only ratios of neighbours mean something. Times of the
//! device are isolated timestamps: each stage alone.

#![allow(clippy::needless_range_loop, reason = "lanes are counted: an iterator too many, and there is no vector")]

mod blur;
mod check;
#[path = "../common/mod.rs"]
mod common;
mod curvature;
mod data;
mod gloss;
mod light;
mod vector;

use blur::{Level, Pass};
use curvature::Bordered;
use data::{Shot, Table, inputs};
use light::Job;
use pdss::gpu::{Gpu, Options};
use pdss::scene::{Camera, LoadOptions, Scene};
use pdss::settings::{Kernels, Method, Size};
use pdss::skin::profile::Profile;
use std::sync::Arc;
use std::time::Instant;

const ROUNDS: usize = 15;
const WARM_UP: usize = 3;

type Fallible<T> = Result<T, Box<dyn std::error::Error>>;

fn main() -> Fallible<()> {
    let (arguments, output) = common::arguments();
    let size = arguments.iter().find_map(|a| pdss::settings::parse_size(a).ok());
    let size = size.unwrap_or(Size { width: 1650, height: 1080 });
    let gpu = Gpu::open(&Options::default())?;
    let mut scenes = Vec::new();
    for name in ["shape:sphere:50", "bust"] {
        let mut scene = Scene::open(name, &LoadOptions::default())?;
        scene.assign_profile(None, 0)?;
        let camera = match name {
            "bust" => Camera::default_for(&scene, 30., f64::from(size.width) / f64::from(size.height)),
            // Close enough that the sphere fills the picture.
            _ => Camera::orbit(0., 0., 110., None, 30., &scene),
        };
        scenes.push(measured(&gpu, name, &scene, &camera, size)?);
    }
    let (info, threads) = (gpu.info(), rayon::current_num_threads());
    let record = serde_json::json!({
        "schema": 1, "bench": "kernels", "device": info.name, "driver": info.driver, "commit": common::commit(), "threads": threads,
        "size": [size.width, size.height], "rounds": ROUNDS, "scenes": scenes,
    });
    common::write(&record, output)?;
    Ok(gpu.close()?)
}

/// Milliseconds of a kernel on the device and on the processor, in turn.
#[derive(Default)]
struct Pairs {
    device: Vec<f64>,
    processor: Vec<f64>,
}

impl Pairs {
    fn record(&self) -> serde_json::Value {
        let ratios = self.device.iter().zip(&self.processor).map(|(d, p)| d / p).collect();
        let least = |values: &[f64]| values.iter().copied().fold(f64::INFINITY, f64::min);
        let (device, processor) = (least(&self.device), least(&self.processor));
        serde_json::json!({
            "device_ms": median(self.device.clone()), "processor_ms": median(self.processor.clone()), "ratio": median(ratios),
            "device_least_ms": device, "processor_least_ms": processor, "ratio_of_least": device / processor,
        })
    }
}

fn measured(gpu: &Arc<Gpu>, name: &str, scene: &Scene, camera: &Camera, size: Size) -> Fallible<serde_json::Value> {
    let shot = |method, kernels| Shot::new(gpu, inputs(scene, camera.clone(), method, kernels, size));
    let mut pdss = shot(Method::Pdss, Kernels::Glsl)?;
    let mut moments = shot(Method::Moments, Kernels::Glsl)?;
    let mut assembly = shot(Method::Pdss, Kernels::Spirv)?;
    pdss.renderer.run()?;
    moments.renderer.run()?;
    let data = pdss.data()?;
    let covered = data.z.iter().filter(|z| **z != 0.).count();

    let bordered = Bordered::new(&data);
    let texels = data.z.len();
    let (mut mean, mut rest) = (vec![0.; texels], vec![0; texels]);
    let step = &pdss.setup.levels.steps[0];
    assert_eq!(step.stride, (1, 1), "{name}: the pass is at full resolution");
    let pass = Pass { variance: step.variance as f32, length_mm: pdss.setup.levels.length_mm as f32 };
    let first = step.level.map_or("way0".to_owned(), |l| l.to_string());
    let mut level = Level::new(texels);
    let mut pictures = [vec![0; texels], vec![0; texels]];
    let levels = [read_levels(&mut pdss)?, read_levels(&mut moments)?];
    let (gloss, lut) = (Table::gloss(), Table::lut(&pdss.lut));
    let lobes = Profile::resolve("skin")?.lobes.ok_or("skin has two lobes")?;
    let wanted = [pdss.words("ldr", 1)?.remove(0), moments.words("ldr", 1)?.remove(0)];
    let (blurred, of_moments) = (pdss.level(&first)?, moments.data()?);
    let (pdss_frame, moments_frame) = (pdss.frame, moments.frame);
    let lights = pdss.lights;
    let jobs = [(&data, &pdss_frame, Some(&lut)), (&of_moments, &moments_frame, None)];

    let mut pairs: [Pairs; 4] = Default::default();
    let mut twins = Vec::new();
    for round in 0..WARM_UP + ROUNDS {
        pdss.renderer.run()?;
        let kernels = [pdss.stage_ms("curvature")?, pdss.stage_ms("blur0")?, pdss.stage_ms("light")?];
        let start = Instant::now();
        curvature::run(&data.screen, &bordered, &mut mean, &mut rest);
        let mut own = vec![milliseconds(start)];
        let start = Instant::now();
        blur::run(pass, &data, &mut level);
        own.push(milliseconds(start));
        for (i, (data, frame, lut)) in jobs.into_iter().enumerate() {
            let job = Job { data, frame, lights: &lights, levels: &levels[i], gloss: &gloss, lut, lobes };
            let start = Instant::now();
            light::run(&job, &mut pictures[i]);
            own.push(milliseconds(start));
        }
        moments.renderer.run()?;
        assembly.renderer.run()?;
        let device = [kernels[0], kernels[1], kernels[2], moments.stage_ms("light")?];
        if round >= WARM_UP {
            for (i, pair) in pairs.iter_mut().enumerate() {
                pair.device.push(device[i]);
                pair.processor.push(own[i]);
            }
            twins.push(assembly.stage_ms("curvature")? / kernels[0]);
        }
    }
    let apart = serde_json::json!({
        "curvature": check::curvature(&data, &mean, &rest)?, "blur": check::level(&blurred, &level, pass)?,
        "light pdss": check::picture(&wanted[0], &pictures[0])?, "light moments": check::picture(&wanted[1], &pictures[1])?,
    });
    // The check's twin: curvature a thousandth off is other work.
    let off: Vec<f32> = mean.iter().map(|h| h * 1.001).collect();
    if check::curvature(&data, &off, &rest).is_ok() {
        return Err("curvature .1 % off passes for the same".into());
    }
    let [bend, soft, lit, lit_moments] = pairs.map(|p| p.record());
    Ok(serde_json::json!({
        "scene": name, "covered": covered as f64 / texels as f64, "apart": apart,
        "curvature": bend, "blur": soft, "light pdss": lit, "light moments": lit_moments,
        "levels": levels.map(|l| l.len()), "curvature_spirv_over_glsl": median(twins),
    }))
}

fn read_levels(shot: &mut Shot) -> Fallible<Vec<Level>> {
    let strides: Vec<u32> = shot.setup.levels.levels.iter().map(|l| l.stride).collect();
    assert!(strides.iter().all(|s| *s == 1), "levels at full resolution");
    (0..strides.len()).map(|i| Ok(shot.level(&i.to_string())?)).collect()
}

fn milliseconds(since: Instant) -> f64 {
    since.elapsed().as_secs_f64() * 1e3
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}
