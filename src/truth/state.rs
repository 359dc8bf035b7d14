//! An integral that was interrupted goes on: what is done so far, in a file beside the output.
//!
//! The file holds a key of everything that changes the result, the pixels done, their results bit for bit, and a checksum. It
//! is written under a temporary name and renamed, so that it is one state or another, never half of one. Surface samples are
//! not kept: they are drawn again, the same.

use super::{Effort, Window};
use crate::frame::Inputs;
use crate::report::picture::{self, PictureError};
use bytemuck::{Pod, Zeroable};
use std::path::PathBuf;
use std::time::Duration;

/// First bytes of the file; the digit changes whenever the integrator or the layout does.
const MAGIC: &[u8; 16] = b"pdss truth rev 1";

/// Where the state of an integral is kept, and how often.
#[derive(Clone, Debug)]
pub struct Checkpoint {
    /// Beside the output.
    pub file: PathBuf,
    /// Least time between two writes.
    pub every: Duration,
}

/// What was found where a state may be.
#[derive(Debug)]
pub(super) enum Found {
    Nothing,
    /// Seconds spent, and the results of the first pixels.
    State(f64, Vec<Work>),
    /// Why it is of no use.
    Useless(&'static str),
}

/// One pixel on its way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Work {
    pub value: [f64; 3],
    pub halves: [[f64; 3]; 2],
    pub mass: f64,
    /// 1 where there is a surface.
    pub covered: u32,
    /// 1 where its near part was done again with more rays.
    pub refined: u32,
}

/// What stands in front of the pixels.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Head {
    magic: [u8; 16],
    key: [u64; 2],
    sum: [u64; 2],
    seconds: f64,
    pixels: u64,
}

impl Checkpoint {
    /// Reads what an earlier run left.
    pub(super) fn load(&self, key: [u64; 2], pixels: usize) -> Found {
        let Ok(bytes) = std::fs::read(&self.file) else { return Found::Nothing };
        let (head, body) = bytes.split_at(bytes.len().min(size_of::<Head>()));
        let Ok(head) = bytemuck::try_pod_read_unaligned::<Head>(head) else {
            return Found::Useless("it is no state of an integral");
        };
        if head.magic != *MAGIC {
            return Found::Useless("it is no state of this version");
        }
        if head.key != key {
            return Found::Useless("it belongs to another scene or other settings");
        }
        let size = size_of::<Work>();
        let whole = body.len().is_multiple_of(size) && (body.len() / size) as u64 == head.pixels;
        if !whole || body.len() / size > pixels || digest(body) != head.sum {
            return Found::Useless("it is damaged");
        }
        Found::State(head.seconds, body.chunks_exact(size).map(bytemuck::pod_read_unaligned).collect())
    }

    /// Keeps the results of the first pixels.
    pub(super) fn save(&self, key: [u64; 2], seconds: f64, work: &[Work]) -> Result<(), PictureError> {
        let body: &[u8] = bytemuck::cast_slice(work);
        let head = Head { magic: *MAGIC, key, sum: digest(body), seconds, pixels: work.len() as u64 };
        picture::write_bytes(&self.file, &[bytemuck::bytes_of(&head), body])
    }
}

/// Two words that differ where anything differs that the result depends on.
pub(super) fn key(inputs: &Inputs<'_>, window: Window, effort: &Effort) -> [u64; 2] {
    let (scene, settings) = (inputs.scene, &inputs.settings);
    // Rust prints floating-point numbers so that they read back to the bit.
    let said = format!(
        "{window:?} {effort:?} {:?} {} {:?} {:?} {:?} {:?} {:?} {:?}",
        settings.size,
        settings.no_shadows,
        inputs.camera,
        inputs.lights,
        inputs.profiles,
        scene.draws,
        scene.materials,
        scene.bounds
    );
    let version = concat!(env!("CARGO_PKG_VERSION"), " ");
    let textures: Vec<u8> = (scene.textures.iter())
        .flat_map(|t| [t.width, t.height].map(u32::to_le_bytes).concat().into_iter().chain(t.rgba8.iter().copied()))
        .collect();
    let wraps = format!("{:?}", scene.textures.iter().map(|t| (t.wrap, t.filter)).collect::<Vec<_>>());
    let parts: [&[u8]; 9] = [
        version.as_bytes(),
        said.as_bytes(),
        bytemuck::cast_slice(&scene.positions),
        bytemuck::cast_slice(&scene.normals),
        bytemuck::cast_slice(&scene.tangents),
        bytemuck::cast_slice(&scene.uvs),
        bytemuck::cast_slice(&scene.indices),
        &textures,
        wraps.as_bytes(),
    ];
    parts.iter().fold([0; 2], |all, part| {
        let [a, b] = digest(part);
        [super::random::hash(all[0] ^ a, part.len() as u64), super::random::hash(all[1], b)]
    })
}

/// 128 bits of some bytes: two chains of a mixer over their words.
fn digest(bytes: &[u8]) -> [u64; 2] {
    let word = |chunk: &[u8]| {
        let mut word = [0; 8];
        word[..chunk.len()].copy_from_slice(chunk);
        u64::from_le_bytes(word)
    };
    let start = [bytes.len() as u64, !(bytes.len() as u64)];
    bytes.chunks(8).map(word).fold(start, |[a, b], w| [super::random::hash(a, w), super::random::hash(w, b)])
}
