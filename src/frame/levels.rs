//! Which levels of the diffusion run: from the profile, the quality, and how many pixels a millimetre covers.

use super::uniforms::MAX_LEVELS;
use crate::settings::{Method, Quality, Resolution, Settings};
use crate::skin::profile::{Gaussian, Profile, fewer};

/// A Gaussian whose sigma covers fewer pixels than this is not told from a point: its rms radius projects below one pixel.
pub const LEAST_SIGMA_PX: f64 = 0.7;

/// Most levels that are gathered: what the mass target has channels for.
pub const MOST_GATHERED: usize = 3;

/// A Gaussian whose sigma covers fewer texels of a shadow map is not gathered from it.
const LEAST_SIGMA_TEXELS: f64 = 3.;

/// A sigma covers so many texels at least of what is kept of the shadow map for gathering.
const LEAST_SIGMA_SPARSE: f64 = 1.5;

/// Each of these that a step exceeds asks for one more pass.
const LONG_STEPS_TEXELS: [f64; 3] = [12., 24., 48.];

/// One level that lighting reads.
#[derive(Clone, Debug, PartialEq)]
pub struct Level {
    /// Variance of the accumulated Gaussian, mm^2.
    pub variance: f64,
    /// Weight of the profile's Gaussians that this level stands for (`moments`).
    pub weight: [f64; 3],
    /// Share in each channel's own normal (`pdss`).
    pub share: [f64; 3],
    /// Pixels per texel and axis.
    pub stride: u32,
    /// Light with a slot is gathered from the shadow map, hidden parts included, instead of blurred.
    pub gathered: bool,
}

/// One blur pass.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// Variance that it adds, mm^2.
    pub variance: f64,
    /// Pixels per texel of what it reads and writes.
    pub stride: (u32, u32),
    /// Level that it completes; none for a pass on the way.
    pub level: Option<usize>,
}

/// The whole diffusion of one profile at one distance.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Levels {
    /// Levels in order of variance.
    pub levels: Vec<Level>,
    /// Passes in order.
    pub steps: Vec<Step>,
    /// Weight of what is narrower than a pixel (`moments`), or the unblurred normal's share (`pdss`).
    pub sharp: [f64; 3],
    /// Mean sigma of the profile's Gaussians that project below a pixel, mm, for methods in which nothing else carries them; else 0.
    pub narrow_mm: f64,
    /// Unit in which levels store curvature, mm.
    pub length_mm: f64,
    /// Variances that were asked for and project below a pixel.
    pub below_a_pixel: Vec<f64>,
}

/// How many pixels a millimetre covers: at the nearest point of the scene, and at its middle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Magnification {
    /// Pixels per mm at the nearest point: what is below a pixel there is below a pixel everywhere.
    pub nearest: f64,
    /// Pixels per mm in the middle of the scene.
    pub middle: f64,
}

/// Geometric mean of the sigmas that are narrower than `least` and above 0, by weight in all channels; 0 where there is none. Of a peak and
/// its foot one Gaussian resembles the peak: the arithmetic mean is too wide for the edge of a shadow (glsl/README.md).
fn mean_sigma(gaussians: &[Gaussian], least: f64) -> f64 {
    let narrow = gaussians.iter().map(|g| (g.variance.sqrt(), g.weight.iter().sum::<f64>()));
    let narrow = narrow.filter(|(sigma, weight)| *sigma > 0. && *sigma < least && *weight > 0.);
    let (sum, weight) = narrow.fold((0., 0.), |(sum, all), (sigma, w)| (sum + w * sigma.ln(), all + w));
    if weight > 0. { (sum / weight).exp() } else { 0. }
}

impl Levels {
    /// Decides the levels.
    pub fn new(profile: &Profile, settings: &Settings, pixels: Magnification) -> Levels {
        let fit = profile.gaussians().gaussians;
        let widest = fit.iter().map(|g| g.variance).fold(0., f64::max);
        // Whatever the profile, its own length makes curvature dimensionless; 1 mm where it has none.
        let length_mm = if widest > 0. { widest.sqrt() } else { 1. };
        // The kernels of others hold the narrow ones, too.
        let drops = matches!(settings.method, Method::Moments | Method::Gaussians);
        let narrow_mm = if drops { mean_sigma(&fit, LEAST_SIGMA_PX / pixels.nearest) } else { 0. };
        let mut out = Levels { length_mm, narrow_mm, ..Levels::default() };
        match settings.method {
            Method::Moments => out.per_gaussian(fit, most_levels(settings), pixels),
            Method::Pdss => out.per_channel(profile, widest, most_levels(settings), pixels),
            // Nothing scatters, light itself is blurred, or nothing is (`methods::kernel`).
            _ => out.sharp = [1.; 3],
        }
        out.strides(settings, pixels);
        out.steps(settings, pixels);
        out
    }

