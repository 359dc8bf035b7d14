//! Triangles, transforms, materials: files made here.

use glam::{DVec3, Vec3};
use pdss::scene::LoadOptions;
use serde_json::{Value, json};

use crate::check::assert_sound;
use crate::fixture::{Fixture, SQUARE, add_attribute, add_bytes, area, base64, bytes_of, square};

#[test]
fn a_square_becomes_millimetres_around_its_middle() {
    let scene = Fixture::new().load(&square()).unwrap();
    assert_sound(&scene);
    assert_eq!(scene.name, "made");
    assert_eq!(scene.origin, DVec3::new(500.0, 500.0, 0.0));
    assert_eq!(scene.bounds.size(), Vec3::new(1000.0, 1000.0, 0.0));
    assert!(scene.normals.iter().all(|&n| n == [0.0, 0.0, 1.0]));
    assert!(scene.uvs.is_empty() && scene.tangents.is_empty() && scene.textures.is_empty());
    assert_eq!(scene.warnings, ["4 vertices without normals; smooth ones were made"]);
}

#[test]
fn the_unit_is_the_callers() {
    let made = Fixture::new();
    for mm in [1e-4, 0.05, 1.0, 1e7] {
        let options = LoadOptions { mm_per_unit: Some(mm), ..LoadOptions::default() };
        let mut document = square();
        // The node undoes the unit: the real size is the same.
        document["nodes"][0]["scale"] = json!([1.0 / mm, 1.0 / mm, 1.0 / mm]);
        let scene = made.load_with(&document, &options).unwrap();
        assert_sound(&scene);
        assert_eq!(scene.bounds.size(), Vec3::new(1.0, 1.0, 0.0), "{mm}");
    }
    for mm in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let options = LoadOptions { mm_per_unit: Some(mm), ..LoadOptions::default() };
        assert!(made.load_with(&square(), &options).is_err());
    }
}

#[test]
fn positions_far_away_stay_exact() {
    let mut document = square();
    document["nodes"][0]["translation"] = json!([1e7, -3e7, 5e6]);
    let scene = Fixture::new().load(&document).unwrap();
    assert_eq!(scene.bounds.size(), Vec3::new(1000.0, 1000.0, 0.0));
    assert_eq!(scene.origin, DVec3::new(1e10 + 500.0, -3e10 + 500.0, 5e9));
}

#[test]
fn transforms_keep_fronts_in_front() {
    let made = Fixture::new();
    for (scale, factor) in [([-1., 1., 1.], 1.0), ([-2., -3., -1.], 6.0), ([1e-4, 1e-4, 1e-4], 1e-8)] {
        let mut document = square();
        document["nodes"][0]["scale"] = json!(scale);
        document["nodes"][0]["rotation"] = json!([0.5, 0.5, 0.5, 0.5]);
        let scene = made.load(&document).unwrap();
        assert_sound(&scene);
        let (mm2, agree) = area(&scene);
        assert!(agree, "{scale:?}");
        assert!((mm2 / (1e6 * factor) - 1.0).abs() < 1e-5, "{mm2}");
    }
    let mut flat = square();
    flat["nodes"][0]["scale"] = json!([1.0, 0.0, 1.0]);
    let scene = made.load(&flat).unwrap();
    assert_sound(&scene);
    assert_eq!(scene.triangle_count(), 0);
    assert!(scene.warnings.iter().any(|w| w.starts_with("2 triangles without area")));
}

#[test]
fn normals_take_the_inverse_transpose() {
    // A square tilted 45 degrees by its normals, stretched twice along x.
    let mut document = square();
    let tilted = [1.0f32, 0.0, 1.0].map(|x| x * 0.5f32.sqrt()).repeat(4);
    add_attribute(&mut document, "NORMAL", "VEC3", &tilted);
    document["nodes"][0]["scale"] = json!([2.0, 1.0, 1.0]);
    let scene = Fixture::new().load(&document).unwrap();
    let expected = Vec3::new(0.5, 0.0, 1.0).normalize();
    assert!(scene.normals.iter().all(|&n| (Vec3::from(n) - expected).length() < 1e-6));
    assert!(scene.warnings.is_empty());
}

