//! Which cells stand side by side: at equal time, at equal error, at one quality.

use super::cell::Cell;
use super::store::Results;

/// Times and errors this much above count as equal.
const EQUAL: f64 = 1.05;

/// The cell that others are held against: ours at medium quality, else any of ours, else any that was measured.
pub fn reference(results: &Results, scene: &[usize]) -> Option<usize> {
    let measured: Vec<usize> = scene.iter().copied().filter(|r| results.cells[*r].point().is_some()).collect();
    let find = |test: &dyn Fn(&Cell) -> bool| measured.iter().rev().copied().find(|r| test(&results.cells[*r]));
    find(&|c| c.method == "moments" && c.quality == "medium")
        .or_else(|| find(&|c| super::front::OURS.contains(&c.method.as_str())))
        .or_else(|| measured.last().copied())
}

/// Methods of a scene in order, each with its measured rows.
fn methods(results: &Results, scene: &[usize]) -> Vec<Vec<usize>> {
    let mut methods: Vec<Vec<usize>> = Vec::new();
    for &row in scene.iter().filter(|r| results.cells[**r].point().is_some()) {
        match methods.iter_mut().find(|m| results.cells[m[0]].method == results.cells[row].method) {
            Some(method) => method.push(row),
            None => methods.push(vec![row]),
        }
    }
    methods
}

/// For each method the least `by` among the rows with `within`; where none is, the least by the other, and false.
fn least(
    results: &Results,
    scene: &[usize],
    within: impl Fn((f64, f64)) -> bool,
    by: impl Fn((f64, f64)) -> f64,
    else_by: impl Fn((f64, f64)) -> f64,
) -> Vec<(usize, bool)> {
    let point = |row: &usize| results.cells[*row].point().unwrap_or((f64::MAX, f64::MAX));
    let choose = |rows: Vec<usize>| {
        let hit =
            rows.iter().copied().filter(|r| within(point(r))).min_by(|a, b| by(point(a)).total_cmp(&by(point(b))));
        let miss = || rows.iter().copied().min_by(|a, b| else_by(point(a)).total_cmp(&else_by(point(b))));
        hit.map(|r| (r, true)).or_else(|| miss().map(|r| (r, false)))
    };
    methods(results, scene).into_iter().filter_map(choose).collect()
}

/// Of each method the rightest setting that is as fast as `own`; else its fastest, and false.
pub fn at_equal_time(results: &Results, scene: &[usize], own: usize) -> Vec<(usize, bool)> {
    let limit = results.cells[own].point().map_or(0., |p| p.0 * EQUAL);
    least(results, scene, |p| p.0 <= limit, |p| p.1, |p| p.0)
}

/// Of each method the fastest setting that is as right as `own`; else its rightest, and false.
pub fn at_equal_error(results: &Results, scene: &[usize], own: usize) -> Vec<(usize, bool)> {
    let limit = results.cells[own].point().map_or(0., |p| p.1 * EQUAL);
    least(results, scene, |p| p.1 <= limit, |p| p.0, |p| p.1)
}

/// Each method at the quality of `own`, else at its first.
pub fn qualities_alike(results: &Results, scene: &[usize], own: usize) -> Vec<usize> {
    let alike = |row: &usize| results.cells[*row].quality == results.cells[own].quality;
    methods(results, scene)
        .into_iter()
        .filter_map(|m| m.iter().copied().find(alike).or_else(|| m.first().copied()))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::front::tests::results;

    #[test]
    fn equals_are_chosen_and_misses_are_said() {
        let results = results();
        let scene: Vec<usize> = (0..5).collect();
        assert_eq!(reference(&results, &scene), Some(2), "moments at medium: 50 ms, 0.008");
        // lambert low, moments medium, burley low; texture-space was refused.
        assert_eq!(at_equal_time(&results, &scene, 2), [(0, true), (2, true), (3, true)]);
        assert_eq!(
            at_equal_time(&results, &scene, 1),
            [(0, true), (1, true), (3, false)],
            "burley takes 50 ms, not 30"
        );
        assert_eq!(
            at_equal_error(&results, &scene, 1),
            [(0, false), (1, true), (3, false)],
            "0.01 is out of reach of two"
        );
        assert_eq!(qualities_alike(&results, &scene, 2), [0, 2, 3]);
    }
}
