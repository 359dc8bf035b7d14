//! Whether both did the same work: what 999 of 1000 pixels do not exceed, and a line that names what does not hold.

use super::blur::{Level, Pass};
use super::data::Data;
use super::vector::{half, level as decoded, unorm};

/// Curvature times the pixel's footprint. Both do the same arithmetic: the bits are the same at 999 of 1000 pixels.
const CURVATURE: f32 = 1e-7;
/// Three steps of a level's snorm16: a tap whose pixel is rounded otherwise moves a mean by as much.
const NORMAL: f32 = 1e-4;
/// Light, of 1.
const LIGHT: f32 = 2e-4;
/// Steps of an 8-bit channel.
const PICTURE: f32 = 1.;

fn held(what: &str, mut apart: Vec<f32>, bound: f32) -> Result<f32, String> {
    apart.sort_by(f32::total_cmp);
    let most = apart.get(apart.len() * 999 / 1000).copied().ok_or(format!("{what}: nothing was compared"))?;
    if most <= bound {
        Ok(most)
    } else {
        Err(format!("{what}: {most:e} apart at p99.9, {bound:e} would be the same work"))
    }
}

pub fn curvature(device: &Data, mean: &[f32], rest: &[u32]) -> Result<[f32; 2], String> {
    // The device measures what scatters, whose distance is negative.
    let covered = || (0..mean.len()).filter(|i| device.z[*i] < 0.);
    let footprint = |i: usize| device.z[i].abs() / device.screen.pixels_per_mm;
    let h = covered().map(|i| (mean[i] - device.mean[i]).abs() * footprint(i)).collect();
    let trust = covered().map(|i| (half(rest[i] >> 16) - half(device.rest[i] >> 16)).abs()).collect();
    Ok([held("H q", h, CURVATURE)?, held("confidence", trust, 1e-3)?])
}

pub fn level(device: &Level, own: &Level, pass: Pass) -> Result<[f32; 3], String> {
    // A texel without a surface holds no normal, here, and on the device whatever was there.
    let covered = || (0..own.first.len()).filter(|i| own.first[*i] != 0 || own.second[*i] != 0);
    let both = |i: usize| [device, own].map(|l| level_of(l, i));
    let far = |i: usize| {
        let [(a, _), (b, _)] = both(i);
        (0..3).fold(0f32, |m, k| m.max((a[k] - b[k]).abs()))
    };
    // Curvature where it is one: relative to what the profile feels of it.
    let bent = |i: usize| {
        let [(_, a), (_, b)] = both(i);
        (a - b).abs() / (1. + pass.length_mm.max(a.abs()))
    };
    let dim = |i: usize| {
        let [a, b] = [device, own].map(|l| unorm(l.lit[i]));
        (a[0] - b[0]).abs().max((a[1] - b[1]).abs())
    };
    let apart = [covered().map(far).collect(), covered().map(bent).collect(), covered().map(dim).collect::<Vec<f32>>()];
    let [n, h, lit] = apart;
    Ok([held("mean normal", n, NORMAL)?, held("mean curvature", h, 1e-3)?, held("blurred light", lit, LIGHT)?])
}

fn level_of(l: &Level, i: usize) -> ([f32; 3], f32) {
    decoded([l.first[i], l.second[i]])
}

pub fn picture(device: &[u32], own: &[u32]) -> Result<f32, String> {
    let byte = |word: u32, c: u32| (word >> (8 * c) & 255) as f32;
    let far = |(a, b): (&u32, &u32)| (0..4).fold(0f32, |m, c| m.max((byte(*a, c) - byte(*b, c)).abs()));
    held("picture", device.iter().zip(own).map(far).collect(), PICTURE)
}
