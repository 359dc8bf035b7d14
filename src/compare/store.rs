//! What a run leaves on disk, and how runs are put together.

use super::cell::Cell;
use super::key::{self, Digest};
use super::plot::{Drawing, raster, svg};
use super::scenes::Subject;
use super::timing::Plan;
use super::{CompareError, Options, columns, front, html};
use crate::gpu::DeviceInfo;
use crate::gpu::timing::TimingMode;
use crate::report::picture;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Version of the results' shape; it changes when a field changes its meaning.
pub const SCHEMA: u32 = 1;
/// Frames before the first sample on a processor, whose clocks others decide: code is compiled in the first, and turns do the rest.
const CPU_WARMUP: usize = 3;
/// Pixels per unit of a plot as PNG.
const PLOT_SCALE: f32 = 2.;
/// File of all results of a run.
pub const RESULTS: &str = "results.json";

/// What all cells of a run have in common. Results that differ here are not compared.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Context {
    /// Device name.
    pub device: String,
    /// Driver name and version.
    pub driver: String,
    /// discrete, integrated, virtual, cpu or other.
    pub device_kind: String,
    /// The machine: its processor and how many threads it runs.
    pub host: String,
    /// Commit, or the program's own key.
    pub code: String,
    /// Version of this crate.
    pub version: String,
    /// Profile name.
    pub profile: String,
    /// The one material that scatters; none: every opaque dielectric.
    pub material: Option<String>,
    /// Width and height of the timed picture.
    pub size: [u32; 2],
    /// Width and height of the picture whose error is measured.
    pub error_size: [u32; 2],
    /// Surface samples of truth, largest error of a pixel, opening of its tree.
    pub effort: (usize, f64, f64),
    /// Rounds, samples a round, warm-up.
    pub plan: Plan,
    /// The validation layers were on: times are of them, too.
    pub validation: bool,
    /// The clock that counts: `device`, or `wall` where the device's stamps are not times.
    pub clock: String,
}

impl Context {
    /// Of a run on this device.
    pub fn new(device: &DeviceInfo, o: &Options) -> Context {
        let error_size = o.error_size.unwrap_or(o.size);
        // On a processor a stamp waits for everything before it: it would be part of what is measured.
        let stamps = device.kind != "cpu" && device.timestamp_period > 0.;
        Context {
            device: device.name.clone(),
            driver: device.driver.clone(),
            device_kind: device.kind.to_owned(),
            host: host(),
            code: key::of_code(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            profile: o.profile.name.clone(),
            material: o.material.clone(),
            size: [o.size.width, o.size.height],
            error_size: [error_size.width, error_size.height],
            effort: (o.effort.samples, o.effort.max_error, o.effort.opening),
            plan: Plan {
                warmup: o.plan.warmup.or(if device.kind == "cpu" { Some(CPU_WARMUP) } else { None }),
                ..o.plan
            },
            validation: o.validation,
            clock: if stamps { "device" } else { "wall" }.to_owned(),
        }
    }

    /// Timestamps in timed frames.
    pub fn stamps(&self) -> Option<TimingMode> {
        (self.clock == "device").then_some(TimingMode::Overlap)
    }

    /// The start of a cell's key: this, and a scene with everything that it is seen by.
    pub fn key_of(&self, s: &Subject) -> Digest {
        let mut digest = Digest::default();
        digest.debug(&(SCHEMA, self)).debug(&(&s.spec, &s.camera, &s.lights, &s.profile, s.size));
        key::scene(&mut digest, &s.scene);
        digest
    }

    /// The first thing in which two differ: its name and both values.
    pub fn difference(&self, other: &Context) -> Option<(String, String, String)> {
        let fields = |c: &Context| match serde_json::to_value(c) {
            Ok(serde_json::Value::Object(map)) => map,
            _ => serde_json::Map::new(),
        };
        let (a, b) = (fields(self), fields(other));
        let differs = a.iter().find(|(name, value)| b.get(*name) != Some(*value));
        differs.map(|(name, value)| {
            (name.clone(), value.to_string(), b.get(name).map_or(String::new(), ToString::to_string))
        })
    }
}

/// The processor's name and threads.
pub fn host() -> String {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = info.lines().find_map(|l| l.strip_prefix("model name")?.split_once(':').map(|(_, name)| name.trim()));
    let threads = std::thread::available_parallelism().map_or(0, usize::from);
    format!("{}, {threads} threads", model.unwrap_or(std::env::consts::ARCH))
}

/// Everything that a run found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Results {
    /// [`SCHEMA`].
    pub schema: u32,
    /// What all cells have in common.
    pub context: Context,
    /// Sorted by scene, method and quality.
    pub cells: Vec<Cell>,
    /// What follows from the cells together, one each.
    pub standing: Vec<front::Standing>,
}

impl Results {
    /// Sorts, and works out who stands where.
    pub fn new(context: Context, mut cells: Vec<Cell>) -> Results {
        cells.sort_by_key(|c| c.order);
        let standing = front::standing(&cells);
        Results { schema: SCHEMA, context, cells, standing }
    }

    /// Puts runs together that shared out one question.
    ///
    /// # Errors
    /// Where they were measured on different devices or with different settings, or both have a cell.
    pub fn merge(parts: Vec<(PathBuf, Results)>) -> Result<Results, CompareError> {
        let mut parts = parts.into_iter();
        let Some((first, Results { context, mut cells, .. })) = parts.next() else {
            return Err(CompareError::Question("nothing to merge".to_owned()));
        };
        for (directory, part) in parts {
            if let Some((field, a, b)) = context.difference(&part.context) {
                let what = format!(
                    "its {field} is {b}, that of {} {a}; only runs of one device and one setting are one result",
                    first.display()
                );
                return Err(CompareError::file(&directory, what));
            }
            for cell in part.cells {
                let twice = cells.iter().any(|c| c.is_asked_as(&cell));
                if twice {
                    let what = format!(
                        "{} {} {} is also in another directory; parts share no cell",
                        cell.scene, cell.method, cell.quality
                    );
                    return Err(CompareError::file(&directory, what));
                }
                cells.push(cell);
            }
        }
        Ok(Results::new(context, cells))
    }

