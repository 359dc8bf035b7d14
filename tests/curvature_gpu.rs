//! `--view curvature` through the whole frame, against shapes whose curvature is known in closed form.
//!
//! Causes of error are told apart: the kernel's arithmetic (against its f64 twin on the very G-buffer that the device wrote),
//! the mesh, whose triangles interpolate normals linearly, and the 16-bit normals (the twin again, with the shape's own
//! normal at each position, stored in 16 bit or not at all). The rest is the estimator's truncation. Here
//! the 16 bit decide everywhere but on the torus, where the mesh doubles what they leave; the kernel adds 1e-6.
mod studio;

use glam::DVec3;
use pdss::gpu::Gpu;
use pdss::scene::{Camera, ShapeSpec, shape_curvature, shape_normal};
use pdss::settings::{Curvature, Method, View};
use pdss::skin::curvature::{self as twin, Estimator, GBuffer};
use std::sync::Arc;
use studio::{Picture, Set};

const BAND: i64 = 4;
const SIZE: [u32; 2] = [320, 240];
const ESTIMATORS: [(Curvature, Estimator); 4] = [
    (Curvature::Vergne, Estimator::Vergne),
    (Curvature::Trace, Estimator::Trace),
    (Curvature::Metric, Estimator::Metric),
    (Curvature::Fit, Estimator::Fit),
];

/// A shape and its smallest radius of curvature, mm; of the plane, its size.
struct Subject {
    text: &'static str,
    radius: f64,
    /// yaw, pitch, distance.
    eye: [f64; 3],
}

const SUBJECTS: [Subject; 6] = [
    Subject { text: "shape:sphere:60", radius: 60., eye: [0., 0., 300.] },
    Subject { text: "shape:cylinder:40", radius: 40., eye: [0., 20., 220.] },
    Subject { text: "shape:torus:70,25", radius: 25., eye: [0., 50., 420.] },
    // The sharpest principal curvature of an ellipsoid is a / c^2.
    Subject { text: "shape:ellipsoid:80,60,45", radius: 45. * 45. / 80., eye: [30., 20., 380.] },
    Subject { text: "shape:saddle:50", radius: 50., eye: [25., 50., 480.] },
    Subject { text: "shape:plane", radius: 200., eye: [10., 40., 420.] },
];

/// What is known of each pixel without any estimator.
struct Truth {
    h: Vec<f64>,
    k: Vec<f64>,
    /// On the surface; true within the silhouette band.
    pixels: Vec<(usize, bool)>,
}

fn view(gpu: &Arc<Gpu>, set: &Set, view: View) -> Picture {
    let mut set = set.clone();
    set.settings.view = view;
    set.linear(gpu)
}

/// Analytic curvature where the device says that it hit, signed as seen from the eye.
fn truth(spec: &ShapeSpec, set: &Set, position: &Picture, depth: &Picture, footprint: f64) -> Truth {
    let [w, h] = position.size.map(|n| n as i64);
    let eye = set.camera.eye.as_dvec3();
    let n = position.texels.len();
    let mut t = Truth { h: vec![0.; n], k: vec![0.; n], pixels: Vec::new() };
    // A neighbour this much further along the view axis than a slope of 8 allows is another part of the surface.
    let jump = |a: usize, b: usize| (depth.texels[a][0] - depth.texels[b][0]).abs() as f64 > 8. * footprint;
    for at in position.covered() {
        let [x, y, z, _] = position.texels[at].map(f64::from);
        let p = DVec3::new(x, y, z);
        let side = shape_normal(spec, p).dot(eye - p).signum();
        let (mean, gauss) = shape_curvature(spec, p);
        (t.h[at], t.k[at]) = (side * mean, gauss);
        let (px, py) = (at as i64 % w, at as i64 / w);
        let mut band = px < BAND || py < BAND || px >= w - BAND || py >= h - BAND;
        for dy in -BAND..=BAND {
            for dx in -BAND..=BAND {
                let inside = px + dx >= 0 && px + dx < w && py + dy >= 0 && py + dy < h;
                let other = ((py + dy) * w + px + dx) as usize;
                band |= inside && position.texels[other][3] == 0.;
                // One step at a time: along a slope depth adds up.
                let step = (((py + dy - dy.signum()) * w) + px + dx - dx.signum()) as usize;
                band |= inside && (dx, dy) != (0, 0) && jump(other, step);
            }
        }
        t.pixels.push((at, band));
    }
    t
}

