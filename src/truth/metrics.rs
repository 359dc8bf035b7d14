//! How wrong a picture is against a reference: over the pixels that both cover, whole and inside bands.

use super::bands::band;
use super::flip;
use crate::report::tone;

/// Floor of the relative error's denominator, square of exitance.
const EPSILON: f64 = 0.01;

/// Errors over a set of pixels. Units are those of the pictures, exitance for unit irradiance and albedo.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Metrics {
    /// Pixels compared.
    pub pixels: usize,
    /// Root mean square error over pixels and channels.
    pub rmse: f64,
    /// The same per channel.
    pub rmse_rgb: [f64; 3],
    /// Mean of (x - r)^2 / (r^2 + 0.01).
    pub rel_mse: f64,
    /// 20 log10 of the reference's greatest value over the rmse, dB; none where there is no error.
    pub psnr_db: Option<f64>,
    /// 99th percentile of |x - r| over pixels and channels.
    pub p99: f64,
    /// Greatest |x - r|.
    pub max: f64,
    /// Mean of x - r: positive is too bright.
    pub bias: f64,
    /// The same per channel.
    pub bias_rgb: [f64; 3],
    /// Mean [`flip`] of the pictures as a display shows them, 0..1.
    pub flip: f64,
}

/// What a picture's numbers are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Light {
    /// Scene light, 0 and up: FLIP sees it through the renderer's own curve, Khronos PBR Neutral at exposure 1.
    Scene,
    /// Display light, 0..1: already through a curve.
    Display,
}

impl Light {
    /// For people.
    pub fn name(self) -> &'static str {
        match self {
            Light::Scene => "linear scene light",
            Light::Display => "display light, decoded from sRGB",
        }
    }

    fn shown(self, p: &[f32; 4]) -> [f64; 3] {
        let linear = [p[0], p[1], p[2]].map(f64::from);
        match self {
            Light::Scene => tone::neutral(linear),
            Light::Display => linear,
        }
    }
}

/// Errors of the whole and of each band.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Comparison {
    /// Version of this record.
    pub schema: u32,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Pixels that one picture covers and the other does not.
    pub uncommon: usize,
    /// Pixels of common coverage with a NaN or an infinity, left out.
    pub not_finite: usize,
    /// All pixels of common coverage.
    pub whole: Metrics,
    /// Where bands are known: their names and errors.
    pub bands: Vec<(&'static str, Metrics)>,
}

/// Names of the bands, and their bits.
pub const BANDS: [(&str, u8); 4] = [
    ("silhouette", band::SILHOUETTE),
    ("terminator", band::TERMINATOR),
    ("shadow-edge", band::SHADOW_EDGE),
    ("concave", band::CONCAVE),
];

/// Compares a picture with its reference, RGBA of scene light with coverage in A, as many pixels each; bands are bits a pixel.
pub fn compare(size: [u32; 2], picture: &[[f32; 4]], reference: &[[f32; 4]], bands: Option<&[u8]>) -> Comparison {
    compare_light(size, [(picture, Light::Scene), (reference, Light::Scene)], bands)
}

/// The same for a picture and a reference of whatever light.
pub fn compare_light(size: [u32; 2], pictures: [(&[[f32; 4]], Light); 2], bands: Option<&[u8]>) -> Comparison {
    let [(picture, _), (reference, _)] = pictures;
    let pairs = || picture.iter().zip(reference).enumerate();
    let compared: Vec<usize> = pairs().filter(|(_, (a, b))| comparable(a, b)).map(|(i, _)| i).collect();
    let shown = pictures.map(|(p, light)| seen(picture, reference, p, |p| light.shown(p)));
    let flip = flip::ldr(size.map(|x| x as usize), &shown[1], &shown[0]);
    let over = |bit: Option<u8>| {
        let inside = |i: &&usize| bit.is_none_or(|bit| bands.and_then(|b| b.get(**i)).is_some_and(|b| b & bit != 0));
        Metrics::over(compared.iter().filter(inside).map(|i| (&picture[*i], &reference[*i], flip[*i])))
    };
    Comparison {
        schema: 1,
        size,
        uncommon: pairs().filter(|(_, (a, b))| (a[3] > 0.) != (b[3] > 0.)).count(),
        not_finite: pairs().filter(|(_, (a, b))| covered(a, b) && !comparable(a, b)).count(),
        whole: over(None),
        bands: if bands.is_some() { BANDS.map(|(name, bit)| (name, over(Some(bit)))).to_vec() } else { Vec::new() },
    }
}

