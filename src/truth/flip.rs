//! FLIP: how different two pictures look when one is flipped to the other in place (Andersson et al. 2020), 0..1 a pixel; and
//! its extension to high dynamic range, the worst over exposures (Andersson et al. 2021).
//!
//! Pictures are linear RGB with sRGB primaries, row by row; edges repeat. Both are seen at [`PIXELS_PER_DEGREE`]: 0.7 m from a
//! display 0.7 m and 3840 pixels wide, the authors' default. What the eye cannot resolve is filtered away first, so a difference of
//! single pixels counts less than the same difference over an area, and one at an edge or a dot counts more.

use rayon::prelude::*;
use std::f64::consts::PI;

/// Pixels per degree of visual angle.
pub const PIXELS_PER_DEGREE: f64 = 3840. * PI / 180.;

/// Contrast sensitivity of the achromatic, the red-green and the blue-yellow channel as Gaussians: amplitude and scale in
/// square degrees (Johnson & Fairchild 2003, fitted by Andersson et al. 2020, table 1).
const ACHROMATIC: &[[f64; 2]] = &[[1., 0.0047]];
const RED_GREEN: &[[f64; 2]] = &[[1., 0.0053]];
const BLUE_YELLOW: &[[f64; 2]] = &[[34.1, 0.04], [13.5, 0.025]];
/// The widest of the scales: all kernels end three of its standard deviations out.
const WIDEST: f64 = 0.04;
/// Exponent and knee of the colour difference.
const COLOUR_EXPONENT: f64 = 0.7;
const KNEE: [f64; 2] = [0.4, 0.95];
/// Width in degrees of the edges and dots that are looked for, and the exponent of their difference.
const FEATURE_WIDTH: f64 = 0.082;
const FEATURE_EXPONENT: f64 = 0.5;
/// Display light that the brightest and the median pixel reach at the first and the last exposure.
const EXPOSED: f64 = 0.85;
/// A median below this part of the greatest luminance is taken for it: a black background asks for no exposure.
const DIMMEST: f64 = 1. / 65536.;

type Colour = [f64; 3];

/// FLIP of each pixel. Both pictures in display light: linear, 0..1 (held to it). The order of the two does not matter.
pub fn ldr(size: [usize; 2], reference: &[Colour], picture: &[Colour]) -> Vec<f64> {
    let space = Space::new();
    let looks = [reference, picture].map(|p| Look::new(&space, size, p));
    let most = space.greatest_difference();
    let pixel = |i: usize| {
        let [a, b] = [&looks[0], &looks[1]].map(|l| l.colour[i]);
        let knee = KNEE[0] * most;
        let apart = hyab(a, b).powf(COLOUR_EXPONENT);
        let colour = if apart < knee {
            apart * KNEE[1] / knee
        } else {
            KNEE[1] + (apart - knee) / (most - knee) * (1. - KNEE[1])
        };
        let feature = |k: usize| (looks[0].features[i][k] - looks[1].features[i][k]).abs();
        let feature = (feature(0).max(feature(1)) / 2f64.sqrt()).powf(FEATURE_EXPONENT).min(1.);
        colour.powf(1. - feature)
    };
    (0..size[0] * size[1]).into_par_iter().map(pixel).collect()
}

/// Exposures of a high-dynamic-range comparison, as powers of two.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Exposures {
    /// Where the reference's brightest pixel comes to 85 % of display white.
    pub first: f64,
    /// Where its median pixel does.
    pub last: f64,
    /// How many, evenly spaced.
    pub count: usize,
}

impl Exposures {
    /// Those that a reference asks for, from the luminance of the pixels that `counts` names; none where all are black.
    pub fn of(reference: &[Colour], counts: impl Fn(usize) -> bool) -> Option<Self> {
        let space = Space::new();
        let luminance = |c: &Colour| (0..3).map(|k| space.xyz[1][k] * c[k]).sum::<f64>();
        let mut all: Vec<f64> =
            reference.iter().enumerate().filter(|(i, _)| counts(*i)).map(|(_, c)| luminance(c)).collect();
        all.sort_by(f64::total_cmp);
        let most = all.last().copied().filter(|l| *l > 0.)?;
        let median = all[all.len() / 2];
        // Where the curve below gives EXPOSED: the positive root of a quadratic.
        let [a, b, c] = [0, 1, 2].map(|k| ACES[k] - EXPOSED * ACES[k + 3]);
        let exposed = (-b + (b * b - 4. * a * c).sqrt()) / (2. * a);
        let (first, last) = ((exposed / most).log2(), (exposed / median.max(DIMMEST * most)).log2());
        Some(Self { first, last, count: ((last - first).ceil() as usize).max(2) })
    }
}

