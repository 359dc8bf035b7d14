//! Built-in shapes against their formulas.

use glam::{DVec3, Vec3};
use pdss::scene::{LoadOptions, Scene, ShapeSpec, shape_curvature, shape_normal, vertex_curvature};

use crate::check::{SHAPES, assert_sound, built};
use crate::fixture::area;

/// The surface as a function that is zero on it, its sign positive outside, for all but plane and cube; mm near it.
fn distance(spec: &ShapeSpec, p: DVec3) -> f64 {
    match *spec {
        ShapeSpec::Sphere { r } => p.length() - r,
        ShapeSpec::Cylinder { r } => p.x.hypot(p.z) - r,
        ShapeSpec::Torus { major, minor } => (p.x.hypot(p.z) - major).hypot(p.y) - minor,
        ShapeSpec::Saddle { a } => p.y - (p.x * p.x - p.z * p.z) / (2.0 * a),
        ShapeSpec::Ellipsoid { a, b, c } => ((p / DVec3::new(a, b, c)).length_squared() - 1.0) * a.min(b).min(c) / 2.0,
        ShapeSpec::Plane => p.y,
        ShapeSpec::Cube { a } => p.abs().max_element() - a / 2.0,
    }
}

#[test]
fn shapes_lie_on_their_surfaces() {
    for name in SHAPES {
        let (scene, spec) = built(name);
        assert_sound(&scene);
        assert_eq!(scene.uvs.len(), scene.positions.len(), "{name}");
        assert!(scene.uvs.as_flattened().iter().all(|x| (0.0..=1.0).contains(x)), "{name}");
        let (_, agree) = area(&scene);
        assert!(agree, "{name}: winding against normals");
        let size = f64::from(scene.bounds.size().max_element());
        let cap = |n: &[f32; 3]| matches!(spec, ShapeSpec::Cylinder { .. }) && n[1] != 0.0;
        for (p, n) in scene.positions.iter().zip(&scene.normals) {
            let at = Vec3::from(*p).as_dvec3();
            if !cap(n) {
                assert!(distance(&spec, at).abs() < 1e-6 * size, "{name} {at}");
            }
        }
        // Chords: the middle of every edge stays within 1e-4 of the size.
        for t in scene.indices.chunks(3) {
            let [a, b] = [t[0], t[1]].map(|i| Vec3::from(scene.positions[i as usize]).as_dvec3());
            if t.iter().all(|&i| !cap(&scene.normals[i as usize])) {
                assert!(distance(&spec, a.midpoint(b)).abs() < 5e-5 * size, "{name}");
            }
        }
    }
    let (torus, _) = built("torus:70,25");
    assert_eq!(torus.triangle_count(), 102_400);
    assert!((torus.bounds.size() - Vec3::new(190.0, 50.0, 190.0)).length() < 1e-3);
}

#[test]
fn closed_shapes_are_watertight_and_have_their_area() {
    use std::collections::HashMap;
    let pi = std::f64::consts::PI;
    let expected = [
        ("sphere:10", 400.0 * pi),
        ("cylinder:10", 2.0 * pi * 10.0 * 200.0 + 2.0 * pi * 100.0),
        ("torus:10,4", 4.0 * pi * pi * 40.0),
        ("cube:10", 600.0),
        ("ellipsoid:10,10,10", 400.0 * pi),
    ];
    for (name, mm2) in expected {
        let (scene, _) = built(name);
        let (got, _) = area(&scene);
        assert!((got / mm2 - 1.0).abs() < 1e-3, "{name}: {got} for {mm2}");
        // Each directed edge, by position, has exactly one partner that runs back.
        let place = |i: u32| scene.positions[i as usize].map(|x| (x + 0.0).to_bits());
        let mut edges: HashMap<_, i32> = HashMap::new();
        for t in scene.indices.chunks(3) {
            for k in 0..3 {
                let (a, b) = (place(t[k]), place(t[(k + 1) % 3]));
                *edges.entry((a.min(b), a.max(b))).or_default() += if a < b { 1 } else { -1 };
            }
        }
        assert!(edges.values().all(|&sum| sum == 0), "{name}: the seams are open");
    }
}

#[test]
fn spheres_have_no_poles() {
    let (scene, _) = built("sphere");
    let areas = scene.indices.chunks(3).map(|t| {
        let p = [0, 1, 2].map(|k| Vec3::from(scene.positions[t[k] as usize]));
        (p[1] - p[0]).cross(p[2] - p[0]).length()
    });
    let (least, most) = areas.fold((f32::MAX, 0.0f32), |(l, m), a| (l.min(a), m.max(a)));
    assert!(most < 2.0 * least, "{least}..{most}");
}

