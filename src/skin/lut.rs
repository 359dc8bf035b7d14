//! Pre-integration as a table: D(mu, curvature) for one profile, small enough to stay in a texture cache.
//!
//! u runs over mu in two straight pieces, four times as many texels a unit within |mu| < 1/8, where a sharp profile has
//! its terminator, as there would be in one. Unlike a root or a smoothstep, straight pieces that break at texels
//! reproduce max(0, mu), which is the row of curvature 0, exactly, and every mu of a texel is a binary16 number.
//! v runs over x / (x + 1), x the root of |curvature| / knee, so that 0 and infinity are rows of the table, too, and the
//! decades between are evenly served: without the root, the last row stood for all radii below a fifth of a Gaussian's.
//!
//! The GLSL twin is `lut_look_up` in `glsl/common/scattering.glsl`.

use super::profile::{Gaussian, Profile, Shape};
use super::ring::{self, Reading};
use super::sphere;
use half::f16;
use rayon::prelude::*;

/// Width and height of a table, in texels. The width is odd, so that a texel's centre lies at mu = 0.
pub const SIZE: [u32; 2] = [129, 64];
/// The curvature of the middle of the v axis, times the mean radius of the widest channel.
pub const KNEE: f64 = 2.5;
/// A curvature that counts as infinite, 1/mm: at the last row but for a ten-billionth.
pub const MOST_CURVATURE: f64 = 1e30;

/// What is integrated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Integral {
    /// The surface of a sphere ([`sphere`]), normalised. Exact for Gaussians and for Burley's profile.
    Sphere,
    /// Penner & Borshukov 2011, literally ([`Reading::Literal2011`]); a profile that is no sum of Gaussians is fitted.
    RingLiteral,
    /// The ring with one-dimensional Gaussians ([`Reading::OneDimensional`]), likewise.
    Ring,
}

/// A table over (mu, curvature), in binary16 on the device.
#[derive(Clone, Debug, PartialEq)]
pub struct Lut {
    /// Texels across (mu) and down (curvature).
    pub size: [u32; 2],
    /// Row by row from curvature 0; rgb = exitance of unit irradiance and unit albedo divided by the kernel's mass, a = 1.
    /// Rounded to binary16 already, so that what is uploaded is what [`Lut::sample`] reads.
    pub texels: Vec<[f32; 4]>,
    /// Curvature of the middle of the v axis, 1/mm: the GLSL's `knee`.
    pub knee_per_mm: f64,
}

impl Lut {
    /// Integrates `profile`: some tenths of a second on one core.
    pub fn build(profile: &Profile, integral: Integral) -> Lut {
        let length = profile.mean_radius_mm().into_iter().fold(0.0, f64::max);
        // A profile without any extent scatters nothing at any curvature; any knee serves.
        let knee_per_mm = if length > 0.0 { KNEE / length } else { 1.0 };
        let exact = Exact::new(profile, integral);
        let [width, height] = SIZE;
        let rows = (0..height).into_par_iter().flat_map_iter(|y| {
            let v = f64::from(y) / f64::from(height - 1);
            row(&exact.at_curvature(knee_per_mm * (v / (1.0 - v)).powi(2)), width)
        });
        Lut { size: SIZE, texels: rows.collect(), knee_per_mm }
    }

    /// What is uploaded: R16F, red above green above blue, `size` with three times the rows.
    pub fn planes(&self) -> ([u32; 2], Vec<f16>) {
        let plane = |c: usize| self.texels.iter().map(move |t| f16::from_f32(t[c]));
        ([self.size[0], 3 * self.size[1]], (0..3).flat_map(plane).collect())
    }

    /// Texture coordinates within a plane, 0..1 with texel centres at half texels, of `mu` and `curvature` (1/mm, its sign ignored).
    pub fn coordinate(&self, mu: f64, curvature: f64) -> [f64; 2] {
        let a = mu.abs().min(1.0);
        let t = (4.0 * a).min((4.0 * a + 3.0) / 7.0).copysign(mu);
        let root = curvature.abs().min(MOST_CURVATURE).sqrt();
        let place = [0.5 + 0.5 * t, root / (root + self.knee_per_mm.sqrt())];
        let size = self.size.map(f64::from);
        std::array::from_fn(|i| (place[i] * (size[i] - 1.0) + 0.5) / size[i])
    }

