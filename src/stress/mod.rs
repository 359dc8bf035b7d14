//! Numerical stability: every stiff or extreme case as a row with a figure, a bound and a verdict.
//!
//! [`rows::ROWS`] is the table of contents: a row names the case, what must hold, the bound of each quantity, and the
//! function that measures it. Each measurement comes with a second figure, that of an input which is wrong on purpose, put
//! through the very same comparison: a row whose wrong input stays within the bound checks nothing, and fails.
//!
//! | file | what it measures |
//! |---|---|
//! | [`studio`] | frames: a scene, a camera, lights, a profile, settings; the linear picture |
//! | [`surface`] | H and K of shapes whose curvature is known, at every scale, distance and field of view |
//! | [`integral`] | pre-integration: stiffness, bounds, energy, the table as the device samples it |
//! | [`size`] | picture sizes, crops, scale, scattering radii |
//! | [`material`] | albedo, metal, masks, normal maps, meshes whose normals are not their geometry's |
//! | [`mod@file`] | hostile glTF: normals, triangles, transforms, units, counts |
//! | [`lighting`] | lights where they should not be, too strong, too many, none |
//! | [`edge`] | what must not bleed into what |
//! | [`gathered`] | light gathered from the light's view on the device against the same in f64 |
//! | [`twins`] | levels and light on the device against the same in f64 |

pub mod edge;
pub mod file;
pub mod gathered;
pub mod integral;
pub mod lighting;
pub mod material;
pub mod probe;
pub mod rows;
pub mod size;
pub mod studio;
pub mod surface;
pub mod twins;

use crate::frame::FrameError;
use crate::gpu::{Gpu, GpuError};
use crate::scene::SceneError;
use crate::settings::Method;
use clap::ValueEnum;
use std::sync::Arc;
use std::time::Instant;

/// Why a row has no figure.
#[derive(Debug, thiserror::Error)]
pub enum StressError {
    /// A frame.
    #[error(transparent)]
    Frame(#[from] FrameError),
    /// The device.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// A scene.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A file that a row writes for the loader.
    #[error("writing a scene: {0}")]
    Write(#[from] std::io::Error),
    /// A diffusion profile.
    #[error(transparent)]
    Profile(#[from] crate::skin::profile::ProfileError),
    /// A row that contradicts itself.
    #[error("{0}")]
    Row(String),
}

/// What rows run on.
pub struct Bench {
    /// The device.
    pub gpu: Arc<Gpu>,
}

/// One figure, and what the same comparison says of a wrong input.
#[derive(Clone, Debug)]
pub struct Measure {
    /// Which of the row's bounds it is held to.
    pub quantity: &'static str,
    /// At most the bound; NaN never is.
    pub figure: f64,
    /// Beyond the bound.
    pub wrong: f64,
    /// More for people: further figures, the unit.
    pub text: String,
}

impl Measure {
    /// A figure in the row's only quantity or one of several.
    pub fn new(quantity: &'static str, figure: f64, wrong: f64, text: impl Into<String>) -> Measure {
        Measure { quantity, figure, wrong, text: text.into() }
    }
}

/// What a row returns.
pub type Measured = Result<Vec<Measure>, StressError>;

/// How a row is measured.
#[derive(Clone, Copy)]
pub enum Engine {
    /// Once.
    Once(fn(&Bench) -> Measured),
    /// By each method, `lambert` included.
    Each(fn(&Bench, Method) -> Measured),
    /// By each method that scatters.
    Scattering(fn(&Bench, Method) -> Measured),
}

/// One row of the table.
pub struct Row {
    /// The case.
    pub name: &'static str,
    /// What must hold.
    pub holds: &'static str,
    /// Quantities and their bounds.
    pub bounds: &'static [(&'static str, f64)],
    /// Takes a second or so; these run among the tests.
    pub quick: bool,
    /// How it is measured.
    pub engine: Engine,
    /// Known not to hold: method (empty: all) and quantity (empty: all), and why. It is a failure all the same.
    pub expected: &'static [(&'static str, &'static str, &'static str)],
}

/// What a line says.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// Within the bound, and the wrong input is not.
    Pass,
    /// Beyond the bound, or no figure.
    Fail,
    /// The wrong input passes, too: nothing was checked.
    Blind,
    /// The method refuses the case in words.
    Refused,
}

/// One line of the result.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Line {
    /// The case.
    pub row: &'static str,
    /// By which method, where it depends on one.
    pub method: Option<String>,
    /// What was measured.
    pub quantity: &'static str,
    /// What must hold.
    pub holds: &'static str,
    /// The figure; none where there is no number.
    pub figure: Option<f64>,
    /// Its bound.
    pub bound: f64,
    /// The figure of an input that is wrong on purpose.
    pub wrong: Option<f64>,
    /// Verdict.
    pub verdict: Verdict,
    /// More figures, or the error.
    pub text: String,
    /// Why it is known not to hold.
    pub expected: Option<&'static str>,
    /// Of the row, by this method.
    pub seconds: f64,
}

