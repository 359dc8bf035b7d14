//! Test vectors: each formula as numbers in and numbers out, so that a port can be checked without this renderer.
//!
//! A file holds one formula: its name, the equation's source, what each input and output is, how far a port in f32 may be
//! off, and its cases. Inputs and outputs are flat lists of numbers in the order that `inputs` and `outputs` name; a name with
//! a count in brackets stands for so many numbers.

use super::blur::{Pass, Screen, Texel, blur};
use super::curvature::{Camera, Estimator, GBuffer, estimate};
use super::lut::{Integral, Lut};
use super::occlusion::{Falloff, bowl, from_mean, trough};
use super::profile::Profile;
use super::{light, moments, octahedral, ring, sphere};
use serde::{Deserialize, Serialize};

/// Version of the files.
pub const SCHEMA: u32 = 1;

/// A formula and where it is tried.
pub struct Formula {
    /// The file's stem.
    pub name: &'static str,
    /// Author, year, equation; and the shader function that a port would check.
    pub source: &'static str,
    /// What goes in, with units.
    pub inputs: &'static [&'static str],
    /// What comes out, with units.
    pub outputs: &'static [&'static str],
    /// Largest absolute difference that a correct f32 port shows.
    pub tolerance: f64,
    /// Where it is tried.
    pub cases: fn() -> Vec<Vec<f64>>,
    /// The formula.
    pub of: fn(&[f64]) -> Vec<f64>,
}

/// A file as it stands on disk.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct File {
    /// [`SCHEMA`].
    pub schema: u32,
    /// The formula's name.
    pub formula: String,
    /// As in [`Formula`].
    pub source: String,
    /// As in [`Formula`].
    pub inputs: Vec<String>,
    /// As in [`Formula`].
    pub outputs: Vec<String>,
    /// As in [`Formula`].
    pub tolerance: f64,
    /// Input and output of each case.
    pub cases: Vec<Case>,
}

/// One case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Case {
    /// Numbers in the order of `inputs`.
    pub input: Vec<f64>,
    /// Numbers in the order of `outputs`.
    pub output: Vec<f64>,
}

