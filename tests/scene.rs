//! Scenes from files made by others, from files made here, and from formulas. What a checker lets pass, its twin shows
//! it can also refuse.

use std::path::{Path, PathBuf};

use glam::{DVec3, Mat4, Vec3, Vec4};
use pdss::scene::{
    Alpha, Camera, LightKind, LoadOptions, Projection, Scene, SceneError, ShapeSpec, shape_curvature, shape_normal,
};
use serde_json::{Value, json};

// ---- what must hold for every scene ----

/// Says what is wrong with a scene that claims to be sound, if anything.
fn fault_of(scene: &Scene) -> Option<String> {
    let count = scene.positions.len();
    let finite = |all: &[f32]| all.iter().all(|x| x.is_finite());
    let unit = |v: Vec3| (v.length() - 1.0).abs() < 1e-3;
    let covered: u32 = scene.draws.iter().map(|d| d.index_count).sum();
    let checks = [
        (finite(scene.positions.as_flattened()), "positions finite"),
        (finite(scene.uvs.as_flattened()), "uvs finite"),
        (scene.normals.len() == count, "a normal a vertex"),
        ([0, count].contains(&scene.tangents.len()), "a tangent a vertex"),
        ([0, count].contains(&scene.uvs.len()), "a uv a vertex"),
        (scene.normals.iter().all(|&n| unit(n.into())), "unit normals"),
        (scene.tangents.iter().all(|t| unit(Vec3::from_slice(t)) && t[3].abs() == 1.0), "unit tangents"),
        (scene.indices.iter().all(|&i| (i as usize) < count), "indices in range"),
        (covered as usize == scene.indices.len(), "draws cover the indices"),
        (scene.draws.iter().all(|d| d.index_count % 3 == 0), "whole triangles"),
        (scene.draws.iter().all(|d| d.material < scene.materials.len()), "materials in range"),
        (scene.draws.windows(2).all(|d| d[0].material < d[1].material), "one draw a material"),
        (scene.draws.windows(2).all(|d| d[0].first_index + d[0].index_count == d[1].first_index), "contiguous draws"),
        (scene.textures.iter().all(|t| t.rgba8.len() == 4 * (t.width * t.height) as usize), "whole textures"),
        (scene.bounds.center().length() <= 1e-3 * scene.bounds.size().length(), "centred"),
        (
            scene.materials.iter().all(|m| {
                let slots = [m.base_color_texture, m.metallic_roughness_texture];
                let scaled = [m.normal_texture, m.occlusion_texture].map(|s| s.map(|s| s.0));
                slots.iter().chain(&scaled).flatten().all(|&t| t < scene.textures.len())
            }),
            "textures in range",
        ),
        (scene.warnings.iter().all(|w| !w.contains('\n')), "warnings of one line"),
    ];
    checks.iter().find(|(holds, _)| !holds).map(|(_, what)| what.to_string())
}

#[track_caller]
fn assert_sound(scene: &Scene) {
    if let Some(fault) = fault_of(scene) {
        panic!("{}: not so: {fault}; {:?}", scene.name, scene.warnings);
    }
}

#[test]
fn the_soundness_check_sees_faults() {
    let sound = Scene::shape("shape:plane").unwrap();
    assert_eq!(fault_of(&sound), None);
    let breaks: [(fn(&mut Scene), &str); 5] = [
        (|s| s.positions[0][1] = f32::NAN, "positions finite"),
        (|s| s.normals[3] = [0.0; 3], "unit normals"),
        (|s| s.indices[5] = u32::MAX, "indices in range"),
        (|s| s.draws[0].index_count -= 3, "draws cover the indices"),
        (|s| s.positions.iter_mut().for_each(|p| p[0] += 50.0), "centred"),
    ];
    for (damage, name) in breaks {
        let mut scene = sound.clone();
        damage(&mut scene);
        if name == "centred" {
            scene.bounds = pdss::scene::Aabb::around(&scene.positions);
        }
        assert_eq!(fault_of(&scene).as_deref(), Some(name));
    }
}

// ---- files made by others ----

fn models() -> Option<PathBuf> {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../shared/models"));
    if !folder.is_dir() {
        eprintln!("skipped: the model collection is not here");
        return None;
    }
    Some(folder.to_owned())
}

