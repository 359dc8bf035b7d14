//! A sky as a picture: radiance by latitude and longitude, read from Radiance HDR or OpenEXR.

use super::SceneError;
use glam::DMat3;
use image::codecs::hdr::HdrDecoder;
use image::codecs::openexr::OpenExrDecoder;
use image::{DynamicImage, ImageDecoder, ImageError};
use std::fs::File;
use std::io::{BufReader, Read, Seek};
use std::path::Path;

/// Light from all around. The middle of the picture lies in +Z, where yaw and pitch 0 are; left of it is +X, yaw 90 (OpenEXR's
/// latitude-longitude map: the picture as it is seen from within).
#[derive(Clone, Debug, PartialEq)]
pub struct Environment {
    /// The file as it was named.
    pub name: String,
    /// Texels across, twice `height`.
    pub width: usize,
    /// Texels down; row 0 is straight up.
    pub height: usize,
    /// Linear radiance, row by row from the top, finite, none negative.
    pub pixels: Vec<[f32; 3]>,
    /// Degrees by which the sky is turned about +Y: what shone from yaw 0 then shines from here.
    pub rotation_deg: f64,
    /// Factor on radiance, at least 0.
    pub intensity: f64,
    /// The sky is drawn where nothing else is, blurred by 0 (not at all) .. 1 (as a matt ball sees it).
    pub background: Option<f32>,
    /// What was mended, for people.
    pub warnings: Vec<String>,
}

/// Bytes that reading takes at most: what a model file may, too.
const FREE_BYTES: u64 = 256 << 20;
/// Bytes a texel while it is read.
const TEXEL_BYTES: u64 = 24;

impl Environment {
    /// A sky of these texels.
    ///
    /// # Errors
    /// A picture that is not twice as wide as high, or has not as many texels.
    pub fn new(name: &str, width: usize, mut pixels: Vec<[f32; 3]>) -> Result<Self, SceneError> {
        let fault = |place: &str, reason: String| SceneError::Invalid {
            file: name.to_owned(),
            place: place.to_owned(),
            reason,
        };
        let height = width / 2;
        if width < 2 || pixels.len() != width * height {
            return Err(fault("size", format!("{} texels are no sky of {width} x {height}", pixels.len())));
        }
        let (mut endless, mut negative) = (0usize, 0usize);
        for x in pixels.iter_mut().flatten() {
            if !x.is_finite() {
                endless += 1;
                *x = if *x == f32::INFINITY { 65504. } else { 0. };
            } else if *x < 0. {
                negative += 1;
                *x = 0.;
            }
        }
        let mut warnings = Vec::new();
        if endless > 0 {
            warnings.push(format!("{endless} values are not finite: infinite ones count as 65504, NaN as 0"));
        }
        if negative > 0 {
            warnings.push(format!("{negative} values are negative and count as 0"));
        }
        let (rotation_deg, intensity) = (0., 1.);
        Ok(Self { name: name.to_owned(), width, height, pixels, rotation_deg, intensity, background: None, warnings })
    }

    /// Reads an `.hdr` or `.exr` file.
    ///
    /// # Errors
    /// One line naming the file and what is wrong with it: unreadable, not what its name says, cut short, not twice as wide as
    /// high, or larger than 16 times its bytes and 256 MiB once decoded.
    pub fn load(path: &Path) -> Result<Self, SceneError> {
        let file = path.display().to_string();
        let read = |reason| SceneError::Read { file: file.clone(), reason };
        let fault =
            |place: &str, reason: String| SceneError::Invalid { file: file.clone(), place: place.to_owned(), reason };
        let extension = path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
        let handle = File::open(path).map_err(read)?;
        let bytes = handle.metadata().map_err(read)?.len();
        let mut reader = BufReader::new(handle);
        let mut head = Vec::new();
        reader.by_ref().take(64).read_to_end(&mut head).map_err(read)?;
        reader.rewind().map_err(read)?;
        if head.starts_with(b"version https://git-lfs") {
            return Err(fault(
                "contents",
                "a Git LFS pointer instead of a picture; git lfs pull fetches it".to_owned(),
            ));
        }
        let wrong = |e: ImageError| fault("contents", e.to_string());
        match extension.as_deref() {
            Some("hdr") => decode(&file, bytes, HdrDecoder::new(reader).map_err(wrong)?),
            Some("exr") => decode(&file, bytes, OpenExrDecoder::new(reader).map_err(wrong)?),
            _ => Err(fault("name", "a sky is an .hdr or .exr file".to_owned())),
        }
    }

    /// World directions to the picture's own axes: the turn about +Y undone.
    pub fn sky_from_world(&self) -> DMat3 {
        DMat3::from_rotation_y(-self.rotation_deg.to_radians())
    }
}

fn decode(file: &str, bytes: u64, decoder: impl ImageDecoder) -> Result<Environment, SceneError> {
    let fault =
        |place: &str, reason: String| SceneError::Invalid { file: file.to_owned(), place: place.to_owned(), reason };
    let (width, height) = decoder.dimensions();
    if width < 2 || u64::from(width) != 2 * u64::from(height) {
        return Err(fault(
            "size",
            format!("{width} x {height}: a sky by latitude and longitude is twice as wide as high"),
        ));
    }
    let wanted = u64::from(width) * u64::from(height) * TEXEL_BYTES;
    if wanted > 16 * bytes + FREE_BYTES {
        return Err(fault("size", format!("{width} x {height} texels in {bytes} bytes: the file does not hold them")));
    }
    let picture = DynamicImage::from_decoder(decoder).map_err(|e| fault("contents", e.to_string()))?;
    let pixels = picture.into_rgb32f().as_raw().chunks_exact(3).map(|p| [p[0], p[1], p[2]]).collect();
    Environment::new(file, width as usize, pixels)
}
