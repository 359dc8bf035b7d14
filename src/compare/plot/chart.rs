//! A log-log chart of results: one curve a method through its qualities, the Pareto front marked.

use super::{Anchor, Drawing, Ink, Mark};
use crate::compare::columns::{self, significant};
use crate::compare::store::Results;

/// Width and height of a chart.
const SIZE: [f64; 2] = [480., 420.];
/// Left, top, right and bottom of the frame inside it.
const FRAME: [f64; 4] = [70., 34., 466., 320.];
/// Height of words.
const WORDS: f64 = 13.;

/// One axis: the column it shows and what it says.
#[derive(Clone, Copy, Debug)]
pub struct Axis {
    /// Column of the table.
    pub column: &'static str,
    /// Words along it.
    pub label: &'static str,
}

/// A point: row, coordinates, and their texts in the table.
struct Point {
    row: usize,
    at: [f64; 2],
    texts: [String; 2],
}

/// Frame time against error.
pub const TIME_ERROR: [Axis; 2] =
    [Axis { column: "frame_ms", label: "frame, ms" }, Axis { column: "rmse", label: "rms error" }];

/// Draws rows of the results; `curve` names the curve that a row belongs to, and its method. Rows that lack a coordinate, or
/// have one that no logarithm shows, are left out.
pub fn draw(
    results: &Results,
    title: &str,
    rows: &[usize],
    axes: [Axis; 2],
    curve: impl Fn(usize) -> (String, String),
) -> Drawing {
    let table = columns::rows(results);
    let text = |row: usize, axis: &Axis| Some(table.get(row)?.get(columns::position(axis.column)?)?.clone());
    let point = |&row: &usize| {
        let texts = [text(row, &axes[0])?, text(row, &axes[1])?];
        let at = [texts[0].parse::<f64>().ok()?, texts[1].parse().ok()?];
        at.iter().all(|x| *x > 0. && x.is_finite()).then_some(Point { row, at, texts })
    };
    let points: Vec<Point> = rows.iter().filter_map(point).collect();
    let mut drawing = Drawing { size: SIZE, marks: vec![words([FRAME[0], 20.], title, 15., Anchor::Start)] };
    if points.is_empty() {
        drawing.marks.push(words([SIZE[0] / 2., SIZE[1] / 2.], "nothing measured", WORDS, Anchor::Middle));
        return drawing;
    }
    let scales = [0, 1].map(|k| Scale::around(points.iter().map(|p| p.at[k]), k));
    let place = |at: [f64; 2]| [scales[0].place(at[0]), scales[1].place(at[1])];
    frame(&mut drawing, &scales, &axes);

    // The front lies under everything.
    let mut front: Vec<&Point> =
        points.iter().filter(|p| results.standing.get(p.row).is_some_and(|s| s.front)).collect();
    front.sort_by(|a, b| a.at[0].total_cmp(&b.at[0]));
    let of_errors = axes[0].column == TIME_ERROR[0].column;
    if of_errors {
        let line = front.iter().map(|p| place(p.at)).collect();
        drawing.marks.push(Mark::Line { points: line, ink: Ink::Front, width: 7. });
    }
    let mut curves: Vec<(String, String)> = Vec::new();
    for p in &points {
        let named = curve(p.row);
        if !curves.contains(&named) {
            curves.push(named);
        }
    }
    for named in &curves {
        let own: Vec<&Point> = points.iter().filter(|p| curve(p.row) == *named).collect();
        let ink = Ink::of(&named.1);
        drawing.marks.push(Mark::Line { points: own.iter().map(|p| place(p.at)).collect(), ink, width: 2. });
        for p in own {
            let cell = &results.cells[p.row];
            drawing.marks.push(Mark::Dot {
                at: place(p.at),
                radius: 4.,
                ink,
                ringed: of_errors && front.iter().any(|f| f.row == p.row),
                row: p.row,
                x: (axes[0].column, p.texts[0].clone()),
                y: (axes[1].column, p.texts[1].clone()),
                title: format!("{} {}", cell.method, cell.quality),
            });
        }
    }
    legend(&mut drawing, &curves);
    drawing
}

fn words(at: [f64; 2], text: &str, size: f64, anchor: Anchor) -> Mark {
    Mark::Words { at, text: text.to_owned(), size, anchor, tick: false, upright: false }
}

/// Names under the chart, four in a row.
fn legend(drawing: &mut Drawing, curves: &[(String, String)]) {
    for (i, (name, method)) in curves.iter().enumerate() {
        let at = [FRAME[0] - 58. + 116. * (i % 4) as f64, FRAME[3] + 60. + 20. * (i / 4) as f64];
        let line = vec![[at[0], at[1] - 4.], [at[0] + 16., at[1] - 4.]];
        drawing.marks.push(Mark::Line { points: line, ink: Ink::of(method), width: 3. });
        drawing.marks.push(words([at[0] + 21., at[1]], name, WORDS, Anchor::Start));
    }
    drawing.size[1] = drawing.size[1].max(FRAME[3] + 74. + 20. * (curves.len().saturating_sub(1) / 4) as f64);
}

