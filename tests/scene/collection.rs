//! Files made by others: the good load, the broken end in one line.

use std::path::{Path, PathBuf};

use glam::{Vec2, Vec3, Vec4};
use pdss::scene::{LoadOptions, Scene};
use serde_json::{Value, json};

use crate::check::fault_of;

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
            // Nobody can draw these: another format's surfaces, a later version, or text without its buffers.
            Err(e) => {
                refused += 1;
                let line = e.to_string();
                let fair = ["extensionsRequired: ", "the file needs glTF 2.1", "ScatteringSkull"];
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

/// Files with a few bytes changed, or cut short, load soundly or end in an error; nothing panics.
#[test]
fn damaged_models_never_panic() {
    let Some(folder) = models() else { return };
    let here = tempfile::tempdir().unwrap();
    let path = here.path().join("damaged.gltf");
    let mut random = 1u64;
    let mut next = |below: usize| {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (random >> 33) as usize % below
    };
    let (mut loaded, mut refused) = (0, 0);
    for name in [
        "khronos/Box/glTF-Binary/Box.glb",
        "khronos/BoxTextured/glTF-Embedded/BoxTextured.gltf",
        "khronos/SimpleSparseAccessor/glTF-Embedded/SimpleSparseAccessor.gltf",
        "playcanvas/Lights.glb",
        "cesium-native/content/cubeStripIndexed.glb",
        "tinygltf/singleBlendshapeCube_sparse.glb",
    ] {
        let whole = std::fs::read(folder.join(name)).unwrap();
        for round in 0..150 {
            let mut bytes = whole.clone();
            for _ in 0..=next(4) {
                // Mostly digits: numbers that still parse, and lie.
                let mut at = next(bytes.len());
                for _ in 0..if next(20) == 0 { 0 } else { 50 } {
                    at = if bytes[at].is_ascii_digit() { at } else { next(bytes.len()) };
                }
                bytes[at] = if bytes[at].is_ascii_digit() { b'0' + next(10) as u8 } else { next(256) as u8 };
            }
            if round % 10 == 0 {
                bytes.truncate(next(whole.len()));
            }
            std::fs::write(&path, bytes).unwrap();
            match Scene::load(&path, &LoadOptions::default()) {
                Ok(scene) => {
                    loaded += 1;
                    assert_eq!(fault_of(&scene), None, "{name}, round {round}");
                }
                Err(e) => {
                    refused += 1;
                    assert!(!e.to_string().contains('\n'), "{e}");
                }
            }
        }
    }
    println!("{loaded} loaded, {refused} refused");
    assert!(loaded > 100 && refused > 100);
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

/// Blender's exporter writes MikkTSpace tangents, the bitangent against v: ours, made from the same file without them,
/// must agree. (Other exporters turn the sign over; a file's own tangents are taken as they are.)
#[test]
fn made_tangents_agree_with_those_of_a_file() {
    let Some(folder) = models() else { return };
    let here = tempfile::tempdir().unwrap();
    let sphere = "04_sphere_specular_glossiness";
    for entry in std::fs::read_dir(folder.join("blender-io").join(sphere)).unwrap().flatten() {
        std::fs::copy(entry.path(), here.path().join(entry.file_name())).unwrap();
    }
    image::RgbImage::new(1, 1).save(here.path().join("flat.png")).unwrap();
    let path = here.path().join(sphere).with_extension("gltf");
    let mut document: Value = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
    document["images"] = json!([{"uri": "flat.png"}]);
    document["textures"] = json!([{"source": 0}]);
    document["materials"] = json!([{"normalTexture": {"index": 0}}]);
    let load = |document: &Value| {
        std::fs::write(&path, document.to_string()).unwrap();
        Scene::load(&path, &LoadOptions::default()).unwrap()
    };
    let given = load(&document);
    let attributes = document["meshes"][0]["primitives"][0]["attributes"].as_object_mut().unwrap();
    attributes.remove("TANGENT").unwrap();
    let made = load(&document);
    assert!(made.warnings.iter().any(|w| w.contains("MikkTSpace")));
    assert_eq!(given.indices.len(), made.indices.len());
    // At the poles the triangles have no area in UV, and any tangent is as good as another.
    let defined = |t: &[u32]| {
        let [a, b, c] = [0, 1, 2].map(|k| Vec2::from(made.uvs[t[k] as usize]));
        (b - a).perp_dot(c - a).abs() > 1e-9
    };
    let corner = |scene: &Scene, i: u32| Vec4::from(scene.tangents[i as usize]);
    let mut cosines = Vec::new();
    for (a, b) in given.indices.chunks(3).zip(made.indices.chunks(3)).filter(|(_, b)| defined(b)) {
        for k in 0..3 {
            let (a, b) = (corner(&given, a[k]), corner(&made, b[k]));
            assert_eq!(a.w, b.w, "the bitangent is turned over");
            cosines.push(a.truncate().dot(b.truncate()));
        }
    }
    cosines.sort_by(f32::total_cmp);
    let (least, median) = (cosines[0], cosines[cosines.len() / 2]);
    println!("{} corners, cosine at least {least}, median {median}", cosines.len());
    // The exporter weighted the corners of quads, we those of triangles: by less than one of the sphere's 32 segments.
    assert!(cosines.len() > 2500 && least > (360f32 / 32.0).to_radians().cos() && median > 0.999);
}
