//! What must not bleed into what: a card in front, a bright background, a neighbour that does not scatter.

use super::studio::{Picture, Set, settings};
use super::{Bench, Measure, Measured, StressError};
use crate::scene::{Aabb, Camera, Draw, Light, LightKind, Material, Scene};
use crate::settings::{Method, View};
use crate::skin::profile::Profile;
use glam::{DVec3, Mat4, Vec3};
use std::sync::Arc;

/// A plate of 80 mm: its middle, how far it is turned around Y, what it is made of.
struct Plate {
    middle: Vec3,
    yaw: f32,
    scatter: Option<usize>,
    color: f32,
}

/// Plates, each with a material of its own.
fn plates(list: &[Plate]) -> Result<Scene, StressError> {
    let plane = Scene::shape("shape:plane")?;
    let mut scene = plane.clone();
    (scene.positions, scene.normals, scene.indices, scene.uvs) = Default::default();
    (scene.draws, scene.materials) = Default::default();
    for (i, plate) in list.iter().enumerate() {
        // The plane faces +Y; make it face +Z, then turn it.
        let turn = Mat4::from_rotation_y(plate.yaw) * Mat4::from_rotation_x(std::f32::consts::FRAC_PI_2);
        let first = scene.positions.len() as u32;
        let place = |p: &[f32; 3]| (plate.middle + turn.transform_vector3(Vec3::from(*p) * 0.4)).to_array();
        scene.positions.extend(plane.positions.iter().map(place));
        scene.normals.extend(plane.normals.iter().map(|n| turn.transform_vector3(Vec3::from(*n)).to_array()));
        scene.uvs.extend(&plane.uvs);
        let first_index = scene.indices.len() as u32;
        scene.indices.extend(plane.indices.iter().map(|i| i + first));
        scene.draws.push(Draw { material: i, first_index, index_count: plane.indices.len() as u32 });
        let [r, g, b] = [plate.color; 3];
        let scatter = plate.scatter;
        scene.materials.push(Material { scatter, base_color: [r, g, b, 1.], ..Material::new(&format!("plate {i}")) });
    }
    scene.bounds = Aabb::around(&scene.positions);
    Ok(scene)
}

fn draw(bench: &Bench, method: Method, list: &[Plate], from: Vec3) -> Result<Picture, StressError> {
    let mut set = Set::new("shape:plane", 200., settings(method, View::Scatter, [128, 96]))?;
    let scene = plates(list)?;
    set.camera = Camera::orbit(0., 0., 200., Some(DVec3::ZERO), 20., &scene);
    set.scene = Arc::new(scene);
    let direction = from.normalize();
    set.lights = vec![Light { kind: LightKind::Directional { direction }, ..Light::directional(0., 0., 1.) }];
    set.settings.no_shadows = true;
    if list.iter().any(|p| p.scatter == Some(1)) {
        set.other = Some(Profile::resolve("skin")?);
    }
    set.linear(bench)
}

fn plate(x: f32, z: f32, yaw: f32, scatters: bool) -> Plate {
    Plate { middle: Vec3::new(x, 0., z), yaw, scatter: scatters.then_some(0), color: 1. }
}

/// Largest difference over what the first picture shows, where `keep` keeps.
fn band(alone: &Picture, with: &Picture, keep: impl Fn(usize) -> bool) -> f64 {
    alone.differences(with, keep).into_iter().fold(0., f64::max)
}

/// A card before a lit wall of the same material, 60 mm apart, and the wall behind the card: neither takes from the other.
pub fn card(bench: &Bench, method: Method) -> Measured {
    let left = |z: f32| plate(-40., z, 0., true);
    let behind = |gap: f32| {
        let (sin, cos) = 0.8f32.sin_cos();
        plate(40. * cos - 0.4, -40. * sin - gap, 0.8, true)
    };
    let mut all = Vec::new();
    for (quantity, from) in [("behind lit", Vec3::new(1., 0., -0.2)), ("card lit", Vec3::new(-0.9, 0., 0.6))] {
        let alone = draw(bench, method, &[left(0.)], from)?;
        let far = band(&alone, &draw(bench, method, &[left(0.), behind(60.)], from)?, |_| true);
        let near = band(&alone, &draw(bench, method, &[left(0.), behind(0.2)], from)?, |_| true);
        // A method that gathers nothing has nothing to leak: there, the wrong picture is 1 % brighter.
        let wrong = near.max(band(&alone, &alone.times(1.01), |_| true));
        all.push(Measure::new(quantity, far, wrong, "wrong: .2 mm apart, where light does pass; or 1 % brighter"));
    }
    Ok(all)
}

/// A lit wall that does not scatter, as bright as can be, 60 mm behind: as if there were none.
pub fn background(bench: &Bench, method: Method) -> Measured {
    let from = Vec3::new(-0.9, 0., 0.6);
    let front = || plate(-40., 0., 0., true);
    let wall = || plate(30., -60., 0., false);
    let alone = draw(bench, method, &[front()], from)?;
    let with = draw(bench, method, &[front(), wall()], from)?;
    // The card's own pixels: those that are covered without the wall.
    let figure = band(&alone, &with, |_| true);
    Ok(vec![Measure::new("largest change", figure, band(&alone, &with.times(1.01), |_| true), "wrong: 1 % brighter")])
}

/// Two plates that scatter by different profiles, and one that does not beside one that does, edge to edge, one lit and one turned
/// from the light: the seam is sharp.
pub fn touching(bench: &Bench, method: Method) -> Measured {
    // A shallow roof: its left side faces the light, its right side looks away.
    let (sin, cos) = 0.6f32.sin_cos();
    let side = |right: bool, scatter: Option<usize>| {
        let s = if right { 1. } else { -1. };
        Plate { scatter, ..plate(s * 40. * cos, -40. * sin, s * 0.6, true) }
    };
    // The right side's cosine is just below 0, the left side's .9.
    let from = Vec3::new(-1., 0., 0.61);
    let alone = draw(bench, method, &[side(true, Some(0))], from)?;
    let beside = |scatter| draw(bench, method, &[side(false, scatter), side(true, Some(0))], from);
    let (bare, other, same) = (beside(None)?, beside(Some(1))?, beside(Some(0))?);
    // The dark side's pixels, those the lit side's rasterisation does not share.
    let w = alone.size[0];
    let dark = |i: usize| i % w > w / 2 + 1;
    // A method that gathers nothing has nothing to leak: there, the wrong picture is all lit.
    let stranger = band(&alone, &draw(bench, method, &[side(true, Some(0))], Vec3::Z)?, dark);
    let wrong = band(&alone, &same, dark).max(stranger);
    let said = "wrong: one material, where light does pass";
    Ok(vec![
        Measure::new("bleed from what does not scatter", band(&alone, &bare, dark), wrong, said),
        Measure::new("bleed from another profile", band(&alone, &other, dark), wrong, said),
    ])
}
