//! Truth: what every method approximates, converged, with its own error estimated.
//!
//! Exitance at x is the integral over the surface of R(|x - y|) E(y) dA(y), divided by the same integral without E (the
//! kernel's mass there), per channel. R is the whole profile, E the irradiance with the normal that light falls on and with
//! cast shadows, by rays. The kernel is cut in three ([`kernel`]): a tiny core that keeps the light where it is, a near part
//! found by rays around each pixel ([`near`]), and a smooth far part summed over surface samples in a tree ([`cloud`]).
//! Everything is done twice with independent samples; the difference tells the error.
//!
//! Units: mm; irradiance as the lights have it. What is not modelled: alpha (cut-outs are whole).

pub mod ambient;
pub mod bands;
pub mod bump;
pub mod cloud;
pub mod eye;
pub mod flip;
pub mod kernel;
pub mod lighting;
pub mod metrics;
pub mod near;
pub mod random;
mod state;
pub mod surface;

pub use eye::Window;
pub use state::Checkpoint;

use crate::frame::Inputs;
use crate::frame::view::ViewFacts;
use crate::report::picture::PictureError;
use crate::scene::{Alpha, Projection};
use crate::skin::profile::Profile;
use bands::BORDER;
use cloud::{Cloud, Sum};
use eye::{Eye, Seen};
use glam::DVec3;
use kernel::Kernel;
use near::Near;
use random::hash;
use rayon::prelude::*;
use state::{Found, Work};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;
use surface::Surface;

/// Sample spacings in the radius of the near part.
const SPLIT: f64 = 8.;
/// Rays of a near part at first, along the normal, in each half.
const FIRST_RAYS: usize = 24;
/// Rays at most.
const MOST_RAYS: usize = 24 * 64;
/// Pixels on which the tree is asked again, twice as finely.
const PROBES: usize = 400;

/// Pixels after which a state may be kept.
const ROUND: usize = 8192;

/// How hard to try.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Effort {
    /// Surface samples of the far part, both halves together.
    pub samples: usize,
    /// Error of a pixel above which its near part is done again with more rays.
    pub max_error: f64,
    /// A branch of the tree counts as one point where its radius is below this part of its distance.
    pub opening: f64,
}

impl Default for Effort {
    fn default() -> Self {
        Self { samples: 2_000_000, max_error: 1e-3, opening: 0.12 }
    }
}

/// Why there is no truth.
#[derive(Debug, thiserror::Error)]
pub enum TruthError {
    /// The window does not lie in the picture.
    #[error("the window {0:?} does not lie in a picture of {1} x {2}")]
    Window(Window, u32, u32),
    /// The state could not be kept.
    #[error("keeping the state: {0}")]
    State(#[from] PictureError),
}

/// Root mean square errors, estimated.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Estimate {
    /// All of it: root of the sum of the squares below.
    pub rms: f64,
    /// From half the difference of two independent halves.
    pub noise: f64,
    /// From a tree asked twice as finely, extrapolated.
    pub tree: f64,
    /// 99th percentile of half the difference, largest channel.
    pub noise_p99: f64,
}

/// The converged picture.
#[derive(Clone, Debug)]
pub struct Truth {
    /// What of the picture there is.
    pub window: Window,
    /// RGBA row by row from the top; A is coverage.
    pub pixels: Vec<[f32; 4]>,
    /// The same from each half of the samples alone.
    pub halves: [Vec<[f64; 3]>; 2],
    /// Bits of [`bands::band`].
    pub bands: Vec<u8>,
    /// Its own error.
    pub error: Estimate,
    /// Surface samples used.
    pub samples: usize,
    /// Pixels done again with more rays.
    pub refined: usize,
    /// Kernel mass, 5th, 50th and 95th percentile over covered pixels, green.
    pub mass: [f64; 3],
    /// Where the near part ends and how far the kernel reaches, mm; of several profiles, those of the first.
    pub radii_mm: [f64; 2],
    /// Seconds of wall time, those of an interrupted run included.
    pub seconds: f64,
    /// Pixels taken over from an interrupted run.
    pub resumed: usize,
    /// What differs from the renderer; for people.
    pub warnings: Vec<String>,
}

