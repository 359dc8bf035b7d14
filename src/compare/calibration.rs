//! What a device was measured to do, and which method and quality that recommends for a time or an error.

use super::CompareError;
use super::cell::Cell;
use super::columns::significant;
use super::key::Digest;
use super::store::{self, Results};
use crate::gpu::DeviceInfo;
use crate::report::picture;
use crate::report::stats::quantile;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Version of the file's shape.
const SCHEMA: u32 = 1;

/// A method at a quality, over the calibrated scenes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Setting {
    /// Method's name.
    pub method: String,
    /// Quality's name.
    pub quality: String,
    /// Frame time that no pixel costs, ms.
    pub fixed_ms: f64,
    /// Frame time of a million pixels, ms.
    pub megapixel_ms: f64,
    /// Root mean square of the scenes' rms errors.
    pub rmse: f64,
    /// The greatest of them.
    pub worst_rmse: f64,
    /// And its scene.
    pub worst_scene: String,
}

impl Setting {
    /// Expected frame time of a picture of so many pixels, ms.
    pub fn frame_ms(&self, pixels: u64) -> f64 {
        self.fixed_ms + self.megapixel_ms * pixels as f64 * 1e-6
    }
}

/// What is kept of a device.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Calibration {
    schema: u32,
    /// Device name.
    pub device: String,
    /// Driver name and version.
    pub driver: String,
    /// Commit, or the program's own key.
    pub code: String,
    /// The two sizes it was timed at.
    pub sizes: [[u32; 2]; 2],
    /// The clock of its times: `device` or `wall`.
    pub clock: String,
    /// Scenes.
    pub scenes: usize,
    /// Every setting that was measured.
    pub settings: Vec<Setting>,
}

/// What a picture may cost.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wish {
    /// Frame time at most, ms.
    pub budget_ms: Option<f64>,
    /// Error at most, rms over the calibrated scenes.
    pub max_error: Option<f64>,
}

impl Calibration {
    /// Puts together what two sizes showed: the same scenes, methods and qualities. Times are the median scene's.
    ///
    /// # Errors
    /// Where nothing was measured at both.
    pub fn new(small: &Results, large: &Results) -> Result<Calibration, CompareError> {
        let [a, b] = [small, large].map(|r| &r.context);
        let mut settings: Vec<Setting> = Vec::new();
        for cell in &large.cells {
            let named = |c: &&Cell| c.method == cell.method && c.quality == cell.quality;
            if settings.iter().any(|s| s.method == cell.method && s.quality == cell.quality) {
                continue;
            }
            let ms = |r: &Results| median(r.cells.iter().filter(named).filter_map(|c| Some(c.point()?.0)).collect());
            let errors: Vec<(f64, &str)> =
                large.cells.iter().filter(named).filter_map(|c| Some((c.point()?.1, c.scene.as_str()))).collect();
            let worst = errors.iter().copied().max_by(|x, y| x.0.total_cmp(&y.0));
            let (Some(at_small), Some(at_large), Some(worst)) = (ms(small), ms(large), worst) else { continue };
            let pixels = |size: [u32; 2]| f64::from(size[0]) * f64::from(size[1]);
            // A small difference of noisy times must not promise less than nothing.
            let slope = ((at_large - at_small) / (pixels(b.size) - pixels(a.size)).max(1.)).max(0.);
            settings.push(Setting {
                method: cell.method.clone(),
                quality: cell.quality.clone(),
                fixed_ms: (at_large - slope * pixels(b.size)).max(0.),
                megapixel_ms: slope * 1e6,
                rmse: (errors.iter().map(|e| e.0 * e.0).sum::<f64>() / errors.len() as f64).sqrt(),
                worst_rmse: worst.0,
                worst_scene: worst.1.to_owned(),
            });
        }
        if settings.is_empty() {
            return Err(CompareError::Question("nothing was measured at both sizes".to_owned()));
        }
        let mut scenes: Vec<&str> = large.cells.iter().map(|c| c.scene.as_str()).collect();
        scenes.dedup();
        Ok(Calibration {
            schema: SCHEMA,
            device: b.device.clone(),
            driver: b.driver.clone(),
            code: b.code.clone(),
            sizes: [a.size, b.size],
            clock: b.clock.clone(),
            scenes: scenes.len(),
            settings,
        })
    }

    /// The settings that a wish allows, best first: the rightest within a time, else the fastest within an error.
    ///
    /// # Errors
    /// One line that says what would have to be allowed.
    pub fn choose(&self, wish: Wish, pixels: u64) -> Result<Vec<&Setting>, String> {
        let fits = |s: &&Setting| {
            wish.budget_ms.is_none_or(|b| s.frame_ms(pixels) <= b) && wish.max_error.is_none_or(|e| s.rmse <= e)
        };
        let mut fitting: Vec<&Setting> = self.settings.iter().filter(fits).collect();
        let rank = |s: &Setting| if wish.max_error.is_some() { s.frame_ms(pixels) } else { s.rmse };
        fitting.sort_by(|a, b| rank(a).total_cmp(&rank(b)));
        if fitting.is_empty() { Err(self.what_would_fit(wish, pixels)) } else { Ok(fitting) }
    }

