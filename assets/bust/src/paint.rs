//! Colour and roughness at every point of the surface.

use glam::{DVec3, dvec3};

use crate::ear::apart;
use crate::face::{EYE, EYE_RADIUS, lids, opening, parting, vermilion};
use crate::hair::cover;
use crate::sdf::{bump, cone, mix, noise, step};

/// What a point looks like: linear albedo and perceptual roughness, 0..1.
#[derive(Clone, Copy, Debug)]
pub struct Look {
    pub albedo: DVec3,
    pub roughness: f64,
}

/// Linear from sRGB, 0..255.
fn rgb(r: f64, g: f64, b: f64) -> DVec3 {
    let linear = |c: f64| {
        let c = c / 255.;
        if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
    };
    dvec3(linear(r), linear(g), linear(b))
}

/// Skin, lips, brows and hair at a point of the surface.
pub fn skin(p: DVec3) -> Look {
    let side = p;
    let p = dvec3(p.x.abs(), p.y, p.z);
    let mut albedo = rgb(219., 178., 157.);
    // Blood: cheeks, nose, ears, chin; sallow under the eyes and on the neck; broad mottling.
    let mut blood = 0.55 * bump(p, [46., -28., 75.], [20., 17., 25.])
        + 0.55 * bump(p, [0., -40., 112.], [15., 12., 16.])
        + 0.75 * step(70., 78., p.x) * bump(p, [80., -17., -15.], [40., 40., 28.])
        + 0.25 * bump(p, [0., -104., 98.], [18., 12., 20.])
        + 0.3 * bump(p, [14., -42., 100.], [7., 9., 12.]);
    blood += 0.18 * noise(side / 9.) + 0.16 * noise(side / 4. + 7.) + 0.12 * noise(side / 1.6 + 3.);
    albedo *= DVec3::ONE.lerp(dvec3(1.0, 0.70, 0.66), blood.clamp(-0.5, 1.));
    albedo *= 1. + 0.05 * noise(side / 14. + 31.) + 0.05 * noise(side / 0.8);
    let shade = bump(p, [26., -12., 78.], [14., 6., 16.]) + 0.7 * bump(p, [17., 2., 80.], [6., 8., 16.]);
    albedo *= DVec3::ONE.lerp(dvec3(0.86, 0.80, 0.82), shade.min(1.));
    let mut roughness = 0.54 + 0.06 * noise(side / 1.1) + 0.03 * noise(side / 5.);
    // Oil on forehead, nose and chin.
    let oil = bump(p, [0., 45., 92.], [35., 30., 30.]).max(bump(p, [0., -25., 108.], [10., 28., 22.]));
    roughness -= 0.10 * oil.max(0.6 * bump(p, [0., -104., 98.], [16., 12., 20.]));

    if p.z > 60. && p.y < -50. && p.y > -95. && p.x < 40. {
        let [upper, lower] = vermilion(p.x);
        let out = (p.y - upper).max(lower - p.y);
        let red = step(0.7, -0.7, out) * step(28., 25., p.x);
        let lip = rgb(172., 100., 92.) * (1. + 0.10 * noise(dvec3(side.x / 0.9, side.y / 5., 0.)));
        albedo = albedo.lerp(lip, 0.85 * red);
        roughness = mix(roughness, 0.40, red);
        let gap = (-((p.y - parting(p.x)) / 0.9).powi(2)).exp() * step(28., 25., p.x);
        albedo = albedo.lerp(rgb(104., 52., 48.), 0.75 * gap);
    }
    if p.z > 40. && p.y.abs() < 30. && p.x < 70. {
        albedo = albedo.lerp(rgb(74., 52., 40.), brow(side, p));
        let open = opening(p);
        // Margins of the lids, and the lashes as a dark line on the upper.
        let margin = step(1.6, 0.2, open);
        albedo = albedo.lerp(rgb(186., 128., 112.), 0.7 * margin);
        let flesh = step(-9.5, -11.5, p.x - EYE[0]) * step(0.4, -0.4, open);
        albedo = albedo.lerp(rgb(206., 138., 124.), flesh);
        let [upper, _] = lids(p.x - EYE[0]);
        let lash =
            step(1.3, 0.4, open.abs()) * step(-1.2, 0.2, p.y - EYE[1] - upper + 1.) * step(-11., -6., p.x - EYE[0]);
        albedo = albedo.lerp(rgb(52., 36., 30.), 0.8 * lash);
        roughness = mix(roughness, 0.35, margin);
    }
    let hair = hair(p);
    let strand = noise(dvec3(side.x / 1.0, side.y / 1.6, side.z / 1.6)) + 0.6 * noise(side / 0.6);
    albedo = albedo.lerp(rgb(66., 49., 40.) * (1. + 0.55 * strand), hair);
    roughness = mix(roughness, 0.72, hair);
    Look { albedo, roughness }
}

/// How much of a point is hair, 0..1; `p.x` is not negative.
pub fn hair(p: DVec3) -> f64 {
    if p.y < -90. {
        return 0.;
    }
    let ragged = 2.0 * noise(p / 0.9);
    step(-2.5, 5., cover(p) + ragged) * step(2.5, 5., apart(p) + 0.5 * ragged)
}

/// How much of a point is eyebrow.
fn brow(side: DVec3, p: DVec3) -> f64 {
    let flat = dvec3(p.x, p.y, 0.);
    let line =
        cone(flat, [12., 14., 0.], [37., 22., 0.], 4.2, 3.4).min(cone(flat, [37., 22., 0.], [54., 16., 0.], 3.4, 1.2));
    // Hairs lie along the brow, rising near the nose.
    let rise = mix(0.9, 0., step(12., 30., p.x));
    let along = dvec3(side.x.abs() + rise * p.y, p.y - rise * side.x.abs() * 0.4, side.x.signum() * 9.);
    let hairs =
        noise(dvec3(along.x / 3.0, along.y / 0.7, along.z)) + 0.5 * noise(dvec3(along.x / 1.6, along.y / 0.4, along.z));
    0.85 * step(1.6, -2.2, line + 0.9 * hairs) * (0.72 + 0.28 * hairs).clamp(0., 1.)
}

/// The eyeball: white, iris, pupil, by the direction from its middle.
pub fn eye(p: DVec3) -> Look {
    let side = p;
    let q = dvec3(p.x.abs(), p.y, p.z) - DVec3::from(EYE);
    let r = q.x.hypot(q.y) * EYE_RADIUS / q.length();
    let turn = q.y.atan2(q.x);
    let mut albedo = rgb(226., 217., 208.);
    let veins = (noise(side / 1.2 + 11.).abs() < 0.06) as u8 as f64 * step(7., 11., r);
    albedo = albedo.lerp(rgb(206., 150., 138.), 0.5 * veins + 0.5 * step(8., 12., r));
    let fibre = noise(dvec3(12. * turn.cos(), 12. * turn.sin(), r / 2.))
        + 0.5 * noise(dvec3(25. * turn.cos(), 25. * turn.sin(), r));
    let iris = rgb(104., 86., 60.).lerp(rgb(98., 104., 100.), step(2.8, 4.6, r)) * (1. + 0.35 * fibre);
    let iris = iris * mix(1., 0.35, step(4.9, 5.8, r));
    albedo = albedo.lerp(iris, step(6.1, 5.6, r));
    albedo = albedo.lerp(rgb(12., 10., 10.), step(2.3, 2.0, r));
    Look { albedo, roughness: if q.z < 0. { 0.3 } else { mix(0.06, 0.14, step(5., 7., r)) } }
}