    /// What a bilinear sampler returns there: the CPU's twin of the GLSL, with exact fractions.
    ///
    /// Within 1e-3 of the exact integral at every radius for the built-in profiles; at curvature 0
    /// max(0, mu) but for the rounding of the fractions. A GPU that keeps 8 bits of the fraction adds up to 1e-4.
    pub fn sample(&self, mu: f64, curvature: f64) -> [f32; 3] {
        let [u, v] = self.coordinate(mu, curvature);
        let [width, height] = self.size;
        let (x, fx) = split(u, width);
        let (y, fy) = split(v, height);
        std::array::from_fn(|c| {
            let texel = |x: u32, y: u32| f64::from(self.texels[(y * width + x) as usize][c]);
            let row = |y: u32| texel(x, y) + fx * (texel(x + 1, y) - texel(x, y));
            (row(y) + fy * (row(y + 1) - row(y))) as f32
        })
    }
}

/// A row of texels of one curvature's D(mu).
///
/// Whatever the kernel, D(mu) - D(-mu) is linear in mu, since max(0, x) - max(0, -x) is x: half a row gives the other.
fn row(exact: &AtCurvature, width: u32) -> Vec<[f32; 4]> {
    let [from, to] = [exact.at(-1.0), exact.at(1.0)];
    let mut texels = vec![[0.0, 0.0, 0.0, 1.0]; width as usize];
    let last = texels.len() - 1;
    for i in 0..=last / 2 {
        let away = -mu_of(i as f64 / last as f64);
        let dark = exact.at(-away);
        for c in 0..3 {
            texels[i][c] = f16::from_f64(dark[c]).to_f32();
            texels[last - i][c] = f16::from_f64(dark[c] + away * (to[c] - from[c])).to_f32();
        }
    }
    texels
}

/// mu of a place 0..1 along the u axis, the inverse of [`Lut::coordinate`]'s first half.
fn mu_of(place: f64) -> f64 {
    let t = 2.0 * place - 1.0;
    let a = if t.abs() < 0.5 { t.abs() / 4.0 } else { (7.0 * t.abs() - 3.0) / 4.0 };
    a.copysign(t)
}

/// The lower of the two texels that a coordinate lies between, and the way to the upper, 0..1.
fn split(coordinate: f64, size: u32) -> (u32, f64) {
    // A NaN comes out as texel 0: a table must not be read outside, whatever it is asked.
    let place = (coordinate * f64::from(size) - 0.5).max(0.0).min(f64::from(size - 1));
    let lower = (place as u32).min(size - 2);
    (lower, place - f64::from(lower))
}

/// The function that a table approximates.
enum Exact {
    Burley([f64; 3]),
    Sphere(Vec<Gaussian>),
    Ring(Vec<Gaussian>, Reading),
}

/// The same at one curvature.
enum AtCurvature<'a> {
    Burley([sphere::Burley; 3]),
    Sphere(&'a [Gaussian], f64),
    Ring(ring::Mixture),
}

impl Exact {
    fn new(profile: &Profile, integral: Integral) -> Exact {
        match (integral, &profile.shape) {
            (Integral::Sphere, Shape::Burley { d }) => Exact::Burley(*d),
            (Integral::Sphere, Shape::Gaussians(list)) => Exact::Sphere(list.clone()),
            (Integral::RingLiteral, _) => Exact::Ring(profile.gaussians().gaussians, Reading::Literal2011),
            (Integral::Ring, _) => Exact::Ring(profile.gaussians().gaussians, Reading::OneDimensional),
        }
    }

    fn at_curvature(&self, curvature: f64) -> AtCurvature<'_> {
        let radius_mm = curvature.recip();
        match self {
            // A delta stays one however sharp the bend: 0 times infinity is 0 here.
            Exact::Burley(d) => {
                AtCurvature::Burley(d.map(|d| sphere::Burley::new(if d > 0.0 { d * curvature } else { 0.0 })))
            }
            Exact::Sphere(list) => AtCurvature::Sphere(list, radius_mm),
            Exact::Ring(list, reading) => AtCurvature::Ring(ring::Mixture::new(radius_mm, list, *reading)),
        }
    }
}

impl AtCurvature<'_> {
    fn at(&self, mu: f64) -> [f64; 3] {
        match self {
            AtCurvature::Burley(channels) => std::array::from_fn(|c| channels[c].at(mu)),
            AtCurvature::Sphere(list, radius_mm) => sphere::exitance_normalised(mu, *radius_mm, list),
            AtCurvature::Ring(mixture) => mixture.at(mu),
        }
    }
}
