//! Mean and Gaussian curvature from view distances and normals: the f64 twin of `glsl/curvature.comp`.
//!
//! Everything is computed in pixel footprints (one unit = q, the size in mm of a pixel at the centre's distance) and
//! scaled once at the end, so the same bits of work serve an object of a micrometre and one of a kilometre:
//! with ray_k = (slope of the view ray, -1), P_k - P_0 = z_0 (ray_k - ray_0) + (z_k - z_0) ray_k, which divided by q is
//! a constant pixel step plus e_k ray_k, e_k = (z_k - z_0) / q. Only the two stored distances are subtracted, and that
//! subtraction is exact in floating point between neighbours; products z ray are never differenced.
mod real;
mod vergne;

use real::{Real, V3, add, cross, dot, scale, sub};

/// How curvature is read off the G-buffer. `ESTIMATOR` in the shader counts in this order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Estimator {
    /// Vergne et al. 2009: trace of the Hessian of depth in screen space. Divides by n.z; kept as the rival.
    Vergne,
    /// Chen, Lambert & Penner 2014, equation 1, with the projection's own Jacobian.
    Trace,
    /// Fundamental forms from four neighbours, each axis choosing its sides. The default.
    Metric,
    /// Least squares in the tangent plane over eight neighbours.
    Fit,
    /// Vergne's own later code: a tamed exponent, a floor under n.z, nothing at silhouettes.
    VergneMended,
}

impl Estimator {
    /// Every estimator, in the shader's order.
    pub const ALL: [Self; 5] = [Self::Vergne, Self::Trace, Self::Metric, Self::Fit, Self::VergneMended];

    /// As the command line spells it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Vergne => "vergne",
            Self::Trace => "trace",
            Self::Metric => "metric",
            Self::Fit => "fit",
            Self::VergneMended => "vergne-mended",
        }
    }
}

/// The projection, as in the shader's `frame`: `ray.xy = ray_scale * (pixel + .5) + ray_offset`.
#[derive(Debug, Clone, Copy)]
pub struct Camera {
    /// View x, y per pixel at unit distance (perspective) or in mm (orthographic). Signed: y usually runs down.
    pub ray_scale: [f64; 2],
    /// In the same unit.
    pub ray_offset: [f64; 2],
    /// Or orthographic.
    pub perspective: bool,
}

impl Camera {
    /// Pixels per mm at unit distance.
    pub fn pixels_per_mm(&self) -> f64 {
        (1.0 / self.ray_scale[1]).abs()
    }

    /// Pixel footprint in mm at view distance `z` (mm).
    pub fn footprint(&self, z: f64) -> f64 {
        if self.perspective { z.abs() / self.pixels_per_mm() } else { 1.0 / self.pixels_per_mm() }
    }
}

/// What the estimators read, row by row from the top.
#[derive(Debug, Clone)]
pub struct GBuffer {
    /// Pixels.
    pub width: usize,
    /// Pixels.
    pub height: usize,
    /// Distance along the view axis in mm; negated where the surface scatters; 0 is background.
    pub z: Vec<f64>,
    /// Unit, view space, unbumped, facing the viewer.
    pub normal: Vec<[f64; 3]>,
    /// What they were seen with.
    pub camera: Camera,
}

/// Curvature of one pixel; all zero on background.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Curvature {
    /// Mean curvature, 1/mm, convex > 0.
    pub h: f64,
    /// Gaussian curvature, 1/mm^2; 0 from an estimator that has none.
    pub k: f64,
    /// 1: measured from both sides on both axes; 0: do not use, fill from the neighbours.
    pub confidence: f64,
}

/// Largest |H| of `metric` and `fit`, in 1/q: a feature with a radius under about 2 pixels cannot be told from noise.
pub const FOOTPRINT_BOUND: f64 = 0.5;
/// Two sides of an axis are averaged while neither step is longer than 3 times the other (9: squared).
pub const SIDE_RATIO_SQUARED: f64 = 9.0;
/// Normals further apart than 60 degrees belong to two faces. Between pixels a smooth surface within the footprint
/// bound turns by 30 at most face on. At 90 degrees, a cube's, rounding of the normal would decide.
pub const CREASE_COS: f64 = 0.5;
/// The determinant's floor, relative to E G: a parallelogram this thin is rounding noise in f32.
pub const DETERMINANT_FLOOR: f64 = 1e-6;
/// Cosine between shading and measured normal from which `metric` begins to trust, and trusts fully.
pub const AGREE_COS: [f64; 2] = [0.5, 0.9];
/// `fit` adds this share of its matrix' trace to the diagonal: a line of neighbours still yields its curvature.
pub const RIDGE: f64 = 1e-6;
/// Sum of weights below which `fit` found no neighbour; one good neighbour is 1.
pub const NO_WEIGHT: f64 = 1e-12;
/// Neighbours, of 8, that give `fit` full confidence: the half left over is what its own weights take at grazing angles.
pub const ENOUGH_VOTES: f64 = 7.5;

