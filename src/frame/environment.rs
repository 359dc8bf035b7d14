//! A sky as the device reads it: its picture filtered by GGX lobes level by level, and the constants beside it.

use super::Inputs;
use super::uniforms::EnvironmentBlock;
use crate::scene::Environment;
use crate::skin::profile::Profile;
use crate::skin::sky::{self, Harmonics};
use crate::skin::specular::half_vector_cosine;
use glam::Vec3;
use half::f16;
use rayon::prelude::*;
use std::f32::consts::{PI, TAU};

/// Texels across of the widest level that a background shows.
const MOST: usize = 2048;
/// Texels across of the level that a mirror shows, and of the one for roughness 1.
const MIRROR: usize = 512;
const MATT: usize = 16;
/// Directions drawn for a texel of a filtered level.
const DIRECTIONS: usize = 96;

/// Levels of the picture, each half the size of the one before.
pub struct Filtered {
    /// Texels across and down of each.
    pub sizes: Vec<[u32; 2]>,
    /// RGBA16F, level by level.
    pub bytes: Vec<u8>,
    /// The level that a mirror shows.
    pub first: usize,
}

impl Filtered {
    /// Levels from the picture's own size, 2048 across at most, to 16: plain averages down to 512, from there on filtered by a lobe
    /// seen head on, of a roughness that grows evenly with the level, to 1 (Karis 2013). Radiance beyond halves' range is cut.
    pub fn of(environment: &Environment) -> Filtered {
        let across = 1usize << environment.width.clamp(2 * MATT, MOST).ilog2();
        let mut plain = vec![Level::resampled(environment, across)];
        while let Some(last) = plain.last()
            && last.width > MATT
        {
            plain.push(last.halved());
        }
        let first = plain.iter().position(|l| l.width <= MIRROR).unwrap_or(0);
        let last = plain.len() - 1;
        let levels: Vec<Level> = (0..plain.len())
            .map(|i| {
                if i <= first {
                    plain[i].clone()
                } else {
                    filtered(&plain, i, (i - first) as f32 / (last - first) as f32)
                }
            })
            .collect();
        let half = |x: f32| f16::from_f32(x.min(f16::MAX.to_f32())).to_le_bytes();
        let texel = |p: &Vec3| [half(p.x), half(p.y), half(p.z), half(1.)].concat();
        Filtered {
            sizes: levels.iter().map(|l| [l.width as u32, l.height as u32]).collect(),
            bytes: levels.iter().flat_map(|l| l.texels.iter().flat_map(texel)).collect(),
            first,
        }
    }
}

/// What is known of a sky, whatever scatters under it.
pub struct Bands {
    /// Its light, in its own axes.
    pub harmonics: Harmonics,
    /// Levels of its picture for roughness 0 and 1.
    pub levels: (usize, usize),
}

/// The constants: the sky's bands turned into view space, and how the levels are read.
pub fn block(
    environment: &Environment,
    bands: &Bands,
    inputs: &Inputs<'_>,
    profile: Option<&Profile>,
) -> EnvironmentBlock {
    let Bands { harmonics: sky, levels: (first, last) } = bands;
    let gaussians = profile.map_or(Vec::new(), |p| p.gaussians().gaussians);
    let view_from_world = inputs.camera.view_from_world();
    let view = glam::DMat3::from_mat4(view_from_world.as_dmat4());
    let sky_from_view = environment.sky_from_world() * view.transpose();
    let view_from_sky = sky_from_view.transpose();
    let rows = [0, 1, 2].map(|i| view_from_sky.row(i).to_array());
    let harmonic = sky.turned(rows).polynomial();
    EnvironmentBlock {
        sky_from_view: sky_from_view.as_mat3().to_cols_array_2d(),
        intensity: environment.intensity as f32,
        first: *first as f32,
        last: *last as f32,
        blur: environment.background.unwrap_or(0.) * *last as f32,
        knee: sky::knee(&gaussians) as f32,
        harmonic: harmonic.map(|v| v.map(|x| (x * environment.intensity) as f32)),
    }
}

/// The picture's bands in its own axes, at intensity 1, without ringing.
pub fn harmonics(environment: &Environment) -> Harmonics {
    let texel = |x: usize, y: usize| environment.pixels[y * environment.width + x].map(f64::from);
    let whole = Harmonics::of_rows(environment.width, environment.height, texel);
    whole.without_ringing(least_irradiance(environment))
}

