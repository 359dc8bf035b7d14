//! The bust that comes with the program: true to size, closed, symmetric, unwrapped without overlap. Each check also
//! refuses a bust with that fault.

use std::collections::BTreeMap;

use glam::{Vec2, Vec3};
use pdss::scene::{LoadOptions, Scene};

fn bust() -> Scene {
    Scene::bust(&LoadOptions::default()).unwrap()
}

fn triangles<'a>(scene: &'a Scene, names: &[&str]) -> Vec<[usize; 3]> {
    let chosen = |d: &&pdss::scene::Draw| names.contains(&scene.materials[d.material].name.as_str());
    let of = |d: &'a pdss::scene::Draw| &scene.indices[d.first_index as usize..][..d.index_count as usize];
    let flat: Vec<u32> = scene.draws.iter().filter(chosen).flat_map(of).copied().collect();
    flat.chunks_exact(3).map(|t| [t[0] as usize, t[1] as usize, t[2] as usize]).collect()
}

/// Edges of the surface, vertices at one place being one, that have not one triangle on either side.
fn open_edges(scene: &Scene, triangles: &[[usize; 3]]) -> usize {
    let mut edges: BTreeMap<[[u32; 3]; 2], i32> = BTreeMap::new();
    let place = |i: usize| scene.positions[i].map(|x| (x + 0.0).to_bits());
    for t in triangles {
        for k in 0..3 {
            let (a, b) = (place(t[k]), place(t[(k + 1) % 3]));
            if a < b {
                *edges.entry([a, b]).or_default() += 1;
            } else {
                // Both directions once each leave 0; a second triangle on one side leaves 256.
                *edges.entry([b, a]).or_default() += 257;
            }
        }
    }
    edges.values().filter(|&&n| n != 258).count()
}

/// Texels of a `size` square whose middle lies in two triangles, and those that lie in one.
fn overlaps(scene: &Scene, triangles: &[[usize; 3]], size: usize) -> [usize; 2] {
    let mut seen = vec![0u8; size * size];
    for t in triangles {
        let [a, b, c] = t.map(|i| Vec2::from(scene.uvs[i]) * size as f32 - 0.5);
        let area = (b - a).perp_dot(c - a);
        let (low, high) = (a.min(b).min(c).ceil().max(Vec2::ZERO), a.max(b).max(c).floor());
        for y in low.y as usize..=high.y as usize {
            for x in low.x as usize..=high.x as usize {
                let q = Vec2::new(x as f32, y as f32);
                let (v, w) = ((q - a).perp_dot(c - a) / area, (b - a).perp_dot(q - a) / area);
                // The edge itself belongs to two triangles: a hair inside.
                if v > 1e-3 && w > 1e-3 && v + w < 1.0 - 1e-3 {
                    seen[y.min(size - 1) * size + x.min(size - 1)] += 1;
                }
            }
        }
    }
    [seen.iter().filter(|&&n| n > 1).count(), seen.iter().filter(|&&n| n == 1).count()]
}

/// Vertices without a twin on the other side.
fn lonely(scene: &Scene) -> usize {
    let center = scene.origin.x as f32;
    let key = |p: &[f32; 3], side: f32| [side * (p[0] + center), p[1], p[2]].map(|x| (x * 1e3).round() as i64);
    let places: std::collections::BTreeSet<_> = scene.positions.iter().map(|p| key(p, 1.)).collect();
    scene.positions.iter().filter(|p| !places.contains(&key(p, -1.))).count()
}

