//! Bands of a picture: where methods are known to have trouble, each with its own errors.

use super::eye::{Pixels, Seen, Window};
use super::lighting;
use super::surface::Surface;
use crate::scene::Light;
use rayon::prelude::*;

/// Bits of a pixel's band: where methods are known to have trouble.
pub mod band {
    /// Within 4 pixels of the background or of a step in depth.
    pub const SILHOUETTE: u8 = 1;
    /// |n.l| < 0.2 for some light.
    pub const TERMINATOR: u8 = 2;
    /// Within 2 pixels of where a light's visibility changes, where its n.l > 0.2.
    pub const SHADOW_EDGE: u8 = 4;
    /// Mean curvature below -0.02 over the profile's length: what a concave patch does there is more than rounding.
    pub const CONCAVE: u8 = 8;
}

/// Pixels around a window that bands look at.
pub const BORDER: usize = 4;
/// |n.l| below which a pixel counts as terminator.
const TURNED: f64 = 0.2;
/// A neighbour farther off the tangent plane than this many pixels' footprints is across a step in depth.
const STEP: f64 = 8.;
const SHADOW_BORDER: usize = 2;
/// Mean curvature times the profile's length below which a pixel counts as concave.
const HOLLOW: f64 = -0.02;

/// The bands of a window, from what a window [`BORDER`] pixels larger on every side sees; `length_mm` is the profile's.
pub fn bands(
    surface: &Surface<'_>,
    lights: &[Light],
    shadows: bool,
    seen: &Pixels,
    window: &Window,
    mm_per_pixel: impl Fn(f64) -> f64 + Sync,
    length_mm: f64,
) -> Vec<u8> {
    let stride = window.width as usize + 2 * BORDER;
    // Per pixel and light, up to 32: whether it faces the light, and whether the light reaches it.
    let facing: Vec<(u32, u32, bool)> = seen
        .par_iter()
        .map(|s| {
            let Some(s) = s else { return (0, 0, false) };
            let (mut lit, mut clear, mut turned) = (0u32, 0u32, false);
            for (i, light) in lights.iter().take(32).enumerate() {
                let arrival = lighting::arrives(light, s.place.position);
                let cosine = s.place.normal.dot(arrival.direction);
                turned |= cosine.abs() < TURNED && arrival.irradiance != [0.; 3];
                if cosine > TURNED {
                    lit |= 1 << i;
                    clear |= u32::from(!shadows || lighting::visible(surface, &s.place, &arrival)) << i;
                }
            }
            (lit, clear, turned)
        })
        .collect();
    (0..window.pixels())
        .into_par_iter()
        .map(|i| {
            let (x, y) = (i % window.width as usize + BORDER, i / window.width as usize + BORDER);
            let here = y * stride + x;
            let Some(own) = &seen[here] else { return 0 };
            let mut bits = if facing[here].2 { band::TERMINATOR } else { 0 };
            let apart = STEP * mm_per_pixel(own.depth);
            let mut shape = Shape::default();
            for dy in 0..=2 * BORDER {
                for dx in 0..=2 * BORDER {
                    let there = (y + dy - BORDER) * stride + x + dx - BORDER;
                    let level = |s: &&Seen| (s.place.position - own.place.position).dot(own.place.facet).abs() <= apart;
                    match seen[there].as_ref().filter(level) {
                        None => bits |= band::SILHOUETTE,
                        Some(s) => shape.add(own, s),
                    }
                    let close = dx.abs_diff(BORDER).max(dy.abs_diff(BORDER)) <= SHADOW_BORDER;
                    let both = facing[here].0 & facing[there].0;
                    if close && (facing[here].1 ^ facing[there].1) & both != 0 {
                        bits |= band::SHADOW_EDGE;
                    }
                }
            }
            bits | if shape.mean() * length_mm < HOLLOW { band::CONCAVE } else { 0 }
        })
        .collect()
}

/// The shape operator by least squares over neighbours in the tangent plane, without the normal map: n turns by S d.
#[derive(Default)]
struct Shape {
    moved: [f64; 3],
    turned: [[f64; 2]; 2],
}

impl Shape {
    fn add(&mut self, own: &Seen, other: &Seen) {
        let axes = own.place.smooth.any_orthonormal_pair();
        let flat = |v: glam::DVec3| [v.dot(axes.0), v.dot(axes.1)];
        let (d, n) = (flat(other.place.position - own.place.position), flat(other.place.smooth - own.place.smooth));
        self.moved[0] += d[0] * d[0];
        self.moved[1] += d[0] * d[1];
        self.moved[2] += d[1] * d[1];
        for (i, n) in n.into_iter().enumerate() {
            (0..2).for_each(|k| self.turned[i][k] += n * d[k]);
        }
    }

    /// Mean curvature, 1/mm, convex positive; 0 where the neighbours lie on a line.
    fn mean(&self) -> f64 {
        let ([a, b, c], t) = (self.moved, self.turned);
        let det = a * c - b * b;
        if det <= 1e-9 * a * c { 0. } else { 0.5 * (t[0][0] * c - (t[0][1] + t[1][0]) * b + t[1][1] * a) / det }
    }
}