/// Within a bound; NaN is not.
pub fn within(figure: f64, bound: f64) -> bool {
    figure <= bound
}

/// The verdict on a measurement.
pub fn verdict(m: &Measure, bound: f64) -> Verdict {
    match (within(m.figure, bound), within(m.wrong, bound)) {
        (false, _) => Verdict::Fail,
        (true, true) => Verdict::Blind,
        (true, false) => Verdict::Pass,
    }
}

/// As the command line spells it.
pub fn method_name(method: Method) -> String {
    method.to_possible_value().map_or_else(String::new, |v| v.get_name().to_owned())
}

/// Runs one row; each line is handed over as soon as it is known. Validation messages that come meanwhile are failures of it.
pub fn run(bench: &Bench, row: &Row) -> Vec<Line> {
    let methods = Method::value_variants().iter().copied();
    match row.engine {
        Engine::Once(f) => one(bench, row, None, || f(bench)),
        Engine::Each(f) => each(bench, row, methods, f),
        Engine::Scattering(f) => each(bench, row, methods.filter(|m| *m != Method::Lambert), f),
    }
}

fn each(
    bench: &Bench,
    row: &Row,
    methods: impl Iterator<Item = Method>,
    f: fn(&Bench, Method) -> Measured,
) -> Vec<Line> {
    let mut lines: Vec<Line> = methods.flat_map(|m| one(bench, row, Some(m), || f(bench, m))).collect();
    if lines.iter().all(|l| l.verdict == Verdict::Refused) {
        lines.iter_mut().for_each(|l| l.verdict = Verdict::Fail);
    }
    lines
}

/// A case that a method does not take, said in one line: no fault of the case's.
fn refusal(error: &StressError) -> bool {
    matches!(error, StressError::Frame(e) if !matches!(e, FrameError::Gpu(_) | FrameError::Plan(_)))
}

fn one(bench: &Bench, row: &Row, method: Option<Method>, f: impl FnOnce() -> Measured) -> Vec<Line> {
    let (start, before) = (Instant::now(), bench.gpu.messages().len());
    let measured = f();
    let messages = bench.gpu.messages().split_off(before.min(bench.gpu.messages().len()));
    let seconds = start.elapsed().as_secs_f64();
    let name = method.map(method_name);
    let expected = |quantity: &str| {
        let fits = |key: &str, value: &str| key.is_empty() || key == value;
        let own = row.expected.iter().find(|(m, q, _)| fits(m, name.as_deref().unwrap_or("")) && fits(q, quantity));
        own.map(|(_, _, why)| *why)
    };
    let line = |quantity: &'static str, bound: f64, m: Option<&Measure>, verdict: Verdict, text: String| Line {
        row: row.name,
        method: name.clone(),
        quantity,
        holds: row.holds,
        figure: m.map(|m| m.figure).filter(|x| x.is_finite()),
        bound,
        wrong: m.map(|m| m.wrong).filter(|x| x.is_finite()),
        verdict,
        text,
        expected: expected(quantity),
        seconds,
    };
    let mut lines: Vec<Line> = row
        .bounds
        .iter()
        .map(|(quantity, bound)| match &measured {
            Err(e) if refusal(e) => line(quantity, *bound, None, Verdict::Refused, e.to_string()),
            Err(e) => line(quantity, *bound, None, Verdict::Fail, e.to_string()),
            Ok(list) => match list.iter().find(|m| m.quantity == *quantity) {
                Some(m) => line(quantity, *bound, Some(m), verdict(m, *bound), m.text.clone()),
                None => line(quantity, *bound, None, Verdict::Fail, "not measured".to_owned()),
            },
        })
        .collect();
    if let Some(message) = messages.first() {
        let text = format!("{} validation messages, the first: {message}", messages.len());
        lines.push(line("validation", 0., None, Verdict::Fail, text));
    }
    lines
}

/// Quantiles of a list of errors; NaN sorts last and shows.
#[derive(Clone, Copy, Debug, Default)]
pub struct Spread {
    /// Half are at most this.
    pub median: f64,
    /// 99 of 100.
    pub p99: f64,
    /// All.
    pub max: f64,
    /// How many.
    pub n: usize,
}

impl Spread {
    /// Sorts and reads off; an empty list is NaN: nothing was compared.
    pub fn of(mut v: Vec<f64>) -> Spread {
        v.sort_by(f64::total_cmp);
        let at =
            |q: f64| v.get(((v.len() as f64 * q) as usize).min(v.len().saturating_sub(1))).copied().unwrap_or(f64::NAN);
        Spread { median: at(0.5), p99: at(0.99), max: at(1.), n: v.len() }
    }
}

impl std::fmt::Display for Spread {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "median {:.1e}, p99 {:.1e}, max {:.1e} of {}", self.median, self.p99, self.max, self.n)
    }
}