    /// `moments`: a level a Gaussian, of those that a pixel can tell from a point, or of fewer that come near them: `count` at most.
    fn per_gaussian(&mut self, gaussians: Vec<Gaussian>, count: u32, pixels: Magnification) {
        let least = (LEAST_SIGMA_PX / pixels.nearest).powi(2);
        let (narrow, wide): (Vec<_>, Vec<_>) =
            fewer(&gaussians, count as usize, least).into_iter().partition(|g| g.variance < least);
        for g in narrow {
            (0..3).for_each(|c| self.sharp[c] += g.weight[c]);
            // What stays where it is has been left out by nobody.
            if g.variance > 0. {
                self.below_a_pixel.push(g.variance);
            }
        }
        for g in wide {
            self.levels.push(Level {
                variance: g.variance,
                weight: g.weight,
                share: [0.; 3],
                stride: 1,
                gathered: false,
            });
        }
    }

    /// `pdss`: geometric levels up to the widest Gaussian; each channel's normal is mixed from the two levels that enclose
    /// its mean variance, linearly in sigma.
    fn per_channel(&mut self, profile: &Profile, widest: f64, count: u32, pixels: Magnification) {
        let ratio = 4f64;
        for i in 0..count {
            let variance = widest * ratio.powi(i as i32 + 1 - count as i32);
            if variance.sqrt() * pixels.nearest < LEAST_SIGMA_PX {
                self.below_a_pixel.push(variance);
            } else {
                self.levels.push(Level { variance, weight: [0.; 3], share: [0.; 3], stride: 1, gathered: false });
            }
        }
        for (c, variance) in profile.mean_variance().into_iter().enumerate() {
            let sigma = variance.sqrt();
            let above = self.levels.iter().position(|l| l.variance.sqrt() >= sigma);
            match above {
                None if self.levels.is_empty() => self.sharp[c] = 1.,
                None => self.levels.last_mut().into_iter().for_each(|l| l.share[c] = 1.),
                Some(i) => {
                    let low = if i == 0 { 0. } else { self.levels[i - 1].variance.sqrt() };
                    let t = (sigma - low) / (self.levels[i].variance.sqrt() - low);
                    self.levels[i].share[c] = t;
                    if i == 0 { self.sharp[c] = 1. - t } else { self.levels[i - 1].share[c] = 1. - t }
                }
            }
        }
    }

    /// Coarser texels for wider levels: a level is smooth over its own sigma.
    fn strides(&mut self, settings: &Settings, pixels: Magnification) {
        let fixed = settings.resolution.map(Resolution::stride);
        // Beyond a silhouette a coarse texel has nothing to interpolate from, so high quality stops at a stride of two: at four
        // pdss on a small torus loses a tenth (.0219 rms against .0197).
        let (texels_per_sigma, coarsest) = match (settings.quality, settings.method) {
            (Quality::Low, Method::Moments) => (1.2, 4),
            (Quality::Low, _) => (0.8, 4),
            (Quality::Medium, Method::Moments) => (1.5, 4),
            (Quality::Medium, _) => (1.2, 4),
            (Quality::High, _) => (1.5, 2),
            (Quality::Ultra, _) => (f64::INFINITY, 1),
        };
        let mut stride = 1;
        for level in &mut self.levels {
            let sigma_px = level.variance.sqrt() * pixels.middle;
            let enough = |s: &u32| *s <= coarsest && sigma_px >= f64::from(*s) * texels_per_sigma;
            let wanted = [4, 2].into_iter().find(enough).unwrap_or(1);
            // A level reads the one before it, so it is never finer.
            stride = stride.max(fixed.unwrap_or(wanted));
            level.stride = stride;
        }
    }

    /// Levels before the first that is gathered.
    pub fn first_gathered(&self) -> u32 {
        self.levels.iter().take_while(|l| !l.gathered).count() as u32
    }

