//! Eyes with their lids, nose and mouth.

use glam::{DVec3, dvec3};

use crate::sdf::{bump, carve, cone, curve, ellipsoid, join, meet, mix, pair, sphere};

/// Centre of the left eyeball and its radius, mm.
pub const EYE: [f64; 3] = [31.5, 0., 67.5];
pub const EYE_RADIUS: f64 = 12.;
/// Corners of the eye, from the middle of the eyeball: towards the nose, towards the temple.
const CANTHI: [[f64; 2]; 2] = [[-14.2, -2.2], [13.6, 0.6]];

/// Edges of the lids above and below, mm above the middle of the eyeball, where `x` is from its middle.
pub fn lids(x: f64) -> [f64; 2] {
    let t = ((x - CANTHI[0][0]) / (CANTHI[1][0] - CANTHI[0][0])).clamp(0., 1.);
    let line = mix(CANTHI[0][1], CANTHI[1][1], t);
    const UPPER: [[f64; 2]; 8] =
        [[0., 0.], [0.06, 1.3], [0.15, 2.9], [0.3, 4.7], [0.45, 5.3], [0.65, 4.8], [0.85, 2.7], [1., 0.]];
    const LOWER: [[f64; 2]; 8] =
        [[0., 0.], [0.08, -0.7], [0.2, -2.0], [0.4, -3.9], [0.6, -4.7], [0.78, -4.1], [0.92, -2.1], [1., 0.]];
    [line + curve(&UPPER, t), line + curve(&LOWER, t)]
}

/// Less than zero between the lids, about mm.
pub fn opening(p: DVec3) -> f64 {
    let (x, y) = (p.x - EYE[0], p.y - EYE[1]);
    let [upper, lower] = lids(x);
    let beyond = (CANTHI[0][0] - x).max(x - CANTHI[1][0]).max(0.);
    let inside = (y - upper).max(lower - y);
    if beyond > 0. { beyond.hypot(inside.max(0.)) } else { inside * 0.8 }
}

/// The hollows around the eye and the lids over the ball.
fn eyes(d: f64, p: DVec3) -> f64 {
    let local = p - DVec3::from(EYE);
    if local.length() > 60. {
        return d;
    }
    let flat = dvec3(p.x, p.y, 0.);
    let mut d = d;
    d += 6.0 * bump(p, [32., 1., 82.], [18., 11., 24.]);
    d += 5.5 * bump(p, [17., 2., 86.], [7.5, 10., 20.]);
    d -= 1.6 * bump(p, [43., 12., 78.], [12., 5., 16.]);
    d = join(d, sphere(p, EYE, EYE_RADIUS + 2.3), 5.);
    let [upper, lower] = lids(local.x);
    // The fold of the upper lid, and the furrow under the lower.
    let width = bump(flat, [EYE[0] - 0.5, 0., 0.], [14., 1e3, 1.]);
    let above = local.y - upper - 3.8 - 0.04 * (local.x + 2.).max(0.);
    d += 1.5 * width * (-(above / 1.1).powi(2)).exp();
    d -= 1.3 * width * (-((above - 3.2) / 2.4).powi(2)).exp();
    let below = local.y - lower + 5.5;
    d += 0.6 * width * (-(below / 2.0).powi(2)).exp();
    d += 1.2 * bump(p, [20., -13., 86.], [9., 4., 20.]);
    // Between the lids only the ball is seen, and the pink flesh in its corners.
    let flesh = sphere(p, EYE, EYE_RADIUS - 0.5).min(sphere(p, [EYE[0] - 12.2, -1.7, EYE[2] + 3.0], 3.8)).min(sphere(
        p,
        [EYE[0] + 11.6, 0.4, EYE[2] + 0.8],
        3.6,
    ));
    let hole = meet(opening(p), -flesh, 0.3).max(EYE[2] - p.z);
    carve(d, hole, 0.9)
}

