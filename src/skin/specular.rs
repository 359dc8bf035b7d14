//! What a surface reflects of light from everywhere, in f64: the twin of `glsl/common/specular.glsl`, and the table it reads.
//!
//! GGX (Walter et al. 2007) with the height-correlated Smith term (Heitz 2014) and Schlick's Fresnel. One bounce of rough
//! microfacets loses energy; what is lost is given back by 1 + F0 (1/E - 1), E the share that a mirror-like one would reflect
//! in one bounce (Turquin 2019): a white metal under a white sky stays white. What specular takes, diffuse does not get.

use half::f16;
use rayon::prelude::*;
use std::f64::consts::PI;
use std::sync::LazyLock;

/// Least GGX alpha, as in the shader.
const LEAST_ALPHA: f64 = 2e-3;
/// Texels of the table along each axis.
pub const SIDE: usize = 32;
/// Fibonacci numbers: points of the lattice, and the step of its second coordinate.
const POINTS: usize = 2584;
const STEP: usize = 1597;

/// (A, B) of the split sum (Karis 2013): one bounce reflects F0 A + B of a white sky. `nv` = n.v in 0..1, perceptual
/// `roughness` 0..1; half vectors drawn from D(h) n.h, on a Fibonacci lattice: 5e-3 where the eye grazes, else 1e-3.
pub fn split_sum(nv: f64, roughness: f64) -> [f64; 2] {
    let nv = nv.max(1e-4);
    let a2 = (roughness * roughness).max(LEAST_ALPHA).powi(2);
    let across = (1.0 - nv * nv).max(0.0).sqrt();
    let [mut scale, mut bias] = [0.0; 2];
    for i in 0..POINTS {
        let [u, turn] = [i, i * STEP % POINTS].map(|x| (x as f64 + 0.5) / POINTS as f64);
        let nh = half_vector_cosine(u, a2);
        let vh = (1.0 - nh * nh).max(0.0).sqrt() * (PI * turn).cos() * across + nh * nv;
        let nl = 2.0 * vh * nh - nv;
        if nl <= 0.0 || vh <= 0.0 {
            continue;
        }
        let visibility = 0.5 / (nl * (nv * nv * (1.0 - a2) + a2).sqrt() + nv * (nl * nl * (1.0 - a2) + a2).sqrt());
        let weight = 4.0 * visibility * nl * vh / nh;
        let fresnel = (1.0 - vh).powi(5);
        scale += weight * (1.0 - fresnel);
        bias += weight * fresnel;
    }
    [scale, bias].map(|x| x / POINTS as f64)
}

/// n.h of half vectors drawn from D(h) n.h, by a number u in 0..1; `a2` is alpha squared.
pub fn half_vector_cosine(u: f64, a2: f64) -> f64 {
    ((1.0 - u) / (1.0 + (a2 - 1.0) * u)).sqrt()
}

/// Share of a white sky that a lobe reflects, all bounces counted, 0..1.
pub fn albedo([a, b]: [f64; 2], f0: f64) -> f64 {
    (f0 * a + b) * (1.0 + f0 * (1.0 / (a + b) - 1.0))
}

/// (A, B) as halves, [`SIDE`] x [`SIDE`], row after row of roughness 0..1, along the square root of n.v, 0..1, texels at both
/// ends. Made once a process, some hundredths of a second.
pub fn table() -> &'static [[f16; 2]] {
    static TABLE: LazyLock<Vec<[f16; 2]>> = LazyLock::new(|| {
        let texel = |i: usize| {
            let at = [i % SIDE, i / SIDE].map(|x| x as f64 / (SIDE - 1) as f64);
            split_sum(at[0] * at[0], at[1]).map(f16::from_f64)
        };
        (0..SIDE * SIDE).into_par_iter().map(texel).collect()
    });
    &TABLE
}

/// The table as the device reads it: bilinear.
pub fn look_up(nv: f64, roughness: f64) -> [f64; 2] {
    let at = [nv.clamp(0.0, 1.0).sqrt(), roughness].map(|x| x * (SIDE - 1) as f64);
    let base = at.map(|x| (x as usize).min(SIDE - 2));
    let mut sum = [0.0; 2];
    for corner in 0..4usize {
        let step = [corner & 1, corner >> 1];
        let weight: f64 = (0..2)
            .map(|k| {
                let t = at[k] - base[k] as f64;
                if step[k] == 1 { t } else { 1.0 - t }
            })
            .product();
        let texel = table()[(base[1] + step[1]) * SIDE + base[0] + step[0]];
        (0..2).for_each(|k| sum[k] += weight * texel[k].to_f64());
    }
    sum
}

