//! Light of a whole sky: spherical harmonics up to band 2, irradiance from them, and what scattering leaves of each band.
//!
//! Irradiance at a normal is the sky convolved with the clamped cosine, which keeps pi, 2 pi/3 and pi/4 of bands 0, 1 and 2, nothing
//! of band 3, and little of the rest (Ramamoorthi & Hanrahan 2001). Scattering on a sphere is one more convolution: a Gaussian
//! of chord distance is a von Mises-Fisher lobe (see [`sphere`](super::sphere)), and keeps R_l of band l. So light that scatters costs two factors a
//! channel, and band 0 stays what it was. Radiance is linear; directions are unit, in the sky's own axes, +Y up.

use super::profile::Gaussian;
use super::sphere::sharpness;
use std::f64::consts::PI;

type V3 = [f64; 3];

/// What the clamped cosine keeps of each band.
pub const COSINE: V3 = [PI, 2.0 * PI / 3.0, PI / 4.0];

/// Factors of the basis: of 1; of x, y, z; of xy, yz, zx; of 3 z^2 - 1; of x^2 - y^2.
const BASIS: [f64; 5] = [
    0.282_094_791_773_878_1,
    0.488_602_511_902_919_9,
    1.092_548_430_592_079,
    0.315_391_565_252_52,
    0.546_274_215_296_039_5,
];

/// A sky's radiance up to band 2: nine coefficients a channel, in the order 1, x, y, z, xy, yz, zx, 3 zz - 1, xx - yy.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Harmonics(pub [V3; 9]);

/// The band of each coefficient.
const BAND: [usize; 9] = [0, 1, 1, 1, 2, 2, 2, 2, 2];

fn basis([x, y, z]: V3) -> [f64; 9] {
    let [one, linear, cross, axis, across] = BASIS;
    [
        one,
        linear * x,
        linear * y,
        linear * z,
        cross * x * y,
        cross * y * z,
        cross * z * x,
        axis * (3.0 * z * z - 1.0),
        across * (x * x - y * y),
    ]
}

/// The direction that a place of a latitude-longitude picture shows, both coordinates 0..1 from the upper left: the middle is
/// +Z, left of it +X (OpenEXR's convention: the picture as it is seen from within).
pub fn direction(place: [f64; 2]) -> V3 {
    let (longitude, latitude) = ((0.5 - place[0]) * 2.0 * PI, (0.5 - place[1]) * PI);
    [latitude.cos() * longitude.sin(), latitude.sin(), latitude.cos() * longitude.cos()]
}

impl Harmonics {
    /// The projection of a latitude-longitude picture, `radiance` by row from the top. Each texel counts by its exact solid angle
    /// and is taken as a point in its middle: an error of a part in (texels across)^2.
    pub fn of_rows<R>(width: usize, height: usize, rows: R) -> Harmonics
    where
        R: Fn(usize, usize) -> V3 + Sync,
    {
        use rayon::prelude::*;
        let row = |y: usize| {
            let edge = |y: usize| ((0.5 - y as f64 / height as f64) * PI).sin();
            let texel = (edge(y) - edge(y + 1)) * 2.0 * PI / width as f64;
            let mut sum = Harmonics::default();
            for x in 0..width {
                let at = [(x as f64 + 0.5) / width as f64, (y as f64 + 0.5) / height as f64];
                sum.add(direction(at), rows(x, y).map(|l| l * texel));
            }
            sum
        };
        (0..height).into_par_iter().map(row).reduce(Harmonics::default, |mut a, b| {
            a.0.iter_mut().zip(b.0).for_each(|(a, b)| (0..3).for_each(|c| a[c] += b[c]));
            a
        })
    }

    /// Adds light from one direction: radiance times solid angle, which is irradiance at normal incidence.
    pub fn add(&mut self, from: V3, light: V3) {
        for (sum, y) in self.0.iter_mut().zip(basis(from)) {
            (0..3).for_each(|c| sum[c] += y * light[c]);
        }
    }

    /// Radiance from a direction: the sky as three bands know it.
    pub fn radiance(&self, from: V3) -> V3 {
        self.weighted(from, [[1.0; 3]; 3])
    }

