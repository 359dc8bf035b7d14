//! `pdss truth`: the converged answer, with its own error.

use super::args::{Stage, View};
use super::failure::Failure;
use super::progress::Progress;
use super::{print, say};
use clap::{Args, ValueEnum};
use pdss::frame::Output;
use pdss::report::picture;
use pdss::settings::View as Show;
use pdss::skin::occlusion;
use pdss::skin::profile::Profile;
use pdss::truth::ambient;
use pdss::truth::{self, Checkpoint, Effort, Truth as Answer, Window, metrics};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Options of `pdss truth`.
#[derive(Debug, Args)]
pub struct Truth {
    #[command(flatten)]
    view: View,
    /// The picture, .exr: linear, A = coverage. Its error is written beside it as .json, its bands as .bands.exr.
    #[arg(long, short, value_name = "FILE")]
    output: PathBuf,
    /// Only this window of the picture, pixels.
    #[arg(long, value_name = "X,Y,W,H", value_parser = parse_window)]
    crop: Option<Window>,
    /// Surface samples of the far part of the integral.
    #[arg(long, value_name = "N", default_value_t = Effort::default().samples,
        value_parser = parse_count)]
    samples: usize,
    /// Error of a pixel above which its near part is integrated again with more rays.
    #[arg(long, value_name = "E", default_value_t = Effort::default().max_error, value_parser = parse_error)]
    max_error: f64,
    /// Size of what counts as one point, as a part of its distance.
    #[arg(long, value_name = "X", default_value_t = Effort::default().opening, value_parser = parse_error)]
    opening: f64,
    /// Least seconds between two writes of the state that an interrupted run goes on from: FILE with .state, removed when done.
    #[arg(long, value_name = "S", default_value_t = 15., value_parser = parse_seconds)]
    save_every: f64,
    /// Occlusion radius of --view ao, mm. Default: the widest level's, three sigma of the profile's widest Gaussian.
    #[arg(long, value_name = "MM", value_parser = parse_length)]
    radius: Option<f64>,
    /// Rays a pixel of --view ao.
    #[arg(long, value_name = "N", default_value_t = 1024, value_parser = parse_rays)]
    rays: usize,
}

/// What is written beside an ambient picture.
#[derive(serde::Serialize)]
struct AmbientRecord<'a> {
    schema: u32,
    method: &'static str,
    scene: &'a str,
    size: [u32; 2],
    window: Window,
    falloff: &'static str,
    radius_mm: f64,
    rays: usize,
    error: AmbientError,
    covered_pixels: usize,
    seconds: f64,
}

#[derive(serde::Serialize)]
struct AmbientError {
    rms: f64,
    p99: f64,
}

/// What is written beside the picture.
#[derive(serde::Serialize)]
struct Record<'a> {
    schema: u32,
    method: &'static str,
    scene: &'a str,
    profile: Option<String>,
    size: [u32; 2],
    window: Window,
    shadows: bool,
    lights: usize,
    effort: Effort,
    error: truth::Estimate,
    samples: usize,
    refined_pixels: usize,
    covered_pixels: usize,
    band_pixels: Vec<(&'static str, usize)>,
    kernel_mass_p5_p50_p95: [f64; 3],
    near_and_reach_mm: [f64; 2],
    seconds: f64,
    resumed_pixels: usize,
    warnings: &'a [String],
}

impl Truth {
    /// Integrates, and writes picture, bands and record.
    pub fn run(&self) -> Result<(), Failure> {
        if picture::format_of(&self.output)? != picture::Format::Exr {
            return Err(Failure::Input(format!("{}: truth is written as .exr", self.output.display())));
        }
        let stage = self.view.load()?;
        if stage.scene.environment.is_some() {
            say("truth knows no sky: what --env would light is left out");
        }
        match stage.settings.view {
            Show::Final | Show::Scatter => self.exitance(&stage),
            Show::Ao => self.ambient(&stage),
            other => {
                let name = other.to_possible_value().map_or_else(String::new, |v| v.get_name().to_owned());
                Err(Failure::Input(format!(
                    "--view {name}: truth knows scatter (exitance) and ao (visibility of the sky)"
                )))
            }
        }
    }

    /// Visibility of the sky by cast rays.
    fn ambient(&self, stage: &Stage) -> Result<(), Failure> {
        let sigmas = |p: &Profile| p.gaussians().gaussians.into_iter().map(|g| g.variance.sqrt());
        let widest = stage.profiles.iter().flat_map(sigmas).fold(0., f64::max);
        let radius = self.radius.unwrap_or(occlusion::RADIUS_SIGMAS * widest);
        if radius <= 0. {
            return Err(Failure::Input(
                "--view ao: a profile that does not scatter has no radius; give --radius MM".to_owned(),
            ));
        }
        let progress = Progress::new();
        let inputs = stage.inputs(None, Output::Linear);
        let a = ambient::visibility(&inputs, self.crop, radius, self.rays, |part| {
            progress.show(&format!("truth: {} %", part / 10));
        })
        .map_err(|e| Failure::Input(e.to_string()))?;
        drop(progress);
        let record = AmbientRecord {
            schema: 1,
            method: "ambient truth",
            scene: &stage.name,
            size: stage.size(),
            window: a.window,
            falloff: "quadratic: 1 - (t/R)^2",
            radius_mm: a.radius_mm,
            rays: a.rays,
            error: AmbientError { rms: a.rms, p99: a.p99 },
            covered_pixels: a.pixels.iter().filter(|p| p[3] > 0.).count(),
            seconds: a.seconds,
        };
        let text = serde_json::to_string_pretty(&record).map_err(|e| Failure::Run(format!("writing JSON: {e}")))?;
        picture::write_text(&self.output.with_extension("json"), &(text + "\n"))?;
        picture::write_exr(&self.output, [a.window.width, a.window.height], &a.pixels)?;
        print(&format!(
            "{}: rms error {:.2e} (p99 {:.2e}), {} rays up to {:.3} mm, {:.1} s\n",
            self.output.display(),
            a.rms,
            a.p99,
            a.rays,
            a.radius_mm,
            a.seconds
        ))
    }

