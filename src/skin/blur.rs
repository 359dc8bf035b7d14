//! One pass of the cross-bilateral diffusion, in plain loops: the f64 twin of `glsl/blur.comp`.
//!
//! A pass widens a Gaussian on the surface by a variance with the seven-point rule for the plane (Radon 1948; Stroud 1971,
//! E2 r^2 5-1): the centre weighs 1/2, six corners of radius 2 sqrt(variance) in the tangent plane 1/12 each. Each corner is
//! rounded to a pixel and weighed for where that pixel's surface really lies, by 3-D distance (Mikkelsen 2010) and area.

use super::curvature::Camera;
use half::f16;

type V3 = [f64; 3];

/// What the screen shows: distances along the view axis and how they were seen.
#[derive(Clone, Debug)]
pub struct Screen {
    /// Pixels across and down.
    pub size: [usize; 2],
    /// mm, row by row from the top; negated where the surface scatters; 0 background.
    pub z: Vec<f64>,
    /// The projection.
    pub camera: Camera,
}

/// A texel of a level, or of what the first pass reads.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Texel {
    /// Mean normal, not normalised, view space.
    pub n: V3,
    /// H times the profile's length.
    pub h: f64,
    /// Of `h`, 0..1; 1 in a level.
    pub confidence: f64,
    /// Clamped cosine times visibility of two lights, 0..1.
    pub lit: [f64; 2],
}

/// What a pass adds, and between which grids.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pass {
    /// mm^2, above 0.
    pub variance: f64,
    /// Pixels a texel and axis of the source.
    pub source_stride: usize,
    /// Of the target.
    pub target_stride: usize,
    /// The hexagon stands on a side.
    pub turn: bool,
}

/// Least cosine to the eye that an area is divided by.
const LEAST_FACING: f64 = 0.1;

impl Screen {
    /// View ray of a pixel at unit depth; `z` is -1.
    pub fn ray(&self, pixel: [usize; 2]) -> [f64; 2] {
        [0, 1].map(|i| self.camera.ray_scale[i] * (pixel[i] as f64 + 0.5) + self.camera.ray_offset[i])
    }

    /// View-space position of a pixel's surface at distance `z` > 0 (mm).
    pub fn position(&self, pixel: [usize; 2], z: f64) -> V3 {
        let [x, y] = self.ray(pixel);
        let d = if self.camera.perspective { z } else { 1.0 };
        [x * d, y * d, -z]
    }

    /// Unit direction to the eye.
    pub fn towards_eye(&self, p: V3) -> V3 {
        if self.camera.perspective { unit(p.map(|x| -x)) } else { [0.0, 0.0, 1.0] }
    }

    /// Distance of a scattering surface, positive; not above 0 elsewhere.
    pub fn scattering(&self, [x, y]: [usize; 2]) -> f64 {
        -self.z[y * self.size[0] + x]
    }

    /// The pixel that speaks for a texel.
    pub fn representative(&self, texel: [usize; 2], stride: usize) -> [usize; 2] {
        [0, 1].map(|i| (texel[i] * stride + (stride / 2).min(1)).min(self.size[i] - 1))
    }

    /// Texels across and down at a stride.
    pub fn texels(&self, stride: usize) -> [usize; 2] {
        self.size.map(|n| n.div_ceil(stride))
    }
}

impl Texel {
    /// As the level's formats hold it: three snorm16, a half, two unorm16 (`glsl/common/level_code.glsl`).
    pub fn stored(self) -> Texel {
        let snorm = |x: f64| (x.clamp(-1.0, 1.0) * 32767.0).round() / 32767.0;
        let unorm = |x: f64| (x.clamp(0.0, 1.0) * 65535.0).round() / 65535.0;
        let h = f16::from_f64(self.h.clamp(-6e4, 6e4)).to_f64();
        Texel { n: self.n.map(snorm), h, confidence: 1.0, lit: self.lit.map(unorm) }
    }
}

/// The pass. `source` has a texel for each `source_stride` pixels; the result, one for each `target_stride`, is not rounded
/// to the formats ([`Texel::stored`]); where no surface scatters it is the default.
pub fn blur(screen: &Screen, source: &[Texel], pass: &Pass) -> Vec<Texel> {
    let [width, height] = screen.texels(pass.target_stride);
    let mut out = vec![Texel::default(); width * height];
    for (at, texel) in out.iter_mut().enumerate() {
        if let Some(t) = one(screen, source, pass, [at % width, at / width]) {
            *texel = t;
        }
    }
    out
}

