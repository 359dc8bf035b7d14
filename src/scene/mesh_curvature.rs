//! Curvature of the mesh itself, for shading that interpolates it (Penner & Borshukov 2011; the recipe is NVIDIA FaceWorks').

use super::Scene;
use glam::Vec3;
use std::collections::HashMap;

/// Rounds of smoothing over the edges.
const SMOOTHINGS: usize = 2;

/// Unsigned curvature at each vertex, 1/mm, for the scene's positions and normals: along an edge it is |dN| / |dP|; a vertex
/// takes the middle between its least and its greatest edge, twice smoothed over its neighbours. Vertices of one place and one
/// normal count as one, so seams of the texture coordinates are no edges; a vertex without an edge has 0.
pub fn vertex_curvature(scene: &Scene) -> Vec<f32> {
    let mut places: HashMap<[u32; 6], u32> = HashMap::with_capacity(scene.positions.len());
    let mut first: Vec<usize> = Vec::new();
    let weld = |(i, (p, n)): (usize, (&[f32; 3], &[f32; 3]))| {
        // Adding zero makes -0 equal to 0.
        let bits = |x: f32| (x + 0.).to_bits();
        let key = [p[0], p[1], p[2], n[0], n[1], n[2]].map(bits);
        *places.entry(key).or_insert_with(|| {
            first.push(i);
            first.len() as u32 - 1
        })
    };
    let welded: Vec<u32> = scene.positions.iter().zip(&scene.normals).enumerate().map(weld).collect();
    let mut edges: Vec<(u32, u32)> = Vec::with_capacity(scene.indices.len());
    for t in scene.indices.chunks_exact(3) {
        let t = [0, 1, 2].map(|k| welded[t[k] as usize]);
        edges.extend([0, 1, 2].map(|k| (t[k].min(t[(k + 1) % 3]), t[k].max(t[(k + 1) % 3]))));
    }
    edges.sort_unstable();
    edges.dedup();
    edges.retain(|e| e.0 != e.1);

    let mut range = vec![(f32::INFINITY, 0f32); first.len()];
    for (a, b) in &edges {
        let [i, j] = [a, b].map(|v| first[*v as usize]);
        let along = (Vec3::from(scene.positions[i]) - Vec3::from(scene.positions[j])).length();
        let turned = (Vec3::from(scene.normals[i]) - Vec3::from(scene.normals[j])).length();
        if along <= 0. {
            continue;
        }
        for v in [a, b] {
            let (least, most) = &mut range[*v as usize];
            *least = least.min(turned / along);
            *most = most.max(turned / along);
        }
    }
    let mut value: Vec<f32> = range.iter().map(|(a, b)| if a.is_finite() { 0.5 * (a + b) } else { 0. }).collect();
    for _ in 0..SMOOTHINGS {
        let mut sum: Vec<(f32, f32)> = value.iter().map(|v| (*v, 1.)).collect();
        for (a, b) in &edges {
            for (to, from) in [(a, b), (b, a)] {
                sum[*to as usize].0 += value[*from as usize];
                sum[*to as usize].1 += 1.;
            }
        }
        value = sum.into_iter().map(|(s, n)| s / n).collect();
    }
    welded.iter().map(|v| value[*v as usize]).collect()
}