/// The G-buffer that the device wrote, for the f64 twin.
fn gbuffer(set: &Set, depth: &Picture, normal: &Picture) -> GBuffer {
    let [width, height] = depth.size;
    let rotation = set.camera.view_from_world().as_dmat4();
    let turned =
        |t: &[f32; 4]| rotation.transform_vector3(DVec3::new(t[0].into(), t[1].into(), t[2].into())).to_array();
    let tan = 15f64.to_radians().tan();
    let scale = 2. * tan / height as f64;
    let camera = twin::Camera {
        ray_scale: [scale, -scale],
        ray_offset: [-tan * width as f64 / height as f64, tan],
        perspective: true,
    };
    GBuffer {
        width,
        height,
        z: depth.texels.iter().map(|t| f64::from(t[0])).collect(),
        normal: normal.texels.iter().map(turned).collect(),
        camera,
    }
}

/// The same with the shape's own normals, rounded to octahedral coordinates of so many steps if any.
fn own_normals(spec: &ShapeSpec, set: &Set, position: &Picture, g: &GBuffer, steps: Option<f64>) -> GBuffer {
    let mut g = g.clone();
    let rotation = set.camera.view_from_world().as_dmat4();
    for at in position.covered() {
        let [x, y, z, _] = position.texels[at].map(f64::from);
        let p = DVec3::new(x, y, z);
        let n = shape_normal(spec, p);
        let n = rotation.transform_vector3(n * n.dot(set.camera.eye.as_dvec3() - p).signum());
        g.normal[at] = steps.map_or(n, |s| octahedral(n, s)).to_array();
    }
    g
}

fn octahedral(n: DVec3, steps: f64) -> DVec3 {
    let fold = |x: f64, y: f64| ((1. - y.abs()).copysign(x), (1. - x.abs()).copysign(y));
    let n = n / n.abs().element_sum();
    let (x, y) = if n.z < 0. { fold(n.x, n.y) } else { (n.x, n.y) };
    let (x, y) = ((x * steps).round() / steps, (y * steps).round() / steps);
    let z = 1. - x.abs() - y.abs();
    let (x, y) = if z < 0. { fold(x, y) } else { (x, y) };
    DVec3::new(x, y, z).normalize()
}

#[derive(Clone, Copy, Debug, Default)]
struct Spread {
    median: f64,
    p99: f64,
    max: f64,
    n: usize,
}

fn spread(mut v: Vec<f64>) -> Spread {
    v.sort_by(f64::total_cmp);
    let at = |q: f64| v.get(((v.len() as f64 * q) as usize).min(v.len().saturating_sub(1))).copied().unwrap_or(0.);
    Spread { median: at(0.5), p99: at(0.99), max: at(1.), n: v.len() }
}

/// The claim for `fit` and `metric`.
fn accurate(s: Spread) -> bool {
    s.n > 3000 && s.median <= 1e-3 && s.p99 <= 1e-2
}

impl Truth {
    fn errors(&self, inside: bool, error: impl Fn(usize) -> f64) -> Spread {
        spread(self.pixels.iter().filter(|(_, band)| *band == inside).map(|(at, _)| error(*at)).collect())
    }
}

fn line(s: Spread) -> String {
    format!("{:8.1e} {:8.1e} {:8.1e}", s.median, s.p99, s.max)
}

