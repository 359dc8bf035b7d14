//! What is left out, and what is not done again: fewer passes, fewer bytes, the same bits.
use crate::Outcome;
use crate::same_bits::{SCATTERING, torus};
use crate::studio::{Set, shape};
use clap::ValueEnum;
use pdss::frame::Renderer;
use pdss::gpu::timing::TimingMode;
use pdss::gpu::{Gpu, Options};
use pdss::plan::Plan;
use pdss::scene::{Camera, Environment, Light, LightKind, Scene};
use pdss::settings::{Ambient, Method, Quality, Spared, View};
use std::sync::Arc;

type Change<'a> = (&'a str, &'a dyn Fn(&mut Set));

fn plan(set: &Set) -> Plan {
    Renderer::plan_only(&set.inputs()).expect("a plan")
}

/// Everything runs that can, needed or not, at once and one by one: the plan is longer, the picture the same.
pub fn left_out(gpu: &Arc<Gpu>) -> Vec<Outcome> {
    let point = |set: &mut Set| {
        let position = glam::Vec3::new(-90., 150., 120.);
        set.lights =
            vec![Light { kind: LightKind::Point { position }, color: [1.; 3], intensity: 0.05, range_mm: None }];
    };
    let dark = |set: &mut Set| set.settings.ambient = Ambient { up: [0.; 3], down: [0.; 3] };
    // Beyond its range, and beside its cone.
    let far = |set: &mut Set| {
        let position = glam::Vec3::new(0., 900., 0.);
        let beside = LightKind::Spot { position, direction: glam::Vec3::X, inner_cos: 0.99, outer_cos: 0.9 };
        let off = |kind, range_mm| Light { kind, color: [1.; 3], intensity: 5., range_mm };
        set.lights.insert(0, off(LightKind::Point { position }, Some(800.)));
        set.lights.push(off(beside, None));
    };
    let change = |set: &mut Set, change: &dyn Fn(&mut Scene)| {
        let mut scene = (*set.scene).clone();
        change(&mut scene);
        set.scene = Arc::new(scene);
    };
    let matt = |s: &mut Scene| s.materials.iter_mut().for_each(|m| m.specular.factor = 0.);
    let masked = |s: &mut Scene| {
        s.materials.iter_mut().for_each(|m| (m.scatter, m.scatter_mask) = (None, 0.));
        s.assign_profile(None, 0).expect("materials");
    };
    let black = |s: &mut Scene| {
        let sky = Environment::new("sky", 4, vec![[1.; 3]; 8]).expect("a sky");
        s.environment = Some(Arc::new(Environment { intensity: 0., background: Some(0.3), ..sky }));
    };
    // The first few for all methods.
    let pipe = |s: &mut Set| {
        s.scene = shape("shape:cylinder:40");
        s.camera = Camera::orbit(30., 50., 250., None, 30., &s.scene);
    };
    let cases: [Change<'_>; 15] = [
        ("as it is", &|_| {}),
        ("no ambient", &dark),
        ("a point light", &point),
        ("no profile", &|s| s.profile = None),
        ("nothing reflects", &|s| change(s, &matt)),
        ("lights that reach nothing", &far),
        ("no light", &|s| s.lights.clear()),
        ("a mask of 0", &|s| change(s, &masked)),
        ("a sky of intensity 0", &|s| change(s, &black)),
        ("no ambient occlusion", &|s| s.settings.no_ao = true),
        ("medium quality", &|s| s.settings.quality = Quality::Medium),
        ("still", &|s| s.settings.still = true),
        ("a pipe that is seen from inside", &pipe),
        ("a ball", &|s| s.scene = shape("shape:sphere:70")),
        ("a body that is almost flat", &|s| s.scene = shape("shape:ellipsoid:120,60,4")),
    ];
    let mut all = Vec::new();
    // Each by itself, for methods that have most to leave out, where the plan offers it for the first time.
    let mut alone: Vec<(Method, Spared)> = Vec::new();
    for method in std::iter::once(Method::Lambert).chain(SCATTERING) {
        let most = matches!(method, Method::Lambert | Method::Moments | Method::Separable | Method::Preintegrated);
        for (at, (what, change)) in cases[..if most { cases.len() } else { 6 }].iter().enumerate() {
            let mut set = torus(method, View::Final);
            change(&mut set);
            let fewer = plan(&set);
            let mut backs = vec![Spared::All];
            for back in fewer.left_out.iter().filter_map(|l| l.back) {
                if most && !alone.contains(&(method, back)) {
                    alone.push((method, back));
                    backs.push(back);
                }
            }
            // Where a method has nothing left out that it has not been tried with, one of them runs it all the same.
            if backs.len() == 1 && at > 3 && most && method != Method::Moments {
                continue;
            }
            let elided = set.linear(gpu);
            for back in backs {
                set.settings.no_elide = vec![back];
                let whole = set.linear(gpu);
                let more = plan(&set);
                let n = elided.differing(&whole);
                let left = more.left_out.iter().filter(|l| l.back.is_some_and(|b| b == back || back == Spared::All));
                let left: Vec<&str> = left.map(|l| l.what.as_str()).collect();
                // The twin: a picture that is not the same, by one part in a thousand.
                let mut other = whole.clone();
                other.texels.iter_mut().flatten().for_each(|x| *x *= 1.001);
                let off = elided.differing(&other);
                let text = format!(
                    "{method:?}, {what}, {back:?} back: {n} pixels differ; {} passes and {} things left out against {} and {}, still left out {left:?}; brighter by .1 %: {off}",
                    fewer.passes.len(),
                    fewer.left_out.len(),
                    more.passes.len(),
                    more.left_out.len()
                );
                all.push(Outcome { text, holds: n == 0 && left.is_empty(), can_fail: off > 500 });
            }
        }
    }
    let forgotten: Vec<&Spared> = Spared::value_variants()
        .iter()
        .filter(|s| **s != Spared::All && alone.iter().all(|(_, back)| back != *s))
        .collect();
    let text = format!("{} names, each by itself, but for {forgotten:?}", Spared::value_variants().len() - 1);
    all.push(Outcome { text, holds: forgotten.is_empty(), can_fail: !alone.is_empty() });
    all
}

