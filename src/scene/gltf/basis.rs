//! KTX2 textures of KHR_texture_basisu: Basis Universal's ETC1S and UASTC, with or without Zstandard, decoded to RGBA.

use basisu::{DecodeFlags, TargetFormat, Transcoder};
use image::RgbaImage;

use super::images::{Decoded, MAX_SIDE};
use super::json::At;
use crate::scene::error::Fault;

const MAGIC: &[u8] = b"\xABKTX 20\xBB\r\n\x1A\n";
/// Bytes for each texel while one is decoded: the picture, what Zstandard gives, a block's codes.
const WORK: u64 = 6;

pub(super) fn is_ktx2(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

/// Decodes the first image, at full size. A kind of KTX2 that is none of Basis Universal's is no fault of the file.
pub(super) fn decode(at: &At, bytes: &[u8], limit: u64) -> Result<Decoded, Fault> {
    let damaged = |reason: &str| Fault::new(at.path(), format!("damaged image: {reason}"));
    let torn = |_| damaged("its bytes are neither ETC1S nor UASTC as its header has them");
    let word = |place: usize| bytes.get(place..place + 4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]));
    // Format, width, height; where a level stands: offset, length, and its length as Zstandard unpacks it.
    let header = [12, 20, 24, 96, 100].map(word);
    let [Some(format), Some(width), Some(height), Some(unpacked), Some(0)] = header else {
        return Err(damaged("its header is cut short"));
    };
    if format != 0 {
        let place = at.path();
        return Ok(Err(format!("{place}: KTX2 of Vulkan's format {format} is not read; its texture is left out")));
    }
    let texels = u64::from(width) * u64::from(height);
    if width.max(height) > MAX_SIDE || texels.saturating_mul(WORK).saturating_add(unpacked.into()) > limit {
        return Err(damaged(&format!("{width} x {height} texels pass the limit of {} MiB", limit >> 20)));
    }
    let transcoder = Transcoder::new(bytes).map_err(torn)?;
    if !transcoder.supports(TargetFormat::Rgba32) || transcoder.is_video() {
        let (place, kind) = (at.path(), transcoder.source_format());
        return Ok(Err(format!("{place}: KTX2 of {kind:?} is not read; its texture is left out")));
    }
    let texels = transcoder.transcode(0, TargetFormat::Rgba32, DecodeFlags::NONE).map_err(torn)?;
    match RgbaImage::from_raw(width, height, texels) {
        Some(image) => Ok(Ok(image)),
        None => Err(damaged("it holds fewer texels than it says")),
    }
}
