//! H and K on shapes whose curvature is known in closed form: every scale, distance, field of view and number of bits.
//!
//! Errors are told as r |dH| and r^2 |dK|, r the shape's smallest radius of curvature: the same at every scale.

use super::studio::{Picture, Set, settings};
use super::{Bench, Measure, Measured, Spread, StressError};
use crate::scene::{Camera, ShapeSpec, shape_curvature, shape_normal};
use crate::settings::{Curvature, Method, View};
use crate::skin::blur::Texel;
use crate::skin::curvature::{self as twin, Estimator, GBuffer};
use crate::skin::octahedral as code;
use glam::DVec3;

/// Pixels from the background, a jump in depth or the border that count as the silhouette's.
const BAND: i64 = 4;
const SIZE: [u32; 2] = [160, 120];

/// Errors of one picture.
pub struct Look {
    /// r |dH| outside the silhouette's band.
    pub out: Spread,
    /// The same inside.
    pub band: Spread,
    /// r^2 |dK| outside.
    pub gauss: Spread,
    /// r |dH| outside of an H that is .02 / r off.
    pub off: Spread,
    /// r times the mean of the signed error outside.
    pub bias: f64,
}

/// Measures curvature where `set` looks at the shape; `radius` is the unit of errors in mm.
pub fn look(bench: &Bench, spec: &ShapeSpec, set: &Set, radius: f64) -> Result<Look, StressError> {
    let position = set.seeing(View::Position).linear(bench)?;
    let depth = set.seeing(View::Depth).linear(bench)?;
    let got = set.seeing(View::Curvature).linear(bench)?;
    let eye = set.camera.eye.as_dvec3();
    let perspective = matches!(set.camera.projection, crate::scene::Projection::Perspective { .. });
    let (mut out, mut band, mut gauss, mut off) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let mut sum = 0.;
    let rim = silhouette(&depth);
    for at in position.covered() {
        let [x, y, z, _] = position.texels[at].map(f64::from);
        let p = DVec3::new(x, y, z);
        let towards = if perspective { eye - p } else { -set.camera.forward.as_dvec3() };
        let side = shape_normal(spec, p).dot(towards).signum();
        let (mean, k) = shape_curvature(spec, p);
        let h = f64::from(got.texels[at][0]);
        let error = (h - side * mean) * radius;
        if rim[at] {
            band.push(error.abs());
            continue;
        }
        sum += error;
        out.push(error.abs());
        gauss.push((f64::from(got.texels[at][1]) - k).abs() * radius * radius);
        off.push((error + 0.02).abs());
    }
    let bias = sum / out.len() as f64;
    Ok(Look { out: Spread::of(out), band: Spread::of(band), gauss: Spread::of(gauss), off: Spread::of(off), bias })
}

/// Pixels near the background, the border, or a jump in depth that no slope of 8 explains.
fn silhouette(depth: &Picture) -> Vec<bool> {
    let [w, h] = depth.size.map(|n| n as i64);
    let z = |x: i64, y: i64| f64::from(depth.texels[(y * w + x) as usize][0]);
    // A jump: far more than the median step between neighbours.
    let median = |dx: i64, dy: i64| {
        let both = |i: &i64| i % w >= dx && i / w >= dy && z(i % w, i / w) > 0. && z(i % w - dx, i / w - dy) > 0.;
        let step = |i: i64| (z(i % w, i / w) - z(i % w - dx, i / w - dy)).abs();
        Spread::of((0..w * h).filter(both).map(step).collect()).median
    };
    let step = median(1, 0).max(median(0, 1));
    let jump = |a: f64, b: f64| (a - b).abs() > 40. * step + 1e-6 * a;
    let near = |x: i64, y: i64| {
        if x < BAND || y < BAND || x >= w - BAND || y >= h - BAND {
            return true;
        }
        (-BAND..=BAND).any(|dy| {
            (-BAND..=BAND).any(|dx| {
                let (i, j) = (x + dx, y + dy);
                z(i, j) == 0. || (dx, dy) != (0, 0) && jump(z(i, j), z(i - dx.signum(), j - dy.signum()))
            })
        })
    };
    (0..w * h).map(|i| near(i % w, i / w)).collect()
}

