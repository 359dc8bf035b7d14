//! What the camera sees: one ray through the middle of each pixel, as the renderer rasterises it.

use super::TruthError;
use super::surface::{Place, Surface};
use crate::frame::view::ViewFacts;
use crate::scene::{Camera, Projection, Scene};
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
    /// The window that was asked for, or the whole picture.
    ///
    /// # Errors
    /// Where it is empty or does not lie in the picture.
    pub fn within(asked: Option<Window>, size: [u32; 2]) -> Result<Window, TruthError> {
        let window = asked.unwrap_or(Window { x: 0, y: 0, width: size[0], height: size[1] });
        let ends = [(window.x, window.width, size[0]), (window.y, window.height, size[1])];
        if ends.iter().any(|(at, extent, all)| *extent == 0 || at.checked_add(*extent).is_none_or(|end| end > *all)) {
            return Err(TruthError::Window(window, size[0], size[1]));
        }
        Ok(window)
    }

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
