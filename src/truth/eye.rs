//! What the camera sees: one ray through the middle of each pixel, as the renderer rasterises it.

use super::lighting;
use super::surface::{Place, Surface};
use crate::frame::setup::ViewFacts;
use crate::scene::{Camera, Light, Projection, Scene};
use glam::DVec3;
use rayon::prelude::*;

/// A window of a picture, pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Window {
    /// Left edge.
    pub x: u32,
    /// Top edge.
    pub y: u32,
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
}

impl Window {
    /// Pixels.
    pub fn pixels(&self) -> usize {
        self.width as usize * self.height as usize
    }
}

/// What is seen through one pixel.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    /// Where.
    pub place: Place,
    /// Distance along the view axis, mm.
    pub depth: f64,
}

/// A pixel with what is around it.
pub type Pixels = Vec<Option<Seen>>;

/// Rays of a camera.
pub struct Eye<'a> {
    camera: &'a Camera,
    facts: ViewFacts,
}

impl<'a> Eye<'a> {
    /// A camera whose whole picture has this size.
    pub fn new(camera: &'a Camera, size: [u32; 2], scene: &Scene) -> Self {
        Self { camera, facts: ViewFacts::new(camera, size, scene.bounds.min, scene.bounds.max) }
    }

    /// What a window sees, row by row from the top; `left` and `top` may lie outside the picture.
    pub fn see(&self, surface: &Surface<'_>, left: i64, top: i64, width: usize, height: usize) -> Pixels {
        (0..width * height)
            .into_par_iter()
            .map(|i| self.through(surface, left + (i % width) as i64, top + (i / width) as i64))
            .collect()
    }

    fn through(&self, surface: &Surface<'_>, x: i64, y: i64) -> Option<Seen> {
        let c = self.camera;
        let (right, up, forward) = (c.right.as_dvec3(), c.up.as_dvec3(), c.forward.as_dvec3());
        let at = [x, y].map(|p| p as f64 + 0.5);
        let [a, b] = std::array::from_fn(|k| self.facts.ray_scale[k] * at[k] + self.facts.ray_offset[k]);
        let eye = c.eye.as_dvec3();
        let (origin, direction): (DVec3, DVec3) = match c.projection {
            Projection::Perspective { .. } => (eye, forward + right * a + up * b),
            Projection::Orthographic { .. } => (eye + right * a + up * b, forward),
        };
        // The direction is of length 1 along the view axis: t is depth.
        let hit = surface.seen(origin, direction, f64::from(c.near_mm), f64::from(c.far_mm))?;
        Some(Seen { place: surface.place(hit.face, hit.at), depth: hit.t })
    }
}

/// Bits of a pixel's band: where methods are known to have trouble.
pub mod band {
    /// Within 4 pixels of the background or of a step in depth.
    pub const SILHOUETTE: u8 = 1;
    /// |n.l| < 0.2 for some light.
    pub const TERMINATOR: u8 = 2;
    /// Within 2 pixels of where a light's visibility changes, where its n.l > 0.2.
    pub const SHADOW_EDGE: u8 = 4;
}

/// Pixels around a window that bands look at.
pub const BORDER: usize = 4;
/// |n.l| below which a pixel counts as terminator.
const TURNED: f64 = 0.2;
/// A neighbour farther off the tangent plane than this many pixels' footprints is across a step in depth.
const STEP: f64 = 8.;
const SHADOW_BORDER: usize = 2;

/// The bands of a window, from what a window [`BORDER`] pixels larger on every side sees.
pub fn bands(
    surface: &Surface<'_>,
    lights: &[Light],
    shadows: bool,
    seen: &Pixels,
    window: &Window,
    mm_per_pixel: impl Fn(f64) -> f64 + Sync,
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
            for dy in 0..=2 * BORDER {
                for dx in 0..=2 * BORDER {
                    let there = (y + dy - BORDER) * stride + x + dx - BORDER;
                    let step = match &seen[there] {
                        None => true,
                        Some(s) => (s.place.position - own.place.position).dot(own.place.facet).abs() > apart,
                    };
                    bits |= if step { band::SILHOUETTE } else { 0 };
                    let close = dx.abs_diff(BORDER).max(dy.abs_diff(BORDER)) <= SHADOW_BORDER;
                    let both = facing[here].0 & facing[there].0;
                    if close && (facing[here].1 ^ facing[there].1) & both != 0 {
                        bits |= band::SHADOW_EDGE;
                    }
                }
            }
            bits
        })
        .collect()
}