/// A shape from yaw, pitch, distance, by one estimator.
fn seen(text: &str, eye: [f64; 3], fov: f64, estimator: Curvature) -> Result<(ShapeSpec, Set), StressError> {
    let spec: ShapeSpec = text.parse()?;
    let mut set = Set::new(text, eye[2], settings(Method::Lambert, View::Curvature, SIZE))?;
    set.camera = Camera::orbit(eye[0], eye[1], eye[2], None, fov, &set.scene);
    set.settings.curvature = estimator;
    set.lights.clear();
    Ok((spec, set))
}

/// Figures of one shape: H outside and inside the band, K outside.
fn shape(bench: &Bench, text: &str, radius: f64, eye: [f64; 3], estimator: Curvature) -> Measured {
    let (spec, set) = seen(text, eye, 30., estimator)?;
    let l = look(bench, &spec, &set, radius)?;
    let mut wild = set.clone();
    wild.settings.curvature = Curvature::Vergne;
    let vergne = look(bench, &spec, &wild, radius)?;
    // Of a plane there is nothing that the rival gets wrong: there, the wrong input is a curvature of 1/r.
    let wild = if vergne.band.p99 > 1. { vergne.band.p99 } else { l.band.p99 + 1. };
    let k_off = l.gauss.p99 + 0.1;
    Ok(vec![
        Measure::new("r|dH| p99", l.out.p99, l.off.p99, format!("{}", l.out)),
        Measure::new("r|dH| rim p99", l.band.p99, wild, format!("{}", l.band)),
        Measure::new("r^2|dK| p99", l.gauss.p99, k_off, format!("{}", l.gauss)),
    ])
}

/// A plane; its unit is its size.
pub fn plane(bench: &Bench) -> Measured {
    shape(bench, "shape:plane", 200., [10., 40., 420.], Curvature::Fit)
}
/// A cube: flat faces, creases.
pub fn cube(bench: &Bench) -> Measured {
    shape(bench, "shape:cube:100", 100., [30., 25., 380.], Curvature::Fit)
}
/// A cylinder.
pub fn cylinder(bench: &Bench) -> Measured {
    shape(bench, "shape:cylinder:40", 40., [0., 20., 220.], Curvature::Fit)
}
/// A saddle.
pub fn saddle(bench: &Bench) -> Measured {
    shape(bench, "shape:saddle:50", 50., [25., 50., 480.], Curvature::Fit)
}
/// A torus.
pub fn torus(bench: &Bench) -> Measured {
    shape(bench, "shape:torus:70,25", 25., [0., 50., 420.], Curvature::Fit)
}
/// The same by the default estimator.
pub fn torus_metric(bench: &Bench) -> Measured {
    shape(bench, "shape:torus:70,25", 25., [0., 50., 420.], Curvature::Metric)
}
/// An ellipsoid; its sharpest bend has radius c^2 / a.
pub fn ellipsoid(bench: &Bench) -> Measured {
    shape(bench, "shape:ellipsoid:80,60,45", 45. * 45. / 80., [30., 20., 380.], Curvature::Fit)
}

/// The worst of several looks at a sphere.
fn worst(bench: &Bench, shots: &[(String, f64, Set)]) -> Measured {
    let (mut figure, mut wrong, mut text) = (0f64, f64::INFINITY, String::new());
    for (name, r, set) in shots {
        let l = look(bench, &ShapeSpec::Sphere { r: *r }, set, *r)?;
        let p99 = if l.out.p99.is_nan() { f64::INFINITY } else { l.out.p99 };
        (figure, wrong) = (figure.max(p99), wrong.min(l.off.p99));
        text.push_str(&format!("{name} {:.1e} ", l.out.p99));
    }
    Ok(vec![Measure::new("|H r - 1| p99", figure, wrong, text.trim_end())])
}

