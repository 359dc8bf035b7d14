//! A profile's Gaussians as fewer of them and what stays where it is: for each, a frame pays a level.
//!
//! Sought is the least energy distance (Cramer 1928; Szekely & Rizzo 2013) to the profile, summed over channels: twice the
//! integral of the squared difference between the responses to a straight edge of light. Between mixtures of Gaussians it is
//! closed: E|x - y| = sqrt(2 (v + w) / pi), so that with a the weights of the one and, negative, of the other, it is
//! -sum a_i a_j sqrt(2 (v_i + v_j) / pi).

use super::Gaussian;
use super::fit::{DICTIONARY, choose};
use std::f64::consts::PI;

/// The energy distance between two mixtures along one axis, mm, summed over the channels. Each channel's weights must sum to the
/// same in both.
pub fn distance(one: &[Gaussian], other: &[Gaussian]) -> f64 {
    let signed = || one.iter().map(|g| (g, 1.)).chain(other.iter().map(|g| (g, -1.)));
    let pair = |(a, s): (&Gaussian, f64), (b, t): (&Gaussian, f64)| {
        let weight: f64 = (0..3).map(|c| a.weight[c] * b.weight[c]).sum();
        -s * t * weight * (2. * (a.variance + b.variance) / PI).sqrt()
    };
    signed().map(|a| signed().map(|b| pair(a, b)).sum::<f64>()).sum()
}

/// At most `most` Gaussians no narrower than the first of variance `least` (mm^2) or more, by rising variance, and before them a
/// delta (variance 0) if that takes some of the energy. Each channel's weights sum to what they summed to. Where there are few
/// enough already, they stay as they are.
pub fn fewer(gaussians: &[Gaussian], most: usize, least: f64) -> Vec<Gaussian> {
    let mut sorted: Vec<Gaussian> = gaussians.iter().copied().filter(|g| g.weight.iter().any(|w| *w > 0.)).collect();
    sorted.sort_by(|a, b| a.variance.total_cmp(&b.variance));
    let narrow = sorted.iter().filter(|g| g.variance < least || g.variance == 0.).count();
    let widest = sorted.last().map_or(0., |g| g.variance);
    if most == 0 || sorted.len() - narrow <= most {
        return sorted;
    }
    let low = sorted[narrow].variance;
    let choice: [f64; DICTIONARY] =
        std::array::from_fn(|i| low * (widest / low).powf(i as f64 / (DICTIONARY - 1) as f64));
    let levels = choose(most, |levels| {
        let variances: Vec<f64> = levels.iter().map(|&i| choice[i]).collect();
        (0..3).map(|c| solve(&sorted, c, &variances).1).sum()
    });
    let variances: Vec<f64> = levels.iter().map(|&i| choice[i]).collect();
    let weights: [Vec<f64>; 3] = std::array::from_fn(|c| solve(&sorted, c, &variances).0);
    let places = std::iter::once(0.).chain(variances);
    let all =
        places.enumerate().map(|(i, variance)| Gaussian { variance, weight: std::array::from_fn(|c| weights[c][i]) });
    all.filter(|g| g.weight.iter().any(|w| *w > 0.)).collect()
}

/// The inner product that belongs to the distance, with the delta as its zero.
fn product(v: f64, w: f64) -> f64 {
    v.sqrt() + w.sqrt() - (v + w).sqrt()
}

/// The best weights of a delta and these variances for one channel, none below 0, and what they leave of the distance, but for a
/// constant. Every set of those that are not 0 is tried: they are few.
fn solve(source: &[Gaussian], channel: usize, variances: &[f64]) -> (Vec<f64>, f64) {
    let energy: f64 = source.iter().map(|g| g.weight[channel]).sum();
    let pull: Vec<f64> =
        variances.iter().map(|&v| source.iter().map(|g| g.weight[channel] * product(g.variance, v)).sum()).collect();
    let n = variances.len();
    let mut best = (vec![0.; n + 1], f64::INFINITY);
    best.0[0] = energy;
    for set in 0u32..1 << (n + 1) {
        let held: Vec<usize> = (0..n).filter(|i| set >> (i + 1) & 1 == 1).collect();
        let delta = set & 1 == 1;
        let Some(w) = free(&held, variances, &pull, (!delta).then_some(energy)) else { continue };
        let rest = energy - w.iter().sum::<f64>();
        if w.iter().any(|w| *w < 0.) || delta && rest < 0. || !delta && rest.abs() > 1e-9 * energy {
            continue;
        }
        let mut left = 0.;
        for (k, &i) in held.iter().enumerate() {
            left += w[k]
                * (held.iter().enumerate().map(|(m, &j)| w[m] * product(variances[i], variances[j])).sum::<f64>()
                    - 2. * pull[i]);
        }
        if left < best.1 {
            let mut all = vec![0.; n + 1];
            all[0] = if delta { rest } else { 0. };
            held.iter().zip(&w).for_each(|(&i, w)| all[i + 1] = *w);
            best = (all, left);
        }
    }
    best
}

/// The stationary weights of the variances in `held`, of this sum if one is given: Gaussian elimination with pivots; none
/// where the system is singular.
fn free(held: &[usize], variances: &[f64], pull: &[f64], sum: Option<f64>) -> Option<Vec<f64>> {
    if held.is_empty() {
        return sum.is_none().then(Vec::new);
    }
    let n = held.len() + usize::from(sum.is_some());
    let mut rows = vec![vec![0.; n + 1]; n];
    for (r, &i) in held.iter().enumerate() {
        for (c, &j) in held.iter().enumerate() {
            rows[r][c] = product(variances[i], variances[j]);
        }
        rows[r][n] = pull[i];
        if let Some(sum) = sum {
            (rows[r][n - 1], rows[n - 1][r], rows[n - 1][n]) = (1., 1., sum);
        }
    }
    for k in 0..n {
        let pivot = (k..n).max_by(|&a, &b| rows[a][k].abs().total_cmp(&rows[b][k].abs()))?;
        rows.swap(k, pivot);
        if rows[k][k].abs() < 1e-14 {
            return None;
        }
        let pivot = rows[k].clone();
        for row in rows.iter_mut().enumerate().filter_map(|(r, row)| (r != k).then_some(row)) {
            let f = row[k] / pivot[k];
            row.iter_mut().zip(&pivot).for_each(|(x, p)| *x -= f * p);
        }
    }
    Some((0..held.len()).map(|k| rows[k][n] / rows[k][k]).collect())
}
