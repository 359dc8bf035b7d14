//! `pdss compare`: error against run time, all methods on all scenes.

use super::args::{self, Aim, DEFAULT_SCENE, Device};
use super::failure::Failure;
use super::print;
use super::progress::Progress;
use clap::{Args, ValueEnum};
use pdss::compare::scenes::{self, Lit, Spec};
use pdss::compare::store::{Folder, Results};
use pdss::compare::sweep::Sweep;
use pdss::compare::{self, CompareError, Options, table, timing};
use pdss::scene::Light;
use pdss::settings::{Method, Quality, Size, parse_size};
use pdss::skin::profile::Profile;
use pdss::truth::Effort;
use std::path::PathBuf;

/// Options of `pdss compare`.
#[derive(Debug, Args)]
pub struct Compare {
    /// Scenes: files and shapes, names of the standard set (sphere, torus, bust, bumpy-torus, thin-sheet, many-lights,
    /// mostly-empty), or standard for all of it. Default: standard.
    #[arg(value_name = "SCENE")]
    scenes: Vec<String>,
    /// Directory of the results. A run that was interrupted goes on where it stopped.
    #[arg(long, short, value_name = "DIR")]
    output: PathBuf,
    #[command(flatten)]
    question: Question,
    /// Change one thing about each scene and hold all else. Default: the bust, at medium quality.
    #[arg(long, value_enum, value_name = "AXIS")]
    sweep: Option<Sweep>,
    /// Only every N-th scene from the I-th, from 0: a part that --merge puts together with the others.
    #[arg(long, value_name = "I/N", value_parser = parse_shard)]
    shard: Option<(usize, usize)>,
    /// Put the results of these directories together instead of measuring. One device, one setting.
    #[arg(long, value_name = "DIR", num_args = 1.., conflicts_with_all = ["scenes", "shard", "sweep"])]
    merge: Vec<PathBuf>,
}

/// What is measured, and how hard.
#[derive(Debug, Args)]
pub struct Question {
    /// Methods; lambert, the floor, is always among them. Default: all.
    #[arg(long, value_enum, value_delimiter = ',', value_name = "METHOD,...")]
    methods: Vec<Method>,
    /// Qualities. Default: all.
    #[arg(long, value_enum, value_delimiter = ',', value_name = "QUALITY,...")]
    qualities: Vec<Quality>,
    /// Size of the picture that is timed. Default: 1650x1080; of calibrate 660x432, and half of it.
    #[arg(long, value_parser = parse_size, value_name = "WxH")]
    size: Option<Size>,
    /// Size of the picture whose error is measured. Default: the same; of calibrate half of it.
    #[arg(long, value_parser = parse_size, value_name = "WxH")]
    truth_size: Option<Size>,
    /// Turns of each method and quality. Default: 5; of calibrate 3.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    rounds: Option<u32>,
    /// Frames measured a turn. Default: 3.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    frames: Option<u32>,
    /// Frames before the first sample. Default: 3 on a processor, elsewhere until the median has settled.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(..=100_000))]
    warmup: Option<u32>,
    /// Surface samples of truth. Default: 2000000; of calibrate 200000.
    #[arg(long, value_name = "N", value_parser = super::truth::parse_count)]
    samples: Option<usize>,
    /// Error of a pixel above which truth casts more rays.
    #[arg(long, value_name = "E", default_value_t = Effort::default().max_error, value_parser = super::truth::parse_error)]
    truth_error: f64,
    /// Diffusion profile: a built-in name or a .toml file.
    #[arg(long, value_name = "NAME|FILE", default_value = "skin")]
    profile: String,
    /// The one material that has the profile. Default: every opaque dielectric.
    #[arg(long, value_name = "NAME")]
    profile_material: Option<String>,
    /// Millimetres in one unit of a file. Default: 1000.
    #[arg(long, value_name = "X", allow_hyphen_values = true, value_parser = args::parse_positive)]
    mm_per_unit: Option<f64>,
    /// Directional light instead of each scene's own; may be repeated.
    #[arg(long = "light", value_name = "YAW,PITCH[,INTENSITY]", allow_hyphen_values = true, value_parser = args::parse_light)]
    lights: Vec<Aim>,
    /// Where truths are kept. Default: truth in the results' directory.
    #[arg(long, value_name = "DIR")]
    cache: Option<PathBuf>,
    #[command(flatten)]
    pub device: Device,
}

impl Compare {
    /// Measures or merges, and writes the results.
    pub fn run(&self) -> Result<(), Failure> {
        if !self.merge.is_empty() {
            return self.merged();
        }
        let options = self.options()?;
        let folder = Folder::open(&self.output)?;
        let gpu = self.question.device.open()?;
        let progress = Progress::new();
        let results = compare::run(&gpu, &options, &|line| progress.show(line));
        drop(progress);
        let results = results?;
        folder.finish(&results)?;
        print(&table::of(&results))?;
        args::close(gpu)
    }