/// Spheres of 1e-3 to 1e6 mm, the eye in proportion.
pub fn scales(bench: &Bench) -> Measured {
    let shots: Result<Vec<_>, StressError> = (-3..=6)
        .map(|e| {
            let r = 10f64.powi(e);
            let (_, set) = seen(&format!("shape:sphere:{r}"), [0., 0., 5. * r], 30., Curvature::Fit)?;
            Ok((format!("1e{e}"), r, set))
        })
        .collect();
    worst(bench, &shots?)
}

/// Vertical fields of view of 1 to 170 degrees, and a parallel view; the sphere's size on the screen kept.
pub fn fields(bench: &Bench) -> Measured {
    let mut shots = Vec::new();
    for fov in [1f64, 10., 60., 120., 150., 170.] {
        // Its rim at two thirds of the way to the edge of the picture.
        let across = (fov / 2.).to_radians().tan() * 0.66;
        let distance = 60. * (1. + across * across).sqrt() / across;
        let (_, set) = seen("shape:sphere:60", [0., 0., distance], fov, Curvature::Fit)?;
        shots.push((format!("{fov}"), 60., set));
    }
    let (_, mut set) = seen("shape:sphere:60", [0., 0., 300.], 30., Curvature::Fit)?;
    set.camera = set.camera.clone().with_orthographic(180., &set.scene);
    shots.push(("parallel".to_owned(), 60., set));
    worst(bench, &shots)
}

/// A sphere of 1 mm close to the eye and one of 1e8 mm far behind it, in one scene, then each alone in the same view.
pub fn range(bench: &Bench) -> Measured {
    let (spec, mut set) = seen("shape:sphere:1", [0., 0., 8.], 60., Curvature::Fit)?;
    let mut scene = (*set.scene).clone();
    let far = crate::scene::Scene::shape("shape:sphere:1e8")?;
    let first = scene.positions.len() as u32;
    // It stands behind, and to the side, where the small one does not hide it.
    let place = DVec3::new(1.5e8, 0., -4e8);
    scene
        .positions
        .extend(far.positions.iter().map(|p| (DVec3::from_array(p.map(f64::from)) + place).as_vec3().to_array()));
    scene.normals.extend(&far.normals);
    scene.uvs.extend(&far.uvs);
    scene.indices.extend(far.indices.iter().map(|i| i + first));
    scene.draws[0].index_count = scene.indices.len() as u32;
    scene.bounds = crate::scene::Aabb::around(&scene.positions);
    set.scene = std::sync::Arc::new(scene);
    set.camera.near_mm = 1e-6;
    let position = set.seeing(View::Position).linear(bench)?;
    let got = set.linear(bench)?;
    let rim = silhouette(&set.seeing(View::Depth).linear(bench)?);
    let (mut near_errors, mut far_errors, mut off) = (Vec::new(), Vec::new(), Vec::new());
    for at in position.covered().filter(|at| !rim[*at]) {
        let z = position.texels[at][2];
        let (list, r) = if z < -1e6 { (&mut far_errors, 1e8) } else { (&mut near_errors, 1.) };
        let h = f64::from(got.texels[at][0]) * r;
        list.push((h - 1.).abs());
        off.push((1.02 * h - 1.).abs());
    }
    let _ = spec;
    let (near, far) = (Spread::of(near_errors), Spread::of(far_errors));
    let text = format!("near: {near}; far: {far}");
    Ok(vec![Measure::new("|H r - 1| p99", near.p99.max(far.p99), Spread::of(off).p99, text)])
}