/// A scene in which nothing scatters is a plain deferred frame, whatever the method: the same commands, not a byte more.
pub fn plain(_: &Arc<Gpu>) -> Vec<Outcome> {
    let cases: [Change<'_>; 3] = [
        ("no profile", &|s| s.profile = None),
        ("a profile of radius 0", &|s| s.profile = s.profile.take().map(|p| p.scaled(0.))),
        ("a mask of nothing", &|s| {
            let mut scene = (*s.scene).clone();
            scene.materials.iter_mut().for_each(|m| m.scatter = None);
            s.scene = Arc::new(scene);
        }),
    ];
    let mut all = Vec::new();
    for method in SCATTERING {
        for (what, change) in &cases {
            let of = |method: Method, bare: bool| {
                let mut set = torus(method, View::Final);
                if bare {
                    change(&mut set);
                }
                plan(&set)
            };
            // A profile still marks its material, and its tiles: the floor is marked, too.
            let floor = of(Method::Lambert, true);
            let marked = *what == "a profile of radius 0";
            let frame = of(method, true);
            let same = frame.bytes() == floor.bytes() && (marked || frame.records_as(&floor));
            let own = of(method, false);
            let text = format!(
                "{method:?}, {what}: {} passes, {:?} bytes; lambert {} and {:?}",
                frame.passes.len(),
                frame.bytes(),
                floor.passes.len(),
                floor.bytes()
            );
            all.push(Outcome { text, holds: same, can_fail: !own.records_as(&floor) });
        }
    }
    all
}

/// Another eye and other lights are a write of constants: nothing is recorded again, and the picture is a fresh frame's.
pub fn looks(gpu: &Arc<Gpu>) -> Vec<Outcome> {
    let mut all = Vec::new();
    for method in std::iter::once(Method::Lambert).chain(SCATTERING) {
        let here = torus(method, View::Final);
        let mut there = here.clone();
        there.camera = Camera::orbit(35., 20., 420., None, 30., &there.scene);
        there.lights = vec![Light::directional(-10., 50., 0.8), Light::directional(80., 5., 0.7)];
        let mut far = here.clone();
        far.camera = Camera::orbit(20., 30., 4e5, None, 30., &far.scene);
        let (first, fresh) = (here.linear(gpu), there.linear(gpu));
        let mut renderer = Renderer::new(gpu, here.inputs()).expect("a frame");
        renderer.run().expect("it runs");
        let recorded = renderer.cpu_times().record_ms.to_bits();
        // What is too far away to scatter takes another frame, and leaves this one alone.
        let refused = method == Method::Lambert || !renderer.look(&far.inputs()).expect("a plan");
        let looked = renderer.look(&there.inputs()).expect("a plan");
        let again = renderer.cpu_times().record_ms.to_bits() != recorded;
        renderer.run().expect("it runs");
        let mut moved = first.clone();
        moved.texels = renderer.linear().expect("a picture");
        let (n, off) = (moved.differing(&fresh), moved.differing(&first));
        let text = format!(
            "{method:?}: looked {looked}, recorded again {again}, refused from afar {refused}; {n} pixels differ from a fresh frame's, {off} from the first"
        );
        all.push(Outcome { text, holds: looked && !again && refused && n == 0, can_fail: off > 500 });
    }
    all
}

