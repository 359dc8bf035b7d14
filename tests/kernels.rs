//! The curvature kernels on the device: GLSL and hand-written SPIR-V against each other and against the f64 twin.
mod analytic;
mod rig;

use analytic::{Picture, Shape, Shot};
use pdss::gpu::{Gpu, Options};
use pdss::shaders::{
    CURVATURE_FIT, CURVATURE_METRIC, CURVATURE_SPIRV, CURVATURE_TRACE, CURVATURE_VERGNE, CURVATURE_VERGNE_MENDED,
    Shader, ShaderStage,
};
use pdss::skin::curvature::{Estimator, estimate};
use rig::{Rig, decoded};

const KERNELS: [(&Shader, Estimator); 6] = [
    (&CURVATURE_VERGNE_MENDED, Estimator::VergneMended),
    (&CURVATURE_VERGNE, Estimator::Vergne),
    (&CURVATURE_TRACE, Estimator::Trace),
    (&CURVATURE_METRIC, Estimator::Metric),
    (&CURVATURE_SPIRV, Estimator::Metric),
    (&CURVATURE_FIT, Estimator::Fit),
];

fn shot(shape: Shape, distance: f64, turn: [f64; 2]) -> Shot {
    // Neither size is a multiple of a tile.
    Shot { shape, size: [317, 243], focal: 672.0, distance, turn, perspective: true }
}

fn pictures() -> Vec<(String, Picture)> {
    let torus = shot(Shape::Torus(70.0, 25.0), 560.0, [20.0, 30.0]);
    let mut all = vec![
        ("sphere".to_owned(), shot(Shape::Sphere(60.0), 500.0, [0.0, 0.0]).take()),
        ("saddle".to_owned(), shot(Shape::Saddle(40.0), 560.0, [25.0, 40.0]).take()),
        ("ortho".to_owned(), Shot { perspective: false, ..torus }.take()),
        (
            "wide".to_owned(),
            Shot { focal: 40.0, ..shot(Shape::Ellipsoid(80.0, 50.0, 35.0), 75.0, [30.0, 20.0]) }.take(),
        ),
        ("row".to_owned(), Shot { size: [317, 1], ..shot(Shape::Sphere(60.0), 500.0, [0.0, 0.0]) }.take()),
        ("pixel".to_owned(), Shot { size: [1, 1], ..shot(Shape::Sphere(60.0), 500.0, [0.0, 0.0]) }.take()),
    ];
    for s in [1e-3 / 25.0, 1.0, 1e6 / 25.0] {
        all.push((format!("torus x {s:.0e}"), torus.scaled(s).take()));
    }
    // Half of the object scatters: the sign of the distance is an edge.
    let mut halves = torus.take();
    for i in 0..halves.g.z.len() {
        if i % 317 > 150 {
            halves.g.z[i] = -halves.g.z[i];
        }
    }
    all.push(("halves".to_owned(), halves));
    all
}

/// Largest of the values, and the one that 999 of 1000 do not exceed.
fn spread(mut v: Vec<f64>) -> (f64, f64) {
    v.sort_by(f64::total_cmp);
    (v.last().copied().unwrap_or(0.0), v.get(v.len() * 999 / 1000).copied().unwrap_or(0.0))
}

