//! Truth, kept: a picture that took minutes is looked up by the key of everything that would change it.

use super::CompareError;
use super::key;
use crate::frame::Inputs;
use crate::report::picture;
use crate::truth::{self, Checkpoint, Effort, metrics};
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::time::Duration;

/// The answer that pictures are held against.
pub struct Reference {
    /// Width and height.
    pub size: [u32; 2],
    /// RGBA, A coverage.
    pub pixels: Vec<[f32; 4]>,
    /// Bits a pixel.
    pub bands: Vec<u8>,
    /// Its own root mean square error.
    pub rms: f64,
    /// The key of everything that decides it.
    pub key: String,
}

/// What stands beside the pictures. Written last: where it is, they are whole.
#[derive(Serialize, Deserialize)]
struct Card {
    schema: u32,
    rms: f64,
    samples: usize,
    seconds: f64,
}

const SCHEMA: u32 = 1;
/// An interruption costs at most this much of a truth.
const STATE_EVERY: Duration = Duration::from_secs(15);

/// Finds the truth of these inputs in `cache`, or integrates it and keeps it there.
///
/// # Errors
/// Where the cache cannot be written. What cannot be read there is made again.
pub fn find(
    inputs: &Inputs<'_>,
    effort: &Effort,
    cache: &Path,
    progress: impl Fn(usize) + Sync,
) -> Result<Reference, CompareError> {
    let key = key::of_truth(inputs, effort);
    let path = |ending: &str| cache.join(format!("{key}.{ending}"));
    if let Some(found) = read(&key, &path("exr"), &path("bands.exr"), &path("json")) {
        return Ok(found);
    }
    std::fs::create_dir_all(cache).map_err(|e| CompareError::file(cache, e))?;
    let state = Checkpoint { file: path("state"), every: STATE_EVERY };
    let answer = truth::resume(inputs, None, effort, Some(&state), progress)?;
    let size = [answer.window.width, answer.window.height];
    let card = Card { schema: SCHEMA, rms: answer.error.rms, samples: answer.samples, seconds: answer.seconds };
    picture::write_exr(&path("exr"), size, &answer.pixels)?;
    picture::write_exr(&path("bands.exr"), size, &metrics::bands_picture(&answer.bands))?;
    picture::write_text(&path("json"), &super::store::json(&card)?)?;
    match std::fs::remove_file(&state.file) {
        // A truth of seconds leaves no state.
        Err(e) if e.kind() != std::io::ErrorKind::NotFound => return Err(CompareError::file(&state.file, e)),
        _ => {}
    }
    Ok(Reference { size, pixels: answer.pixels, bands: answer.bands, rms: answer.error.rms, key })
}

fn read(key: &str, exr: &Path, bands: &Path, card: &Path) -> Option<Reference> {
    let card: Card = serde_json::from_str(&std::fs::read_to_string(card).ok()?).ok()?;
    let (size, pixels) = picture::read_exr(exr).ok()?;
    let (banded, bands) = picture::read_exr(bands).ok()?;
    (card.schema == SCHEMA && banded == size).then(|| Reference {
        size,
        pixels,
        bands: metrics::bands_of(&bands),
        rms: card.rms,
        key: key.to_owned(),
    })
}
