//! Takes every barrier out of a plan in turn, and looks whether synchronization validation notices: the zero messages of the
//! other tests are worth as much as this one finds.
mod studio;

use ash::vk;
use pdss::frame::Renderer;
use pdss::gpu::Gpu;
use pdss::gpu::usage::{Barrier, Usage};
use pdss::plan::Plan;
use pdss::scene::Light;
use pdss::settings::{Method, Quality, Settings, View};
use std::collections::BTreeMap;
use std::sync::Arc;
use studio::Set;

/// `moments` gathers from medium quality on.
fn small(method: Method) -> Set {
    let quality = if method == Method::Moments { Quality::Medium } else { Quality::Low };
    let settings = Settings { quality, ..studio::settings(method, View::Final, [48, 32]) };
    let mut set = Set::new("shape:cylinder:40", 300., settings);
    set.lights.push(Light::directional(70., 10., 0.4));
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

/// A pass reads and writes this image in place.
fn updated(plan: &Plan, pass: usize, resource: &str) -> bool {
    let touches = |(name, usage): &(String, Usage)| name == resource && *usage == Usage::ComputeReadWrite;
    plan.targets.contains_key(resource) && plan.passes[pass].accesses.iter().any(touches)
}

/// Why nobody notices that this barrier is gone; none where somebody should.
fn excuse(plan: &Plan, pass: usize, resource: &str, barrier: &Barrier) -> Option<&'static str> {
    let first = !plan.passes[..pass].iter().any(|p| p.accesses.iter().any(|(name, _)| name == resource));
    let depth = vk::ImageLayout::DEPTH_ATTACHMENT_OPTIMAL;
    match resource {
        _ if first && plan.buffers.contains_key(resource) => {
            Some("the hazard is with the frame before, another submit, whose fence has been waited for")
        }
        "shadow" if barrier.old_layout == depth && barrier.new_layout == depth => {
            Some("the two passes write different layers: an image is tracked whole, so the barrier is not needed")
        }
        _ if updated(plan, pass, resource) && barrier.src_access == vk::AccessFlags2::SHADER_STORAGE_WRITE => {
            Some("what is read and written is tracked as written, and write after write on a storage image is missed")
        }
        "depth" if first => {
            Some("layouts of attachments are not checked under dynamic rendering, and nobody reads depth later")
        }
        _ => None,
    }
}

#[test]
fn every_barrier_is_missed() {
    let gpu = studio::open();
    for method in [Method::Pdss, Method::Moments, Method::Separable] {
        missed(&gpu, &small(method));
    }
    gpu.close().expect("nothing leaks");
}

fn missed(gpu: &Arc<Gpu>, set: &Set) {
    let plan = Renderer::plan_only(&set.inputs()).expect("a plan");
    assert_eq!(messages(gpu, set, |_| {}), Vec::<String>::new(), "the whole plan");
    let mut kinds = BTreeMap::<String, usize>::new();
    let (mut count, mut excused, mut silent) = (0, 0, Vec::new());
    for (p, pass) in plan.passes.iter().enumerate() {
        for (b, (resource, barrier)) in pass.barriers.iter().enumerate() {
            count += 1;
            let place = format!("{resource} before {}", pass.name);
            let found = messages(gpu, set, |plan| drop(plan.passes[p].barriers.remove(b)));
            match (found.first(), excuse(&plan, p, resource, barrier)) {
                (Some(first), _) => *kinds.entry(kind(first)).or_default() += 1,
                (None, Some(why)) => {
                    println!("{place}: not noticed; {why}");
                    excused += 1;
                }
                (None, None) => silent.push(format!("{place}: {barrier:?}")),
            }
        }
    }
    println!(
        "{:?}: {count} barriers, {} noticed by their first message: {kinds:#?}",
        set.settings.method,
        count - excused - silent.len()
    );
    assert_eq!(silent, Vec::<String>::new(), "nobody notices that these are gone");
    assert!(count > 20 && 5 * excused < count, "{excused} of {count} have an excuse");
}
