//! Primitives and joints of signed distance fields, mm: negative inside. Distances are exact or of first order, which is
//! what blending needs near the surface.

use glam::DVec3;

/// Union with a fillet; `k` is the distance over which the two surfaces feel each other, and the fillet adds k/4 at most.
pub fn join(a: f64, b: f64, k: f64) -> f64 {
    let h = (k - (a - b).abs()).max(0.) / k;
    a.min(b) - h * h * k / 4.
}

/// Intersection with a rounded edge.
pub fn meet(a: f64, b: f64, k: f64) -> f64 {
    -join(-a, -b, k)
}

/// `a` without `b`, the edge rounded.
pub fn carve(a: f64, b: f64, k: f64) -> f64 {
    meet(a, -b, k)
}

/// 0 below `low`, 1 above `high`, smooth between; `low` may be the larger.
pub fn step(low: f64, high: f64, x: f64) -> f64 {
    let t = ((x - low) / (high - low)).clamp(0., 1.);
    t * t * (3. - 2. * t)
}

pub fn mix(a: f64, b: f64, t: f64) -> f64 {
    a + (b - a) * t
}

/// exp(-|p|^2) of p divided by the widths.
pub fn bump(p: DVec3, center: [f64; 3], width: [f64; 3]) -> f64 {
    let q = (p - DVec3::from(center)) / DVec3::from(width);
    (-q.length_squared()).exp()
}

/// A bump and its mirror image, so that nothing creases at x = 0.
pub fn pair(p: DVec3, center: [f64; 3], width: [f64; 3]) -> f64 {
    bump(p, center, width) + bump(p, [-center[0], center[1], center[2]], width)
}

pub fn sphere(p: DVec3, center: [f64; 3], radius: f64) -> f64 {
    p.distance(DVec3::from(center)) - radius
}

/// Of first order at the surface.
pub fn ellipsoid(p: DVec3, center: [f64; 3], radii: [f64; 3]) -> f64 {
    let (p, r) = (p - DVec3::from(center), DVec3::from(radii));
    let k0 = (p / r).length();
    let k1 = (p / (r * r)).length();
    if k1 < 1e-9 { -r.min_element() } else { k0 * (k0 - 1.) / k1 }
}

/// A capsule whose radius runs from `ra` to `rb`.
pub fn cone(p: DVec3, a: [f64; 3], b: [f64; 3], ra: f64, rb: f64) -> f64 {
    let (a, b) = (DVec3::from(a), DVec3::from(b));
    let (pa, ba) = (p - a, b - a);
    let h = (pa.dot(ba) / ba.length_squared()).clamp(0., 1.);
    (pa - ba * h).length() - mix(ra, rb, h)
}

/// A tube along a smooth curve through the points; the fourth number of each is the radius.
pub fn tube(p: DVec3, points: &[[f64; 4]]) -> f64 {
    const PIECES: usize = 4;
    let at = |i: usize, j: isize| points[(i as isize + j).clamp(0, points.len() as isize - 1) as usize];
    let spot = |i: usize, t: f64| -> [f64; 4] {
        let (a, b, c, d) = (at(i, -1), at(i, 0), at(i, 1), at(i, 2));
        std::array::from_fn(|k| hermite(b[k], c[k], (c[k] - a[k]) / 2., (d[k] - b[k]) / 2., t))
    };
    let mut best = f64::MAX;
    let mut last = spot(0, 0.);
    for i in 0..points.len() - 1 {
        for piece in 1..=PIECES {
            let next = spot(i, piece as f64 / PIECES as f64);
            let [ax, ay, az, ar] = last;
            let [bx, by, bz, br] = next;
            best = best.min(cone(p, [ax, ay, az], [bx, by, bz], ar, br));
            last = next;
        }
    }
    best
}

fn hermite(a: f64, b: f64, da: f64, db: f64, t: f64) -> f64 {
    let (t2, t3) = (t * t, t * t * t);
    a * (2. * t3 - 3. * t2 + 1.) + da * (t3 - 2. * t2 + t) + b * (3. * t2 - 2. * t3) + db * (t3 - t2)
}

/// A smooth curve through (x, y) points of rising x, level beyond its ends. Slopes are limited so that it never overshoots.
pub fn curve(points: &[[f64; 2]], x: f64) -> f64 {
    let n = points.len();
    if x <= points[0][0] {
        return points[0][1];
    }
    if x >= points[n - 1][0] {
        return points[n - 1][1];
    }
    let i = points.partition_point(|p| p[0] <= x) - 1;
    let rise = |i: usize| (points[i + 1][1] - points[i][1]) / (points[i + 1][0] - points[i][0]);
    let slope = |i: usize| {
        if i == 0 || i == n - 1 {
            return 0.;
        }
        let (a, b) = (rise(i - 1), rise(i));
        // Harmonic mean (Fritsch & Butland 1984).
        if a * b <= 0. { 0. } else { 2. * a * b / (a + b) }
    };
    let width = points[i + 1][0] - points[i][0];
    hermite(points[i][1], points[i + 1][1], slope(i) * width, slope(i + 1) * width, (x - points[i][0]) / width)
}

/// Smooth noise in -1..1 with features of about one unit.
pub fn noise(p: DVec3) -> f64 {
    let cell = p.floor();
    let f = p - cell;
    let w = f * f * (DVec3::splat(3.) - 2. * f);
    let corner = |i: i64, j: i64, k: i64| hash(cell.x as i64 + i, cell.y as i64 + j, cell.z as i64 + k);
    let row = |j, k| mix(corner(0, j, k), corner(1, j, k), w.x);
    mix(mix(row(0, 0), row(1, 0), w.y), mix(row(0, 1), row(1, 1), w.y), w.z)
}

fn hash(x: i64, y: i64, z: i64) -> f64 {
    let mut h = (x as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15)
        ^ (y as u64).wrapping_mul(0xc2b2_ae3d_27d4_eb4f)
        ^ (z as u64).wrapping_mul(0x1656_67b1_9e37_79f9);
    h = (h ^ (h >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    h = (h ^ (h >> 32)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((h ^ (h >> 29)) >> 11) as f64 / (1u64 << 52) as f64 - 1.
}
