//! Takes every barrier out of a plan in turn, and looks whether synchronization validation notices, in the frame or between it and
//! the next, or else the picture: the zero messages of the other tests are worth as much as this one finds.
mod studio;

use ash::vk;
use glam::Vec3;
use pdss::frame::Renderer;
use pdss::gpu::Gpu;
use pdss::gpu::suit::Screen;
use pdss::gpu::usage::Usage;
use pdss::plan::{Pass, Plan};
use pdss::scene::{Draw, Light, Material};
use pdss::settings::{Method, Quality, Settings, View};
use std::collections::BTreeMap;
use std::sync::Arc;
use studio::{Picture, Set};

/// `moments` gathers from medium quality on. Half of the scene does not scatter, and its shading normals stray from its triangles.
fn small(method: Method, screen: Screen) -> Set {
    let quality = if method == Method::Moments { Quality::Medium } else { Quality::Low };
    let settings = Settings { quality, screen: Some(screen), ..studio::settings(method, View::Final, [48, 32]) };
    let mut set = Set::new("shape:cylinder:40", 300., settings);
    set.lights.push(Light::directional(70., 10., 0.4));
    let mut scene = (*set.scene).clone();
    for (n, p) in scene.normals.iter_mut().zip(&scene.positions) {
        *n = (Vec3::from(*n) + 0.2 * Vec3::new((0.3 * p[1]).sin(), (0.2 * p[2]).sin(), 0.)).normalize().to_array();
    }
    let half = scene.indices.len() as u32 / 6 * 3;
    let rest = Draw { material: 1, first_index: half, index_count: scene.indices.len() as u32 - half };
    scene.materials.push(Material { scatter: None, ..scene.materials[0].clone() });
    scene.draws[0].index_count = half;
    scene.draws.push(rest);
    set.scene = Arc::new(scene);
    set
}

/// Messages of one frame with its plan changed.
fn messages(gpu: &Arc<Gpu>, set: &Set, edit: impl FnOnce(&mut Plan)) -> Vec<String> {
    let before = gpu.messages().len();
    let mut renderer = Renderer::edited(gpu, set.inputs(), edit).expect("a frame");
    renderer.run().expect("it runs");
    drop(renderer);
    gpu.messages().split_off(before)
}

/// What the message is about: the identifier it starts with.
fn kind(message: &str) -> String {
    let inside = message.split_once("[ ").and_then(|(_, rest)| rest.split_once(" ]"));
    inside.map_or("no identifier", |(id, _)| id).to_owned()
}

/// A second frame behind the first in the same command buffer, without the host between them.
fn twice(plan: &mut Plan) {
    let again = plan.passes.clone();
    plan.passes.extend(again);
}

/// The picture of a frame in which another value stands in an image before pass `at`.
fn instead(gpu: &Arc<Gpu>, set: &Set, image: &str, at: usize) -> Picture {
    let edit = |plan: &mut Plan| {
        plan.clear("instead", image, [7.; 4]);
        let pass = plan.passes.pop().expect("just added");
        plan.passes.insert(at, pass);
        plan.finish().expect("a plan");
    };
    let mut renderer = Renderer::edited(gpu, set.inputs(), edit).expect("a frame");
    renderer.run().expect("it runs");
    Picture { size: set.size(), texels: renderer.linear().expect("a picture") }
}

/// An image that a pass reads and writes in place is tracked as written alone, and validation does not tell one write to a
/// storage image from the next. So the picture must: with the barrier gone the pass may find what stood there before.
fn read_in_place(gpu: &Arc<Gpu>, set: &Set, plan: &Plan, pass: usize, image: &str) -> bool {
    let uses = |p: usize| plan.passes[p].accesses.iter().filter(|(name, _)| name == image).map(|(_, usage)| *usage);
    let in_place = plan.targets.contains_key(image) && uses(pass).any(|usage| usage == Usage::ComputeReadWrite);
    let Some(writer) = (0..pass).rev().find(|p| uses(*p).any(|usage| usage.access().writes)) else { return false };
    let others = |p: &Pass| p.barriers.iter().any(|(name, _)| name == image);
    if !in_place || plan.passes[writer + 1..pass].iter().any(others) {
        return false;
    }
    let whole = set.linear(gpu);
    let (wrong, twin) = (instead(gpu, set, image, pass), instead(gpu, set, image, writer));
    let (wrong, twin) = (whole.differing(&wrong), whole.differing(&twin));
    println!(
        "{image} before {}: {wrong} pixels differ if it is something else; before its writer: {twin}",
        plan.passes[pass].name
    );
    wrong > 50 && twin == 0
}

