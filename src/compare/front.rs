//! Who is best at what: the Pareto front of frame time and error, and what the best screen-space rival does at equal error
//! and at equal time.

use super::cell::Cell;
use serde::{Deserialize, Serialize};

/// Methods of this project, which are held against the rivals.
pub const OURS: [&str; 2] = ["pdss", "moments"];
/// Methods that blur irradiance in screen space.
pub const RIVALS: [&str; 3] = ["gaussians", "separable", "burley"];

/// A rival's setting, and how ours stands to it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Rival {
    /// Its method.
    pub method: String,
    /// Its quality.
    pub quality: String,
    /// Ours over its: of time at equal error, of error at equal time.
    pub ratio: f64,
}

/// What follows for a cell from the others of its scene.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Standing {
    /// No other cell of the scene is at least as fast and as right, and better in one.
    pub front: bool,
    /// The rival with an error of at most ours that spends least time on scattering; the ratio is of those times. None: no
    /// rival is as right.
    pub at_error: Option<Rival>,
    /// The rightest rival that spends no more time on scattering; the ratio is of errors. None: no rival is as fast.
    pub at_time: Option<Rival>,
}

/// The standing of each cell, in order.
pub fn standing(cells: &[Cell]) -> Vec<Standing> {
    cells.iter().map(|cell| of(cell, cells)).collect()
}

fn of(cell: &Cell, cells: &[Cell]) -> Standing {
    let scene = |c: &&Cell| c.scene == cell.scene && c.sweep == cell.sweep && c.sweep_value == cell.sweep_value;
    let (Some(own), Some((spent, error))) = (cell.point(), cell.scatter_point()) else { return Standing::default() };
    let front = !cells.iter().filter(scene).filter_map(Cell::point).any(|p| dominates(p, own));
    if !OURS.contains(&cell.method.as_str()) {
        return Standing { front, ..Standing::default() };
    }
    let rivals = || {
        let known = cells.iter().filter(scene).filter(|c| RIVALS.contains(&c.method.as_str()));
        known.filter_map(|c| Some((c, c.scatter_point()?)))
    };
    let named = |c: &Cell, ratio: f64| Rival { method: c.method.clone(), quality: c.quality.clone(), ratio };
    let as_right = rivals().filter(|(_, (_, e))| *e <= error).min_by(|a, b| a.1.0.total_cmp(&b.1.0));
    let as_fast = rivals().filter(|(_, (t, _))| *t <= spent).min_by(|a, b| a.1.1.total_cmp(&b.1.1));
    Standing {
        front,
        // What spends nothing that can be measured has no ratio.
        at_error: as_right.filter(|(_, (t, _))| *t > 0. && spent > 0.).map(|(c, (t, _))| named(c, spent / t)),
        at_time: as_fast.filter(|(_, (_, e))| *e > 0.).map(|(c, (_, e))| named(c, error / e)),
    }
}

