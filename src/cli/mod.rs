//! The command line: thin, one file per subcommand. Machine output goes to stdout alone, words for people to stderr.

mod args;
mod calibrate;
mod compare;
mod contact_sheet;
mod devices;
mod diff;
mod explain;
mod failure;
mod figure1;
mod profile;
mod profiles;
mod progress;
mod render;
mod sky;
mod stress;
mod truth;
mod vectors;
mod watch;

use clap::{Parser, Subcommand};
use failure::Failure;
use std::io::{self, Write};
use std::process::ExitCode;

/// Pre-integrated deferred subsurface scattering on Vulkan.
///
/// Exit codes: 0 done, 1 a check failed, 2 bad usage or input, 3 no usable Vulkan device.
#[derive(Debug, Parser)]
#[command(name = "pdss", version, arg_required_else_help = true, subcommand_required = true)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Draw a picture.
    Render(render::Render),
    /// Time every stage of the frame.
    Profile(profile::Profile),
    /// Say what a frame consists of, what waits for what and why, and what was left out.
    Explain(explain::Explain),
    /// Integrate the converged answer that methods are held against; needs no device.
    Truth(truth::Truth),
    /// Make the poster's first figure: our picture at every quality, curvature by every estimator.
    Figure1(figure1::Figure1),
    /// Hold all methods against truth and against the clock: error against run time.
    Compare(compare::Compare),
    /// Measure this device, so that render can choose a method for --budget-ms or --max-error.
    Calibrate(calibrate::Calibrate),
    /// Say how wrong one picture is against another.
    Diff(diff::Diff),
    /// Try every stiff and extreme case and say what holds.
    Stress(stress::Stress),
    /// Write inputs and outputs of each formula, so that a port can be checked without this program.
    Vectors(vectors::Vectors),
    /// List the Vulkan devices.
    Devices(devices::Devices),
}

/// Runs the command line and says how it went.
pub fn main() -> ExitCode {
    let done = match Cli::parse().command {
        Command::Render(c) => c.run(),
        Command::Profile(c) => c.run(),
        Command::Explain(c) => c.run(),
        Command::Truth(c) => c.run(),
        Command::Figure1(c) => c.run(),
        Command::Compare(c) => c.run(),
        Command::Calibrate(c) => c.run(),
        Command::Diff(c) => c.run(),
        Command::Stress(c) => c.run(),
        Command::Vectors(c) => c.run(),
        Command::Devices(c) => c.run(),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            say(&format!("pdss: {failure}"));
            failure.code()
        }
    }
}

/// A line for people.
fn say(line: &str) {
    // Nobody is left to hear that stderr is closed.
    let _ = writeln!(io::stderr(), "{line}");
}

/// Output for programs, or the table that a person asked for. A reader that has heard enough is not a fault.
fn print(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(e) if e.kind() != io::ErrorKind::BrokenPipe => Err(Failure::Run(format!("standard output: {e}"))),
        _ => Ok(()),
    }
}

/// The same for a value as JSON.
fn print_json(value: &impl serde::Serialize) -> Result<(), Failure> {
    let text = serde_json::to_string_pretty(value).map_err(|e| Failure::Run(format!("writing JSON: {e}")))?;
    print(&(text + "\n"))
}
