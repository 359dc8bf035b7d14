//! `pdss profile`: how long every stage of a frame takes.

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
use pdss::report::{table, trace};
use pdss::settings::{self, Method};
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
            profile: stage.profile.as_ref().map(|p| p.name.clone()),
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
    inputs.settings.no_elide = false;
    let mut renderer = Renderer::new(gpu, inputs)?;
    renderer.run()?;
    Ok(renderer.linear()?.iter().filter(|p| p[3] > 0.).count() as u64)
}

/// Frames done and all frames; none at all while warming up.
fn turn(done: usize, all: usize) -> String {
    if all == 0 { format!("warming up: frame {}", done + 1) } else { format!("frame {} of {all}", done + 1) }
}
