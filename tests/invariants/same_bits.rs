//! Pictures that must not differ in a single bit.
use crate::Outcome;
use crate::studio::{Picture, Set, settings, shape, thinned};
use ash::vk;
use pdss::frame::Renderer;
use pdss::gpu::Gpu;
use pdss::plan::{Plan, TargetPlan};
use pdss::scene::Light;
use pdss::settings::{Method, Quality, Resolution, View};
use std::sync::Arc;

pub const SCATTERING: [Method; 8] = [
    Method::TextureSpace,
    Method::Pdss,
    Method::Moments,
    Method::Preintegrated,
    Method::Gaussians,
    Method::Separable,
    Method::Burley,
    Method::Wrap,
];

pub fn torus(method: Method, view: View) -> Set {
    let mut set = Set::new("shape:torus:70,25", 420., settings(method, view, [120, 90]));
    set.scene = thinned(&set.scene);
    set.lights.push(Light::directional(70., 10., 0.4));
    set.settings.quality = Quality::Low;
    set
}

pub fn radius_zero(gpu: &Arc<Gpu>) -> Vec<Outcome> {
    let lambert = torus(Method::Lambert, View::Scatter).linear(gpu);
    let against = |method: Method, factor: f64| {
        let mut set = torus(method, View::Scatter);
        set.profile = set.profile.map(|p| p.scaled(factor));
        lambert.differing(&set.linear(gpu))
    };
    let mut all = Vec::new();
    for method in SCATTERING {
        let own = against(method, 1.);
        for factor in [0., 1e-9] {
            let n = against(method, factor);
            let text = format!("{method:?}, profile times {factor}: {n} pixels differ; times 1: {own}");
            all.push(Outcome { text, holds: n == 0, can_fail: own > 1000 });
        }
    }
    all
}

pub fn no_profile(gpu: &Arc<Gpu>) -> Vec<Outcome> {
    let mut all = Vec::new();
    for view in [View::Final] {
        let lambert = torus(Method::Lambert, view).linear(gpu);
        for method in SCATTERING {
            let mut set = torus(method, view);
            let own = lambert.differing(&set.linear(gpu));
            set.profile = None;
            let none = lambert.differing(&set.linear(gpu));
            // The profile is there, but no material has it.
            let mut set = torus(method, view);
            let mut scene = (*thinned(&shape("shape:torus:70,25"))).clone();
            scene.materials.iter_mut().for_each(|m| m.scatter = None);
            set.scene = Arc::new(scene);
            let nobody = lambert.differing(&set.linear(gpu));
            let text = format!(
                "{method:?} {view:?}: {none} pixels differ without a profile, {nobody} without a material; with both: {own}"
            );
            all.push(Outcome { text, holds: none == 0 && nobody == 0, can_fail: own > 1000 });
        }
    }
    all
}

/// The picture of a frame in which each colour image but the picture is filled with NaN bits before pass `at`.
fn poisoned(gpu: &Arc<Gpu>, set: &Set, at: fn(&Plan) -> usize) -> Picture {
    let poison = |plan: &mut Plan| {
        let colour = |t: &TargetPlan| !t.kept && t.desc.format != vk::Format::D32_SFLOAT && t.desc.size != [1, 1];
        let names: Vec<String> = plan.targets.iter().filter(|(_, t)| colour(t)).map(|(n, _)| n.clone()).collect();
        let index = at(plan);
        for name in names {
            plan.clear("poison", &name, [f32::NAN; 4]);
            let pass = plan.passes.pop().expect("just added");
            plan.passes.insert(index, pass);
        }
        plan.finish().expect("a plan");
    };
    let mut renderer = Renderer::edited(gpu, set.inputs(), poison).expect("a frame");
    renderer.run().expect("it runs");
    Picture { size: set.size(), texels: renderer.linear().expect("a picture") }
}

/// What memory holds before the frame does not matter: nobody uses what nobody has written.
pub fn unwritten(gpu: &Arc<Gpu>) -> Vec<Outcome> {
    let mut all = Vec::new();
    // A forward pass reads no target.
    let deferred = SCATTERING.into_iter().filter(|m| *m != Method::Preintegrated);
    for method in std::iter::once(Method::Lambert).chain(deferred) {
        for resolution in [Resolution::Full, Resolution::Quarter] {
            let mut set = torus(method, View::Final);
            set.settings.resolution = Some(resolution);
            let picture = set.linear(gpu);
            let n = picture.differing(&poisoned(gpu, &set, |_| 0));
            let late = |plan: &Plan| {
                plan.passes.iter().position(|p| p.name == "light" || p.name == "combine").unwrap_or_default()
            };
            let off = picture.differing(&poisoned(gpu, &set, late));
            let text = format!("{method:?} {resolution:?}: {n} pixels differ; filled just before lighting: {off}");
            all.push(Outcome { text, holds: n == 0, can_fail: off > 1000 });
        }
    }
    all
}
