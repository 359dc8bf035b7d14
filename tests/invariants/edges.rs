//! Borders, backgrounds, steps in depth, pictures of a pixel.
use crate::Outcome;
use crate::studio::{Picture, Set, plates, settings};
use glam::Vec3;
use pdss::gpu::Gpu;
use pdss::scene::{Camera, Light, LightKind};
use pdss::settings::{Method, Quality, View};
use std::sync::Arc;

const SCATTERING: [Method; 5] = [Method::Pdss, Method::Moments, Method::Gaussians, Method::Separable, Method::Burley];

fn bounded(p: &Picture) -> bool {
    p.covered().count() > 0
        && p.texels.iter().flatten().all(|x| (0. ..=1.001).contains(x))
        && p.covered().any(|i| p.texels[i][0] > 0.1)
}

pub fn sizes(gpu: &Arc<Gpu>) -> Vec<Outcome> {
    let mut all = Vec::new();
    for method in SCATTERING {
        for size in [[1, 1], [1, 37], [53, 1], [7, 5], [33, 17], [65, 66]] {
            let mut set = Set::new("shape:cylinder:40", 300., settings(method, View::Scatter, size));
            set.settings.quality = Quality::Low;
            set.lights = vec![Light::directional(30., 45., 1.)];
            let mut picture = set.linear(gpu);
            let (holds, covered) = (bounded(&picture), picture.covered().count());
            picture.texels[0][1] = f32::NAN;
            let text = format!("{method:?}, {} x {}: {covered} pixels covered, all within 0..1", size[0], size[1]);
            all.push(Outcome { text, holds, can_fail: !bounded(&picture) });
        }
    }
    all
}

/// Exitance against irradiance, the largest difference on covered pixels.
fn apart(gpu: &Arc<Gpu>, set: &Set) -> f32 {
    let view = |view| {
        let mut set = set.clone();
        set.settings.view = view;
        set.linear(gpu)
    };
    view(View::Scatter).apart(&view(View::Irradiance))
}

/// Far from any border, on a plane, whatever the view and the light. The twin: on a sphere the two are not the same.
pub fn constant(gpu: &Arc<Gpu>) -> Vec<Outcome> {
    let mut all = Vec::new();
    for method in SCATTERING {
        let set = |text: &str, pitch: f64, light: f64, quality: Quality| {
            let mut set = Set::new(text, 60., settings(method, View::Scatter, [96, 64]));
            let target = (text != "shape:plane").then_some(glam::DVec3::Y * 20.);
            set.camera = Camera::orbit(0., pitch, 60., target, 20., &set.scene);
            set.lights = vec![Light::directional(70., light, 1.)];
            set.settings.quality = quality;
            set
        };
        let round = apart(gpu, &set("shape:sphere:20", 90., 90., Quality::Low));
        for (pitch, light, quality) in [(90., 90., Quality::Ultra), (35., 90., Quality::High), (35., 40., Quality::Low)]
        {
            let flat = apart(gpu, &set("shape:plane", pitch, light, quality));
            let text = format!(
                "{method:?} {quality:?}, seen at {pitch}, lit at {light} degrees: {flat:.1e}; on a sphere {round:.1e}"
            );
            all.push(Outcome { text, holds: flat < 1e-3, can_fail: round > 1e-3 });
        }
    }
    all
}

/// A plate covers the left half of the picture; what stands behind it, another plate or nothing, must not matter to it. One
/// of the two is lit, the other is not.
pub fn leak(gpu: &Arc<Gpu>) -> Vec<Outcome> {
    let front = (Vec3::new(-40., 0., 0.), 0.);
    // Its near edge lies just out of sight behind the front plate's, from there it leads away to the right.
    let (sin, cos) = 0.8f32.sin_cos();
    let behind = |gap: f32| (Vec3::new(40. * cos - 0.4, 0., -40. * sin - gap), 0.8);
    let mut all = Vec::new();
    for method in SCATTERING {
        for quality in [Quality::Low, Quality::Ultra] {
            for (lit, direction) in [("behind", Vec3::new(1., 0., -0.2)), ("front", Vec3::new(-0.9, 0., 0.6))] {
                let draw = |list: &[(Vec3, f32)]| {
                    let mut set = Set::new("shape:plane", 200., settings(method, View::Scatter, [128, 96]));
                    set.scene = Arc::new(plates(list));
                    let camera = Camera::orbit(0., 0., 200., Some(glam::DVec3::ZERO), 20., &set.scene);
                    set.camera = camera;
                    let direction = direction.normalize();
                    set.lights =
                        vec![Light { kind: LightKind::Directional { direction }, ..Light::directional(0., 0., 1.) }];
                    set.settings.quality = quality;
                    set.settings.no_shadows = true;
                    set.linear(gpu)
                };
                let alone = draw(&[front]);
                let with = |gap: f32| {
                    let other = draw(&[front, behind(gap)]);
                    let apart =
                        |i: usize| (0..3).map(|c| (alone.texels[i][c] - other.texels[i][c]).abs()).fold(0., f32::max);
                    alone.covered().map(apart).fold(0., f32::max)
                };
                // Alone, too, it is one plate under one light: the background takes nothing from it.
                let values: Vec<f32> = alone.covered().map(|i| alone.texels[i][0]).collect();
                let (low, high) = values.iter().fold((9f32, -9f32), |m, v| (m.0.min(*v), m.1.max(*v)));
                let (far, near) = (with(60.), with(0.2));
                let text = format!(
                    "{method:?} {quality:?}, {lit} lit: {far:.1e} from 60 mm behind, {:.1e} from the background; from .2 mm behind: {near:.1e}",
                    high - low
                );
                all.push(Outcome { text, holds: far < 1e-3 && high - low < 1e-3, can_fail: near > 1e-2 });
            }
        }
    }
    all
}