/// From a pixel across to a hundred screens across: the mean of H.
pub fn distances(bench: &Bench) -> Measured {
    let (mut figure, mut wrong, mut text) = (0f64, f64::INFINITY, String::new());
    for screens in [0.2, 1., 10., 100.] {
        // A sphere of 20 mm; the picture is 40 / screens mm high where it is nearest.
        let height = 40. / screens;
        let distance = 20. + height / (2. * 15f64.to_radians().tan());
        let (spec, set) = seen("shape:sphere:20", [10., 20., distance], 30., Curvature::Fit)?;
        let l = look(bench, &spec, &set, 20.)?;
        let bias = if l.bias.is_nan() { f64::INFINITY } else { l.bias.abs() };
        (figure, wrong) = (figure.max(bias), wrong.min((1.02 * (1. + l.bias) - 1.).abs()));
        text.push_str(&format!("{screens}: mean {:+.1e} p99 {:.1e}; ", l.bias, l.out.p99));
    }
    Ok(vec![Measure::new("|mean H r - 1|", figure, wrong, text.trim_end_matches("; "))])
}

/// A sphere of radius 60, ray cast in f64, with normals rounded to octahedral coordinates of so many bits.
fn cast(bits: Option<u32>) -> GBuffer {
    let (width, height, distance, r) = (160usize, 120usize, 300., 60.);
    let scale = 2. * 15f64.to_radians().tan() / height as f64;
    let camera = twin::Camera {
        ray_scale: [scale, -scale],
        ray_offset: [-0.5 * width as f64 * scale, 0.5 * height as f64 * scale],
        perspective: true,
    };
    let mut g =
        GBuffer { width, height, z: vec![0.; width * height], normal: vec![[0., 0., 1.]; width * height], camera };
    for at in 0..width * height {
        let x = scale * ((at % width) as f64 + 0.5) + camera.ray_offset[0];
        let y = -scale * ((at / width) as f64 + 0.5) + camera.ray_offset[1];
        let a = x * x + y * y + 1.;
        let root = distance * distance - a * (distance * distance - r * r);
        if root > 0. {
            let z = (distance - root.sqrt()) / a;
            let n = DVec3::new(x * z, y * z, distance - z) / r;
            g.z[at] = z;
            g.normal[at] = bits.map_or(n, |b| octahedral(n, f64::from((1u32 << (b - 1)) - 1))).to_array();
        }
    }
    g
}

/// Rounded to so many steps of an octahedral coordinate.
pub fn octahedral(n: DVec3, steps: f64) -> DVec3 {
    let fold = |x: f64, y: f64| ((1. - y.abs()).copysign(x), (1. - x.abs()).copysign(y));
    let n = n / n.abs().element_sum();
    let (x, y) = if n.z < 0. { fold(n.x, n.y) } else { (n.x, n.y) };
    let (x, y) = ((x * steps).round() / steps, (y * steps).round() / steps);
    let z = 1. - x.abs() - y.abs();
    let (x, y) = if z < 0. { fold(x, y) } else { (x, y) };
    DVec3::new(x, y, z).normalize()
}

/// rms of H on that sphere, less that of exact normals, in units of q / 2s.
fn noise(bits: u32, estimator: Estimator) -> f64 {
    let rms = |g: &GBuffer| {
        let c = twin::estimate(estimator, g);
        let mut sum = (0., 0.);
        for (at, c) in c.iter().enumerate() {
            // The middle, where the footprint is that of the facing surface.
            if g.normal[at][2] > 0.8 && g.z[at] > 0. {
                sum = (sum.0 + (c.h - 1. / 60.).powi(2), sum.1 + 1.);
            }
        }
        (sum.0 / sum.1).sqrt()
    };
    let g = cast(Some(bits));
    let step = 2f64.powi(1 - bits as i32);
    let footprint = g.camera.footprint(245.);
    (rms(&g).powi(2) - rms(&cast(None)).powi(2)).max(0.).sqrt() / (step / (2. * footprint))
}

