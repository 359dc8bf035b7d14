//! What must hold for every scene, and that the check sees what does not.

use glam::Vec3;
use pdss::scene::{LoadOptions, Scene, ShapeSpec};

/// Says what is wrong with a scene that claims to be sound, if anything.
pub fn fault_of(scene: &Scene) -> Option<String> {
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
        ([0, count].contains(&scene.second_uvs.len()), "a second uv a vertex"),
        ([0, count].contains(&scene.colors.len()), "a colour a vertex"),
        (scene.colors.as_flattened().iter().all(|x| x.is_finite() && *x >= 0.0), "colours finite, not negative"),
        (
            scene.materials.iter().all(|m| m.emission.iter().all(|e| e.is_finite() && *e >= 0.0)),
            "emission finite, not negative",
        ),
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
            scene.materials.iter().all(|m| m.maps().iter().flatten().all(|&t| t < scene.textures.len())),
            "textures in range",
        ),
        (scene.warnings.iter().all(|w| !w.contains('\n')), "warnings of one line"),
    ];
    checks.iter().find(|(holds, _)| !holds).map(|(_, what)| what.to_string())
}

#[track_caller]
pub fn assert_sound(scene: &Scene) {
    if let Some(fault) = fault_of(scene) {
        panic!("{}: not so: {fault}; {:?}", scene.name, scene.warnings);
    }
}

#[test]
fn the_soundness_check_sees_faults() {
    let sound = Scene::shape("shape:plane").unwrap();
    assert_eq!(fault_of(&sound), None);
    type Damage = fn(&mut Scene);
    let breaks: [(Damage, &str); 5] = [
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

/// Every shape, with its default sizes.
pub const SHAPES: [&str; 7] = ["plane", "sphere", "cylinder", "torus", "saddle", "cube", "ellipsoid"];

/// A shape's scene and its formula.
pub fn built(name: &str) -> (Scene, ShapeSpec) {
    let text = format!("shape:{name}");
    (Scene::open(&text, &LoadOptions::default()).unwrap(), text.parse().unwrap())
}
