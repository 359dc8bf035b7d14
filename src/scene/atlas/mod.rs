//! Texture coordinates as a place to work in: which parts hang together, how fine they are, and whether every point of the
//! surface has a place of its own.

mod seams;

use super::Scene;
use glam::{Vec2, Vec3};
pub use seams::{Filled, Seam, gutter};
use std::collections::HashMap;

/// Charts are told apart by a number that a half holds exactly.
const CHART_NUMBERS: u32 = 2047;
/// Coordinates this far outside of the unit square are rounding.
const SLACK: f32 = 1. / 512.;
/// Side of the grid on which overlaps are counted.
const GRID: usize = 1024;
/// Share of the covered grid that may be covered twice: rounding at the edges of charts.
const OVERLAP: f64 = 0.01;

/// An unwrapping that gives every point of the scattering surface its own place.
#[derive(Clone, Debug, PartialEq)]
pub struct Atlas {
    /// For each vertex the number of its chart, 1..=2047; charts that are near each other have different ones, unless there are
    /// more than that. 0 where nothing scatters.
    pub charts: Vec<f32>,
    /// How many charts there are.
    pub count: usize,
    /// Square root of the surface's area over the unwrapped area, mm: what one texel of a one-texel map would cover.
    pub side_mm: f64,
    /// Both sides of every cut.
    pub seams: Vec<Seam>,
    /// Cells of a grid of [`GRID`] a side that charts cover.
    covered: Vec<u8>,
}

/// Widest border of a sheet, in texture coordinates: more would cost more texels than the seams are worth.
const WIDEST_BORDER: f64 = 0.15;

impl Atlas {
    /// How much of a sheet's side lies beside the unit square on each side, so that what is within `reach_mm` of a cut has room.
    pub fn border(&self, reach_mm: f64) -> f64 {
        let reach = reach_mm / self.side_mm;
        let room = |p: &glam::DVec2| p.min_element().min(1. - p.max_element());
        let least = self.seams.iter().flat_map(|s| &s.edge).map(room).fold(f64::INFINITY, f64::min);
        let outside = (reach - least).clamp(0., WIDEST_BORDER);
        outside / (1. + 2. * outside)
    }

    /// Whether a texture coordinate lies well inside a chart: its cell of a coarse grid and those around it are covered.
    fn is_inside(&self, at: glam::DVec2) -> bool {
        let cell = |p: f64| (p * GRID as f64) as i64;
        let (x, y) = (cell(at.x), cell(at.y));
        let last = GRID as i64 - 1;
        if at.min_element() < 0. || x < 1 || y < 1 || x >= last || y >= last {
            return false;
        }
        (-1..=1).all(|dy| (-1..=1).all(|dx| self.covered[((y + dy) * GRID as i64 + x + dx) as usize] > 0))
    }

    /// Looks at the draws of a scene that scatter by the profile of this index ([`Material::scatter`](super::Material::scatter)).
    ///
    /// # Errors
    /// Where there are no coordinates, or they leave the unit square, or two parts of the surface share a place; one line that
    /// says how much and what would be right.
    pub fn new(scene: &Scene, profile: usize) -> Result<Atlas, String> {
        let triangles = scattering(scene, profile);
        if scene.uvs.is_empty() || triangles.is_empty() {
            return Err(
                "it has no texture coordinates; unwrap it, or take a method that works on the screen".to_owned()
            );
        }
        let uv = |i: u32| Vec2::from(scene.uvs[i as usize]);
        let inside = |p: Vec2| p.is_finite() && p.min_element() >= -SLACK && p.max_element() <= 1. + SLACK;
        let outside = triangles.iter().filter(|t| !t.iter().all(|i| inside(uv(*i)))).count();
        if outside > 0 {
            let all = triangles.len();
            return Err(format!(
                "{outside} of its {all} scattering triangles have texture coordinates outside of 0..1; unwrap it into the unit square"
            ));
        }
        let place = |i: u32| Vec3::from(scene.positions[i as usize]);
        let (mut area, mut unwrapped) = (0f64, 0f64);
        for [a, b, c] in &triangles {
            area += 0.5 * f64::from((place(*b) - place(*a)).cross(place(*c) - place(*a)).length());
            unwrapped += 0.5 * f64::from((uv(*b) - uv(*a)).perp_dot(uv(*c) - uv(*a))).abs();
        }
        let covered = cover(&triangles.iter().map(|t| t.map(uv)).collect::<Vec<_>>());
        let count = |n: u8| covered.iter().filter(|c| **c > n).count() as f64;
        let twice = count(1) / count(0).max(1.);
        if twice > OVERLAP {
            return Err(format!(
                "{:.0} % of its unwrapped surface is covered twice (mirrored or stacked texture coordinates); unwrap it so that \
                 every point has a place of its own",
                100. * twice
            ));
        }
        if unwrapped <= 0. {
            return Err("its texture coordinates cover no area; unwrap it".to_owned());
        }
        let (charts, count) = charts(scene, &triangles);
        let seams = seams::find(scene, &triangles, &charts);
        Ok(Atlas { covered, seams, charts, count, side_mm: (area / unwrapped).sqrt() })
    }
}

