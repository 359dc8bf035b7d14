//! The first pass of `glsl/blur.comp` with light (`first_lit`), each texel a pixel.

use super::data::{Data, Screen};
use super::vector::{LANES, Lanes, along, dot, exp2, half, normal, to_half, to_snorm, to_unorm, unit, unorm};
use crate::vectorised;
use rayon::prelude::*;
use std::f32::consts::LOG2_E;

/// What a pass adds, and the unit that curvature is stored in.
#[derive(Clone, Copy)]
pub struct Pass {
    pub variance: f32,
    pub length_mm: f32,
}

/// A level: the two words of its normal and curvature, and the word of its light.
#[derive(Clone, Debug, PartialEq)]
pub struct Level {
    pub first: Vec<u32>,
    pub second: Vec<u32>,
    pub lit: Vec<u32>,
}

impl Level {
    pub fn new(texels: usize) -> Level {
        Level { first: vec![0; texels], second: vec![0; texels], lit: vec![0; texels] }
    }
}

pub fn run(p: Pass, d: &Data, out: &mut Level) {
    let across = d.screen.size[0];
    let words = out.first.par_chunks_mut(across).zip(out.second.par_chunks_mut(across));
    let rows = words.zip(out.lit.par_chunks_mut(across)).enumerate();
    rows.for_each(|(y, ((first, second), lit))| {
        for x in (0..across).step_by(LANES) {
            let n = LANES.min(across - x);
            let mut words = [[0; LANES]; 3];
            if !d.empty(y * across + x, n) {
                block(p, d, [x, y], &mut words);
            }
            first[x..x + n].copy_from_slice(&words[0][..n]);
            second[x..x + n].copy_from_slice(&words[1][..n]);
            lit[x..x + n].copy_from_slice(&words[2][..n]);
        }
    });
}

vectorised!(block => block_of(p: Pass, d: &Data, at: [usize; 2], out: &mut [[u32; LANES]; 3]));

/// What a tap reads.
struct Taps {
    z: Lanes,
    normal: [u32; LANES],
    mean: Lanes,
    rest: [u32; LANES],
    lit: [u32; LANES],
}

#[inline(always)]
fn fetch(d: &Data, at: &[u32; LANES]) -> Taps {
    // Scalar loads: none of these processors gathers faster.
    let mut t = Taps { z: [0.; LANES], normal: [0; LANES], mean: [0.; LANES], rest: [0; LANES], lit: [0; LANES] };
    let length = d.z.len();
    let (z, code, mean, rest, lit) =
        (&d.z[..length], &d.normal[..length], &d.mean[..length], &d.rest[..length], &d.lit[..length]);
    for i in 0..LANES {
        let a = (at[i] as usize).min(length - 1);
        t.z[i] = -z[a];
        t.normal[i] = code[a];
        t.mean[i] = mean[a];
        t.rest[i] = rest[a];
        t.lit[i] = lit[a];
    }
    t
}

