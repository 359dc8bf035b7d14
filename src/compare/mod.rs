//! Error against run time: every method at every quality on every scene, timed in turns and held against truth.
//!
//! A run is a list of [`cell::Cell`]s. Each is kept as soon as it is known, under a key of everything that decides it, so that
//! an interrupted run goes on where it stopped and a changed one starts anew. Nothing else is computed while a cell is timed.
//!
//! A directory of results holds:
//!
//! ```text
//! report.html            one page for people: plots, tables, pictures; needs nothing else
//! results.csv            a row a cell; columns.rs says what each column is
//! results.json           the same with every sample; what --merge reads
//! plot.svg .png          all scenes; plot-SCENE.svg .png each
//! cells/KEY.json         what is known of each cell
//! pictures/KEY.*.png     its map of errors, and a window where methods have trouble
//! truth/KEY.exr .json    converged answers with their bands and errors, unless --cache says where
//! ```

pub mod calibration;
pub mod cell;
pub mod check;
pub mod columns;
pub mod front;
pub mod html;
pub mod html_pictures;
pub mod key;
pub mod pick;
pub mod pictures;
pub mod plot;
pub mod reference;
pub mod scenes;
pub mod store;
pub mod sweep;
pub mod table;
pub mod timing;

use crate::frame::{FrameError, Output, Renderer};
use crate::gpu::{Gpu, GpuError};
use crate::report::picture::PictureError;
use crate::scene::SceneError;
use crate::settings::{Method, Quality, Settings, Size, View};
use crate::skin::profile::Profile;
use crate::truth::{Effort, TruthError, metrics};
use cell::{Cell, Errors};
use reference::Reference;
use scenes::{Spec, Subject};
use std::fmt::Display;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use store::{Context, Folder, Results};
use timing::Weight;

