//! `pdss calibrate`: measures this device, for `render --budget-ms` and `--max-error`.

use super::args;
use super::compare::{Defaults, Question, specs};
use super::failure::Failure;
use super::progress::Progress;
use super::{print, say};
use clap::Args;
use pdss::compare::calibration::{self, Calibration};
use pdss::compare::columns::significant;
use pdss::compare::{self, Options};
use pdss::report::table::Table;
use pdss::settings::Size;
use std::path::PathBuf;

/// File of a device's calibration.
const FILE: &str = "calibration.json";
/// Small: what is sought is what costs what, not how wrong a pixel is.
const DEFAULTS: Defaults = Defaults { size: Size { width: 660, height: 432 }, rounds: 3, samples: 200_000 };

/// Options of `pdss calibrate`.
#[derive(Debug, Args)]
pub struct Calibrate {
    /// Scenes, as of compare. Default: the standard set.
    #[arg(value_name = "SCENE")]
    scenes: Vec<String>,
    #[command(flatten)]
    question: Question,
}

impl Calibrate {
    /// Measures at the size and at half of it, and keeps what that says.
    pub fn run(&self) -> Result<(), Failure> {
        let cache = cache()?;
        let gpu = self.question.device.open()?;
        let home = calibration::directory(&cache, gpu.info());
        let specs = specs(&self.scenes, &self.question)?;
        let progress = Progress::new();
        let asked = self.question.options(specs, &DEFAULTS, &home, None)?;
        let half = Size { width: asked.size.width.div_ceil(2), height: asked.size.height.div_ceil(2) };
        let at = |size: Size| Options { size, error_size: Some(half), cache: cache.join("truth"), ..asked.clone() };
        let small = compare::run(&gpu, &at(half), &|line| progress.show(&format!("half size: {line}")))?;
        let large = compare::run(&gpu, &at(asked.size), &|line| progress.show(&format!("whole size: {line}")))?;
        drop(progress);
        let found = Calibration::new(&small, &large)?;
        found.keep(&home.join(FILE))?;
        say(&format!("kept in {}", home.join(FILE).display()));
        print(&table(&found))?;
        args::close(gpu)
    }
}

/// Where calibrations and their truths are kept.
fn cache() -> Result<PathBuf, Failure> {
    calibration::cache_directory()
        .ok_or_else(|| Failure::Input("no cache directory: set XDG_CACHE_HOME to an absolute path".to_owned()))
}

/// The calibration of a device.
pub fn of(device: &pdss::gpu::DeviceInfo) -> Result<Calibration, Failure> {
    let file = calibration::directory(&cache()?, device).join(FILE);
    let none = || {
        Failure::Input(format!("{} is not calibrated: run pdss calibrate once, with the same --device", device.name))
    };
    let found = Calibration::find(&file)?.ok_or_else(none)?;
    if found.code != compare::key::of_code() {
        say(&format!("warning: calibrated by another program ({}); pdss calibrate measures this one", found.code));
    }
    Ok(found)
}

fn table(c: &Calibration) -> String {
    let mut table = Table::new(&["method", "quality", "fixed ms", "ms a megapixel", "error", "worst", "on"]);
    for s in &c.settings {
        let three = |x: f64| significant(x, 3);
        let figures = [s.fixed_ms, s.megapixel_ms, s.rmse, s.worst_rmse].map(three);
        table.row([s.method.clone(), s.quality.clone()].into_iter().chain(figures).chain([s.worst_scene.clone()]));
    }
    format!("{} ({}), {} scenes\n{table}", c.device, c.driver, c.scenes)
}