    /// Reads the results of a directory.
    ///
    /// # Errors
    /// Where there are none, they are cut short, or another version wrote them.
    pub fn read(directory: &Path) -> Result<Results, CompareError> {
        let file = directory.join(RESULTS);
        if !directory.is_dir() {
            return Err(CompareError::file(directory, "there is no such directory"));
        }
        let text = std::fs::read_to_string(&file).map_err(|e| match e.kind() {
            std::io::ErrorKind::NotFound => CompareError::file(
                &file,
                "not there: compare has not finished in this directory; run it again to go on",
            ),
            _ => CompareError::file(&file, e),
        })?;
        let value: serde_json::Value = serde_json::from_str(&text).map_err(|e| damaged(&file, &e))?;
        match value.get("schema").and_then(serde_json::Value::as_u64) {
            Some(schema) if schema == u64::from(SCHEMA) => {
                serde_json::from_value(value).map_err(|e| damaged(&file, &e))
            }
            Some(schema) => {
                Err(CompareError::file(&file, format!("results of schema {schema}; this program reads {SCHEMA}")))
            }
            None => Err(CompareError::file(&file, "no results of compare: they have a schema")),
        }
    }
}

fn damaged(file: &Path, error: &serde_json::Error) -> CompareError {
    CompareError::file(file, format!("damaged or cut short ({error}); remove it and run compare again"))
}

/// JSON as it is written everywhere here.
///
/// # Errors
/// Where a value has no JSON.
pub fn json(value: &impl Serialize) -> Result<String, CompareError> {
    let text = serde_json::to_string_pretty(value);
    text.map(|t| t + "\n").map_err(|e| CompareError::Question(format!("writing JSON: {e}")))
}

/// The directory of a run.
#[derive(Clone, Debug)]
pub struct Folder {
    root: PathBuf,
}

impl Folder {
    /// Opens or makes it, with room for cells and pictures.
    ///
    /// # Errors
    /// Where the name is taken by a file, or nothing may be written there.
    pub fn open(root: &Path) -> Result<Folder, CompareError> {
        if root.exists() && !root.is_dir() {
            return Err(CompareError::file(root, "that is a file; results need a directory"));
        }
        for part in ["cells", "pictures"] {
            let directory = root.join(part);
            std::fs::create_dir_all(&directory).map_err(|e| CompareError::file(&directory, e))?;
        }
        Ok(Folder { root: root.to_owned() })
    }

    /// A picture in it.
    pub fn picture(&self, name: &str) -> PathBuf {
        self.root.join("pictures").join(name)
    }

    /// What is known of a cell.
    ///
    /// # Errors
    /// Where its file is damaged.
    pub fn cell(&self, asked: &Cell) -> Result<Option<Cell>, CompareError> {
        let file = self.cell_file(asked);
        let text = match std::fs::read_to_string(&file) {
            Ok(text) => text,
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok(None),
            Err(e) => return Err(CompareError::file(&file, e)),
        };
        let known: Cell = serde_json::from_str(&text).map_err(|e| damaged(&file, &e))?;
        // The order follows from what is asked now, not from what was asked then.
        Ok((known.key == asked.key).then_some(Cell { order: asked.order, ..known }))
    }

    /// Keeps what is known of a cell.
    ///
    /// # Errors
    /// Where it cannot be written.
    pub fn keep(&self, cell: &Cell) -> Result<(), CompareError> {
        Ok(picture::write_text(&self.cell_file(cell), &json(cell)?)?)
    }

    fn cell_file(&self, cell: &Cell) -> PathBuf {
        self.root.join("cells").join(format!("{}.json", cell.key))
    }

    /// Writes the table, the record, the plots and the report.
    ///
    /// # Errors
    /// Where they cannot be written.
    pub fn finish(&self, results: &Results) -> Result<(), CompareError> {
        let csv = columns::csv(results);
        picture::write_text(&self.root.join("results.csv"), &csv)?;
        let plots = html::plots(results);
        for (name, drawing) in plots.iter().chain([&("plot".to_owned(), Drawing::grid(&html::drawings(&plots), 2))]) {
            picture::write_text(&self.root.join(format!("{name}.svg")), &svg::alone(drawing))?;
            if let Some((size, texels)) = raster::paint(drawing, PLOT_SCALE) {
                picture::write_png(&self.root.join(format!("{name}.png")), size, &texels)?;
            }
        }
        picture::write_text(&self.root.join("report.html"), &html::page(results, self))?;
        Ok(picture::write_text(&self.root.join(RESULTS), &json(results)?)?)
    }

    /// Takes over the pictures of another run.
    ///
    /// # Errors
    /// Where they cannot be copied.
    pub fn adopt(&self, other: &Path) -> Result<(), CompareError> {
        let from = other.join("pictures");
        let entries = std::fs::read_dir(&from).map_err(|e| CompareError::file(&from, e))?;
        for entry in entries {
            let entry = entry.map_err(|e| CompareError::file(&from, e))?;
            let to = self.root.join("pictures").join(entry.file_name());
            std::fs::copy(entry.path(), &to).map_err(|e| CompareError::file(&to, e))?;
        }
        Ok(())
    }
}
