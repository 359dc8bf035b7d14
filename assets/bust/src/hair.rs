//! Close-cropped hair: where it grows and how thick it stands.

use glam::{DVec3, dvec3};

use crate::sdf::{curve, noise, step};

/// Thickness of the cap, mm.
const CAP: f64 = 3.0;

/// Above zero under the hair, about mm from its edge; `p.x` is not negative.
pub fn cover(p: DVec3) -> f64 {
    // The line of growth by the angle round the head: 0 in front, 180 behind.
    const LINE: [[f64; 2]; 12] = [
        [0., 70.],
        [12., 71.],
        [24., 72.],
        [34., 66.],
        [44., 50.],
        [54., 36.],
        [62., 22.],
        [70., -8.],
        [84., -20.],
        [100., 2.],
        [130., -48.],
        [180., -70.],
    ];
    let angle = p.x.atan2(p.z + 5.).to_degrees();
    let wave = 1.6 * noise(p / 5.) + 0.8 * noise(p / 2.);
    p.y - curve(&LINE, angle) + wave
}

/// How far the hair stands off the skin, mm; `p.x` is not negative.
pub fn thickness(p: DVec3) -> f64 {
    if p.y < -90. {
        return 0.;
    }
    let inside = cover(p);
    if inside < -4. {
        return 0.;
    }
    let strands = 0.4 * noise(dvec3(p.x / 4., p.y / 4., p.z / 7.));
    step(-3., 9., inside) * (CAP + strands)
}
