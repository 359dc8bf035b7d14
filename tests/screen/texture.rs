//! Colour before and after scattering: where colour does not change it makes no difference when it acts, across a seam it does.
use crate::studio::{Picture, Set, plates, settings};
use glam::Vec3;
use pdss::gpu::Gpu;
use pdss::scene::{Camera, Light};
use pdss::settings::{Method, Quality, Texturing, View};
use std::sync::Arc;

const METHODS: [Method; 3] = [Method::Gaussians, Method::Separable, Method::Burley];

/// Two plates side by side that scatter alike, one nearly black.
fn draw(gpu: &Arc<Gpu>, method: Method, texturing: Texturing) -> Picture {
    let mut set = Set::new("shape:plane", 200., settings(method, View::Final, [128, 64]));
    let mut scene = plates(&[(Vec3::new(-40., 0., 0.), 0.), (Vec3::new(40., 0., 0.), 0.)]);
    let (mut draw, mut dark) = (scene.draws[0], scene.materials[0].clone());
    dark.base_color = [0.04, 0.04, 0.04, 1.];
    scene.materials.push(dark);
    scene.draws[0].index_count /= 2;
    draw.first_index += scene.draws[0].index_count;
    (draw.index_count, draw.material) = (scene.draws[0].index_count, scene.materials.len() - 1);
    scene.draws.push(draw);
    set.scene = Arc::new(scene);
    set.camera = Camera::orbit(0., 0., 200., Some(glam::DVec3::ZERO), 15., &set.scene);
    set.lights = vec![Light::directional(20., 20., 1.)];
    (set.settings.quality, set.settings.texturing, set.settings.no_shadows) = (Quality::High, texturing, true);
    set.linear(gpu)
}

pub fn check(gpu: &Arc<Gpu>) -> Vec<String> {
    let mut wrong = Vec::new();
    for method in METHODS {
        let (post, both) = (draw(gpu, method, Texturing::Post), draw(gpu, method, Texturing::PrePost));
        let apart = |columns: std::ops::Range<usize>| {
            let at = |x: usize| (0..3).map(|c| (post.at(x, 32)[c] - both.at(x, 32)[c]).abs()).fold(0., f32::max);
            columns.map(at).fold(0., f32::max)
        };
        let (left, seam, right) = (apart(0..8), apart(60..68), apart(120..128));
        println!(
            "{method:?}: pre and post against post, away from the seam {left:.1e} and {right:.1e}, at it {seam:.1e}"
        );
        if left.max(right) > 1e-3 || seam < 1e-2 {
            wrong.push(format!("{method:?}: {left} {seam} {right}"));
        }
    }
    wrong
}
