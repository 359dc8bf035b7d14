//! Ambient truth against closed forms, the AO polynomial against ambient truth.
mod studio;

use pdss::gpu::Gpu;
use pdss::scene::{Camera, LoadOptions, Scene};
use pdss::settings::{Method, Quality, View};
use pdss::skin::occlusion::{self, Falloff, bowl, trough};
use pdss::skin::profile::{Gaussian, Profile, Shape};
use pdss::truth::Window;
use pdss::truth::ambient::{self, Ambient};
use pdss::truth::bands::band;
use std::path::Path;
use std::sync::Arc;
use studio::Set;

const SIZE: [u32; 2] = [112, 112];
/// A pixel's size at unit distance, about: 30 degrees over the picture.
const PIXEL: f64 = 0.0048;

/// A shape seen from inside: its far wall, past a near one whose back is culled.
fn inside_out(text: &str) -> Arc<Scene> {
    let mut scene = (*studio::shape(text)).clone();
    scene.normals.iter_mut().for_each(|n| *n = n.map(|x| -x));
    scene.indices.chunks_exact_mut(3).for_each(|t| t.swap(1, 2));
    Arc::new(scene)
}

fn set(scene: Arc<Scene>, camera: [f64; 3], fov: f64) -> Set {
    let mut set = Set::new("shape:plane", 100., studio::settings(Method::Moments, View::Ao, SIZE));
    set.camera = Camera::orbit(camera[0], camera[1], camera[2], None, fov, &scene);
    set.scene = scene;
    set.profile = Some(Profile::resolve("skin").expect("a profile"));
    set.settings.quality = Quality::Ultra;
    set.lights.truncate(0);
    set
}

fn truth(set: &Set, window: Option<Window>, radius: f64, rays: usize) -> Ambient {
    ambient::visibility(&set.inputs(), window, radius, rays, |_| ()).expect("a truth")
}

/// Root mean square and greatest difference from `exact` where truth sees something.
fn apart(a: &Ambient, exact: f64) -> (f64, f64) {
    let errors: Vec<f64> = a.pixels.iter().filter(|p| p[3] > 0.).map(|p| (f64::from(p[0]) - exact).abs()).collect();
    assert!(errors.len() > 1000, "{} pixels", errors.len());
    let square: f64 = errors.iter().map(|e| e * e).sum();
    ((square / errors.len() as f64).sqrt(), errors.iter().fold(0., |m, e| m.max(*e)))
}

#[test]
fn rays_find_what_closed_forms_say() {
    let mut worst = 0f64;
    let middle = Some(Window { x: 40, y: 40, width: 32, height: 32 });
    for reach in [0.5, 1., 1.9, 3.] {
        let bowl_set = set(inside_out("shape:sphere:20"), [20., 10., 60.], 20.);
        let trough_set = set(inside_out("shape:cylinder:20"), [20., 0., 60.], 20.);
        let (b, t) = (truth(&bowl_set, middle, 20. * reach, 1024), truth(&trough_set, middle, 20. * reach, 1024));
        let exact = [bowl, trough].map(|f| 1. - f(-1. / 20., 20. * reach, Falloff::Quadratic));
        let ((rms_b, max_b), (rms_t, max_t)) = (apart(&b, exact[0]), apart(&t, exact[1]));
        println!(
            "kR {reach}: bowl {:.4} rms {rms_b:.1e} max {max_b:.1e}, estimated {:.1e}; trough {:.4} rms {rms_t:.1e} max {max_t:.1e}, estimated {:.1e}",
            exact[0], b.rms, exact[1], t.rms
        );
        worst = worst.max(rms_b).max(rms_t);
        assert!(rms_b < 3. * b.rms + 3e-4 && rms_t < 3. * t.rms + 3e-4, "the estimate is not honest");
        // Twins: another falloff, and the one for the other.
        let linear = 1. - bowl(-1. / 20., 20. * reach, Falloff::Linear);
        assert!(apart(&b, linear).0 > 5. * rms_b && apart(&b, exact[1]).0 > 5. * rms_b, "kR {reach}: wrong ones pass");
        assert!(b.halves[0] != b.halves[1]);
    }
    assert!(worst < 2e-3, "{worst:e}");
    // Nothing convex hides anything, and a plane sees all of the sky.
    for (shape, camera) in [("shape:sphere:20", [0., 0., 80.]), ("shape:plane", [0., 50., 200.])] {
        let open = apart(&truth(&set(studio::shape(shape), camera, 20.), None, 30., 64), 1.);
        assert!(open.1 < 1e-3, "{shape}: {open:?}");
    }
}

