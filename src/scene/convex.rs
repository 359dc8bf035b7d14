//! Whether a surface is concave anywhere, as shading sees it: by its mean curvature.

use super::Scene;
use glam::Vec3;

/// Mean curvature times the scene's size that is still flat: rounding of its numbers, and nothing that occludes.
const FLAT: f32 = 1e-4;

/// No triangle has a negative mean curvature, by the positions and normals that are interpolated over it: nothing that curvature
/// tells of occludes it.
pub fn is_convex(scene: &Scene) -> bool {
    let size = scene.bounds.size().length().max(f32::MIN_POSITIVE);
    scene.indices.chunks_exact(3).all(|t| {
        let [p, q, r] = [0, 1, 2].map(|k| Vec3::from(scene.positions[t[k] as usize]));
        let [l, m, n] = [0, 1, 2].map(|k| Vec3::from(scene.normals[t[k] as usize]));
        let (pu, pv, nu, nv) = (q - p, r - p, m - l, n - l);
        let (e, f, g) = (pu.dot(pu), pu.dot(pv), pv.dot(pv));
        // The two fundamental forms: 2 H times the square of twice the triangle's area.
        let twice = g * nu.dot(pu) + e * nv.dot(pv) - f * (nu.dot(pv) + nv.dot(pu));
        twice * size >= -2. * FLAT * (e * g - f * f)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bowls_are_told_from_balls() {
        let convex = |text: &str| is_convex(&Scene::shape(text).expect("a shape"));
        // The inside of a thin ring turns more across than along.
        for shape in ["torus:70,25", "plane", "sphere:40", "cylinder:40", "ellipsoid:40,20,10", "cube:30"] {
            assert!(convex(&format!("shape:{shape}")), "{shape}");
        }
        for shape in ["torus:40,30", "saddle:40"] {
            assert!(!convex(&format!("shape:{shape}")), "{shape}");
        }
        // Inside out.
        let mut bowl = Scene::shape("shape:sphere:40").expect("a shape");
        bowl.normals.iter_mut().flatten().for_each(|x| *x = -*x);
        assert!(!is_convex(&bowl));
    }
}