    /// The widest levels are gathered where a sigma covers enough texels of the shadow maps, each `texel_mm` wide. One texel in so
    /// many along each axis serves them: a power of two; 0 where no level is gathered.
    pub fn gather(&mut self, texel_mm: f64) -> u32 {
        for level in self.levels.iter_mut().rev().take(MOST_GATHERED) {
            let sigma = level.variance.sqrt();
            level.gathered = sigma >= (LEAST_SIGMA_TEXELS * texel_mm).max(0.25 * self.length_mm);
        }
        let Some(narrowest) = self.levels.iter().find(|l| l.gathered) else { return 0 };
        let step = (narrowest.variance.sqrt() / (LEAST_SIGMA_SPARSE * texel_mm)).clamp(2., 16.);
        1 << step.log2() as u32
    }

    /// Passes that reach each level's variance from the one before. A long step is seen: where a tap falls off a silhouette,
    /// its weight is missing along a line as far away as the step is long. More, shorter steps wash the line out.
    fn steps(&mut self, settings: &Settings, pixels: Magnification) {
        let levels = self.levels.len() as u32;
        if levels == 0 {
            return;
        }
        let (mut before, mut source) = (0., 1);
        for (i, level) in self.levels.iter().enumerate() {
            let step_texels = 2. * (level.variance - before).sqrt() * pixels.middle / f64::from(level.stride);
            let extra = match settings.passes {
                // The passes beyond one a level go to the widest levels, whose steps are longest.
                Some(passes) => {
                    let spare = passes.saturating_sub(levels);
                    spare / levels + u32::from(i as u32 >= levels - spare % levels)
                }
                None if settings.quality == Quality::Low => 0,
                None => {
                    u32::from(settings.quality == Quality::Ultra)
                        + LONG_STEPS_TEXELS.iter().filter(|long| step_texels > **long).count() as u32
                }
            };
            let share = (level.variance - before) / f64::from(1 + extra);
            for pass in 0..=extra {
                self.steps.push(Step {
                    variance: share,
                    stride: (source, level.stride),
                    level: (pass == extra).then_some(i),
                });
                source = level.stride;
            }
            before = level.variance;
        }
    }
}

fn most_levels(settings: &Settings) -> u32 {
    let by_quality = match (settings.method, settings.quality) {
        (Method::Moments, Quality::Low) => 2,
        (Method::Moments, Quality::Medium) => 3,
        (Method::Moments, Quality::High) => 4,
        (Method::Moments, _) => MAX_LEVELS as u32,
        (_, Quality::Low) => 1,
        (_, Quality::Medium) => 2,
        _ => 3,
    };
    settings.passes.map_or(by_quality, |p| {
        if settings.method == Method::Pdss { p.min(MAX_LEVELS as u32) } else { by_quality.min(p.max(1)) }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn skin() -> Profile {
        Profile::resolve("skin").unwrap_or_else(|e| panic!("{e}"))
    }

    #[test]
    fn weights_are_kept_whatever_the_quality_and_the_distance() {
        for quality in [Quality::Low, Quality::Medium, Quality::High, Quality::Ultra] {
            for method in [Method::Pdss, Method::Moments] {
                for px in [1e-4, 0.3, 2., 50.] {
                    let settings = Settings { method, quality, ..Settings::default() };
                    let l = Levels::new(&skin(), &settings, Magnification { nearest: px, middle: px });
                    for c in 0..3 {
                        let sum: f64 = l.levels.iter().map(|x| x.weight[c] + x.share[c]).sum::<f64>() + l.sharp[c];
                        assert!((sum - 1.).abs() < 1e-9, "{method:?} {quality:?} at {px} px/mm: {sum}");
                    }
                    let added: f64 = l.steps.iter().map(|s| s.variance).sum();
                    let last = l.levels.last().map_or(0., |x| x.variance);
                    assert!((added - last).abs() < 1e-9, "steps add {added}, the widest level has {last}");
                }
            }
        }
    }

    #[test]
    fn nothing_below_a_pixel_runs() {
        let far = Levels::new(&skin(), &Settings::default(), Magnification { nearest: 0.01, middle: 0.01 });
        assert!(far.steps.is_empty() && far.sharp == [1.; 3], "{far:?}");
        let near = Levels::new(&skin(), &Settings::default(), Magnification { nearest: 5., middle: 5. });
        assert!(!near.steps.is_empty(), "the twin: close by, levels run");
    }
}