/// Shadow maps are drawn once, kept while only the eye moves, and drawn again when a light does: the bits of frames that draw
/// them every time.
pub fn still(gpu: &Arc<Gpu>) -> Vec<Outcome> {
    let unwatched = Gpu::open(&Options::default()).expect("a Vulkan device");
    let mut all = Vec::new();
    for method in std::iter::once(Method::Lambert).chain(SCATTERING) {
        let here = torus(method, View::Final);
        let mut beside = here.clone();
        beside.camera = Camera::orbit(35., 20., 420., None, 30., &here.scene);
        let mut moved = beside.clone();
        moved.lights = vec![Light::directional(-10., 50., 0.8), Light::directional(80., 5., 0.7)];
        let keeping = |set: &Set| {
            let mut set = set.clone();
            set.settings.still = true;
            set
        };
        let start = keeping(&here);
        let mut inputs = start.inputs();
        inputs.timing = Some(TimingMode::Isolated);
        let mut renderer = Renderer::new(gpu, inputs).expect("a frame");
        // Each set as the next frame, and whether that should draw the maps.
        let turns = [(&here, true), (&here, false), (&beside, false), (&moved, true), (&moved, false), (&here, true)];
        let (mut drawn, mut differing) = (Vec::new(), 0);
        for (set, _) in turns {
            assert!(renderer.look(&keeping(set).inputs()).expect("a plan"), "{method:?}");
            renderer.run().expect("it runs");
            drawn.push(renderer.times().expect("stamps").iter().any(|(name, _)| name.starts_with("shadow")));
            let mut picture = set.linear(gpu);
            let fresh = picture.clone();
            picture.texels = renderer.linear().expect("a picture");
            differing += picture.differing(&fresh);
        }
        // The twin keeps the pass behind the maps, too, which draws what the eye sees.
        let mut greedy = Renderer::edited(&unwatched, start.inputs(), |plan| plan.still += 1).expect("a frame");
        greedy.run().expect("it runs");
        assert!(greedy.look(&keeping(&beside).inputs()).expect("a plan"), "{method:?}");
        greedy.run().expect("it runs");
        let fresh = beside.linear(gpu);
        let mut wrong = fresh.clone();
        wrong.texels = greedy.linear().expect("a picture");
        let off = wrong.differing(&fresh);
        let asked = turns.map(|t| t.1);
        let text = format!(
            "{method:?}: maps drawn {drawn:?}, {differing} pixels differ from frames that draw them each time; keeping what the eye sees, too: {off}"
        );
        all.push(Outcome { text, holds: drawn == asked && differing == 0, can_fail: off > 100 });
    }
    unwatched.close().expect("nothing leaks");
    all
}

/// A frame that is run again costs ten microseconds at most beside what the driver takes.
pub fn submits(gpu: &Arc<Gpu>) -> Vec<Outcome> {
    let mut renderer = Renderer::new(gpu, torus(Method::Moments, View::Final).inputs()).expect("a frame");
    let (mut own, mut whole) = (Vec::new(), Vec::new());
    for _ in 0..30 {
        renderer.run().expect("it runs");
        let times = renderer.cpu_times();
        own.push(times.last_own_us);
        whole.push(times.last_run_ms * 1e3);
    }
    let median = |list: &mut Vec<f64>| {
        list.sort_by(f64::total_cmp);
        list[list.len() / 2]
    };
    let (own, whole) = (median(&mut own), median(&mut whole));
    let text = format!("a frame run again: {own:.2} us of our own, {whole:.0} us in all");
    vec![Outcome { text, holds: own <= 10., can_fail: whole > 10. }]
}