    fn options(&self) -> Result<Options, Failure> {
        let Some(sweep) = self.sweep else {
            return self.question.options(specs(&self.scenes, &self.question)?, &DEFAULTS, &self.output, self.shard);
        };
        let names = if self.scenes.is_empty() { &["bust".to_owned()][..] } else { &self.scenes };
        let swept = specs(names, &self.question)?.iter().flat_map(|s| sweep.specs(s)).collect();
        let mut options = self.question.options(swept, &DEFAULTS, &self.output, self.shard)?;
        if self.question.qualities.is_empty() {
            options.qualities = vec![Quality::Medium];
        }
        Ok(options)
    }

    fn merged(&self) -> Result<(), Failure> {
        let read = |directory: &PathBuf| Ok((directory.clone(), Results::read(directory)?));
        let parts = self.merge.iter().map(read).collect::<Result<Vec<_>, CompareError>>()?;
        let results = Results::merge(parts)?;
        let folder = Folder::open(&self.output)?;
        for directory in &self.merge {
            folder.adopt(directory)?;
        }
        folder.finish(&results)?;
        print(&table::of(&results))
    }
}

/// The scenes that names stand for; none: the standard set.
pub fn specs(names: &[String], question: &Question) -> Result<Vec<Spec>, Failure> {
    let standard = scenes::standard(DEFAULT_SCENE);
    let mut specs: Vec<Spec> = Vec::new();
    let asked: &[String] = if names.is_empty() { &["standard".to_owned()] } else { names };
    for name in asked {
        match standard.iter().find(|s| s.name == *name) {
            Some(spec) => specs.push(spec.clone()),
            None if name == "standard" => specs.extend(standard.iter().cloned()),
            None => specs.push(Spec::given(name)),
        }
    }
    for spec in specs.iter_mut().filter(|_| !question.lights.is_empty()) {
        spec.lit = Lit::These(question.lights.iter().map(Aim::light).collect::<Vec<Light>>());
    }
    for (i, spec) in specs.iter().enumerate() {
        if specs[..i].iter().any(|s| s.name == spec.name) {
            let text = format!("two scenes are called {}: results are told apart by name", spec.name);
            return Err(Failure::Input(text));
        }
    }
    Ok(specs)
}

/// What a command takes where nothing is said.
pub struct Defaults {
    /// Of the picture that is timed.
    pub size: Size,
    /// Turns.
    pub rounds: u32,
    /// Surface samples of truth.
    pub samples: usize,
}

const DEFAULTS: Defaults = Defaults { size: Size { width: 1650, height: 1080 }, rounds: 5, samples: 2_000_000 };
/// Frames a turn.
const FRAMES: u32 = 3;

impl Question {
    /// The library's options.
    pub fn options(
        &self,
        specs: Vec<Spec>,
        defaults: &Defaults,
        directory: &std::path::Path,
        shard: Option<(usize, usize)>,
    ) -> Result<Options, Failure> {
        if self.profile == "none" {
            return Err(Failure::Input("--profile none: nothing scatters, and all methods are lambert".to_owned()));
        }
        Ok(Options {
            specs,
            methods: if self.methods.is_empty() { Method::value_variants().to_vec() } else { self.methods.clone() },
            qualities: if self.qualities.is_empty() {
                Quality::value_variants().to_vec()
            } else {
                self.qualities.clone()
            },
            size: self.size.unwrap_or(defaults.size),
            error_size: self.truth_size,
            effort: Effort {
                samples: self.samples.unwrap_or(defaults.samples),
                max_error: self.truth_error,
                ..Effort::default()
            },
            plan: timing::Plan {
                rounds: self.rounds.unwrap_or(defaults.rounds) as usize,
                frames: self.frames.unwrap_or(FRAMES) as usize,
                warmup: self.warmup.map(|n| n as usize),
            },
            profile: Profile::resolve(&self.profile)?,
            material: self.profile_material.clone(),
            mm_per_unit: self.mm_per_unit,
            cache: self.cache.clone().unwrap_or_else(|| directory.join("truth")),
            directory: directory.to_owned(),
            shard,
            validation: self.device.validates(),
        })
    }
}

fn parse_shard(text: &str) -> Result<(usize, usize), String> {
    let parts = text.split_once('/').and_then(|(i, n)| Some((i.trim().parse().ok()?, n.trim().parse().ok()?)));
    match parts {
        Some((i, n)) if i < n => Ok((i, n)),
        _ => Err("that is not I/N with I below N; 0/2 and 1/2 would be the two halves".to_owned()),
    }
}