/// Integrates. `progress` hears of parts of a thousand done.
///
/// # Errors
/// Where the window lies outside the picture.
pub fn solve(
    inputs: &Inputs<'_>,
    window: Option<Window>,
    effort: &Effort,
    progress: impl Fn(usize) + Sync,
) -> Result<Truth, TruthError> {
    resume(inputs, window, effort, None, progress)
}

/// The same, going on from the state that an interrupted run left, and leaving one. A state of something else is not used: a
/// warning says so. Whoever has put the result away removes the file.
///
/// # Errors
/// Where the window lies outside the picture, or the state cannot be written.
pub fn resume(
    inputs: &Inputs<'_>,
    window: Option<Window>,
    effort: &Effort,
    checkpoint: Option<&Checkpoint>,
    progress: impl Fn(usize) + Sync,
) -> Result<Truth, TruthError> {
    let start = Instant::now();
    let (scene, size) = (inputs.scene, [inputs.settings.size.width, inputs.settings.size.height]);
    let window = Window::within(window, size)?;
    let shadows = !inputs.settings.no_shadows;
    let surface = Surface::new(scene, &inputs.camera, size);
    let eye = Eye::new(&inputs.camera, size, scene);
    let width = window.width as usize + 2 * BORDER;
    let corner = [i64::from(window.x) - BORDER as i64, i64::from(window.y) - BORDER as i64];
    let seen = eye.see(&surface, corner[0], corner[1], width, window.height as usize + 2 * BORDER);
    let facts = ViewFacts::new(&inputs.camera, size, scene.bounds.min, scene.bounds.max);
    let parallel = matches!(inputs.camera.projection, Projection::Orthographic { .. });
    let footprint = |depth: f64| if parallel { 1. } else { depth } / facts.pixels_per_mm;
    let length = inputs.profiles.iter().flat_map(Profile::mean_radius_mm).fold(0., f64::max);
    let length = if length > 0. { length } else { 1. };
    let bands = bands::bands(&surface, &inputs.lights, shadows, &seen, &window, footprint, length);

    // The far part's samples, and the near part that is steep beside their spacing.
    let own: Vec<Option<&Seen>> = (0..window.pixels())
        .map(|i| seen[(i / window.width as usize + BORDER) * width + i % window.width as usize + BORDER].as_ref())
        .collect();
    let bodies: Vec<Option<Body>> =
        (0..inputs.profiles.len()).map(|k| Body::new(inputs, &surface, k, &own, effort)).collect();
    progress(100);

    let solver = Solver { inputs, surface: &surface, shadows, bodies: &bodies, effort };
    let mut said = warnings(inputs);
    let key = if checkpoint.is_some() { state::key(inputs, window, effort) } else { [0; 2] };
    let (before, mut work) = match checkpoint.map_or(Found::Nothing, |c| c.load(key, own.len())) {
        Found::State(seconds, work) => (seconds, work),
        Found::Nothing => (0., Vec::new()),
        Found::Useless(why) => {
            said.extend(checkpoint.map(|c| format!("{}: {why}; starting over", c.file.display())));
            (0., Vec::new())
        }
    };
    let resumed = work.len();
    let done = AtomicUsize::new(resumed);
    let mut kept = Instant::now();
    while work.len() < own.len() {
        let first = work.len();
        let round = &own[first..own.len().min(first + ROUND)];
        work.par_extend(round.par_iter().enumerate().map(|(i, s)| {
            let n = done.fetch_add(1, Ordering::Relaxed);
            if n.is_multiple_of(1024) {
                progress(100 + 900 * n / own.len());
            }
            s.map_or(Work::default(), |s| solver.pixel(s, (first + i) as u64))
        }));
        if let Some(c) = checkpoint.filter(|c| work.len() < own.len() && kept.elapsed() >= c.every) {
            c.save(key, before + start.elapsed().as_secs_f64(), &work)?;
            kept = Instant::now();
        }
    }
    let tree = solver.tree_error(&own, &work);
    progress(1000);

    let mut masses: Vec<f64> = work.iter().filter(|w| w.mass > 0.).map(|w| w.mass).collect();
    masses.sort_by(f64::total_cmp);
    let at = |q: f64| masses.get((q * masses.len() as f64) as usize).copied().unwrap_or(1.);
    Ok(Truth {
        window,
        pixels: work.iter().map(Work::rgba).collect(),
        halves: std::array::from_fn(|k| work.iter().map(|w| w.halves[k]).collect()),
        bands,
        error: estimate(&work, tree),
        samples: bodies.iter().flatten().flat_map(|b| &b.clouds).map(Cloud::len).sum(),
        refined: work.iter().filter(|w| w.refined > 0).count(),
        mass: [at(0.05), at(0.5), at(0.95)],
        radii_mm: bodies.iter().flatten().next().map_or([0.; 2], |b| [b.kernel.near_end(), b.kernel.reach]),
        seconds: before + start.elapsed().as_secs_f64(),
        resumed,
        warnings: said,
    })
}

