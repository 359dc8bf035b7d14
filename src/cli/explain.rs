//! `pdss explain`: the plan of a frame in words.

use super::args::View;
use super::failure::Failure;
use super::{print, print_json};
use clap::{Args, ValueEnum};
use pdss::frame::{Output, Renderer};
use pdss::report::explain::{Explanation, ProfileWords};

/// Options of `pdss explain`.
#[derive(Debug, Args)]
pub struct Explain {
    #[command(flatten)]
    view: View,
    /// For people or for programs.
    #[arg(long, value_enum, default_value_t)]
    format: Format,
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
    /// Plans, and prints the plan: a decision that takes no device.
    pub fn run(&self) -> Result<(), Failure> {
        let stage = self.view.load()?;
        let plan = Renderer::plan_only(&stage.inputs(None, Output::Ldr))?;
        let [width, height] = stage.size();
        let mut words = Explanation::of(&plan, u64::from(width) * u64::from(height));
        words.profile = stage.profile.as_ref().map(ProfileWords::of);
        match self.format {
            Format::Table => print(&words.to_string()),
            Format::Json => print_json(&words),
        }
    }
}
