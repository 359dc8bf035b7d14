//! `metric` of `glsl/curvature.comp`, pixel for pixel.

use super::data::{Data, Screen};
use super::vector::{dot, normal, to_half};
use crate::vectorised;
use rayon::prelude::*;

const FOOTPRINT_BOUND: f32 = 0.5;
const SIDE_RATIO_SQUARED: f32 = 9.;
const CREASE_COS: f32 = 0.5;
const DETERMINANT_FLOOR: f32 = 1e-6;
const AGREE: [f32; 2] = [0.5, 0.9];

/// Distances and normals with a border of background, a pixel wide.
pub struct Bordered {
    z: Vec<f32>,
    code: Vec<u32>,
}

impl Bordered {
    pub fn new(d: &Data) -> Bordered {
        let [w, h] = d.screen.size;
        let mut b = Bordered { z: vec![0.; (w + 2) * (h + 2)], code: vec![0; (w + 2) * (h + 2)] };
        for y in 0..h {
            let at = (y + 1) * (w + 2) + 1;
            b.z[at..at + w].copy_from_slice(&d.z[y * w..][..w]);
            b.code[at..at + w].copy_from_slice(&d.normal[y * w..][..w]);
        }
        b
    }
}

/// H, and the word of K and confidence.
pub fn run(s: &Screen, b: &Bordered, mean: &mut [f32], rest: &mut [u32]) {
    let across = s.size[0];
    let rows = mean.par_chunks_mut(across).zip(rest.par_chunks_mut(across)).enumerate();
    rows.for_each(|(y, (mean, rest))| {
        let three = |i: usize| (y + i) * (across + 2)..(y + i + 1) * (across + 2);
        let z = [0, 1, 2].map(|i| &b.z[three(i)]);
        let code = [0, 1, 2].map(|i| &b.code[three(i)]);
        row(s, y, z, code, mean, rest);
    });
}

vectorised!(row => row_of(s: &Screen, y: usize, z: [&[f32]; 3], code: [&[u32]; 3], mean: &mut [f32], rest: &mut [u32]));

struct Step {
    p: [f32; 3],
    n: [f32; 3],
    usable: bool,
}

struct Centre {
    z: f32,
    n: [f32; 3],
    per_mm: f32,
    unit: [f32; 2],
    slope: [f32; 2],
    slope_step: [f32; 2],
}

#[inline(always)]
fn step(c: &Centre, z: f32, code: u32, side: [f32; 2]) -> Step {
    let e = (z.abs() - c.z.abs()) * c.per_mm;
    let n = normal(code);
    Step {
        p: [
            side[0] * c.unit[0] + e * (c.slope[0] + side[0] * c.slope_step[0]),
            side[1] * c.unit[1] + e * (c.slope[1] + side[1] * c.slope_step[1]),
            -e,
        ],
        n,
        usable: (z * c.z > 0.) & (dot(n, c.n) > CREASE_COS),
    }
}

#[inline(always)]
fn sub(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
fn pick(a: bool, x: [f32; 3], y: [f32; 3]) -> [f32; 3] {
    [if a { x[0] } else { y[0] }, if a { x[1] } else { y[1] }, if a { x[2] } else { y[2] }]
}

/// Differences over the sides that serve, and their number.
#[inline(always)]
fn axis(ahead: &Step, behind: &Step, n0: [f32; 3]) -> ([f32; 3], [f32; 3], f32) {
    let (a2, b2) = (dot(ahead.p, ahead.p), dot(behind.p, behind.p));
    let a = ahead.usable & (!behind.usable | (a2 <= SIDE_RATIO_SQUARED * b2));
    let b = behind.usable & (!ahead.usable | (b2 <= SIDE_RATIO_SQUARED * a2));
    let p = sub(pick(a, ahead.p, [0.; 3]), pick(b, behind.p, [0.; 3]));
    let n = sub(pick(a, ahead.n, n0), pick(b, behind.n, n0));
    (p, n, f32::from(u8::from(a)) + f32::from(u8::from(b)))
}

#[inline(always)]
fn row_of(s: &Screen, y: usize, z: [&[f32]; 3], code: [&[u32]; 3], mean: &mut [f32], rest: &mut [u32]) {
    let across = s.size[0];
    let (z0, z1, z2) = (&z[0][..across + 2], &z[1][..across + 2], &z[2][..across + 2]);
    let (c0, c1, c2) = (&code[0][..across + 2], &code[1][..across + 2], &code[2][..across + 2]);
    let (mean, rest) = (&mut mean[..across], &mut rest[..across]);
    let unit = [s.ray_scale[0] * s.pixels_per_mm, s.ray_scale[1] * s.pixels_per_mm];
    let slope_y = s.ray_scale[1] * (y as f32 + 0.5) + s.ray_offset[1];
    for x in 0..across {
        let centre = z1[x + 1];
        let n0 = normal(c1[x + 1]);
        let per_mm = s.pixels_per_mm / centre.abs();
        let slope = [s.ray_scale[0] * (x as i32 as f32 + 0.5) + s.ray_offset[0], slope_y];
        let c = Centre { z: centre, n: n0, per_mm, unit, slope, slope_step: s.ray_scale };
        let right = step(&c, z1[x + 2], c1[x + 2], [1., 0.]);
        let left = step(&c, z1[x], c1[x], [-1., 0.]);
        let below = step(&c, z2[x + 1], c2[x + 1], [0., 1.]);
        let above = step(&c, z0[x + 1], c0[x + 1], [0., -1.]);
        let (pu, nu, sides_u) = axis(&right, &left, n0);
        let (pv, nv, sides_v) = axis(&below, &above, n0);
        let (e, f, g) = (dot(pu, pu), dot(pu, pv), dot(pv, pv));
        let (l, m, n) = (dot(nu, pu), 0.5 * (dot(nu, pv) + dot(nv, pu)), dot(nv, pv));
        let both = sides_u * sides_v > 0.;
        let measured = [pu[1] * pv[2] - pu[2] * pv[1], pu[2] * pv[0] - pu[0] * pv[2], pu[0] * pv[1] - pu[1] * pv[0]];
        let area2 = dot(measured, measured).max(DETERMINANT_FLOOR * e * g);
        let twice = if both { g * l + e * n - 2. * f * m } else { l + n };
        let over = 1. / (if both { area2 } else { e + g }).max(1e-20);
        let facing = if unit[0] * unit[1] < 0. { -1. } else { 1. };
        let cosine = facing * dot(measured, n0) * over.sqrt();
        let agree = ((cosine - AGREE[0]) / (AGREE[1] - AGREE[0])).clamp(0., 1.);
        let agree = if both { agree } else { 1. };
        let trust = if both { sides_u * sides_v * 0.25 } else { (sides_u + sides_v) * 0.125 };
        let h = 0.5 * twice * over;
        let k = ((l * n - m * m) * over).clamp(-FOOTPRINT_BOUND * FOOTPRINT_BOUND, FOOTPRINT_BOUND * FOOTPRINT_BOUND);
        let confidence = if h.abs() > FOOTPRINT_BOUND { 0. } else { trust * agree };
        let root = if k < 0. { -k.abs().sqrt() } else { k.abs().sqrt() };
        let covered = centre != 0.;
        mean[x] = if covered { h.clamp(-FOOTPRINT_BOUND, FOOTPRINT_BOUND) * per_mm } else { 0. };
        rest[x] = if covered { to_half(root) | to_half(confidence) << 16 } else { 0 };
    }
}