impl Work {
    fn rgba(&self) -> [f32; 4] {
        let [r, g, b] = self.value.map(|x| x as f32);
        [r, g, b, self.covered as f32]
    }
}

/// All that scatters by one profile: other surface gives it no light, and gets none of it.
struct Body {
    kernel: Kernel,
    clouds: [Cloud; 2],
}

impl Body {
    fn new(
        inputs: &Inputs<'_>,
        surface: &Surface<'_>,
        profile: usize,
        own: &[Option<&Seen>],
        effort: &Effort,
    ) -> Option<Body> {
        let scatters = |s: &&&Seen| surface.profile(s.place.face) == Some(profile);
        let scattering: Vec<DVec3> = own.iter().flatten().filter(scatters).map(|s| s.place.position).collect();
        let reach = Kernel::reach_of(&inputs.profiles[profile]);
        let faces = if reach > 0. { cloud::faces_in_reach(surface, profile, &scattering, reach) } else { Vec::new() };
        if faces.is_empty() {
            return None;
        }
        let area: f64 = faces.iter().map(|f| surface.faces[*f as usize].area()).sum();
        let half = (effort.samples / 2).max(1);
        let split = SPLIT * (area / half as f64).sqrt();
        let count = if split < reach { half } else { 1 };
        let shadows = !inputs.settings.no_shadows;
        Some(Body {
            kernel: Kernel::new(&inputs.profiles[profile], split),
            clouds: std::array::from_fn(|k| Cloud::new(surface, &faces, &inputs.lights, shadows, count, k as u64 + 1)),
        })
    }
}

/// Everything that a pixel needs.
struct Solver<'a> {
    inputs: &'a Inputs<'a>,
    surface: &'a Surface<'a>,
    shadows: bool,
    bodies: &'a [Option<Body>],
    effort: &'a Effort,
}

