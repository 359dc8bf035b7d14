//! `pdss diff`: how wrong one picture is against another.

use super::failure::Failure;
use super::{print, print_json, say};
use clap::{Args, ValueEnum};
use pdss::report::picture;
use pdss::truth::flip::Exposures;
use pdss::truth::metrics::{self, Comparison, Light, Metrics};
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Options of `pdss diff`.
#[derive(Debug, Args)]
pub struct Diff {
    /// The picture: .exr, linear as it is, or .png, whose sRGB codes are decoded to linear light.
    picture: PathBuf,
    /// The reference, likewise.
    reference: PathBuf,
    /// Compare only where this picture's red is above one half and its alpha above 0; .exr or .png.
    #[arg(long, value_name = "FILE")]
    mask: Option<PathBuf>,
    /// Bands to report, as `pdss truth` writes them. Default: the reference's .bands.exr where there is one.
    #[arg(long, value_name = "FILE")]
    bands: Option<PathBuf>,
    /// Also HDR-FLIP: the worst FLIP over exposures, from the reference's brightest pixel to its median.
    #[arg(long)]
    hdr: bool,
    /// A map of the errors, .png.
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Error that the map shows as white. Default: the 99th percentile.
    #[arg(long, value_name = "E", value_parser = parse_full)]
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

/// A picture as it is compared.
struct Side {
    name: String,
    size: [u32; 2],
    pixels: Vec<[f32; 4]>,
    light: Light,
}

/// What programs read.
#[derive(serde::Serialize)]
struct Record<'a> {
    #[serde(flatten)]
    comparison: &'a Comparison,
    /// What each file's numbers were taken for.
    read_as: [&'static str; 2],
    #[serde(skip_serializing_if = "Option::is_none")]
    hdr_flip: Option<Hdr>,
}

#[derive(serde::Serialize)]
struct Hdr {
    mean: f64,
    exposures: Exposures,
}

impl Diff {
    /// Compares, prints, and draws the map.
    pub fn run(&self) -> Result<(), Failure> {
        if let Some(map) = &self.output
            && picture::format_of(map)? != picture::Format::Png
        {
            return Err(Failure::Input(format!("{}: the map is written as .png", map.display())));
        }
        let (mut a, b) = (Side::open(&self.picture)?, Side::open(&self.reference)?);
        a.fits("the reference", b.size)?;
        if let Some(mask) = &self.mask {
            let mask = Side::open(mask)?;
            a.fits("the mask", mask.size)?;
            let inside = |m: &[f32; 4]| m[0] > 0.5 && m[3] > 0.;
            a.pixels.iter_mut().zip(&mask.pixels).filter(|(_, m)| !inside(m)).for_each(|(p, _)| p[3] = 0.);
        }
        let beside = self.reference.with_extension("bands.exr");
        let bands = match self.bands.clone().or_else(|| beside.is_file().then_some(beside)) {
            None => None,
            Some(file) => {
                let (size, pixels) = picture::read_exr(&file)?;
                a.fits("the picture of the bands", size)?;
                Some(metrics::bands_of(&pixels))
            }
        };
        let pictures = [&a, &b].map(|s| (&s.pixels[..], s.light));
        let comparison = metrics::compare_light(a.size, pictures, bands.as_deref());
        let hdr_flip = if self.hdr { Some(hdr(&a, &b)?) } else { None };
        if let Some(map) = &self.output {
            let full = self.full.unwrap_or(comparison.whole.p99.max(1e-6));
            picture::write_png(map, a.size, &metrics::heat(&a.pixels, &b.pixels, full))?;
        }
        if a.light != b.light {
            say(&format!("warning: {} is {}, {} is {}", a.name, a.read_as(), b.name, b.read_as()));
        }
        let record = Record { comparison: &comparison, read_as: [a.read_as(), b.read_as()], hdr_flip };
        match self.format {
            Format::Table => print(&table(&record)),
            Format::Json => print_json(&record),
        }
    }
}

impl Side {
    fn open(file: &Path) -> Result<Self, Failure> {
        let picture::Picture { format, size, pixels } = picture::read(file)?;
        let light = match format {
            picture::Format::Exr => Light::Scene,
            picture::Format::Png => Light::Display,
        };
        Ok(Self { name: file.display().to_string(), size, pixels, light })
    }

    fn fits(&self, what: &str, size: [u32; 2]) -> Result<(), Failure> {
        if size == self.size {
            return Ok(());
        }
        let ([w, h], [v, g]) = (self.size, size);
        Err(Failure::Input(format!("{} is {w}x{h}, {what} {v}x{g}; they must have one size", self.name)))
    }

    fn read_as(&self) -> &'static str {
        self.light.name()
    }
}

fn hdr(a: &Side, b: &Side) -> Result<Hdr, Failure> {
    if [a, b].iter().any(|s| s.light == Light::Display) {
        return Err(Failure::Input("--hdr: HDR-FLIP compares scene light; give two .exr".to_owned()));
    }
    let Some((mean, exposures)) = metrics::hdr_flip(a.size, &a.pixels, &b.pixels) else {
        return Err(Failure::Input(format!("--hdr: {} is black where it is compared; no exposure fits", b.name)));
    };
    Ok(Hdr { mean, exposures })
}

fn table(record: &Record<'_>) -> String {
    let c = record.comparison;
    let mut text = format!(
        "{:12} {:>8} {:>9} {:>9} {:>9} {:>9} {:>9} {:>8} {:>9} {:>9} {:>10} {:>8}\n",
        "", "pixels", "rmse", "r", "g", "b", "relmse", "psnr", "p99", "max", "bias", "flip"
    );
    let mut row = |name: &str, m: &Metrics| {
        let [r, g, b] = m.rmse_rgb;
        let psnr = m.psnr_db.map_or("-".to_owned(), |p| format!("{p:.2}"));
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{name:12} {:8} {:9.5} {r:9.5} {g:9.5} {b:9.5} {:9.2e} {psnr:>8} {:9.5} {:9.5} {:10.6} {:8.5}",
            m.pixels, m.rmse, m.rel_mse, m.p99, m.max, m.bias, m.flip
        );
    };
    row("all", &c.whole);
    c.bands.iter().for_each(|(name, m)| row(name, m));
    if let Some(Hdr { mean, exposures: e }) = &record.hdr_flip {
        let _ = writeln!(text, "HDR-FLIP {mean:.5}, {} exposures from 2^{:.2} to 2^{:.2}", e.count, e.first, e.last);
    }
    if record.read_as.contains(&Light::Display.name()) {
        let _ = writeln!(text, "read as {} and {}", record.read_as[0], record.read_as[1]);
    }
    if c.uncommon + c.not_finite > 0 {
        let _ = writeln!(text, "{} pixels covered by one only, {} not finite: left out", c.uncommon, c.not_finite);
    }
    text
}

fn parse_full(text: &str) -> Result<f64, String> {
    let right = |x: &f64| *x > 0. && x.is_finite();
    text.parse().ok().filter(right).ok_or_else(|| "that is not an error above 0; 0.1 would be".to_owned())
}
