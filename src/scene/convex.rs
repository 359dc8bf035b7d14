//! Whether a surface is concave anywhere, as shading sees it: by its mean curvature.

use super::Scene;
use glam::Vec3;
use std::collections::HashMap;

/// Mean curvature times the scene's size that is still flat: rounding of its numbers, and nothing that occludes.
const FLAT: f32 = 1e-4;
/// Vertices this near one another, as a part of the scene's size, are one; so are normals that differ by less.
const SAME: f32 = 1e-5;

/// One smooth piece of surface, seen from outside, no triangle of which has a negative mean curvature by the positions and
/// normals that are interpolated over it: nothing that curvature tells of occludes it. What shows its back as well, where it is
/// turned round, must be flat. What has edges or several pieces is not taken for convex, whatever it is.
pub fn is_convex(scene: &Scene) -> bool {
    let size = scene.bounds.size().length().max(f32::MIN_POSITIVE);
    let turned = scene.draws.iter().any(|d| scene.materials.get(d.material).is_some_and(|m| m.double_sided));
    let bends_outwards = |t: &[u32]| {
        let [p, q, r] = [0, 1, 2].map(|k| Vec3::from(scene.positions[t[k] as usize]));
        let [l, m, n] = [0, 1, 2].map(|k| Vec3::from(scene.normals[t[k] as usize]));
        let (pu, pv, nu, nv) = (q - p, r - p, m - l, n - l);
        let (e, f, g) = (pu.dot(pu), pu.dot(pv), pv.dot(pv));
        // The two fundamental forms: 2 H times the square of twice the triangle's area.
        let bend = size * (g * nu.dot(pu) + e * nv.dot(pv) - f * (nu.dot(pv) + nv.dot(pu)));
        let flat = 2. * FLAT * (e * g - f * f);
        bend >= -flat && (!turned || bend <= flat)
    };
    // A concave scene shows it in its first triangles; the rest is asked of few.
    scene.indices.chunks_exact(3).all(bends_outwards) && is_smooth_and_one(scene, SAME * size)
}

/// No place has two normals, and from each triangle the others are reached over places that they share.
fn is_smooth_and_one(scene: &Scene, grid: f32) -> bool {
    let mut places: HashMap<[i64; 3], usize> = HashMap::new();
    let mut normals: Vec<Vec3> = Vec::new();
    let mut leads_to: Vec<usize> = Vec::new();
    let mut pieces = 0;
    for t in scene.indices.chunks_exact(3) {
        let mut first = None;
        for v in t.iter().map(|v| *v as usize) {
            let normal = Vec3::from(scene.normals[v]);
            let place = *places.entry(scene.positions[v].map(|x| (x / grid).round() as i64)).or_insert(normals.len());
            if place == normals.len() {
                normals.push(normal);
                leads_to.push(place);
                pieces += 1;
            } else if (normals[place] - normal).length() > SAME {
                return false;
            }
            let (a, b) = (root(&mut leads_to, *first.get_or_insert(place)), root(&mut leads_to, place));
            if a != b {
                leads_to[b] = a;
                pieces -= 1;
            }
        }
    }
    pieces <= 1
}

/// The place that stands for the piece of this one; ways there are halved on the way.
fn root(leads_to: &mut [usize], mut place: usize) -> usize {
    while leads_to[place] != place {
        leads_to[place] = leads_to[leads_to[place]];
        place = leads_to[place];
    }
    place
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shape(text: &str) -> Scene {
        Scene::shape(&format!("shape:{text}")).expect("a shape")
    }

    #[test]
    fn bowls_are_told_from_balls() {
        // The inside of a thin ring turns more across than along.
        for text in ["torus:70,25", "plane", "sphere:40", "ellipsoid:40,20,10"] {
            assert!(is_convex(&shape(text)), "{text}");
        }
        for text in ["torus:40,30", "saddle:40"] {
            assert!(!is_convex(&shape(text)), "{text}");
        }
        let mut bowl = shape("sphere:40");
        bowl.normals.iter_mut().flatten().for_each(|x| *x = -*x);
        assert!(!is_convex(&bowl), "inside out");
    }

    #[test]
    fn what_cannot_be_told_from_triangles_is_not_convex() {
        assert!(!is_convex(&shape("cube:30")), "edges");
        assert!(!is_convex(&shape("cylinder:40")), "it is open: its inside is seen, turned round");
        let mut two = shape("sphere:40");
        let count = two.positions.len() as u32;
        two.positions.extend(two.positions.clone().iter().map(|p| [p[0] + 30., p[1], p[2]]));
        two.normals.extend(two.normals.clone());
        two.indices.extend(two.indices.clone().iter().map(|i| i + count));
        assert!(!is_convex(&two), "two balls in one another");
    }
}