impl Solver<'_> {
    /// What a face scatters with.
    fn body(&self, face: u32) -> Option<(usize, &Body)> {
        let profile = self.surface.profile(face)?;
        Some((profile, self.bodies.get(profile)?.as_ref()?))
    }

    fn pixel(&self, seen: &Seen, index: u64) -> Work {
        let x = &seen.place;
        let here = lighting::irradiance(self.surface, &self.inputs.lights, self.shadows, x);
        let plain = Work { covered: 1, value: here, halves: [here; 2], ..Work::default() };
        let Some((profile, Body { kernel, clouds })) = self.body(x.face) else { return plain };
        let mut core = Sum::default();
        core.add(kernel.core_share, here);
        if !kernel.spreads() {
            return plain;
        }
        let far: [Sum; 2] = std::array::from_fn(|k| clouds[k].far(kernel, x.position, self.effort.opening).plus(&core));
        let mean_far = far[0].plus(&far[1]).times(0.5);
        let near = Near { surface: self.surface, lights: &self.inputs.lights, shadows: self.shadows, kernel, profile };
        let mut rays = FIRST_RAYS;
        loop {
            let round = (rays / FIRST_RAYS) as u64;
            let part: [Sum; 2] = std::array::from_fn(|k| near.gather(x, rays, hash(index * 2 + k as u64, round)));
            // What the rays alone leave open decides whether more are cast; new ones, so that luck is not kept.
            let open = part.map(|p| p.plus(&mean_far).ratio(here));
            let error = (0..3).map(|c| 0.5 * (open[0][c] - open[1][c]).abs()).fold(0., f64::max);
            if error <= self.effort.max_error || rays >= MOST_RAYS {
                let halves: [Sum; 2] = std::array::from_fn(|k| part[k].plus(&far[k]));
                let whole = halves[0].plus(&halves[1]).times(0.5);
                return Work {
                    covered: 1,
                    value: whole.ratio(here),
                    halves: halves.map(|h| h.ratio(here)),
                    mass: whole.mass[1],
                    refined: u32::from(rays > FIRST_RAYS),
                };
            }
            rays *= 4;
        }
    }

    /// How far the tree's clusters move some pixels, from asking twice as finely; clustering is of second order.
    fn tree_error(&self, own: &[Option<&Seen>], work: &[Work]) -> f64 {
        let places: Vec<usize> = (0..own.len()).filter(|i| work[*i].mass > 0.).collect();
        let step = places.len().div_ceil(PROBES).max(1);
        let square = |i: &usize| {
            let Some(seen) = own[*i] else { return 0. };
            let Some((_, body)) = self.body(seen.place.face) else { return 0. };
            let far = |opening: f64| body.clouds[0].far(&body.kernel, seen.place.position, opening);
            let (coarse, fine) = (far(self.effort.opening), far(0.5 * self.effort.opening));
            // The other parts of the mass stay as they are.
            (0..3)
                .map(|c| {
                    let value = work[*i].value[c];
                    let moved = fine.lit[c] - coarse.lit[c] - value * (fine.mass[c] - coarse.mass[c]);
                    (4. / 3. * moved / work[*i].mass.max(1e-3)).powi(2) / 3.
                })
                .sum()
        };
        let chosen: Vec<usize> = places.into_iter().step_by(step).collect();
        let sum: f64 = chosen.par_iter().map(square).sum();
        (sum / chosen.len().max(1) as f64).sqrt()
    }
}

fn estimate(work: &[Work], tree: f64) -> Estimate {
    let halves = |w: &Work| -> [f64; 3] { std::array::from_fn(|c| 0.5 * (w.halves[0][c] - w.halves[1][c])) };
    let covered: Vec<[f64; 3]> = work.iter().filter(|w| w.covered > 0).map(halves).collect();
    let count = (3 * covered.len()).max(1) as f64;
    let noise = (covered.iter().flatten().map(|d| d * d).sum::<f64>() / count).sqrt();
    let mut worst: Vec<f64> = covered.iter().map(|d| d.iter().fold(0., |a: f64, x| a.max(x.abs()))).collect();
    worst.sort_by(f64::total_cmp);
    let noise_p99 = worst.get(worst.len() * 99 / 100).copied().unwrap_or(0.);
    Estimate { rms: noise.hypot(tree), noise, tree, noise_p99 }
}

fn warnings(inputs: &Inputs<'_>) -> Vec<String> {
    let materials = &inputs.scene.materials;
    let mut said = Vec::new();
    let cut = materials.iter().filter(|m| m.alpha != Alpha::Opaque).count();
    if cut > 0 {
        said.push(format!("{cut} materials have alpha, which truth ignores: cut-outs are whole"));
    }
    said
}
