//! The table of results, as data: one line a column. The report shows nothing that is not in it.

use super::cell::{Cell, Errors, Times};
use super::front::Standing;
use super::store::{Context, Results, SCHEMA};
use std::fmt::Write as _;

/// Digits that a figure is written with; what is measured has fewer.
const DIGITS: i32 = 6;

/// A row's parts.
pub struct Row<'a> {
    /// Of all rows.
    pub context: &'a Context,
    /// Its own.
    pub cell: &'a Cell,
    /// Against the others.
    pub standing: &'a Standing,
}

/// One column: its name, and its text in a row, empty where there is none.
pub type Column = (&'static str, fn(&Row<'_>) -> String);

/// Every column, in order. Times are ms, lengths pixels, memory bytes; `scatter_ms` is what the frame takes beyond lambert's.
pub const COLUMNS: &[Column] = &[
    ("scene", |r| r.cell.scene.clone()),
    ("sweep", |r| r.cell.sweep.clone().unwrap_or_default()),
    ("sweep_value", |r| figure(r.cell.sweep_value)),
    ("method", |r| r.cell.method.clone()),
    ("quality", |r| r.cell.quality.clone()),
    ("refused", |r| r.cell.refused.clone().unwrap_or_default()),
    ("frame_ms", |r| time(r, |t| Some(t.frame_ms().median))),
    ("scatter_ms", |r| time(r, |t| Some(t.scatter_ms.median))),
    ("rmse", |r| error(r, |e| Some(e.rmse))),
    ("front", |r| if r.standing.front { "yes" } else { "" }.to_owned()),
    ("memory_bytes", |r| r.cell.memory.map_or(String::new(), |m| m[0].to_string())),
    ("rival_at_error", |r| {
        r.standing.at_error.as_ref().map_or(String::new(), |s| format!("{} {}", s.method, s.quality))
    }),
    ("time_over_rival", |r| figure(r.standing.at_error.as_ref().map(|s| s.ratio))),
    ("rival_at_time", |r| r.standing.at_time.as_ref().map_or(String::new(), |s| format!("{} {}", s.method, s.quality))),
    ("error_over_rival", |r| figure(r.standing.at_time.as_ref().map(|s| s.ratio))),
    ("rmse_r", |r| error(r, |e| Some(e.rmse_rgb[0]))),
    ("rmse_g", |r| error(r, |e| Some(e.rmse_rgb[1]))),
    ("rmse_b", |r| error(r, |e| Some(e.rmse_rgb[2]))),
    ("rel_mse", |r| error(r, |e| Some(e.rel_mse))),
    ("psnr_db", |r| error(r, |e| e.psnr_db)),
    ("p99", |r| error(r, |e| Some(e.p99))),
    ("max", |r| error(r, |e| Some(e.max))),
    ("bias", |r| error(r, |e| Some(e.bias))),
    ("flip", |r| error(r, |e| Some(e.flip))),
    ("rmse_silhouette", |r| error(r, |e| e.band("silhouette"))),
    ("rmse_terminator", |r| error(r, |e| e.band("terminator"))),
    ("rmse_shadow_edge", |r| error(r, |e| e.band("shadow-edge"))),
    ("rmse_concave", |r| error(r, |e| e.band("concave"))),
    ("truth_rms", |r| error(r, |e| Some(e.truth_rms))),
    ("covered", |r| error(r, |e| Some(e.covered))),
    ("pixels_left_out", |r| r.cell.error.as_ref().map_or(String::new(), |e| e.left_out.to_string())),
    ("wall_median_ms", |r| time(r, |t| Some(t.wall_ms.median))),
    ("wall_p5_ms", |r| time(r, |t| Some(t.wall_ms.p5))),
    ("wall_p95_ms", |r| time(r, |t| Some(t.wall_ms.p95))),
    ("wall_min_ms", |r| time(r, |t| Some(t.wall_ms.min))),
    ("wall_mad_ms", |r| time(r, |t| Some(t.wall_ms.mad))),
    ("wall_n", |r| r.cell.time.as_ref().map_or(String::new(), |t| t.wall_ms.n.to_string())),
    ("gpu_median_ms", |r| time(r, |t| t.gpu_ms.map(|g| g.median))),
    ("gpu_p5_ms", |r| time(r, |t| t.gpu_ms.map(|g| g.p5))),
    ("gpu_p95_ms", |r| time(r, |t| t.gpu_ms.map(|g| g.p95))),
    ("scatter_p5_ms", |r| time(r, |t| Some(t.scatter_ms.p5))),
    ("scatter_p95_ms", |r| time(r, |t| Some(t.scatter_ms.p95))),
    ("plan_ms", |r| time(r, |t| Some(t.prepare_ms[0]))),
    ("pipelines_ms", |r| time(r, |t| Some(t.prepare_ms[1]))),
    ("upload_ms", |r| time(r, |t| Some(t.prepare_ms[2]))),
    ("record_ms", |r| time(r, |t| Some(t.prepare_ms[3]))),
    ("memory_unshared_bytes", |r| r.cell.memory.map_or(String::new(), |m| m[1].to_string())),
    ("passes", |r| r.cell.passes.map_or(String::new(), |p| p.to_string())),
    ("warmup_frames", |r| r.cell.time.as_ref().map_or(String::new(), |t| t.warmup.to_string())),
    ("interleaved_cells", |r| r.cell.time.as_ref().map_or(String::new(), |t| t.interleaved.to_string())),
    ("width", |r| r.cell.size[0].to_string()),
    ("height", |r| r.cell.size[1].to_string()),
    ("error_width", |r| r.cell.error_size[0].to_string()),
    ("error_height", |r| r.cell.error_size[1].to_string()),
    ("triangles", |r| r.cell.triangles.to_string()),
    ("lights", |r| r.cell.lights.to_string()),
    ("about", |r| r.cell.why.clone()),
    ("profile", |r| r.context.profile.clone()),
    ("rounds", |r| r.context.plan.rounds.to_string()),
    ("frames_per_round", |r| r.context.plan.frames.to_string()),
    ("clock", |r| r.context.clock.clone()),
    ("validation", |r| if r.context.validation { "on" } else { "off" }.to_owned()),
    ("truth_samples", |r| r.context.effort.0.to_string()),
    ("truth_max_error", |r| figure(Some(r.context.effort.1))),
    ("truth_opening", |r| figure(Some(r.context.effort.2))),
    ("map_white", |_| figure(Some(super::pictures::WHITE))),
    ("device", |r| r.context.device.clone()),
    ("driver", |r| r.context.driver.clone()),
    ("device_kind", |r| r.context.device_kind.clone()),
    ("host", |r| r.context.host.clone()),
    ("code", |r| r.context.code.clone()),
    ("version", |r| r.context.version.clone()),
    ("key", |r| r.cell.key.clone()),
    ("schema", |_| SCHEMA.to_string()),
];

