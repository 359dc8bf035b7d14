//! How wrong a picture is against a reference: over the pixels that both cover, whole and inside bands.

use super::eye::band;

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
pub const BANDS: [(&str, u8); 3] =
    [("silhouette", band::SILHOUETTE), ("terminator", band::TERMINATOR), ("shadow-edge", band::SHADOW_EDGE)];

/// Compares a picture with its reference, RGBA with coverage in A, as many pixels each; bands are bits a pixel.
pub fn compare(size: [u32; 2], picture: &[[f32; 4]], reference: &[[f32; 4]], bands: Option<&[u8]>) -> Comparison {
    let pairs = || picture.iter().zip(reference).enumerate();
    let covered = |a: &[f32; 4], b: &[f32; 4]| a[3] > 0. && b[3] > 0.;
    let finite = |p: &[f32; 4]| p.iter().all(|x| x.is_finite());
    let compared: Vec<(usize, &[f32; 4], &[f32; 4])> =
        pairs().filter(|(_, (a, b))| covered(a, b) && finite(a) && finite(b)).map(|(i, (a, b))| (i, a, b)).collect();
    let within = |bit: u8| {
        let inside = |i: usize| bands.and_then(|b| b.get(i)).is_some_and(|b| b & bit != 0);
        Metrics::over(compared.iter().filter(|(i, _, _)| inside(*i)).map(|(_, a, b)| (*a, *b)))
    };
    Comparison {
        schema: 1,
        size,
        uncommon: pairs().filter(|(_, (a, b))| (a[3] > 0.) != (b[3] > 0.)).count(),
        not_finite: pairs().filter(|(_, (a, b))| covered(a, b) && !(finite(a) && finite(b))).count(),
        whole: Metrics::over(compared.iter().map(|(_, a, b)| (*a, *b))),
        bands: if bands.is_some() { BANDS.map(|(name, bit)| (name, within(bit))).to_vec() } else { Vec::new() },
    }
}

impl Metrics {
    fn over<'a>(pairs: impl Iterator<Item = (&'a [f32; 4], &'a [f32; 4])>) -> Metrics {
        let (mut square, mut bias, mut relative, mut peak) = ([0.; 3], [0.; 3], 0., 0f64);
        let (mut pixels, mut errors) = (0usize, Vec::new());
        for (a, b) in pairs {
            pixels += 1;
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
        if pixels == 0 {
            return Metrics::default();
        }
        errors.sort_unstable_by(f64::total_cmp);
        let n = pixels as f64;
        let rmse = (square.iter().sum::<f64>() / (3. * n)).sqrt();
        Metrics {
            pixels,
            rmse,
            rmse_rgb: square.map(|s| (s / n).sqrt()),
            rel_mse: relative / (3. * n),
            psnr_db: (rmse > 0. && peak > 0.).then(|| 20. * (peak / rmse).log10()),
            p99: errors[(errors.len() - 1) * 99 / 100],
            max: errors.last().copied().unwrap_or(0.),
            bias: bias.iter().sum::<f64>() / (3. * n),
            bias_rgb: bias.map(|b| b / n),
        }
    }
}

/// Bands as a picture: R silhouette, G terminator, B shadow edge, each 0 or 1; A 1 where there is coverage.
pub fn bands_picture(bands: &[u8], pixels: &[[f32; 4]]) -> Vec<[f32; 4]> {
    let bit = |b: u8, mask: u8| f32::from(u8::from(b & mask != 0));
    let texel = |(b, p): (&u8, &[f32; 4])| [bit(*b, BANDS[0].1), bit(*b, BANDS[1].1), bit(*b, BANDS[2].1), p[3]];
    bands.iter().zip(pixels).map(texel).collect()
}

/// The bands of such a picture.
pub fn bands_of(picture: &[[f32; 4]]) -> Vec<u8> {
    let bits = |p: &[f32; 4]| (0..3).filter(|i| p[*i] > 0.5).map(|i| BANDS[i].1).sum();
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