/// Every formula that has vectors.
#[rustfmt::skip]
pub const FORMULAS: &[Formula] = &[
    Formula { name: "curvature-vergne", source: "Vergne et al. 2009: H = -tr(Hess depth)/2; glsl/curvature.comp", inputs: WINDOW, outputs: BEND, tolerance: 1e-5, cases: windows, of: |v| curvature(Estimator::Vergne, v) },
    Formula { name: "curvature-trace", source: "Chen, Lambert & Penner 2014, equation 1: H = tr(grad n)/2; glsl/curvature.comp", inputs: WINDOW, outputs: BEND, tolerance: 1e-5, cases: windows, of: |v| curvature(Estimator::Trace, v) },
    Formula { name: "curvature-metric", source: "first and second fundamental form: H = (GL + EN - 2FM)/2D, K = (LN - M^2)/D; glsl/curvature.comp", inputs: WINDOW, outputs: BEND, tolerance: 1e-5, cases: windows, of: |v| curvature(Estimator::Metric, v) },
    Formula { name: "curvature-fit", source: "least squares in the tangent plane: S = (sum w m a^T)(sum w a a^T)^-1; glsl/curvature.comp", inputs: WINDOW, outputs: BEND, tolerance: 1e-5, cases: windows, of: |v| curvature(Estimator::Fit, v) },
    Formula { name: "blur-pass", source: "seven-point rule for a Gaussian (Radon 1948; Stroud 1971, E2 r^2 5-1), 3-D distance (Mikkelsen 2010); glsl/blur.comp, unrounded", inputs: PATCH, outputs: &["mean normal (3)", "H times length", "lit (2)"], tolerance: 1e-5, cases: patches, of: blurred },
    Formula { name: "sphere", source: "mean of max(0, n.l) under a von Mises-Fisher lobe, Legendre series and density; the table's content", inputs: &["mu", "k = r^2/v"], outputs: &["D"], tolerance: 1e-6, cases: stiff, of: |v| vec![sphere::vmf(v[0], v[1])] },
    Formula { name: "sphere-burley", source: "Christensen & Burley 2015, equation 2, integrated over a sphere", inputs: &["mu", "d times curvature"], outputs: &["D"], tolerance: 1e-6, cases: stiff, of: |v| vec![sphere::burley(v[0], v[1])] },
    Formula { name: "ring", source: "Penner & Borshukov 2011: mean of max(0, cos(theta + x)) under exp(k cos x)", inputs: &["mu", "k = r^2/v"], outputs: &["D"], tolerance: 1e-6, cases: stiff, of: |v| vec![ring::von_mises(v[0], v[1])] },
    Formula { name: "table-coordinate", source: "lut_look_up in glsl/common/scattering.glsl: two straight pieces in mu, x/(x + 1) with x the root of curvature/knee", inputs: &["mu", "curvature, 1/mm", "knee, 1/mm"], outputs: &["u", "v"], tolerance: 1e-6, cases: coordinates, of: coordinate },
    Formula { name: "table-sample", source: "the table of profile skin over a sphere, sampled; lut_look_up in glsl/common/scattering.glsl", inputs: &["mu", "curvature, 1/mm"], outputs: &["D (3), red green blue"], tolerance: 2e-4, cases: samples, of: sample },
    Formula { name: "rectified", source: "E max(0, X) = s phi(c/s) + c Phi(c/s); rectified in glsl/common/scattering.glsl, whose cubic is within 2.4e-5 s", inputs: &["mean c", "standard deviation s"], outputs: &["E max(0, X)"], tolerance: 3e-5, cases: normals, of: |v| vec![moments::rectified(v[0], v[1])] },
    Formula { name: "moment", source: "variance (1 - |n|^2)/2 (1 - (n.l)^2/|n|^2); moment in glsl/common/scattering.glsl", inputs: &["mean normal n (3)", "l (3)"], outputs: &["mean of max(0, n.l)"], tolerance: 3e-5, cases: means, of: |v| vec![light::moment([v[0], v[1], v[2]], [v[3], v[4], v[5]])] },
    Formula { name: "occlusion", source: "5/16 (H R)^2 where concave, saturating; occlusion_of in glsl/common/scattering.glsl. Bowl and trough by exact integrals", inputs: &["H R, convex > 0"], outputs: &["from mean curvature", "bowl", "trough of the same k R"], tolerance: 1e-6, cases: || steps(-6.0, 1.0, 29), of: occlusion },
    Formula { name: "octahedral", source: "Meyer et al. 2010, Cigolle et al. 2014; glsl/common/octahedral.glsl, 2 x snorm16", inputs: &["n (3), unit"], outputs: &["code (2), whole steps", "decoded (3)"], tolerance: 1e-6, cases: directions, of: coded },
    Formula { name: "tone-neutral", source: "Khronos PBR Neutral 2024; neutral in glsl/common/tonemap.glsl", inputs: &["linear rgb (3)"], outputs: &["display rgb (3)"], tolerance: 1e-6, cases: colours, of: |v| crate::report::tone::neutral([v[0], v[1], v[2]]).to_vec() },
    Formula { name: "tone-srgb", source: "IEC 61966-2-1; srgb in glsl/common/tonemap.glsl", inputs: &["linear"], outputs: &["code 0..1"], tolerance: 1e-5, cases: || steps(0.0, 1.0, 33), of: |v| vec![crate::report::tone::encode(v[0])] },
];

const WINDOW: &[&str] = &[
    "ray_scale (2)",
    "ray_offset (2)",
    "perspective 0|1",
    "z of 3 x 3 pixels (9), mm, 0 background",
    "normals (27), view space",
];
const BEND: &[&str] = &["H, 1/mm", "K, 1/mm^2", "confidence"];
const PATCH: &[&str] = &[
    "ray_scale (2)",
    "ray_offset (2)",
    "perspective 0|1",
    "variance, mm^2",
    "turn 0|1",
    "9 x 9 pixels: z (81), mm, negative where it scatters",
    "normals (243), view space",
    "H times length (81)",
    "confidence (81)",
    "lit (162)",
];

/// Runs a formula over its cases.
pub fn file(f: &Formula) -> File {
    let names = |list: &[&str]| list.iter().map(|s| (*s).to_owned()).collect();
    let case = |input: Vec<f64>| Case { output: (f.of)(&input), input };
    File {
        schema: SCHEMA,
        formula: f.name.to_owned(),
        source: f.source.to_owned(),
        inputs: names(f.inputs),
        outputs: names(f.outputs),
        tolerance: f.tolerance,
        cases: (f.cases)().into_iter().map(case).collect(),
    }
}