/// The filmic curve of HDR-FLIP, a ratio of quadratics: Narkowicz's fit of ACES (2015) with its exposure of 0.6.
const ACES: [f64; 6] = [0.36 * 2.51, 0.6 * 0.03, 0., 0.36 * 2.43, 0.6 * 0.59, 0.14];

fn aces(x: f64) -> f64 {
    let x = x.max(0.);
    ((ACES[0] * x + ACES[1]) * x + ACES[2]) / ((ACES[3] * x + ACES[4]) * x + ACES[5])
}

/// The greatest FLIP over exposures of each pixel. Both pictures in scene light: linear, 0 and up.
pub fn hdr(size: [usize; 2], reference: &[Colour], picture: &[Colour], exposures: Exposures) -> Vec<f64> {
    let mut worst = vec![0f64; size[0] * size[1]];
    for i in 0..exposures.count {
        let t = i as f64 / (exposures.count.max(2) - 1) as f64;
        let factor = (exposures.first + (exposures.last - exposures.first) * t).exp2();
        let expose = |p: &[Colour]| -> Vec<Colour> { p.iter().map(|c| c.map(|x| aces(x * factor))).collect() };
        let map = ldr(size, &expose(reference), &expose(picture));
        worst.iter_mut().zip(map).for_each(|(w, m)| *w = w.max(m));
    }
    worst
}

/// What the eye makes of one picture.
struct Look {
    /// L*a*b* after contrast sensitivity, a* and b* scaled by lightness (Hunt 1952).
    colour: Vec<Colour>,
    /// Strength of edge and of dot at each pixel.
    features: Vec<[f64; 2]>,
}

impl Look {
    fn new(space: &Space, size: [usize; 2], picture: &[Colour]) -> Self {
        let opponent: Vec<Colour> = picture.par_iter().map(|c| space.opponent(c.map(|x| x.clamp(0., 1.)))).collect();
        let plane = |c: usize| -> Vec<f64> { opponent.iter().map(|o| o[c]).collect() };
        let filtered: [Vec<f64>; 3] = [ACHROMATIC, RED_GREEN, BLUE_YELLOW]
            .into_iter()
            .enumerate()
            .map(|(c, sensitivity)| resolve(size, &plane(c), sensitivity))
            .collect::<Vec<_>>()
            .try_into()
            .unwrap_or_default();
        let colour = (0..picture.len())
            .into_par_iter()
            .map(|i| space.lab(space.rgb([0, 1, 2].map(|c| filtered[c][i])).map(|x| x.clamp(0., 1.))))
            .collect();
        let lightness: Vec<f64> = opponent.iter().map(|o| (o[0] + 16.) / 116.).collect();
        Self { colour, features: features(size, &lightness) }
    }
}

/// Colour spaces between sRGB's primaries and the eye's opponents, white at D65.
struct Space {
    xyz: [[f64; 3]; 3],
    inverse: [[f64; 3]; 3],
    white: Colour,
}

impl Space {
    fn new() -> Self {
        // Chromaticities of red, green, blue and white (IEC 61966-2-1); each primary scaled so that together they are white.
        let column = |x: f64, y: f64| glam::DVec3::new(x / y, 1., (1. - x - y) / y);
        let primaries = glam::DMat3::from_cols(column(0.64, 0.33), column(0.3, 0.6), column(0.15, 0.06));
        let share = primaries.inverse() * column(0.3127, 0.329);
        let xyz = primaries * glam::DMat3::from_diagonal(share);
        let rows = |m: glam::DMat3| m.transpose().to_cols_array_2d();
        Self { xyz: rows(xyz), inverse: rows(xyz.inverse()), white: (xyz * glam::DVec3::ONE).to_array() }
    }

    /// Linear RGB to XYZ over white's.
    fn relative(&self, rgb: Colour) -> Colour {
        std::array::from_fn(|i| (0..3).map(|k| self.xyz[i][k] * rgb[k]).sum::<f64>() / self.white[i])
    }

    /// To the linear opponents that contrast sensitivity is stated in: light-dark, red-green, blue-yellow.
    fn opponent(&self, rgb: Colour) -> Colour {
        let [x, y, z] = self.relative(rgb);
        [116. * y - 16., 500. * (x - y), 200. * (y - z)]
    }

    /// And back.
    fn rgb(&self, [light, red, blue]: Colour) -> Colour {
        let y = (light + 16.) / 116.;
        let xyz = [(y + red / 500.) * self.white[0], y * self.white[1], (y - blue / 200.) * self.white[2]];
        std::array::from_fn(|i| (0..3).map(|k| self.inverse[i][k] * xyz[k]).sum())
    }

