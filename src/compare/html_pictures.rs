//! Pictures inside a page: small JPEGs as data URIs.

use super::cell::Cell;
use super::pictures;
use super::store::Folder;
use image::codecs::jpeg::JpegEncoder;
use image::{ImageReader, Rgb, RgbImage};
use std::path::Path;

/// Of 100: artefacts stay below what the maps show.
const QUALITY: u8 = 90;
/// Behind what no surface covers.
const BEHIND: f32 = 40.;

/// The picture of a file as an element; an empty one where there is no such file, as of a cell that was not drawn.
fn element(file: &Path, what: &str) -> String {
    let Some(uri) = uri(file) else { return String::new() };
    format!("<img alt=\"{what}\" loading=\"lazy\" src=\"{uri}\">")
}

fn uri(file: &Path) -> Option<String> {
    let picture = ImageReader::open(file).ok()?.decode().ok()?.into_rgba8();
    let mut flat = RgbImage::new(picture.width(), picture.height());
    for (to, from) in flat.pixels_mut().zip(picture.pixels()) {
        let [r, g, b, a] = from.0.map(f32::from);
        let over = |c: f32| (BEHIND + (c - BEHIND) * a / 255.).round() as u8;
        *to = Rgb([over(r), over(g), over(b)]);
    }
    let mut bytes = Vec::new();
    JpegEncoder::new_with_quality(&mut bytes, QUALITY).encode_image(&flat).ok()?;
    Some(format!("data:image/jpeg;base64,{}", base64(&bytes)))
}

/// The map of a cell's errors.
pub fn map(folder: &Folder, cell: &Cell) -> String {
    element(&folder.picture(&pictures::map_of(cell)), "errors")
}

/// The window of a cell and that of its errors.
pub fn windows(folder: &Folder, cell: &Cell) -> String {
    let name = |n: String| folder.picture(&n);
    element(&name(pictures::window_of(cell)), "exitance") + &element(&name(pictures::window_map_of(cell)), "errors")
}

/// A truth's picture and its window.
pub fn truth(folder: &Folder, cell: &Cell) -> [String; 2] {
    let key = cell.error.as_ref().map_or("", |e| &e.truth_key);
    pictures::truth_of(key).map(|name| element(&folder.picture(&name), "truth"))
}

/// RFC 4648.
fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut out = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for chunk in bytes.chunks(3) {
        let three = chunk.iter().enumerate().fold(0u32, |n, (i, b)| n | u32::from(*b) << (16 - 8 * i));
        for i in 0..4 {
            let digit = DIGITS[(three >> (18 - 6 * i) & 63) as usize] as char;
            out.push(if i <= chunk.len() { digit } else { '=' });
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::base64;

    #[test]
    fn base64_is_that_of_the_rfc() {
        let texts = ["", "f", "fo", "foo", "foob", "fooba", "foobar"];
        assert_eq!(
            texts.map(|t| base64(t.as_bytes())),
            ["", "Zg==", "Zm8=", "Zm9v", "Zm9vYg==", "Zm9vYmE=", "Zm9vYmFy"]
        );
    }
}
