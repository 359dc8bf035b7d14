//! `pdss render`: a picture of a scene.

use super::args::{self, Stage, View, parse_positive};
use super::failure::Failure;
use super::watch::Watch;
use super::{calibrate, contact_sheet, say};
use clap::{Args, ValueEnum};
use pdss::compare::calibration::Wish;
use pdss::compare::columns::significant;
use pdss::frame::{FrameError, Output, Renderer};
use pdss::gpu::Gpu;
use pdss::gpu::timing::TimingMode;
use pdss::report::layers::{self, Layer, Made};
use pdss::report::measure::{self, Warmup};
use pdss::report::picture::{self, Format};
use pdss::report::stats::Summary;
use pdss::report::{preview, supersample};
use pdss::settings::{Method, Quality, Size, View as Show, parse_size};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Options of `pdss render`.
#[derive(Debug, Args)]
pub struct Render {
    #[command(flatten)]
    view: View,
    /// More scenes, for a contact sheet.
    #[arg(value_name = "SCENE", requires = "contact_sheet")]
    more: Vec<String>,
    /// All scenes on one .png, named below each; one that is refused says why in its place.
    #[arg(long)]
    contact_sheet: bool,
    /// Size of a scene on a contact sheet, in pixels.
    #[arg(long, value_name = "WxH", default_value = "256x192", value_parser = parse_size, requires = "contact_sheet")]
    cell: Size,
    /// The picture: .png, tone-mapped, or .exr, linear 32-bit float whose A is coverage.
    #[arg(long, short, value_name = "FILE")]
    output: PathBuf,
    /// Frames drawn before the picture is taken; or, as A..B, a sequence: frames A to B, both included, of the file's animation,
    /// each a picture with its number before the extension.
    #[arg(long, value_name = "N|A..B", default_value = "1", value_parser = parse_frames)]
    frames: Frames,
    /// Frames a second of a sequence; frame 0 is at --time.
    #[arg(long, value_name = "F", default_value_t = 24., value_parser = parse_positive)]
    fps: f64,
    /// Write every view that the method has into one .exr, as layers: the picture is R, G, B, A, the others normal.R and so on.
    #[arg(long, conflicts_with = "view")]
    layers: bool,
    /// Samples of a pixel along each axis, averaged in linear light: for lit PNGs. EXR and other views have one.
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=4))]
    supersample: u32,
    /// Choose the method and quality that are nearest to truth among those whose frame takes at most X ms, by what
    /// pdss calibrate measured on this device.
    #[arg(long, value_name = "X", value_parser = parse_positive, conflicts_with_all = ["method", "quality"])]
    budget_ms: Option<f64>,
    /// Choose the fastest method and quality whose rms error on the calibrated scenes is at most E.
    #[arg(long, value_name = "E", value_parser = parse_positive, conflicts_with_all = ["method", "quality"])]
    max_error: Option<f64>,
}

/// Which frames are drawn, and what is kept of them.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Frames {
    /// The same this often; the last is kept.
    Still(u32),
    /// Moments of an animation, both ends included; each is kept.
    Sequence(u32, u32),
}

fn parse_frames(text: &str) -> Result<Frames, String> {
    let read = match text.split_once("..") {
        Some((first, last)) => first.parse().ok().zip(last.parse().ok()).map(|(a, b)| Frames::Sequence(a, b)),
        None => text.parse().ok().map(Frames::Still),
    };
    match read {
        Some(Frames::Still(0)) | None => {
            Err("that is no number of frames above 0 and no range; 0..47 would be".to_owned())
        }
        Some(Frames::Sequence(a, b)) if a > b => Err(format!("frame {b} comes before {a}; {b}..{a} would be a range")),
        Some(frames) => Ok(frames),
    }
}

