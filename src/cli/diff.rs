//! `pdss diff`: how wrong one picture is against another.

use super::failure::Failure;
use super::{print, print_json};
use clap::{Args, ValueEnum};
use pdss::report::picture;
use pdss::truth::metrics::{self, Comparison, Metrics};
use std::fmt::Write;
use std::path::PathBuf;

/// Options of `pdss diff`.
#[derive(Debug, Args)]
pub struct Diff {
    /// The picture, .exr.
    picture: PathBuf,
    /// The reference, .exr.
    reference: PathBuf,
    /// Bands to report, as `pdss truth` writes them. Default: the reference's .bands.exr where there is one.
    #[arg(long, value_name = "FILE")]
    mask: Option<PathBuf>,
    /// A map of the errors, .png.
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Error that the map shows as white. Default: the 99th percentile.
    #[arg(long, value_name = "E")]
    full: Option<f64>,
    /// A table for people, JSON for programs.
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// How errors are printed.
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
enum Format {
    /// For people.
    #[default]
    Table,
    /// Everything.
    Json,
}

impl Diff {
    /// Compares, prints, and draws the map.
    pub fn run(&self) -> Result<(), Failure> {
        if let Some(map) = &self.output
            && picture::format_of(map)? != picture::Format::Png
        {
            return Err(Failure::Input(format!("{}: the map is written as .png", map.display())));
        }
        let (size, a) = picture::read_exr(&self.picture)?;
        let (other, b) = picture::read_exr(&self.reference)?;
        let beside = self.reference.with_extension("bands.exr");
        let mask = self.mask.clone().or_else(|| beside.is_file().then_some(beside));
        let mask = mask.map(|m| picture::read_exr(&m)).transpose()?;
        for (what, s) in [("the reference", other), ("the mask", mask.as_ref().map_or(size, |m| m.0))] {
            if s != size {
                let name = self.picture.display();
                return Err(Failure::Input(format!("{name} is {}x{}, {what} {}x{}", size[0], size[1], s[0], s[1])));
            }
        }
        let bands = mask.map(|(_, m)| metrics::bands_of(&m));
        let comparison = metrics::compare(size, &a, &b, bands.as_deref());
        if let Some(map) = &self.output {
            let full = self.full.unwrap_or(comparison.whole.p99).max(1e-6);
            picture::write_png(map, size, &metrics::heat(&a, &b, full))?;
        }
        match self.format {
            Format::Table => print(&table(&comparison)),
            Format::Json => print_json(&comparison),
        }
    }
}

fn table(c: &Comparison) -> String {
    let mut text = format!(
        "{:12} {:>8} {:>9} {:>9} {:>9} {:>9} {:>9} {:>8} {:>9} {:>9} {:>10}\n",
        "", "pixels", "rmse", "r", "g", "b", "relmse", "psnr", "p99", "max", "bias"
    );
    let mut row = |name: &str, m: &Metrics| {
        let [r, g, b] = m.rmse_rgb;
        let psnr = m.psnr_db.map_or("-".to_owned(), |p| format!("{p:.2}"));
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{name:12} {:8} {:9.5} {r:9.5} {g:9.5} {b:9.5} {:9.2e} {psnr:>8} {:9.5} {:9.5} {:10.6}",
            m.pixels, m.rmse, m.rel_mse, m.p99, m.max, m.bias
        );
    };
    row("all", &c.whole);
    c.bands.iter().for_each(|(name, m)| row(name, m));
    if c.uncommon + c.not_finite > 0 {
        let _ = writeln!(text, "{} pixels covered by one only, {} not finite: left out", c.uncommon, c.not_finite);
    }
    text
}
