//! `pdss render`: a picture of a scene.

use super::args::{self, View};
use super::failure::Failure;
use clap::Args;
use pdss::frame::{Output, Renderer};
use pdss::report::picture::{self, Format};
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
        match format {
            Format::Png => picture::write_png(&self.output, stage.size(), &renderer.ldr()?)?,
            Format::Exr => picture::write_exr(&self.output, stage.size(), &renderer.linear()?)?,
        }
        drop(renderer);
        args::close(gpu)
    }
}
