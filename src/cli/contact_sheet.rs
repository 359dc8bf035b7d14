//! `pdss render --contact-sheet`: many scenes on one picture, on one device.

use super::args::{self, View};
use super::failure::Failure;
use super::say;
use pdss::frame::{Output, Renderer};
use pdss::gpu::Gpu;
use pdss::report::canvas::Canvas;
use pdss::report::picture::{self, Format};
use pdss::report::{preview, supersample};
use pdss::settings::Size;
use std::path::Path;
use std::sync::Arc;

const PAPER: [u8; 3] = [52, 54, 58];
const WORDS: [u8; 3] = [225, 225, 225];
const REFUSED: [u8; 3] = [240, 150, 110];
/// Pixels of a letter, of a line of them, and between cells.
const LETTER: u32 = 8;
const LINE: u32 = 10;
const GAP: u32 = 6;

/// Draws each scene into its cell; one that cannot be drawn as asked leaves its reason there.
pub fn draw(view: &View, scenes: &[&str], cell: Size, samples: u32, output: &Path) -> Result<(), Failure> {
    if picture::format_of(output)? != Format::Png {
        return Err(Failure::Input(format!("{}: a contact sheet is a .png", output.display())));
    }
    let (w, h) = (cell.width, cell.height);
    let pitch = [w + GAP, h + LINE + GAP];
    // About as wide as three halves of its height.
    let shape = scenes.len() as f64 * 1.5 * f64::from(pitch[1]) / f64::from(pitch[0]);
    let columns = (shape.sqrt().round() as u32).clamp(1, scenes.len() as u32);
    let rows = (scenes.len() as u32).div_ceil(columns);
    let mut sheet = Canvas::new([columns * pitch[0] + GAP, rows * pitch[1] + GAP], PAPER);
    let gpu = view.device().open()?;
    let mut refused = 0;
    for (index, scene) in scenes.iter().enumerate() {
        let index = index as u32;
        let at = [GAP + index % columns * pitch[0], GAP + index / columns * pitch[1]];
        match one(&gpu, &view.of(scene, cell), samples) {
            Ok(texels) => sheet.picture(at, [w, h], &texels, [w, h], [0, 0, w, h]),
            Err(Failure::Input(why)) => {
                refused += 1;
                say(&format!("refused: {why}"));
                words(&mut sheet, at, [w, h], &why);
            }
            Err(other) => return Err(other),
        }
        let name =
            Path::new(scene).file_stem().map_or_else(|| (*scene).to_owned(), |s| s.to_string_lossy().into_owned());
        let name: String = name.chars().take((w / LETTER) as usize).collect();
        sheet.text([at[0], at[1] + h + 1], 1, WORDS, &name);
    }
    say(&format!("{} scenes, {refused} refused: {}", scenes.len(), output.display()));
    picture::write_png(output, sheet.size, &sheet.texels)?;
    args::close(gpu)
}

/// One scene, sRGB RGBA.
fn one(gpu: &Arc<Gpu>, view: &View, samples: u32) -> Result<Vec<u8>, Failure> {
    let mut stage = view.load()?;
    stage.meter();
    let size = stage.size();
    let samples = if stage.lit() { samples } else { 1 };
    stage.settings.size = Size { width: size[0] * samples, height: size[1] * samples };
    let mut renderer = Renderer::new(gpu, stage.inputs(None, Output::Ldr))?;
    renderer.run()?;
    Ok(match renderer.output() {
        Output::Ldr => supersample::average(&renderer.ldr()?, size, samples),
        Output::Linear => preview::encode(stage.settings.view, &renderer.linear()?).0,
    })
}

/// A line, broken to fit a cell.
fn words(sheet: &mut Canvas, at: [u32; 2], size: [u32; 2], line: &str) {
    let letters: Vec<char> = line.chars().collect();
    let rows = letters.chunks((size[0] / LETTER).max(1) as usize).take((size[1] / LINE) as usize);
    for (row, letters) in rows.enumerate() {
        let text: String = letters.iter().map(|c| if c.is_ascii() { *c } else { '?' }).collect();
        sheet.text([at[0], at[1] + row as u32 * LINE], 1, REFUSED, &text);
    }
}
