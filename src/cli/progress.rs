//! A line on a terminal that is written over; nothing in a pipe.

use std::io::{self, IsTerminal, Write};
use std::sync::Mutex;

/// The line.
pub struct Progress {
    last: Option<Mutex<String>>,
}

impl Progress {
    /// Shown only where stderr is a terminal.
    pub fn new() -> Self {
        Self { last: io::stderr().is_terminal().then(|| Mutex::new(String::new())) }
    }

    /// Shows a text in place of the one before.
    pub fn show(&self, text: &str) {
        let Some(last) = &self.last else { return };
        // Somebody else is already saying so.
        let Ok(mut last) = last.try_lock() else { return };
        if *last != text {
            text.clone_into(&mut last);
            // Carriage return and "erase the line"; a terminal that is gone is no fault.
            let _ = write!(io::stderr(), "\r\x1b[2K{text}").and_then(|()| io::stderr().flush());
        }
    }
}

impl Drop for Progress {
    /// What comes next, an error too, starts on a clean line.
    fn drop(&mut self) {
        if self.last.is_some() {
            let _ = write!(io::stderr(), "\r\x1b[2K").and_then(|()| io::stderr().flush());
        }
    }
}