/// Layouts of attachments are not checked under dynamic rendering. So the next pass asks: with the barrier the image is in the
/// layout that it was drawn in, without it is not.
fn layout_is_asked(gpu: &Arc<Gpu>, set: &Set, pass: usize, at: usize) -> bool {
    let asked = |gone: bool| {
        messages(gpu, set, |plan| {
            let (image, mut barrier) = plan.passes[pass].barriers[at].clone();
            if !plan.targets.contains_key(&image) || plan.passes[pass + 1..].iter().any(|p| touches(p, &image)) {
                return;
            }
            (barrier.old_layout, barrier.new_layout) = (barrier.new_layout, vk::ImageLayout::GENERAL);
            if plan.passes.len() == pass + 1 {
                // The frame's last: a clear behind it asks.
                plan.clear("asks", &image, [0.; 4]);
                let clear = Usage::CopyTo.access();
                (barrier.src_stage, barrier.src_access) = (barrier.dst_stage, barrier.dst_access);
                (barrier.dst_stage, barrier.dst_access) = (clear.stage, clear.access);
                barrier.new_layout = clear.layout;
            }
            if gone {
                plan.passes[pass].barriers.remove(at);
            }
            plan.passes[pass + 1].barriers.push((image, barrier));
        })
    };
    asked(false).is_empty() && !asked(true).is_empty()
}

fn touches(pass: &Pass, resource: &str) -> bool {
    pass.accesses.iter().any(|(name, _)| name == resource)
}

#[test]
fn every_barrier_is_missed() {
    let gpu = studio::open();
    let frames = [
        (Method::Pdss, Screen::Compute),
        (Method::Pdss, Screen::Fragment),
        (Method::Moments, Screen::Fragment),
        (Method::Separable, Screen::Compute),
    ];
    for (method, screen) in frames {
        missed(&gpu, &small(method, screen));
    }
    gpu.close().expect("nothing leaks");
}

fn missed(gpu: &Arc<Gpu>, set: &Set) {
    let plan = Renderer::plan_only(&set.inputs()).expect("a plan");
    assert!(
        plan.has("facet") && plan.has("inert") == (set.settings.method == Method::Moments),
        "the scene asks for them"
    );
    assert_eq!(messages(gpu, set, |_| {}), Vec::<String>::new(), "the whole plan");
    assert_eq!(messages(gpu, set, twice), Vec::<String>::new(), "two frames");
    let mut kinds = BTreeMap::<String, usize>::new();
    let (mut count, mut second, mut layouts, mut pictures, mut silent) = (0, 0, 0, 0, Vec::new());
    for (p, pass) in plan.passes.iter().enumerate() {
        for (b, (resource, barrier)) in pass.barriers.iter().enumerate() {
            count += 1;
            let place = format!("{resource} before {}", pass.name);
            let found = messages(gpu, set, |plan| drop(plan.passes[p].barriers.remove(b)));
            if let Some(first) = found.first() {
                *kinds.entry(kind(first)).or_default() += 1;
                continue;
            }
            // What orders a frame behind the one before is seen where both are in one command buffer.
            let found = messages(gpu, set, |plan| {
                let first = plan.passes.len();
                twice(plan);
                plan.passes[first + p].barriers.remove(b);
            });
            if let Some(first) = found.first() {
                println!("{place}: noticed between frames, {}", kind(first));
                second += 1;
            } else if layout_is_asked(gpu, set, p, b) {
                println!("{place}: its layout is missed when asked for");
                layouts += 1;
            } else if read_in_place(gpu, set, &plan, p, resource) {
                pictures += 1;
            } else {
                silent.push(format!("{place}: {barrier:?}"));
            }
        }
    }
    let noticed: usize = kinds.values().sum();
    println!(
        "{:?}, {:?}: {count} barriers, {noticed} noticed in a frame, {second} between two, {layouts} by its layout, {pictures} by a wrong picture: {kinds:#?}",
        set.settings.method, set.settings.screen
    );
    assert_eq!(silent, Vec::<String>::new(), "nobody notices that these are gone");
    assert!(count > 20 && noticed > count / 2, "{noticed} of {count}");
}