/// A scene to fit on.
struct Case {
    name: &'static str,
    truth: Vec<f64>,
    /// H of each level times its radius, pixels that count alone.
    levels: Vec<Vec<f64>>,
    /// H and K as measured, times R and R^2 of the widest level.
    sharp: Vec<[f64; 2]>,
    shader: Vec<f64>,
    own: f64,
}

fn render(gpu: &Arc<Gpu>, set: &Set) -> Vec<[f32; 4]> {
    set.linear(gpu).texels
}

fn case(gpu: &Arc<Gpu>, name: &'static str, mut set: Set, sigmas: &[f64]) -> Case {
    let radius = 3. * sigmas.iter().fold(0., |m: f64, s| m.max(*s));
    let ao = truth(&set, None, radius, 128);
    let surface = pdss::truth::surface::Surface::new(&set.scene, &set.camera, set.size().map(|x| x as u32));
    let eye = pdss::truth::eye::Eye::new(&set.camera, SIZE, &set.scene);
    let border = pdss::truth::bands::BORDER;
    let (w, h) = (SIZE[0] as usize, SIZE[1] as usize);
    let seen = eye.see(&surface, -(border as i64), -(border as i64), w + 2 * border, h + 2 * border);
    let window = Window { x: 0, y: 0, width: SIZE[0], height: SIZE[1] };
    let bands = pdss::truth::bands::bands(&surface, &[], false, &seen, &window, |d| d * PIXEL, 1.);
    // Beside a silhouette the screen shows one side of what occludes.
    let counts: Vec<usize> =
        (0..w * h).filter(|i| ao.pixels[*i][3] > 0. && bands[*i] & band::SILHOUETTE == 0).collect();
    let shader = render(gpu, &set);
    set.settings.view = View::Curvature;
    let curvature = render(gpu, &set);
    set.settings.view = View::SoftCurvature;
    set.settings.quality = Quality::Ultra;
    let mut levels = Vec::new();
    for sigma in sigmas {
        let gaussians = vec![Gaussian { variance: sigma * sigma, weight: [1.; 3] }];
        let one = Profile {
            name: "one".into(),
            source: String::new(),
            shape: Shape::Gaussians(gaussians),
            ior: 1.4,
            albedo: None,
            lobes: None,
        };
        set.profile = Some(one);
        let soft = set.try_linear(gpu).ok().map(|p| p.texels);
        // A level below a pixel is not there; the frame refuses to show it.
        if let Some(soft) = soft {
            levels.push(counts.iter().map(|i| f64::from(soft[*i][0]) * 3. * sigma).collect());
        }
    }
    let pick = |from: &[[f32; 4]]| -> Vec<f64> { counts.iter().map(|i| f64::from(from[*i][0])).collect() };
    Case {
        name,
        truth: pick(&ao.pixels),
        levels,
        sharp: counts
            .iter()
            .map(|i| [f64::from(curvature[*i][0]) * radius, f64::from(curvature[*i][1]) * radius * radius])
            .collect(),
        shader: pick(&shader),
        own: ao.rms,
    }
}

/// rms and worst of a visibility against truth.
fn errors(c: &Case, v: impl Fn(usize) -> f64) -> (f64, f64) {
    let e: Vec<f64> = (0..c.truth.len()).map(|i| (v(i) - c.truth[i]).abs()).collect();
    ((e.iter().map(|e| e * e).sum::<f64>() / e.len() as f64).sqrt(), e.iter().fold(0., |m, e| m.max(*e)))
}

/// The polynomial with coefficient `a` before (H R)^2 and the bowl's saturation, quadratic falloff.
fn curve(hr: f64, a: f64) -> f64 {
    let q = a * hr.min(0.).powi(2);
    if q <= 1. { 0.5 * q } else { 1. - 0.5 / q }
}

