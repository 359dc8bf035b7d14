//! Results for people who read a terminal: the columns that decide.

use super::columns::significant;
use super::store::Results;
use crate::report::table::Table;
use crate::report::traffic::human;
use std::fmt::Write as _;

/// A table a scene.
pub fn of(results: &Results) -> String {
    let c = &results.context;
    let (watch, size) = (if c.validation { ", validation on" } else { "" }, c.size);
    let mut out = format!(
        "{} ({})\n{}\n{}, profile {}, {} x {}, {} rounds of {} frames, {} clock{watch}\n",
        c.device, c.driver, c.host, c.code, c.profile, size[0], size[1], c.plan.rounds, c.plan.frames, c.clock
    );
    let mut from = 0;
    while from < results.cells.len() {
        let scene = |i: usize| (&results.cells[i].scene, results.cells[i].sweep_value.map(f64::to_bits));
        let to = (from..results.cells.len()).find(|i| scene(*i) != scene(from)).unwrap_or(results.cells.len());
        let mut table =
            Table::new(&["method", "quality", "ms", "scatter ms", "MAD", "rmse", "terminator", "memory", "front"]);
        let mut refused = String::new();
        for (cell, standing) in results.cells[from..to].iter().zip(&results.standing[from..to]) {
            let (Some(time), Some(error)) = (&cell.time, &cell.error) else {
                let why = cell.refused.as_deref().unwrap_or("not measured");
                // Writing to a string does not fail.
                let _ = writeln!(refused, "{} {}: {why}", cell.method, cell.quality);
                continue;
            };
            let three = |x: Option<f64>| x.map_or("-".to_owned(), |x| significant(x, 3));
            table.row([
                cell.method.clone(),
                cell.quality.clone(),
                three(Some(time.frame_ms().median)),
                three(Some(time.scatter_ms.median)),
                three(Some(time.scatter_ms.mad)),
                three(Some(error.rmse)),
                three(error.band("terminator")),
                cell.memory.map_or(String::new(), |m| human(m[0])),
                if standing.front { "*" } else { "" }.to_owned(),
            ]);
        }
        let cell = &results.cells[from];
        let swept = match (&cell.sweep, cell.sweep_value) {
            (Some(axis), Some(value)) => format!(", {axis} {}", significant(value, 3)),
            _ => String::new(),
        };
        let truth =
            cell.error.as_ref().map_or(String::new(), |e| format!("; truth to {}", significant(e.truth_rms, 2)));
        let _ = write!(
            out,
            "\n{}{swept}: {} triangles, {} lights{truth}\n{table}{refused}",
            cell.scene, cell.triangles, cell.lights
        );
        from = to;
    }
    out
}
