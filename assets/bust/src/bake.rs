//! Textures: each texel of the chart is painted for the point of the surface that it covers.

use glam::{DVec2, DVec3, dvec2, dvec3};
use image::{GrayImage, Luma, Rgb, RgbImage};
use rayon::prelude::*;

use crate::mesh::Mesh;
use crate::{paint, sculpt};

/// The thickness that white stands for, mm.
pub const THICKEST: f64 = 40.;

/// Colour (sRGB), occlusion-roughness-metallic, and thickness.
pub struct Textures {
    pub color: RgbImage,
    pub surface: RgbImage,
    pub thickness: GrayImage,
}

/// Paints squares of `size` texels; thickness at a quarter of it.
pub fn bake(mesh: &Mesh, uv: &[DVec2], size: u32) -> Textures {
    let points = cover(mesh, uv, size);
    let painted: Vec<_> = points.par_iter().map(|p| p.map(paint::skin)).collect();
    let color = painted.iter().map(|look| look.map(|l| l.albedo.to_array().map(encode))).collect();
    let coarse = cover(mesh, uv, size / 2);
    let seen: Vec<_> =
        coarse.par_iter().map(|p| p.map(|p| [byte(open(p)), byte(paint::skin(p).roughness), 0])).collect();
    let rough = size / 2;
    let deep = cover(mesh, uv, size / 4);
    let deep: Vec<_> = deep.par_iter().map(|p| p.map(|p| [byte(thickness(p) / THICKEST); 3])).collect();
    let thickness = picture(deep, size / 4);
    let thickness = GrayImage::from_fn(size / 4, size / 4, |x, y| Luma([thickness.get_pixel(x, y).0[0]]));
    Textures { color: picture(color, size), surface: picture(seen, rough), thickness }
}

/// The point of the surface under the middle of each texel.
fn cover(mesh: &Mesh, uv: &[DVec2], size: u32) -> Vec<Option<DVec3>> {
    let mut points = vec![None; (size * size) as usize];
    for t in &mesh.triangles {
        let [a, b, c] = t.map(|i| uv[i as usize] * f64::from(size) - 0.5);
        let area = (b - a).perp_dot(c - a);
        let (low, high) = (a.min(b).min(c).ceil(), a.max(b).max(c).floor());
        for y in low.y as i64..=high.y as i64 {
            for x in low.x as i64..=high.x as i64 {
                let q = dvec2(x as f64, y as f64);
                let (v, w) = ((q - a).perp_dot(c - a) / area, (b - a).perp_dot(q - a) / area);
                if v >= 0.
                    && w >= 0.
                    && v + w <= 1.
                    && (0..i64::from(size)).contains(&x)
                    && (0..i64::from(size)).contains(&y)
                {
                    let [pa, pb, pc] = t.map(|i| mesh.positions[i as usize]);
                    points[(y * i64::from(size) + x) as usize] = Some(pa * (1. - v - w) + pb * v + pc * w);
                }
            }
        }
    }
    points
}

/// Bytes to a picture; texels without one take the mean of their neighbours, outwards, until all have.
fn picture(mut texels: Vec<Option<[u8; 3]>>, size: u32) -> RgbImage {
    let n = i64::from(size);
    let mut edge: Vec<i64> = (0..n * n).filter(|&i| texels[i as usize].is_none()).collect();
    while !edge.is_empty() {
        let near = |i: i64, texels: &[Option<[u8; 3]>]| {
            let (x, y) = (i % n, i / n);
            let mut sum = ([0u32; 3], 0);
            for (dx, dy) in [(-1, 0), (1, 0), (0, -1), (0, 1), (-1, -1), (1, -1), (-1, 1), (1, 1)] {
                let inside = (0..n).contains(&(x + dx)) && (0..n).contains(&(y + dy));
                if let Some(c) = inside.then(|| texels[(i + dy * n + dx) as usize]).flatten() {
                    (0..3).for_each(|k| sum.0[k] += u32::from(c[k]));
                    sum.1 += 1;
                }
            }
            (sum.1 > 0).then(|| sum.0.map(|s| (s / sum.1) as u8))
        };
        let found: Vec<_> = edge.iter().map(|&i| (i, near(i, &texels))).collect();
        if found.iter().all(|(_, c)| c.is_none()) {
            break;
        }
        found.iter().for_each(|&(i, c)| texels[i as usize] = c);
        edge = found.iter().filter(|(_, c)| c.is_none()).map(|&(i, _)| i).collect();
    }
    RgbImage::from_fn(size, size, |x, y| Rgb(texels[(y * size + x) as usize].unwrap_or([128; 3])))
}

/// The eyes: left and right half of the picture, the front in the middle; see [`crate::eyes::chart`].
pub fn eyes(height: u32) -> RgbImage {
    RgbImage::from_fn(2 * height, height, |x, y| {
        let left = x >= height;
        let q = dvec2(f64::from(x % height) + 0.5, f64::from(y) + 0.5) / f64::from(height);
        let p = crate::eyes::point(q);
        let p = if left { p } else { dvec3(-p.x, p.y, p.z) };
        Rgb(paint::eye(p).albedo.to_array().map(encode))
    })
}

/// How open a point is to the sky around it, 0..1, from distances along its normal.
fn open(p: DVec3) -> f64 {
    let n = sculpt::normal(p);
    let mut lost = 0.;
    for (k, h) in [2., 5., 10., 18.].into_iter().enumerate() {
        let free = sculpt::skin(p + h * n).clamp(0., h) / h;
        lost += (1. - free) * 0.5f64.powi(k as i32 + 1);
    }
    (1. - 1.1 * lost).clamp(0., 1.)
}

/// Mean length of a few rays from the point inwards until they leave the body, mm, at most [`THICKEST`].
fn thickness(p: DVec3) -> f64 {
    let n = sculpt::normal(p);
    let (t, b) = n.any_orthonormal_pair();
    let ray = |d: DVec3| {
        let mut along = 1.0;
        while along < THICKEST {
            let inside = -sculpt::skin(p + d * along);
            if inside < 0.02 {
                break;
            }
            along += inside.max(0.5);
        }
        along.min(THICKEST)
    };
    let tilted = [t, -t, b, -b].map(|s| ray((s * 0.5 - n).normalize()));
    (2. * ray(-n) + tilted.iter().sum::<f64>()) / 6.
}

fn byte(x: f64) -> u8 {
    (x.clamp(0., 1.) * 255. + 0.5) as u8
}

/// sRGB from linear.
fn encode(c: f64) -> u8 {
    let c = c.clamp(0., 1.);
    byte(if c <= 0.0031308 { 12.92 * c } else { 1.055 * c.powf(1. / 2.4) - 0.055 })
}
