//! Tables for people: columns as wide as what stands in them, numbers to the right.

use super::record::Record;
use super::stats::Summary;
use super::traffic::human;
use crate::gpu::DeviceInfo;
use std::fmt::{self, Display, Write as _};

/// Rows under a header.
#[derive(Clone, Debug, Default)]
pub struct Table {
    rows: Vec<Vec<String>>,
}

impl Table {
    /// A table with this header.
    pub fn new(header: &[&str]) -> Self {
        Table { rows: vec![header.iter().map(|&h| h.to_owned()).collect()] }
    }

    /// Adds a row.
    pub fn row(&mut self, cells: impl IntoIterator<Item = String>) {
        self.rows.push(cells.into_iter().collect());
    }
}

impl Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let columns = self.rows.iter().map(Vec::len).max().unwrap_or(0);
        let widest = |c: usize| self.rows.iter().filter_map(|r| r.get(c)).map(|s| s.chars().count()).max().unwrap_or(0);
        let number = |s: &String| s.is_empty() || s == "-" || s.starts_with(|c: char| c.is_ascii_digit());
        let right = |c: usize| self.rows.iter().skip(1).filter_map(|r| r.get(c)).all(number);
        let layout: Vec<(usize, bool)> = (0..columns).map(|c| (widest(c), right(c))).collect();
        for row in &self.rows {
            let mut line = String::new();
            for (cell, (width, right)) in row.iter().zip(&layout) {
                let gap = if line.is_empty() { "" } else { "  " };
                if *right { write!(line, "{gap}{cell:>width$}")? } else { write!(line, "{gap}{cell:<width$}")? }
            }
            writeln!(f, "{}", line.trim_end())?;
        }
        Ok(())
    }
}

/// A record for people.
pub fn of_record(record: &Record) -> String {
    let mut table =
        Table::new(&["ms", "median", "p5", "p95", "min", "MAD", "n", "dropped", "share", "read", "written"]);
    let whole = record.frame.sum_of_stage_medians_ms;
    for stage in &record.stages {
        let share =
            stage.gpu_ms.filter(|_| whole > 0.).map_or("-".to_owned(), |s| format!("{:.1} %", 100. * s.median / whole));
        let tail = [share, human(stage.bytes_read), human(stage.bytes_written)];
        table.row(times(&stage.name, stage.gpu_ms).into_iter().chain(tail));
    }
    table.row(["sum of medians".to_owned(), format!("{whole:.3}")]);
    table.row(times("frame, device clock", record.frame.gpu_ms));
    table.row(times("frame, wall clock", record.frame.wall_ms));
    let mut out = String::new();
    // Writing to a string does not fail.
    let _ = write!(out, "{}{table}", head(record));
    let (m, c) = (record.memory_total, record.cpu);
    let _ = writeln!(out, "memory: {} of images; {} if none shared", human(m.shared), human(m.unshared));
    let _ = writeln!(
        out,
        "host: plan {:.2} ms, pipelines {:.1} ms, upload {:.1} ms, recording {:.2} ms, last frame {:.2} ms",
        c.plan_ms, c.pipelines_ms, c.upload_ms, c.record_ms, c.last_run_ms
    );
    for note in &record.notes {
        let _ = writeln!(out, "note: {note}");
    }
    out
}

fn head(record: &Record) -> String {
    let s = &record.subject;
    let covered = s.covered_pixels.map_or(String::new(), |p| {
        format!(", {:.1} % covered", 100. * p as f64 / (f64::from(record.size[0]) * f64::from(record.size[1])))
    });
    format!(
        "{} ({})\n{}: {} triangles, {} lights, profile {}; {} x {}{covered}\nmethod {}, timing {}, validation {}, {} frames of warm-up\n",
        record.device,
        record.driver,
        s.scene,
        s.triangles,
        s.lights,
        s.profile.as_deref().unwrap_or("none"),
        record.size[0],
        record.size[1],
        name_of(record.method),
        name_of(s.timing),
        if s.validation { "on" } else { "off" },
        record.warmup.frames,
    )
}

/// The name that the command line has for a value.
pub fn name_of<T: clap::ValueEnum>(value: T) -> String {
    value.to_possible_value().map(|v| v.get_name().to_owned()).unwrap_or_default()
}

fn times(name: &str, summary: Option<Summary>) -> Vec<String> {
    let mut cells = vec![name.to_owned()];
    match summary {
        Some(s) => {
            cells.extend([s.median, s.p5, s.p95, s.min, s.mad].map(|t| format!("{t:.3}")));
            cells.extend([s.n, s.dropped].map(|n| n.to_string()));
        }
        None => cells.extend(std::iter::repeat_n("-".to_owned(), 7)),
    }
    cells
}

/// The devices for people.
pub fn of_devices(devices: &[DeviceInfo]) -> String {
    let mut table = Table::new(&["index", "device", "kind", "Vulkan", "driver", "ns per tick", "usable"]);
    for d in devices {
        table.row([
            d.index.to_string(),
            d.name.clone(),
            d.kind.to_owned(),
            d.api.clone(),
            d.driver.clone(),
            if d.timestamp_period > 0. { d.timestamp_period.to_string() } else { "-".to_owned() },
            d.unusable.as_ref().map_or("yes".to_owned(), |why| format!("no: {why}")),
        ]);
    }
    table.to_string()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::timing::TimingMode;
    use crate::report::record::tests::sample;

    #[test]
    fn columns_line_up() {
        let mut t = Table::new(&["stage", "ms"]);
        t.row(["a".to_owned(), "10.5".to_owned()]);
        t.row(["longer".to_owned(), "1.5".to_owned()]);
        assert_eq!(t.to_string(), "stage     ms\na       10.5\nlonger   1.5\n");
    }

    #[test]
    fn a_record_shows_the_stages_next_to_the_whole() {
        let text = of_record(&sample("d", TimingMode::Isolated));
        for word in
            ["gbuffer", "sum of medians", "frame, wall clock", "timing isolated", "validation off", "note: isolated"]
        {
            assert!(text.contains(word), "{word:?} in\n{text}");
        }
    }
}
