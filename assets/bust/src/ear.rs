//! The ear: a thin plate with a rolled rim, the fold inside it, the bowl, the flap in front of the canal and the lobe.

use glam::{DVec3, dvec3};

use crate::sdf::{carve, cone, ellipsoid, join, meet, sphere, tube};

/// The middle of the ear, and its frame: to the back, up, outwards.
const CENTER: DVec3 = DVec3::new(74.5, -17., -12.);
const FLARE: f64 = 24.;
const TILT: f64 = 14.;

/// The rim from the bowl over the top down to the lobe: back, up, out, radius.
const RIM: [[f64; 4]; 11] = [
    [-4., -3.5, -2.5, 1.6],
    [-11.5, 0., 1.5, 2.1],
    [-14.5, 9., 2.2, 2.3],
    [-12., 20., 2.4, 2.4],
    [-4., 28.5, 2.6, 2.5],
    [6., 30., 3.0, 2.5],
    [14.2, 23.5, 3.4, 2.4],
    [17., 12., 3.2, 2.3],
    [15.2, -1., 2.6, 2.1],
    [10., -12.5, 1.8, 2.0],
    [4., -21., 0.8, 2.4],
];
/// The fold inside the rim.
const FOLD: [[f64; 4]; 6] = [
    [-3.5, -15., 1.2, 2.8],
    [3.5, -12.5, 1.6, 2.6],
    [8., -4.5, 2.2, 2.6],
    [8.6, 5., 2.2, 2.7],
    [5.5, 13.5, 1.4, 2.8],
    [0.5, 21.5, 0.2, 2.6],
];
/// Its lower branch.
const BRANCH: [[f64; 4]; 3] = [[6.8, 9., 1.6, 2.4], [0., 11., 0.4, 2.1], [-9., 11.5, -0.6, 1.8]];
/// Radii of the outline around a point, as a polygon of circles.
const OUTLINE: [[f64; 3]; 4] = [[1., 13., 15.5], [2., 4., 14.5], [-1., -9., 11.], [-4., -20., 7.5]];

fn local(p: DVec3) -> DVec3 {
    let (sf, cf) = FLARE.to_radians().sin_cos();
    let (st, ct) = TILT.to_radians().sin_cos();
    let q = p - CENTER;
    let (back, up) = (-q.z * ct + q.y * -st, q.y * ct - q.z * st);
    // `back` lies in the sagittal plane; the flare turns it outwards.
    dvec3(back * cf + q.x * sf, up, q.x * cf - back * sf)
}

fn outline(q: DVec3) -> f64 {
    let disc = |c: &[f64; 3]| (q.x - c[0]).hypot(q.y - c[1]) - c[2];
    OUTLINE.iter().map(disc).reduce(|a, b| join(a, b, 8.)).unwrap_or(f64::MAX)
}

/// How far a point of the head is from the ear, about mm; `p.x` is not negative.
pub fn apart(p: DVec3) -> f64 {
    let q = local(p);
    outline(q).max(-5. - q.z)
}

/// The ear joined to a head; `p.x` is not negative.
pub fn ear(d: f64, p: DVec3) -> f64 {
    if p.distance_squared(CENTER) > 60. * 60. {
        return d;
    }
    let q = local(p);
    let sheet = (q.z - 0.3).abs() - 1.5;
    let mut ear = meet(outline(q), sheet, 2.5);
    // What holds it to the head, hollowed by the bowl.
    let stalk = cone(q, [-7., 5., -9.], [-7., -9., -9.], 8.5, 8.);
    ear = join(ear, stalk, 5.);
    // The back of the bowl.
    let shell = meet(ellipsoid(q, [-3.2, -4.5, 2.0], [11.5, 14.5, 10.]), q.z - 0.3, 2.);
    ear = join(ear, shell, 4.);
    let bowl = ellipsoid(q, [-3.2, -5.5, 3.0], [8.6, 10.2, 7.4]);
    let cup = ellipsoid(q, [-2.6, 4.8, 2.], [9., 5., 4.2]);
    ear = carve(ear, join(bowl, cup, 3.), 2.2);
    ear = join(ear, tube(q, &FOLD), 2.4);
    ear = join(ear, tube(q, &BRANCH), 2.2);
    ear = join(ear, tube(q, &RIM), 1.6);
    ear = join(ear, ellipsoid(q, [-5., -23., 0.6], [7.2, 7.6, 2.9]), 3.);
    let flap = ellipsoid(q, [-13., -7.5, 2.2], [4., 6., 3.6]);
    let anti = sphere(q, [-4.5, -15.5, 1.6], 3.1);
    let d = join(d, ear, 3.5);
    let canal = cone(q, [-9., -8., -3.], [-16., -8., -10.], 3., 2.5);
    let d = carve(d, canal, 1.5);
    join(join(d, flap, 3.), anti, 2.)
}
