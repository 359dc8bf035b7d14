//! The pictures that a cell leaves behind: a map of its errors, and a window at full size where methods have trouble.

use super::CompareError;
use super::cell::Cell;
use super::reference::Reference;
use super::store::Folder;
use crate::report::{picture, preview};
use crate::settings::View;
use crate::truth::bands::band;
use crate::truth::metrics;
use image::imageops::{self, FilterType};
use image::{Rgba, RgbaImage};

/// Error that a map shows as white: a twentieth of full light.
pub const WHITE: f64 = 0.05;
/// Sides of the window, pixels at most.
const WINDOW: u32 = 192;
/// Width of a whole picture, pixels at most.
const WIDE: u32 = 480;

/// Names of a cell's pictures.
pub fn map_of(cell: &Cell) -> String {
    format!("{}.map.png", cell.key)
}

/// The window of the picture.
pub fn window_of(cell: &Cell) -> String {
    format!("{}.window.png", cell.key)
}

/// The window of the map.
pub fn window_map_of(cell: &Cell) -> String {
    format!("{}.window.map.png", cell.key)
}

/// A truth's picture, and its window.
pub fn truth_of(key: &str) -> [String; 2] {
    [format!("{key}.truth.png"), format!("{key}.truth.window.png")]
}

/// Writes the pictures of a truth.
///
/// # Errors
/// Where they cannot be written.
pub fn of_truth(folder: &Folder, truth: &Reference) -> Result<(), CompareError> {
    let [whole, window] = truth_of(&truth.key);
    let picture = shown(truth.size, &truth.pixels);
    write(folder, &whole, &smaller(&picture))?;
    write(folder, &window, &cut(&picture, corner(truth)))
}

/// Writes the pictures of a cell; `pixels` are what it drew.
///
/// # Errors
/// Where they cannot be written.
pub fn of_cell(folder: &Folder, cell: &Cell, pixels: &[[f32; 4]], truth: &Reference) -> Result<(), CompareError> {
    let map = rgba(truth.size, metrics::heat(pixels, &truth.pixels, WHITE));
    let at = corner(truth);
    write(folder, &map_of(cell), &smaller(&map))?;
    write(folder, &window_map_of(cell), &cut(&map, at))?;
    write(folder, &window_of(cell), &cut(&shown(truth.size, pixels), at))
}

/// The corner of the window that holds most terminator and shadow edge: decided by truth alone, the same for all methods.
fn corner(truth: &Reference) -> [u32; 2] {
    let [width, height] = truth.size.map(|s| s as usize);
    let hard = |i: usize| {
        let turned = truth.bands.get(i).is_some_and(|b| b & (band::TERMINATOR | band::SHADOW_EDGE) != 0);
        u64::from(truth.pixels[i][3] > 0.) + 4 * u64::from(turned)
    };
    // A table of sums from the top left corner: a window costs four look-ups.
    let mut sums = vec![0u64; (width + 1) * (height + 1)];
    for y in 0..height {
        for x in 0..width {
            let above = sums[y * (width + 1) + x + 1] + sums[(y + 1) * (width + 1) + x] - sums[y * (width + 1) + x];
            sums[(y + 1) * (width + 1) + x + 1] = above + hard(y * width + x);
        }
    }
    let [w, h] = [width, height].map(|s| s.min(WINDOW as usize));
    let inside = |x: usize, y: usize| {
        let at = |x: usize, y: usize| sums[y * (width + 1) + x];
        at(x + w, y + h) + at(x, y) - at(x + w, y) - at(x, y + h)
    };
    let corners = (0..=height - h).step_by(4).flat_map(|y| (0..=width - w).step_by(4).map(move |x| [x, y]));
    // The first of the best.
    let best = corners.map(|[x, y]| (inside(x, y), [x, y])).fold((0, [0, 0]), |a, b| if b.0 > a.0 { b } else { a });
    best.1.map(|s| s as u32)
}

fn shown(size: [u32; 2], pixels: &[[f32; 4]]) -> RgbaImage {
    rgba(size, preview::encode(View::Scatter, pixels).0)
}

/// An image of texels that fill it; one of the right size and nothing in it where they do not.
fn rgba([width, height]: [u32; 2], texels: Vec<u8>) -> RgbaImage {
    RgbaImage::from_raw(width, height, texels).unwrap_or_else(|| RgbaImage::from_pixel(width, height, Rgba([0; 4])))
}

fn smaller(picture: &RgbaImage) -> RgbaImage {
    if picture.width() <= WIDE {
        return picture.clone();
    }
    let height = (picture.height() * WIDE).div_ceil(picture.width());
    imageops::resize(picture, WIDE, height, FilterType::Triangle)
}

fn cut(picture: &RgbaImage, [x, y]: [u32; 2]) -> RgbaImage {
    imageops::crop_imm(picture, x, y, WINDOW.min(picture.width()), WINDOW.min(picture.height())).to_image()
}

fn write(folder: &Folder, name: &str, picture: &RgbaImage) -> Result<(), CompareError> {
    Ok(picture::write_png(&folder.picture(name), [picture.width(), picture.height()], picture.as_raw())?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_window_goes_where_the_trouble_is() {
        let size = [400, 300];
        let mut truth = Reference {
            size,
            pixels: vec![[1.; 4]; 400 * 300],
            bands: vec![0; 400 * 300],
            rms: 0.,
            key: "k".to_owned(),
        };
        assert_eq!(corner(&truth), [0, 0], "all the same: the first");
        for y in 250..260 {
            for x in 350..360 {
                truth.bands[y * 400 + x] = band::SHADOW_EDGE;
            }
        }
        let [x, y] = corner(&truth);
        assert!((168..=208).contains(&x) && (68..=108).contains(&y), "{x} {y}");
    }
}
