//! `pdss vectors`: inputs and outputs of each formula, for whoever ports one.

use super::failure::Failure;
use super::say;
use clap::Args;
use pdss::skin::vectors::{FORMULAS, file};
use std::io::Write;
use std::path::PathBuf;

/// Options of `pdss vectors`.
#[derive(Debug, Args)]
pub struct Vectors {
    /// Folder for a .json file a formula; made where it is not there.
    #[arg(long, short, value_name = "DIR")]
    output: PathBuf,
}

impl Vectors {
    /// Writes the files, each whole or not at all.
    pub fn run(&self) -> Result<(), Failure> {
        let folder = self.output.display();
        let wrong =
            |e: &dyn std::fmt::Display| Failure::Input(format!("{folder}: {e}; a folder to write to is wanted"));
        std::fs::create_dir_all(&self.output).map_err(|e| wrong(&e))?;
        for formula in FORMULAS {
            let text = serde_json::to_string(&file(formula)).map_err(|e| Failure::Run(format!("writing JSON: {e}")))?;
            let mut part = tempfile::NamedTempFile::new_in(&self.output).map_err(|e| wrong(&e))?;
            part.write_all(text.as_bytes()).map_err(|e| wrong(&e))?;
            part.persist(self.output.join(format!("{}.json", formula.name))).map_err(|e| wrong(&e))?;
        }
        say(&format!("{} files in {folder}", FORMULAS.len()));
        Ok(())
    }
}
