//! What the harnesses share: their arguments, and records that say which code was measured.

use std::io::Write as _;
use std::path::Path;

/// What follows `--`, without the flag that cargo adds; and the file after `-o`, if any.
pub fn arguments() -> (Vec<String>, Option<String>) {
    let mut all: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    let output = all.iter().position(|a| a == "-o").map(|i| all.split_off(i)).and_then(|rest| rest.into_iter().nth(1));
    (all, output)
}

/// The checkout's commit, a `+` behind it where files have been changed since.
pub fn commit() -> Option<String> {
    let git = ["describe", "--always", "--dirty=+", "--exclude=*"];
    let said = std::process::Command::new("git").args(git).output().ok().filter(|o| o.status.success())?;
    Some(String::from_utf8_lossy(&said.stdout).trim().to_owned())
}

/// Writes a record to a file, whole or not at all, or prints it.
pub fn write(record: &serde_json::Value, to: Option<String>) -> Result<(), Box<dyn std::error::Error>> {
    let Some(path) = to else {
        println!("{record:#}");
        return Ok(());
    };
    let beside = Path::new(&path).parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut file = tempfile::NamedTempFile::new_in(beside)?;
    writeln!(file, "{record:#}")?;
    file.persist(path)?;
    Ok(())
}