    /// CIELAB with Hunt's effect.
    fn lab(&self, rgb: Colour) -> Colour {
        const D: f64 = 6. / 29.;
        let [x, y, z] = self.relative(rgb).map(|t| if t > D * D * D { t.cbrt() } else { t / (3. * D * D) + 4. / 29. });
        let light = 116. * y - 16.;
        [light, 0.01 * light * 500. * (x - y), 0.01 * light * 200. * (y - z)]
    }

    /// The colour difference of green and blue, the greatest there is, raised as all are.
    fn greatest_difference(&self) -> f64 {
        hyab(self.lab([0., 1., 0.]), self.lab([0., 0., 1.])).powf(COLOUR_EXPONENT)
    }
}

/// Difference of lightness plus distance of chroma (Abasi et al. 2020): holds for large differences, too.
fn hyab(a: Colour, b: Colour) -> f64 {
    (a[0] - b[0]).abs() + (a[1] - b[1]).hypot(a[2] - b[2])
}

/// A plane without what contrast sensitivity does not resolve.
fn resolve(size: [usize; 2], plane: &[f64], sensitivity: &[[f64; 2]]) -> Vec<f64> {
    let radius = (3. * (WIDEST / (2. * PI * PI)).sqrt() * PIXELS_PER_DEGREE).ceil() as i32;
    let (mut sum, mut all) = (vec![0.; plane.len()], 0.);
    for [amplitude, scale] in sensitivity {
        let at = |x: i32| (-(PI * f64::from(x) / PIXELS_PER_DEGREE).powi(2) / scale).exp();
        let taps: Vec<f64> = (-radius..=radius).map(at).collect();
        let weight = amplitude * (PI / scale).sqrt();
        all += weight * taps.iter().sum::<f64>().powi(2);
        let part = down(size, &across(size, plane, &taps), &taps);
        sum.iter_mut().zip(part).for_each(|(s, p)| *s += weight * p);
    }
    sum.iter_mut().for_each(|s| *s /= all);
    sum
}

/// Strength of edges and dots of [`FEATURE_WIDTH`]: first and second derivatives of a Gaussian.
fn features(size: [usize; 2], plane: &[f64]) -> Vec<[f64; 2]> {
    let sigma = 0.5 * FEATURE_WIDTH * PIXELS_PER_DEGREE;
    let radius = (3. * sigma).ceil() as i32;
    let kernel = |shape: fn(f64) -> f64| -> Vec<f64> {
        let at = |x: i32| f64::from(x) / sigma;
        let taps: Vec<f64> = (-radius..=radius).map(|x| shape(at(x)) * (-0.5 * at(x).powi(2)).exp()).collect();
        // The positive taps weigh 1 together, and the negative ones -1 or nothing.
        let sum = |sign: f64| taps.iter().map(|t| (t * sign).max(0.)).sum::<f64>();
        let (up, low) = (sum(1.), sum(-1.));
        taps.iter().map(|t| if *t > 0. { t / up } else { t / low.max(f64::MIN_POSITIVE) }).collect()
    };
    let (smooth, slope, bend) = (kernel(|_| 1.), kernel(|x| -x), kernel(|x| x * x - 1.));
    let flat = across(size, plane, &smooth);
    let edges = [down(size, &across(size, plane, &slope), &smooth), down(size, &flat, &slope)];
    let dots = [down(size, &across(size, plane, &bend), &smooth), down(size, &flat, &bend)];
    let size = |pair: &[Vec<f64>; 2], i: usize| pair[0][i].hypot(pair[1][i]);
    (0..plane.len()).map(|i| [size(&edges, i), size(&dots, i)]).collect()
}

/// Correlates the rows with taps around the middle one.
fn across(size: [usize; 2], plane: &[f64], taps: &[f64]) -> Vec<f64> {
    let (width, middle) = (size[0], taps.len() / 2);
    let mut out = vec![0.; plane.len()];
    out.par_chunks_mut(width.max(1)).zip(plane.par_chunks(width.max(1))).for_each(|(to, from)| {
        for (x, to) in to.iter_mut().enumerate() {
            *to = taps.iter().enumerate().map(|(k, t)| t * from[(x + k).saturating_sub(middle).min(width - 1)]).sum();
        }
    });
    out
}

/// Correlates the columns.
fn down(size: [usize; 2], plane: &[f64], taps: &[f64]) -> Vec<f64> {
    let ([width, height], middle) = (size, taps.len() / 2);
    let mut out = vec![0.; plane.len()];
    out.par_chunks_mut(width.max(1)).enumerate().for_each(|(y, to)| {
        for (k, t) in taps.iter().enumerate() {
            let row = (y + k).saturating_sub(middle).min(height - 1) * width;
            to.iter_mut().zip(&plane[row..row + width]).for_each(|(o, v)| *o += t * v);
        }
    });
    out
}
