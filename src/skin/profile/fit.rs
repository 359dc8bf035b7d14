//! Any profile as a few Gaussians that its three channels share.
//!
//! Fitted is 2 pi r^2 R, the energy per logarithm of radius: over log r every Gaussian has the same form, so one error
//! norm serves every scale. The widths come from a geometric dictionary, first the one that helps most, then the next,
//! then each is exchanged for a better one until none is; the weights by non-negative least squares at every step.

use super::{Gaussian, Profile, Shape};

/// The most Gaussians a fit has, all channels together: as many blur levels as d'Eon & Luebke's skin.
pub const MAX_LEVELS: usize = 6;
/// Widths to choose from.
pub(super) const DICTIONARY: usize = 48;
/// How much a channel's total energy counts beside its form; it is made exact afterwards.
const ENERGY_WEIGHT: f64 = 4.0;
/// Rounds of exchange; three have been enough.
const ROUNDS: usize = 6;

/// A profile as Gaussians.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// At most [`MAX_LEVELS`], by rising variance; in each channel the weights sum to 1.
    pub gaussians: Vec<Gaussian>,
    /// The largest channel's L1 error, Int |2 pi r (R - fit)| dr: 0 is exact, 2 is no overlap at all. Half of it is the
    /// energy that leaves at the wrong distance.
    pub error: f64,
}

/// One channel's least squares problem over the dictionary: minimise w G w - 2 b w, w >= 0.
struct Channel {
    b: [f64; DICTIONARY],
    /// Energy that is no delta.
    energy: f64,
}

pub(super) fn fit(profile: &Profile) -> Fit {
    let delta = delta_energy(profile);
    let supports: [Option<(f64, f64)>; 3] = std::array::from_fn(|c| widths(profile, c));
    let has_delta = delta.iter().any(|&d| d > 0.0);
    let mut gaussians = Vec::with_capacity(MAX_LEVELS);
    if has_delta {
        gaussians.push(Gaussian { variance: 0.0, weight: delta });
    }
    if let Some((low, high)) = span(&supports) {
        let step = (high / low).ln() / (DICTIONARY - 1) as f64;
        let variances: [f64; DICTIONARY] = std::array::from_fn(|i| (low * (step * i as f64).exp()).powi(2));
        let channels: [Channel; 3] =
            std::array::from_fn(|c| Channel::new(profile, c, supports[c], &variances, 1.0 - delta[c]));
        let gram = Gram::new(&variances);
        let cost = |levels: &[usize]| channels.iter().map(|c| c.solve(&gram, levels).1).sum::<f64>();
        let levels = choose(MAX_LEVELS - usize::from(has_delta), cost);
        let weights: [[f64; MAX_LEVELS]; 3] = std::array::from_fn(|c| channels[c].weights(&gram, &levels));
        for (i, &level) in levels.iter().enumerate() {
            let weight = std::array::from_fn(|c| weights[c][i]);
            if weight != [0.0; 3] {
                gaussians.push(Gaussian { variance: variances[level], weight });
            }
        }
    }
    Fit { error: l1_error(profile, &supports, &gaussians), gaussians }
}

/// The share of each channel that leaves exactly where it entered.
fn delta_energy(profile: &Profile) -> [f64; 3] {
    match &profile.shape {
        Shape::Gaussians(list) => {
            std::array::from_fn(|c| list.iter().filter(|g| g.variance == 0.0).map(|g| g.weight[c]).sum())
        }
        Shape::Burley { d } => d.map(|d| if d == 0.0 { 1.0 } else { 0.0 }),
    }
}

/// The standard deviations, mm, between which a channel's Gaussians are sought; none for a delta.
fn widths(profile: &Profile, channel: usize) -> Option<(f64, f64)> {
    match &profile.shape {
        Shape::Gaussians(list) => {
            let used =
                || list.iter().filter(|g| g.variance > 0.0 && g.weight[channel] > 0.0).map(|g| g.variance.sqrt());
            let low = used().fold(f64::INFINITY, f64::min);
            low.is_finite().then(|| (low, used().fold(0.0, f64::max)))
        }
        // Below .04 d lies 1 % of the energy; 4.5 d is the tail's own slope at its last percent.
        Shape::Burley { d } => (d[channel] > 0.0).then_some((0.04 * d[channel], 4.5 * d[channel])),
    }
}