/// Triangles of the materials that scatter by a profile.
fn scattering(scene: &Scene, profile: usize) -> Vec<[u32; 3]> {
    let scatters = |m: usize| scene.materials.get(m).is_some_and(|m| m.scatter == Some(profile));
    let draws = scene.draws.iter().filter(|d| scatters(d.material));
    let range = |first: u32, count: u32| first as usize..(first + count) as usize;
    draws
        .flat_map(|d| scene.indices[range(d.first_index, d.index_count)].chunks_exact(3))
        .map(|t| [t[0], t[1], t[2]])
        .collect()
}

/// Numbers the parts of the surface that hang together by place and texture coordinate.
fn charts(scene: &Scene, triangles: &[[u32; 3]]) -> (Vec<f32>, usize) {
    let mut places: HashMap<[u32; 5], u32> = HashMap::new();
    let mut parent: Vec<u32> = Vec::new();
    let mut weld = |i: u32| {
        let (p, t) = (scene.positions[i as usize], scene.uvs[i as usize]);
        let key = [p[0], p[1], p[2], t[0], t[1]].map(|x| (x + 0.).to_bits());
        *places.entry(key).or_insert_with(|| {
            parent.push(parent.len() as u32);
            parent.len() as u32 - 1
        })
    };
    let welded: Vec<[u32; 3]> = triangles.iter().map(|t| t.map(&mut weld)).collect();
    fn root(parent: &mut [u32], mut i: u32) -> u32 {
        while parent[i as usize] != i {
            parent[i as usize] = parent[parent[i as usize] as usize];
            i = parent[i as usize];
        }
        i
    }
    for [a, b, c] in &welded {
        for other in [b, c] {
            let (x, y) = (root(&mut parent, *a), root(&mut parent, *other));
            parent[x.max(y) as usize] = x.min(y);
        }
    }
    let mut numbers: HashMap<u32, u32> = HashMap::new();
    let mut charts = vec![0.; scene.positions.len()];
    for (triangle, welded) in triangles.iter().zip(&welded) {
        let next = numbers.len() as u32;
        let number = *numbers.entry(root(&mut parent, welded[0])).or_insert(next);
        triangle.iter().for_each(|i| charts[*i as usize] = (number % CHART_NUMBERS + 1) as f32);
    }
    (charts, numbers.len())
}

/// How many triangles cover each point of a grid.
fn cover(triangles: &[[Vec2; 3]]) -> Vec<u8> {
    let mut covered = vec![0u8; GRID * GRID];
    for [a, b, c] in triangles {
        // A point on an edge belongs to one side: the grid is moved off by what no coordinate is a multiple of.
        let shift = glam::DVec2::new(0.500_731, 0.500_317);
        let p = [a, b, c].map(|p| p.as_dvec2() * GRID as f64 - shift);
        let area = (p[1] - p[0]).perp_dot(p[2] - p[0]);
        if area == 0. {
            continue;
        }
        let least = p[0].min(p[1]).min(p[2]).ceil().max(glam::DVec2::ZERO);
        let most = p[0].max(p[1]).max(p[2]).floor().min(glam::DVec2::splat(GRID as f64 - 1.));
        for y in least.y as i64..=most.y as i64 {
            for x in least.x as i64..=most.x as i64 {
                let at = glam::DVec2::new(x as f64, y as f64);
                let inside = (0..3).all(|k| (p[(k + 1) % 3] - p[k]).perp_dot(at - p[k]) * area.signum() > 0.);
                if inside {
                    let cell = &mut covered[y as usize * GRID + x as usize];
                    *cell = cell.saturating_add(1);
                }
            }
        }
    }
    covered
}