/// The reference.
pub fn estimate(estimator: Estimator, g: &GBuffer) -> Vec<Curvature> {
    estimate_in::<f64>(estimator, g)
}

/// The same text in f32, from distances and normals rounded to f32: what the shader may lose.
pub fn estimate_f32(estimator: Estimator, g: &GBuffer) -> Vec<Curvature> {
    estimate_in::<f32>(estimator, g)
}

fn estimate_in<T: Real>(estimator: Estimator, g: &GBuffer) -> Vec<Curvature> {
    let mut out = Vec::with_capacity(g.width * g.height);
    for y in 0..g.height {
        for x in 0..g.width {
            out.push(pixel::<T>(estimator, g, x, y));
        }
    }
    out
}

fn pixel<T: Real>(estimator: Estimator, g: &GBuffer, x: usize, y: usize) -> Curvature {
    let Some(window) = Window::<T>::new(g, x, y) else { return Curvature::default() };
    let local = match estimator {
        Estimator::Vergne => vergne::published(&window),
        Estimator::VergneMended => vergne::mended(&window),
        Estimator::Trace => trace(&window),
        Estimator::Metric => bounded(metric(&window)),
        Estimator::Fit => bounded(fit(&window)),
    };
    let per_mm = window.per_mm.f64();
    Curvature {
        h: local.h.f64() * per_mm,
        k: local.k.f64() * per_mm * per_mm,
        confidence: local.confidence.clamped(0.0, 1.0).f64(),
    }
}

/// Curvature in units of the footprint: H q, K q^2.
struct Local<T> {
    h: T,
    k: T,
    confidence: T,
}

/// Clamps to the footprint's limit; what exceeded it was not measured.
fn bounded<T: Real>(c: Local<T>) -> Local<T> {
    let h = c.h.clamped(-FOOTPRINT_BOUND, FOOTPRINT_BOUND);
    let square = FOOTPRINT_BOUND * FOOTPRINT_BOUND;
    let confidence = if c.h.abs() > T::of(FOOTPRINT_BOUND) { T::of(0.0) } else { c.confidence };
    Local { h, k: c.k.clamped(-square, square), confidence }
}

/// A neighbour, relative to the centre.
#[derive(Clone, Copy)]
struct Step<T> {
    /// Position difference in footprints.
    p: V3<T>,
    normal: V3<T>,
    /// Not background, inside the image.
    covered: bool,
    /// Covered, the same object, and no crease between.
    usable: bool,
}

struct Window<'a, T> {
    g: &'a GBuffer,
    x: i64,
    y: i64,
    z: T,
    scatters: bool,
    n: V3<T>,
    /// Footprints per mm: 1/q.
    per_mm: T,
    /// The pixel step along each axis in footprints: +1 or -1 for square pixels.
    unit: [T; 2],
    /// View ray's slope through the centre (0 in an orthographic view), and its change per pixel.
    slope: [T; 2],
    slope_step: [T; 2],
}

impl<'a, T: Real> Window<'a, T> {
    fn new(g: &'a GBuffer, x: usize, y: usize) -> Option<Self> {
        let at = y * g.width + x;
        let z = g.z[at];
        if z == 0.0 {
            return None;
        }
        let ppm = T::of(g.camera.pixels_per_mm());
        let perspective = T::of(if g.camera.perspective { 1.0 } else { 0.0 });
        let scale = g.camera.ray_scale.map(T::of);
        let offset = g.camera.ray_offset.map(T::of);
        let centre = [T::of(x as f64 + 0.5), T::of(y as f64 + 0.5)];
        let distance = T::of(z).abs();
        Some(Self {
            g,
            x: x as i64,
            y: y as i64,
            z: distance,
            scatters: z < 0.0,
            n: g.normal[at].map(T::of),
            per_mm: if g.camera.perspective { ppm / distance } else { ppm },
            unit: [scale[0] * ppm, scale[1] * ppm],
            slope: [0, 1].map(|i| perspective * (scale[i] * centre[i] + offset[i])),
            slope_step: [perspective * scale[0], perspective * scale[1]],
        })
    }