/// The least irradiance, per channel, that a surface can have of the picture: summed over 64 x 32 directions.
fn least_irradiance(environment: &Environment) -> [f64; 3] {
    let coarse = Level::resampled(environment, 64);
    let light: Vec<(Vec3, Vec3)> = (0..coarse.texels.len())
        .map(|i| {
            let [u, v] = [(i % 64) as f32 / 64., (i / 64) as f32 / 32.].map(|x| x + 1. / 128.);
            let d = direction(u, v);
            (d, coarse.texels[i] * (1. - d.y * d.y).sqrt() * (PI / 32.).powi(2))
        })
        .collect();
    let at = |n: [f64; 3]| {
        let n = Vec3::new(n[0] as f32, n[1] as f32, n[2] as f32);
        light.iter().map(|(d, l)| *l * d.dot(n).max(0.)).sum::<Vec3>()
    };
    let least = sky::directions(96).map(at).fold(Vec3::MAX, Vec3::min);
    least.to_array().map(f64::from)
}

/// The most irradiance that the sky can cast: all of its light from straight ahead.
pub fn most_irradiance(sky: &Harmonics, intensity: f64) -> f32 {
    let mean = sky.0[0].iter().fold(0f64, |m, x| m.max(*x));
    (mean * f64::from(4. * PI).sqrt() * intensity) as f32
}

#[derive(Clone)]
struct Level {
    width: usize,
    height: usize,
    texels: Vec<Vec3>,
}

impl Level {
    fn filled(width: usize, texel: impl Fn(usize, usize) -> Vec3 + Sync) -> Level {
        let height = width / 2;
        let row = |y: usize| (0..width).map(|x| texel(x, y)).collect::<Vec<_>>();
        Level { width, height, texels: (0..height).into_par_iter().flat_map_iter(row).collect() }
    }

    /// The picture at a power of two: means of bilinear samples, as many as the texels are wide.
    fn resampled(environment: &Environment, width: usize) -> Level {
        let source = Level {
            width: environment.width,
            height: environment.height,
            texels: environment.pixels.iter().map(|p| Vec3::from(*p)).collect(),
        };
        if source.width == width {
            return source;
        }
        let n = source.width.div_ceil(width).max(1);
        let step = 1. / n as f32;
        Level::filled(width, |x, y| {
            let mut sum = Vec3::ZERO;
            for i in 0..n * n {
                let u = (x as f32 + ((i % n) as f32 + 0.5) * step) / width as f32;
                let v = (y as f32 + ((i / n) as f32 + 0.5) * step) / (width / 2) as f32;
                sum += source.at(u, v);
            }
            sum * step * step
        })
    }

    fn halved(&self) -> Level {
        let texel = |x: usize, y: usize| self.texels[y * self.width + x];
        Level::filled(self.width / 2, |x, y| {
            // Rows nearer to the poles are smaller.
            let weight = |y: usize| (PI * (y as f32 + 0.5) / self.height as f32).sin();
            let (a, b) = (weight(2 * y), weight(2 * y + 1));
            let pair = |y: usize| texel(2 * x, y) + texel(2 * x + 1, y);
            (pair(2 * y) * a + pair(2 * y + 1) * b) / (2. * (a + b))
        })
    }

    /// Bilinear, around in u, held in v.
    fn at(&self, u: f32, v: f32) -> Vec3 {
        let (x, y) = (u * self.width as f32 - 0.5, v * self.height as f32 - 0.5);
        let (fx, fy) = (x - x.floor(), y - y.floor());
        let column = |i: i64| (x.floor() as i64 + i).rem_euclid(self.width as i64) as usize;
        let row = |i: i64| (y.floor() as i64 + i).clamp(0, self.height as i64 - 1) as usize;
        let texel = |i: i64, j: i64| self.texels[row(j) * self.width + column(i)];
        texel(0, 0).lerp(texel(1, 0), fx).lerp(texel(0, 1).lerp(texel(1, 1), fx), fy)
    }
}

fn direction(u: f32, v: f32) -> Vec3 {
    let [x, y, z] = sky::direction([f64::from(u), f64::from(v)]);
    Vec3::new(x as f32, y as f32, z as f32)
}

fn place(d: Vec3) -> [f32; 2] {
    [0.5 - d.x.atan2(d.z) / TAU, 0.5 - d.y.clamp(-1., 1.).asin() / PI]
}