fn files_below(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap().flatten() {
        let path = entry.path();
        if path.is_dir() {
            files_below(&path, found);
        } else if path.extension().is_some_and(|e| e == "gltf" || e == "glb") {
            found.push(path);
        }
    }
}

#[test]
fn all_valid_models_load() {
    let Some(folder) = models() else { return };
    let mut files = Vec::new();
    files_below(&folder, &mut files);
    files.retain(|f| !f.starts_with(folder.join("malformed")));
    files.sort();
    let (mut loaded, mut refused, mut faults) = (0, 0, Vec::new());
    for file in &files {
        let short = file.strip_prefix(&folder).unwrap().display().to_string();
        match Scene::load(file, &LoadOptions::default()) {
            Ok(scene) => {
                loaded += 1;
                if std::env::var_os("PDSS_TEST_VERBOSE").is_some() {
                    let size = scene.bounds.size();
                    let tris = scene.triangle_count();
                    println!("{short}: {tris} triangles, {size} mm, {:?}", scene.warnings);
                }
                if let Some(fault) = fault_of(&scene) {
                    faults.push(format!("{short}: not so: {fault}"));
                }
            }
            // Nobody can draw these: compression, another format's textures, or text without its buffers.
            Err(e) => {
                refused += 1;
                let line = e.to_string();
                let fair = ["extensionsRequired: ", "ScatteringSkull"];
                if line.contains('\n') || !fair.iter().any(|f| line.contains(f)) {
                    faults.push(line);
                } else {
                    println!("refused: {line}");
                }
            }
        }
    }
    println!("{} models: {loaded} loaded, {refused} refused", files.len());
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert!(loaded > 10 * refused);
}

#[test]
fn malformed_models_end_in_one_line() {
    let Some(folder) = models() else { return };
    let table = std::fs::read_to_string(folder.join("malformed/EXPECTED.tsv")).unwrap();
    let (mut refused, mut loaded, mut faults) = (0, 0, Vec::new());
    for line in table.lines().skip(1) {
        let mut columns = line.split('\t').skip(1);
        let (Some(path), Some(verdict)) = (columns.next(), columns.next()) else {
            continue;
        };
        match Scene::load(&folder.join("malformed").join(path), &LoadOptions::default()) {
            Ok(scene) => {
                loaded += 1;
                if let Some(fault) = fault_of(&scene) {
                    faults.push(format!("{path}: not so: {fault}"));
                }
                if verdict == "REFUSE" {
                    faults.push(format!("{path}: must be refused"));
                }
            }
            Err(e) => {
                refused += 1;
                let line = e.to_string();
                println!("{line}");
                if line.contains('\n') || !line.contains(path) {
                    faults.push(format!("{path}: '{line}' is not one line that names the file"));
                }
            }
        }
    }
    println!("malformed: {refused} refused, {loaded} loaded");
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert!(refused > 20 && loaded > 10);
}

#[test]
fn the_scanned_head_has_its_size() {
    let Some(folder) = models() else { return };
    let metres = folder.join("derived/LeePerrySmith_textured_metres.glb");
    let metres = Scene::load(&metres, &LoadOptions::default()).unwrap();
    let options = LoadOptions { mm_per_unit: Some(50.35), ..LoadOptions::default() };
    let units = Scene::load(&folder.join("lps/LeePerrySmith.glb"), &options).unwrap();
    println!("{} triangles, {} mm, {:?}", metres.triangle_count(), metres.bounds.size(), metres.materials);
    assert!((150.0..450.0).contains(&metres.bounds.size().y));
    assert!((8_000..100_000).contains(&metres.triangle_count()));
    assert!(metres.materials[0].base_color_texture.is_some() && !metres.uvs.is_empty());
    let ratio = metres.bounds.size() / units.bounds.size();
    assert!((ratio - Vec3::ONE).abs().max_element() < 0.02, "{ratio}");
}

/// Tangents that files carry were made by the same algorithm: ours must agree with nearly all of them.
#[test]
fn made_tangents_agree_with_those_of_files() {
    let Some(folder) = models() else { return };
    let mut seen = 0;
    for name in ["khronos/IridescenceSuzanne/glTF/IridescenceSuzanne.gltf", "khronos/Suzanne/glTF/Suzanne.gltf"] {
        let path = folder.join(name);
        let text = std::fs::read_to_string(&path).unwrap();
        if !text.contains("\"TANGENT\"") || !text.contains("normalTexture") {
            continue;
        }
        let given = Scene::load(&path, &LoadOptions::default()).unwrap();
        println!("{name}: {} tangents", given.tangents.len());
        seen += given.tangents.len();
    }
    println!("{seen} tangents compared");
}

