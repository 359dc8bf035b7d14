//! `pdss explain`: the plan of a frame in words.

use super::args::{self, Stage, View};
use super::failure::Failure;
use super::{print, print_json};
use clap::{Args, ValueEnum};
use pdss::frame::{Output, Renderer};
use pdss::report::explain::{Explanation, ProfileWords};
use pdss::report::stats::Summary;
use std::collections::BTreeMap;

/// Options of `pdss explain`.
#[derive(Debug, Args)]
pub struct Explain {
    #[command(flatten)]
    view: View,
    /// For people or for programs.
    #[arg(long, value_enum, default_value_t)]
    format: Format,
    /// Also measure what leaving out saves: N frames with each thing that can be brought back, in turn with N without.
    #[arg(long, value_name = "N", num_args = 0..=1, default_missing_value = "20", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    measure: Option<u32>,
}

/// How a list is written.
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub enum Format {
    /// For people.
    #[default]
    Table,
    /// For programs.
    Json,
}

impl Explain {
    /// Plans, and prints the plan: a decision that takes no device, unless something is to be measured.
    pub fn run(&self) -> Result<(), Failure> {
        let stage = self.view.load()?;
        let plan = Renderer::plan_only(&stage.inputs(None, Output::Ldr))?;
        let [width, height] = stage.size();
        let mut words = Explanation::of(&plan, u64::from(width) * u64::from(height));
        words.profiles = stage.profiles.iter().map(ProfileWords::of).collect();
        for (what, back) in words.left_out.iter().filter_map(|l| Some((l.what.clone(), l.back?))) {
            let mut inputs = stage.inputs(None, Output::Ldr);
            inputs.settings.no_elide.push(back);
            let more = Renderer::plan_only(&inputs)?.bytes().0;
            words.saved_bytes.insert(what, more.saturating_sub(plan.bytes().0));
        }
        if let Some(rounds) = self.measure {
            words.saved_ms = self.saved(&stage, &words, rounds)?;
        }
        match self.format {
            Format::Table => print(&words.to_string()),
            Format::Json => print_json(&words),
        }
    }

    /// What each thing would cost that the frame does without, ms: the median over pairs of neighbouring frames.
    fn saved(&self, stage: &Stage, words: &Explanation, rounds: u32) -> Result<BTreeMap<String, f64>, Failure> {
        let gpu = self.view.open()?;
        let mut saved = BTreeMap::new();
        let mut without = Renderer::new(&gpu, stage.inputs(None, Output::Ldr))?;
        for (left_out, back) in words.left_out.iter().filter_map(|l| Some((l, l.back?))) {
            let mut inputs = stage.inputs(None, Output::Ldr);
            inputs.settings.no_elide.push(back);
            let mut with = Renderer::new(&gpu, inputs)?;
            let mut pairs = Vec::new();
            for round in 0..rounds + 2 {
                without.run()?;
                with.run()?;
                if round >= 2 {
                    pairs.push(Some(with.cpu_times().last_run_ms - without.cpu_times().last_run_ms));
                }
            }
            saved.extend(Summary::of(&pairs).map(|s| (left_out.what.clone(), s.median)));
        }
        drop(without);
        args::close(gpu)?;
        Ok(saved)
    }
}