impl Render {
    /// Draws, and writes the picture, or the pictures.
    pub fn run(&self) -> Result<(), Failure> {
        let format = picture::format_of(&self.output)?;
        if self.layers && format != Format::Exr {
            return Err(Failure::Input(format!("{}: --layers writes an .exr", self.output.display())));
        }
        if self.contact_sheet {
            let scenes: Vec<&str> =
                [self.view.scene()].into_iter().chain(self.more.iter().map(String::as_str)).collect();
            return contact_sheet::draw(&self.view, &scenes, self.cell, self.supersample, &self.output);
        }
        let mut watch = Watch::default();
        let (start, repeat) = match self.frames {
            Frames::Still(count) => (None, count),
            Frames::Sequence(first, _) => (Some(self.at(first)), 1),
        };
        let (first, gpu) = std::thread::scope(|both| {
            let open = both.spawn(|| self.view.open());
            (start.as_ref().unwrap_or(&self.view).load(), open.join())
        });
        let gpu = gpu.map_err(|_| Failure::Run("opening the device failed".to_owned()))?;
        // What is wrong with the input comes first.
        let (first, gpu) = (first?, gpu?);
        watch.lap("scene and device");
        match self.frames {
            Frames::Still(_) => self.draw(&gpu, first, format, repeat, &self.output, watch)?,
            Frames::Sequence(start, end) => {
                // What is odd about the file is said once.
                self.draw(&gpu, first, format, repeat, &self.numbered(start), watch)?;
                for frame in start + 1..=end {
                    let mut watch = Watch::default();
                    let stage = self.at(frame).load_silently()?;
                    watch.lap("scene");
                    self.draw(&gpu, stage, format, repeat, &self.numbered(frame), watch)?;
                }
            }
        }
        args::close(gpu)
    }

    /// The view at a frame of a sequence.
    fn at(&self, frame: u32) -> View {
        self.view.later(f64::from(frame) / self.fps)
    }

    /// head.png, frame 7: head.0007.png.
    fn numbered(&self, frame: u32) -> PathBuf {
        let extension = self.output.extension().unwrap_or_default().to_string_lossy();
        self.output.with_extension(format!("{frame:04}.{extension}"))
    }

    fn draw(
        &self,
        gpu: &Arc<Gpu>,
        mut stage: Stage,
        format: Format,
        repeat: u32,
        path: &Path,
        mut watch: Watch,
    ) -> Result<(), Failure> {
        let size = stage.size();
        let wish = Wish { budget_ms: self.budget_ms, max_error: self.max_error };
        if wish != Wish::default() {
            choose(gpu, &mut stage, wish)?;
        }
        let output = match format {
            Format::Png => Output::Ldr,
            Format::Exr => Output::Linear,
        };
        if format == Format::Png {
            self.view.tell(&stage.meter());
        }
        let most = gpu.limits().max_image_dimension2_d / size[0].max(size[1]);
        let samples = if stage.lit() && format == Format::Png { self.supersample.min(most).max(1) } else { 1 };
        stage.settings.size = Size { width: size[0] * samples, height: size[1] * samples };
        let mut renderer = Renderer::new(gpu, stage.inputs(None, output))?;
        let cpu = renderer.cpu_times();
        watch.known([
            ("plan", cpu.plan_ms),
            ("upload", cpu.upload_ms),
            ("pipelines", cpu.pipelines_ms),
            ("record", cpu.record_ms),
        ]);
        renderer.run()?;
        watch.lap("first frame");
        for _ in 1..repeat {
            renderer.run()?;
        }
        watch.start();
        match (format, renderer.output()) {
            (Format::Png, Output::Ldr) => {
                picture::write_png(path, size, &supersample::average(&renderer.ldr()?, size, samples))?;
            }
            (Format::Exr, _) => {
                let mut list = vec![Layer::picture(&renderer.linear()?)];
                let made = Made::of(&stage.name, &stage.inputs(None, output), gpu.info());
                if self.layers {
                    list.extend(self.others(gpu, &mut stage)?);
                }
                layers::write(path, size, &list, &made)?;
            }
            // A view of numbers is linear whatever the picture is; a PNG shows them to people.
            (Format::Png, Output::Linear) => {
                let (texels, meaning) = preview::encode(stage.settings.view, &renderer.linear()?);
                self.view.tell(&format!("{}: {meaning}", path.display()));
                picture::write_png(path, size, &texels)?;
            }
        }
        watch.lap("picture");
        self.view.tell(&watch.words());
        Ok(())
    }
}