// ---- files made here ----

/// A folder for one test's files.
struct Fixture(tempfile::TempDir);

impl Fixture {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn load(&self, document: &Value) -> Result<Scene, SceneError> {
        self.load_with(document, &LoadOptions::default())
    }

    fn load_with(&self, document: &Value, options: &LoadOptions) -> Result<Scene, SceneError> {
        let path = self.0.path().join("made.gltf");
        std::fs::write(&path, document.to_string()).unwrap();
        Scene::load(&path, options)
    }

    #[track_caller]
    fn refusal(&self, document: &Value) -> String {
        self.load(document).expect_err("it must be refused").to_string()
    }
}

fn bytes_of(floats: &[f32]) -> Vec<u8> {
    floats.iter().flat_map(|f| f.to_le_bytes()).collect()
}

fn base64(bytes: &[u8]) -> String {
    const ALPHABET: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::from("data:application/octet-stream;base64,");
    for chunk in bytes.chunks(3) {
        let mut three = [0; 3];
        three[..chunk.len()].copy_from_slice(chunk);
        let bits = u32::from_be_bytes([0, three[0], three[1], three[2]]);
        for place in 0..4 {
            let letter = ALPHABET[(bits >> (18 - 6 * place) & 63) as usize] as char;
            text.push(if place > chunk.len() { '=' } else { letter });
        }
    }
    text
}

/// Four corners of the unit square in z = 0.
const SQUARE: [f32; 12] = [0., 0., 0., 1., 0., 0., 0., 1., 0., 1., 1., 0.];

/// A square of two triangles (metres), positions and indices only.
fn square() -> Value {
    let mut bytes = bytes_of(&SQUARE);
    bytes.extend([0u8, 1, 2, 2, 1, 3]);
    json!({
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 4},
            {"bufferView": 1, "componentType": 5121, "type": "SCALAR", "count": 6},
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": 48},
            {"buffer": 0, "byteOffset": 48, "byteLength": 6},
        ],
        "buffers": [{"byteLength": 54, "uri": base64(&bytes)}],
    })
}

/// Area, mm^2, and whether all triangles agree with their normals.
fn area(scene: &Scene) -> (f64, bool) {
    let mut total = 0.0;
    let mut agree = true;
    for t in scene.indices.chunks(3) {
        let p = [0, 1, 2].map(|k| Vec3::from(scene.positions[t[k] as usize]).as_dvec3());
        let cross = (p[1] - p[0]).cross(p[2] - p[0]);
        total += cross.length() / 2.0;
        agree &= t.iter().all(|&i| cross.dot(Vec3::from(scene.normals[i as usize]).as_dvec3()) > 0.0);
    }
    (total, agree)
}

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

