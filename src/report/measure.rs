//! Running a frame often enough to say how long it takes.

use super::stats;
use crate::frame::{FrameError, Renderer};
use std::time::{Duration, Instant};

/// Frames whose medians are compared to see whether the clocks have settled.
const WINDOW: usize = 5;
/// Two windows whose medians differ by less than this part have settled.
const TOLERANCE: f64 = 0.02;
/// Warming up ends here, settled or not.
const MOST_FRAMES: usize = 100;
/// And here.
const LONGEST: Duration = Duration::from_secs(10);

/// How long to warm up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Warmup {
    /// Exactly this many frames.
    Exactly(usize),
    /// Until the median has settled, five frames at least, a hundred frames or ten seconds at most.
    Settle,
}

/// What the warm-up came to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Warmed {
    /// Frames run.
    pub frames: usize,
    /// The median had settled; none where nobody looked.
    pub settled: Option<bool>,
}

/// Every sample of a run, ms.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
pub struct Samples {
    /// Each frame from before its submit to after its fence, on the host's clock.
    pub wall_ms: Vec<f64>,
    /// Each pass in each frame on the device's clock; none where a stamp was not available.
    pub stages: Vec<StageSamples>,
}

/// The samples of one pass, one a frame.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct StageSamples {
    /// Name of the pass.
    pub name: String,
    /// ms.
    pub gpu_ms: Vec<Option<f64>>,
}

impl Samples {
    /// First stamp to last in each frame: neighbouring passes share a stamp, so this is their sum. None in a frame that
    /// lacks a stamp.
    pub fn gpu_ms(&self) -> Vec<Option<f64>> {
        let frame = |i: usize| self.stages.iter().map(|s| s.gpu_ms.get(i).copied().flatten()).sum::<Option<f64>>();
        let timed = !self.stages.is_empty();
        (0..self.wall_ms.len()).map(|i| frame(i).filter(|_| timed)).collect()
    }

    /// Adds a frame. A pass that earlier frames did not have starts with as many holes.
    fn push(&mut self, wall: Duration, times: Vec<(String, Option<f64>)>) {
        let before = self.wall_ms.len();
        self.wall_ms.push(wall.as_secs_f64() * 1e3);
        for (index, (name, ns)) in times.into_iter().enumerate() {
            if index == self.stages.len() {
                self.stages.push(StageSamples { name, gpu_ms: vec![None; before] });
            }
            self.stages[index].gpu_ms.push(ns.map(|ns| ns * 1e-6));
        }
    }
}

/// Warms a renderer up, then takes samples of `frames` frames. `progress` is told the frames done and those to come; 0
/// to come means warming up with no known end.
///
/// # Errors
/// Those of the frame.
pub fn measure(
    renderer: &mut Renderer,
    warmup: Warmup,
    frames: usize,
    mut progress: impl FnMut(usize, usize),
) -> Result<(Warmed, Samples), FrameError> {
    let wall = |renderer: &mut Renderer| -> Result<Duration, FrameError> {
        let start = Instant::now();
        renderer.run()?;
        Ok(start.elapsed())
    };
    let mut done = 0;
    let warmed = warm(warmup, LONGEST, || {
        progress(done, 0);
        done += 1;
        wall(renderer)
    })?;
    let mut samples = Samples::default();
    for frame in 0..frames {
        progress(frame, frames);
        let time = wall(renderer)?;
        samples.push(time, renderer.times()?);
    }
    Ok((warmed, samples))
}

/// Runs frames until there have been enough of them.
fn warm<E>(warmup: Warmup, longest: Duration, mut frame: impl FnMut() -> Result<Duration, E>) -> Result<Warmed, E> {
    let mut times = Vec::new();
    let mut total = Duration::ZERO;
    loop {
        let settled = stats::settled(&times, WINDOW, TOLERANCE);
        match warmup {
            Warmup::Exactly(n) if times.len() >= n => return Ok(Warmed { frames: n, settled: None }),
            Warmup::Settle if settled || times.len() >= MOST_FRAMES || times.len() >= WINDOW && total >= longest => {
                return Ok(Warmed { frames: times.len(), settled: Some(settled) });
            }
            _ => {}
        }
        let time = frame()?;
        total += time;
        times.push(time.as_secs_f64());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(warmup: Warmup, time_ms: impl Fn(u64) -> u64) -> Warmed {
        let mut frame = 0;
        let warmed = warm::<()>(warmup, LONGEST, || {
            frame += 1;
            Ok(Duration::from_millis(time_ms(frame - 1)))
        });
        warmed.unwrap_or(Warmed { frames: usize::MAX, settled: None })
    }

    #[test]
    fn warms_until_the_clock_is_steady() {
        let steady = run(Warmup::Settle, |_| 5);
        assert_eq!(steady, Warmed { frames: 10, settled: Some(true) });
        // Slow for 20 frames, falling all the while: a fixed count of ten would have measured the fall.
        let cold = run(Warmup::Settle, |i| 10 + 2 * 20u64.saturating_sub(i));
        assert!(cold.frames > 25 && cold.settled == Some(true), "{cold:?}");
    }

    #[test]
    fn gives_up_on_a_clock_that_never_settles() {
        assert_eq!(run(Warmup::Settle, |i| 1 + i * i), Warmed { frames: 32, settled: Some(false) }, "ten seconds");
        assert_eq!(run(Warmup::Settle, |i| 1 + i).frames, MOST_FRAMES.min(141));
    }

    #[test]
    fn an_exact_count_is_exact() {
        assert_eq!(run(Warmup::Exactly(0), |_| 5), Warmed { frames: 0, settled: None });
        assert_eq!(run(Warmup::Exactly(3), |i| 9 - i), Warmed { frames: 3, settled: None });
    }

    #[test]
    fn a_frame_without_all_its_stamps_has_no_time() {
        let mut s = Samples::default();
        let pass = |name: &str, ns: Option<f64>| (name.to_owned(), ns);
        s.push(Duration::from_millis(4), vec![pass("a", Some(1e6)), pass("b", Some(2e6))]);
        s.push(Duration::from_millis(4), vec![pass("a", Some(1e6)), pass("b", None)]);
        assert_eq!(s.gpu_ms(), vec![Some(3.), None]);
        let untimed = Samples { wall_ms: vec![1.], stages: Vec::new() };
        assert_eq!(untimed.gpu_ms(), vec![None], "no stamps are not no time");
    }
}