    /// Irradiance at a unit normal. Three bands of a small bright light are up to 4 % of it below 0 on the side that looks away.
    pub fn irradiance(&self, n: V3) -> V3 {
        self.scattered(n, [[1.0; 3]; 3])
    }

    /// The same sky with bands 1 and 2 weakened, all channels alike, just so far that irradiance nowhere falls below half of the least
    /// there is, `least` per channel (the sky's own, summed without harmonics). Three bands of a sun swing below 0 behind it, in some
    /// channels before others: black patches, and coloured ones. At worst bands 1 and 2 keep 3/4 and 2/5: the clamped cosine is then
    /// 3/16 (1 + n.l)^2, which is nowhere negative, and of all such forms of two bands has the highest peak, 3/4 of the cosine's. A
    /// sky that three bands hold is left as it is.
    pub fn without_ringing(&self, least: V3) -> Harmonics {
        let weakened = |t: f64| {
            let mut out = *self;
            for (sum, band) in out.0.iter_mut().zip(BAND) {
                *sum = sum.map(|x| x * (1.0 - t * [0.0, 0.25, 0.6][band]));
            }
            out
        };
        let holds = |sky: &Harmonics| {
            directions(256).all(|n| sky.irradiance(n).iter().zip(least).all(|(have, least)| *have >= 0.5 * least))
        };
        if holds(self) {
            return *self;
        }
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..24 {
            let middle = 0.5 * (low + high);
            if holds(&weakened(middle)) { high = middle } else { low = middle }
        }
        weakened(high)
    }

    /// Irradiance of which scattering has left `kept[l]` of band l, per channel (see [`kept`]).
    pub fn scattered(&self, n: V3, kept: [V3; 3]) -> V3 {
        self.weighted(n, std::array::from_fn(|l| kept[l].map(|k| k * COSINE[l])))
    }

    fn weighted(&self, n: V3, bands: [V3; 3]) -> V3 {
        let mut sum = [0.0; 3];
        for (i, y) in basis(n).into_iter().enumerate() {
            (0..3).for_each(|c| sum[c] += bands[BAND[i]][c] * y * self.0[i][c]);
        }
        sum
    }

    /// The same light in other axes: `rows` turns a direction of this sky into the new axes (a rotation).
    pub fn turned(&self, rows: [V3; 3]) -> Harmonics {
        let [_, _, cross, axis, across] = BASIS;
        let mut out = *self;
        for c in 0..3 {
            let k: [f64; 9] = std::array::from_fn(|i| self.0[i][c]);
            for (turned, row) in out.0[1..4].iter_mut().zip(rows) {
                turned[c] = row.iter().zip(&k[1..4]).map(|(a, b)| a * b).sum();
            }
            // Band 2 is a symmetric form without trace.
            let (xy, yz, zx) = (0.5 * cross * k[4], 0.5 * cross * k[5], 0.5 * cross * k[6]);
            let (zz, xx) = (axis * k[7], across * k[8]);
            let form = [[xx - zz, xy, zx], [xy, -xx - zz, yz], [zx, yz, 2.0 * zz]];
            let turned = |i: usize, j: usize| -> f64 {
                (0..3)
                    .flat_map(|a| (0..3).map(move |b| (a, b)))
                    .map(|(a, b)| rows[i][a] * form[a][b] * rows[j][b])
                    .sum()
            };
            out.0[4][c] = 2.0 * turned(0, 1) / cross;
            out.0[5][c] = 2.0 * turned(1, 2) / cross;
            out.0[6][c] = 2.0 * turned(2, 0) / cross;
            out.0[7][c] = 0.5 * turned(2, 2) / axis;
            out.0[8][c] = 0.5 * (turned(0, 0) - turned(1, 1)) / across;
        }
        out
    }

    /// Factors of 1, x, y, z, xy, yz, zx, 2 zz - xx - yy, xx - yy whose sum is irradiance / pi: what
    /// `glsl/common/environment.glsl` holds.
    pub fn polynomial(&self) -> [V3; 9] {
        let [one, linear, cross, axis, across] = BASIS;
        let factor = [one, linear, linear, linear, cross, cross, cross, axis, across];
        std::array::from_fn(|i| self.0[i].map(|k| k * factor[i] * COSINE[BAND[i]] / PI))
    }
}

