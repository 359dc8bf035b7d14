//! `pdss stress`: the table of numerical stability.

use super::args::{self, Device};
use super::failure::Failure;
use super::{print, print_json, say};
use clap::{Args, ValueEnum};
use pdss::gpu::{Gpu, GpuError};
use pdss::stress::rows::ROWS;
use pdss::stress::{self, Bench, Line, Verdict};
use std::io::{self, IsTerminal, Write as _};
use std::sync::Arc;

/// Options of `pdss stress`.
#[derive(Debug, Args)]
pub struct Stress {
    /// Only rows whose name holds this text.
    #[arg(long, value_name = "TEXT")]
    filter: Option<String>,
    /// A table for people, JSON for programs.
    #[arg(long, value_enum, default_value_t)]
    format: Format,
    #[command(flatten)]
    device: Device,
}

/// How the result is printed.
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
enum Format {
    /// For people.
    #[default]
    Table,
    /// Everything.
    Json,
}

#[derive(serde::Serialize)]
struct Report<'a> {
    schema: u32,
    device: &'a str,
    driver: &'a str,
    /// Core and synchronization validation was on; a message fails its row.
    validation: bool,
    lines: &'a [Line],
    rows: usize,
    pass: usize,
    fail: usize,
    expected: usize,
    refused: usize,
}

impl Stress {
    /// Runs the rows. Validation is on wherever the layer is installed.
    pub fn run(&self) -> Result<(), Failure> {
        let wanted = |name: &str| self.filter.as_ref().is_none_or(|f| name.contains(f.as_str()));
        let rows: Vec<_> = ROWS.iter().filter(|r| wanted(r.name)).collect();
        if rows.is_empty() {
            let filter = self.filter.as_deref().unwrap_or_default();
            return Err(Failure::Input(format!(
                "--filter {filter}: no row's name holds that; leave it out to see all"
            )));
        }
        let (gpu, validation) = self.open()?;
        let bench = Bench { gpu };
        let mut lines = Vec::new();
        let terminal = io::stderr().is_terminal();
        for (i, row) in rows.iter().enumerate() {
            if terminal {
                // Progress that cannot be shown stops nothing.
                let _ = write!(io::stderr(), "\r\x1b[K{} of {}: {}", i + 1, rows.len(), row.name);
            }
            lines.extend(stress::run(&bench, row));
        }
        if terminal {
            let _ = write!(io::stderr(), "\r\x1b[K");
        }
        let count = |v: Verdict| lines.iter().filter(|l| l.verdict == v).count();
        let expected = lines.iter().filter(|l| failed(l) && l.expected.is_some()).count();
        let report = Report {
            schema: 1,
            device: &bench.gpu.info().name.clone(),
            driver: &bench.gpu.info().driver.clone(),
            validation,
            rows: rows.len(),
            pass: count(Verdict::Pass),
            fail: count(Verdict::Fail) + count(Verdict::Blind),
            expected,
            refused: count(Verdict::Refused),
            lines: &lines,
        };
        match self.format {
            Format::Table => print(&table(&report))?,
            Format::Json => print_json(&report)?,
        }
        let failures = report.fail;
        args::close(bench.gpu)?;
        match failures {
            0 => Ok(()),
            n => Err(Failure::Run(format!("{n} figures beyond their bounds, {expected} of them known and explained"))),
        }
    }

    fn open(&self) -> Result<(Arc<Gpu>, bool), Failure> {
        match self.device.open_validated() {
            Ok(gpu) => Ok((gpu, true)),
            Err(GpuError::NoValidation) if !self.device.validate => {
                say("the validation layer is not installed: rows run without it");
                Ok((self.device.open()?, false))
            }
            Err(e) => Err(e.into()),
        }
    }
}

fn failed(l: &Line) -> bool {
    matches!(l.verdict, Verdict::Fail | Verdict::Blind)
}

fn table(r: &Report) -> String {
    let on = if r.validation { "on: a message fails its row" } else { "off: the layer is not installed" };
    let mut text = format!("{} ({}); validation {on}\n", r.device, r.driver);
    text.push_str(&format!(
        "{:40} {:14} {:22} {:>9} {:>9} {:>9}  {}\n",
        "case", "method", "quantity", "figure", "bound", "if wrong", ""
    ));
    let number = |x: Option<f64>| x.map_or("-".to_owned(), |x| format!("{x:.2e}"));
    let mut before = "";
    for l in r.lines {
        let name = if l.row == before { "" } else { l.row };
        before = l.row;
        let verdict = match l.verdict {
            Verdict::Pass => "pass",
            Verdict::Fail => "FAIL",
            Verdict::Blind => "BLIND",
            Verdict::Refused => "refused",
        };
        text.push_str(&format!(
            "{name:40} {:14} {:22} {:>9} {:>9.1e} {:>9}  {verdict}{}{}\n",
            l.method.as_deref().unwrap_or(""),
            l.quantity,
            number(l.figure),
            l.bound,
            number(l.wrong),
            if failed(l) || l.verdict == Verdict::Refused { format!(": {}", l.text) } else { String::new() },
            if failed(l) { l.expected.map_or(String::new(), |why| format!("; known: {why}")) } else { String::new() },
        ));
    }
    text + &format!(
        "{} rows, {} figures: {} within their bounds, {} beyond ({} of them known and explained), {} refused by a method\n",
        r.rows,
        r.lines.len(),
        r.pass,
        r.fail,
        r.expected,
        r.refused
    )
}