    /// The scattered light.
    fn exitance(&self, stage: &Stage) -> Result<(), Failure> {
        let inputs = stage.inputs(None, Output::Linear);
        let effort = Effort { samples: self.samples, max_error: self.max_error, opening: self.opening };
        let progress = Progress::new();
        let state = self.output.with_extension("exr.state");
        let checkpoint = Checkpoint { file: state.clone(), every: Duration::from_secs_f64(self.save_every) };
        let answer = truth::resume(&inputs, self.crop, &effort, Some(&checkpoint), |part| {
            progress.show(&format!("truth: {} %", part / 10))
        })
        .map_err(|e| Failure::Input(e.to_string()))?;
        drop(progress);
        for warning in &answer.warnings {
            say(&format!("warning: {warning}"));
        }
        let size = [answer.window.width, answer.window.height];
        let bands = metrics::bands_picture(&answer.bands);
        let record = Record {
            schema: 1,
            method: "truth",
            scene: &stage.name,
            profile: (!stage.profiles.is_empty()).then(|| Profile::joined(&stage.profiles)),
            size: stage.size(),
            window: answer.window,
            shadows: !stage.settings.no_shadows,
            lights: stage.lights.len(),
            effort,
            error: answer.error,
            samples: answer.samples,
            refined_pixels: answer.refined,
            covered_pixels: answer.pixels.iter().filter(|p| p[3] > 0.).count(),
            band_pixels: metrics::BANDS
                .iter()
                .map(|(name, bit)| (*name, answer.bands.iter().filter(|b| *b & bit != 0).count()))
                .collect(),
            kernel_mass_p5_p50_p95: answer.mass,
            near_and_reach_mm: answer.radii_mm,
            seconds: answer.seconds,
            resumed_pixels: answer.resumed,
            warnings: &answer.warnings,
        };
        let text = serde_json::to_string_pretty(&record).map_err(|e| Failure::Run(format!("writing JSON: {e}")))?;
        picture::write_exr(&self.output.with_extension("bands.exr"), size, &bands)?;
        picture::write_text(&self.output.with_extension("json"), &(text + "\n"))?;
        picture::write_exr(&self.output, size, &answer.pixels)?;
        match std::fs::remove_file(&state) {
            Err(e) if e.kind() != std::io::ErrorKind::NotFound => {
                say(&format!("warning: {}: {e}; the result is whole, this file may go", state.display()));
            }
            _ => {}
        }
        print(&summary(&self.output, &answer))
    }
}

fn summary(file: &Path, a: &Answer) -> String {
    format!(
        "{}: rms error {:.2e} (noise {:.2e}, p99 {:.2e}; tree {:.2e}), {} samples, {} pixels refined, {:.1} s\n",
        file.display(),
        a.error.rms,
        a.error.noise,
        a.error.noise_p99,
        a.error.tree,
        a.samples,
        a.refined,
        a.seconds
    )
}

fn parse_window(text: &str) -> Result<Window, String> {
    let numbers: Option<Vec<u32>> = text.split(',').map(|t| t.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some([x, y, w, h]) if *w > 0 && *h > 0 => Ok(Window { x: *x, y: *y, width: *w, height: *h }),
        _ => Err("that is not x,y,width,height in pixels; 100,80,64,64 would be".to_owned()),
    }
}

pub fn parse_count(text: &str) -> Result<usize, String> {
    text.parse()
        .ok()
        .filter(|n| (1000..=200_000_000).contains(n))
        .ok_or_else(|| "samples are 1000 to 200000000".to_owned())
}

fn parse_length(text: &str) -> Result<f64, String> {
    let right = |x: &f64| *x > 0. && x.is_finite();
    text.parse().ok().filter(right).ok_or_else(|| "that is not a length above 0 mm; 8 would be".to_owned())
}

fn parse_rays(text: &str) -> Result<usize, String> {
    text.parse().ok().filter(|n| (2..=1_000_000).contains(n)).ok_or_else(|| "rays are 2 to 1000000".to_owned())
}

fn parse_seconds(text: &str) -> Result<f64, String> {
    let right = |x: &f64| (0. ..=86400.).contains(x);
    text.parse().ok().filter(right).ok_or_else(|| "that is not 0 to 86400 seconds; 15 would be".to_owned())
}

pub fn parse_error(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|x| *x > 0. && *x <= 1.).ok_or_else(|| "that is not above 0 and at most 1".to_owned())
}
