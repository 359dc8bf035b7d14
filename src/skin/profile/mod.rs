//! Diffusion profiles: R(r), the exitance at distance r from a point of unit flux, per channel.
//!
//! Every profile is normalised: the integral of 2 pi r R(r) is 1 in each channel. The diffuse albedo is kept apart and
//! applied elsewhere, so that all methods share one.
//!
//! # The file format
//!
//! TOML, with exactly one of three shapes; unknown keys, negative numbers, NaN and infinities are errors.
//!
//! ```toml
//! name = "my wax"              # optional: else the file's stem
//! source = "author year, page" # optional
//! ior = 1.4                    # optional: else 1.4; gives F0 .028 to materials that say nothing of their own
//! albedo = [0.8, 0.6, 0.5]     # optional, except with the third shape
//! # Optional: gloss of two lobes. Factors on the material's roughness, each 0.1..4, and the second lobe's share, 0..1.
//! specular = { roughness = [0.75, 1.3], mix = 0.15 }
//!
//! # 1. Gaussians exp(-r^2/2v)/(2 pi v). Weights that do not sum to 1 in a channel are scaled to.
//! gaussians = [{ variance_mm2 = 0.2, weight = [0.4, 1.0, 1.0] }, { variance_mm2 = 2.0, weight = [0.6, 0.0, 0.0] }]
//! # 2. Burley's normalised diffusion by its shape distance (Christensen & Burley 2015).
//! burley_d_mm = [0.75, 0.32, 0.20]
//! # 3. The same from measured coefficients: l = 1/(s' + a), d = l / (1.9 - A + 3.5 (A - 0.8)^2), A = albedo.
//! sigma_s_prime_per_mm = [0.74, 0.88, 1.01]
//! sigma_a_per_mm = [0.032, 0.17, 0.48]
//! ```

mod fewer;
mod file;
mod fit;
mod volume;

pub use fewer::{distance, fewer};
pub use file::ProfileError;
pub use fit::{Fit, MAX_LEVELS};
pub use volume::single_albedo;

use super::specular::Lobes;
use std::f64::consts::{PI, TAU};

/// One Gaussian of a profile, weight * exp(-r^2 / 2 variance) / (2 pi variance).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gaussian {
    /// mm^2, >= 0. Variance 0 is a delta: light leaves where it entered.
    pub variance: f64,
    /// Share of each channel's energy, >= 0.
    pub weight: [f64; 3],
}

/// How R depends on r.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A sum of Gaussians; in each channel the weights sum to 1.
    Gaussians(Vec<Gaussian>),
    /// (exp(-r/d) + exp(-r/3d)) / (8 pi d r), Christensen & Burley 2015.
    Burley {
        /// Shape distance per channel, mm, >= 0; 0 is a delta.
        d: [f64; 3],
    },
}

/// A material's diffusion profile.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    /// What the command line calls it.
    pub name: String,
    /// Where the figures come from.
    pub source: String,
    /// R(r), normalised.
    pub shape: Shape,
    /// Index of refraction.
    pub ior: f64,
    /// Diffuse albedo 0..1 where the source states one.
    pub albedo: Option<[f64; 3]>,
    /// Two lobes of gloss instead of one.
    pub lobes: Option<Lobes>,
}

/// The energy within [`Profile::max_radius_mm`].
pub const MAX_RADIUS_ENERGY: f64 = 0.997;

