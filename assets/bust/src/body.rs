//! Skull, jaw, neck and shoulders: what carries the face. Origin between the pupils' height and the ear canals; mm.

use glam::DVec3;

use crate::sdf::{bump, cone, curve, ellipsoid, join, meet, pair};

/// Where the vault of the skull begins: above, the loft closes as an ellipsoid.
const VAULT: f64 = 35.;
/// The top of the skull.
pub const CROWN: f64 = 116.;
/// The underside of the bust.
pub const BASE: f64 = -272.;

/// Half width of the head at each height.
const WIDTH: [[f64; 2]; 10] = [
    [-130., 40.],
    [-115., 45.],
    [-100., 50.],
    [-85., 54.],
    [-65., 58.],
    [-45., 62.],
    [-25., 67.],
    [-5., 70.5],
    [15., 73.],
    [35., 75.],
];
/// The middle of the face without nose, lips and chin.
const FRONT: [[f64; 2]; 14] = [
    [-130., 82.],
    [-120., 89.],
    [-112., 93.],
    [-102., 94.5],
    [-90., 94.],
    [-78., 96.],
    [-65., 98.],
    [-50., 98.5],
    [-38., 97.],
    [-22., 93.],
    [-4., 90.],
    [8., 92.],
    [20., 96.],
    [35., 97.],
];
/// The back of the head.
const BACK: [[f64; 2]; 8] =
    [[-130., -25.], [-100., -38.], [-75., -52.], [-50., -67.], [-25., -81.], [-5., -90.], [15., -96.], [35., -98.]];
/// Where the head is widest.
const MIDDLE: [[f64; 2]; 5] = [[-120., 14.], [-60., 8.], [-20., 2.], [10., -6.], [35., -12.]];
/// How square the cross-section is: 2 is an ellipse.
const SQUARE: [[f64; 2]; 6] = [[-120., 2.], [-90., 2.], [-60., 2.05], [-20., 2.15], [15., 2.3], [35., 2.2]];

/// The head without features. `p.x` is not negative.
fn head(p: DVec3) -> f64 {
    let (w, n, z0) = (curve(&WIDTH, p.y), curve(&SQUARE, p.y), curve(&MIDDLE, p.y));
    let (front, back) = (curve(&FRONT, p.y) - z0, z0 - curve(&BACK, p.y));
    let z = p.z - z0;
    let depth = if z > 0. { front } else { back };
    let (u, v, t) = (p.x / w, z.abs() / depth, (p.y - VAULT).max(0.) / (CROWN - VAULT));
    // Powers of the same order, so that one norm closes the vault.
    let q = (u.powf(n) + v.powf(n) + t.powf(n)).max(1e-12).powf(1. / n);
    let part = |x: f64, size: f64| (x / q).powf(n - 1.) / size;
    let slope = (part(u, w).powi(2) + part(v, depth).powi(2) + part(t, CROWN - VAULT).powi(2)).sqrt();
    (q - 1.) / slope.max(1. / 120.)
}

/// What the bones and the fat under the skin add, mm.
fn relief(p: DVec3) -> f64 {
    // Brow ridge and the frontal bosses.
    2.0 * pair(p, [19., 17., 92.], [14., 7., 20.]) + 1.2 * pair(p, [40., 17., 80.], [12., 8., 20.])
        + 1.5 * pair(p, [28., 55., 88.], [22., 18., 30.])
        // Temples.
        - 4.0 * pair(p, [66., 22., 42.], [18., 22., 22.])
        // Cheekbones and their arch, the hollow under them.
        + 4.2 * pair(p, [46., -21., 70.], [17., 11., 20.]) + 2.5 * pair(p, [66., -12., 38.], [12., 8., 24.])
        - 3.5 * pair(p, [55., -58., 52.], [16., 18., 22.])
        // Corner of the jaw, chin and the fold above it.
        + 3.0 * pair(p, [55., -74., 14.], [14., 14., 18.])
        + 6.5 * bump(p, [0., -105., 95.], [16., 10., 18.]) + 1.2 * pair(p, [11., -108., 92.], [9., 8., 14.])
        - 2.2 * bump(p, [0., -88., 96.], [17., 5., 14.])
        // Back of the head.
        + 3.0 * bump(p, [0., -5., -95.], [40., 22., 30.])
}