/// From the least to the greatest of the channels' widths.
fn span(supports: &[Option<(f64, f64)>; 3]) -> Option<(f64, f64)> {
    supports.iter().flatten().copied().reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
}

/// Int f(r) dr/r over all radii where Gaussians of these widths have any energy: the trapezoid rule over log r.
fn over_log_radius((low, high): (f64, f64), step: f64, mut f: impl FnMut(f64) -> f64) -> f64 {
    let (from, to) = ((1e-4 * low).ln(), (14.0 * high).ln());
    let steps = ((to - from) / step).ceil() as usize;
    (0..=steps).map(|i| f((from + step * i as f64).exp())).sum::<f64>() * step
}

/// 2 pi r^2 exp(-r^2/2v) / (2 pi v).
fn atom(variance: f64, r: f64) -> f64 {
    let q = r * (r / variance);
    q * (-0.5 * q).exp()
}

/// 2 pi r^2 R(r) of one channel, its delta left out.
fn energy_per_log_radius(profile: &Profile, channel: usize, r: f64) -> f64 {
    match &profile.shape {
        Shape::Gaussians(list) => {
            let wide = list.iter().filter(|g| g.variance > 0.0);
            wide.map(|g| g.weight[channel] * atom(g.variance, r)).sum()
        }
        Shape::Burley { d } => {
            let u = r / d[channel];
            if u.is_finite() { 0.25 * u * ((-u).exp() + (-u / 3.0).exp()) } else { 0.0 }
        }
    }
}

/// The largest channel's L1 error, over all radii that any channel reaches: a fit may spill energy into another's.
fn l1_error(profile: &Profile, supports: &[Option<(f64, f64)>; 3], gaussians: &[Gaussian]) -> f64 {
    let Some(span) = span(supports) else { return 0.0 };
    let wide = || gaussians.iter().filter(|g| g.variance > 0.0);
    let error = |c: usize| {
        over_log_radius(span, 0.02, |r| {
            let fitted: f64 = wide().map(|g| g.weight[c] * atom(g.variance, r)).sum();
            (energy_per_log_radius(profile, c, r) - fitted).abs()
        })
    };
    (0..3).map(error).fold(0.0, f64::max)
}

/// The dictionary's inner products, 2 v w / (v + w)^2, and the pull towards the right energy.
struct Gram(Vec<[f64; DICTIONARY]>);

impl Gram {
    fn new(variances: &[f64; DICTIONARY]) -> Gram {
        let product = |v: f64, w: f64| 2.0 / ((1.0 + v / w) * (1.0 + w / v)) + ENERGY_WEIGHT;
        Gram(variances.iter().map(|&v| variances.map(|w| product(v, w))).collect())
    }
}

impl Channel {
    fn new(
        profile: &Profile,
        channel: usize,
        support: Option<(f64, f64)>,
        variances: &[f64; DICTIONARY],
        energy: f64,
    ) -> Channel {
        let b = variances.map(|v| match support {
            Some(support) => {
                let product = |r| energy_per_log_radius(profile, channel, r) * atom(v, r);
                over_log_radius(support, 0.2, product) + ENERGY_WEIGHT * energy
            }
            None => 0.0,
        });
        Channel { b, energy }
    }