/// Mean HDR-FLIP over the pixels compared, scene light as it is, and its exposures; none where the reference is black.
pub fn hdr_flip(size: [u32; 2], picture: &[[f32; 4]], reference: &[[f32; 4]]) -> Option<(f64, flip::Exposures)> {
    let linear = |p: &[f32; 4]| [p[0], p[1], p[2]].map(f64::from);
    let [a, b] = [picture, reference].map(|p| seen(picture, reference, p, linear));
    let compared = |i: usize| comparable(&picture[i], &reference[i]);
    let exposures = flip::Exposures::of(&b, compared)?;
    let map = flip::hdr(size.map(|x| x as usize), &b, &a, exposures);
    let counted: Vec<f64> = (0..map.len()).filter(|i| compared(*i)).map(|i| map[i]).collect();
    Some((counted.iter().sum::<f64>() / counted.len() as f64, exposures))
}

fn covered(a: &[f32; 4], b: &[f32; 4]) -> bool {
    a[3] > 0. && b[3] > 0.
}

/// Whether a pixel counts: both cover it, with numbers.
fn comparable(a: &[f32; 4], b: &[f32; 4]) -> bool {
    covered(a, b) && a.iter().chain(b).all(|x| x.is_finite())
}

/// One of two pictures as FLIP sees it: what does not count is black in both.
fn seen(a: &[[f32; 4]], b: &[[f32; 4]], which: &[[f32; 4]], show: impl Fn(&[f32; 4]) -> [f64; 3]) -> Vec<[f64; 3]> {
    let pixel = |i: usize| if comparable(&a[i], &b[i]) { show(&which[i]) } else { [0.; 3] };
    (0..which.len()).map(pixel).collect()
}

impl Metrics {
    fn over<'a>(pixels: impl Iterator<Item = (&'a [f32; 4], &'a [f32; 4], f64)>) -> Metrics {
        let (mut square, mut bias, mut relative, mut peak, mut flip) = ([0.; 3], [0.; 3], 0., 0f64, 0.);
        let (mut count, mut errors) = (0usize, Vec::new());
        for (a, b, look) in pixels {
            count += 1;
            flip += look;
            for c in 0..3 {
                let r = f64::from(b[c]);
                let d = f64::from(a[c]) - r;
                square[c] += d * d;
                bias[c] += d;
                relative += d * d / (r * r + EPSILON);
                peak = peak.max(r);
                errors.push(d.abs());
            }
        }
        if count == 0 {
            return Metrics::default();
        }
        errors.sort_unstable_by(f64::total_cmp);
        let n = count as f64;
        let rmse = (square.iter().sum::<f64>() / (3. * n)).sqrt();
        Metrics {
            pixels: count,
            rmse,
            rmse_rgb: square.map(|s| (s / n).sqrt()),
            rel_mse: relative / (3. * n),
            psnr_db: (rmse > 0. && peak > 0.).then(|| 20. * (peak / rmse).log10()),
            p99: errors[(errors.len() - 1) * 99 / 100],
            max: errors.last().copied().unwrap_or(0.),
            bias: bias.iter().sum::<f64>() / (3. * n),
            bias_rgb: bias.map(|b| b / n),
            flip: flip / n,
        }
    }
}

/// Bands as a picture, a band a channel, each 0 or 1: R silhouette, G terminator, B shadow edge, A concave.
pub fn bands_picture(bands: &[u8]) -> Vec<[f32; 4]> {
    bands.iter().map(|b| BANDS.map(|(_, bit)| f32::from(u8::from(b & bit != 0)))).collect()
}

/// The bands of such a picture.
pub fn bands_of(picture: &[[f32; 4]]) -> Vec<u8> {
    let bits = |p: &[f32; 4]| BANDS.iter().zip(p).filter(|(_, x)| **x > 0.5).map(|((_, bit), _)| bit).sum();
    picture.iter().map(bits).collect()
}

/// The largest channel's |x - r| as colour: black at 0, through blue, violet, orange, to white at `full` and beyond. RGBA8.
pub fn heat(picture: &[[f32; 4]], reference: &[[f32; 4]], full: f64) -> Vec<u8> {
    const RAMP: [[f64; 3]; 6] =
        [[0., 0., 0.], [0.1, 0.1, 0.5], [0.5, 0.1, 0.6], [0.9, 0.3, 0.3], [1., 0.75, 0.2], [1., 1., 1.]];
    let texel = |(a, b): (&[f32; 4], &[f32; 4])| {
        if !(a[3] > 0. && b[3] > 0.) {
            return [0, 0, 0, 0];
        }
        let error = (0..3).map(|c| f64::from(a[c] - b[c]).abs()).fold(0., f64::max);
        let at = (error / full).clamp(0., 1.) * 5.;
        let i = (at as usize).min(4);
        let t = at - i as f64;
        let [r, g, b] =
            std::array::from_fn(|c| (255. * (RAMP[i][c] + (RAMP[i + 1][c] - RAMP[i][c]) * t)).round() as u8);
        [r, g, b, 255]
    };
    picture.iter().zip(reference).flat_map(texel).collect()
}