/// Cases whose outputs are further from what this formula gives than its tolerance; outputs that are missing count, too.
pub fn wrong(f: &Formula, file: &File) -> usize {
    let off = |c: &&Case| {
        let want = (f.of)(&c.input);
        want.len() != c.output.len() || !want.iter().zip(&c.output).all(|(a, b)| (a - b).abs() <= f.tolerance)
    };
    file.cases.iter().filter(off).count()
}

fn curvature(estimator: Estimator, v: &[f64]) -> Vec<f64> {
    let camera = Camera { ray_scale: [v[0], v[1]], ray_offset: [v[2], v[3]], perspective: v[4] > 0.5 };
    let normal = v[14..41].chunks_exact(3).map(|n| [n[0], n[1], n[2]]).collect();
    let g = GBuffer { width: 3, height: 3, z: v[5..14].to_vec(), normal, camera };
    let c = estimate(estimator, &g)[4];
    vec![c.h, c.k, c.confidence]
}

fn blurred(v: &[f64]) -> Vec<f64> {
    let camera = Camera { ray_scale: [v[0], v[1]], ray_offset: [v[2], v[3]], perspective: v[4] > 0.5 };
    let texel = |i: usize| Texel {
        n: [0, 1, 2].map(|k| v[88 + 3 * i + k]),
        h: v[331 + i],
        confidence: v[412 + i],
        lit: [0, 1].map(|k| v[493 + 2 * i + k]),
    };
    let source: Vec<Texel> = (0..81).map(texel).collect();
    let screen = Screen { size: [9, 9], z: v[7..88].to_vec(), camera };
    let pass = Pass { variance: v[5], source_stride: 1, target_stride: 1, turn: v[6] > 0.5 };
    let t = blur(&screen, &source, &pass)[40];
    [t.n.to_vec(), vec![t.h], t.lit.to_vec()].concat()
}

fn coordinate(v: &[f64]) -> Vec<f64> {
    let lut = Lut { size: super::lut::SIZE, texels: Vec::new(), knee_per_mm: v[2] };
    lut.coordinate(v[0], v[1]).to_vec()
}

fn sample(v: &[f64]) -> Vec<f64> {
    static TABLE: std::sync::LazyLock<Option<Lut>> =
        std::sync::LazyLock::new(|| Profile::resolve("skin").ok().map(|p| Lut::build(&p, Integral::Sphere)));
    TABLE.as_ref().map_or_else(Vec::new, |t| t.sample(v[0], v[1]).map(f64::from).to_vec())
}

fn occlusion(v: &[f64]) -> Vec<f64> {
    vec![
        from_mean(v[0], 1.0, Falloff::Quadratic),
        bowl(v[0], 1.0, Falloff::Quadratic),
        trough(v[0], 1.0, Falloff::Quadratic),
    ]
}

fn coded(v: &[f64]) -> Vec<f64> {
    let code = octahedral::encode([v[0], v[1], v[2]]);
    code.iter().map(|c| f64::from(*c)).chain(octahedral::decode(code)).collect()
}

/// So many numbers from `a` to `b`, a case each.
fn steps(a: f64, b: f64, n: usize) -> Vec<Vec<f64>> {
    (0..n).map(|i| vec![a + (b - a) * i as f64 / (n - 1) as f64]).collect()
}

fn pairs(first: &[f64], second: &[f64]) -> Vec<Vec<f64>> {
    first.iter().flat_map(|a| second.iter().map(move |b| vec![*a, *b])).collect()
}

fn stiff() -> Vec<Vec<f64>> {
    let powers: Vec<f64> = (-8..=14).map(|e| 10f64.powi(e)).collect();
    pairs(&[-1.0, -0.6, -0.1, -1e-3, 0.0, 1e-3, 0.1, 0.6, 1.0], &powers)
}

fn coordinates() -> Vec<Vec<f64>> {
    let both =
        pairs(&[-1.2, -1.0, -0.3, -0.125, -0.05, 0.0, 0.05, 0.125, 0.3, 1.0], &[0.0, 1e-6, 0.01, 0.5, 3.0, 1e3, 1e30]);
    both.into_iter().flat_map(|p| [0.2, 2.5].map(|knee| vec![p[0], p[1], knee])).collect()
}

fn samples() -> Vec<Vec<f64>> {
    pairs(&[-1.0, -0.5, -0.1, 0.0, 0.03, 0.2, 0.7, 1.0], &[0.0, 0.005, 0.05, 0.2, 1.0, 10.0, 1e4])
}

