//! `pdss render`: a picture of a scene.

use super::args::{self, View};
use super::failure::Failure;
use clap::Args;
use pdss::frame::{Output, Renderer};
use pdss::report::picture::{self, Format};
use pdss::report::{preview, supersample};
use pdss::settings::{Size, View as Show};
use std::path::PathBuf;

/// Options of `pdss render`.
#[derive(Debug, Args)]
pub struct Render {
    #[command(flatten)]
    view: View,
    /// The picture: .png, tone-mapped, or .exr, linear 32-bit float whose A is coverage.
    #[arg(long, short, value_name = "FILE")]
    output: PathBuf,
    /// Frames drawn before the picture is taken.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    frames: u32,
    /// Samples of a pixel along each axis, averaged in linear light: for lit PNGs. EXR and other views have one.
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=4))]
    supersample: u32,
}

impl Render {
    /// Draws, and writes the picture.
    pub fn run(&self) -> Result<(), Failure> {
        let format = picture::format_of(&self.output)?;
        let mut stage = self.view.load()?;
        let size = stage.size();
        let gpu = self.view.open()?;
        let output = match format {
            Format::Png => Output::Ldr,
            Format::Exr => Output::Linear,
        };
        let lit = matches!(stage.settings.view, Show::Final | Show::Scatter | Show::Irradiance | Show::Ao);
        let most = gpu.limits().max_image_dimension2_d / size[0].max(size[1]);
        let samples = if lit && format == Format::Png { self.supersample.min(most).max(1) } else { 1 };
        stage.settings.size = Size { width: size[0] * samples, height: size[1] * samples };
        let mut renderer = Renderer::new(&gpu, stage.inputs(None, output))?;
        for _ in 0..self.frames {
            renderer.run()?;
        }
        match (format, renderer.output()) {
            (Format::Png, Output::Ldr) => {
                picture::write_png(&self.output, size, &supersample::average(&renderer.ldr()?, size, samples))?;
            }
            (Format::Exr, _) => picture::write_exr(&self.output, size, &renderer.linear()?)?,
            // A view of numbers is linear whatever the picture is; a PNG shows them to people.
            (Format::Png, Output::Linear) => {
                let (texels, meaning) = preview::encode(stage.settings.view, &renderer.linear()?);
                self.view.tell(&format!("{}: {meaning}", self.output.display()));
                picture::write_png(&self.output, size, &texels)?;
            }
        }
        drop(renderer);
        args::close(gpu)
    }
}
