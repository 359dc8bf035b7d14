//! Irradiance with cast shadows: the twin of `light_arrives` in `glsl/common/lights.glsl`, in f64, with rays for shadow maps.

use super::surface::{Place, Surface};
use crate::scene::{Light, LightKind};
use glam::DVec3;

/// Light as it arrives at a place.
#[derive(Clone, Copy, Debug)]
pub struct Arrival {
    /// Unit, towards the light.
    pub direction: DVec3,
    /// mm; infinite for a parallel light.
    pub distance: f64,
    /// Irradiance at normal incidence, RGB.
    pub irradiance: [f64; 3],
}

/// Direction, distance and irradiance at normal incidence. Point and spot lights are in candela: irradiance at one metre.
pub fn arrives(light: &Light, position: DVec3) -> Arrival {
    let color = light.color.map(|c| f64::from(c) * f64::from(light.intensity));
    let (place, cone) = match light.kind {
        LightKind::Directional { direction } => {
            let direction = direction.as_dvec3().normalize_or_zero();
            return Arrival { direction, distance: f64::INFINITY, irradiance: color };
        }
        LightKind::Point { position } => (position, None),
        LightKind::Spot { position, direction, inner_cos, outer_cos } => {
            (position, Some((direction.as_dvec3(), f64::from(inner_cos), f64::from(outer_cos))))
        }
    };
    let d = place.as_dvec3() - position;
    let square = d.length_squared();
    let direction = d.normalize_or_zero();
    // Per square metre; a light nearer than 1 mm is held there.
    let mut falloff = 1e6 / square.max(1.);
    if let Some(range) = light.range_mm {
        let q = square / f64::from(range).powi(2);
        falloff *= (1. - q * q).clamp(0., 1.);
    }
    if let Some((axis, inner, outer)) = cone {
        let t = (((-direction).dot(axis) - outer) / (inner - outer).max(1e-4)).clamp(0., 1.);
        falloff *= t * t;
    }
    Arrival { direction, distance: square.sqrt(), irradiance: color.map(|c| c * falloff) }
}

/// Whether a light reaches a place that faces it.
pub fn visible(surface: &Surface<'_>, place: &Place, arrival: &Arrival) -> bool {
    !surface.hidden(place, arrival.direction, arrival.distance)
}

/// The sum over lights of irradiance, clamped cosine and visibility, RGB.
pub fn irradiance(surface: &Surface<'_>, lights: &[Light], shadows: bool, place: &Place) -> [f64; 3] {
    let mut sum = [0.; 3];
    for light in lights {
        let arrival = arrives(light, place.position);
        let cosine = place.normal.dot(arrival.direction);
        if cosine > 0. && arrival.irradiance != [0.; 3] && (!shadows || visible(surface, place, &arrival)) {
            (0..3).for_each(|c| sum[c] += cosine * arrival.irradiance[c]);
        }
    }
    sum
}