fn normals() -> Vec<Vec<f64>> {
    pairs(&[-1.0, -0.3, -0.02, 0.0, 0.02, 0.3, 1.0], &[0.0, 1e-8, 1e-4, 0.01, 0.1, 0.3, 0.7])
}

fn means() -> Vec<Vec<f64>> {
    let mut all = Vec::new();
    for length in [1e-3, 0.5, 0.9, 0.999, 1.0] {
        for angle in [0.0f64, 0.7, 1.4, 1.6, 2.2, 3.1] {
            all.push(vec![
                0.6 * length,
                0.0,
                0.8 * length,
                0.6 * angle.cos() + 0.8 * angle.sin(),
                0.0,
                0.8 * angle.cos() - 0.6 * angle.sin(),
            ]);
        }
    }
    all
}

fn directions() -> Vec<Vec<f64>> {
    let at = |i: usize| {
        // Spread evenly by the golden angle, both poles included.
        let z = 1.0 - 2.0 * i as f64 / 63.0;
        let (s, c) = (2.399_963_229_728_653 * i as f64).sin_cos();
        let r = (1.0 - z * z).max(0.0).sqrt();
        vec![r * c, r * s, z]
    };
    (0..64).map(at).collect()
}

fn colours() -> Vec<Vec<f64>> {
    let v = [0.0, 0.02, 0.3, 0.8, 2.0, 40.0];
    v.iter().flat_map(|r| v.iter().flat_map(move |g| v.map(|b| vec![*r, *g, b]))).collect()
}

/// A sphere of radius `r` mm, its nearest point at 100 mm, seen by `n` x `n` pixels of about `q` mm.
fn ball(n: usize, r: f64, q: f64, shift: f64) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
    let scale = q / 100.0;
    let offset = -0.5 * n as f64 * scale + shift;
    let (mut z, mut normal) = (Vec::new(), Vec::new());
    for at in 0..n * n {
        let x = scale * ((at % n) as f64 + 0.5) + offset;
        let y = -scale * ((at / n) as f64 + 0.5) + 0.5 * n as f64 * scale;
        let (a, d) = (x * x + y * y + 1.0, 100.0 + r);
        let root = d * d - a * (d * d - r * r);
        let hit = if root > 0.0 { (d - root.sqrt()) / a } else { 0.0 };
        z.push(hit);
        normal.extend(if hit > 0.0 { [x * hit / r, y * hit / r, (d - hit) / r] } else { [0.0, 0.0, 1.0] });
    }
    (vec![scale, -scale, offset, 0.5 * n as f64 * scale, 1.0], z, normal)
}

fn windows() -> Vec<Vec<f64>> {
    let mut all = Vec::new();
    for (r, q, shift) in [(60.0, 0.5, 0.0), (60.0, 0.5, 0.3), (10.0, 1.0, 0.05), (1e5, 0.5, 0.1), (8.0, 1.0, 0.0725)] {
        let (head, z, normal) = ball(3, r, q, shift);
        all.push([head, z, normal].concat());
    }
    // A neighbour of background, and one of another object.
    for (at, value) in [(5 + 5, 0.0), (5 + 1, -100.5)] {
        let mut case = all[0].clone();
        case[at] = value;
        all.push(case);
    }
    all
}

fn patches() -> Vec<Vec<f64>> {
    let mut all = Vec::new();
    for (r, q, shift, variance, turn) in [
        (60.0, 0.5, 0.0, 0.36, 0.0),
        (20.0, 0.5, 0.08, 0.2, 1.0),
        (5.0, 0.5, 0.035, 0.25, 0.0),
        (1e4, 0.5, 0.4, 0.3, 1.0),
    ] {
        let (head, z, normal) = ball(9, r, q, shift);
        let wave = |i: usize, k: f64| 0.5 + 0.5 * (k * i as f64).sin();
        let h = (0..81).map(|i| 0.1 * wave(i, 0.7)).collect();
        let confidence = (0..81).map(|i| if i % 5 == 0 { 0.0 } else { wave(i, 1.3) }).collect();
        let lit = (0..162).map(|i| wave(i, 0.37)).collect();
        let z = z.iter().map(|z| -z).collect();
        all.push([head, vec![variance, turn], z, normal, h, confidence, lit].concat());
    }
    all
}