#[test]
fn bad_normals_are_replaced_and_counted() {
    let mut document = square();
    let normals = [0., 0., 0., f32::NAN, 0., 1., 0., 0., 3., 0., 0., 1.];
    add_attribute(&mut document, "NORMAL", "VEC3", &normals);
    let scene = Fixture::new().load(&document).unwrap();
    assert_sound(&scene);
    assert!(scene.normals.iter().all(|&n| n == [0.0, 0.0, 1.0]));
    let expected = ["2 normals zero or not finite; smooth ones were made", "1 normals not of unit length, scaled"];
    assert_eq!(scene.warnings, expected);
}

#[test]
fn damaged_triangles_are_dropped_and_counted() {
    let mut document = square();
    let mut bytes = bytes_of(&[0., 0., 0., 1., 0., 0., 0., 1., 0., f32::INFINITY, 1., 0.]);
    // Good, its repetition (turned), without area, with a corner at infinity, two left over.
    bytes.extend([0u8, 1, 2, 1, 2, 0, 0, 1, 1, 1, 3, 2, 0, 1]);
    document["buffers"][0] = json!({"byteLength": bytes.len(), "uri": base64(&bytes)});
    document["bufferViews"][1]["byteLength"] = json!(14);
    document["accessors"][1]["count"] = json!(14);
    let scene = Fixture::new().load(&document).unwrap();
    assert_sound(&scene);
    assert_eq!((scene.triangle_count(), scene.positions.len()), (1, 3));
    for line in [
        "1 triangles with a corner that is not finite left out",
        "1 triangles without area left out",
        "1 repeated triangles left out",
        "2 vertices after the last whole triangle ignored",
    ] {
        assert!(scene.warnings.iter().any(|w| w == line), "{:?}", scene.warnings);
    }
}

#[test]
fn strips_and_fans_make_the_same_square() {
    let made = Fixture::new();
    for (mode, order) in [(5, [0u8, 1, 2, 3]), (6, [0, 1, 3, 2])] {
        let mut document = square();
        let mut bytes = bytes_of(&SQUARE);
        bytes.extend(order);
        document["buffers"][0] = json!({"byteLength": 52, "uri": base64(&bytes)});
        document["bufferViews"][1]["byteLength"] = json!(4);
        document["accessors"][1]["count"] = json!(4);
        document["meshes"][0]["primitives"][0]["mode"] = json!(mode);
        let scene = made.load(&document).unwrap();
        assert_eq!((scene.triangle_count(), area(&scene)), (2, (1e6, true)), "mode {mode}");
        assert!(scene.normals.iter().all(|n| n[2] == 1.0));
    }
}

#[test]
fn primitives_of_one_material_are_one_draw() {
    let mut document = square();
    document["materials"] = json!([{"name": "unused"}, {"name": "skin"}, {"name": "eye"}]);
    let primitive = document["meshes"][0]["primitives"][0].clone();
    let with = |material: Value| {
        let mut primitive = primitive.clone();
        primitive["material"] = material;
        primitive
    };
    document["meshes"][0]["primitives"] = json!([with(json!(2)), with(json!(1)), with(json!(2)), primitive]);
    let mut scene = Fixture::new().load(&document).unwrap();
    assert_sound(&scene);
    let names: Vec<_> = scene.materials.iter().map(|m| m.name.as_str()).collect();
    assert_eq!(names, ["skin", "eye", "default"]);
    let counts: Vec<_> = scene.draws.iter().map(|d| d.index_count).collect();
    assert_eq!(counts, [6, 12, 6]);

    // glTF's materials are metals unless they say otherwise; only the default one scatters unasked.
    scene.assign_profile(None, 4).unwrap();
    assert_eq!(scene.materials.iter().map(|m| m.scatter).collect::<Vec<_>>(), [None, None, Some(4)]);
    scene.assign_profile(Some("skin"), 2).unwrap();
    assert_eq!(scene.materials[0].scatter, Some(2));
    let line = scene.assign_profile(Some("hair"), 0).unwrap_err().to_string();
    assert_eq!(line, "no material is named 'hair'; the scene has 'skin', 'eye', 'default'");
}

#[test]
fn ten_thousand_nodes_in_one_chain() {
    let mut document = square();
    let node = |i: usize| json!({"mesh": 0, "children": [i + 1], "translation": [0, 0, 1]});
    let mut nodes: Vec<_> = (0..10_000).map(node).collect();
    nodes.push(json!({"name": "end"}));
    document["nodes"] = nodes.into();
    let scene = Fixture::new().load(&document).unwrap();
    assert_sound(&scene);
    assert_eq!(scene.triangle_count(), 20_000);
    assert_eq!(scene.bounds.size().z, 9_999_000.0);
}

