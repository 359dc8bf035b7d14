//! Animations, skins and morph targets against their formulas in f64.

use glam::{DMat4, DQuat, DVec3, Vec3};
use pdss::scene::{LoadOptions, Pose, Scene, vertex_curvature};
use serde_json::{Value, json};

use crate::check::assert_sound;
use crate::fixture::{Fixture, SQUARE, add_attribute, add_bytes, bytes_of, square};

/// Adds an accessor of floats and returns its index.
fn add(document: &mut Value, kind: &str, count: usize, floats: &[f32]) -> usize {
    add_bytes(document, kind, 5126, count, &bytes_of(floats))
}

/// Adds animation 0: one channel of node 0.
fn animate(document: &mut Value, path: &str, kind: &str, interpolation: &str, times: &[f32], values: &[f32]) {
    let width = if kind == "SCALAR" { 1 } else { kind[3..].parse().unwrap() };
    let input = add(document, "SCALAR", times.len(), times);
    let output = add(document, kind, values.len() / width, values);
    document["animations"] = json!([{
        "samplers": [{"input": input, "output": output, "interpolation": interpolation}],
        "channels": [{"sampler": 0, "target": {"node": 0, "path": path}}],
    }]);
}

fn at(document: &Value, time: f64) -> Scene {
    let options = LoadOptions { pose: Some(Pose { animation: 0, time }), ..LoadOptions::default() };
    let scene = Fixture::new().load_with(document, &options).unwrap();
    assert_sound(&scene);
    scene
}

/// Stored positions in the world, metres.
fn world(scene: &Scene) -> Vec<DVec3> {
    let place = |p: &[f32; 3]| (Vec3::from(*p).as_dvec3() + scene.origin) / 1000.0;
    scene.positions.iter().map(place).collect()
}

#[track_caller]
fn assert_places(scene: &Scene, expected: impl Fn(DVec3) -> DVec3) {
    let corners = SQUARE.chunks(3).map(|p| expected(Vec3::from_slice(p).as_dvec3()));
    for (found, expected) in world(scene).into_iter().zip(corners) {
        assert!((found - expected).length() < 1e-6, "{found} where {expected} should be");
    }
}

#[test]
fn keys_are_held_joined_by_lines_and_by_cubics() {
    let times = [1.0, 3.0, 4.0];
    let mut linear = square();
    animate(&mut linear, "translation", "VEC3", "LINEAR", &times, &[0., 0., 0., 4., 2., 0., 4., 2., 8.]);
    for (time, place) in
        [(0.0, [0., 0., 0.]), (1.5, [1., 0.5, 0.]), (3.0, [4., 2., 0.]), (3.75, [4., 2., 6.]), (99.0, [4., 2., 8.])]
    {
        assert_places(&at(&linear, time), |p| p + DVec3::from(place));
    }
    let mut step = linear.clone();
    step["animations"][0]["samplers"][0]["interpolation"] = json!("STEP");
    assert_places(&at(&step, 2.999), |p| p);
    assert_places(&at(&step, 3.0), |p| p + DVec3::new(4., 2., 0.));
    // A cubic and its own slopes: any polynomial of degree three is met between keys too.
    let curve = |t: f64| DVec3::new(t * t * t - 2.0 * t, 1.0 + t * t, -t);
    let slope = |t: f64| DVec3::new(3.0 * t * t - 2.0, 2.0 * t, -1.0);
    let keys = times.iter().flat_map(|t| {
        let t = f64::from(*t);
        [slope(t), curve(t), slope(t)].map(|v| v.as_vec3().to_array()).concat()
    });
    let mut cubic = square();
    animate(&mut cubic, "translation", "VEC3", "CUBICSPLINE", &times, &keys.collect::<Vec<_>>());
    for time in [1.0, 1.3, 2.9, 3.5, 4.0] {
        assert_places(&at(&cubic, time), |p| p + curve(time));
    }
    assert!((curve(2.0) - curve(1.0).midpoint(curve(3.0))).length() > 1.0, "a line between keys would pass");
}

#[test]
fn rotations_turn_at_an_even_pace_along_the_shorter_arc() {
    let axis = DVec3::new(1., 2., -2.) / 3.0;
    let end = -DQuat::from_axis_angle(axis, 2.4);
    let values: Vec<f32> = [DQuat::IDENTITY, end].iter().flat_map(|q| q.as_quat().to_array()).collect();
    let mut document = square();
    animate(&mut document, "rotation", "VEC4", "LINEAR", &[0.0, 1.0], &values);
    for time in [0.25, 0.5, 0.9] {
        // The sign of a quaternion does not matter; its way to the other does: 2.4 radians, not 2 pi - 2.4.
        let turn = DQuat::from_axis_angle(axis, 2.4 * time);
        assert_places(&at(&document, time), |p| turn * p);
    }
}

