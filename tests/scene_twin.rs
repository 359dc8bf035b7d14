//! Our glTF reader against another one, the `gltf` crate: what both can read must have the same triangles in the same place.

use glam::{Mat4, Vec3};
use gltf::mesh::Mode;
use pdss::scene::{LoadOptions, Scene};
use std::path::{Path, PathBuf};

/// Triangles and world bounding box (mm) as the other reader sees them; none where it refuses the file, or where morph targets
/// move what it does not: those have oracles of their own (`tests/scene/motion.rs`).
fn other(path: &Path) -> Option<(usize, Vec3, Vec3)> {
    let (document, buffers, _) = gltf::import(path).ok()?;
    let morphs = document.meshes().any(|m| m.weights().is_some_and(|w| w.iter().any(|w| *w != 0.)))
        || document.nodes().any(|n| n.weights().is_some_and(|w| w.iter().any(|w| *w != 0.)));
    if morphs {
        return None;
    }
    let scene = document.default_scene().or_else(|| document.scenes().next())?;
    let mut found = (0, Vec3::INFINITY, Vec3::NEG_INFINITY);
    let mut stack: Vec<(gltf::Node<'_>, Mat4)> = scene.nodes().map(|n| (n, Mat4::IDENTITY)).collect();
    while let Some((node, above)) = stack.pop() {
        let world = above * Mat4::from_cols_array_2d(&node.transform().matrix());
        for primitive in node.mesh().into_iter().flat_map(|m| m.primitives().collect::<Vec<_>>()) {
            if primitive.mode() != Mode::Triangles {
                return None;
            }
            let reader = primitive.reader(|b| buffers.get(b.index()).map(|d| &d.0[..]));
            let positions: Vec<Vec3> = reader.read_positions()?.map(Vec3::from).collect();
            let indices: Vec<u32> = match reader.read_indices() {
                Some(i) => i.into_u32().collect(),
                None => (0..positions.len() as u32).collect(),
            };
            for triangle in indices.chunks_exact(3) {
                found.0 += 1;
                for i in triangle {
                    let p = world.transform_point3(positions[*i as usize]) * 1000.;
                    found.1 = found.1.min(p);
                    found.2 = found.2.max(p);
                }
            }
        }
        stack.extend(node.children().map(|c| (c, world)));
    }
    Some(found)
}

fn files(folder: &Path, out: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            files(&path, out);
        } else if path.extension().is_some_and(|e| e == "gltf" || e == "glb") {
            out.push(path);
        }
    }
}

/// How far two boxes are apart, relative to their size.
fn apart(a: (Vec3, Vec3), b: (Vec3, Vec3)) -> f32 {
    let size = (a.1 - a.0).max_element().max(1e-6);
    (a.0 - b.0).abs().max_element().max((a.1 - b.1).abs().max_element()) / size
}

#[test]
fn two_readers_see_the_same_triangles_in_the_same_place() {
    let shared = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/models");
    let mut list = Vec::new();
    for folder in ["khronos", "derived", "blender-io", "playcanvas", "pmndrs", "makehuman", "materialx", "lps"] {
        files(&shared.join(folder), &mut list);
    }
    if list.is_empty() {
        eprintln!("skipped: {} is not here", shared.display());
        return;
    }
    let (mut same, mut worst, mut wrong) = (0, 0f32, Vec::new());
    for path in &list {
        let (Some((triangles, min, max)), Ok(ours)) = (other(path), Scene::load(path, &LoadOptions::default())) else {
            continue;
        };
        if triangles == 0 || ours.indices.is_empty() {
            continue;
        }
        let origin = ours.origin.as_vec3();
        let off = apart((min, max), (ours.bounds.min + origin, ours.bounds.max + origin));
        // Degenerate and duplicate triangles are dropped, and each such file says so.
        let dropped = triangles - ours.triangle_count().min(triangles);
        let told = !ours.warnings.is_empty();
        if off > 1e-5 || (dropped > 0 && !told) || ours.triangle_count() > triangles {
            wrong.push(format!(
                "{}: {} triangles against {triangles}, off by {off:e}",
                path.display(),
                ours.triangle_count()
            ));
        }
        worst = worst.max(off);
        same += 1;
        // The twin: a box that is a percent larger is noticed.
        assert!(apart((min, max), (min, max * 1.01 + (max - min) * 0.01)) > 1e-5, "{}", path.display());
    }
    println!("{same} of {} files compared, boxes apart by at most {worst:e} of their size", list.len());
    assert!(same > 20, "only {same} files were compared");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