/// Share of a white sky that the sheen of fine hair reflects (Estevez & Kulla 2017: D = (2 + 1/a) sin^(1/a) / 2 pi, here a = 1/2; with
/// the visibility of Neubelt & Pettineo 2013, 1 / 4 (n.l + n.v - n.l n.v)), fitted over n.v: to 4e-3, and 2.1e-2 at the
/// very edge.
pub fn fuzz_albedo(nv: f64) -> f64 {
    let s = nv.clamp(0.0, 1.0).sqrt();
    0.7284 + s * (-0.2018 + s * (-1.6271 + s * (1.9159 - 0.7337 * s)))
}

/// Least alpha of sheen, as in the shader.
const LEAST_SHEEN: f64 = 1e-2;

/// Share of a white sky that white sheen reflects (Estevez & Kulla 2017: D = (2 + 1/a) sin^(1/a) / 2 pi, a = roughness^2; with the
/// visibility of [`fuzz_albedo`]); `nv` = n.v in 0..1, perceptual `roughness` 0..1. Above 1 for smooth sheen seen edge on,
/// where [`Layers`] hold it to 1. By midpoints over the half vector, 1e-3 but for the very edge.
pub fn sheen_albedo(nv: f64, roughness: f64) -> f64 {
    const N: usize = 48;
    let nv = nv.clamp(1e-4, 1.0);
    let power = 1.0 / (roughness * roughness).max(LEAST_SHEEN);
    let across = (1.0 - nv * nv).sqrt();
    let mut sum = 0.0;
    for i in 0..N {
        // Half vectors by D's own share of the angle: sin^(power + 1) ds, the cosine from 0 up.
        let theta = (i as f64 + 0.5) / N as f64 * PI / 2.0;
        let (sine, nh) = theta.sin_cos();
        let d = (2.0 + power) * sine.powf(power) / (2.0 * PI);
        for j in 0..N {
            let vh = sine * ((j as f64 + 0.5) / N as f64 * PI).cos() * across + nh * nv;
            let nl = 2.0 * vh * nh - nv;
            if nl > 0.0 && vh > 0.0 {
                // dl = 4 v.h dh.
                sum += d / (4.0 * (nl + nv - nl * nv)) * nl * 4.0 * vh * sine;
            }
        }
    }
    sum * (PI / 2.0 / N as f64) * (2.0 * PI / N as f64)
}

/// [`sheen_albedo`] as halves, over the axes of [`table`].
pub fn sheen_table() -> &'static [f16] {
    static TABLE: LazyLock<Vec<f16>> = LazyLock::new(|| {
        let texel = |i: usize| {
            let at = [i % SIDE, i / SIDE].map(|x| x as f64 / (SIDE - 1) as f64);
            f16::from_f64(sheen_albedo(at[0] * at[0], at[1]))
        };
        (0..SIDE * SIDE).into_par_iter().map(texel).collect()
    });
    &TABLE
}

/// What lies over a surface: a clear coat of F0 .04 (KHR_materials_clearcoat), under it sheen (KHR_materials_sheen).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layers {
    /// Share of the surface that is coated, 0..1.
    pub coat: f64,
    /// Perceptual, 0..1.
    pub coat_roughness: f64,
    /// Linear RGB, 0..1.
    pub sheen: [f64; 3],
    /// Perceptual, 0..1.
    pub sheen_roughness: f64,
}

impl Layers {
    /// Shares of a white sky: what both reflect, RGB, and what is left for the surface below. With the surface's own that is
    /// never more than 1; coloured sheen swallows what the brightest of its channels takes and the others do not reflect.
    pub fn shares(&self, nv: f64) -> ([f64; 3], f64) {
        let coat = self.coat * albedo(look_up(nv, self.coat_roughness), 0.04);
        let sheen = sheen_albedo(nv, self.sheen_roughness).min(1.0);
        let brightest = self.sheen.iter().copied().fold(0.0, f64::max);
        (self.sheen.map(|c| coat + (1.0 - coat) * c * sheen), (1.0 - coat) * (1.0 - brightest * sheen))
    }
}

/// Both lobes of a surface: roughness is the material's times each factor, held to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lobes {
    /// Factor on the material's roughness, of each lobe, above 0.
    pub roughness: [f64; 2],
    /// Share of the second lobe, 0..1.
    pub mix: f64,
}

impl Lobes {
    /// Share of a white sky that both reflect together.
    pub fn albedo(&self, nv: f64, roughness: f64, f0: f64) -> f64 {
        let one = |factor: f64| albedo(look_up(nv, (roughness * factor).min(1.0)), f0);
        (1.0 - self.mix) * one(self.roughness[0]) + self.mix * one(self.roughness[1])
    }
}
