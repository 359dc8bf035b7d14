//! The profile cut into three parts that together are all of it: a core so small that light leaves it as it came, a near
//! part with all that is steep, and a far part that is smooth on the scale of the surface samples.

use crate::skin::profile::Profile;
use std::f64::consts::PI;

/// Energy that is left beyond the reach.
const BEYOND: f64 = 1e-5;
/// The core's radius as a part of the widest channel's mean radius. Over it irradiance is taken for constant.
const CORE: f64 = 2e-3;
/// Entries of the far table, and rings of the near density.
const TABLE: usize = 4096;
const RINGS: usize = 96;

/// A profile ready to be integrated over a surface.
#[derive(Clone, Debug)]
pub struct Kernel {
    profile: Profile,
    /// Radius of the core, mm.
    pub core: f64,
    /// Share of each channel's energy in the core.
    pub core_share: [f64; 3],
    /// Radius where the near part ends, mm; the far part begins at half of it.
    pub split: f64,
    /// Radius where the far part ends, mm.
    pub reach: f64,
    far: Vec<[f64; 3]>,
    far_step: f64,
    rings: Rings,
}

/// Rings of equal expected energy around a point: a density to draw from, constant over each ring.
#[derive(Clone, Debug, Default)]
struct Rings {
    /// Squared radii, ascending, from 0.
    square: Vec<f64>,
    /// Probability per mm^2 of each ring.
    density: Vec<f64>,
}

impl Kernel {
    /// Radius that keeps all but `BEYOND` of every channel's energy, mm; 0 for a delta.
    pub fn reach_of(profile: &Profile) -> f64 {
        let (mut low, mut high) = (0., 2. * profile.mean_radius_mm().into_iter().fold(0., f64::max));
        let short = |r: f64| profile.enclosed(r).iter().any(|e| *e < 1. - BEYOND);
        while high > 0. && high.is_finite() && short(high) {
            (low, high) = (high, 2. * high);
        }
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if short(middle) { low = middle } else { high = middle }
        }
        high
    }

    /// Cuts a profile for surface samples that can carry what is smooth over `split` mm.
    pub fn new(profile: &Profile, split: f64) -> Self {
        let reach = Self::reach_of(profile);
        let core = CORE * profile.mean_radius_mm().into_iter().fold(0., f64::max);
        // Where the near part covers the whole reach there is no far part.
        let split = if split >= reach { 2. * reach } else { split.max(core * 4.) };
        let far_step = (reach - 0.5 * split).max(0.) / TABLE as f64;
        let mut kernel = Self {
            profile: profile.clone(),
            core,
            core_share: profile.enclosed(core),
            split,
            reach,
            far: Vec::new(),
            far_step,
            rings: Rings::default(),
        };
        kernel.far = (0..=TABLE + 1)
            .map(|i| {
                let r = 0.5 * split + i as f64 * far_step;
                profile.radial(r).map(|v| v * (1. - kernel.window(r)))
            })
            .collect();
        kernel.rings = kernel.make_rings();
        kernel
    }

    /// Whether anything is left outside the core.
    pub fn spreads(&self) -> bool {
        self.reach > self.core
    }

    /// Where the near part ends, whether or not there is a far part, mm.
    pub fn near_end(&self) -> f64 {
        self.split.min(self.reach)
    }

    /// 1 up to half the split, 0 from the split on, twice differentiable.
    fn window(&self, r: f64) -> f64 {
        let t = (2. * r / self.split - 1.).clamp(0., 1.);
        1. - t * t * t * (10. + t * (6. * t - 15.))
    }

    /// The near part of R in 1/mm^2.
    pub fn near(&self, r: f64) -> [f64; 3] {
        if r < self.core || r > self.near_end() {
            return [0.; 3];
        }
        let window = self.window(r);
        self.profile.radial(r).map(|v| v * window)
    }

    /// The far part of R in 1/mm^2, by linear interpolation.
    pub fn far(&self, r: f64) -> [f64; 3] {
        let at = (r - 0.5 * self.split) / self.far_step;
        let index = at as usize;
        if !(at >= 0. && index < TABLE) {
            return [0.; 3];
        }
        let (a, b, t) = (self.far[index], self.far[index + 1], at - index as f64);
        [a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t, a[2] + (b[2] - a[2]) * t]
    }

    /// The radius, mm, that a uniform number 0..1 draws.
    pub fn draw(&self, u: f64) -> f64 {
        let at = u.clamp(0., 1. - 1e-12) * RINGS as f64;
        let ring = at as usize;
        let (a, b) = (self.rings.square[ring], self.rings.square[ring + 1]);
        (a + (b - a) * (at - ring as f64)).sqrt()
    }

    /// Probability per mm^2 with which [`draw`](Self::draw) and a uniform angle land at radius r.
    pub fn density(&self, r: f64) -> f64 {
        let ring = self.rings.square.partition_point(|s| *s <= r * r);
        if ring == 0 { 0. } else { self.rings.density.get(ring - 1).copied().unwrap_or(0.) }
    }

    fn make_rings(&self) -> Rings {
        let end = self.near_end();
        let (inner, outer) = (self.profile.enclosed(self.core), self.profile.enclosed(end));
        // What a channel has between core and end, each channel alike, and a tenth spread evenly over the area.
        let share = |r: f64| {
            let at = self.profile.enclosed(r.max(self.core));
            let parts: [f64; 3] = std::array::from_fn(|c| {
                let all = outer[c] - inner[c];
                if all > 1e-12 { (at[c] - inner[c]) / all } else { (r / end).powi(2) }
            });
            0.3 * parts.iter().sum::<f64>() + 0.1 * (r / end).powi(2)
        };
        let radius = |quantile: f64| {
            let (mut low, mut high) = (0., end);
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if share(middle) < quantile { low = middle } else { high = middle }
            }
            high
        };
        let mut square: Vec<f64> = (0..=RINGS).map(|i| radius(i as f64 / RINGS as f64).powi(2)).collect();
        square[0] = 0.;
        square[RINGS] = end * end;
        let density =
            square.windows(2).map(|s| 1. / (RINGS as f64 * PI * (s[1] - s[0]).max(f64::MIN_POSITIVE))).collect();
        Rings { square, density }
    }
}
