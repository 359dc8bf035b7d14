//! What a camera comes to in pixels.

use super::levels::Magnification;
use crate::scene::{Camera, Projection};
use glam::Vec3;

/// The camera as screen stages see it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViewFacts {
    /// View x, y per pixel at unit distance, or in mm for a parallel projection.
    pub ray_scale: [f64; 2],
    /// So that ray = scale * (pixel + 1/2) + offset.
    pub ray_offset: [f64; 2],
    /// 1 perspective, 0 parallel.
    pub perspective: f32,
    /// Pixels per mm at unit distance.
    pub pixels_per_mm: f64,
    /// Pixels per mm where the scene is.
    pub magnification: Magnification,
}

impl ViewFacts {
    /// The facts of a camera over a box of the scene, mm.
    pub(crate) fn new(camera: &Camera, size: [u32; 2], min: Vec3, max: Vec3) -> Self {
        let [w, h] = size.map(f64::from);
        let (half_height, perspective) = match camera.projection {
            Projection::Perspective { fov_y } => ((f64::from(fov_y) / 2.).tan(), 1.),
            Projection::Orthographic { height_mm } => (f64::from(height_mm) / 2., 0.),
        };
        let pixels_per_mm = h / (2. * half_height);
        let distances = (0..8).map(|i| {
            let corner = Vec3::select(glam::BVec3::new(i & 1 > 0, i & 2 > 0, i & 4 > 0), max, min);
            f64::from((corner - camera.eye).dot(camera.forward))
        });
        let middle = f64::from(((min + max) / 2. - camera.eye).dot(camera.forward));
        let nearest = distances.fold(f64::INFINITY, f64::min).max(f64::from(camera.near_mm)).max(middle * 1e-3);
        let at = |d: f64| if perspective > 0. { pixels_per_mm / d.max(f64::MIN_POSITIVE) } else { pixels_per_mm };
        ViewFacts {
            // Square pixels: the vertical field of view sets both.
            ray_scale: [2. * half_height / h, -2. * half_height / h],
            ray_offset: [-half_height * w / h, half_height],
            perspective,
            pixels_per_mm,
            magnification: Magnification { nearest: at(nearest), middle: at(middle.max(nearest)) },
        }
    }
}
