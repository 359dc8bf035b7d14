//! `glsl/light.comp` up to what leaves the surface (the rest: `gloss.rs`), for `pdss` and `moments`: two directional lights whose shadows are blurred, levels at full resolution,
//! gloss of two lobes, ambient light with occlusion, tone curve.

use super::blur::Level;
use super::data::{Data, Screen, Table};
use super::gloss::finish;
use super::vector::{LANES, Lanes, along, dot, exp2, level, normal, scaled, unit, unorm};
use crate::vectorised;
use pdss::frame::uniforms::{FrameBlock, LightBlock};
use pdss::skin::specular::Lobes;
use rayon::prelude::*;

/// What both forms read besides the G-buffer.
pub struct Job<'a> {
    pub data: &'a Data,
    pub frame: &'a FrameBlock,
    pub lights: &'a LightBlock,
    pub levels: &'a [Level],
    pub gloss: &'a Table,
    /// Of `pdss`: a channel above the other.
    pub lut: Option<&'a Table>,
    pub lobes: Lobes,
}

pub fn run(j: &Job<'_>, picture: &mut [u32]) {
    let across = j.data.screen.size[0];
    picture.par_chunks_mut(across).enumerate().for_each(|(y, row)| {
        for x in (0..across).step_by(LANES) {
            let n = LANES.min(across - x);
            let mut words = [0; LANES];
            match j.lut {
                _ if j.data.empty(y * across + x, n) => {}
                Some(lut) => pdss(j, lut, [x, y], &mut words),
                None => moments(j, [x, y], &mut words),
            }
            row[x..x + n].copy_from_slice(&words[..n]);
        }
    });
}