fn time(row: &Row<'_>, of: impl Fn(&Times) -> Option<f64>) -> String {
    figure(row.cell.time.as_ref().and_then(of))
}

fn error(row: &Row<'_>, of: impl Fn(&Errors) -> Option<f64>) -> String {
    figure(row.cell.error.as_ref().and_then(of))
}

/// A number with as many digits as are kept, without an exponent; nothing where there is none.
fn figure(x: Option<f64>) -> String {
    x.map_or(String::new(), |x| significant(x, DIGITS))
}

/// `x` rounded to so many significant digits, as a plain decimal.
pub fn significant(x: f64, digits: i32) -> String {
    if x == 0. || !x.is_finite() {
        return if x == 0. { "0".to_owned() } else { x.to_string() };
    }
    let places = (digits - 1 - x.abs().log10().floor() as i32).clamp(0, 18);
    format!("{x:.*}", places as usize)
}

/// The rows, as the table and the report have them.
pub fn rows(results: &Results) -> Vec<Vec<String>> {
    let pairs = results.cells.iter().zip(&results.standing);
    let text = |(cell, standing): (&Cell, &Standing)| {
        let row = Row { context: &results.context, cell, standing };
        COLUMNS.iter().map(|(_, text)| text(&row)).collect()
    };
    pairs.map(text).collect()
}

/// The position of a column.
pub fn position(name: &str) -> Option<usize> {
    COLUMNS.iter().position(|(n, _)| *n == name)
}

/// The table, RFC 4180: a header, a row a cell, commas.
pub fn csv(results: &Results) -> String {
    let mut out = COLUMNS.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(",") + "\n";
    for row in rows(results) {
        let quoted: Vec<String> = row.iter().map(|text| quote(text)).collect();
        // Writing to a string does not fail.
        let _ = writeln!(out, "{}", quoted.join(","));
    }
    out
}

fn quote(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_keep_their_digits_and_have_no_exponent() {
        let six = |x| significant(x, 6);
        assert_eq!(
            [six(123.456_789), six(0.001_234_567_8), six(1e-9), six(-2.)],
            ["123.457", "0.00123457", "0.00000000100000", "-2.00000"]
        );
        assert_eq!([six(1_234_567.), six(0.), significant(0.010_96, 3)], ["1234567", "0", "0.0110"]);
    }

    #[test]
    fn names_are_unique_and_commas_are_quoted() {
        let mut names: Vec<&str> = COLUMNS.iter().map(|c| c.0).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), COLUMNS.len());
        assert_eq!(quote("llvmpipe (LLVM 15, 256 \"bits\")"), "\"llvmpipe (LLVM 15, 256 \"\"bits\"\")\"");
    }
}