/// Normals in 8, 10 and 16 bit: noise in H in units of q / 2s is one number, whatever the format.
pub fn formats(_: &Bench) -> Measured {
    let mut all = Vec::new();
    for (quantity, estimator) in [("metric: spread", Estimator::Metric), ("fit: spread", Estimator::Fit)] {
        let n = [8, 10, 16].map(|b| noise(b, estimator));
        let ratio = |n: [f64; 3]| {
            n.iter().fold(0., |m: f64, x| m.max(*x)) / n.iter().fold(f64::INFINITY, |m: f64, x| m.min(*x))
        };
        let text = format!("rms dH 2s/q: 8 bit {:.3}, 10 bit {:.3}, 16 bit {:.3}", n[0], n[1], n[2]);
        // The law of another power, q^2 / 2s.
        let wrong = ratio([n[0], n[1] / 4., n[2] / 256.]);
        all.push(Measure::new(quantity, ratio(n), wrong, text));
    }
    Ok(all)
}

/// f32 against f64: the estimators' text in both, on the same stored numbers.
pub fn precision(_: &Bench) -> Measured {
    let g = cast(Some(16));
    let mut all = Vec::new();
    let quantities = ["vergne", "trace", "metric", "fit"];
    for (quantity, estimator) in quantities.into_iter().zip(Estimator::ALL) {
        let (wide, narrow) = (twin::estimate(estimator, &g), twin::estimate_f32(estimator, &g));
        let inner = |at: &usize| g.z[*at] > 0. && g.normal[*at][2] > 0.3;
        let error = |f: f64| {
            let one = |at: usize| (narrow[at].h * f - wide[at].h).abs() * g.camera.footprint(g.z[at]);
            Spread::of((0..g.z.len()).filter(inner).map(one).collect())
        };
        let s = error(1.);
        all.push(Measure::new(quantity, s.max, error(1.02).max, format!("|dH| q: {s}")));
    }
    Ok(all)
}

/// What the formats of normals, levels and light lose, over their whole range.
pub fn storage(_: &Bench) -> Measured {
    let directions: Vec<DVec3> = (0..20_000)
        .map(|i| {
            let z = 1. - 2. * (f64::from(i) + 0.5) / 20_000.;
            let (s, c) = (2.399_963_229_728_653 * f64::from(i)).sin_cos();
            let r = (1. - z * z).sqrt();
            DVec3::new(r * c, r * s, z)
        })
        .collect();
    // The sine tells small angles apart, the arc cosine does not.
    let angle =
        |decode: &dyn Fn(DVec3) -> DVec3| directions.iter().map(|n| n.cross(decode(*n)).length()).fold(0., f64::max);
    let coded = |n: DVec3| DVec3::from_array(code::decode(code::encode(n.to_array())));
    let [mut normal, mut bend, mut light] = [0f64; 3];
    for (i, n) in directions.iter().enumerate() {
        let part = i as f64 / 20_000.;
        // H times length over the half's normal range.
        let h = 10f64.powf(part * 8.8 - 4.2);
        let t = Texel { n: (*n * 0.9).to_array(), h, confidence: 1., lit: [0.; 2] }.stored();
        normal = normal.max((DVec3::from_array(t.n) - *n * 0.9).abs().max_element());
        bend = bend.max((t.h / h - 1.).abs());
        // Light in its unit, which keeps it below 4096.
        let l = 10f64.powf(part * 7.8 - 4.2);
        light = light.max((half::f16::from_f64(l).to_f64() / l - 1.).abs());
    }
    Ok(vec![
        Measure::new(
            "oct-16: angle, rad",
            angle(&coded),
            angle(&|n| octahedral(n, 16383.)),
            "at most sqrt(18) half steps, in the middle of a face; wrong: a bit less",
        ),
        Measure::new("level: |dn|", normal, 2. * normal, "three snorm16; wrong: a bit less"),
        Measure::new("level: dH, relative", bend, 2. * bend, "a half, 6e-5 .. 4e4"),
        Measure::new("light: relative", light, 2. * light, "a half, 6e-5 .. 4e3"),
    ])
}
