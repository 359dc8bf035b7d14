//! `pdss figure1`: both halves of the poster's first figure. Our picture at every quality with its time, and curvature by every
//! estimator at creases and silhouettes, in one colour map.

use super::args::{self, Stage, View};
use super::failure::Failure;
use super::say;
use clap::{Args, ValueEnum};
use pdss::frame::{Output, Renderer};
use pdss::gpu::Gpu;
use pdss::report::canvas::Canvas;
use pdss::report::measure::{self, Warmup};
use pdss::report::{picture, stats};
use pdss::settings::{Curvature, Quality, View as Show};
use std::path::PathBuf;
use std::sync::Arc;

/// Options of `pdss figure1`.
#[derive(Debug, Args)]
pub struct Figure1 {
    #[command(flatten)]
    view: View,
    /// Where figure1.png goes; made if it is not there.
    #[arg(long, short, value_name = "DIR")]
    output: PathBuf,
    /// Frames whose median is the time of a quality.
    #[arg(long, value_name = "N", default_value_t = 7, value_parser = clap::value_parser!(u32).range(1..=1000))]
    frames: u32,
}

/// Width of the figure, and of what stands between its pictures, pixels.
const WIDTH: u32 = 1320;
const GAP: u32 = 8;
/// Height of a line of words.
const LINE: u32 = 26;
const INK: [u8; 3] = [20; 3];
/// Enlarged part of a picture: a window this part of its width across.
const ZOOM: u32 = 6;

/// A picture of the scene with what is said of it.
struct Panel {
    words: String,
    texels: Vec<u8>,
}

impl Figure1 {
    /// Draws, measures, and writes the figure.
    pub fn run(&self) -> Result<(), Failure> {
        let mut stage = self.view.load()?;
        let gpu = self.view.open()?;
        let name = &gpu.info().name;
        let pictures = self.pictures(&gpu, &mut stage)?;
        let (curvatures, range, window) = curvatures(&gpu, &mut stage)?;
        let size = stage.size();
        let method = stage.settings.method.to_possible_value().map_or(String::new(), |v| v.get_name().to_owned());
        let first = format!("{method}, {} x {}: whole frames, median of {}, on {name}", size[0], size[1], self.frames);
        let second = format!("mean curvature, blue {:.3} to red {range:.3} 1/mm; below: the frame enlarged", -range);

        // Letters of 16 pixels, or of 8 where the line would not fit.
        let scale = |line: &str| if line.len() as u32 * 16 <= WIDTH { 2 } else { 1 };
        let wide = |n: u32| (WIDTH - GAP * (n - 1)) / n;
        let high = |w: u32| (u64::from(w) * u64::from(size[1]) / u64::from(size[0])).max(1) as u32;
        let (four, five) = (wide(pictures.len() as u32), wide(curvatures.len() as u32));
        let tops = [LINE, LINE + high(four), 3 * LINE + high(four)];
        let zoomed = tops[2] + LINE + high(five) + GAP;
        let mut canvas = Canvas::new([WIDTH, zoomed + high(five)], [255; 3]);
        canvas.text([0, 4], scale(&first), INK, &first);
        for (i, panel) in pictures.iter().enumerate() {
            let x = i as u32 * (four + GAP);
            canvas.picture([x, tops[0]], [four, high(four)], &panel.texels, size, [0, 0, size[0], size[1]]);
            canvas.text([x, tops[1] + 4], 2, INK, &panel.words);
        }
        canvas.text([0, tops[1] + LINE + 4], scale(&second), INK, &second);
        for (i, panel) in curvatures.iter().enumerate() {
            let x = i as u32 * (five + GAP);
            canvas.text([x, tops[2] + 4], 2, INK, &panel.words);
            let y = tops[2] + LINE;
            canvas.picture([x, y], [five, high(five)], &panel.texels, size, [0, 0, size[0], size[1]]);
            let shrunk = |v: u32| (u64::from(v) * u64::from(five) / u64::from(size[0])) as u32;
            canvas.frame([x + shrunk(window[0]), y + shrunk(window[1]), shrunk(window[2]), shrunk(window[3])], INK);
            canvas.picture([x, zoomed], [five, high(five)], &panel.texels, size, window);
        }
        std::fs::create_dir_all(&self.output)
            .map_err(|e| Failure::Input(format!("--output {}: {e}", self.output.display())))?;
        let file = self.output.join("figure1.png");
        picture::write_png(&file, canvas.size, &canvas.texels)?;
        self.view.tell(&file.display().to_string());
        args::close(gpu)
    }