/// `a` is at least as good as `b` in both, and better in one.
fn dominates(a: (f64, f64), b: (f64, f64)) -> bool {
    a.0 <= b.0 && a.1 <= b.1 && a != b
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::compare::cell::{Errors, Times};
    use crate::report::stats::Summary;

    /// A cell of known time and error; `lambert` takes 20 ms.
    pub(in crate::compare) fn cell(
        scene: &str,
        method: (usize, &str),
        quality: (usize, &str),
        ms: f64,
        rmse: f64,
    ) -> Cell {
        let one = |ms: f64| Summary { median: ms, p5: ms, p95: ms, min: ms, mad: 0., n: 3, dropped: 0 };
        let (error, time) = (
            Errors {
                covered: 0.25,
                rmse,
                rmse_rgb: [rmse; 3],
                rel_mse: rmse * rmse,
                psnr_db: Some(40.),
                p99: 3. * rmse,
                max: 9. * rmse,
                bias: -0.1 * rmse,
                flip: 2. * rmse,
                bands: vec![("silhouette".to_owned(), 9, 2. * rmse), ("terminator".to_owned(), 0, 0.)],
                left_out: 0,
                truth_rms: 1e-4,
                truth_key: "0".to_owned(),
            },
            Times {
                wall_ms: one(ms),
                gpu_ms: None,
                scatter_ms: one(ms - 20.),
                prepare_ms: [1.; 4],
                warmup: 3,
                interleaved: 4,
                wall_samples_ms: vec![vec![ms; 3]],
                gpu_samples_ms: Vec::new(),
            },
        );
        Cell {
            scene: scene.to_owned(),
            why: "a test".to_owned(),
            sweep: None,
            sweep_value: None,
            method: method.1.to_owned(),
            quality: quality.1.to_owned(),
            order: [0, method.0, quality.0],
            size: [64, 48],
            error_size: [64, 48],
            triangles: 12,
            lights: 1,
            key: format!("{scene}{}{}", method.1, quality.1),
            refused: None,
            error: Some(error),
            time: Some(time),
            memory: Some([1 << 20, 1 << 21]),
            passes: Some(5),
        }
    }

    /// Two scenes, one cell refused.
    pub(in crate::compare) fn results() -> crate::compare::store::Results {
        let mut cells = vec![
            cell("a", (0, "lambert"), (0, "low"), 20., 0.02),
            cell("a", (1, "moments"), (0, "low"), 30., 0.01),
            cell("a", (1, "moments"), (1, "medium"), 50., 0.008),
            cell("a", (2, "burley"), (0, "low"), 50., 0.015),
            cell("a", (3, "texture-space"), (0, "low"), 50., 0.015),
            cell("b", (0, "lambert"), (0, "low"), 20., 0.02),
        ];
        cells[4] = Cell { refused: Some("no coordinates".to_owned()), error: None, time: None, ..cells[4].clone() };
        cells[5].order[0] = 1;
        let context = crate::compare::store::Context {
            device: "card 4090".to_owned(),
            driver: "driver 1, <new>".to_owned(),
            device_kind: "discrete".to_owned(),
            host: "a processor, 2 threads".to_owned(),
            code: "build 0".to_owned(),
            version: "1".to_owned(),
            profile: "skin".to_owned(),
            material: None,
            size: [64, 48],
            error_size: [64, 48],
            effort: (1000, 0.001, 0.1),
            plan: crate::compare::timing::Plan { rounds: 2, frames: 3, warmup: None },
            validation: false,
            clock: "wall".to_owned(),
        };
        crate::compare::store::Results::new(context, cells)
    }

    #[test]
    fn the_front_and_the_rivals_are_who_they_should_be() {
        let cells = [
            cell("a", (0, "lambert"), (0, "low"), 20., 0.02),
            cell("a", (1, "moments"), (0, "low"), 30., 0.01),
            cell("a", (1, "moments"), (1, "medium"), 50., 0.012),
            cell("a", (2, "burley"), (0, "low"), 50., 0.015),
            cell("a", (2, "burley"), (1, "medium"), 80., 0.009),
            // Another scene's rival is nobody's here.
            cell("b", (2, "burley"), (0, "low"), 21., 0.001),
        ];
        let s = standing(&cells);
        assert_eq!(s.iter().map(|s| s.front).collect::<Vec<_>>(), [true, true, false, false, true, true]);
        let at_error = s[1].at_error.as_ref().map(|r| (r.quality.as_str(), r.ratio));
        assert_eq!(at_error, Some(("medium", 10. / 60.)), "10 ms against the 60 ms of the first that is as right");
        assert_eq!(s[1].at_time, None, "no rival spends 10 ms or less");
        let at_time = s[2].at_time.as_ref().map(|r| (r.quality.as_str(), r.ratio));
        assert_eq!(at_time, Some(("low", 0.012 / 0.015)));
        assert!(s[3].at_error.is_none() && s[3].at_time.is_none(), "rivals are not their own rivals");
    }

    #[test]
    fn equals_do_not_push_each_other_off_the_front() {
        assert!(!dominates((1., 1.), (1., 1.)));
        assert!(dominates((1., 1.), (1., 2.)) && !dominates((1., 2.), (2., 1.)));
    }
}
