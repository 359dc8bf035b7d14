//! Both lighting forms in plain loops: the f64 twin of what `glsl/light.comp` scatters, and of how it reads coarse levels.

use super::blur::{Screen, Texel, dot, sub, unit};
use super::lut::Lut;
use super::moments::rectified;
use super::occlusion::{self, Combine, Falloff};

type V3 = [f64; 3];

/// A light as a pixel meets it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lamp {
    /// Unit, view space, towards the light.
    pub l: V3,
    /// At normal incidence.
    pub irradiance: V3,
    /// The channel of `lit` that it has, if its shadow is scattered.
    pub slot: Option<usize>,
    /// Visibility where it has none.
    pub shade: f64,
}

/// Offset in light that keeps the share that shadows leave from 0 over 0.
const DIM: f64 = 0.003;

/// A level as a pixel reads it. Coarse ones are read by four texels, weighted bilinearly and by closeness to the tangent plane
/// (joint bilateral upsampling, Kopf et al. 2007); where none of them holds a surface, `sharp` stands in.
pub fn level_at(screen: &Screen, level: &[Texel], stride: usize, pixel: [usize; 2], n: V3, sharp: [f64; 2]) -> Texel {
    let [across, down] = screen.texels(stride);
    if stride == 1 {
        return level[pixel[1] * across + pixel[0]];
    }
    let z = screen.scattering(pixel).abs();
    let p0 = screen.position(pixel, z);
    let reach = stride as f64 * screen.camera.footprint(z);
    let at = pixel.map(|x| (x as f64 - (stride / 2).min(1) as f64) / stride as f64);
    let mut out = Texel { confidence: 1.0, ..Texel::default() };
    let mut sum = 0.0;
    for corner in 0..4usize {
        let corner = [corner & 1, corner >> 1];
        let place = [0, 1].map(|i| (at[i].floor() + corner[i] as f64).clamp(0.0, [across, down][i] as f64 - 1.0));
        let texel = place.map(|x| x as usize);
        let seat = screen.representative(texel, stride);
        let far = screen.scattering(seat);
        if far <= 0.0 {
            continue;
        }
        let bilinear: f64 = (0..2)
            .map(|i| {
                let t = at[i] - at[i].floor();
                if corner[i] == 1 { t } else { 1.0 - t }
            })
            .product();
        let off = dot(sub(screen.position(seat, far), p0), n) / reach;
        let w = (bilinear + 1e-4) * (-(off * off).min(60.0)).exp();
        let s = &level[texel[1] * across + texel[0]];
        (0..3).for_each(|i| out.n[i] += w * s.n[i]);
        (0..2).for_each(|i| out.lit[i] += w * s.lit[i]);
        out.h += w * s.h;
        sum += w;
    }
    if sum == 0.0 {
        return Texel { n, lit: sharp, ..out };
    }
    Texel { n: out.n.map(|x| x / sum), h: out.h / sum, lit: out.lit.map(|x| x / sum), ..out }
}

/// Scattered clamped cosine of one Gaussian from its mean normal, not normalised: the mean of max(0, n.l), n.l normal with
/// mean n.l and a variance that 1 - |n|^2 tells, even over the tangent plane.
pub fn moment(n: V3, l: V3) -> f64 {
    let (c, square) = (dot(n, l), dot(n, n));
    let tilt = if square > 0.0 { (1.0 - c * c / square).max(0.0) } else { 1.0 };
    rectified(c, (0.5 * (1.0 - square).max(0.0) * tilt).sqrt())
}

/// What a pixel is lit by before it scatters.
fn unscattered(n: V3, sharp: [f64; 2], lamp: &Lamp) -> f64 {
    lamp.slot.map_or(dot(n, lamp.l).max(0.0) * lamp.shade, |s| sharp[s])
}

/// Exitance of unit albedo by `moments`: each level by its weight, what is narrower than a pixel by the sharp normal.
pub fn moments(n: V3, sharp: [f64; 2], levels: &[Texel], weights: &[V3], narrow: V3, lamps: &[Lamp]) -> V3 {
    let mut sum = [0.0; 3];
    for lamp in lamps {
        let own = unscattered(n, sharp, lamp);
        for c in 0..3 {
            let mut lit = narrow[c] * own;
            for (level, weight) in levels.iter().zip(weights) {
                lit += weight[c] * lamp.slot.map_or_else(|| moment(level.n, lamp.l) * lamp.shade, |s| level.lit[s]);
            }
            sum[c] += lit * lamp.irradiance[c];
        }
    }
    sum
}

/// Exitance of unit albedo by `pdss`: each channel's own mix of levels, looked up. `shares` has an entry more than `levels`, the
/// first for the sharp normal; levels hold curvature times `length_mm`.
pub fn pdss(n: V3, sharp: [f64; 2], levels: &[Texel], shares: &[V3], length_mm: f64, lut: &Lut, lamps: &[Lamp]) -> V3 {
    let mut sum = [0.0; 3];
    for c in 0..3 {
        let own = shares[0][c];
        let (mut mixed, mut h, mut lit) = (n.map(|x| x * own), 0.0, sharp.map(|x| x * own));
        for (i, (level, share)) in levels.iter().zip(&shares[1..]).enumerate() {
            (0..3).for_each(|k| mixed[k] += level.n[k] * share[c]);
            (0..2).for_each(|k| lit[k] += level.lit[k] * share[c]);
            // The sharp normal has no curvature worth using: the first level's stands in.
            h += level.h * if i == 0 { share[c] + own } else { share[c] };
        }
        let (mixed, h) = (unit(mixed), h.abs() / length_mm);
        for lamp in lamps {
            let d = f64::from(lut.sample(dot(mixed, lamp.l), h)[c]);
            let kept = match lamp.slot {
                None => lamp.shade,
                Some(s) => {
                    let free = own * dot(n, lamp.l).max(0.0)
                        + levels.iter().zip(&shares[1..]).map(|(x, w)| w[c] * moment(x.n, lamp.l)).sum::<f64>();
                    ((lit[s] + DIM) / (free + DIM)).min(1.0)
                }
            };
            sum[c] += d * kept * lamp.irradiance[c];
        }
    }
    sum
}

/// Ambient visibility from the levels' curvature; `radii` are each level's reach in units of the profile's length.
pub fn ambient(levels: &[Texel], radii: &[f64]) -> f64 {
    let hidden = levels.iter().zip(radii).map(|(l, r)| (1.0, occlusion::from_mean(l.h, *r, Falloff::Quadratic)));
    occlusion::combine(&hidden.collect::<Vec<_>>(), Combine::Max)
}