    /// The picture of each quality, its time beside it.
    fn pictures(&self, gpu: &Arc<Gpu>, stage: &mut Stage) -> Result<Vec<Panel>, Failure> {
        let mut panels = Vec::new();
        for quality in Quality::value_variants() {
            stage.settings.quality = *quality;
            let mut renderer = Renderer::new(gpu, stage.inputs(None, Output::Ldr))?;
            let (_, samples) = measure::measure(&mut renderer, Warmup::Exactly(2), self.frames as usize, |_, _| {})?;
            let mut times = samples.wall_ms;
            times.sort_by(f64::total_cmp);
            let median = stats::quantile(&times, 0.5).unwrap_or_default();
            let words = format!("{} {median:.1} ms", named(quality));
            panels.push(Panel { words, texels: renderer.ldr()? });
        }
        Ok(panels)
    }
}

fn named(value: &impl ValueEnum) -> String {
    value.to_possible_value().map_or(String::new(), |v| v.get_name().to_owned())
}

/// Curvature by each estimator, the range of the colours (1/mm), and the window that is enlarged.
fn curvatures(gpu: &Arc<Gpu>, stage: &mut Stage) -> Result<(Vec<Panel>, f64, [u32; 4]), Failure> {
    stage.settings.view = Show::Curvature;
    let size = stage.size();
    let all = [Curvature::Vergne, Curvature::VergneMended, Curvature::Trace, Curvature::Metric, Curvature::Fit];
    let mut fields = Vec::new();
    for estimator in all {
        stage.settings.curvature = estimator;
        let mut renderer = Renderer::new(gpu, stage.inputs(None, Output::Linear))?;
        renderer.run()?;
        fields.push(renderer.linear()?);
    }
    let fit = fields.last().map_or(&[][..], Vec::as_slice);
    let mut sizes: Vec<f64> = fit.iter().filter(|p| p[3] > 0.).map(|p| f64::from(p[0].abs())).collect();
    sizes.sort_by(f64::total_cmp);
    let range = stats::quantile(&sizes, 0.98).filter(|r| *r > 0.).unwrap_or(1.);
    let window = window(fit, size, range as f32);
    let panel = |(estimator, field): (Curvature, &Vec<[f32; 4]>)| {
        // How far the estimator is from the fit, where it matters most: the hundredth that is worst.
        let mut apart: Vec<f64> =
            field.iter().zip(fit).filter(|(p, _)| p[3] > 0.).map(|(p, f)| f64::from((p[0] - f[0]).abs())).collect();
        apart.sort_by(f64::total_cmp);
        let worst = stats::quantile(&apart, 0.99).unwrap_or_default();
        say(&format!("{}: 99 % of pixels within {worst:.4} 1/mm of fit", named(&estimator)));
        Panel { words: named(&estimator), texels: field.iter().flat_map(|p| colour(*p, range as f32)).collect() }
    };
    Ok((all.into_iter().zip(&fields).map(panel).collect(), range, window))
}

/// Blue, white, red: -range, 0, range; what is not a number is black.
fn colour([h, _, _, covered]: [f32; 4], range: f32) -> [u8; 4] {
    if covered == 0. {
        return [0; 4];
    }
    if h.is_nan() {
        return [0, 0, 0, 255];
    }
    let t = (h / range).clamp(-1., 1.);
    let fade = |to: f32| (255. * (1. - t.abs() * (1. - to))).round() as u8;
    if t < 0. { [fade(0.1), fade(0.25), fade(0.85), 255] } else { [fade(0.8), fade(0.1), fade(0.1), 255] }
}

/// The part of the picture with most curvature in it and some background: creases and a silhouette.
fn window(field: &[[f32; 4]], size: [u32; 2], range: f32) -> [u32; 4] {
    let extent = size.map(|s| (s / ZOOM).max(1));
    let score = |x0: u32, y0: u32| {
        let (mut bent, mut empty) = (0., 0.);
        for y in y0..y0 + extent[1] {
            for x in x0..x0 + extent[0] {
                let [h, _, _, covered] = field[(y * size[0] + x) as usize];
                if covered > 0. { bent += h.abs().min(range) / range } else { empty += 1. }
            }
        }
        let part = empty / (extent[0] * extent[1]) as f32;
        bent * (1. - part) * (0.2 + part.min(0.2))
    };
    let step = extent.map(|e| (e / 3).max(1));
    let mut best = (f32::NEG_INFINITY, [0; 2]);
    let mut y = 0;
    while y + extent[1] <= size[1] {
        let mut x = 0;
        while x + extent[0] <= size[0] {
            let s = score(x, y);
            if s > best.0 {
                best = (s, [x, y]);
            }
            x += step[0];
        }
        y += step[1];
    }
    [best.1[0], best.1[1], extent[0], extent[1]]
}