#[test]
fn morph_targets_add_up_and_curvature_follows() {
    let mut document = square();
    let bulge: Vec<f32> = (0..12).map(|i| if i % 3 == 2 { 0.5 } else { 0.0 }).collect();
    let shear: Vec<f32> = SQUARE.chunks(3).flat_map(|p| [p[1], 0., 0.]).collect();
    let targets = [add(&mut document, "VEC3", 4, &bulge), add(&mut document, "VEC3", 4, &shear)];
    document["meshes"][0]["primitives"][0]["targets"] = json!(targets.map(|t| json!({"POSITION": t})));
    document["meshes"][0]["weights"] = json!([2.0, 0.0]);
    assert_places(&Fixture::new().load(&document).unwrap(), |p| p + DVec3::Z);
    document["nodes"][0]["weights"] = json!([0.0, -1.0]);
    assert_places(&Fixture::new().load(&document).unwrap(), |p| DVec3::new(p.x - p.y, p.y, 0.0));
    animate(&mut document, "weights", "SCALAR", "LINEAR", &[0.0, 1.0], &[0., 0., 1., 2.]);
    assert_places(&at(&document, 0.5), |p| DVec3::new(p.x + p.y, p.y, 0.25));

    // A sphere of a metre swells: its curvature falls with it.
    let sphere = Scene::shape("shape:sphere:1000").unwrap();
    let unit: Vec<f32> = sphere.normals.iter().flatten().copied().collect();
    let count = sphere.normals.len();
    let indices: Vec<u8> = sphere.indices.iter().flat_map(|i| i.to_le_bytes()).collect();
    let mut document = square();
    let position = add(&mut document, "VEC3", count, &unit);
    let index = add_bytes(&mut document, "SCALAR", 5125, sphere.indices.len(), &indices);
    document["meshes"][0] = json!({"weights": [0.0], "primitives": [{
        "attributes": {"POSITION": position, "NORMAL": position}, "indices": index, "targets": [{"POSITION": position}],
    }]});
    for weight in [0.0, 1.5] {
        document["nodes"][0]["weights"] = json!([weight]);
        let mut bends = vertex_curvature(&Fixture::new().load(&document).unwrap());
        bends.sort_by(f32::total_cmp);
        let expected = 1.0 / (1000.0 * (1.0 + weight));
        let middle = f64::from(bends[bends.len() / 2]);
        assert!((middle / expected - 1.0).abs() < 0.01, "{middle} where {expected} should be");
    }
}

/// Two joints, the second 60 cm up and turned: corners below follow the first, above the second, half way both.
#[test]
fn skins_blend_the_joints_matrices() {
    let turn = DQuat::from_rotation_x(0.7);
    let joint = DVec3::new(0.0, 0.6, 0.0);
    let mut document = square();
    let floats = |m: DMat4| m.as_mat4().to_cols_array();
    // Bound where the joint stands unturned.
    let binds = [floats(DMat4::IDENTITY), floats(DMat4::from_translation(-joint))].concat();
    let binds = add(&mut document, "MAT4", 2, &binds);
    document["nodes"] = json!([
        // A skinned node's own transform does not matter.
        {"mesh": 0, "skin": 0, "translation": [50, 60, 70], "scale": [3, 3, 3]},
        {"children": [2]},
        {"translation": joint.to_array(), "rotation": turn.to_array()},
    ]);
    document["scenes"] = json!([{"nodes": [0, 1]}]);
    document["skins"] = json!([{"joints": [1, 2], "inverseBindMatrices": binds}]);
    let upper = [0.0, 0.5, 1.0, 1.0];
    let weights: Vec<f32> = upper.iter().flat_map(|w| [1.0 - w, *w, 0., 0.]).collect();
    add_attribute(&mut document, "WEIGHTS_0", "VEC4", &weights);
    add_attribute(&mut document, "NORMAL", "VEC3", &[0., 0., 1.].repeat(4));
    let joints = add_bytes(&mut document, "VEC4", 5121, 4, &[0, 1, 0, 0].repeat(4));
    document["meshes"][0]["primitives"][0]["attributes"]["JOINTS_0"] = json!(joints);
    let scene = Fixture::new().load(&document).unwrap();
    assert_sound(&scene);
    let moved = |p: DVec3| joint + turn * (p - joint);
    for (i, found) in world(&scene).into_iter().enumerate() {
        let p = Vec3::from_slice(&SQUARE[3 * i..]).as_dvec3();
        let (part, expected) = (f64::from(upper[i]), p.lerp(moved(p), f64::from(upper[i])));
        assert!((found - expected).length() < 1e-6, "{found} where {expected} should be");
        if part == 1.0 {
            let normal = Vec3::from(scene.normals[i]).as_dvec3();
            assert!((normal - turn * DVec3::Z).length() < 1e-6, "{normal}");
        }
    }
    // A joint that is not there is said, with its place.
    let wrong = add_bytes(&mut document, "VEC4", 5121, 4, &[0, 7, 0, 0].repeat(4));
    document["meshes"][0]["primitives"][0]["attributes"]["JOINTS_0"] = json!(wrong);
    let line = Fixture::new().refusal(&document);
    assert!(line.contains("meshes[0].primitives[0]: joint 7 of vertex 1 is out of range"), "{line}");
}

#[test]
fn what_cannot_move_is_said() {
    let mut document = square();
    animate(&mut document, "translation", "VEC3", "LINEAR", &[0.0, 1.0], &[0.; 6]);
    let refusal = |document: &Value, animation: usize| {
        let options = LoadOptions { pose: Some(Pose { animation, time: 0.5 }), ..LoadOptions::default() };
        Fixture::new().load_with(document, &options).expect_err("it must be refused").to_string()
    };
    assert!(refusal(&document, 3).contains("animations: 3 is out of range; the file has 1"));
    let with = |change: &dyn Fn(&mut Value)| {
        let mut changed = document.clone();
        change(&mut changed);
        refusal(&changed, 0)
    };
    let line = with(&|d| d["animations"][0]["samplers"][0]["interpolation"] = json!("CUBICSPLINE"));
    assert!(line.contains("animations[0].samplers[0]: 2 values for 2 keys"), "{line}");
    let line = with(&|d| d["animations"][0]["channels"][0]["target"]["path"] = json!("colour"));
    assert!(line.contains("'colour' cannot move"), "{line}");
    // Times that do not rise.
    let line = with(&|d| d["animations"][0]["samplers"][0]["input"] = json!(1));
    assert!(line.contains("samplers[0].input: times must be floats, finite and rising"), "{line}");
}
