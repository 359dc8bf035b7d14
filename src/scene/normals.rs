//! Smooth vertex normals from triangles: at each *position* (not vertex: seams in the UVs are no edges) the triangles'
//! unit normals, each weighted by its angle there, which does not depend on how a surface is cut into triangles.
//!
//! glTF asks for flat normals where a file has none. Smooth ones are made all the same: a facetted scan has no
//! curvature to light.

use std::collections::HashMap;

use glam::DVec3;

use super::bake::BakedPrimitive;

/// A unit normal for each vertex of each primitive; primitives that meet share their normals there. A vertex where the
/// triangles cancel takes the normal of one of them; one without triangles takes +Y.
pub(super) fn smooth_normals(primitives: &[BakedPrimitive]) -> Vec<Vec<[f32; 3]>> {
    let vertices = primitives.iter().map(|p| p.positions.len()).sum();
    let mut places = HashMap::with_capacity(vertices);
    let mut welded: Vec<Vec<u32>> = Vec::with_capacity(primitives.len());
    for primitive in primitives {
        let weld = |p: &DVec3| {
            let next = places.len() as u32;
            // Adding zero makes -0 equal to 0.
            let key = (*p + DVec3::ZERO).to_array().map(f64::to_bits);
            *places.entry(key).or_insert(next)
        };
        welded.push(primitive.positions.iter().map(weld).collect());
    }
    let mut sums = vec![(DVec3::ZERO, DVec3::Y); places.len()];
    for (primitive, welded) in primitives.iter().zip(&welded) {
        for triangle in &primitive.triangles {
            let corners = triangle.map(|i| primitive.positions[i as usize]);
            for (normal, weight, i) in weights(corners, triangle) {
                let (sum, any) = &mut sums[welded[i as usize] as usize];
                *sum += normal * weight;
                *any = normal;
            }
        }
    }
    let unit = |&(sum, any): &(DVec3, DVec3)| {
        // A sum this small beside angles of a radian is rounding.
        let usable = sum.length() > 1e-6;
        let normal = if usable { sum.normalize_or(any) } else { any };
        normal.as_vec3().to_array()
    };
    welded.iter().map(|welded| welded.iter().map(|&w| unit(&sums[w as usize])).collect()).collect()
}

/// Unit normal, angle and index of each corner.
fn weights(p: [DVec3; 3], triangle: &[u32; 3]) -> [(DVec3, f64, u32); 3] {
    let normal = (p[1] - p[0]).cross(p[2] - p[0]).normalize_or_zero();
    [0, 1, 2].map(|k| {
        let (to_next, to_last) = (p[(k + 1) % 3] - p[k], p[(k + 2) % 3] - p[k]);
        (normal, to_next.angle_between(to_last), triangle[k])
    })
}