fn frame(drawing: &mut Drawing, scales: &[Scale; 2], axes: &[Axis; 2]) {
    let [left, top, right, bottom] = FRAME;
    for (text, at) in scales[0].ticks(44.) {
        drawing.marks.push(Mark::Line { points: vec![[at, top], [at, bottom]], ink: Ink::Grid, width: 1. });
        drawing.marks.push(tick([at, bottom + 16.], text, Anchor::Middle));
    }
    for (text, at) in scales[1].ticks(20.) {
        drawing.marks.push(Mark::Line { points: vec![[left, at], [right, at]], ink: Ink::Grid, width: 1. });
        drawing.marks.push(tick([left - 6., at + 4.], text, Anchor::End));
    }
    let corners = vec![[left, top], [left, bottom], [right, bottom]];
    drawing.marks.push(Mark::Line { points: corners, ink: Ink::Text, width: 1. });
    drawing.marks.push(words([(left + right) / 2., bottom + 35.], axes[0].label, WORDS, Anchor::Middle));
    drawing.marks.push(Mark::Words {
        at: [13., (top + bottom) / 2.],
        text: axes[1].label.to_owned(),
        size: WORDS,
        anchor: Anchor::Middle,
        tick: false,
        upright: true,
    });
}

fn tick(at: [f64; 2], text: String, anchor: Anchor) -> Mark {
    Mark::Words { at, text, size: WORDS, anchor, tick: true, upright: false }
}

/// A logarithmic axis.
struct Scale {
    /// log10 at both ends.
    ends: [f64; 2],
    /// Where the ends lie.
    places: [f64; 2],
}

impl Scale {
    /// Around values, with room on both sides; axis 0 is x.
    fn around(values: impl Iterator<Item = f64>, axis: usize) -> Scale {
        let (low, high) = values.fold((f64::INFINITY, 0f64), |(l, h), v| (l.min(v), h.max(v)));
        let room = (0.06 * (high / low).log10()).max(0.04);
        let places = if axis == 0 { [FRAME[0], FRAME[2]] } else { [FRAME[3], FRAME[1]] };
        Scale { ends: [low.log10() - room, high.log10() + room], places }
    }

    fn place(&self, value: f64) -> f64 {
        let part = (value.log10() - self.ends[0]) / (self.ends[1] - self.ends[0]);
        self.places[0] + part * (self.places[1] - self.places[0])
    }

    /// Round values, their texts and their places: 1, then 2 and 5, then all digits, then halves and tenths of them while
    /// there are fewer than three, each where it stands `apart` from the others.
    fn ticks(&self, apart: f64) -> Vec<(String, f64)> {
        let (from, to) = (self.ends[0].floor() as i32, self.ends[1].ceil() as i32);
        // Multiples of a part of the decade, and the digits that they are written with.
        let finer = |parts: i32| (parts..10 * parts).map(|n| f64::from(n) / f64::from(parts)).collect::<Vec<_>>();
        let kinds = [(vec![1.], 1), (vec![2., 5.], 1), (finer(1), 1), (finer(2), 2), (finer(10), 2), (finer(100), 3)];
        let mut ticks: Vec<(String, f64)> = Vec::new();
        for (kind, (multiples, digits)) in kinds.iter().enumerate() {
            if kind > 2 && ticks.len() >= 3 {
                break;
            }
            for value in (from..=to).flat_map(|e| multiples.iter().map(move |m| m * 10f64.powi(e))) {
                let inside = (self.ends[0]..=self.ends[1]).contains(&value.log10());
                let at = self.place(value);
                if inside && ticks.iter().all(|(_, other)| (at - other).abs() >= apart) {
                    ticks.push((significant(value, *digits), at));
                }
            }
        }
        ticks
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::front::tests::results;

    #[test]
    fn a_decade_is_as_long_as_the_next_and_ticks_do_not_touch() {
        let scale = Scale::around([1., 10., 100.].into_iter(), 0);
        let (a, b, c) = (scale.place(1.), scale.place(10.), scale.place(100.));
        assert!((b - a - (c - b)).abs() < 1e-9 && a > FRAME[0] && c < FRAME[2]);
        let ticks = scale.ticks(44.);
        assert!(ticks.len() >= 3 && ticks.iter().any(|t| t.0 == "10"), "{ticks:?}");
        // Less than a decade still has a scale.
        for values in [[0.011, 0.018], [0.0692, 0.0721], [7., 7.]] {
            let ticks = Scale::around(values.into_iter(), 1).ticks(20.);
            println!("{values:?}: {ticks:?}");
            assert!(ticks.len() >= 3, "{values:?}: {ticks:?}");
        }
    }

    #[test]
    fn every_measured_cell_is_a_dot_at_its_figures() {
        let results = results();
        let rows: Vec<usize> = (0..results.cells.len()).collect();
        let curve = |row: usize| (results.cells[row].method.clone(), results.cells[row].method.clone());
        let drawing = draw(&results, "a", &rows, TIME_ERROR, curve);
        let dots: Vec<(usize, bool, [f64; 2])> = drawing
            .marks
            .iter()
            .filter_map(|m| match m {
                Mark::Dot { row, ringed, at, .. } => Some((*row, *ringed, *at)),
                _ => None,
            })
            .collect();
        let measured = results.cells.iter().filter(|c| c.point().is_some()).count();
        assert_eq!(dots.len(), measured, "refused cells have no dot");
        for (row, ringed, at) in &dots {
            assert_eq!(*ringed, results.standing[*row].front);
            for (other, _, there) in &dots {
                let ms = |r: usize| results.cells[r].point().map_or(0., |p| p.0);
                assert!(ms(*row) >= ms(*other) || at[0] < there[0], "faster is further left");
            }
        }
    }
}
