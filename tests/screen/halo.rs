//! What stands next to skin or behind it: a neighbour that does not scatter gives nothing, and the band that what lies behind leaves is
//! measured.
use crate::studio::{Picture, Set, plates, settings};
use glam::Vec3;
use pdss::gpu::Gpu;
use pdss::scene::{Camera, Light, LightKind};
use pdss::settings::{Method, Quality, View};
use pdss::skin::profile::Profile;
use std::sync::Arc;

const METHODS: [Method; 5] = [Method::Pdss, Method::Moments, Method::Gaussians, Method::Separable, Method::Burley];

/// These never look at another pixel: nothing can cross.
const LONELY: [Method; 2] = [Method::Preintegrated, Method::Wrap];

/// A plate covers the left half, dimly lit; to its right, `gap` mm behind, a bright one leads away; or there is none.
fn draw(gpu: &Arc<Gpu>, method: Method, gap: Option<f32>, scatters: bool) -> Picture {
    let front = (Vec3::new(-40., 0., 0.), 0.);
    let (sin, cos) = 0.8f32.sin_cos();
    let behind = gap.map(|gap| (Vec3::new(40. * cos, 0., -40. * sin - gap), 0.8));
    let mut set = Set::new("shape:plane", 200., settings(method, View::Scatter, [128, 96]));
    let mut scene = plates(&std::iter::once(front).chain(behind).collect::<Vec<_>>());
    if !scatters && behind.is_some() {
        let (mut draw, mut material) = (scene.draws[0], scene.materials[0].clone());
        material.scatter = None;
        scene.materials.push(material);
        scene.draws[0].index_count /= 2;
        draw.first_index += scene.draws[0].index_count;
        (draw.index_count, draw.material) = (scene.draws[0].index_count, scene.materials.len() - 1);
        scene.draws.push(draw);
    }
    set.scene = Arc::new(scene);
    set.camera = Camera::orbit(0., 0., 200., Some(glam::DVec3::ZERO), 10., &set.scene);
    let direction = Vec3::new(1., 0., 0.15).normalize();
    set.lights = vec![Light { kind: LightKind::Directional { direction }, ..Light::directional(0., 0., 1.) }];
    set.profile = Some(Profile::resolve("skin").expect("built in"));
    (set.settings.quality, set.settings.no_shadows) = (Quality::High, true);
    set.linear(gpu)
}

pub fn check(gpu: &Arc<Gpu>) -> Vec<String> {
    let mut wrong = Vec::new();
    for method in METHODS.into_iter().chain(LONELY) {
        let alone = draw(gpu, method, None, true);
        // Means of red over the 3 mm of the plate that are nearest to its edge, 64 of 96 lines.
        let apart = |other: &Picture| {
            let pixels = (16..80).flat_map(|y| (56..63).map(move |x| (x, y)));
            let sum: f32 = pixels.map(|(x, y)| (alone.at(x, y)[0] - other.at(x, y)[0]).abs()).sum();
            sum / (64. * 7.)
        };
        let still = apart(&draw(gpu, method, Some(0.), false));
        let gaps = [0., 2., 5., 10., 20.].map(|gap| apart(&draw(gpu, method, Some(gap), true)));
        println!(
            "{method:?}: band of {gaps:.4?} from 0, 2, 5, 10, 20 mm behind; from a neighbour that does not scatter {still:.1e}"
        );
        // A neighbour moves the box that the levels are chosen by, so that the two normal blurs may round otherwise.
        if still > 1e-6 || gaps[4] > 1e-3 || gaps.windows(2).any(|g| g[1] > g[0]) {
            wrong.push(format!("{method:?}: {gaps:?}, {still}"));
        }
        if LONELY.contains(&method) && gaps.iter().any(|g| *g > 1e-4) {
            wrong.push(format!("{method:?}: {gaps:?} where no pixel is looked at but its own"));
        }
        if gaps[0] < 1e-2 && !LONELY.contains(&method) {
            wrong.push(format!("{method:?}: nothing crosses where it should"));
        }
    }
    wrong
}