#[test]
fn buffers_beside_the_file_may_have_spaces() {
    let made = Fixture::new();
    let mut bytes = bytes_of(&SQUARE);
    bytes.extend([0u8, 1, 2, 2, 1, 3]);
    std::fs::write(made.0.path().join("my buffer é.bin"), &bytes).unwrap();
    let mut document = square();
    for uri in ["my%20buffer%20%C3%A9.bin", "my buffer é.bin", "./my%20buffer é.bin"] {
        document["buffers"][0]["uri"] = json!(uri);
        assert_eq!(made.load(&document).unwrap().triangle_count(), 2);
    }
    document["buffers"][0]["uri"] = json!("my%2");
    assert!(made.refusal(&document).contains("without two hex digits"));
}

#[test]
fn indices_of_every_width_make_the_same_triangles() {
    let made = Fixture::new();
    let plain = made.load(&square()).unwrap();
    let indices = [0u32, 1, 2, 2, 1, 3];
    let wide: [(u32, Vec<u8>); 2] = [
        (5123, indices.iter().flat_map(|i| (*i as u16).to_le_bytes()).collect()),
        (5125, indices.iter().flat_map(|i| i.to_le_bytes()).collect()),
    ];
    for (component, bytes) in wide {
        let mut document = square();
        let index = add_bytes(&mut document, "SCALAR", component, 6, &bytes);
        document["meshes"][0]["primitives"][0]["indices"] = json!(index);
        let scene = made.load(&document).unwrap();
        assert_eq!((&scene.indices, &scene.positions), (&plain.indices, &plain.positions), "{component}");
    }
    let mut signed = square();
    let index = add_bytes(&mut signed, "SCALAR", 5122, 6, &[0; 12]);
    signed["meshes"][0]["primitives"][0]["indices"] = json!(index);
    assert!(made.refusal(&signed).contains("indices must be unsigned integers"));
}

#[test]
fn sparse_elements_replace_and_quantised_ones_are_scaled() {
    let made = Fixture::new();
    let world = |scene: &pdss::scene::Scene| {
        let place = |p: &[f32; 3]| (Vec3::from(*p).as_dvec3() + scene.origin) / 1000.0;
        scene.positions.iter().map(place).collect::<Vec<_>>()
    };
    let mut sparse = square();
    let targets = add_bytes(&mut sparse, "SCALAR", 5121, 1, &[3]);
    let values = add_bytes(&mut sparse, "VEC3", 5126, 1, &bytes_of(&[1.0, 1.0, 0.5]));
    let view = |document: &Value, accessor: usize| document["accessors"][accessor]["bufferView"].clone();
    sparse["accessors"][0]["sparse"] = json!({
        "count": 1,
        "indices": {"bufferView": view(&sparse, targets), "componentType": 5121},
        "values": {"bufferView": view(&sparse, values)},
    });
    let found = world(&made.load(&sparse).unwrap());
    let expected = SQUARE.chunks(3).map(|p| Vec3::from_slice(p).as_dvec3());
    let expected: Vec<_> = expected.map(|p| if p.x + p.y > 1.5 { p.with_z(0.5) } else { p }).collect();
    assert!(found.iter().zip(&expected).all(|(a, b)| (*a - *b).length() < 1e-6), "{found:?}");

    // 16 bits, normalised, padded to 8 bytes an element: the least one counts as -1.
    let corners = [[-32768i16, -32767, 0], [32767, -32767, 0], [-32767, 32767, 0], [32767, 32767, 16384]];
    let bytes: Vec<u8> = corners.iter().flat_map(|c| [c[0], c[1], c[2], 0]).flat_map(i16::to_le_bytes).collect();
    let mut quantised = square();
    let position = add_bytes(&mut quantised, "VEC3", 5122, 4, &bytes);
    let index = view(&quantised, position).as_u64().unwrap() as usize;
    quantised["bufferViews"][index]["byteStride"] = json!(8);
    quantised["accessors"][position]["normalized"] = json!(true);
    quantised["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    quantised["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = json!(position);
    let expected = corners.map(|c| DVec3::from(c.map(|x| (f64::from(x) / 32767.0).max(-1.0))));
    let found = world(&made.load(&quantised).unwrap());
    assert!(found.iter().zip(&expected).all(|(a, b)| (*a - *b).length() < 1e-6), "{found:?}");
}
