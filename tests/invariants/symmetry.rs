//! Moving, turning, mirroring and scaling everything at once changes nothing.
use crate::Outcome;
use crate::studio::{Picture, Set, settings};
use glam::{DMat3, DVec3, Vec3};
use pdss::gpu::Gpu;
use pdss::scene::{Aabb, Camera, Light, LightKind};
use pdss::settings::{Curvature, Method, View};
use std::sync::Arc;

const SIZE: [u32; 2] = [160, 120];

/// Median, 99th percentile and largest of the differences over pixels that both cover; and how many only one covers.
fn compare(a: &Picture, b: &Picture, scale: f32) -> ([f32; 3], usize) {
    let mut d = Vec::new();
    let mut lone = 0;
    for (p, q) in a.texels.iter().zip(&b.texels) {
        match (p[3] > 0., q[3] > 0.) {
            (true, true) => d.push((0..3).map(|c| (p[c] - q[c]).abs()).fold(0., f32::max) * scale),
            (false, false) => {}
            _ => lone += 1,
        }
    }
    d.sort_by(f32::total_cmp);
    let at = |q: f64| d.get(((d.len() as f64 * q) as usize).min(d.len().saturating_sub(1))).copied().unwrap_or(9.);
    ([at(0.5), at(0.99), at(1.)], lone)
}

fn flipped(p: &Picture) -> Picture {
    let [w, h] = p.size;
    let texels = (0..w * h).map(|i| p.at(w - 1 - i % w, i / w)).collect();
    Picture { size: p.size, texels }
}

/// A torus is its own mirror image. Its triangles are not, nor are the texels of a shadow map or which of two pixels an edge
/// falls to, so this holds to a tolerance. Nor is the spiral by which `moments` samples the light's view: that has a bound of
/// its own.
pub fn mirror(gpu: &Arc<Gpu>) -> Vec<Outcome> {
    [
        (Method::Lambert, true, 2e-4),
        (Method::Pdss, true, 2e-4),
        (Method::Moments, true, 2e-4),
        (Method::Moments, false, 1e-3),
    ]
        .map(|(method, on_screen, most)| {
            let picture = |yaw: f64| {
                let mut set = Set::new("shape:torus:70,25", 420., settings(method, View::Scatter, SIZE));
                set.camera = Camera::orbit(0., 40., 420., None, 30., &set.scene);
                set.lights = vec![Light::directional(yaw, 35., 1.)];
                set.settings.no_translucent = on_screen;
                set.linear(gpu)
            };
            let (left, right) = (picture(-50.), picture(50.));
            let ([median, p99, max], lone) = compare(&left, &flipped(&right), 1.);
            let ([.., off, _], _) = compare(&left, &right, 1.);
            let text = format!(
                "{method:?}, on the screen alone {on_screen}: median {median:.1e}, p99 {p99:.1e}, max {max:.1e}, {lone} at the rim; not flipped: p99 {off:.1e}"
            );
            Outcome { text, holds: median < most && p99 < 1e-2 && lone < 20, can_fail: off > 0.1 }
        })
        .into()
}

/// The scene, its camera, its lights and its profile `factor` times as large.
fn scaled(set: &Set, factor: f64, with_profile: bool) -> Set {
    let mut set = set.clone();
    let f = factor as f32;
    let mut scene = (*set.scene).clone();
    scene.positions.iter_mut().flatten().for_each(|x| *x *= f);
    scene.bounds = Aabb::around(&scene.positions);
    set.scene = Arc::new(scene);
    set.camera.eye *= f;
    set.camera.near_mm *= f;
    if with_profile {
        set.profile = set.profile.map(|p| p.scaled(factor));
    }
    set
}

/// f32 rounds differently at another power of two: a pixel of the rim may fall to the other side, a 16-bit code by a step.
pub fn scale(gpu: &Arc<Gpu>) -> Vec<Outcome> {
    let mut all = Vec::new();
    for method in [Method::Pdss, Method::Moments] {
        let set = Set::new("shape:torus:70,25", 420., settings(method, View::Scatter, SIZE));
        let base = set.linear(gpu);
        for factor in [1e-3, 1e3] {
            let ([median, p99, max], lone) = compare(&base, &scaled(&set, factor, true).linear(gpu), 1.);
            let ([.., off, _], _) = compare(&base, &scaled(&set, factor, false).linear(gpu), 1.);
            let text = format!(
                "{method:?} x {factor}: median {median:.1e}, p99 {p99:.1e}, max {max:.1e}, {lone} at the rim; profile left as it is: p99 {off:.1e}"
            );
            all.push(Outcome { text, holds: median < 1e-5 && p99 < 1e-3 && lone < 5, can_fail: off > 0.02 });
        }
    }
    all
}

/// View space is the same, so H is, but for what world space rounds otherwise.
pub fn rotation(gpu: &Arc<Gpu>) -> Vec<Outcome> {
    let turn = DMat3::from_axis_angle(DVec3::new(1., 2., -0.5).normalize(), 1.1);
    let turned = |v: Vec3| (turn * v.as_dvec3()).as_vec3();
    let mut set = Set::new("shape:ellipsoid:80,60,45", 380., settings(Method::Pdss, View::Curvature, SIZE));
    set.settings.curvature = Curvature::Fit;
    let mut other = set.clone();
    let mut scene = (*set.scene).clone();
    for v in scene.positions.iter_mut().chain(&mut scene.normals) {
        *v = turned(Vec3::from(*v)).to_array();
    }
    scene.bounds = Aabb::around(&scene.positions);
    other.scene = Arc::new(scene);
    let eye = set.camera.eye;
    let mut same_lights = other.clone();
    let camera = &mut other.camera;
    (camera.eye, camera.right, camera.up, camera.forward) =
        (turned(eye), turned(camera.right), turned(camera.up), turned(camera.forward));
    for light in &mut other.lights {
        if let LightKind::Directional { direction } = &mut light.kind {
            *direction = turned(*direction);
        }
    }
    same_lights.camera = other.camera.clone();
    let radius = 45. * 45. / 80.;
    let h = |set: &Set| {
        let mut p = set.linear(gpu);
        p.texels.iter_mut().for_each(|t| *t = [t[0], 0., 0., t[3]]);
        p
    };
    let ([median, p99, max], lone) = compare(&h(&set), &h(&other), radius);
    let mut still = set.clone();
    still.scene = other.scene.clone();
    let ([.., off, _], _) = compare(&h(&set), &h(&still), radius);
    let text = format!(
        "r|dH|: median {median:.1e}, p99 {p99:.1e}, max {max:.1e}, {lone} at the rim; the camera left behind: p99 {off:.1e}"
    );
    let curvature = Outcome { text, holds: median < 1e-6 && p99 < 2e-3 && lone < 5, can_fail: off > 0.05 };
    let lit = |set: &Set| {
        let mut set = set.clone();
        set.settings.view = View::Scatter;
        set.settings.no_shadows = true;
        set.linear(gpu)
    };
    let ([median, p99, max], lone) = compare(&lit(&set), &lit(&other), 1.);
    let ([.., off, _], _) = compare(&lit(&set), &lit(&same_lights), 1.);
    let text = format!(
        "exitance: median {median:.1e}, p99 {p99:.1e}, max {max:.1e}, {lone} at the rim; the light left behind: p99 {off:.1e}"
    );
    let light = Outcome { text, holds: median < 1e-5 && p99 < 1e-3 && lone < 5, can_fail: off > 0.05 };
    vec![curvature, light]
}
