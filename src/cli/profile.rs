//! `pdss profile`: how long every stage of a frame takes.

use super::args::parse_positive;
use super::args::{self, Stage, View};
use super::failure::Failure;
use super::progress::Progress;
use super::{print, print_json};
use clap::{Args, ValueEnum};
use pdss::frame::{FrameError, Output, Renderer};
use pdss::gpu::Gpu;
use pdss::gpu::timing::TimingMode;
use pdss::report::measure::{self, Warmup};
use pdss::report::record::{Record, Subject};
use pdss::report::versus::Versus;
use pdss::report::{table, trace};
use pdss::settings::{self, Method};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Options of `pdss profile`.
#[derive(Debug, Args)]
pub struct Profile {
    #[command(flatten)]
    view: View,
    /// Frames measured.
    #[arg(long, value_name = "N", default_value_t = 60, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    frames: u32,
    /// Frames before the first sample. Default: 5, then until the median has settled, 100 or ten seconds at most.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(..=1_000_000))]
    warmup: Option<u32>,
    /// Whether stages may overlap or run each alone.
    #[arg(long, value_enum, default_value_t)]
    timing: TimingMode,
    /// A table for people; JSON and CSV for programs; a trace of the median frame for ui.perfetto.dev.
    #[arg(long, value_enum, default_value_t)]
    format: Format,
    /// Run nothing: hold two JSON records of one device and one setting against each other. Exit code 1 where something has
    /// become slower by more than the threshold and three times the noise.
    #[arg(long, num_args = 2, value_names = ["OLD", "NEW"])]
    compare: Option<Vec<PathBuf>>,
    /// Part of the older time by which the newer may exceed it.
    #[arg(long, value_name = "PART", default_value_t = 0.05, value_parser = parse_positive, requires = "compare")]
    threshold: f64,
}

/// How a record is written.
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
enum Format {
    /// For people.
    #[default]
    Table,
    /// The whole record.
    Json,
    /// A row per stage.
    Csv,
    /// The median frame as a Chrome trace.
    Trace,
}

impl Profile {
    /// Measures, and prints the record.
    pub fn run(&self) -> Result<(), Failure> {
        if let Some([old, new]) = self.compare.as_deref() {
            return self.versus(old, new);
        }
        let stage = self.view.load()?;
        let gpu = self.view.open()?;
        let record = self.measure(&gpu, &stage)?;
        match self.format {
            Format::Table => print(&table::of_record(&record))?,
            Format::Json => print_json(&record)?,
            Format::Csv => print(&record.csv())?,
            Format::Trace => print_json(&trace::of_record(&record))?,
        }
        args::close(gpu)
    }

    fn versus(&self, old: &Path, new: &Path) -> Result<(), Failure> {
        let read = |path: &Path| -> Result<serde_json::Value, Failure> {
            let wrong = |why: String| Failure::Input(format!("{}: {why}", path.display()));
            let text = std::fs::read(path).map_err(|e| wrong(e.to_string()))?;
            serde_json::from_slice(&text).map_err(|e| wrong(format!("not a record of pdss profile --format json: {e}")))
        };
        let versus = Versus::of(&read(old)?, &read(new)?, self.threshold).map_err(Failure::Input)?;
        print(&versus.to_string())?;
        match versus.slower().as_slice() {
            [] => Ok(()),
            names => Err(Failure::Run(format!("slower: {}", names.join(", ")))),
        }
    }

    fn measure(&self, gpu: &Arc<Gpu>, stage: &Stage) -> Result<Record, Failure> {
        // Counted in a frame of its own, so that the frame that is timed reads nothing back for it.
        let covered_pixels = covered(gpu, stage).ok();
        let mut renderer = Renderer::new(gpu, stage.inputs(Some(self.timing), Output::Ldr))?;
        let warmup = self.warmup.map_or(Warmup::Settle, |n| Warmup::Exactly(n as usize));
        let progress = Progress::new();
        let (warmed, samples) =
            measure::measure(&mut renderer, warmup, self.frames as usize, |done, all| progress.show(&turn(done, all)))?;
        drop(progress);
        let subject = Subject {
            scene: stage.name.clone(),
            triangles: stage.scene.triangle_count(),
            profile: (!stage.profiles.is_empty()).then(|| pdss::skin::profile::Profile::joined(&stage.profiles)),
            lights: stage.lights.len(),
            settings: stage.settings.clone(),
            timing: self.timing,
            validation: self.view.validates(),
            covered_pixels,
        };
        let (plan, memory, cpu) = (renderer.plan(), renderer.memory(), renderer.cpu_times());
        Ok(Record::new(gpu.info(), subject, plan, memory, cpu, warmed, samples))
    }
}

/// Pixels that the scene covers, from the cheapest frame that knows.
fn covered(gpu: &Arc<Gpu>, stage: &Stage) -> Result<u64, FrameError> {
    let mut inputs = stage.inputs(None, Output::Linear);
    inputs.settings.method = Method::Lambert;
    inputs.settings.view = settings::View::Albedo;
    inputs.settings.no_shadows = true;
    inputs.settings.no_elide.clear();
    let mut renderer = Renderer::new(gpu, inputs)?;
    renderer.run()?;
    Ok(renderer.linear()?.iter().filter(|p| p[3] > 0.).count() as u64)
}

/// Frames done and all frames; none at all while warming up.
fn turn(done: usize, all: usize) -> String {
    if all == 0 { format!("warming up: frame {}", done + 1) } else { format!("frame {} of {all}", done + 1) }
}
