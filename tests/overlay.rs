//! What is drawn over the lit picture, and colours of vertices, pixel by pixel: blends by the over operator in their order from
//! the eye, emission added, unlit colours as they are; and not a step of it where nothing asks for it.
mod studio;

use glam::Vec3;
use pdss::frame::{Output, Renderer};
use pdss::gpu::Gpu;
use pdss::scene::{Aabb, Alpha, Camera, Draw, Light, Material, Scene};
use pdss::settings::{Method, Settings, Size, ToneMap, View};
use std::sync::Arc;
use studio::Set;

const BLUE: [f32; 3] = [0.1, 0.2, 0.8];
const GREEN: [f32; 3] = [0.2, 0.7, 0.1];
const RED: [f32; 3] = [0.9, 0.1, 0.2];

fn paint(color: [f32; 3], alpha: f32) -> Material {
    let mut material = Material::new("paint");
    material.base_color = [color[0], color[1], color[2], alpha];
    material.alpha = if alpha < 1. { Alpha::Blend } else { Alpha::Opaque };
    material.double_sided = true;
    material.roughness = 1.;
    material
}

fn unlit(color: [f32; 3], alpha: f32) -> Material {
    Material { unlit: true, ..paint(color, alpha) }
}

/// Plates that face +Z, each of its own material, `z` mm in front of one another.
fn stack(plates: &[(f32, Material)]) -> Scene {
    let places: Vec<(Vec3, f32)> = plates.iter().map(|(z, _)| (Vec3::new(0., 0., *z), 0.)).collect();
    let mut scene = studio::plates(&places);
    let each = (scene.indices.len() / plates.len()) as u32;
    let draw = |i: usize| Draw { material: i, first_index: i as u32 * each, index_count: each };
    scene.draws = (0..plates.len()).map(draw).collect();
    scene.materials = plates.iter().map(|(_, m)| m.clone()).collect();
    scene.bounds = Aabb::around(&scene.positions);
    scene
}

fn set(scene: Scene, yaw: f64, lights: Vec<Light>, method: Method, output: Output) -> Set {
    let size = Size { width: 32, height: 32 };
    let settings = Settings { method, size, tone_map: ToneMap::Linear, ..Settings::default() };
    let camera = Camera::orbit(yaw, 0., 300., Some(glam::DVec3::ZERO), 10., &scene);
    Set { scene: Arc::new(scene), camera, lights, profile: Some(studio::wax()), settings, output }
}

/// The pixel in the middle, linear, premultiplied.
fn middle(gpu: &Arc<Gpu>, set: &Set) -> [f32; 4] {
    let mut renderer = Renderer::new(gpu, set.inputs()).unwrap();
    renderer.run().unwrap();
    renderer.linear().unwrap()[16 * 32 + 16]
}

#[track_caller]
fn near(found: [f32; 4], expected: [f32; 4], slack: f32) {
    let off = found.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0f32, f32::max);
    assert!(off <= slack, "{found:?} where {expected:?} should be");
}

fn over(top: ([f32; 3], f32), below: [f32; 4]) -> [f32; 4] {
    let (color, a) = top;
    [color[0], color[1], color[2], 1.]
        .into_iter()
        .zip(below)
        .map(|(c, b)| a * c + (1. - a) * b)
        .collect::<Vec<_>>()
        .try_into()
        .unwrap()
}

