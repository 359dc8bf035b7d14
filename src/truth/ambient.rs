//! Ambient truth: how much of a cosine-weighted sky a place sees past what is near it, by cast rays.
//!
//! V = 1 - Int (n.w / pi) f(t(w) / R) dw, t the distance to the first face along w, f the falloff of `skin::occlusion`: quadratic,
//! 1 - (t/R)^2 within the radius R, so that an occluder fades out instead of ending. n is the interpolated normal without normal
//! map, as curvature is measured on. Directions below the facet itself are not the sky's and are left out. Everything that is
//! near occludes, whether curvature knows of it or not: contact, thin gaps, other objects.

use super::eye::{Eye, Seen};
use super::random::{Shift, hash};
use super::surface::Surface;
use super::{TruthError, Window};
use crate::frame::Inputs;
use rayon::prelude::*;
use std::f64::consts::TAU;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

/// The converged visibility.
#[derive(Clone, Debug)]
pub struct Ambient {
    /// What of the picture there is.
    pub window: Window,
    /// Visibility 0..1 in R, G and B, row by row from the top; A is coverage.
    pub pixels: Vec<[f32; 4]>,
    /// The same from each half of the rays alone.
    pub halves: [Vec<f64>; 2],
    /// Its own root mean square error, from half the difference of the halves.
    pub rms: f64,
    /// 99th percentile of half the difference.
    pub p99: f64,
    /// Rays a pixel, both halves together.
    pub rays: usize,
    /// Occlusion radius, mm.
    pub radius_mm: f64,
    /// Seconds of wall time.
    pub seconds: f64,
}

/// Casts `rays` a pixel, halved, up to `radius_mm`. `progress` hears of parts of a thousand done.
///
/// # Errors
/// Where the window lies outside the picture.
pub fn visibility(
    inputs: &Inputs<'_>,
    window: Option<Window>,
    radius_mm: f64,
    rays: usize,
    progress: impl Fn(usize) + Sync,
) -> Result<Ambient, TruthError> {
    let start = Instant::now();
    let size = [inputs.settings.size.width, inputs.settings.size.height];
    let window = Window::within(window, size)?;
    let surface = Surface::new(inputs.scene, &inputs.camera, [inputs.settings.size.width, inputs.settings.size.height]);
    let eye = Eye::new(&inputs.camera, size, inputs.scene);
    let corner = [i64::from(window.x), i64::from(window.y)];
    let seen = eye.see(&surface, corner[0], corner[1], window.width as usize, window.height as usize);
    let half = (rays / 2).max(1);
    let done = AtomicUsize::new(0);
    let both: Vec<Option<[f64; 2]>> = seen
        .par_iter()
        .enumerate()
        .map(|(i, s)| {
            let n = done.fetch_add(1, Ordering::Relaxed);
            if n.is_multiple_of(1024) {
                progress(1000 * n / seen.len());
            }
            let cast = |s: &Seen| [0, 1].map(|k| at(&surface, s, radius_mm, half, hash(i as u64, k)));
            s.as_ref().map(cast)
        })
        .collect();
    let mut apart: Vec<f64> = both.iter().flatten().map(|[a, b]| 0.5 * (a - b).abs()).collect();
    apart.sort_by(f64::total_cmp);
    let square: f64 = apart.iter().map(|d| d * d).sum();
    let pixel = |v: &Option<[f64; 2]>| v.map_or([0.; 4], |[a, b]| [0.5 * (a + b), 0.5 * (a + b), 0.5 * (a + b), 1.]);
    Ok(Ambient {
        window,
        pixels: both.iter().map(|v| pixel(v).map(|x| x as f32)).collect(),
        halves: [0, 1].map(|k| both.iter().map(|v| v.map_or(0., |v| v[k])).collect()),
        rms: (square / apart.len().max(1) as f64).sqrt(),
        p99: apart.get(apart.len() * 99 / 100).copied().unwrap_or(0.),
        rays: 2 * half,
        radius_mm,
        seconds: start.elapsed().as_secs_f64(),
    })
}

/// Visibility of one place from `count` rays.
fn at(surface: &Surface<'_>, seen: &Seen, radius: f64, count: usize, seed: u64) -> f64 {
    let place = &seen.place;
    let (a, b) = place.smooth.any_orthonormal_pair();
    let shift = Shift::new(seed);
    let (mut hidden, mut cast) = (0., 0usize);
    for i in 0..count {
        // Uniform over the disc is cosine-weighted over the sky (Malley).
        let [u, v] = shift.lattice(i, count);
        let (sin, cos) = (TAU * v).sin_cos();
        let direction = (a * cos + b * sin) * u.sqrt() + place.smooth * (1. - u).max(0.).sqrt();
        if direction.dot(place.facet) <= 0. {
            continue;
        }
        cast += 1;
        let mut nearest = radius;
        surface.each(place.lifted, direction, surface.slack, radius, |hit, _| {
            if hit.face != place.face {
                nearest = nearest.min(hit.t);
            }
            nearest
        });
        hidden += 1. - (nearest / radius).powi(2);
    }
    1. - hidden / cast.max(1) as f64
}
