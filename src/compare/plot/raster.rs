//! A drawing as pixels, for places that show no SVG.

use super::{Anchor, Drawing, Mark};
use epaint_default_fonts::UBUNTU_LIGHT;
use tiny_skia::{Color, FillRule, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, Stroke, Transform};
use ttf_parser::{Face, OutlineBuilder};

/// Paints `scale` pixels per unit on white. Width, height, RGBA; none where a side would have no pixel.
pub fn paint(drawing: &Drawing, scale: f32) -> Option<([u32; 2], Vec<u8>)> {
    let size = drawing.size.map(|s| (s as f32 * scale).ceil() as u32);
    let mut pixmap = Pixmap::new(size[0], size[1])?;
    pixmap.fill(Color::WHITE);
    let face = Face::parse(UBUNTU_LIGHT, 0).ok();
    let to_pixels = Transform::from_scale(scale, scale);
    for mark in &drawing.marks {
        match mark {
            Mark::Line { points, ink, width } => {
                if let Some(path) = polyline(points) {
                    stroke(&mut pixmap, &path, ink.rgb(), *width as f32, to_pixels);
                }
            }
            Mark::Dot { at, radius, ink, ringed, .. } => {
                if let Some(path) = PathBuilder::from_circle(at[0] as f32, at[1] as f32, *radius as f32) {
                    pixmap.fill_path(&path, &paint_of(ink.rgb()), FillRule::Winding, to_pixels, None);
                    stroke(&mut pixmap, &path, if *ringed { [34; 3] } else { [255; 3] }, 1.5, to_pixels);
                }
            }
            Mark::Words { at, text, size, anchor, upright, .. } => {
                let Some((face, (path, length))) = face.as_ref().and_then(|f| Some((f, outline(f, text)?))) else {
                    continue;
                };
                let unit = *size as f32 / f32::from(face.units_per_em());
                let back = match anchor {
                    Anchor::Start => 0.,
                    Anchor::Middle => -length / 2.,
                    Anchor::End => -length,
                };
                let turn = if *upright { -90. } else { 0. };
                // From the font's units, y up, held at the anchor, turned, placed.
                let place = Transform::from_translate(back, 0.)
                    .post_scale(unit, -unit)
                    .post_rotate(turn)
                    .post_translate(at[0] as f32, at[1] as f32)
                    .post_concat(to_pixels);
                pixmap.fill_path(&path, &paint_of([34; 3]), FillRule::Winding, place, None);
            }
        }
    }
    // Opaque everywhere: multiplied by alpha or not is the same.
    Some((size, pixmap.take()))
}

fn paint_of([r, g, b]: [u8; 3]) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color_rgba8(r, g, b, 255);
    paint.anti_alias = true;
    paint
}

fn stroke(pixmap: &mut Pixmap, path: &Path, rgb: [u8; 3], width: f32, to_pixels: Transform) {
    let stroke = Stroke { width, line_cap: LineCap::Round, line_join: LineJoin::Round, ..Stroke::default() };
    pixmap.stroke_path(path, &paint_of(rgb), &stroke, to_pixels, None);
}

fn polyline(points: &[[f64; 2]]) -> Option<Path> {
    let mut path = PathBuilder::new();
    for (i, [x, y]) in points.iter().enumerate() {
        if i == 0 { path.move_to(*x as f32, *y as f32) } else { path.line_to(*x as f32, *y as f32) }
    }
    path.finish()
}

/// The outline of a line of text and its length, in the font's units. None where nothing of it has an outline.
fn outline(face: &Face<'_>, text: &str) -> Option<(Path, f32)> {
    let mut pen = Pen { path: PathBuilder::new(), at: 0. };
    for c in text.chars() {
        let Some(glyph) = face.glyph_index(c) else { continue };
        face.outline_glyph(glyph, &mut pen);
        pen.at += f32::from(face.glyph_hor_advance(glyph).unwrap_or(0));
    }
    let length = pen.at;
    Some((pen.path.finish()?, length))
}

/// Puts glyphs one after the other.
struct Pen {
    path: PathBuilder,
    at: f32,
}

impl OutlineBuilder for Pen {
    fn move_to(&mut self, x: f32, y: f32) {
        self.path.move_to(self.at + x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.path.line_to(self.at + x, y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.path.quad_to(self.at + x1, y1, self.at + x, y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.path.cubic_to(self.at + x1, y1, self.at + x2, y2, self.at + x, y);
    }

    fn close(&mut self) {
        self.path.close();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::plot::Ink;

    #[test]
    fn lines_dots_and_words_are_painted_where_they_are() {
        let words = |upright| Mark::Words {
            at: [50., 50.],
            text: "wide".to_owned(),
            size: 13.,
            anchor: Anchor::Middle,
            tick: false,
            upright,
        };
        let dark = |marks: Vec<Mark>| {
            let (size, texels) = paint(&Drawing { size: [100., 100.], marks }, 2.).unwrap_or_default();
            assert_eq!(size, [200, 200]);
            let xy = |i: usize| [i % 200 / 2, i / 200 / 2];
            let painted = texels.chunks_exact(4).enumerate().filter(|(_, t)| t[0] < 200);
            let all: Vec<[usize; 2]> = painted.map(|(i, _)| xy(i)).collect();
            let span = |k: usize| all.iter().map(|p| p[k]).max().zip(all.iter().map(|p| p[k]).min());
            [span(0), span(1)]
        };
        assert_eq!(dark(Vec::new()), [None, None]);
        let line = Mark::Line { points: vec![[10., 20.], [90., 20.]], ink: Ink::Text, width: 2. };
        assert_eq!(dark(vec![line]), [Some((90, 9)), Some((20, 19))]);
        let [Some(x), Some(y)] = dark(vec![words(false)]) else { panic!("no words") };
        assert!(x.0 - x.1 > 2 * (y.0 - y.1) && x.0 > 55 && x.1 < 45 && y.0 <= 53, "{x:?} {y:?}");
        let [Some(a), Some(b)] = dark(vec![words(true)]) else { panic!("no words") };
        assert!(b.0 - b.1 > 2 * (a.0 - a.1), "turned words are high: {a:?} {b:?}");
    }
}