#[test]
fn what_is_drawn_over_the_picture_is_what_the_formulas_say() {
    let gpu = studio::open();
    let ambientless = |set: Set| {
        let mut set = set;
        set.settings.ambient.up = [0.; 3];
        set.settings.ambient.down = [0.; 3];
        set
    };
    let dark = |scene, yaw, method| ambientless(set(scene, yaw, Vec::new(), method, Output::Linear));
    let solid = |c: [f32; 3]| [c[0], c[1], c[2], 1.];
    for method in [Method::Lambert, Method::Pdss, Method::Preintegrated] {
        // Blended over what lies behind, hidden by what lies before.
        let plates = stack(&[(20., unlit(RED, 0.25)), (0., unlit(BLUE, 1.)), (10., unlit(GREEN, 0.5))]);
        let expected = over((RED, 0.25), over((GREEN, 0.5), solid(BLUE)));
        near(middle(&gpu, &dark(plates.clone(), 0., method)), expected, 1e-5);
        near(middle(&gpu, &dark(plates, 180., method)), solid(BLUE), 1e-5);
        // The nearest covers last, whatever the order in the file.
        let glass = stack(&[(20., unlit(RED, 0.25)), (10., unlit(GREEN, 0.5))]);
        let front = over((RED, 0.25), over((GREEN, 0.5), [0.; 4]));
        let back = over((GREEN, 0.5), over((RED, 0.25), [0.; 4]));
        near(middle(&gpu, &dark(glass.clone(), 0., method)), front, 1e-5);
        near(middle(&gpu, &dark(glass, 180., method)), back, 1e-5);
        assert!((front[0] - back[0]).abs() > 0.05, "any order would pass");
        // Light that a surface gives off, over light that it does not.
        let glow = Material { emission: [3., 0.5, 0.25], ..paint(BLUE, 1.) };
        near(middle(&gpu, &dark(stack(&[(0., glow)]), 0., method)), [3., 0.5, 0.25, 1.], 1e-5);
    }

    // A blend is lit as the same surface is where it covers all: half of it is half as bright.
    let light = || vec![Light::directional(30., 20., 2.)];
    let lit =
        |alpha| ambientless(set(stack(&[(0., paint(GREEN, alpha))]), 0., light(), Method::Lambert, Output::Linear));
    let (whole, half) = (middle(&gpu, &lit(1.)), middle(&gpu, &lit(0.5)));
    near(half, whole.map(|x| 0.5 * x), 0.006);
    assert!(whole[1] > 0.2);

    // A pane casts no shadow; a board does.
    let behind = |front: Material| {
        let light = vec![Light::directional(0., 0., 2.)];
        let scene = stack(&[(0., paint(GREEN, 1.)), (15., front)]);
        let camera = Camera::orbit(50., 0., 300., Some(glam::DVec3::ZERO), 10., &scene);
        Set { camera, ..ambientless(set(scene, 0., light, Method::Lambert, Output::Linear)) }
    };
    let pane = middle(&gpu, &behind(paint(RED, 0.)));
    let board = middle(&gpu, &behind(paint(RED, 1.)));
    near(
        pane,
        middle(&gpu, &{
            let mut alone = behind(paint(RED, 0.));
            let mut scene = (*alone.scene).clone();
            scene.draws.truncate(1);
            scene.indices.truncate(scene.draws[0].index_count as usize);
            alone.scene = Arc::new(scene);
            alone
        }),
        1e-5,
    );
    assert!(board[1] < 0.5 * pane[1], "{board:?} {pane:?}");

    // 8 bits: coverage is taken out, and what is left encoded.
    let glass = ambientless(set(stack(&[(0., unlit(GREEN, 0.5))]), 0., Vec::new(), Method::Pdss, Output::Ldr));
    let mut renderer = Renderer::new(&gpu, glass.inputs()).unwrap();
    renderer.run().unwrap();
    let pixel: [u8; 4] = renderer.ldr().unwrap()[4 * (16 * 32 + 16)..][..4].try_into().unwrap();
    let srgb = |x: f32| ((1.055 * x.powf(1. / 2.4) - 0.055) * 255.).round() as u8;
    for (found, expected) in pixel.into_iter().zip([srgb(GREEN[0]), srgb(GREEN[1]), srgb(GREEN[2]), 128]) {
        assert!(found.abs_diff(expected) <= 1, "{pixel:?}");
    }
    drop(renderer);

    // Colours of vertices: albedo is their product with the factor.
    for method in [Method::Lambert, Method::Moments, Method::Preintegrated] {
        let mut scene = stack(&[(0., paint([0.5, 1., 0.25], 1.))]);
        scene.colors = vec![[0.5, 0.25, 1., 1.]; scene.positions.len()];
        let mut tinted = dark(scene, 0., method);
        tinted.settings.view = View::Albedo;
        near(middle(&gpu, &tinted), [0.25, 0.25, 0.25, 1.], 0.01);
    }
    studio::close(gpu);
}

#[test]
fn a_scene_without_any_has_no_step_for_it() {
    let plan = |material: Material| {
        let set = set(stack(&[(0., material)]), 0., vec![Light::directional(0., 0., 1.)], Method::Pdss, Output::Ldr);
        Renderer::plan_only(&set.inputs()).unwrap()
    };
    let names = |plan: &pdss::plan::Plan| plan.passes.iter().map(|p| p.name.clone()).collect::<Vec<_>>();
    let plain = plan(paint(GREEN, 1.));
    assert!(!names(&plain).iter().any(|n| n == "overlay" || n == "tonemap") && !plain.has("exr"));
    assert!(plain.left_out.iter().any(|l| l.what == "overlay"));
    assert!(plain.left_out.iter().any(|l| l.what == "vertex colours"));
    let glass = plan(paint(GREEN, 0.5));
    assert_eq!(names(&glass)[names(&glass).len() - 2..], ["overlay", "tonemap"]);
}