/// Why there is no comparison.
#[derive(Debug, thiserror::Error)]
pub enum CompareError {
    /// The device, or a frame.
    #[error(transparent)]
    Frame(#[from] FrameError),
    /// A scene.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// Truth.
    #[error(transparent)]
    Truth(#[from] TruthError),
    /// A picture.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// A file or directory that is not as it should be.
    #[error("{}: {what}", .file.display())]
    File {
        /// Which.
        file: PathBuf,
        /// What is wrong, and what would be right.
        what: String,
    },
    /// The question makes no sense.
    #[error("{0}")]
    Question(String),
}

impl CompareError {
    /// Something about a file.
    pub fn file(file: &Path, what: impl Display) -> CompareError {
        CompareError::File { file: file.to_owned(), what: what.to_string() }
    }
}

/// What is compared, and how hard.
#[derive(Clone, Debug)]
pub struct Options {
    /// Scenes.
    pub specs: Vec<Spec>,
    /// Methods; `lambert`, the floor, is always among them.
    pub methods: Vec<Method>,
    /// Qualities.
    pub qualities: Vec<Quality>,
    /// The picture that is timed.
    pub size: Size,
    /// The picture whose error is measured; none: the same.
    pub error_size: Option<Size>,
    /// Of truth.
    pub effort: Effort,
    /// Of timing.
    pub plan: timing::Plan,
    /// What scatters.
    pub profile: Profile,
    /// The one material that scatters; none: every opaque dielectric.
    pub material: Option<String>,
    /// Of files.
    pub mm_per_unit: Option<f64>,
    /// Where results go.
    pub directory: PathBuf,
    /// Where truths are kept.
    pub cache: PathBuf,
    /// This part of the scenes, from 0, of so many.
    pub shard: Option<(usize, usize)>,
    /// The device was opened with validation layers.
    pub validation: bool,
}

/// Compares, and keeps every cell in the directory as it is done. `progress` hears lines for people.
///
/// # Errors
/// Where a scene cannot be had, the device gives up, or files cannot be written. A method that refuses a scene is a result.
pub fn run(gpu: &Arc<Gpu>, options: &Options, progress: &(dyn Fn(&str) + Sync)) -> Result<Results, CompareError> {
    let mut methods = options.methods.clone();
    if !methods.contains(&Method::Lambert) {
        methods.push(Method::Lambert);
    }
    let context = Context::new(gpu.info(), options);
    let folder = Folder::open(&options.directory)?;
    let mut cells = Vec::new();
    let numbered: Vec<(usize, &Spec)> = options.specs.iter().enumerate().collect();
    let mine = share(&numbered, options.shard)?;
    for (done, (number, spec)) in mine.iter().enumerate() {
        let say = |text: &str| progress(&format!("{} of {}, {}: {text}", done + 1, mine.len(), spec.name));
        say("loading");
        let material = options.material.as_deref();
        let subject = Subject::build(spec, &options.profile, material, options.mm_per_unit, options.size)?;
        let mut run = Run { gpu, options, context: &context, folder: &folder, subject: &subject, say: &say };
        cells.extend(run.scene(*number, &methods)?);
    }
    Ok(Results::new(context, cells))
}

/// Every `n`-th scene from the `i`-th.
fn share<T: Copy>(all: &[T], shard: Option<(usize, usize)>) -> Result<Vec<T>, CompareError> {
    let (i, n) = shard.unwrap_or((0, 1));
    let mine: Vec<T> = all.iter().copied().skip(i).step_by(n.max(1)).collect();
    if mine.is_empty() {
        let text = format!(
            "--shard {i}/{n}: that part has no scene; of {} scenes the first part is 0, the last {}",
            all.len(),
            all.len().saturating_sub(1)
        );
        return Err(CompareError::Question(text));
    }
    Ok(mine)
}

/// One scene's part of a run.
struct Run<'a> {
    gpu: &'a Arc<Gpu>,
    options: &'a Options,
    context: &'a Context,
    folder: &'a Folder,
    subject: &'a Subject,
    say: &'a (dyn Fn(&str) + Sync),
}

impl Run<'_> {
    fn scene(&mut self, number: usize, methods: &[Method]) -> Result<Vec<Cell>, CompareError> {
        let error_size = self.error_size();
        let content = self.context.key_of(self.subject);
        let mut cells = Vec::new();
        for (m, method) in <Method as clap::ValueEnum>::value_variants().iter().enumerate() {
            for (q, quality) in <Quality as clap::ValueEnum>::value_variants().iter().enumerate() {
                if !methods.contains(method) || !self.options.qualities.contains(quality) {
                    continue;
                }
                let size = [error_size.width, error_size.height];
                let mut cell = Cell::new(self.subject, number, (m, *method), (q, *quality), size);
                cell.key = content.clone().debug(&(method, quality)).finish();
                cells.push((self.folder.cell(&cell)?.unwrap_or(cell), *method, *quality));
            }
        }
        self.errors(&mut cells)?;
        self.times(&mut cells)?;
        Ok(cells.into_iter().map(|(cell, _, _)| cell).collect())
    }

    /// The error's picture: as large as the timed one, or as asked for, the sweep's factor on both.
    fn error_size(&self) -> Size {
        let scaled = |n: u32| ((f64::from(n) * self.subject.spec.scale).round() as u32).max(1);
        self.options.error_size.map_or(self.subject.size, |s| Size { width: scaled(s.width), height: scaled(s.height) })
    }

    /// Errors of the cells that have none, each kept at once.
    fn errors(&self, cells: &mut [(Cell, Method, Quality)]) -> Result<(), CompareError> {
        let mut truth: Option<Reference> = None;
        for (cell, method, quality) in cells.iter_mut().filter(|(c, _, _)| c.refused.is_none() && c.error.is_none()) {
            let asked = Settings {
                size: self.error_size(),
                view: View::Scatter,
                ..settings(*method, *quality, self.subject.size)
            };
            if truth.is_none() {
                let inputs = self.subject.inputs(Settings { method: Method::Lambert, ..asked.clone() }, Output::Linear);
                let found = reference::find(&inputs, &self.options.effort, &self.options.cache, |thousandths| {
                    if thousandths.is_multiple_of(10) {
                        (self.say)(&format!("truth, {} %", thousandths / 10));
                    }
                })?;
                pictures::of_truth(self.folder, &found)?;
                truth = Some(found);
            }
            let Some(truth) = &truth else { continue };
            (self.say)(&format!("error of {} {}", cell.method, cell.quality));
            let drawn = Renderer::new(self.gpu, self.subject.inputs(asked, Output::Linear)).and_then(|mut r| {
                r.run()?;
                r.linear()
            });
            match drawn {
                Ok(picture) => {
                    let comparison = metrics::compare(truth.size, &picture, &truth.pixels, Some(&truth.bands));
                    cell.error = Some(Errors::of(&comparison, truth));
                    pictures::of_cell(self.folder, cell, &picture, truth)?;
                }
                // What the device cannot do is a refusal; what it fails at is a failure.
                Err(FrameError::Gpu(error)) if !matches!(error, GpuError::Misuse(_)) => {
                    return Err(FrameError::Gpu(error).into());
                }
                Err(refusal) => cell.refused = Some(refusal.to_string()),
            }
            self.folder.keep(cell)?;
        }
        Ok(())
    }