#[test]
fn the_bust_is_a_head_of_true_size_with_three_materials() {
    let scene = bust();
    let size = scene.bounds.size();
    println!("{} triangles, {} vertices, {size} mm", scene.triangle_count(), scene.positions.len());
    assert!((30_000..80_000).contains(&scene.triangle_count()));
    assert!((340. ..400.).contains(&size.x) && (370. ..410.).contains(&size.y) && (200. ..250.).contains(&size.z));
    let names: Vec<_> = scene.materials.iter().map(|m| m.name.as_str()).collect();
    assert_eq!(names, ["Skin", "Hair", "Eyes"]);
    assert!(scene.materials.iter().all(|m| m.base_color_texture.is_some()));
    assert_eq!(scene.cameras.len(), 1);
    // It faces +Z: the eyes lie in front of the middle.
    let front = triangles(&scene, &["Eyes"]).iter().flatten().map(|&i| scene.positions[i][2]).fold(f32::MAX, f32::min);
    assert!(front + scene.origin.z as f32 > 40., "{front}");
}

#[test]
fn only_its_skin_scatters_unless_another_is_named() {
    let scattering = |scene: &Scene| -> Vec<String> {
        scene.materials.iter().filter(|m| m.scatter.is_some()).map(|m| m.name.clone()).collect()
    };
    let mut scene = bust();
    scene.assign_profile(None, 0).unwrap();
    assert_eq!(scattering(&scene), ["Skin"]);
    let mut scene = bust();
    scene.assign_profile(Some("Eyes"), 0).unwrap();
    assert_eq!(scattering(&scene), ["Eyes"]);
    // A file that says nothing of the sort scatters wherever it can.
    let mut scene = bust();
    scene.materials.iter_mut().for_each(|m| m.translucent = false);
    scene.assign_profile(None, 0).unwrap();
    assert_eq!(scattering(&scene).len(), 3);
}

#[test]
fn it_is_closed_and_the_same_on_both_sides() {
    let mut scene = bust();
    for names in [&["Skin", "Hair"][..], &["Eyes"]] {
        let mut triangles = triangles(&scene, names);
        assert_eq!(open_edges(&scene, &triangles), 0, "{names:?}");
        triangles.pop();
        assert_eq!(open_edges(&scene, &triangles), 3, "a missing triangle is seen");
    }
    assert_eq!(lonely(&scene), 0);
    scene.positions[0][0] += 0.1;
    assert!(lonely(&scene) > 0, "a vertex out of place is seen");
}

#[test]
fn its_chart_does_not_overlap_and_leaves_room_around() {
    let mut scene = bust();
    let skin = triangles(&scene, &["Skin", "Hair"]);
    let [twice, once] = overlaps(&scene, &skin, 1024);
    println!("{once} of {} texels used, {twice} twice", 1024 * 1024);
    assert!(twice == 0 && once > 700_000);
    let used = skin.iter().flatten().map(|&i| Vec2::from(scene.uvs[i]));
    let (low, high) = used.fold((Vec2::ONE, Vec2::ZERO), |(low, high), q| (low.min(q), high.max(q)));
    // Eight texels of 1024.
    assert!(low.min_element() > 8. / 1024. && high.max_element() < 1. - 8. / 1024., "{low} {high}");
    let moved = skin[skin.len() / 2][0];
    scene.uvs[moved] = [0.1, 0.1];
    assert!(overlaps(&scene, &skin, 1024)[0] > 0, "an overlap is seen");
}

#[test]
fn its_normals_are_those_of_its_surface() {
    let scene = bust();
    let turned = |scene: &Scene| {
        let flat = |t: &[usize; 3]| {
            let [a, b, c] = t.map(|i| Vec3::from(scene.positions[i]));
            (b - a).cross(c - a)
        };
        let all = triangles(scene, &["Skin", "Hair", "Eyes"]);
        let against =
            |t: &&[usize; 3]| t.iter().any(|&i| Vec3::from(scene.normals[i]).dot(flat(t).normalize_or_zero()) < 0.);
        let area: f32 = all.iter().map(|t| flat(t).length()).sum();
        all.iter().filter(against).map(|t| flat(t).length()).sum::<f32>() / area
    };
    println!("{:.2e} of the area has a normal that looks inwards", turned(&scene));
    assert!(turned(&scene) < 1e-3);
    let mut wrong = scene.clone();
    wrong.normals.iter_mut().for_each(|n| *n = n.map(|x| -x));
    assert!(turned(&wrong) > 0.99);
}
