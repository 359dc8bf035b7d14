//! Exposure as a photographer sets it who holds a meter where the scene is: by the light that arrives, not by what it falls on.

use super::environment;
use crate::scene::{Camera, Environment, Light, LightKind};
use crate::skin::sky;
use glam::{Mat3, Vec3};

const LUMINANCE: [f64; 3] = [0.2126, 0.7152, 0.0722];

/// Stops for a sky and the lights beside it as they shine at `place` (mm), by which a white surface under the light that is
/// metered comes to 1, as one that faces the default key does. Two readings, averaged in stops (the duplex method): with the
/// meter turned to the eye, and with it turned to where most light comes from, so that what is lit from behind is neither black
/// nor the rest burnt out. 0 where there is no light.
pub fn stops(environment: &Environment, lights: &[Light], place: Vec3, camera: &Camera) -> f32 {
    let world_from_sky = environment.sky_from_world().transpose();
    let mut light = environment::harmonics(environment).turned([0, 1, 2].map(|i| world_from_sky.row(i).to_array()));
    light.0.iter_mut().flatten().for_each(|x| *x *= environment.intensity);
    for Light { kind, color, intensity, .. } in lights {
        let (from, falloff) = match *kind {
            LightKind::Directional { direction } => (direction, 1.),
            LightKind::Point { position } | LightKind::Spot { position, .. } => {
                ((position - place).normalize_or_zero(), 1e6 / (position - place).length_squared().max(1.))
            }
        };
        light.add(from.as_dvec3().to_array(), color.map(|c| f64::from(c * intensity * falloff)));
    }
    let reading = |n: [f64; 3]| light.irradiance(n).iter().zip(LUMINANCE).map(|(e, w)| e * w).sum::<f64>().max(0.);
    let eye = reading((Mat3::from_mat4(camera.world_from_view()) * Vec3::Z).as_dvec3().to_array());
    let most = sky::directions(512).map(reading).fold(eye, f64::max);
    // An eye that sees nothing lit counts as eight stops below, not as none.
    let mean = (eye.max(most / 256.) * most).sqrt();
    if mean > 0. { (std::f64::consts::PI / mean).log2() as f32 } else { 0. }
}