    fn step(&self, dx: i64, dy: i64) -> Step<T> {
        let (x, y) = (self.x + dx, self.y + dy);
        let inside = x >= 0 && y >= 0 && x < self.g.width as i64 && y < self.g.height as i64;
        // Outside: the centre stands in, finite, and is marked as not covered.
        let at = if inside {
            y as usize * self.g.width + x as usize
        } else {
            self.y as usize * self.g.width + self.x as usize
        };
        let (z, normal) = (self.g.z[at], self.g.normal[at].map(T::of));
        let e = (T::of(z).abs() - self.z) * self.per_mm;
        let (i, j) = (T::of(dx as f64), T::of(dy as f64));
        let covered = inside && z != 0.0;
        Step {
            p: [
                i * self.unit[0] + e * (self.slope[0] + i * self.slope_step[0]),
                j * self.unit[1] + e * (self.slope[1] + j * self.slope_step[1]),
                -e,
            ],
            normal,
            covered,
            usable: covered && (z < 0.0) == self.scatters && dot(normal, self.n) > T::of(CREASE_COS),
        }
    }
}

fn mask<T: Real>(on: bool) -> T {
    T::of(if on { 1.0 } else { 0.0 })
}

/// Central difference per pixel of `f` along one axis over the covered sides, and how many there were.
fn per_pixel<T: Real>(w: &Window<T>, dx: i64, dy: i64, f: impl Fn(V3<T>) -> V3<T>) -> (V3<T>, T) {
    let (ahead, behind) = (w.step(dx, dy), w.step(-dx, -dy));
    let (a, b) = (mask::<T>(ahead.covered), mask::<T>(behind.covered));
    let centre = f(w.n);
    let total = add(scale(sub(f(ahead.normal), centre), a), scale(sub(centre, f(behind.normal)), b));
    (scale(total, T::of(1.0) / (a + b).at_least(T::of(1.0))), a + b)
}

/// How far to trust differences over `u` and `v` sides of the two axes (0, 1, 2 each).
fn sides<T: Real>(u: T, v: T) -> T {
    let zero = T::of(0.0);
    if u > zero && v > zero { u * v * T::of(0.25) } else { (u + v) * T::of(0.125) }
}

/// grad n = n_u (x) grad u + n_v (x) grad v with grad u = (e_x + slope_x e_z)/(z ray_scale_x): n is constant along a
/// ray, so the poster's third term is 0. n^T grad n = 0 leaves the trace 2H and the second invariant K.
fn trace<T: Real>(w: &Window<T>) -> Local<T> {
    let (u, sides_u) = per_pixel(w, 1, 0, |n| n);
    let (v, sides_v) = per_pixel(w, 0, 1, |n| n);
    let along_u = |d: V3<T>| (d[0] + w.slope[0] * d[2]) / w.unit[0];
    let along_v = |d: V3<T>| (d[1] + w.slope[1] * d[2]) / w.unit[1];
    let (uu, uv, vu, vv) = (along_u(u), along_v(u), along_u(v), along_v(v));
    Local { h: T::of(0.5) * (uu + vv), k: uu * vv - uv * vu, confidence: sides(sides_u, sides_v) }
}

/// One axis of `metric`: differences of position and normal over the sides that serve, and their number.
fn axis<T: Real>(w: &Window<T>, dx: i64, dy: i64) -> (V3<T>, V3<T>, T) {
    let (ahead, behind) = (w.step(dx, dy), w.step(-dx, -dy));
    let (a2, b2) = (dot(ahead.p, ahead.p), dot(behind.p, behind.p));
    let ratio = T::of(SIDE_RATIO_SQUARED);
    // Position and normal always take the same sides: n is affine in P on a sphere, so any pair is exact there.
    let a = ahead.usable && (!behind.usable || a2 <= ratio * b2);
    let b = behind.usable && (!ahead.usable || b2 <= ratio * a2);
    // The centre itself stands in for a side left out.
    let (here, centre) = ([T::of(0.0); 3], w.n);
    let p = sub(if a { ahead.p } else { here }, if b { behind.p } else { here });
    let n = sub(if a { ahead.normal } else { centre }, if b { behind.normal } else { centre });
    (p, n, mask::<T>(a) + mask::<T>(b))
}