impl Profile {
    /// The built-in profiles, in the order in which they are listed to people. `milk` is short for `wholemilk`.
    pub fn names() -> Vec<&'static str> {
        file::BUILT_IN.iter().map(|(name, _)| *name).collect()
    }

    /// The names of several, as people read them.
    pub fn joined(profiles: &[Profile]) -> String {
        match profiles {
            [] => "none".to_owned(),
            all => all.iter().map(|p| p.name.as_str()).collect::<Vec<_>>().join(" + "),
        }
    }

    /// A built-in profile by name, or one read from a path that ends in `.toml`.
    pub fn resolve(arg: &str) -> Result<Profile, ProfileError> {
        file::resolve(arg)
    }

    /// A profile from the text of a TOML file; `place` names the text in errors, `stem` is the name it gets if it has none.
    pub fn parse(text: &str, place: &str, stem: &str) -> Result<Profile, ProfileError> {
        file::parse(text, place, stem)
    }

    /// R(r) in 1/mm^2, of unit integral per channel; `r_mm` >= 0.
    ///
    /// Burley's profile is infinite at r = 0 (its integral is not), and so is a delta there.
    pub fn radial(&self, r_mm: f64) -> [f64; 3] {
        match &self.shape {
            Shape::Gaussians(gaussians) => {
                let mut sum = [0.0; 3];
                for g in gaussians {
                    let height = gaussian(g.variance, r_mm);
                    // A channel that has no share of a delta must not get 0 * infinity.
                    (0..3).filter(|&c| g.weight[c] > 0.0).for_each(|c| sum[c] += g.weight[c] * height);
                }
                sum
            }
            Shape::Burley { d } => d.map(|d| burley(d, r_mm)),
        }
    }

    /// The share of each channel's energy that leaves within `r_mm` (>= 0) of where it entered, 0..1.
    pub fn enclosed(&self, r_mm: f64) -> [f64; 3] {
        match &self.shape {
            Shape::Gaussians(gaussians) => {
                let mut sum = [0.0; 3];
                for g in gaussians {
                    let share = if g.variance > 0.0 { -(-0.5 * r_mm * (r_mm / g.variance)).exp_m1() } else { 1.0 };
                    (0..3).for_each(|c| sum[c] += g.weight[c] * share);
                }
                sum
            }
            Shape::Burley { d } => d.map(|d| {
                let u = r_mm / d;
                if d > 0.0 { -0.25 * ((-u).exp_m1() + 3.0 * (-u / 3.0).exp_m1()) } else { 1.0 }
            }),
        }
    }

    /// The profile as at most [`MAX_LEVELS`] Gaussians whose weights sum to 1 in each channel, and what that loses.
    ///
    /// That many Gaussians or fewer pass through untouched, with error 0. Deterministic; takes milliseconds.
    pub fn gaussians(&self) -> Fit {
        match &self.shape {
            Shape::Gaussians(list) if list.len() <= MAX_LEVELS => Fit { gaussians: list.clone(), error: 0.0 },
            _ => fit::fit(self),
        }
    }

    /// The same material with every length multiplied by `factor`; a negative factor or NaN counts as 0, a delta.
    pub fn scaled(&self, factor: f64) -> Profile {
        let factor = factor.max(0.0);
        let shape = match &self.shape {
            Shape::Gaussians(gaussians) => Shape::Gaussians(
                gaussians.iter().map(|g| Gaussian { variance: g.variance * factor * factor, ..*g }).collect(),
            ),
            Shape::Burley { d } => Shape::Burley { d: d.map(|d| d * factor) },
        };
        Profile { shape, ..self.clone() }
    }

    /// Half the mean square radius per channel, mm^2: the sum of w v for Gaussians, 7 d^2 for Burley.
    ///
    /// One Gaussian of this variance spreads light as far, in the root mean square.
    pub fn mean_variance(&self) -> [f64; 3] {
        match &self.shape {
            Shape::Gaussians(gaussians) => weighted(gaussians, |v| v),
            Shape::Burley { d } => d.map(|d| 7.0 * d * d),
        }
    }

    /// Mean radius per channel, mm: the sum of w sqrt(pi v / 2) for Gaussians, 2.5 d for Burley.
    pub fn mean_radius_mm(&self) -> [f64; 3] {
        match &self.shape {
            Shape::Gaussians(gaussians) => weighted(gaussians, |v| (0.5 * PI * v).sqrt()),
            Shape::Burley { d } => d.map(|d| 2.5 * d),
        }
    }

    /// The radius within which every channel keeps [`MAX_RADIUS_ENERGY`] of its energy, mm; 0 for a delta.
    pub fn max_radius_mm(&self) -> f64 {
        let short = |r: f64| self.enclosed(r).iter().any(|&e| e < MAX_RADIUS_ENERGY);
        let (mut low, mut high) = (0.0, self.mean_radius_mm().into_iter().fold(0.0, f64::max));
        while high > 0.0 && high.is_finite() && short(high) {
            (low, high) = (high, 2.0 * high);
        }
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if short(middle) { low = middle } else { high = middle }
        }
        high
    }
}

/// exp(-r^2 / 2v) / (2 pi v); at v = 0 a delta.
fn gaussian(variance: f64, r: f64) -> f64 {
    if variance > 0.0 { (-0.5 * r * (r / variance)).exp() / (TAU * variance) } else { delta(r) }
}

/// Christensen & Burley 2015, equation 2, with unit albedo.
fn burley(d: f64, r: f64) -> f64 {
    let fall = (-r / d).exp() + (-r / (3.0 * d)).exp();
    match fall {
        // Also where the product below would underflow to 0 / 0.
        _ if d == 0.0 => delta(r),
        0.0 => 0.0,
        _ => fall / (8.0 * PI * d * r),
    }
}

fn delta(r: f64) -> f64 {
    if r == 0.0 { f64::INFINITY } else { 0.0 }
}

fn weighted(gaussians: &[Gaussian], of_variance: impl Fn(f64) -> f64) -> [f64; 3] {
    std::array::from_fn(|c| gaussians.iter().map(|g| g.weight[c] * of_variance(g.variance)).sum())
}