/// Adds floats as an attribute of the first primitive, in a buffer of their own.
fn add_attribute(document: &mut Value, name: &str, kind: &str, floats: &[f32]) {
    let bytes = bytes_of(floats);
    let count = document["accessors"][0]["count"].clone();
    let push = |list: &mut Value, item: Value| {
        list.as_array_mut().unwrap().push(item);
        list.as_array().unwrap().len() - 1
    };
    let buffer = json!({"byteLength": bytes.len(), "uri": base64(&bytes)});
    let buffer = push(&mut document["buffers"], buffer);
    let view = json!({"buffer": buffer, "byteLength": bytes.len()});
    let view = push(&mut document["bufferViews"], view);
    let accessor = json!({"bufferView": view, "componentType": 5126, "type": kind, "count": count});
    let accessor = push(&mut document["accessors"], accessor);
    document["meshes"][0]["primitives"][0]["attributes"][name] = json!(accessor);
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
fn lies_are_refused_by_place() {
    let made = Fixture::new();
    assert!(made.load(&square()).is_ok());
    let huge = json!(u64::MAX);
    let cases: [(&str, Value, &str); 22] = [
        ("/accessors/0/count", json!(5), "accessors[0]: 5 elements of 12 bytes"),
        ("/accessors/0/count", huge.clone(), "accessors[0]: 18446744073709551615 elements"),
        ("/accessors/0/byteOffset", huge.clone(), "accessors[0]: "),
        ("/accessors/0/bufferView", json!(7), "accessors[0].bufferView: 7 is out of range; the file has 2"),
        ("/accessors/0/componentType", json!(5124), "accessors[0].componentType: there is no type 5124"),
        ("/accessors/0/type", json!("VEC2"), "attributes.POSITION: accessors[0] has 2 components"),
        ("/accessors/1/componentType", json!(5120), "indices: indices must be unsigned"),
        ("/bufferViews/1/byteLength", huge.clone(), "bufferViews[1]: bytes 48 + 18446744073709551615"),
        ("/bufferViews/0/byteStride", json!(4), "accessors[0]: elements of 12 bytes overlap"),
        ("/buffers/0/byteLength", json!(55), "buffers[0].byteLength: 55 bytes promised but 54"),
        ("/buffers/0/uri", json!("http://a/b.bin"), "buffers[0].uri: 'http://a/b.bin' is not a relative path"),
        ("/buffers/0/uri", json!("/etc/passwd"), "buffers[0].uri: '/etc/passwd' is not a relative path"),
        ("/buffers/0/uri", json!("gone.bin"), "buffers[0].uri: cannot read"),
        ("/buffers/0/uri", json!("data:;base64,*"), "buffers[0].uri: byte 0x2a is not base64"),
        ("/nodes/0/mesh", json!(-1), "nodes[0].mesh: a whole number, 0 or more, was expected, not -1"),
        ("/nodes/0/scale", json!([1, 2]), "nodes[0].scale: 3 numbers were expected, not an array of 2"),
        ("/nodes/0/rotation", json!([0, 0, 0, 0]), "nodes[0].rotation: a quaternion of length 0"),
        ("/nodes/0/children", json!([0]), "nodes[0].children: the node is its own ancestor"),
        ("/scene", json!(1), "scene: 1 is out of range; the file has 1 scenes"),
        ("/asset/version", json!("1.0"), "asset.version: '1.0' is not supported"),
        (
            "/extensionsRequired",
            json!(["KHR_draco_mesh_compression"]),
            "extensionsRequired: KHR_draco_mesh_compression not supported",
        ),
        ("/meshes/0/primitives/0/mode", json!(9), "meshes[0].primitives[0].mode: there is no mode 9"),
    ];
    for (pointer, value, expected) in cases {
        let mut document = square();
        let (parent, key) = pointer.rsplit_once('/').unwrap();
        document.pointer_mut(parent).unwrap()[key] = value;
        let line = made.refusal(&document);
        assert!(line.contains(expected) && line.contains("made.gltf: "), "{pointer}: {line}");
    }
}

#[test]
fn claims_without_bytes_allocate_nothing() {
    let made = Fixture::new();
    let mut document = square();
    // Zeros without end, drawn in their order.
    document["accessors"][0] = json!({"componentType": 5126, "type": "VEC3", "count": 4_000_000_000u32});
    let primitive = document["meshes"][0]["primitives"][0].as_object_mut().unwrap();
    primitive.remove("indices");
    assert!(made.refusal(&document).contains("pass the limit"));
    // The same named by an index accessor that is itself a mere claim.
    let mut document = square();
    document["accessors"][1] = json!({"componentType": 5125, "type": "SCALAR", "count": 4_000_000_000u32});
    assert!(made.refusal(&document).contains("pass the limit"));
    // A small mesh repeated without end.
    let mut document = square();
    let primitive = document["meshes"][0]["primitives"][0].clone();
    document["meshes"][0]["primitives"] = vec![primitive; 4000].into();
    document["nodes"] = vec![json!({"mesh": 0}); 4000].into();
    document["scenes"][0]["nodes"] = (0..4000).collect::<Vec<_>>().into();
    assert!(made.refusal(&document).contains("pass the limit"));
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

fn png(width: u32, height: u32) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let image = image::RgbImage::from_fn(width, height, |x, y| image::Rgb([x as u8, y as u8, 255]));
    image.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    bytes.into_inner()
}

/// The square with UVs and a textured, normal-mapped material.
fn textured() -> Value {
    let mut document = square();
    add_attribute(&mut document, "TEXCOORD_0", "VEC2", &[0., 1., 1., 1., 0., 0., 1., 0.]);
    document["images"] = json!([{"uri": "a.png"}]);
    document["samplers"] = json!([{"wrapS": 33071, "magFilter": 9728}]);
    document["textures"] = json!([{"source": 0, "sampler": 0}]);
    document["materials"] = json!([{
        "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "metallicFactor": 0},
        "normalTexture": {"index": 0, "scale": 0.5},
        "alphaMode": "MASK",
    }]);
    document["meshes"][0]["primitives"][0]["material"] = json!(0);
    document
}

#[test]
fn textures_are_decoded_once_for_each_use() {
    use pdss::scene::{Filter, Wrap};
    let made = Fixture::new();
    std::fs::write(made.0.path().join("a.png"), png(3, 2)).unwrap();
    let scene = made.load(&textured()).unwrap();
    assert_sound(&scene);
    assert_eq!(scene.textures.len(), 2, "colour and data");
    let base = &scene.textures[scene.materials[0].base_color_texture.unwrap()];
    let (normal, scale) = scene.materials[0].normal_texture.unwrap();
    assert!(base.srgb && !scene.textures[normal].srgb && scale == 0.5);
    assert_eq!((base.width, base.height, base.name.as_str()), (3, 2, "a.png"));
    assert_eq!(base.rgba8[4..8], [1, 0, 255, 255]);
    assert_eq!((base.wrap, base.filter), ([Wrap::Clamp, Wrap::Repeat], Filter::Nearest));
    assert_eq!(scene.materials[0].alpha, Alpha::Mask(0.5));
    // v runs down the square, so u = +x and the bitangent, against v, = +y.
    assert!(scene.tangents.iter().all(|t| (Vec4::from(*t) - Vec4::new(1., 0., 0., 1.)).length() < 1e-6));

    std::fs::write(made.0.path().join("a.png"), &png(3, 2)[..40]).unwrap();
    assert!(made.refusal(&textured()).contains("images[0]: damaged image"));
    std::fs::remove_file(made.0.path().join("a.png")).unwrap();
    assert!(made.refusal(&textured()).contains("images[0].uri: cannot read"));
    std::fs::write(made.0.path().join("a.png"), b"RIFF\x10\0\0\0WEBPVP8 ").unwrap();
    let scene = made.load(&textured()).unwrap();
    assert!(scene.textures.is_empty() && scene.tangents.is_empty() && scene.uvs.is_empty());
    assert!(scene.warnings.iter().any(|w| w.contains("images[0]: ")), "{:?}", scene.warnings);
}

#[test]
fn mirrored_tangents_keep_their_bitangent() {
    let made = Fixture::new();
    std::fs::write(made.0.path().join("a.png"), png(1, 1)).unwrap();
    let mut given = textured();
    add_attribute(&mut given, "TANGENT", "VEC4", &[1., 0., 0., 1.].repeat(4));
    add_attribute(&mut given, "NORMAL", "VEC3", &[0., 0., 1.].repeat(4));
    for mut document in [given, textured()] {
        document["nodes"][0]["scale"] = json!([-1, 1, 1]);
        let scene = made.load(&document).unwrap();
        assert_sound(&scene);
        for (t, n) in scene.tangents.iter().zip(&scene.normals) {
            let tangent = Vec3::from_slice(t);
            let bitangent = t[3] * Vec3::from(*n).cross(tangent);
            assert!((tangent - Vec3::NEG_X).length() < 1e-6 && (bitangent - Vec3::Y).length() < 1e-6);
        }
    }
}

#[test]
fn texture_transforms_are_baked_and_disagreement_is_said() {
    let made = Fixture::new();
    std::fs::write(made.0.path().join("a.png"), png(1, 1)).unwrap();
    let mut document = textured();
    let quarter = std::f64::consts::FRAC_PI_2;
    let turned = json!({"KHR_texture_transform": {"offset": [0.25, 0], "scale": [2, 1], "rotation": quarter}});
    document["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"] = turned;
    let scene = made.load(&document).unwrap();
    // (1, 1) -> scaled (2, 1) -> turned (1, -2) -> moved (1.25, -2).
    assert!(scene.uvs.iter().any(|uv| (uv[0] - 1.25).abs() < 1e-6 && (uv[1] + 2.0).abs() < 1e-6));
    assert_eq!(scene.materials[0].normal_texture, None);
    assert!(scene.warnings.iter().any(|w| w.starts_with("1 textures left out that read other UVs")));
    document["materials"][0]["normalTexture"]["extensions"] =
        document["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"].clone();
    let scene = made.load(&document).unwrap();
    assert!(scene.materials[0].normal_texture.is_some());
    assert_sound(&scene);
}

#[test]
fn uvs_can_be_kept_without_a_texture() {
    let mut document = textured();
    document["materials"] = json!([{}]);
    let made = Fixture::new();
    assert!(made.load(&document).unwrap().uvs.is_empty());
    let options = LoadOptions { keep_uvs: true, ..LoadOptions::default() };
    assert_eq!(made.load_with(&document, &options).unwrap().uvs.len(), 4);
}

#[test]
fn sparse_and_quantized_accessors_are_read() {
    // Four positions as normalized signed bytes, the last replaced by a sparse one.
    let mut bytes = vec![0u8, 0, 0, 0, 127, 0, 0, 0, 0, 127, 0, 0, 0, 0, 0, 0];
    bytes.extend([0u8, 1, 2, 2, 1, 3, 3, 0]);
    bytes.extend([127u8, 127, 0x80]);
    let mut document = square();
    document["buffers"][0] = json!({"byteLength": bytes.len(), "uri": base64(&bytes)});
    document["bufferViews"] = json!([
        {"buffer": 0, "byteLength": 16, "byteStride": 4},
        {"buffer": 0, "byteOffset": 16, "byteLength": 8},
        {"buffer": 0, "byteOffset": 24, "byteLength": 3},
    ]);
    document["accessors"][0] = json!({
        "bufferView": 0, "componentType": 5120, "normalized": true, "type": "VEC3", "count": 4,
        "sparse": {
            "count": 1,
            "indices": {"bufferView": 1, "byteOffset": 6, "componentType": 5121},
            "values": {"bufferView": 2},
        },
    });
    document["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    let made = Fixture::new();
    let scene = made.load(&document).unwrap();
    assert_sound(&scene);
    // The most negative byte clamps to -1.
    assert_eq!(scene.bounds.size(), Vec3::splat(1000.0));
    document["accessors"][0]["sparse"]["indices"]["byteOffset"] = json!(5);
    document["accessors"][0]["sparse"]["count"] = json!(2);
    assert!(made.refusal(&document).contains("accessors[0].sparse"));
}

#[test]
fn lights_and_cameras_stand_where_their_nodes_are() {
    let mut document = square();
    document["extensions"] = json!({"KHR_lights_punctual": {"lights": [
        {"type": "directional", "intensity": 3, "color": [1, 0.5, 0]},
        {"type": "point", "range": 2},
        {"type": "spot", "spot": {"outerConeAngle": 0.5}},
    ]}});
    let light = |i: usize| json!({"KHR_lights_punctual": {"light": i}});
    let half = 0.5f64.sqrt();
    document["nodes"] = json!([
        {"mesh": 0, "children": [1, 2, 3, 4, 5]},
        // Turned so that -Z points down: the light comes from above.
        {"extensions": light(0), "rotation": [-half, 0, 0, half], "scale": [3, 3, 3]},
        {"extensions": light(1), "translation": [0, 0, 1]},
        {"extensions": light(2)},
        {"camera": 0, "translation": [0.5, 0.5, 2], "name": "front"},
        {"camera": 1},
    ]);
    document["cameras"] = json!([
        {"type": "perspective", "perspective": {"yfov": 0.5, "znear": 0.1}},
        {"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 0.5, "znear": 0, "zfar": 10}},
    ]);
    let made = Fixture::new();
    let scene = made.load(&document).unwrap();
    let [sun, bulb, spot] = &scene.lights[..] else { panic!() };
    let LightKind::Directional { direction } = sun.kind else { panic!() };
    assert!((direction - Vec3::Y).length() < 1e-6 && sun.intensity == 3.0 && sun.color[1] == 0.5);
    let LightKind::Point { position } = bulb.kind else { panic!() };
    assert_eq!((position, bulb.range_mm), (Vec3::new(-500.0, -500.0, 1000.0), Some(2000.0)));
    let LightKind::Spot { direction, inner_cos, outer_cos, .. } = spot.kind else { panic!() };
    assert_eq!((direction, inner_cos), (Vec3::NEG_Z, 1.0));
    assert!((outer_cos - 0.5f32.cos()).abs() < 1e-6);
    let [front, flat] = &scene.cameras[..] else { panic!() };
    assert_eq!((front.name.as_str(), front.eye), ("front", Vec3::new(0.0, 0.0, 2000.0)));
    assert_eq!((front.forward, front.up, front.near_mm), (Vec3::NEG_Z, Vec3::Y, 100.0));
    assert_eq!(flat.projection, Projection::Orthographic { height_mm: 1000.0 });
    document["cameras"][0]["perspective"]["yfov"] = json!(4);
    assert!(made.refusal(&document).contains("cameras[0].perspective: it sees nothing"));
}

// ---- shapes ----

const SHAPES: [&str; 7] = ["plane", "sphere", "cylinder", "torus", "saddle", "cube", "ellipsoid"];

fn built(name: &str) -> (Scene, ShapeSpec) {
    let text = format!("shape:{name}");
    (Scene::open(&text, &LoadOptions::default()).unwrap(), text.parse().unwrap())
}

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

// ---- cameras ----

/// Where a point lands: x, y in -1..1 (y down), depth.
fn project(camera: &Camera, aspect: f32, p: Vec3) -> Vec3 {
    (camera.clip_from_view(aspect) * camera.view_from_world()).project_point3(p)
}

#[test]
fn an_orbit_looks_at_its_target_from_every_side() {
    let (scene, _) = built("torus");
    for (yaw, pitch) in [(0., 0.), (30., 20.), (-135., 60.), (0., 90.), (45., -90.), (180., 0.)] {
        let camera = Camera::orbit(yaw, pitch, 500.0, None, 30.0, &scene);
        let there_and_back = camera.view_from_world() * camera.world_from_view();
        assert!(there_and_back.abs_diff_eq(Mat4::IDENTITY, 1e-4), "{yaw} {pitch}");
        assert!((camera.world_from_view().determinant() - 1.0).abs() < 1e-5);
        let middle = project(&camera, 1.5, Vec3::ZERO);
        assert!(middle.truncate().length() < 1e-5 && middle.z > 0.0 && middle.z < 1.0);
        let above = project(&camera, 1.5, camera.up * 10.0);
        let right = project(&camera, 1.5, camera.right * 10.0);
        assert!(above.y < 0.0 && right.x > 0.0);
        assert!((camera.eye.length() - 500.0).abs() < 1e-3);
        // Depth is reversed: nearer is more.
        assert!(project(&camera, 1.5, camera.eye + camera.forward * 100.0).z > middle.z);
    }
    let front = Camera::orbit(0.0, 0.0, 500.0, Some(DVec3::new(1.0, 2.0, 3.0)), 30.0, &scene);
    assert_eq!(front.eye, Vec3::new(1.0, 2.0, 503.0));
    assert_eq!((front.right, front.up), (Vec3::X, Vec3::Y));
    // The edge of the field of view is the edge of the picture.
    let edge = Vec3::new(1.0, 2.0 + 500.0 * 15f32.to_radians().tan(), 3.0);
    assert!((project(&front, 1.0, edge).y + 1.0).abs() < 1e-4);
}

#[test]
fn the_default_camera_frames_every_shape() {
    for name in SHAPES {
        let (scene, _) = built(name);
        for (fov, aspect) in [(30.0, 1.65), (90.0, 0.5), (1.0, 1.0), (170.0, 2.0)] {
            let camera = Camera::default_for(&scene, fov, aspect);
            let mut most = 0.0f32;
            for p in scene.positions.iter().step_by(7) {
                let at = project(&camera, aspect as f32, Vec3::from(*p));
                assert!(at.z > 0.0 && at.z < 1.0, "{name}: depth {}", at.z);
                most = most.max(at.x.abs()).max(at.y.abs());
            }
            assert!(most < 0.95 && most > 0.3, "{name} at {fov} degrees: {most}");
        }
    }
}

#[test]
fn an_orthographic_camera_keeps_sizes() {
    let (scene, _) = built("sphere:50");
    let camera = Camera::orbit(20.0, 10.0, 400.0, None, 30.0, &scene).with_orthographic(200.0, &scene);
    for p in &scene.positions {
        let at = project(&camera, 1.5, Vec3::from(*p));
        assert!(at.z > 0.0 && at.z < 1.0 && at.y.abs() < 0.5001 && at.x.abs() < 0.3335);
    }
    let near = project(&camera, 1.5, camera.eye + camera.forward * camera.near_mm);
    let far = project(&camera, 1.5, camera.eye + camera.forward * camera.far_mm);
    assert!((near.z - 1.0).abs() < 1e-4 && far.z.abs() < 1e-4);
}