/// A level filtered by the lobe of a roughness, seen head on: light weighted by n.l over half vectors drawn from D(h) n.h, each read
/// where a plain level's texels are as large as its share of the lobe (Krivanek & Colbert 2008).
fn filtered(plain: &[Level], index: usize, roughness: f32) -> Level {
    let alpha = (roughness * roughness).max(2e-3);
    let a2 = alpha * alpha;
    let texel = 4. * PI / plain[0].texels.len() as f32;
    // One set of directions around +Z, turned to each texel.
    let drawn: Vec<(Vec3, f32)> = (0..DIRECTIONS)
        .filter_map(|i| {
            let nh = half_vector_cosine((i as f64 + 0.5) / DIRECTIONS as f64, f64::from(a2)) as f32;
            let (sin, cos) = (2.399_963_2 * i as f32).sin_cos();
            let s = (1. - nh * nh).max(0.).sqrt();
            let l = Vec3::new(2. * nh * s * cos, 2. * nh * s * sin, 2. * nh * nh - 1.);
            let d = nh * nh * (a2 - 1.) + 1.;
            let density = a2 / (PI * d * d) / 4.;
            let level = 0.5 * (1. / (DIRECTIONS as f32 * density * texel)).log2() + 0.5;
            (l.z > 0.).then_some((l, level.clamp(0., (plain.len() - 1) as f32)))
        })
        .collect();
    let total: f32 = drawn.iter().map(|(l, _)| l.z).sum();
    let width = plain[index].width;
    Level::filled(width, |x, y| {
        let n = direction((x as f32 + 0.5) / width as f32, (y as f32 + 0.5) / (width / 2) as f32);
        let (t, b) = n.any_orthonormal_pair();
        let mut sum = Vec3::ZERO;
        for (l, level) in &drawn {
            let [u, v] = place(t * l.x + b * l.y + n * l.z);
            let (low, high) = (*level as usize, (*level as usize + 1).min(plain.len() - 1));
            sum += l.z * plain[low].at(u, v).lerp(plain[high].at(u, v), level.fract());
        }
        sum / total
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sky(radiance: impl Fn(Vec3) -> f32) -> Environment {
        let width = 128;
        let texel = |i: usize| {
            let d =
                direction(((i % width) as f32 + 0.5) / width as f32, ((i / width) as f32 + 0.5) / (width / 2) as f32);
            [radiance(d); 3]
        };
        Environment::new("sky", width, (0..width * width / 2).map(texel).collect()).expect("a sky")
    }

    fn texels(f: &Filtered, level: usize) -> Vec<f32> {
        let before: usize = f.sizes[..level].iter().map(|s| (s[0] * s[1]) as usize).sum();
        let count = (f.sizes[level][0] * f.sizes[level][1]) as usize;
        let half = |b: &[u8]| f16::from_le_bytes([b[0], b[1]]).to_f32();
        f.bytes[8 * before..8 * (before + count)].chunks_exact(8).map(half).collect()
    }

    #[test]
    fn an_even_sky_stays_even_and_a_tilted_one_keeps_its_middle() {
        let even = Filtered::of(&sky(|_| 3.));
        for level in 0..even.sizes.len() {
            assert!(texels(&even, level).iter().all(|x| (x - 3.).abs() < 2e-3), "level {level}");
        }
        // Under 1 + d.y a lobe around d sees 1 + s d.y, s its mean cosine weighted by n.l: by quadrature for roughness 1.
        let tilted = Filtered::of(&sky(|d| 1. + d.y));
        let last = tilted.sizes.len() - 1;
        let (mut sum, mut whole) = (0., 0.);
        for i in 0..4000 {
            let nh = half_vector_cosine((f64::from(i) + 0.5) / 4000., 1.);
            let nl = 2. * nh * nh - 1.;
            if nl > 0. {
                sum += nl * nl;
                whole += nl;
            }
        }
        let slope = (sum / whole) as f32;
        let size = tilted.sizes[last];
        let worst = texels(&tilted, last)
            .iter()
            .enumerate()
            .map(|(i, x)| {
                let d = direction(0.5, ((i as u32 / size[0]) as f32 + 0.5) / size[1] as f32);
                (x - (1. + slope * d.y)).abs()
            })
            .fold(0., f32::max);
        println!("slope {slope:.4}, off {worst:.1e}");
        assert!(worst < 3e-2, "{worst}");
        assert!((slope - 1.).abs() > 0.1, "an unfiltered level would be seen");
    }
}
