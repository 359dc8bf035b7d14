//! Kernel mass at the vertices of a mesh: how much surface, seen or hidden, a Gaussian of the profile finds around a point.
//!
//! M(x) is the integral over the surface of G_v(|x - y|) dA(y), G_v(r) = exp(-r^2 / 2v) / (2 pi v): 1 on a plane, 1 - exp(-2
//! r^2/v) on a sphere, about 1 + v (H^2 - K)/2 on a smooth patch, 1 + exp(-t^2 / 2v) on a wide sheet of thickness t, and less
//! than 1 at the border of an open mesh. Exitance is flux gathered over mass, so a method that gathers flux from where the
//! camera does not look needs it. It depends neither on light nor on camera.
//!
//! Area is gathered in cells of half a sigma; cost and error do not depend on how finely a mesh is cut. Lengths in mm.

use glam::{Vec3, ivec3};
use rayon::prelude::*;
use std::collections::{BTreeMap, HashMap};

/// Sigmas beyond which area does not count: what lies there weighs 3e-4 of a plane.
const REACH_SIGMAS: f32 = 4.;
/// Side of a cell in sigmas.
const CELL_SIGMAS: f32 = 0.5;
/// More pieces than this are not cut: the Gaussian is too narrow beside the scene, and its mass stays 1.
const MOST_PIECES: f64 = 6e6;

/// Area with its centroid.
#[derive(Clone, Copy, Debug, Default)]
struct Speck {
    area: f32,
    position: Vec3,
}