fn subject(gpu: &Arc<Gpu>, subject: &Subject) {
    let Subject { text, radius: r, eye } = *subject;
    let spec: ShapeSpec = text.parse().expect("a shape");
    let mut set = Set::new(text, eye[2], studio::settings(Method::Lambert, View::Position, SIZE));
    set.camera = Camera::orbit(eye[0], eye[1], eye[2], None, 30., &set.scene);
    set.lights.clear();
    let (position, depth) = (view(gpu, &set, View::Position), view(gpu, &set, View::Depth));
    let g = gbuffer(&set, &depth, &view(gpu, &set, View::Normal));
    let truth = truth(&spec, &set, &position, &depth, g.camera.footprint(eye[2]));
    let flat = spec == ShapeSpec::Plane;
    let mut worst = [0.; 4];
    let own = |bits: Option<f64>| own_normals(&spec, &set, &position, &g, bits);
    let causes = [own(None), own(Some(32767.))].map(|g| {
        let exact = twin::estimate(Estimator::Fit, &g);
        truth.errors(false, |at| (exact[at].h - truth.h[at]).abs() * r)
    });
    println!("{text:26} fit, exact normals: {}; exact, in 16 bit: {}", line(causes[0]), line(causes[1]));
    for (i, (estimator, reference)) in ESTIMATORS.into_iter().enumerate() {
        set.settings.curvature = estimator;
        let got = view(gpu, &set, View::Curvature);
        let want = twin::estimate(reference, &g);
        let h = |at: usize| f64::from(got.texels[at][0]);
        let of_h = |at: usize| (h(at) - truth.h[at]).abs() * r;
        let of_k = |at: usize| (f64::from(got.texels[at][1]) - truth.k[at]).abs() * r * r;
        let (out, band, gauss) = (truth.errors(false, of_h), truth.errors(true, of_h), truth.errors(false, of_k));
        let kernel = truth.errors(false, |at| (h(at) - want[at].h).abs() * r);
        println!(
            "{:26} {:7} {}  {}  {}  {:8.1e}  {} + {}",
            text,
            reference.name(),
            line(out),
            line(band),
            line(gauss),
            kernel.p99,
            out.n,
            band.n
        );
        worst[i] = out.max.max(band.max);
        let name = format!("{text}, {}", reference.name());
        assert!(got.texels.iter().flatten().all(|x| x.is_finite()), "{name}: not finite");
        assert!(kernel.p99 < 2e-4 || estimator == Curvature::Vergne, "{name}: the kernel is not its twin: {kernel:?}");
        if estimator == Curvature::Fit {
            assert!(accurate(out), "{name}: {out:?}");
            // Twins: a curvature 2 % off (on the plane: not quite flat), and one of the other sign, are caught.
            let off = if flat { 0.02 / r } else { 0. };
            assert!(!accurate(truth.errors(false, |at| (1.02 * h(at) + off - truth.h[at]).abs() * r)), "{name}");
            let turned = truth.errors(false, |at| (off - h(at) - truth.h[at]).abs() * r);
            assert!(!accurate(turned), "{name}: the sign does not matter");
        }
    }
    // `trace` is left out: it takes every neighbour, also across the jump from one part of an open shape to another.
    let [vergne, _, metric, fit] = worst;
    println!("{text:26} largest of all pixels: vergne {vergne:.1e}, metric {metric:.1e}, fit {fit:.1e}");
    if !flat {
        assert!(vergne > 10., "{text}: vergne does not blow up: {vergne}");
    }
    assert!(fit < 0.5 && metric < 0.5, "{text}: ours blow up: {metric} {fit}");
}

#[test]
fn the_frame_measures_curvature() {
    let gpu = studio::open();
    println!(
        "{:34} r|dH|: median p99 max outside; the same in the band; r^2|dK| outside; kernel - twin p99; pixels",
        ""
    );
    for s in &SUBJECTS {
        subject(&gpu, s);
    }
    studio::close(gpu);
}