#[inline(always)]
fn block_of(p: Pass, d: &Data, at: [usize; 2], out: &mut [[u32; LANES]; 3]) {
    let s: &Screen = &d.screen;
    let [across, down] = [s.size[0] as i32, s.size[1] as i32];
    let zero = [0.; LANES];
    let mut own = [0u32; LANES];
    for i in 0..LANES {
        own[i] = (at[1] as i32 * across + (at[0] as i32 + i as i32).min(across - 1)) as u32;
    }
    let c = fetch(d, &own);
    let (mut n, mut weight, mut h, mut h_weight) = ([zero; 3], [6.; LANES], zero, zero);
    let (mut lit, mut p0, mut v, mut facing) = ([zero; 2], [zero; 3], [zero; 3], zero);
    let mut corner = [[zero; 2]; 3];
    let step = 2. * p.variance.sqrt();
    let ray_y = s.ray_scale[1] * (at[1] as f32 + 0.5) + s.ray_offset[1];
    for i in 0..LANES {
        let z = c.z[i];
        let ray = [s.ray_scale[0] * ((at[0] + i) as i32 as f32 + 0.5) + s.ray_offset[0], ray_y];
        let own = [ray[0] * z, ray[1] * z, -z];
        let eye = unit([-own[0], -own[1], -own[2]]);
        let n0 = normal(c.normal[i]);
        let cosine = dot(n0, eye);
        facing[i] = cosine.max(0.1);
        let slope = along(eye, n0, -cosine);
        let steep = dot(slope, slope);
        let other = if n0[0].abs() < 0.7 { [0., n0[2], -n0[1]] } else { [-n0[2], 0., n0[0]] };
        let flat = steep <= 1e-8;
        let pick = [
            if flat { other[0] } else { slope[0] },
            if flat { other[1] } else { slope[1] },
            if flat { other[2] } else { slope[2] },
        ];
        let t = unit(pick);
        let b = [n0[1] * t[2] - n0[2] * t[1], n0[2] * t[0] - n0[0] * t[2], n0[0] * t[1] - n0[1] * t[0]];
        for k in 0..2 {
            let scale = step / (z * s.ray_scale[k]);
            let first = ((t[k] + ray[k] * t[2]) * scale).clamp(-1e6, 1e6);
            let second = ((b[k] + ray[k] * b[2]) * scale).clamp(-1e6, 1e6) * 0.866_025_4;
            corner[0][k][i] = first.round_ties_even();
            corner[1][k][i] = (0.5 * first + second).round_ties_even();
            corner[2][k][i] = (0.5 * first - second).round_ties_even();
        }
        let light = unorm(c.lit[i]);
        for k in 0..3 {
            n[k][i] = n0[k] * 6.;
            p0[k][i] = own[k];
            v[k][i] = eye[k];
        }
        lit[0][i] = light[0] * 6.;
        lit[1][i] = light[1] * 6.;
        let confidence = half(c.rest[i] >> 16) * 6.;
        h_weight[i] = confidence;
        h[i] = if confidence > 0. { c.mean[i] * p.length_mm * confidence } else { 0. };
    }
    let falloff = 0.5 * LOG2_E / p.variance;
    for tap in 0..6 {
        let side = if tap % 2 == 0 { 1. } else { -1. };
        let by = &corner[tap / 2];
        let (mut place, mut inside, mut moved) = ([0u32; LANES], zero, [zero; 2]);
        for i in 0..LANES {
            let q = [at[0] as i32 + i as i32, at[1] as i32];
            let want = [q[0] + (side * by[0][i]) as i32, q[1] + (side * by[1][i]) as i32];
            let got = [want[0].max(0).min(across - 1), want[1].max(0).min(down - 1)];
            inside[i] = if (got[0] == want[0]) & (got[1] == want[1]) { 1. } else { 0. };
            place[i] = (got[1] * across + got[0]) as u32;
            moved[0][i] = (got[0] - q[0]) as f32;
            moved[1][i] = (got[1] - q[1]) as f32;
        }
        let t = fetch(d, &place);
        for i in 0..LANES {
            let z = t.z[i];
            let own = [p0[0][i], p0[1][i], p0[2][i]];
            let ray = [
                s.ray_scale[0] * ((at[0] + i) as i32 as f32 + 0.5) + s.ray_offset[0] + s.ray_scale[0] * moved[0][i],
                ray_y + s.ray_scale[1] * moved[1][i],
            ];
            let to = [ray[0] * z - own[0], ray[1] * z - own[1], -z - own[2]];
            let there = normal(t.normal[i]);
            let area = facing[i] / dot(there, [v[0][i], v[1][i], v[2][i]]).max(0.1);
            let w = exp2((2. * LOG2_E - dot(to, to) * falloff).clamp(-80., 6.)) * area;
            let w = if (z > 0.) & (inside[i] > 0.) { w } else { 0. };
            weight[i] += w;
            n[0][i] += there[0] * w;
            n[1][i] += there[1] * w;
            n[2][i] += there[2] * w;
            let share = if w > 0. { half(t.rest[i] >> 16) * w } else { 0. };
            h[i] += if share > 0. { t.mean[i] * p.length_mm * share } else { 0. };
            h_weight[i] += share;
            let light = unorm(t.lit[i]);
            lit[0][i] += light[0] * w;
            lit[1][i] += light[1] * w;
        }
    }
    for i in 0..LANES {
        let back = 1. / weight[i];
        let mean = (if h_weight[i] > 0. { h[i] / h_weight[i] } else { 0. }).clamp(-6e4, 6e4);
        let covered = c.z[i] > 0.;
        let words = [
            to_snorm(n[0][i] * back) | to_snorm(n[1][i] * back) << 16,
            to_snorm(n[2][i] * back) | to_half(mean) << 16,
            to_unorm(lit[0][i] * back, 65535.) | to_unorm(lit[1][i] * back, 65535.) << 16,
        ];
        out[0][i] = if covered { words[0] } else { 0 };
        out[1][i] = if covered { words[1] } else { 0 };
        out[2][i] = if covered { words[2] } else { 0 };
    }
}
