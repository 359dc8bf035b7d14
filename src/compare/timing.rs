//! Times that can be held against each other: cells take turns, round after round, so that a slow minute is everybody's.

use super::cell::Times;
use crate::frame::{FrameError, Inputs, Renderer};
use crate::gpu::Gpu;
use crate::report::measure::{self, Samples, Warmup};
use crate::report::stats::Summary;
use std::sync::Arc;

/// Device memory that the frames of one group may take, bytes; more is split into smaller groups.
pub const BUDGET: u64 = 1 << 30;

/// How often.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Plan {
    /// Turns of each cell.
    pub rounds: usize,
    /// Samples a turn.
    pub frames: usize,
    /// Frames before the first turn; none: until the median has settled.
    pub warmup: Option<usize>,
}

/// A cell as grouping sees it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Weight {
    /// Cells of one quality have one floor.
    pub quality: usize,
    /// It is the floor: `lambert`.
    pub floor: bool,
    /// Device memory, bytes.
    pub bytes: u64,
}

/// Splits cells into groups that fit the budget, each with the floor of every quality in it: all together; else a group a
/// quality; else as many methods of a quality as fit.
pub fn groups(cells: &[Weight], budget: u64) -> Vec<Vec<usize>> {
    let bytes = |group: &[usize]| group.iter().map(|i| cells[*i].bytes).sum::<u64>();
    let all: Vec<usize> = (0..cells.len()).collect();
    if bytes(&all) <= budget {
        return if all.is_empty() { Vec::new() } else { vec![all] };
    }
    let mut qualities: Vec<usize> = cells.iter().map(|c| c.quality).collect();
    qualities.sort_unstable();
    qualities.dedup();
    let mut groups = Vec::new();
    for quality in qualities {
        let floors: Vec<usize> =
            all.iter().copied().filter(|i| cells[*i].quality == quality && cells[*i].floor).collect();
        let mut group = floors.clone();
        for i in all.iter().copied().filter(|i| cells[*i].quality == quality && !cells[*i].floor) {
            if group.len() > floors.len() && bytes(&group) + cells[i].bytes > budget {
                groups.push(std::mem::replace(&mut group, floors.clone()));
            }
            group.push(i);
        }
        groups.push(group);
    }
    groups
}

/// One cell at its turn.
struct Runner {
    renderer: Renderer,
    floor: usize,
    warmup: usize,
    samples: Vec<Samples>,
}

/// Times a group. `floors` says for each cell which one's time is that of not scattering. `progress` hears of turns done
/// and all turns.
///
/// # Errors
/// Those of the frame.
pub fn time(
    gpu: &Arc<Gpu>,
    group: Vec<Inputs<'_>>,
    floors: &[usize],
    plan: Plan,
    mut progress: impl FnMut(usize, usize),
) -> Result<Vec<Times>, FrameError> {
    let mut runners = Vec::with_capacity(group.len());
    let turns = group.len() * (plan.rounds + 1);
    let warmup = plan.warmup.map_or(Warmup::Settle, Warmup::Exactly);
    for (inputs, floor) in group.into_iter().zip(floors) {
        progress(runners.len(), turns);
        let mut renderer = Renderer::new(gpu, inputs)?;
        let (warmed, _) = measure::measure(&mut renderer, warmup, 0, |_, _| {})?;
        runners.push(Runner { renderer, floor: *floor, warmup: warmed.frames, samples: Vec::new() });
    }
    for round in 0..plan.rounds {
        for turn in 0..runners.len() {
            progress(runners.len() * (round + 1) + turn, turns);
            // Another cell leads each round: whoever follows a heavy frame is not always the same.
            let at = (turn + round) % runners.len();
            let runner = &mut runners[at];
            // The first frame after another's finds its caches cold.
            let (_, samples) = measure::measure(&mut runner.renderer, Warmup::Exactly(1), plan.frames, |_, _| {})?;
            runner.samples.push(samples);
        }
    }
    Ok((0..runners.len()).filter_map(|i| describe(&runners, i)).collect())
}

fn describe(runners: &[Runner], index: usize) -> Option<Times> {
    let runner = &runners[index];
    let wall: Vec<Vec<f64>> = runner.samples.iter().map(|s| s.wall_ms.clone()).collect();
    let gpu: Vec<Vec<Option<f64>>> = runner.samples.iter().map(Samples::gpu_ms).collect();
    let gpu_ms = Summary::of(&gpu.concat());
    let over = |r: &Runner| -> Vec<Option<f64>> {
        let clock = |s: &Samples| {
            if gpu_ms.is_some() { s.gpu_ms() } else { s.wall_ms.iter().copied().map(Some).collect() }
        };
        r.samples.iter().map(|s| Summary::of(&clock(s)).map(|s| s.median)).collect()
    };
    let cpu = runner.renderer.cpu_times();
    Some(Times {
        wall_ms: Summary::of(&wall.concat().into_iter().map(Some).collect::<Vec<_>>())?,
        gpu_ms,
        scatter_ms: beyond(&over(runner), &over(&runners[runner.floor]))?,
        prepare_ms: [cpu.plan_ms, cpu.pipelines_ms, cpu.upload_ms, cpu.record_ms],
        warmup: runner.warmup,
        interleaved: runners.len(),
        gpu_samples_ms: if gpu_ms.is_some() {
            gpu.iter().map(|r| r.iter().flatten().copied().collect()).collect()
        } else {
            Vec::new()
        },
        wall_samples_ms: wall,
    })
}

/// The differences of two series, round by round, described.
fn beyond(times: &[Option<f64>], floor: &[Option<f64>]) -> Option<Summary> {
    Summary::of(&times.iter().zip(floor).map(|(t, f)| Some((*t)? - (*f)?)).collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cells(bytes: u64) -> Vec<Weight> {
        // Two qualities of four methods, the first the floor.
        (0..8).map(|i| Weight { quality: i % 2, floor: i < 2, bytes }).collect()
    }

    #[test]
    fn groups_fit_and_never_lack_their_floor() {
        assert_eq!(groups(&cells(1), 8), vec![(0..8).collect::<Vec<_>>()]);
        assert_eq!(groups(&cells(2), 8), vec![vec![0, 2, 4, 6], vec![1, 3, 5, 7]]);
        assert_eq!(groups(&cells(4), 12), vec![vec![0, 2, 4], vec![0, 6], vec![1, 3, 5], vec![1, 7]]);
        assert_eq!(groups(&cells(100), 1).len(), 6, "what does not fit at all still runs, two at a time");
        assert!(groups(&[], 1).is_empty());
    }

    #[test]
    fn a_slow_minute_is_not_taken_for_scattering() {
        let times = |x: [f64; 5]| x.map(Some).to_vec();
        // The third round ran at half speed.
        let (method, floor) = (times([30., 31., 60., 30., 29.]), times([20., 20., 40., 20., 20.]));
        let apart = beyond(&method, &floor).map(|s| s.median);
        assert_eq!(apart, Some(10.));
        // The twin: rounds paired wrongly show it.
        let shifted = [&floor[2..], &floor[..2]].concat();
        assert!(beyond(&method, &shifted).is_some_and(|s| s.mad > 0. && s.p5 < 0.));
    }
}