    /// Times of the groups in which any cell has none. A group is timed as a whole: its cells took turns, or they did not.
    fn times(&self, cells: &mut [(Cell, Method, Quality)]) -> Result<(), CompareError> {
        let frame = |method, quality| settings(method, quality, self.subject.size);
        let mut there: Vec<usize> = Vec::new();
        let mut weights = Vec::new();
        for (i, (cell, method, quality)) in cells.iter_mut().enumerate() {
            if cell.refused.is_some() {
                continue;
            }
            let inputs = self.subject.inputs(frame(*method, *quality), Output::Ldr);
            match Renderer::plan_only(&inputs) {
                Ok(plan) => {
                    let (shared, unshared) = plan.bytes();
                    cell.memory = Some([shared, unshared]);
                    cell.passes = Some(plan.passes.len());
                    let floor = *method == Method::Lambert;
                    weights.push(Weight {
                        quality: *quality as usize,
                        floor,
                        bytes: shared + upload_bytes(self.subject),
                    });
                    there.push(i);
                }
                Err(refusal) => {
                    cell.refused = Some(refusal.to_string());
                    self.folder.keep(cell)?;
                }
            }
        }
        for group in timing::groups(&weights, timing::BUDGET) {
            let group: Vec<usize> = group.into_iter().map(|g| there[g]).collect();
            if group.iter().all(|i| cells[*i].0.time.is_some()) {
                continue;
            }
            let mut inputs = Vec::new();
            let mut floors = Vec::new();
            for i in &group {
                let (_, method, quality) = cells[*i];
                let mut input = self.subject.inputs(frame(method, quality), Output::Ldr);
                input.timing = self.context.stamps();
                inputs.push(input);
                let floor = |j: &usize| cells[*j].1 == Method::Lambert && cells[*j].2 == quality;
                floors.push(group.iter().position(floor).unwrap_or(0));
            }
            let told = |done: usize, all: usize| (self.say)(&format!("timing, turn {} of {all}", done + 1));
            let times = timing::time(self.gpu, inputs, &floors, self.context.plan, told)?;
            for (i, time) in group.iter().zip(times) {
                cells[*i].0.time = Some(time);
                self.folder.keep(&cells[*i].0)?;
            }
        }
        Ok(())
    }
}

/// What is drawn for a cell. Ambient occlusion is off: only some methods have it, and it is not scattering.
fn settings(method: Method, quality: Quality, size: Size) -> Settings {
    Settings { method, quality, size, no_ao: true, ..Settings::default() }
}

/// About what a scene takes on the device besides the frame's images: vertices, indices, textures with their levels.
fn upload_bytes(subject: &Subject) -> u64 {
    let s = &subject.scene;
    let texels: usize = s.textures.iter().map(|t| t.rgba8.len() * 4 / 3).sum();
    (s.positions.len() * 48 + s.indices.len() * 4 + texels) as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_are_a_partition_and_empty_ones_are_refused() {
        let all = [1, 2, 3, 4, 5, 6, 7];
        let mut parts: Vec<i32> = (0..3).flat_map(|i| share(&all, Some((i, 3))).unwrap_or_default()).collect();
        assert_eq!(parts.len(), 7);
        parts.sort_unstable();
        assert_eq!(parts, all);
        assert!(matches!(share(&all, Some((7, 8))), Err(CompareError::Question(q)) if q.contains("7 scenes")));
    }
}