#[test]
fn kernels_agree_with_the_twin_and_each_other() {
    let gpu = Gpu::open(&Options { validate: true, device: None }).expect("a Vulkan device with validation");
    println!("{:14} {:18} {:^21} {:^21} {:^21}", "", "max, p99.9 of", "|dH| q", "|d root K| q", "|d confidence|");
    for (name, picture) in pictures() {
        let stored = rig::stored(&picture.g);
        let reference = decoded(&stored, &picture.g);
        let rig = Rig::new(&gpu, &stored, &picture.g);
        for (shader, estimator) in KERNELS {
            let got = rig.run(shader);
            let want = estimate(estimator, &reference);
            let mut d = [const { Vec::new() }; 3];
            for (i, (got, want)) in got.iter().zip(&want).enumerate() {
                let z = reference.z[i];
                if z == 0.0 {
                    assert_eq!(got.bits, [rig::UNTOUCHED; 2], "{name}: {} wrote to the background", shader.name);
                    continue;
                }
                let q = reference.camera.footprint(z);
                // Far over the bound (vergne at contours) differences are told relative to the value.
                let large = (want.h.abs() * q).max(1.0);
                d[0].push((got.h - want.h).abs() * q / large);
                d[1].push((got.root_k - want.k.signum() * want.k.abs().sqrt() * q).abs());
                d[2].push((got.confidence - want.confidence).abs());
            }
            assert!(!d[0].is_empty(), "{name}: nothing was compared");
            let [h, k, c] = d.map(spread);
            // f32 loses 1e-7 of a normal; halves lose 2^-12 of 1/2 and of 1; a square root doubles the digits lost near K = 0.
            assert!(h.1 < 1e-6 && k.1 < 2e-4 && c.1 < 1e-3, "{name}: {} is not its twin", shader.name);
            assert!(estimator == Estimator::Vergne || h.0 < 1e-4, "{name}: {} is not its twin", shader.name);
            println!(
                "{name:14} {:18} {:9.1e} {:9.1e}   {:9.1e} {:9.1e}   {:9.1e} {:9.1e}",
                shader.name, h.0, h.1, k.0, k.1, c.0, c.1
            );
        }
        let (glsl, spirv) = (rig.run(&CURVATURE_METRIC), rig.run(&CURVATURE_SPIRV));
        let at = (0..glsl.len()).filter(|i| reference.z[*i] != 0.0);
        let step = spread(
            at.clone().map(|i| (glsl[i].h - spirv[i].h).abs() * reference.camera.footprint(reference.z[i])).collect(),
        );
        let same = at.clone().filter(|i| glsl[*i].bits == spirv[*i].bits).count();
        println!(
            "{name:14} glsl - spirv       {:9.1e} {:9.1e}   {same} of {} pixels are the same bits",
            step.0,
            step.1,
            at.count()
        );
    }
    assert_eq!(gpu.messages(), Vec::<String>::new());
    gpu.close().expect("nothing leaks");
}

/// The tolerances above tell the estimators apart: each kernel against another one's twin fails them.
#[test]
fn no_kernel_passes_for_another() {
    let gpu = Gpu::open(&Options { validate: true, device: None }).expect("a Vulkan device with validation");
    let picture = shot(Shape::Torus(70.0, 25.0), 560.0, [20.0, 30.0]).take();
    let stored = rig::stored(&picture.g);
    let reference = decoded(&stored, &picture.g);
    let rig = Rig::new(&gpu, &stored, &picture.g);
    for (shader, own) in KERNELS {
        let got = rig.run(shader);
        for other in Estimator::ALL.into_iter().filter(|e| *e != own) {
            let want = estimate(other, &reference);
            let error = |i: usize| (got[i].h - want[i].h).abs() * reference.camera.footprint(reference.z[i]);
            let (_, common) = spread((0..got.len()).filter(|i| reference.z[*i] != 0.0).map(error).collect());
            assert!(common > 1e-5, "{} passes for {}", shader.name, other.name());
        }
    }
    drop(rig);
    gpu.close().expect("nothing leaks");
}

/// Times on this device, for `cargo test --release --test kernels -- --ignored --nocapture`.
#[test]
#[ignore = "a measurement, not a check"]
fn times() {
    let gpu = Gpu::open(&Options::default()).expect("a Vulkan device");
    let size = [1650, 1080];
    // All covered, whatever the method costs per pixel it costs everywhere.
    let picture = Shot { size, focal: 2000.0, ..shot(Shape::Saddle(2000.0), 1000.0, [0.0, 60.0]) }.take();
    let covered = picture.covered().count();
    let rig = Rig::new(&gpu, &rig::stored(&picture.g), &picture.g);
    println!("{}: {} x {}, {covered} covered", gpu.info().name, size[0], size[1]);
    for (shader, _) in KERNELS.into_iter().chain(KERNELS) {
        let (_, mut ns) = rig.repeat(shader, 30);
        ns.sort_by(f64::total_cmp);
        println!("{:18} min {:7.3} median {:7.3} ms", shader.name, ns[0] * 1e-6, ns[ns.len() / 2] * 1e-6);
    }
    drop(rig);
    gpu.close().expect("nothing leaks");
}

/// Both kernels bind the same resources in the same way: one stage file serves either.
#[test]
fn both_kernels_have_one_interface() {
    let (a, b) = (&CURVATURE_METRIC, &CURVATURE_SPIRV);
    assert_eq!((a.stage, a.workgroup, a.push_size), (ShaderStage::Compute, [8, 8, 1], 0));
    assert_eq!((b.stage, b.workgroup, b.push_size), (ShaderStage::Compute, [8, 8, 1], 0));
    assert_eq!(format!("{:?}", a.bindings), format!("{:?}", b.bindings));
    // The assembly declares of each block what it reads, at the compiler's own offsets.
    for block in b.blocks {
        let whole = a.blocks.iter().find(|x| x.name == block.name).expect("the same blocks");
        assert!(block.members.iter().all(|m| whole.members.contains(m)), "{}: {:?}", block.name, block.members);
        assert!(!block.members.is_empty());
    }
}