/// H = (G L + E N - 2 F M) / (2 (E G - F^2)), K = (L N - M^2) / (E G - F^2).
fn metric<T: Real>(w: &Window<T>) -> Local<T> {
    let (zero, half) = (T::of(0.0), T::of(0.5));
    let (pu, nu, sides_u) = axis(w, 1, 0);
    let (pv, nv, sides_v) = axis(w, 0, 1);
    let (e, f, g) = (dot(pu, pu), dot(pu, pv), dot(pv, pv));
    let (l, n, m) = (dot(nu, pu), dot(nv, pv), half * (dot(nu, pv) + dot(nv, pu)));
    let both = sides_u > zero && sides_v > zero;
    if !both {
        // The missing axis left zeros: these sums are the other axis' own L and E. A line says nothing about K.
        let h = if e + g > zero { half * (l + n) / (e + g) } else { zero };
        return Local { h, k: zero, confidence: sides(sides_u, sides_v) };
    }
    // |p_u x p_v|^2 rather than E G - F^2: at grazing angles those two nearly cancel.
    let mut measured = cross(pu, pv);
    if (w.unit[0] * w.unit[1]) < zero {
        measured = scale(measured, -T::of(1.0));
    }
    let area2 = dot(measured, measured).at_least(T::of(DETERMINANT_FLOOR) * e * g);
    let cosine = dot(measured, w.n) / area2.sqrt();
    let agree = ((cosine - T::of(AGREE_COS[0])) / T::of(AGREE_COS[1] - AGREE_COS[0])).clamped(0.0, 1.0);
    Local {
        h: half * (g * l + e * n - T::of(2.0) * f * m) / area2,
        k: (l * n - m * m) / area2,
        confidence: sides(sides_u, sides_v) * agree,
    }
}

const RING: [(i64, i64); 8] = [(-1, -1), (0, -1), (1, -1), (-1, 0), (1, 0), (-1, 1), (0, 1), (1, 1)];

/// S = B A^-1 with A = sum w a a^T, B = sum w m a^T over the neighbours' tangential steps a and normal changes m.
fn fit<T: Real>(w: &Window<T>) -> Local<T> {
    let (zero, one, half) = (T::of(0.0), T::of(1.0), T::of(0.5));
    let (t, b) = tangents(w.n);
    let (mut a00, mut a01, mut a11) = (zero, zero, zero);
    let (mut b00, mut b01, mut b10, mut b11) = (zero, zero, zero, zero);
    let mut votes = zero;
    for (dx, dy) in RING {
        let s = w.step(dx, dy);
        let (d2, height) = (dot(s.p, s.p), dot(s.p, w.n));
        // exp(-4 (h / (.5 |d|))^4) exp(-(|d| / 24)^4): off the tangent plane, or many footprints away.
        let (lift, far) = (height * height / d2, d2 / T::of(576.0));
        let vote = mask::<T>(s.usable) * (-(T::of(64.0) * lift * lift + far * far)).exp();
        let weight = vote / d2;
        let change = sub(s.normal, w.n);
        let (ax, ay, mx, my) = (dot(s.p, t), dot(s.p, b), dot(change, t), dot(change, b));
        votes = votes + vote;
        (a00, a01, a11) = (a00 + weight * ax * ax, a01 + weight * ax * ay, a11 + weight * ay * ay);
        (b00, b01) = (b00 + weight * mx * ax, b01 + weight * mx * ay);
        (b10, b11) = (b10 + weight * my * ax, b11 + weight * my * ay);
    }
    let spread = a00 + a11;
    if spread < T::of(NO_WEIGHT) {
        return Local { h: zero, k: zero, confidence: zero };
    }
    // Divided by the trace: products of weights as small as these may be would underflow.
    let unit = one / spread;
    let (a00, a01, a11) = (a00 * unit + T::of(RIDGE), a01 * unit, a11 * unit + T::of(RIDGE));
    let (b00, b01, b10, b11) = (b00 * unit, b01 * unit, b10 * unit, b11 * unit);
    let inverse = one / (a00 * a11 - a01 * a01);
    let (s00, s01) = ((b00 * a11 - b01 * a01) * inverse, (b01 * a00 - b00 * a01) * inverse);
    let (s10, s11) = ((b10 * a11 - b11 * a01) * inverse, (b11 * a00 - b10 * a01) * inverse);
    let shear = half * (s01 + s10);
    Local { h: half * (s00 + s11), k: s00 * s11 - shear * shear, confidence: votes / T::of(ENOUGH_VOTES) }
}

/// An orthonormal tangent pair without a branch that divides by zero (Duff et al. 2017).
fn tangents<T: Real>(n: V3<T>) -> (V3<T>, V3<T>) {
    let one = T::of(1.0);
    let sign = if n[2] < T::of(0.0) { -one } else { one };
    let a = -one / (sign + n[2]);
    let b = n[0] * n[1] * a;
    ([one + sign * n[0] * n[0] * a, sign * b, -sign * n[0]], [b, sign + n[1] * n[1] * a, -n[1]])
}
