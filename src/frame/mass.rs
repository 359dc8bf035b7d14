//! The kernel's mass at every vertex, as a vertex stream: what gathered light is divided by.

use super::levels::Levels;
use crate::cache::{Cache, hash, program};
use crate::scene::{Draw, Scene};
use crate::skin::mass::{beside_border, border_distance, mass};
use glam::Vec3;

/// Sigmas of the widest level beyond which a border is not felt.
const BORDER_SIGMAS: f32 = 4.;

/// Shading normals this far (rms of the difference of unit vectors, over the surface) from the triangles' own are told apart.
const STRAY: f32 = 0.02;

/// Whether vertex normals stray from the triangles' own: coarse meshes.
pub fn strays(scene: &Scene) -> bool {
    let (mut square, mut area) = (0f64, 0f64);
    for t in scene.indices.chunks_exact(3) {
        let corner = |i: usize| scene.positions.get(t[i] as usize).map_or(Vec3::ZERO, |p| Vec3::from(*p));
        let normal = |i: usize| scene.normals.get(t[i] as usize).map_or(Vec3::ZERO, |n| Vec3::from(*n));
        let cross = (corner(1) - corner(0)).cross(corner(2) - corner(0));
        let (own, weight) = (cross.normalize_or_zero(), f64::from(cross.length()));
        // Halfway between corners, where an interpolated normal is farthest from being a corner's own.
        let stray: f32 =
            (0..3).map(|i| (normal(i) + normal((i + 1) % 3)).normalize_or_zero().distance_squared(own)).sum();
        square += weight * f64::from(stray) / 3.;
        area += weight;
    }
    square > f64::from(STRAY * STRAY) * area
}

/// As [`of_vertices`], looked for in `cache` first and kept there.
pub fn kept(cache: Option<&Cache>, scene: &Scene, levels: &Levels) -> Vec<[f32; 4]> {
    let Some(cache) = cache else { return of_vertices(scene, levels) };
    let key = key(scene, levels);
    let found = cache.read("mass", key).filter(|b| b.len() == 16 * scene.positions.len());
    found.map_or_else(
        || {
            let made = of_vertices(scene, levels);
            cache.write("mass", key, bytemuck::cast_slice(&made));
            made
        },
        |bytes| bytes.chunks_exact(16).map(bytemuck::pod_read_unaligned).collect(),
    )
}

/// All that the mass depends on, the program that finds it included.
fn key(scene: &Scene, levels: &Levels) -> u64 {
    let mut facts: Vec<u64> = vec![program()];
    for d in scene.draws.iter().filter(|d| scene.materials.get(d.material).is_some_and(|m| m.scatter.is_some())) {
        facts.extend([u64::from(d.first_index), u64::from(d.index_count)]);
    }
    for level in &levels.levels {
        facts.extend([level.variance.to_bits(), u64::from(level.gathered)]);
    }
    let runs: [&[u8]; 3] =
        [bytemuck::cast_slice(&facts), bytemuck::cast_slice(&scene.positions), bytemuck::cast_slice(&scene.indices)];
    hash(&runs)
}

/// At each vertex: mass of the gathered levels, at most [`super::levels::MOST_GATHERED`], with what a border takes off divided
/// out; and the distance to the nearest border, mm. A border's own profile is put back for each pixel (`glsl/gbuffer.frag`).
/// Only what scatters has mass.
pub fn of_vertices(scene: &Scene, levels: &Levels) -> Vec<[f32; 4]> {
    let points: Vec<Vec3> = scene.positions.iter().map(|p| Vec3::from(*p)).collect();
    let scatters = |d: &&Draw| scene.materials.get(d.material).is_some_and(|m| m.scatter.is_some());
    let mut triangles = Vec::new();
    for draw in scene.draws.iter().filter(scatters) {
        let all = scene.indices.iter().skip(draw.first_index as usize).take(draw.index_count as usize);
        let corners: Vec<Vec3> = all.filter_map(|i| points.get(*i as usize).copied()).collect();
        triangles.extend(corners.chunks_exact(3).map(|c| [c[0], c[1], c[2]]));
    }
    let widest = levels.levels.last().map_or(0., |l| l.variance.sqrt() as f32);
    // Between a border and a vertex out of reach distance must still grow as it does.
    let edge = triangles.iter().map(|[a, b, c]| a.distance(*b).max(b.distance(*c)).max(c.distance(*a)));
    let reach = BORDER_SIGMAS * widest + edge.fold(0., f32::max);
    let borders = border_distance(&points, &triangles, reach);
    let mut all: Vec<[f32; 4]> = borders.iter().map(|d| [1., 1., 1., *d]).collect();
    for (i, level) in levels.levels.iter().filter(|l| l.gathered).enumerate() {
        for (vertex, m) in all.iter_mut().zip(mass(&points, &triangles, level.variance)) {
            vertex[i] = m / beside_border(vertex[3], level.variance.sqrt() as f32);
        }
    }
    all
}