/// `count` directions spread evenly over the sphere (a Fibonacci spiral).
pub fn directions(count: usize) -> impl Iterator<Item = V3> {
    (0..count).map(move |i| {
        let y = 1.0 - (2 * i + 1) as f64 / count as f64;
        let (sin, cos) = (2.399_963_229_728_653 * i as f64).sin_cos();
        let r = (1.0 - y * y).sqrt();
        [r * cos, y, r * sin]
    })
}

/// What scattering leaves of bands 0, 1 and 2, per channel, on a sphere of this curvature (1/mm, either sign), normalised as
/// every method is by the kernel's mass there: R_l = sum w m A_l(k) / sum w m, k = r^2 / v, m = 1 - exp(-2k), A_l the von
/// Mises-Fisher lobe's. 1 on a plane; (1, 0, 0) on a point.
pub fn kept(curvature: f64, gaussians: &[Gaussian]) -> [V3; 3] {
    if curvature == 0.0 {
        return [[1.0; 3]; 3];
    }
    let (mut sum, mut mass) = ([[0.0; 3]; 3], [0.0; 3]);
    for g in gaussians {
        let k = sharpness(1.0 / curvature.abs(), g.variance);
        let held = -(-2.0 * k).exp_m1();
        let lobe = lobe(k);
        for c in 0..3 {
            mass[c] += g.weight[c] * held;
            (0..3).for_each(|l| sum[l][c] += g.weight[c] * held * lobe[l]);
        }
    }
    sum.map(|band| std::array::from_fn(|c| if mass[c] > 0.0 { band[c] / mass[c] } else { 1.0 }))
}

/// A_0, A_1, A_2 of a von Mises-Fisher lobe of sharpness k in 0..=infinity: Legendre moments, I_{l+1/2}(k) / I_{1/2}(k).
pub fn lobe(k: f64) -> V3 {
    if k == f64::INFINITY {
        return [1.0; 3];
    }
    if k > 64.0 {
        let first = 1.0 / k.tanh() - 1.0 / k;
        return [1.0, first, 1.0 - 3.0 * first / k];
    }
    // The ratios' continued fraction, backwards (Miller): no cancellation at small k.
    let (mut ratio, mut ratios) = (0.0, [0.0; 3]);
    for l in (1..=96usize).rev() {
        ratio = if k == 0.0 { 0.0 } else { 1.0 / ((2 * l + 1) as f64 / k + ratio) };
        if l < 3 {
            ratios[l] = ratio;
        }
    }
    [1.0, ratios[1], ratios[1] * ratios[2]]
}

/// A_2 over A_1^2 from A_1^2, fitted: how much of band 2 a blurred normal leaves, told by how short it is. Right at both ends,
/// within 1.7e-3 of A_2 between. The twin of `sky_spread` in `glsl/common/environment.glsl`.
pub fn spread(square: f64) -> f64 {
    0.6 + square * (0.13 + square * (0.41 - 0.14 * square))
}

/// Texels of the table of [`kept`] along curvature.
pub const TABLE: usize = 64;

/// R_1 of every texel, then R_2: rgb and a 1, along u = curvature / (curvature + knee), the last texel the point's.
pub fn table(gaussians: &[Gaussian], knee_per_mm: f64) -> Vec<[f32; 4]> {
    let row = |band: usize| {
        (0..TABLE).map(move |i| {
            let u = i as f64 / (TABLE - 1) as f64;
            let curvature = if i + 1 == TABLE { 1e12 } else { knee_per_mm * u / (1.0 - u) };
            let [r, g, b] = kept(curvature, gaussians)[band].map(|x| x as f32);
            [r, g, b, 1.0]
        })
    };
    row(1).chain(row(2)).collect()
}

/// Curvature of the middle of the table, 1/mm: a sphere as large as the widest Gaussian's sigma.
pub fn knee(gaussians: &[Gaussian]) -> f64 {
    let widest = gaussians.iter().map(|g| g.variance.sqrt()).fold(0.0, f64::max);
    if widest > 0.0 { 1.0 / widest } else { 1.0 }
}