fn nose(d: f64, p: DVec3) -> f64 {
    if !(-75. ..35.).contains(&p.y) || p.x > 50. || p.z < 60. {
        return d;
    }
    let bridge = cone(p, [0., 8., 84.5], [0., -30., 100.5], 5.6, 7.8);
    let root = cone(p, [0., -10., 84.], [0., -38., 92.], 8., 13.);
    let mut nose = join(bridge, root, 9.);
    let tip = ellipsoid(p, [0., -37.5, 108.], [9.4, 8.8, 10.]);
    nose = join(nose, tip, 8.);
    let wing = ellipsoid(p, [11.6, -41.5, 100.], [5.6, 6.6, 9.5]);
    nose = join(nose, wing, 4.);
    let column = cone(p, [0., -46.5, 99.], [0., -45., 110.], 3.4, 3.2);
    nose = join(nose, column, 4.);
    let d = join(d, nose, 6.);
    // Nostrils run up and towards the tip.
    let axis = dvec3(0.35, -0.55, -0.76).normalize();
    let q = p - dvec3(6.6, -47.2, 104.5);
    let along = q.dot(axis);
    let across = (q - along * axis).length();
    let hole = ((across / 3.1).hypot(along / 6.0) - 1.) * 3.1;
    carve(d, hole, 1.6)
}

/// Where the lips part, mm.
pub fn parting(x: f64) -> f64 {
    const LINE: [[f64; 2]; 6] = [[0., -71.2], [5., -70.4], [11., -70.7], [18., -71.6], [24., -72.0], [30., -72.8]];
    curve(&LINE, x)
}

/// Edges of the red of the lips, above and below, mm.
pub fn vermilion(x: f64) -> [f64; 2] {
    const UPPER: [[f64; 2]; 7] =
        [[0., -63.6], [3., -62.4], [5.5, -62.1], [10., -63.8], [17., -67.0], [23., -70.4], [26.5, -72.2]];
    const LOWER: [[f64; 2]; 6] = [[0., -81.4], [6., -81.2], [12., -79.8], [18., -77.2], [23., -74.2], [26.5, -72.4]];
    [curve(&UPPER, x), curve(&LOWER, x)]
}

fn mouth(d: f64, p: DVec3) -> f64 {
    if !(-110. ..-35.).contains(&p.y) || p.x > 50. || p.z < 50. {
        return d;
    }
    let line = parting(p.x);
    // The arch of the teeth bends the lips back.
    let q = dvec3(p.x, p.y - line, p.z + 0.0105 * p.x * p.x);
    let mut d = d;
    // Philtrum, corners, the folds from the nose.
    d += 1.0 * bump(p, [0., -56., 100.], [3., 6., 20.]) - 0.5 * pair(p, [5., -56.5, 100.], [2.4, 6., 20.]);
    d += 2.0 * bump(p, [28., -72.5, 88.], [4., 4.5, 14.]);
    d -= 1.2 * bump(p, [34., -70., 84.], [6., 9., 14.]);
    let fold = cone(dvec3(p.x, p.y, 0.), [19., -40., 0.], [34., -68., 0.], 0., 0.);
    d += 0.7 * (-(fold / 4.0).powi(2)).exp();
    let dip = 0.8 * (-(p.x / 3.4).powi(2)).exp();
    let upper = ellipsoid(q, [0., 4.2 - dip, 96.4], [25.5, 4.9, 8.0]);
    let pout = ellipsoid(q, [0., 3.0, 98.2], [5.0, 3.6, 6.4]);
    let upper = join(upper, pout, 4.);
    let lower = ellipsoid(q, [0., -4.9, 95.4], [22., 5.8, 8.6]);
    let lips = join(upper, lower, 0.9);
    d = join(d, lips, 4.2);
    let reach = (1. - (p.x / 27.5).powi(2)).max(0.).sqrt();
    d + 1.1 * reach * (-(q.y / 0.9).powi(2)).exp()
}

/// The features added to a head; `p.x` is not negative.
pub fn face(d: f64, p: DVec3) -> f64 {
    if p.z < 20. || !(-125. ..60.).contains(&p.y) {
        return d;
    }
    nose(eyes(mouth(d, p), p), p)
}
