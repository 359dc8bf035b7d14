//! Light found from the light's own view, in plain loops: the f64 twin of `glsl/translucent.comp` and `glsl/sparse.comp`.
//!
//! Every texel of a directional light's map carries the same flux, so a Gaussian's integral over the lit surface, hidden parts
//! included, is the mean of exp(-dz^2 / 2v) over offsets drawn from it in the light's plane, dz the distance along the light
//! between the shaded point and what the map holds there (after translucent shadow maps, Dachsbacher & Stamminger 2003).

use super::blur::dot;

type V3 = [f64; 3];

/// What is kept of a directional light's shadow map.
#[derive(Clone, Debug)]
pub struct LightView {
    /// Texels across and down.
    pub side: usize,
    /// Reversed depth, 0 where nothing is, row by row.
    pub depth: Vec<f64>,
    /// From view space (mm) to the map's clip space: -1..1 across and down, 0..1 along the light.
    pub rows: [[f64; 4]; 3],
    /// Unit, view space, towards the light.
    pub l: V3,
    /// Channel that its light is added to.
    pub slot: usize,
    /// Of that channel's light.
    pub part: f64,
}

/// How one level is gathered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gather {
    /// Of the level's Gaussian, mm^2, above 0.
    pub variance: f64,
    /// Offsets a light.
    pub taps: usize,
    /// Several lights have a channel together.
    pub shared: bool,
    /// Texels of the shadow map along each axis for one that is kept.
    pub step: usize,
}

/// A texel of the level, before.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Seen {
    /// View space, mm.
    pub position: V3,
    /// Unit; the triangle's own where shading normals stray from it.
    pub n: V3,
    /// The level's mean normal, not normalised.
    pub mean: V3,
    /// One over the kernel's mass.
    pub share: f64,
    /// Light of two channels, blurred on the screen.
    pub lit: [f64; 2],
    /// The same by the triangles' own normals, where shading normals stray from them.
    pub bare: Option<[f64; 2]>,
}

/// Radians between two offsets one after the other: pi (3 - sqrt 5).
const GOLDEN: f64 = 2.399_963_229_728_653;
/// Least cosine at which the tangent plane has a slope in the light's view.
const EDGE_ON: f64 = 1e-3;

/// Every `step`-th texel along each axis of a map of `side` x `side`, taken from the middle of its cell.
pub fn sparse<T: Copy>(map: &[T], side: usize, step: usize) -> Vec<T> {
    let cells = side / step;
    (0..cells * cells).map(|i| map[(i / cells * step + step / 2) * side + i % cells * step + step / 2]).collect()
}

/// Radians from the first offset of a light to that of the next, where lights share.
const SKEW: f64 = 0.8;

/// Part of a light's irradiance that the Gaussian collects at a point whose normal is `n`, before the kernel's mass. Offsets start at
/// `turn` radians, and are spaced by `phase`, 0..1.
pub fn gathered(view: &LightView, position: V3, n: V3, gather: &Gather, turn: f64, phase: f64) -> f64 {
    let axis = view.rows.map(|r| [r[0], r[1], r[2]]);
    let length = axis.map(|a| dot(a, a).sqrt());
    let clip: V3 = std::array::from_fn(|i| dot(axis[i], position) + view.rows[i][3]);
    let side = view.side as f64;
    let sigma = gather.variance.sqrt();
    // In cells of what is kept. What is kept of a cell is half a texel past its middle.
    let at = [0, 1].map(|i| (clip[i] * 0.5 + 0.5) * side - 0.5 / gather.step as f64);
    let cells_per_sigma = [0, 1].map(|i| sigma * length[i] * 0.5 * side);
    let c = dot(n, view.l);
    let slope = [0, 1].map(|i| dot(n, axis[i]) / length[i] / c.max(EDGE_ON));
    let (mut found, mut plane, mut both, mut square) = (0.0, 0.0, 0.0, 0.0);
    for i in 0..gather.taps {
        // Vogel's spiral, stretched to a Gaussian; each offset counts where its texel is.
        let radius = (-2.0 * (1.0 - (i as f64 + phase) / gather.taps as f64).ln()).sqrt();
        let angle = turn + i as f64 * GOLDEN;
        let cell = [angle.cos(), angle.sin()];
        let cell: [f64; 2] = std::array::from_fn(|k| (at[k] + cell[k] * radius * cells_per_sigma[k]).floor());
        let offset: [f64; 2] = std::array::from_fn(|k| (cell[k] + 0.5 - at[k]) / cells_per_sigma[k]);
        let inside = cell.iter().all(|x| (0.0..side).contains(x));
        let depth = if inside { view.depth[cell[1] as usize * view.side + cell[0] as usize] } else { 0.0 };
        let off = (depth - clip[2]) / length[2];
        let f = if depth > 0.0 { (-0.5 * off * off / gather.variance).exp() } else { 0.0 };
        let rise = offset[0] * slope[0] + offset[1] * slope[1];
        let p = (-0.5 * rise * rise).exp();
        found += f;
        plane += p;
        both += f * p;
        square += p * p;
    }
    // The tangent plane is a control variate, its mean the cosine, its share the regression of one on the other.
    let share = if c > EDGE_ON && square > 0.0 { (both / square).min(1.0) } else { 0.0 };
    let taps = gather.taps as f64;
    if gather.shared {
        return found / taps;
    }
    (found / taps + share * (c - plane / taps)).max(0.0)
}

/// What takes the place of a texel's blurred light: found where the screen may be blind, seen elsewhere.
pub fn level(seen: &Seen, views: &[LightView], gather: &Gather) -> [f64; 2] {
    let mass = 1.0 / seen.share.max(0.1);
    // Spread of the normals, and mass that is not 1, tell of surface that the camera does not see.
    let needed = smoothstep(0.015, 0.09, 1.0 - dot(seen.mean, seen.mean) + 2.0 * (mass - 1.0).abs());
    let (mut found, mut shares) = ([0.0; 2], [0.0; 2]);
    for (i, view) in views.iter().enumerate() {
        let grazing = if gather.shared { 1.0 } else { smoothstep(0.08, 0.3, dot(seen.n, view.l).abs()) };
        shares[view.slot] = needed * grazing;
        let (turn, phase) =
            if gather.shared { (i as f64 * SKEW, (i as f64 + 0.5) / views.len() as f64) } else { (0.0, 0.5) };
        if shares[view.slot] > 0.0 {
            found[view.slot] += view.part * gathered(view, seen.position, seen.n, gather, turn, phase) * seen.share;
        }
    }
    std::array::from_fn(|i| {
        let detail = seen.bare.map_or(0.0, |bare| seen.lit[i] - bare[i]);
        (seen.lit[i] * (1.0 - shares[i]) + (found[i] + detail) * shares[i]).clamp(0.0, 1.0)
    })
}

fn smoothstep(low: f64, high: f64, x: f64) -> f64 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
