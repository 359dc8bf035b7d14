//! Two profiles in one frame: each half of a sphere is lit as if the other did not scatter.
use crate::studio::{Picture, Set, settings, wax};
use clap::ValueEnum;
use pdss::frame::Renderer;
use pdss::gpu::Gpu;
use pdss::scene::{Light, Scene};
use pdss::settings::{Method, Quality, Transmittance, View};
use pdss::skin::profile::Profile;
use pdss::truth::{self, Effort};
use std::sync::Arc;

const SIZE: [u32; 2] = [128, 96];

/// A sphere of 20 mm, the profile of its left half and of its right half; none does not scatter.
fn sphere(halves: [Option<usize>; 2]) -> Scene {
    let mut scene = Scene::shape("shape:sphere:20").expect("a shape");
    let left = |t: &[u32]| t.iter().map(|i| scene.positions[*i as usize][0]).sum::<f32>() < 0.;
    let (a, b): (Vec<&[u32]>, Vec<&[u32]>) = scene.indices.chunks(3).partition(|t| left(t));
    let (first, second) = (a.concat(), b.concat());
    scene.materials.push(scene.materials[0].clone());
    scene.draws.push(scene.draws[0]);
    scene.draws[0].index_count = first.len() as u32;
    (scene.draws[1].first_index, scene.draws[1].index_count) = (first.len() as u32, second.len() as u32);
    scene.draws[1].material = scene.materials.len() - 1;
    for (draw, half) in scene.draws.clone().iter().zip(halves) {
        scene.materials[draw.material].scatter = half;
    }
    scene.indices = [first, second].concat();
    scene
}

fn skin() -> Profile {
    Profile::resolve("skin").expect("built in")
}

fn set(method: Method, view: View, halves: [Option<usize>; 2]) -> Set {
    let mut set = Set::new("shape:sphere:20", 110., settings(method, view, SIZE));
    set.scene = Arc::new(sphere(halves));
    set.lights = vec![Light::directional(70., 25., 1.), Light::directional(-60., 10., 0.3)];
    // Over its own maps, thousands of texels wide at high, light takes seconds a frame.
    let quality = if method == Method::TextureSpace { Quality::Low } else { Quality::High };
    (set.settings.quality, set.settings.transmittance) = (quality, Some(Transmittance::Slab));
    // One profile has its hidden light from the shadow map; several have not.
    set.settings.no_translucent = true;
    set
}

fn draw(gpu: &Arc<Gpu>, set: &Set, profiles: &[Profile]) -> Picture {
    let mut inputs = set.inputs();
    inputs.profiles = profiles.to_vec();
    let mut renderer = Renderer::new(gpu, inputs).expect("a frame");
    renderer.run().expect("it runs");
    Picture { size: set.size(), texels: renderer.linear().expect("a linear picture") }
}

/// Greatest difference, and how many pixels were compared, where `of` says that a pixel is this half's. Two pixels aside: whether
/// a texel of a shadow map is nearer than the surface is a step, and distances that lose bits to a number may fall beyond it.
fn apart(a: &Picture, b: &Picture, of: impl Fn(usize) -> bool) -> (f32, usize) {
    let far = |i: usize| (0..3).map(|c| (a.texels[i][c] - b.texels[i][c]).abs()).fold(0., f32::max);
    let mut pixels: Vec<f32> = (0..a.texels.len()).filter(|i| of(*i)).map(far).collect();
    pixels.sort_unstable_by(|a, b| b.total_cmp(a));
    (pixels[2], pixels.len())
}

pub fn check(gpu: &Arc<Gpu>) -> Vec<String> {
    let mut wrong = Vec::new();
    let (both, left, right) = ([Some(0), Some(1)], [Some(0), None], [None, Some(0)]);
    // Which half a pixel shows: what the right one scatters alone differs from what nothing scatters.
    let view = |material: &str| {
        let mut s = set(Method::Lambert, View::Albedo, [None; 2]);
        let mut scene = (*s.scene).clone();
        scene.materials[usize::from(material == "right")].base_color = [0., 0., 0., 1.];
        s.scene = Arc::new(scene);
        draw(gpu, &s, &[])
    };
    let (dark_left, dark_right) = (view("left"), view("right"));
    let is_left = |i: usize| dark_left.texels[i][0] < 0.1 && dark_left.texels[i][3] > 0.;
    let is_right = |i: usize| dark_right.texels[i][0] < 0.1 && dark_right.texels[i][3] > 0.;
    for method in Method::value_variants() {
        for view in [View::Scatter, View::Final] {
            let whole = draw(gpu, &set(*method, view, both), &[skin(), wax()]);
            let alone =
                [draw(gpu, &set(*method, view, left), &[skin()]), draw(gpu, &set(*method, view, right), &[wax()])];
            let (a, n) = apart(&whole, &alone[0], is_left);
            let (b, m) = apart(&whole, &alone[1], is_right);
            // The twin: as one body of skin light crosses the seam, and the right half is no wax.
            let one = draw(gpu, &set(*method, view, [Some(0); 2]), &[skin()]);
            let (crossed, other) = (apart(&one, &alone[0], is_left).0, apart(&one, &alone[1], is_right).0);
            println!(
                "{method:?} {view:?}: {n} pixels of skin {a:.1e}, {m} of wax {b:.1e}; as one body {crossed:.3} {other:.3}"
            );
            // Distances lose their last three bits to the profile's number.
            let blurs = !matches!(method, Method::Lambert | Method::Wrap | Method::Preintegrated);
            if a > 1e-3 || b > 1e-3 || n < 1000 || m < 1000 {
                wrong.push(format!("{method:?} {view:?}: {a} {b}"));
            }
            if *method != Method::Lambert && (blurs && crossed < 4e-3 || other < 4e-3) {
                wrong.push(format!("{method:?} {view:?}: one body is not told from two: {crossed} {other}"));
            }
        }
    }
    wrong.extend(truth_too(is_left, is_right));
    wrong
}

fn truth_too(is_left: impl Fn(usize) -> bool, is_right: impl Fn(usize) -> bool) -> Option<String> {
    let solve = |halves: [Option<usize>; 2], profiles: &[Profile]| {
        let s = set(Method::Lambert, View::Scatter, halves);
        let mut inputs = s.inputs();
        inputs.profiles = profiles.to_vec();
        let effort = Effort { samples: 60_000, ..Effort::default() };
        let texels = truth::solve(&inputs, None, &effort, |_| ()).expect("a truth").pixels;
        Picture { size: s.size(), texels }
    };
    let whole = solve([Some(0), Some(1)], &[skin(), wax()]);
    let (a, _) = apart(&whole, &solve([Some(0), None], &[skin()]), &is_left);
    let (b, _) = apart(&whole, &solve([None, Some(0)], &[wax()]), &is_right);
    let (crossed, _) = apart(&whole, &solve([Some(0); 2], &[skin()]), &is_left);
    println!("truth: skin {a:.1e}, wax {b:.1e}; as one body {crossed:.3}");
    (a > 1e-6 || b > 1e-6 || crossed < 5e-3).then(|| format!("truth: {a} {b} {crossed}"))
}