fn one(screen: &Screen, source: &[Texel], pass: &Pass, texel: [usize; 2]) -> Option<Texel> {
    let across = screen.texels(pass.source_stride)[0];
    let fetch = |pixel: [usize; 2]| source[pixel[1] / pass.source_stride * across + pixel[0] / pass.source_stride];
    let pixel = screen.representative(texel, pass.target_stride);
    let z = screen.scattering(pixel);
    if z <= 0.0 {
        return None;
    }
    let centre = fetch(pixel);
    let p0 = screen.position(pixel, z);
    let eye = screen.towards_eye(p0);
    let n0 = if dot(centre.n, centre.n) > 0.0 { unit(centre.n) } else { eye };
    let along = dot(n0, eye);
    // In units of a corner's weight the centre weighs 6.
    let mut sum = Sum::default();
    sum.add(&centre, 6.0);
    for corner in corners(screen, pixel, z, n0, eye, pass) {
        for sign in [1.0, -1.0] {
            let wanted = [0, 1].map(|i| pixel[i] as f64 + sign * corner[i]);
            if (0..2).any(|i| wanted[i] < 0.0 || wanted[i] >= screen.size[i] as f64) {
                continue;
            }
            let q = wanted.map(|x| x as usize);
            let seat = if pass.source_stride == 1 {
                q
            } else {
                screen.representative(q.map(|x| x / pass.source_stride), pass.source_stride)
            };
            let far = screen.scattering(seat);
            if far <= 0.0 {
                continue;
            }
            let s = fetch(q);
            let d = sub(screen.position(seat, far), p0);
            let area = along.max(LEAST_FACING) / dot(s.n, eye).max(LEAST_FACING);
            let fall = (2.0 - 0.5 * dot(d, d) / pass.variance) * std::f64::consts::LOG2_E;
            sum.add(&s, fall.clamp(-80.0, 6.0).exp2() * area);
        }
    }
    Some(sum.mean())
}

/// Three of the hexagon's corners in whole pixels from the centre; the others are opposite.
fn corners(screen: &Screen, pixel: [usize; 2], z: f64, n0: V3, eye: V3, pass: &Pass) -> [[f64; 2]; 3] {
    let along = dot(n0, eye);
    let slope = sub(eye, n0.map(|x| x * along));
    let axis = if n0[0].abs() < 0.7 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    // Along the slope and across it: on a grazing surface the images of the two differ most.
    let t = if dot(slope, slope) > 1e-8 { unit(slope) } else { unit(cross(n0, axis)) };
    let b = cross(n0, t);
    let perspective = screen.camera.perspective;
    let ray = screen.ray(pixel);
    let project = |v: V3| {
        [0, 1].map(|i| {
            let scale = 2.0 * pass.variance.sqrt() / (if perspective { z } else { 1.0 } * screen.camera.ray_scale[i]);
            let slide = if perspective { ray[i] * v[2] } else { 0.0 };
            ((v[i] + slide) * scale).clamp(-1e6, 1e6)
        })
    };
    let (first, second) = (project(t), project(b));
    let (a, b) = if pass.turn { (second, first) } else { (first, second) };
    let side = 0.75f64.sqrt();
    [[1.0, 0.0], [0.5, side], [0.5, -side]].map(|[u, v]| [0, 1].map(|i| (u * a[i] + v * b[i]).round()))
}

#[derive(Default)]
struct Sum {
    n: V3,
    weight: f64,
    h: f64,
    h_weight: f64,
    lit: [f64; 2],
}

impl Sum {
    fn add(&mut self, s: &Texel, w: f64) {
        (0..3).for_each(|i| self.n[i] += s.n[i] * w);
        (0..2).for_each(|i| self.lit[i] += s.lit[i] * w);
        self.weight += w;
        self.h += s.h * s.confidence * w;
        self.h_weight += s.confidence * w;
    }

    fn mean(&self) -> Texel {
        Texel {
            n: self.n.map(|x| x / self.weight),
            h: if self.h_weight > 0.0 { self.h / self.h_weight } else { 0.0 },
            confidence: 1.0,
            lit: self.lit.map(|x| x / self.weight),
        }
    }
}

pub(super) fn dot(a: V3, b: V3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn sub(a: V3, b: V3) -> V3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(super) fn unit(a: V3) -> V3 {
    let s = dot(a, a).sqrt();
    a.map(|x| x / s)
}

fn cross(a: V3, b: V3) -> V3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
