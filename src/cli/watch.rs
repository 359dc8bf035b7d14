//! Where the time from the start to the picture goes, for `render -v`.

use std::time::Instant;

/// Where the time from the start to the picture goes.
pub struct Watch {
    since: Instant,
    laps: Vec<(&'static str, f64)>,
}

impl Default for Watch {
    fn default() -> Self {
        Watch { since: Instant::now(), laps: Vec::new() }
    }
}

impl Watch {
    /// Notes the time since the lap before.
    pub fn lap(&mut self, name: &'static str) {
        self.laps.push((name, self.since.elapsed().as_secs_f64() * 1e3));
        self.start();
    }

    /// Notes laps that somebody else has timed, ms; the next begins now.
    pub fn known(&mut self, laps: impl IntoIterator<Item = (&'static str, f64)>) {
        self.laps.extend(laps);
        self.start();
    }

    /// The next lap begins now.
    pub fn start(&mut self) {
        self.since = Instant::now();
    }

    /// All laps.
    pub fn words(&self) -> String {
        let laps: Vec<String> = self.laps.iter().map(|(name, ms)| format!("{name} {ms:.1}")).collect();
        let all: f64 = self.laps.iter().map(|l| l.1).sum();
        format!("ms: {}; {all:.1} in all", laps.join(", "))
    }
}
