//! `--env`: the picture of a sky that lights the scene.

use super::args::parse_positive;
use super::failure::Failure;
use super::say;
use clap::Args;
use pdss::scene::Environment;
use std::path::PathBuf;

/// Light from all around.
#[derive(Clone, Debug, Args)]
pub struct Sky {
    /// Light from a picture of the sky, .hdr or .exr, by latitude and longitude: its middle is where yaw and pitch 0 are, in front of
    /// the scene, yaw 90 left of it. Takes the place of --ambient and of the default lights; lights of the file or of --light
    /// shine beside it.
    #[arg(long = "env", value_name = "FILE", conflicts_with = "ambient")]
    file: Option<PathBuf>,
    /// Degrees by which the sky is turned: what shone from yaw 0 shines from here.
    #[arg(long = "env-rotation", value_name = "DEG", default_value_t = 0., allow_hyphen_values = true,
        value_parser = parse_finite, requires = "file")]
    rotation: f64,
    /// Factor on the sky's light.
    #[arg(long = "env-intensity", value_name = "X", default_value_t = 1., value_parser = parse_positive, requires = "file")]
    intensity: f64,
    /// Draw the sky behind the scene, blurred from 0 (the default: not at all) to 1 (as a matt ball sees it).
    #[arg(long = "env-background", value_name = "BLUR", num_args = 0..=1, default_missing_value = "0",
        value_parser = parse_share, requires = "file")]
    background: Option<f64>,
}

impl Sky {
    /// Reads the file, if one is named, and says what was mended in it.
    pub fn load(&self) -> Result<Option<Environment>, Failure> {
        let Some(file) = &self.file else { return Ok(None) };
        let sky = Environment::load(file)?;
        for warning in &sky.warnings {
            say(&format!("warning: {}: {warning}", sky.name));
        }
        let background = self.background.map(|x| x as f32);
        Ok(Some(Environment { rotation_deg: self.rotation, intensity: self.intensity, background, ..sky }))
    }
}

fn parse_finite(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|x: &f64| x.is_finite()).ok_or_else(|| "that is not a number; 90 would be".to_owned())
}

fn parse_share(text: &str) -> Result<f64, String> {
    let right = |x: &f64| (0. ..=1.).contains(x);
    text.parse().ok().filter(right).ok_or_else(|| "that does not lie in 0..1; 0.3 would".to_owned())
}