/// The views beside the picture, and how many numbers each has.
const LAYERS: [(Show, usize); 13] = [
    (Show::Albedo, 3),
    (Show::Normal, 3),
    (Show::ShadingNormal, 3),
    (Show::Position, 3),
    (Show::Depth, 1),
    (Show::Material, 3),
    (Show::Curvature, 3),
    (Show::SoftNormal, 3),
    (Show::SoftCurvature, 1),
    (Show::Ao, 1),
    (Show::Lit, 2),
    (Show::Irradiance, 3),
    (Show::Scatter, 3),
];

impl Render {
    /// A frame for each view; those that the method does not make are left out, and said.
    fn others(&self, gpu: &Arc<Gpu>, stage: &mut Stage) -> Result<Vec<Layer>, Failure> {
        let mut list = Vec::new();
        for (view, numbers) in LAYERS {
            stage.settings.view = view;
            let mut renderer = match Renderer::new(gpu, stage.inputs(None, Output::Linear)) {
                Ok(renderer) => renderer,
                Err(refusal @ FrameError::View { .. }) => {
                    self.view.tell(&format!("no such layer: {refusal}"));
                    continue;
                }
                Err(error) => return Err(error.into()),
            };
            renderer.run()?;
            let name = view.to_possible_value().map_or_else(String::new, |v| v.get_name().to_owned());
            list.push(Layer::named(&name, numbers, &renderer.linear()?));
        }
        Ok(list)
    }
}

/// Frames that say whether a choice holds on this scene: before the first sample, and samples.
const TRIAL: (usize, usize) = (3, 7);

/// Sets method and quality as the device's calibration recommends, once this very scene has been tried with them.
fn choose(gpu: &Arc<Gpu>, stage: &mut Stage, wish: Wish) -> Result<(), Failure> {
    let calibration = calibrate::of(gpu.info())?;
    let [width, height] = stage.size();
    let pixels = u64::from(width) * u64::from(height);
    let mut tried = Vec::new();
    for setting in calibration.choose(wish, pixels).map_err(Failure::Input)? {
        let (Ok(method), Ok(quality)) =
            (Method::from_str(&setting.method, false), Quality::from_str(&setting.quality, false))
        else {
            continue;
        };
        (stage.settings.method, stage.settings.quality) = (method, quality);
        let name = format!("{} {}", setting.method, setting.quality);
        let took = match trial(gpu, stage, calibration.clock == "device")? {
            Ok(ms) => ms,
            Err(why) => {
                tried.push(format!("{name} {why}"));
                continue;
            }
        };
        let three = |x: f64| significant(x, 3);
        if wish.budget_ms.is_none_or(|budget| took <= budget) {
            let before = if tried.is_empty() { String::new() } else { format!("; not {}", tried.join(", not ")) };
            let [error, expected, took] = [setting.rmse, setting.frame_ms(pixels), took].map(three);
            say(&format!(
                "{name}: error {error} rms over {} calibrated scenes, {} on {} at worst; {expected} ms expected, {took} ms here{before}",
                calibration.scenes,
                three(setting.worst_rmse),
                setting.worst_scene
            ));
            return Ok(());
        }
        tried.push(format!("{name}, {} ms here", three(took)));
    }
    Err(Failure::Input(format!("nothing that was expected to fit did on this scene: {}", tried.join("; "))))
}

/// The median frame time of the stage as it is, ms, on the clock that it was calibrated by; or why its method does not draw it.
fn trial(gpu: &Arc<Gpu>, stage: &Stage, stamps: bool) -> Result<Result<f64, String>, Failure> {
    let timing = stamps.then_some(TimingMode::Overlap);
    let mut renderer = match Renderer::new(gpu, stage.inputs(timing, Output::Ldr)) {
        Ok(renderer) => renderer,
        Err(FrameError::Gpu(error)) => return Err(error.into()),
        Err(refusal) => return Ok(Err(refusal.to_string())),
    };
    let (_, samples) = measure::measure(&mut renderer, Warmup::Exactly(TRIAL.0), TRIAL.1, |_, _| {})?;
    let times = if stamps { samples.gpu_ms() } else { samples.wall_ms.into_iter().map(Some).collect() };
    Ok(Ok(Summary::of(&times).map_or(f64::INFINITY, |s| s.median)))
}