    fn what_would_fit(&self, wish: Wish, pixels: u64) -> String {
        let three = |x: f64| significant(x, 3);
        let right_enough = |s: &&Setting| wish.max_error.is_none_or(|e| s.rmse <= e);
        let fastest =
            self.settings.iter().filter(right_enough).min_by(|a, b| a.frame_ms(pixels).total_cmp(&b.frame_ms(pixels)));
        match (fastest, wish.budget_ms) {
            (Some(s), Some(b)) => format!(
                "--budget-ms {b}: nothing fits; the fastest that is right enough is {} {} at {} ms",
                s.method,
                s.quality,
                three(s.frame_ms(pixels))
            ),
            _ => {
                let best = self.settings.iter().min_by(|a, b| a.rmse.total_cmp(&b.rmse));
                let best = best.map_or(String::new(), |s| {
                    format!("; the rightest is {} {} at {}", s.method, s.quality, three(s.rmse))
                });
                format!("--max-error {}: nothing is as right{best}", wish.max_error.unwrap_or(0.))
            }
        }
    }

    /// Writes it.
    ///
    /// # Errors
    /// Where it cannot be written.
    pub fn keep(&self, file: &Path) -> Result<(), CompareError> {
        Ok(picture::write_text(file, &store::json(self)?)?)
    }

    /// Reads what was kept of a device; none where nothing was.
    ///
    /// # Errors
    /// Where the file is damaged, or another version's.
    pub fn find(file: &Path) -> Result<Option<Calibration>, CompareError> {
        let text = match std::fs::read_to_string(file) {
            Ok(text) => text,
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok(None),
            Err(e) => return Err(CompareError::file(file, e)),
        };
        match serde_json::from_str::<Calibration>(&text) {
            Ok(c) if c.schema == SCHEMA => Ok(Some(c)),
            Ok(c) => Err(CompareError::file(
                file,
                format!("schema {}; this program reads {SCHEMA}: run pdss calibrate again", c.schema),
            )),
            Err(e) => Err(CompareError::file(file, format!("damaged ({e}): run pdss calibrate again"))),
        }
    }
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    quantile(&values, 0.5)
}

/// The directory where this user keeps what can be made again: XDG_CACHE_HOME, else what the system has for it.
pub fn cache_directory() -> Option<PathBuf> {
    let named = |name: &str| std::env::var_os(name).map(PathBuf::from).filter(|p| p.is_absolute());
    let root = named("XDG_CACHE_HOME")
        .or_else(|| named("LOCALAPPDATA"))
        .or_else(|| named("HOME").map(|home| home.join(".cache")));
    root.map(|r| r.join("pdss"))
}

/// The directory of a device's calibration.
pub fn directory(cache: &Path, device: &DeviceInfo) -> PathBuf {
    let key = Digest::default().debug(&(&device.name, &device.driver, store::host())).finish();
    cache.join("calibration").join(&key[..16])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::front::tests::results;

    /// Two runs whose frames take 10 ms and 100 ms a megapixel more than they say.
    fn calibration() -> Result<Calibration, CompareError> {
        let mut sized = [results(), results()];
        for (r, size) in sized.iter_mut().zip([[1000, 500], [1000, 1000]]) {
            r.context.size = size;
            for time in r.cells.iter_mut().filter_map(|c| c.time.as_mut()) {
                time.wall_ms.median += 10. + 100e-6 * f64::from(size[0] * size[1]);
            }
        }
        Calibration::new(&sized[0], &sized[1])
    }

    #[test]
    fn a_time_is_fixed_and_per_pixel() -> Result<(), CompareError> {
        let c = calibration()?;
        assert_eq!(c.settings.len(), 4, "what was refused everywhere is no choice");
        let moments = c.settings.iter().find(|s| s.method == "moments" && s.quality == "low");
        let near = |x: f64, y: f64| (x - y).abs() < 1e-6;
        assert!(
            moments.is_some_and(|s| near(s.fixed_ms, 40.)
                && near(s.megapixel_ms, 100.)
                && near(s.frame_ms(2_000_000), 240.))
        );
        Ok(())
    }

    #[test]
    fn the_choice_is_the_best_that_fits_and_a_miss_says_what_would() -> Result<(), CompareError> {
        let c = calibration()?;
        let wish = |budget_ms, max_error| c.choose(Wish { budget_ms, max_error }, 1_000_000);
        let first = |r: Result<Vec<&Setting>, String>| r.map(|s| format!("{} {}", s[0].method, s[0].quality));
        assert_eq!(first(wish(Some(1000.), None)), Ok("moments medium".to_owned()), "the rightest");
        assert_eq!(first(wish(Some(145.), None)), Ok("moments low".to_owned()), "40 + 100 ms fit, 60 + 100 do not");
        assert_eq!(first(wish(None, Some(0.016))), Ok("moments low".to_owned()), "the fastest that is right enough");
        assert_eq!(first(wish(None, Some(0.5))), Ok("lambert low".to_owned()));
        assert!(wish(Some(50.), None).is_err_and(|e| e.contains("lambert low at 130 ms")));
        assert!(wish(None, Some(0.001)).is_err_and(|e| e.contains("moments medium at 0.00800")));
        assert!(wish(Some(150.), Some(0.009)).is_err_and(|e| e.contains("moments medium at 160 ms")));
        Ok(())
    }

    #[test]
    fn a_damaged_file_is_said_and_a_missing_one_is_none() -> Result<(), Box<dyn std::error::Error>> {
        let directory = tempfile::tempdir()?;
        let file = directory.path().join("c.json");
        assert_eq!(Calibration::find(&file)?, None);
        let c = calibration()?;
        c.keep(&file)?;
        assert_eq!(Calibration::find(&file)?.map(|c| c.settings.len()), Some(4));
        let text = std::fs::read_to_string(&file)?;
        std::fs::write(&file, &text[..text.len() / 2])?;
        assert!(Calibration::find(&file).is_err_and(|e| e.to_string().contains("calibrate again")));
        Ok(())
    }
}