    /// Non-negative weights of these levels, and the objective they reach (Lawson & Hanson 1974, chapter 23).
    fn solve(&self, gram: &Gram, levels: &[usize]) -> ([f64; MAX_LEVELS], f64) {
        let n = levels.len();
        let mut w = [0.0; MAX_LEVELS];
        let mut free = [false; MAX_LEVELS];
        // Each level enters at most a few times; the bound only guards against a cycle of rounding errors.
        for _ in 0..3 * MAX_LEVELS {
            let gradient =
                |i: usize| self.b[levels[i]] - (0..n).map(|j| gram.0[levels[i]][levels[j]] * w[j]).sum::<f64>();
            let best = (0..n).filter(|&i| !free[i]).map(|i| (gradient(i), i)).max_by(|a, b| a.0.total_cmp(&b.0));
            match best {
                Some((gain, i)) if gain > 1e-12 => free[i] = true,
                _ => break,
            }
            loop {
                let target = self.solve_free(gram, levels, &free);
                if (0..n).all(|i| !free[i] || target[i] > 0.0) {
                    w = target;
                    break;
                }
                // Walk towards the unconstrained optimum until the first weight reaches 0, and hold that one there.
                let stop =
                    |i: usize| if free[i] && target[i] <= 0.0 { w[i] / (w[i] - target[i]) } else { f64::INFINITY };
                let alpha = (0..n).map(stop).fold(1.0, f64::min);
                let held = (0..n).filter(|&i| free[i] && target[i] <= 0.0).min_by(|&i, &j| stop(i).total_cmp(&stop(j)));
                (0..n).for_each(|i| w[i] += alpha * (target[i] - w[i]));
                if let Some(i) = held {
                    (w[i], free[i]) = (0.0, false);
                }
            }
        }
        let row = |i: usize| (0..n).map(|j| gram.0[levels[i]][levels[j]] * w[j]).sum::<f64>();
        (w, (0..n).map(|i| w[i] * (row(i) - 2.0 * self.b[levels[i]])).sum())
    }

    /// The least squares solution in the free weights, the others 0: Cholesky, skipping what is held.
    fn solve_free(&self, gram: &Gram, levels: &[usize], free: &[bool; MAX_LEVELS]) -> [f64; MAX_LEVELS] {
        let n = levels.len();
        let mut factor = [[0.0; MAX_LEVELS]; MAX_LEVELS];
        let mut x = [0.0; MAX_LEVELS];
        for i in (0..n).filter(|&i| free[i]) {
            let mut rest = self.b[levels[i]];
            for j in (0..=i).filter(|&j| free[j]) {
                let inner: f64 = (0..j).map(|k| factor[i][k] * factor[j][k]).sum();
                let left = gram.0[levels[i]][levels[j]] - inner;
                factor[i][j] = if i == j { left.max(1e-14).sqrt() } else { left / factor[j][j] };
                if j < i {
                    rest -= factor[i][j] * x[j];
                }
            }
            x[i] = rest / factor[i][i];
        }
        for i in (0..n).rev().filter(|&i| free[i]) {
            let above: f64 = (i + 1..n).map(|j| factor[j][i] * x[j]).sum();
            x[i] = (x[i] - above) / factor[i][i];
        }
        x
    }

    /// The weights, made to hold exactly this channel's energy.
    fn weights(&self, gram: &Gram, levels: &[usize]) -> [f64; MAX_LEVELS] {
        let (w, _) = self.solve(gram, levels);
        let sum: f64 = w.iter().sum();
        w.map(|w| if sum > 0.0 { w * self.energy / sum } else { 0.0 })
    }
}

/// The dictionary's entries of least cost, `most` of them at most, in rising order: first the one that helps most, then the next,
/// then each is exchanged for a better one until none is.
pub(super) fn choose(most: usize, cost: impl Fn(&[usize]) -> f64) -> Vec<usize> {
    let mut levels: Vec<usize> = Vec::with_capacity(most);
    let mut reached = 0.0;
    for _ in 0..most {
        levels.push(0);
        let last = levels.len() - 1;
        reached = exchange(&mut levels, last, f64::INFINITY, &cost);
    }
    for _ in 0..ROUNDS {
        let before = reached;
        for i in 0..levels.len() {
            reached = exchange(&mut levels, i, reached, &cost);
        }
        if reached >= before - 1e-12 {
            break;
        }
    }
    levels.sort_unstable();
    levels.dedup();
    levels
}

/// Puts the best entry of the dictionary in place `i`; returns the cost then, `reached` if nothing beats it.
fn exchange(levels: &mut [usize], i: usize, mut reached: f64, cost: &impl Fn(&[usize]) -> f64) -> f64 {
    let mut best = levels[i];
    for entry in 0..DICTIONARY {
        if levels.iter().enumerate().any(|(j, &l)| j != i && l == entry) {
            continue;
        }
        levels[i] = entry;
        let now = cost(levels);
        if now < reached {
            (reached, best) = (now, entry);
        }
    }
    levels[i] = best;
    reached
}
