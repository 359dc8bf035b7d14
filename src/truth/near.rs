//! The near part of the integral at one place: rays along three axes through a disc around it find the surface, whatever
//! its shape; each point found is weighed by what all three axes would have drawn there (King et al. 2013, Veach & Guibas
//! 1995). Creases and folds are no special case.

use super::cloud::Sum;
use super::kernel::Kernel;
use super::lighting;
use super::random::Shift;
use super::surface::{Hit, Place, Surface};
use crate::scene::Light;
use glam::DVec3;
use std::f64::consts::TAU;

/// The surface around places, as a near integral needs it.
pub struct Near<'a> {
    /// What rays meet.
    pub surface: &'a Surface<'a>,
    /// What light falls on it.
    pub lights: &'a [Light],
    /// Whether they cast shadows.
    pub shadows: bool,
    /// The profile.
    pub kernel: &'a Kernel,
    /// Whose surface counts: that of its own materials.
    pub profile: usize,
}

impl Near<'_> {
    /// The near part with `rays` rays along the normal and a quarter of that along each tangent.
    pub fn gather(&self, x: &Place, rays: usize, seed: u64) -> Sum {
        let n = x.smooth;
        let (s, t) = n.any_orthonormal_pair();
        let axes = [(n, s, t, rays), (s, t, n, rays.div_ceil(4)), (t, n, s, rays.div_ceil(4))];
        let end = self.kernel.near_end();
        let mut sum = Sum::default();
        for (k, &(axis, a, b, count)) in axes.iter().enumerate() {
            let shift = Shift::new(seed.wrapping_add(k as u64));
            for i in 0..count {
                let [u, v] = shift.lattice(i, count);
                let radius = self.kernel.draw(u);
                let (sin, cos) = (TAU * v).sin_cos();
                let half = (end * end - radius * radius).max(0.).sqrt();
                let start = x.position + (a * cos + b * sin) * radius - axis * half;
                self.surface.each(start, axis, 0., 2. * half, |hit, _| {
                    self.found(&mut sum, x, &hit, &axes);
                    2. * half
                });
            }
        }
        sum
    }

    fn found(&self, sum: &mut Sum, x: &Place, hit: &Hit, axes: &[(DVec3, DVec3, DVec3, usize); 3]) {
        if self.surface.profile(hit.face) != Some(self.profile) {
            return;
        }
        let y = self.surface.place(hit.face, hit.at);
        let d = y.position - x.position;
        let kernel = self.kernel.near(d.length());
        if kernel == [0.; 3] {
            return;
        }
        // Expected points per mm^2 of surface, all axes together.
        let expected: f64 = axes
            .iter()
            .map(|&(axis, _, _, count)| {
                let along = d.dot(axis);
                let radius = (d.length_squared() - along * along).max(0.).sqrt();
                count as f64 * self.kernel.density(radius) * y.facet.dot(axis).abs()
            })
            .sum();
        if expected > 0. {
            let e = lighting::irradiance(self.surface, self.lights, self.shadows, &y);
            sum.add(kernel.map(|k| k / expected), e);
        }
    }
}