vectorised!(pdss => pdss_of(j: &Job<'_>, lut: &Table, at: [usize; 2], out: &mut [u32; LANES]));
vectorised!(moments => moments_of(j: &Job<'_>, at: [usize; 2], out: &mut [u32; LANES]));

pub type V3 = [f32; 3];
pub type Lanes3 = [Lanes; 3];

/// What a block of pixels is, before it is lit.
pub struct Surface {
    pub at: [usize; LANES],
    /// Distance, mm; below 0 where it scatters.
    pub z: Lanes,
    pub n: Lanes3,
    pub v: Lanes3,
    pub sharp: [Lanes; 2],
}

#[inline(always)]
pub fn at(x: &Lanes3, i: usize) -> V3 {
    [x[0][i], x[1][i], x[2][i]]
}

#[inline(always)]
pub fn put(x: &mut Lanes3, i: usize, v: V3) {
    x[0][i] = v[0];
    x[1][i] = v[1];
    x[2][i] = v[2];
}

#[inline(always)]
fn rectified(c: f32, s: f32) -> f32 {
    let z = c.abs() / s.max(1e-8);
    let fall = 1.325_832_6 + z * (1.805_709_8 + z * (0.421_194 + z * 0.032_454_884));
    c.max(0.) + s * exp2(-fall.min(126.))
}

#[inline(always)]
fn moment(n: V3, l: V3) -> f32 {
    let (c, square) = (dot(n, l), dot(n, n));
    let spread = (1. - square).max(0.) * 0.5 * (1. - c * c / square.max(1e-8)).max(0.);
    rectified(c, spread.sqrt())
}

#[inline(always)]
fn occlusion_of(h: f32) -> f32 {
    let c = h.min(0.) * 0.5;
    let square = c * c * 1.25;
    if square <= 1. { 0.5 * square } else { 1. - 0.5 / square }
}

#[inline(always)]
fn surface(d: &Data, place: [usize; 2]) -> Surface {
    let s: &Screen = &d.screen;
    let zero = [0.; LANES];
    let (mut own, mut z, mut code, mut lit) = ([0; LANES], zero, [0; LANES], [0; LANES]);
    for i in 0..LANES {
        own[i] = place[1] * s.size[0] + (place[0] + i).min(s.size[0] - 1);
        z[i] = d.z[own[i]];
        code[i] = d.normal[own[i]];
        lit[i] = d.lit[own[i]];
    }
    let mut f = Surface { at: own, z, n: [zero; 3], v: [zero; 3], sharp: [zero; 2] };
    let ray_y = s.ray_scale[1] * (place[1] as f32 + 0.5) + s.ray_offset[1];
    for i in 0..LANES {
        let ray = [s.ray_scale[0] * ((place[0] + i) as i32 as f32 + 0.5) + s.ray_offset[0], ray_y];
        put(&mut f.v, i, unit([-ray[0] * z[i].abs(), -ray[1] * z[i].abs(), z[i].abs()]));
        put(&mut f.n, i, normal(code[i]));
        let light = unorm(lit[i]);
        f.sharp[0][i] = light[0];
        f.sharp[1][i] = light[1];
    }
    f
}

/// A level of a block, decoded.
#[inline(always)]
fn decoded(l: &Level, own: &[usize; LANES]) -> (Lanes3, Lanes, [Lanes; 2]) {
    let zero = [0.; LANES];
    let (mut n, mut h, mut lit) = ([zero; 3], zero, [zero; 2]);
    let mut words = [[0; LANES]; 3];
    for i in 0..LANES {
        words[0][i] = l.first[own[i]];
        words[1][i] = l.second[own[i]];
        words[2][i] = l.lit[own[i]];
    }
    for i in 0..LANES {
        let (normal, bend) = level([words[0][i], words[1][i]]);
        put(&mut n, i, normal);
        h[i] = bend;
        let light = unorm(words[2][i]);
        lit[0][i] = light[0];
        lit[1][i] = light[1];
    }
    (n, h, lit)
}

/// Bilinear, at coordinates in whole texels, every lane; the table's width and height bound them.
#[inline(always)]
pub fn sample(t: &Table, channel: usize, x: &Lanes, y: &Lanes) -> Lanes {
    let stride = t.size[0] + 1;
    let (mut base, mut fx, mut fy) = ([0u32; LANES], [0.; LANES], [0.; LANES]);
    for i in 0..LANES {
        let (x0, y0) = (x[i].floor(), y[i].floor());
        fx[i] = x[i] - x0;
        fy[i] = y[i] - y0;
        base[i] = (y0 as i32 * stride as i32 + x0 as i32) as u32;
    }
    let plane = &t.channels[channel];
    let mut corner = [[0.; LANES]; 4];
    for i in 0..LANES {
        let a = base[i] as usize;
        corner[0][i] = plane[a];
        corner[1][i] = plane[a + 1];
        corner[2][i] = plane[a + stride];
        corner[3][i] = plane[a + stride + 1];
    }
    let mut out = [0.; LANES];
    for i in 0..LANES {
        let top = corner[0][i] + (corner[1][i] - corner[0][i]) * fx[i];
        let bottom = corner[2][i] + (corner[3][i] - corner[2][i]) * fx[i];
        out[i] = top + (bottom - top) * fy[i];
    }
    out
}

#[inline(always)]
fn pdss_of(j: &Job<'_>, lut: &Table, place: [usize; 2], out: &mut [u32; LANES]) {
    let (f, b) = (surface(j.data, place), j.frame);
    let zero = [0.; LANES];
    let lamps = [&j.lights.light[0], &j.lights.light[1]];
    // Normal, curvature and light of each channel, and the unshadowed cosine of each light.
    let (mut n, mut h, mut lit, mut free) = ([[zero; 3]; 3], [zero; 3], [[zero; 3]; 2], [[zero; 3]; 2]);
    let mut ao = [1f32; LANES];
    for c in 0..3 {
        let share = b.share[0][c];
        for i in 0..LANES {
            put(&mut n[c], i, scaled(at(&f.n, i), share));
        }
        for s in 0..2 {
            for i in 0..LANES {
                lit[s][c][i] = f.sharp[s][i] * share;
                free[s][c][i] = share * dot(at(&f.n, i), lamps[s].position).max(0.);
            }
        }
    }
    for (k, l) in j.levels.iter().enumerate() {
        let (mean, bend, light) = decoded(l, &f.at);
        let occlusion = b.occlusion[k];
        for i in 0..LANES {
            ao[i] = ao[i].min(1. - occlusion[1] * occlusion_of(bend[i] * occlusion[0]));
        }
        let mut open = [zero; 2];
        for s in 0..2 {
            for i in 0..LANES {
                open[s][i] = moment(at(&mean, i), lamps[s].position);
            }
        }
        for c in 0..3 {
            let share = b.share[k + 1][c];
            let bent = if k == 0 { share + b.share[0][c] } else { share };
            for i in 0..LANES {
                let moved = along(at(&n[c], i), at(&mean, i), share);
                put(&mut n[c], i, moved);
                h[c][i] += bend[i] * bent;
            }
            for s in 0..2 {
                for i in 0..LANES {
                    lit[s][c][i] += light[s][i] * share;
                    free[s][c][i] += open[s][i] * share;
                }
            }
        }
    }
    let mut exitance = [zero; 3];
    let knee = b.lut_knee.sqrt();
    for c in 0..3 {
        let (mut v, mut u) = (zero, [zero; 2]);
        for i in 0..LANES {
            let mean = unit(at(&n[c], i));
            let root = (h[c][i].abs() / b.length_mm).min(1e30).sqrt();
            v[i] = root / (root + knee) * (lut.size[1] as f32 - 1.);
            u[0][i] = dot(mean, lamps[0].position);
            u[1][i] = dot(mean, lamps[1].position);
        }
        for u in &mut u {
            for i in 0..LANES {
                let a = u[i].abs().min(1.);
                let t = (4. * a).min((4. * a + 3.) * (1. / 7.));
                let t = if u[i] < 0. { -t } else { t };
                u[i] = (0.5 + 0.5 * t) * (lut.size[0] as f32 - 1.);
            }
        }
        for s in 0..2 {
            let d = sample(lut, c, &u[s], &v);
            for i in 0..LANES {
                let kept = ((lit[s][c][i] + 0.003) / (free[s][c][i] + 0.003)).min(1.);
                exitance[c][i] += d[i] * kept * lamps[s].color[c];
            }
        }
    }
    finish(j, &f, &ao, &exitance, None, out);
}

#[inline(always)]
fn moments_of(j: &Job<'_>, place: [usize; 2], out: &mut [u32; LANES]) {
    let (f, b) = (surface(j.data, place), j.frame);
    let zero = [0.; LANES];
    let lamps = [&j.lights.light[0], &j.lights.light[1]];
    let (mut exitance, mut tilt, mut ao) = ([zero; 3], [zero; 3], [1f32; LANES]);
    for c in 0..3 {
        for i in 0..LANES {
            let own = f.sharp[0][i] * lamps[0].color[c] + f.sharp[1][i] * lamps[1].color[c];
            exitance[c][i] = own * b.sharp[c];
            tilt[c][i] = dot(at(&f.n, i), b.up) * b.sharp[c];
        }
    }
    for (k, l) in j.levels.iter().enumerate() {
        let (mean, bend, light) = decoded(l, &f.at);
        let occlusion = b.occlusion[k];
        for i in 0..LANES {
            ao[i] = ao[i].min(1. - occlusion[1] * occlusion_of(bend[i] * occlusion[0]));
        }
        for c in 0..3 {
            let weight = b.level[k][c];
            for i in 0..LANES {
                exitance[c][i] += weight * (light[0][i] * lamps[0].color[c] + light[1][i] * lamps[1].color[c]);
                tilt[c][i] += weight * dot(at(&mean, i), b.up);
            }
        }
    }
    finish(j, &f, &ao, &exitance, Some(&tilt), out);
}
