//! The unit in which light is stored as halves: a power of two, 1 unless the lights are so strong that halves would end.

use crate::scene::{Aabb, Light, LightKind};
use crate::settings::Ambient;
use glam::Vec3;
use std::f32::consts::PI;

/// Irradiance up to this is stored as it is. It leaves a factor of 16 to the largest half, 65504: for light that comes
/// through thin parts, and for gloss.
const PLAIN: f32 = 4096.;

/// What irradiance is divided by before it is stored, and multiplied by afterwards. A power of two: no digit is lost.
/// `sky` is the most irradiance that comes from all around.
pub fn light_unit(lights: &[Light], sky: f32, positions: &[[f32; 3]], bounds: &Aabb) -> f32 {
    let total = |distance: &dyn Fn(Vec3) -> f32| sky + lights.iter().map(|l| strongest(l, distance)).sum::<f32>();
    // The box is soon asked; each vertex only where the box does not settle it.
    if total(&|p| (p.clamp(bounds.min, bounds.max) - p).length()) <= PLAIN {
        return 1.;
    }
    // A face can be nearer than its vertices.
    let nearest = |p: Vec3| {
        let square = positions.iter().map(|q| (Vec3::from(*q) - p).length_squared()).fold(f32::INFINITY, f32::min);
        0.5 * square.sqrt()
    };
    let most = total(&nearest);
    if most <= PLAIN || !most.is_finite() { 1. } else { (most / PLAIN).log2().ceil().exp2() }
}

/// The most irradiance that a sky of two colours casts.
pub fn of_ambient(ambient: &Ambient) -> f32 {
    PI * ambient.up.iter().chain(&ambient.down).fold(0f32, |m, x| m.max(*x))
}

/// The most irradiance that a light can cast, at normal incidence.
fn strongest(light: &Light, distance: &dyn Fn(Vec3) -> f32) -> f32 {
    let peak = light.color.iter().fold(0f32, |m, c| m.max(*c)) * light.intensity;
    match light.kind {
        LightKind::Directional { .. } => peak,
        // As `light_arrives` in glsl/common/lights.glsl: at one metre, and held to 1 mm.
        LightKind::Point { position } | LightKind::Spot { position, .. } => {
            peak * 1e6 / distance(position).powi(2).max(1.)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_strong_light_has_room_and_a_weak_one_is_left_alone() {
        let corner = [[0.; 3], [10., 10., 10.]];
        let unit = |lights: &[Light]| {
            light_unit(lights, of_ambient(&Ambient { up: [0.1; 3], down: [0.; 3] }), &corner, &Aabb::around(&corner))
        };
        assert_eq!(unit(&[Light::directional(0., 0., 1000.)]), 1.);
        for strength in [5e3, 1e6, 3e30] {
            let u = unit(&[Light::directional(0., 0., strength)]);
            assert!(u.log2().fract() == 0. && strength / u <= PLAIN && strength / u > 0.25 * PLAIN, "{strength}: {u}");
        }
        let point = |position: Vec3| Light {
            kind: LightKind::Point { position },
            color: [1.; 3],
            intensity: 100.,
            range_mm: None,
        };
        // 100 at a metre is 1e8 on the surface, and 1 ten metres away.
        assert_eq!(unit(&[point(Vec3::ZERO)]), 32768.);
        assert_eq!(unit(&[point(Vec3::splat(6000.))]), 1.);
    }
}