#[test]
fn the_polynomial_against_rays() {
    let gpu = studio::open();
    let sigmas: Vec<f64> =
        Profile::resolve("skin").expect("skin").gaussians().gaussians.iter().map(|g| g.variance.sqrt()).collect();
    let mut cases = vec![
        case(&gpu, "bowl 12", set(inside_out("shape:sphere:12"), [20., 10., 60.], 14.), &sigmas),
        case(&gpu, "bowl 30", set(inside_out("shape:sphere:30"), [20., 10., 120.], 14.), &sigmas),
        case(&gpu, "trough 8", set(inside_out("shape:cylinder:8"), [0., 0., 60.], 10.), &sigmas),
        case(&gpu, "trough 20", set(inside_out("shape:cylinder:20"), [0., 0., 100.], 10.), &sigmas),
        case(&gpu, "saddle 12", set(studio::shape("shape:saddle:12"), [0., 90., 60.], 30.), &sigmas),
    ];
    let bust = Arc::new({
        let mut s = Scene::bust(&LoadOptions::default()).expect("it comes with the program");
        s.assign_profile(None, 0).expect("its skin");
        s
    });
    cases.push(case(&gpu, "bust", set(bust, [-20., 0., 420.], 30.), &sigmas));
    for (name, file, mm) in [("head", "../shared/models/derived/LeePerrySmith_textured_metres.glb", 420.)] {
        if Path::new(file).is_file() {
            let head = Arc::new({
                let mut s = Scene::load(Path::new(file), &LoadOptions::default()).expect("a head");
                s.assign_profile(None, 0).expect("a material");
                s
            });
            cases.push(case(&gpu, name, set(head, [-20., 0., mm], 30.), &sigmas));
        } else {
            println!("skipped: no {file}");
        }
    }
    let all = |form: &dyn Fn(&Case, usize) -> f64| -> (f64, String) {
        let mut line = String::new();
        let mut mean = 0.;
        for c in &cases {
            let (rms, worst) = errors(c, |i| form(c, i));
            mean += rms * rms / cases.len() as f64;
            line += &format!(" {rms:.4}/{worst:.3}");
        }
        (mean.sqrt(), format!("{line}  | {:.4}", mean.sqrt()))
    };
    println!(
        "{:34} {}",
        "",
        cases
            .iter()
            .map(|c| format!("{} ({:.1e}, {} levels)", c.name, c.own, c.levels.len()))
            .collect::<Vec<_>>()
            .join("  ")
    );
    println!("{:34}{}", "no occlusion", all(&|_, _| 1.).1);
    println!("{:34}{}", "the shader", all(&|c, i| c.shader[i]).1);
    let product = |a: f64| move |c: &Case, i: usize| c.levels.iter().map(|l| 1. - curve(l[i], a)).product();
    let max = |a: f64| move |c: &Case, i: usize| 1. - c.levels.iter().map(|l| curve(l[i], a)).fold(0., f64::max);
    let weighted = |c: &Case, i: usize| {
        let all: f64 = c.levels.iter().map(|l| curve(l[i], 0.3125)).sum();
        1. - all / c.levels.len().max(1) as f64
    };
    for a in [0.25, 0.3125, 0.375] {
        println!("{:34}{}", format!("product, a {a}"), all(&product(a)).1);
        println!("{:34}{}", format!("max, a {a}"), all(&max(a)).1);
        let widest = |c: &Case, i: usize| 1. - c.levels.last().map_or(0., |l| curve(l[i], a));
        println!("{:34}{}", format!("widest level, a {a}"), all(&widest).1);
        println!("{:34}{}", format!("unblurred H, a {a}"), all(&|c, i| 1. - curve(c.sharp[i][0], a)).1);
    }
    println!("{:34}{}", "mean of the levels, a 0.3125", all(&weighted).1);
    let patch = |c: &Case, i: usize| 1. - occlusion::patch(c.sharp[i][0], c.sharp[i][1], 1., Falloff::Quadratic);
    println!("{:34}{}", "unblurred H and K (patch)", all(&patch).1);
    // The shader's is the maximum of its own levels; on bowls, whose curvature no blur changes, to the bit of a half.
    for c in cases.iter().filter(|c| c.name.starts_with("bowl")) {
        let (rms, _) = errors(c, |i| c.shader[i] + c.truth[i] - max(0.3125)(c, i));
        let (twin, _) = errors(c, |i| c.shader[i] + c.truth[i] - product(0.3125)(c, i));
        assert!(rms < 1e-3 && twin > 3. * rms, "{}: {rms:e} from the maximum, {twin:e} from the product", c.name);
    }
    let (shader, _) = all(&|c, i| c.shader[i]);
    let (open, multiplied) = (all(&|_, _| 1.).0, all(&product(0.3125)).0);
    assert!(shader < multiplied && shader < open, "{shader} {multiplied} {open}");
    studio::close(gpu);
}