fn neck(p: DVec3) -> f64 {
    const FRONT: [[f64; 2]; 6] = [[-240., 10.], [-200., 14.], [-165., 27.], [-135., 38.], [-110., 40.], [-60., 25.]];
    const BACK: [[f64; 2]; 6] =
        [[-235., -110.], [-190., -97.], [-150., -85.], [-110., -78.], [-70., -76.], [-30., -74.]];
    const WIDTH: [[f64; 2]; 5] = [[-230., 72.], [-180., 62.], [-130., 57.], [-90., 55.], [-50., 54.]];
    let (front, back, w) = (curve(&FRONT, p.y), curve(&BACK, p.y), curve(&WIDTH, p.y));
    let (z0, depth) = ((front + back) / 2., (front - back) / 2.);
    let (u, v) = (p.x / w, (p.z - z0) / depth);
    let q = u.hypot(v).max(1e-9);
    let slope = (u / w).hypot(v / depth) / q;
    let shaft = (q - 1.) / slope.max(1. / 120.);
    meet(shaft, p.y + 30., 20.)
}

/// Chest and shoulders: the ridge from the neck to the shoulder is a slab under a curve.
fn torso(p: DVec3) -> f64 {
    const RIDGE: [[f64; 2]; 9] = [
        [0., -108.],
        [35., -121.],
        [58., -141.],
        [80., -157.],
        [110., -174.],
        [140., -189.],
        [162., -203.],
        [176., -220.],
        [190., -255.],
    ];
    const STEEP: [[f64; 2]; 5] = [[0., 0.75], [55., 0.66], [90., 0.85], [140., 0.9], [180., 0.6]];
    let top = (p.y - curve(&RIDGE, p.x)) * curve(&STEEP, p.x);
    let slab = meet(top, (p.z + 52.).abs() - 36., 44.);
    let chest = ellipsoid(p, [0., -300., -36.], [160., 118., 82.]);
    let shoulder = ellipsoid(p, [156., -258., -44.], [45., 60., 48.]);
    let mut d = join(join(chest, shoulder, 50.), slab, 36.);
    // Collar bone, the hollow above it, the breastbone between.
    let bone = cone(p, [14., -208., 20.], [75., -209., 10.], 0., 0.).min(cone(
        p,
        [75., -209., 10.],
        [148., -208., -32.],
        0.,
        0.,
    ));
    d -= 3.2 * (-(bone / 9.).powi(2)).exp();
    d += 3.5 * pair(p, [50., -192., 8.], [24., 9., 16.]);
    d + 1.6 * bump(p, [0., -252., 42.], [14., 45., 30.])
}

/// Head, neck and shoulders, mm; `p.x` is not negative.
pub fn body(p: DVec3) -> f64 {
    let mut d = head(p);
    if p.y > -140. {
        d -= relief(p);
    }
    // The underside of the jaw, from the chin up to its corner.
    let under = DVec3::new(0., -0.925, -0.38).dot(p - DVec3::new(0., -117.5, 86.));
    d = meet(d, under, 17.);
    if p.y > 20. {
        return d;
    }
    let mut trunk = neck(p);
    // Sternomastoid, from behind the ear to the breastbone.
    let strap = cone(p, [53., -62., -26.], [12., -202., 17.], 7., 5.);
    trunk = join(trunk, strap, 13.);
    // Larynx.
    trunk -= 2.5 * bump(p, [0., -146., 37.], [8., 12., 12.]);
    d = join(d, trunk, 10.);
    if p.y > -20. {
        return d;
    }
    d = join(d, torso(p), 28.);
    // The pit of the throat is shallow between the straps.
    d -= 1.5 * bump(p, [0., -197., 16.], [8., 14., 16.]);
    d = meet(d, p.x - 183., 30.);
    meet(d, BASE - p.y, 24.)
}
