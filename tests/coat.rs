//! What lies over a surface, on the device: a clear coat, sheen, specular with a weight and a colour. Held to the f64 twin and to
//! what white must stay; and what nobody has costs nothing.
mod studio;

use glam::Vec3;
use pdss::frame::Renderer;
use pdss::scene::{Alpha, Coat, Environment, Light, LightKind, Material, Scene, Sheen, Specular};
use pdss::settings::{Ambient, Method, Quality, View};
use pdss::skin::specular::Layers;
use std::sync::Arc;
use studio::{Picture, Set, settings};

/// A frame through `light`, one that is forward, one through `irradiance` and `combine`, and one with a blur.
const METHODS: [Method; 4] = [Method::Lambert, Method::Preintegrated, Method::Gaussians, Method::Moments];

fn change(set: &mut Set, how: impl FnOnce(&mut Scene)) {
    let mut scene = (*set.scene).clone();
    how(&mut scene);
    set.scene = Arc::new(scene);
}

/// A sphere of 12 mm of this color and roughness under a white sky.
fn ball(method: Method, color: f32, how: impl FnOnce(&mut Material)) -> Set {
    let mut set = Set::new("shape:sphere:12", 90., settings(method, View::Final, [64, 64]));
    set.scene = studio::thinned(&set.scene);
    set.settings.quality = Quality::High;
    set.settings.no_shadows = true;
    set.settings.no_ao = true;
    set.settings.ambient = Ambient { up: [0.; 3], down: [0.; 3] };
    set.lights.clear();
    change(&mut set, |scene| {
        scene.environment = Environment::new("white", 256, vec![[1.; 3]; 256 * 128]).ok().map(Arc::new);
        let m = &mut scene.materials[0];
        (m.base_color, m.roughness) = ([color, color, color, 1.], 0.6);
        how(m);
    });
    set
}

fn coated(m: &mut Material) {
    m.coat = Coat { factor: 0.8, roughness: 0.7, ..Coat::default() };
    m.sheen = Sheen { color: [0.6; 3], roughness: 0.7, ..Sheen::default() };
}

fn values(p: &Picture) -> impl Iterator<Item = f32> {
    p.covered().flat_map(|i| p.texels[i][..3].to_vec())
}

#[test]
fn white_stays_white_under_coat_sheen_and_tint() {
    let gpu = studio::open();
    for method in METHODS {
        let white = ball(method, 1., |m| {
            coated(m);
            m.specular = Specular { factor: 0.4, color: [0.2, 1., 3.], ..m.specular };
        });
        let off = values(&white.linear(&gpu)).map(|x| (x - 1.).abs()).fold(0., f32::max);
        // Red sheen swallows green and blue, and adds nothing.
        let red = ball(method, 1., |m| m.sheen = Sheen { color: [0.9, 0., 0.], roughness: 0.4, ..Sheen::default() });
        let picture = red.linear(&gpu);
        let most = values(&picture).fold(0., f32::max);
        let least = values(&picture).fold(1., f32::min);
        // A wrong twin: a coat that takes nothing from below shines brighter than its sky.
        let bare = ball(method, 1., |_| {}).linear(&gpu);
        let black = ball(method, 0., |m| {
            coated(m);
            m.specular.factor = 0.;
        });
        let added = values(&bare).zip(values(&black.linear(&gpu))).map(|(a, b)| a + b).fold(0., f32::max);
        println!("{method:?}: |L - 1| {off:.1e}; red sheen {least:.2} .. {most:.4}; laid on without taking {added:.2}");
        assert!(off < 2e-3 && most < 1.002 && least < 0.9 && added > 1.1, "{method:?}");
    }
    studio::close(gpu);
}

