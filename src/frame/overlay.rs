//! What is drawn over the lit picture, in the order in which it covers.

use crate::scene::{Alpha, Camera, Draw, Scene};
use glam::Vec3;

/// Draws over the picture: what adds or replaces, in any order, then the blended triangles of all materials, back to front.
#[derive(Clone, Debug, Default)]
pub struct Overlay {
    /// The blended triangles, to stand behind the scene's own indices.
    pub indices: Vec<u32>,
    /// Runs of the scene's indices and of those.
    pub draws: Vec<Draw>,
}

impl Overlay {
    /// The scene's, as this eye orders it. Triangles are sorted by the depth of their middles; those that cut through one
    /// another are not cut.
    pub fn new(scene: &Scene, camera: &Camera) -> Overlay {
        let blended = |d: &Draw| scene.materials.get(d.material).is_some_and(|m| m.alpha == Alpha::Blend);
        let over = |d: &&Draw| scene.materials.get(d.material).is_some_and(|m| m.is_overlaid()) && d.index_count > 0;
        let mut draws: Vec<Draw> = scene.draws.iter().filter(over).filter(|d| !blended(d)).copied().collect();
        let corner = |i: u32| scene.positions.get(i as usize).map_or(Vec3::ZERO, |p| Vec3::from(*p));
        let mut triangles: Vec<(f32, usize, [u32; 3])> = Vec::new();
        for draw in scene.draws.iter().filter(over).filter(|d| blended(d)) {
            let run = scene.indices.iter().skip(draw.first_index as usize).take(draw.index_count as usize);
            let run: Vec<u32> = run.copied().collect();
            triangles.extend(run.chunks_exact(3).map(|t| {
                let middle = (corner(t[0]) + corner(t[1]) + corner(t[2])) / 3.;
                ((middle - camera.eye).dot(camera.forward), draw.material, [t[0], t[1], t[2]])
            }));
        }
        // Stable, so that triangles in one plane keep the order of the file.
        triangles.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut indices = Vec::with_capacity(3 * triangles.len());
        for (_, material, triangle) in triangles {
            let first_index = (scene.indices.len() + indices.len()) as u32;
            match draws.last_mut() {
                Some(last) if last.material == material && last.first_index + last.index_count == first_index => {
                    last.index_count += 3;
                }
                _ => draws.push(Draw { material, first_index, index_count: 3 }),
            }
            indices.extend(triangle);
        }
        Overlay { indices, draws }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Material;

    #[test]
    fn blends_are_drawn_from_the_back() {
        let mut scene = Scene::shape("shape:sphere:10").expect("a shape");
        scene.materials[0].alpha = Alpha::Blend;
        scene.materials.push(Material { alpha: Alpha::Blend, ..Material::new("other") });
        let half = scene.indices.len() as u32 / 6 * 3;
        scene.draws = vec![
            Draw { material: 0, first_index: 0, index_count: half },
            Draw { material: 1, first_index: half, index_count: scene.indices.len() as u32 - half },
        ];
        for yaw in [0., 130.] {
            let camera = Camera::orbit(yaw, 20., 50., None, 30., &scene);
            let overlay = Overlay::new(&scene, &camera);
            assert_eq!(overlay.indices.len(), scene.indices.len());
            let depth = |t: &[u32]| {
                let sum: Vec3 = t.iter().map(|i| Vec3::from(scene.positions[*i as usize])).sum();
                (sum / 3. - camera.eye).dot(camera.forward)
            };
            let depths: Vec<f32> = overlay.indices.chunks(3).map(depth).collect();
            assert!(depths.windows(2).all(|d| d[0] >= d[1]));
            assert!(!scene.indices.chunks(3).map(depth).is_sorted_by(|a, b| a >= b), "unsorted would pass");
            let covered: u32 = overlay.draws.iter().map(|d| d.index_count).sum();
            assert_eq!(covered as usize, overlay.indices.len());
        }
    }
}
