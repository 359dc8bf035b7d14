//! `pdss render`: a picture of a scene.

use super::args::{self, View};
use super::failure::Failure;
use clap::Args;
use pdss::frame::{Output, Renderer};
use pdss::report::picture::{self, Format};
use pdss::report::preview;
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
}

impl Render {
    /// Draws, and writes the picture.
    pub fn run(&self) -> Result<(), Failure> {
        let format = picture::format_of(&self.output)?;
        let stage = self.view.load()?;
        let gpu = self.view.open()?;
        let output = match format {
            Format::Png => Output::Ldr,
            Format::Exr => Output::Linear,
        };
        let mut renderer = Renderer::new(&gpu, stage.inputs(None, output))?;
        for _ in 0..self.frames {
            renderer.run()?;
        }
        let size = stage.size();
        match (format, renderer.output()) {
            (Format::Png, Output::Ldr) => picture::write_png(&self.output, size, &renderer.ldr()?)?,
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