#[test]
fn a_black_body_shows_what_the_twin_says_under_a_sky_and_under_lights() {
    let gpu = studio::open();
    let twin = Layers { coat: 0.8, coat_roughness: 0.7, sheen: [0.6; 3], sheen_roughness: 0.7 };
    for method in METHODS {
        let mut set = ball(method, 0., |m| {
            coated(m);
            m.specular.factor = 0.;
        });
        let by_sky = set.linear(&gpu);
        change(&mut set, |scene| scene.environment = None);
        set.lights = (0..128)
            .map(|i| {
                let y = 1. - (2. * i as f32 + 1.) / 128.;
                let (sin, cos) = (2.399_963_2 * i as f32).sin_cos();
                let direction = Vec3::new((1. - y * y).sqrt() * cos, y, (1. - y * y).sqrt() * sin);
                let kind = LightKind::Directional { direction };
                Light { kind, color: [4. * std::f32::consts::PI / 128.; 3], intensity: 1., range_mm: None }
            })
            .collect();
        let by_lights = set.linear(&gpu);
        let look = |view| {
            let mut set = set.clone();
            set.settings.view = view;
            set.linear(&gpu)
        };
        let (normal, position) = (look(View::Normal), look(View::Position));
        let (mut sky, mut lights, mut wrong) = (0f64, 0f64, 0f64);
        for i in by_sky.covered() {
            let [n, p] = [&normal, &position].map(|x| Vec3::from_slice(&x.texels[i]));
            let nv = f64::from(n.dot((set.camera.eye - p).normalize()));
            if nv < 0.15 {
                continue;
            }
            let want = twin.shares(nv).0[0];
            sky = sky.max((f64::from(by_sky.texels[i][0]) - want).abs());
            lights = lights.max((f64::from(by_lights.texels[i][0]) - want).abs());
            let smooth = Layers { sheen_roughness: 0.4, ..twin };
            wrong = wrong.max((smooth.shares(nv).0[0] - want).abs());
        }
        println!(
            "{method:?}: off by {sky:.4} under a sky, {lights:.4} under 128 lights; sheen of roughness .4: {wrong:.3}"
        );
        assert!(sky < 8e-3 && lights < 0.015 && wrong > 0.04, "{method:?}");
    }
    studio::close(gpu);
}

#[test]
fn what_nobody_has_costs_nothing_and_changes_nothing() {
    let gpu = studio::open();
    for method in METHODS {
        let mut both = ball(method, 0.7, |_| {});
        both.lights = vec![Light::directional(-40., 35., 1.)];
        let plain = both.clone();
        // The lower half of the triangles is another material, which is coated in one of the two scenes.
        change(&mut both, |scene| {
            let half = scene.indices.len() as u32 / 6 * 3;
            scene.materials.push(scene.materials[0].clone());
            scene.draws[0].index_count = half;
            scene.draws.push(pdss::scene::Draw {
                material: 1,
                first_index: half,
                index_count: scene.indices.len() as u32 - half,
            });
            coated(&mut scene.materials[1]);
        });
        let without = Renderer::plan_only(&plain.inputs()).expect("a plan");
        let with = Renderer::plan_only(&both.inputs()).expect("a plan");
        assert!(!without.has("coat"), "{method:?}");
        if method != Method::Preintegrated {
            assert!(with.has("coat"));
            let said = without.left_out.iter().find(|l| l.what == "coat").expect("said");
            assert_eq!(said.bytes, 8 * 64 * 64);
        }
        let (a, b) = (plain.linear(&gpu), both.linear(&gpu));
        // Another pipeline may round otherwise, where one shader draws all; the G-buffer's readers may not.
        let slack = if method == Method::Preintegrated { 1e-6 } else { 0. };
        let differs = |i: &usize| (0..3).any(|c| (a.texels[*i][c] - b.texels[*i][c]).abs() > slack);
        let other = a.covered().filter(differs).count();
        println!("{method:?}: {other} of {} pixels are the coated half's", a.covered().count());
        assert!(other > 100 && 3 * other < 2 * a.covered().count(), "{method:?}: plain pixels changed");
        // Blended, it is lit as opaque.
        if method == Method::Lambert {
            change(&mut both, |scene| scene.materials.iter_mut().for_each(|m| m.alpha = Alpha::Blend));
            let c = both.linear(&gpu);
            let off = values(&b).zip(values(&c)).map(|(x, y)| (x - y).abs()).fold(0., f32::max);
            println!("blended against opaque {off:.1e}");
            assert!(off < 1e-2);
        }
    }
    studio::close(gpu);
}
