//! One method at one quality on one scene: what was asked, how long it took, how wrong it was.

use super::reference::Reference;
use super::scenes::Subject;
use crate::report::stats::Summary;
use crate::report::table::name_of;
use crate::settings::{Method, Quality};
use crate::truth::metrics::Comparison;
use serde::{Deserialize, Serialize};

/// What was asked for. Names rather than enums: a result outlives the program that wrote it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cell {
    /// Name of the scene.
    pub scene: String,
    /// What the scene is in the run for.
    pub why: String,
    /// What is swept; none where nothing is.
    pub sweep: Option<String>,
    /// Its value: pixels, covered share, lights or mm.
    pub sweep_value: Option<f64>,
    /// Name of the method.
    pub method: String,
    /// Name of the quality.
    pub quality: String,
    /// Scene, method and quality by number: how rows are sorted.
    pub order: [usize; 3],
    /// Width and height of the picture that is timed.
    pub size: [u32; 2],
    /// Width and height of the picture whose error is measured.
    pub error_size: [u32; 2],
    /// Triangles.
    pub triangles: usize,
    /// Lights.
    pub lights: usize,
    /// Key of everything above and of what it was measured by.
    pub key: String,
    /// Why the method does not draw this scene; nothing below is there then.
    pub refused: Option<String>,
    /// How wrong.
    pub error: Option<Errors>,
    /// How long.
    pub time: Option<Times>,
    /// Bytes of the frame's images: taken, and if no two took turns.
    pub memory: Option<[u64; 2]>,
    /// Passes of the frame.
    pub passes: Option<usize>,
}

/// Errors against truth, of diffuse exitance.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Errors {
    /// Share of the picture that both cover.
    pub covered: f64,
    /// Root mean square over pixels and channels.
    pub rmse: f64,
    /// Per channel.
    pub rmse_rgb: [f64; 3],
    /// Mean of the squared relative error.
    pub rel_mse: f64,
    /// dB.
    pub psnr_db: Option<f64>,
    /// 99th percentile.
    pub p99: f64,
    /// Greatest.
    pub max: f64,
    /// Mean, signed: positive is too bright.
    pub bias: f64,
    /// Mean FLIP of the tone-mapped pictures, 0..1.
    pub flip: f64,
    /// Name, pixels and rms of each band.
    pub bands: Vec<(String, usize, f64)>,
    /// Pixels left out: covered by one only, or not finite.
    pub left_out: usize,
    /// Truth's own error: below it, an error is no result.
    pub truth_rms: f64,
    /// Its key: what its pictures are called.
    pub truth_key: String,
}

impl Errors {
    /// Takes over a comparison with a truth.
    pub fn of(c: &Comparison, truth: &Reference) -> Errors {
        let m = &c.whole;
        Errors {
            covered: m.pixels as f64 / (f64::from(c.size[0]) * f64::from(c.size[1])),
            rmse: m.rmse,
            rmse_rgb: m.rmse_rgb,
            rel_mse: m.rel_mse,
            psnr_db: m.psnr_db,
            p99: m.p99,
            max: m.max,
            bias: m.bias,
            flip: m.flip,
            bands: c.bands.iter().map(|(name, m)| ((*name).to_owned(), m.pixels, m.rmse)).collect(),
            left_out: c.uncommon + c.not_finite,
            truth_rms: truth.rms,
            truth_key: truth.key.clone(),
        }
    }

    /// rms in a band; none where it has no pixels.
    pub fn band(&self, name: &str) -> Option<f64> {
        self.bands.iter().find(|(n, pixels, _)| n == name && *pixels > 0).map(|(_, _, rmse)| *rmse)
    }
}

/// Times in interleaved rounds with the other methods of the scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Times {
    /// Submit to fence on the host's clock, all rounds together.
    pub wall_ms: Summary,
    /// First stamp to last; none on devices whose stamps are not times.
    pub gpu_ms: Option<Summary>,
    /// What the frame takes beyond `lambert`'s of the same quality in the same round, on the clock that counts: over rounds.
    pub scatter_ms: Summary,
    /// Host: deciding, pipelines, upload and recording, once.
    pub prepare_ms: [f64; 4],
    /// Frames before the first sample.
    pub warmup: usize,
    /// Cells that took turns.
    pub interleaved: usize,
    /// Every sample of the wall clock, round by round.
    pub wall_samples_ms: Vec<Vec<f64>>,
    /// Every sample of the device's clock; empty where there is none.
    pub gpu_samples_ms: Vec<Vec<f64>>,
}

impl Times {
    /// The frame's time: on the device's clock where it has one.
    pub fn frame_ms(&self) -> Summary {
        self.gpu_ms.unwrap_or(self.wall_ms)
    }
}

impl Cell {
    /// What is asked of a scene, nothing measured yet.
    pub fn new(
        subject: &Subject,
        number: usize,
        method: (usize, Method),
        quality: (usize, Quality),
        error_size: [u32; 2],
    ) -> Cell {
        Cell {
            scene: subject.spec.name.clone(),
            why: subject.spec.why.to_owned(),
            sweep: subject.spec.sweep.map(|(axis, _)| axis.to_owned()),
            sweep_value: subject.spec.sweep.map(|(_, value)| value),
            method: name_of(method.1),
            quality: name_of(quality.1),
            order: [number, method.0, quality.0],
            size: [subject.size.width, subject.size.height],
            error_size,
            triangles: subject.scene.triangle_count(),
            lights: subject.lights.len(),
            key: String::new(),
            refused: None,
            error: None,
            time: None,
            memory: None,
            passes: None,
        }
    }

    /// The same method and quality on the same scene.
    pub fn is_asked_as(&self, other: &Cell) -> bool {
        let asked = |c: &Cell| (c.sweep_value.map(f64::to_bits), c.order[1], c.order[2]);
        (&self.scene, &self.sweep, asked(self)) == (&other.scene, &other.sweep, asked(other))
    }

    /// Frame time in ms and rms error, where both are known.
    pub fn point(&self) -> Option<(f64, f64)> {
        Some((self.time.as_ref()?.frame_ms().median, self.error.as_ref()?.rmse))
    }

    /// Time spent on scattering in ms and rms error.
    pub fn scatter_point(&self) -> Option<(f64, f64)> {
        Some((self.time.as_ref()?.scatter_ms.median, self.error.as_ref()?.rmse))
    }
}