/// H and K from the divergence and the Jacobian of the unit normal of an offset-free field, by central differences.
fn measured_curvature(spec: &ShapeSpec, p: DVec3) -> (f64, f64) {
    let step = 1e-5 * p.length();
    let normal = |q: DVec3| {
        let d = |axis: DVec3| distance(spec, q + axis * step) - distance(spec, q - axis * step);
        DVec3::new(d(DVec3::X), d(DVec3::Y), d(DVec3::Z)).normalize()
    };
    let (u, v) = normal(p).any_orthonormal_pair();
    let wide = 1e-3 * p.length();
    let along = |t: DVec3| (normal(p + t * wide) - normal(p - t * wide)) / (2.0 * wide);
    let (du, dv) = (along(u), along(v));
    let (a, b, c, d) = (du.dot(u), du.dot(v), dv.dot(u), dv.dot(v));
    ((a + d) / 2.0, a * d - b * c)
}

#[test]
fn shape_truths_agree_with_differences() {
    for name in ["sphere:3", "cylinder:7", "torus:70,25", "saddle:40", "ellipsoid:60,40,30"] {
        let (scene, spec) = built(name);
        for (p, n) in scene.positions.iter().zip(&scene.normals).step_by(997) {
            let p = Vec3::from(*p).as_dvec3();
            if matches!(spec, ShapeSpec::Cylinder { .. }) && n[1] != 0.0 {
                assert_eq!(shape_curvature(&spec, p * DVec3::new(0.5, 1.0, 0.5)), (0.0, 0.0));
                continue;
            }
            let ((h, k), (h2, k2)) = (shape_curvature(&spec, p), measured_curvature(&spec, p));
            let scale = h.abs().max(k.abs().sqrt());
            assert!((h - h2).abs() < 1e-3 * scale, "{name} {p}: H {h}, measured {h2}");
            assert!((k - k2).abs() < 2e-3 * scale * scale, "{name} {p}: K {k}, measured {k2}");
            let off = (shape_normal(&spec, p) - Vec3::from(*n).as_dvec3()).length();
            assert!(off < 1e-5, "{name} {p}: normal {off}");
        }
    }
    let sphere = ShapeSpec::Sphere { r: 4.0 };
    assert_eq!(shape_curvature(&sphere, DVec3::X * 4.0), (0.25, 0.0625));
}

#[test]
fn shapes_of_every_size_and_no_other_text() {
    for r in ["1e-3", "1", "1e6"] {
        assert_sound(&built(&format!("sphere:{r}")).0);
    }
    for (text, expected) in [
        ("shape:teapot", "there is no shape 'teapot'"),
        ("shape:", "there is no shape ''"),
        ("shape:sphere:x", "'x' is not a size"),
        ("shape:sphere:0", "0 mm is outside"),
        ("shape:sphere:-1", "-1 mm is outside"),
        ("shape:sphere:nan", "NaN mm is outside"),
        ("shape:sphere:1,2", "2 sizes given where sphere has 1"),
        ("shape:plane:3", "1 sizes given where plane has 0"),
        ("shape:torus:5,5", "cuts itself"),
        ("shape:torus:5", "1 sizes given where torus has 2"),
    ] {
        let line = Scene::open(text, &LoadOptions::default()).unwrap_err().to_string();
        assert!(line.starts_with(text) && line.contains(expected), "{line}");
    }
}

/// Largest |curvature - of(vertex)| over the mesh, relative.
fn bend_apart(scene: &Scene, of: impl Fn(DVec3) -> f64) -> f64 {
    let apart = |(p, k): (&[f32; 3], f32)| (f64::from(k) / of(Vec3::from(*p).as_dvec3()) - 1.0).abs();
    scene.positions.iter().zip(vertex_curvature(scene)).map(apart).fold(0.0, f64::max)
}

#[test]
fn the_mesh_knows_its_curvature() {
    let (sphere, _) = built("sphere:20");
    let on_sphere = bend_apart(&sphere, |_| 1.0 / 20.0);
    // On a torus edges run along both principal directions: 1/r, and |cos t| / (R + r cos t) around the hole.
    let (torus, _) = built("torus:70,25");
    let around = |p: DVec3| {
        let radius = p.x.hypot(p.z);
        ((radius - 70.0) / 25.0).abs() / radius
    };
    let on_torus = bend_apart(&torus, |p| (1.0 / 25.0 + around(p)) / 2.0);
    let wrong = bend_apart(&torus, |_| 1.0 / 25.0);
    let (plane, _) = built("plane");
    println!("sphere {on_sphere:.1e}, torus {on_torus:.1e}, torus as a cylinder {wrong:.1e}");
    // The least edge of a vertex is a diagonal where |cos t| changes sign; smoothing blurs that kink.
    assert!(on_sphere < 1e-3 && on_torus < 0.05 && wrong > 0.2);
    assert!(vertex_curvature(&plane).iter().all(|k| *k == 0.0));
}