/// Mass of one Gaussian of variance `variance` (mm^2) at each of `points` (mm), over triangles (mm). Error against the
/// integral below 6e-3 (plane, sphere, sheet).
pub fn mass(points: &[Vec3], triangles: &[[Vec3; 3]], variance: f64) -> Vec<f32> {
    let sigma = variance.sqrt() as f32;
    let cell = CELL_SIGMAS * sigma;
    let area: f64 = triangles.iter().map(|t| f64::from(area_of(t))).sum();
    // NaN and zero too.
    if !(cell > 0. && area / f64::from(cell * cell) < MOST_PIECES) {
        return vec![1.; points.len()];
    }
    let specks = gathered(triangles, cell);
    let reach = REACH_SIGMAS * sigma;
    let bucket = |p: Vec3| (p / reach).floor().as_ivec3();
    let mut buckets: HashMap<glam::IVec3, Vec<Speck>> = HashMap::new();
    for s in specks {
        buckets.entry(bucket(s.position)).or_default().push(s);
    }
    // A cell's spread cancels over a smooth sheet, as in any midpoint rule: the second derivative of G integrates to 0.
    let (falloff, scale) = (-0.5 / variance as f32, 1. / (std::f32::consts::TAU * variance as f32));
    points
        .par_iter()
        .map(|p| {
            let b = bucket(*p);
            let mut sum = 0f32;
            for i in 0..27 {
                let near = b + ivec3(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
                for s in buckets.get(&near).into_iter().flatten() {
                    sum += s.area * (s.position.distance_squared(*p) * falloff).exp();
                }
            }
            sum * scale
        })
        .collect()
}

/// Share of a Gaussian of standard deviation `sigma_mm` that lies on this side of a straight border at `distance_mm`.
/// As the shaders have it: a logistic curve with a cubic, error below 2e-4.
pub fn beside_border(distance_mm: f32, sigma_mm: f32) -> f32 {
    let x = distance_mm / sigma_mm;
    1. / (1. + (-x * (2.304_85 + 0.101_797 * x * x)).exp2())
}

/// Distance (mm) of each of `points` to the nearest open edge, at most `reach_mm`: edges that one triangle alone has, corners
/// at the same place being one corner. Mass falls to a half there over a sigma or two, faster than vertices stand apart.
pub fn border_distance(points: &[Vec3], triangles: &[[Vec3; 3]], reach_mm: f32) -> Vec<f32> {
    let key = |p: Vec3| (p + Vec3::ZERO).to_array().map(f32::to_bits);
    let mut uses: HashMap<[[u32; 3]; 2], (u32, [Vec3; 2])> = HashMap::new();
    for t in triangles {
        for i in 0..3 {
            let (a, b) = (t[i], t[(i + 1) % 3]);
            let mut ends = [key(a), key(b)];
            ends.sort_unstable();
            if ends[0] != ends[1] {
                uses.entry(ends).or_insert((0, [a, b])).0 += 1;
            }
        }
    }
    let open: Vec<[Vec3; 2]> = uses.into_values().filter(|(n, _)| *n == 1).map(|(_, ends)| ends).collect();
    let longest = open.iter().map(|[a, b]| a.distance(*b)).fold(0., f32::max);
    // An edge within reach has an end in the same or a neighbouring bucket.
    let bucket = |p: Vec3| (p / (reach_mm + longest)).floor().as_ivec3();
    let mut buckets: HashMap<glam::IVec3, Vec<usize>> = HashMap::new();
    for (i, ends) in open.iter().enumerate() {
        for p in ends {
            buckets.entry(bucket(*p)).or_default().push(i);
        }
    }
    let nearest = |p: &Vec3| {
        let b = bucket(*p);
        let near = (0..27).filter_map(|i| buckets.get(&(b + ivec3(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1))));
        near.flatten().map(|i| to_segment(*p, open[*i])).fold(reach_mm, f32::min)
    };
    points.par_iter().map(nearest).collect()
}

fn to_segment(p: Vec3, [a, b]: [Vec3; 2]) -> f32 {
    let along = b - a;
    let t = ((p - a).dot(along) / along.length_squared()).clamp(0., 1.);
    p.distance(a + along * t)
}

fn area_of([a, b, c]: &[Vec3; 3]) -> f32 {
    0.5 * (*b - *a).cross(*c - *a).length()
}

/// Triangles cut until a piece fits a cell, and the pieces of each cell joined.
fn gathered(triangles: &[[Vec3; 3]], cell: f32) -> Vec<Speck> {
    const CHUNK: usize = 4096;
    let parts: Vec<HashMap<glam::IVec3, Speck>> = triangles
        .par_chunks(CHUNK)
        .map(|chunk| {
            let mut cells: HashMap<glam::IVec3, Speck> = HashMap::new();
            for t in chunk {
                pieces(t, cell, &mut |piece| {
                    let centre = (piece[0] + piece[1] + piece[2]) / 3.;
                    let area = area_of(piece);
                    let s = cells.entry((centre / cell).floor().as_ivec3()).or_default();
                    s.area += area;
                    s.position += area * centre;
                });
            }
            cells
        })
        .collect();
    // In order of cells: sums over them must come out the same to the bit every time, and a hash map's order does not.
    let mut all: BTreeMap<[i32; 3], Speck> = BTreeMap::new();
    for (key, s) in parts.into_iter().flatten() {
        let sum = all.entry(key.to_array()).or_default();
        sum.area += s.area;
        sum.position += s.position;
    }
    let centred = |s: Speck| Speck { area: s.area, position: s.position / s.area };
    all.into_values().filter(|s| s.area > 0. && s.position.is_finite()).map(centred).collect()
}

/// Halves a triangle across its longest edge until no edge is longer than `most`.
fn pieces(t: &[Vec3; 3], most: f32, each: &mut impl FnMut(&[Vec3; 3])) {
    let edge = |i: usize| t[i].distance_squared(t[(i + 1) % 3]);
    let longest = (0..3).max_by(|a, b| edge(*a).total_cmp(&edge(*b))).unwrap_or(0);
    if !(edge(longest) > most * most && edge(longest).is_finite()) {
        return each(t);
    }
    let (a, b, c) = (t[longest], t[(longest + 1) % 3], t[(longest + 2) % 3]);
    let middle = a.midpoint(b);
    // An edge of neighbouring numbers has no middle.
    if middle == a || middle == b {
        return each(t);
    }
    pieces(&[a, middle, c], most, each);
    pieces(&[middle, b, c], most, each);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two triangles a square, over -extent..extent in x and z at height y.
    fn sheet(extent: f32, y: f32, n: i32) -> Vec<[Vec3; 3]> {
        let at = |i: i32, j: i32| {
            let c = |k: i32| extent * (2. * k as f32 / n as f32 - 1.);
            Vec3::new(c(i), y, c(j))
        };
        (0..n * n)
            .flat_map(|k| {
                let (i, j) = (k % n, k / n);
                [[at(i, j), at(i + 1, j), at(i, j + 1)], [at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]]
            })
            .collect()
    }

    /// An octahedron, its triangles quartered `times` times: closed to the bit.
    fn sphere(radius: f32, times: u32) -> Vec<[Vec3; 3]> {
        let mut all: Vec<[Vec3; 3]> = (0..8)
            .map(|i| {
                let [x, y, z] = [Vec3::X, Vec3::Y, Vec3::Z].map(|a| a * radius);
                let side = |k: i32, v: Vec3| if i >> k & 1 > 0 { -v } else { v };
                [side(0, x), side(1, y), side(2, z)]
            })
            .collect();
        for _ in 0..times {
            let quartered = |[a, b, c]: [Vec3; 3]| {
                let [d, e, f] = [a + b, b + c, c + a].map(|m| m.normalize() * radius);
                [[a, d, f], [d, b, e], [f, e, c], [d, e, f]]
            };
            all = all.into_iter().flat_map(quartered).collect();
        }
        all
    }

    /// The shapes with a known answer, at places of no particular kind.
    fn worst(mass: impl Fn(&[Vec3], &[[Vec3; 3]], f64) -> Vec<f32>) -> f64 {
        let mut worst = 0f64;
        let mut hold = |what: &str, points: &[Vec3], triangles: &[[Vec3; 3]], v: f64, right: f64| {
            for m in mass(points, triangles, v) {
                let error = (f64::from(m) - right).abs();
                if error > worst {
                    println!("{what}, variance {v}: {m} for {right:.5}");
                    worst = error;
                }
            }
        };
        for v in [0.567f64, 1.99, 7.41] {
            let s = v.sqrt() as f32;
            let points: Vec<Vec3> = (0..9).map(|i| Vec3::new(0.11 * i as f32, 0., 0.37 * i as f32) * s).collect();
            for n in [2, 40] {
                let flat = sheet(20. * s, 0., n);
                hold("plane", &points, &flat, v, 1.);
                let thickness = 1.3 * s;
                let both: Vec<[Vec3; 3]> = flat.iter().copied().chain(sheet(20. * s, thickness, n)).collect();
                let other = (-f64::from(thickness).powi(2) / (2. * v)).exp();
                hold("sheet", &points, &both, v, 1. + other);
            }
            for radius in [2. * s, 8. * s] {
                let ball = sphere(radius, 6);
                let on: Vec<Vec3> = ball.iter().step_by(997).map(|t| t[0]).collect();
                hold("sphere", &on, &ball, v, 1. - (-2. * f64::from(radius).powi(2) / v).exp());
            }
        }
        worst
    }

    #[test]
    fn mass_of_planes_sheets_and_spheres() {
        let right = worst(mass);
        // The twin: a little too wide.
        let wrong = worst(|p, t, v| mass(p, t, v * 1.04));
        println!("error at most {right:.5}; with a variance of 4 % more {wrong:.5}");
        assert!(right < 6e-3 && wrong > 6e-3);
    }

    #[test]
    fn borders_of_open_meshes_alone() {
        let flat = sheet(10., 0., 40);
        let points = [Vec3::ZERO, Vec3::new(9.3, 0., 1.), Vec3::new(-4., 0., 9.9), Vec3::new(10., 0., 10.)];
        let found = border_distance(&points, &flat, 3.);
        let right = [3., 0.7, 0.1, 0.];
        println!("{found:?}");
        assert!(found.iter().zip(right).all(|(a, b)| (a - b).abs() < 1e-5), "{found:?}");
        let ball = sphere(10., 3);
        let on: Vec<Vec3> = ball.iter().map(|t| t[0]).collect();
        assert!(border_distance(&on, &ball, 3.).iter().all(|d| *d == 3.), "a closed mesh has no border");
        // The twin: a triangle fewer.
        assert!(border_distance(&on, &ball[1..], 3.).contains(&0.));
    }

    #[test]
    fn half_a_plane_has_half_the_mass() {
        let (half, v) = (sheet(20., 0., 40), 1.99f64);
        let points: Vec<Vec3> = (0..40).map(|i| Vec3::new(20. - 0.2 * i as f32, 0., 0.3)).collect();
        let borders = border_distance(&points, &half, 20.);
        let errors = mass(&points, &half, v).into_iter().zip(&borders);
        let worst = |sigma: f32| errors.clone().map(|(m, d)| (m - beside_border(*d, sigma)).abs()).fold(0., f32::max);
        let (right, wrong) = (worst(v.sqrt() as f32), worst(1.1 * v.sqrt() as f32));
        println!("beside a border off by {right:.4} at most; with a sigma of 10 % more {wrong:.4}");
        assert!(right < 0.01 && wrong > 0.01);
    }

    #[test]
    fn what_cannot_be_cut_is_left_at_one() {
        let points = [Vec3::ZERO];
        assert_eq!(mass(&points, &sheet(10., 0., 2), 0.), [1.]);
        assert_eq!(mass(&points, &sheet(1e6, 0., 2), 1e-4), [1.]);
        assert_eq!(mass(&points, &[], 1.), [0.]);
        let nan = mass(&points, &[[Vec3::NAN; 3], [Vec3::ZERO; 3]], 1.);
        assert!(nan[0].is_finite(), "{nan:?}");
    }
}
