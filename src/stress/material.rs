//! Albedo, metal, masks, normal maps, and meshes whose normals are not their geometry's.

use super::studio::{Picture, Set, settings, triangles};
use super::{Bench, Measure, Measured, Spread, StressError};
use crate::scene::{Camera, Filter, Material, Scene, Texture, Wrap};
use crate::settings::{Ambient, Curvature, Method, View};
use glam::Vec3;
use std::f32::consts::TAU;
use std::sync::Arc;

fn with_material(set: &Set, change: impl Fn(&mut Material)) -> Set {
    let mut set = set.clone();
    let mut scene = (*set.scene).clone();
    scene.materials.iter_mut().for_each(change);
    set.scene = Arc::new(scene);
    set
}

fn torus(method: Method, view: View) -> Result<Set, StressError> {
    Set::new("shape:torus:70,25", 420., settings(method, view, [96, 72]))
}

/// Under a sky of 1 without lights: nothing absorbed comes back as 1, black as the gloss alone, metal as its colour.
pub fn furnace(bench: &Bench, method: Method) -> Measured {
    let mut set = torus(method, View::Final)?;
    set.lights.clear();
    set.settings.ambient = Ambient { up: [1.; 3], down: [1.; 3] };
    set.settings.no_ao = true;
    let off = |set: &Set| -> Result<Spread, StressError> {
        let p = set.linear(bench)?;
        let one = |i: usize| p.texels[i][..3].iter().map(|x| f64::from((x - 1.).abs())).fold(0., f64::max);
        Ok(Spread::of(p.covered().map(one).collect()))
    };
    let white = off(&set)?;
    let grey = off(&with_material(&set, |m| m.base_color = [0.9, 0.9, 0.9, 1.]))?;
    let metal = off(&with_material(&set, |m| m.metallic = 1.))?;
    let black = with_material(&set, |m| m.base_color = [0., 0., 0., 1.]).linear(bench)?;
    let mut lambert = with_material(&set, |m| m.base_color = [0., 0., 0., 1.]);
    lambert.profile = None;
    let gloss = lambert.by(Method::Lambert).linear(bench)?;
    let dark = Spread::of(black.differences(&gloss, |_| true)).max;
    Ok(vec![
        Measure::new("albedo 1: |L - 1|", white.max, grey.max, format!("{white}")),
        Measure::new("metal: |L - 1|", metal.max, grey.max, format!("{metal}")),
        Measure::new("albedo 0: - gloss", dark, Spread::of(black.differences(&set.linear(bench)?, |_| true)).max, ""),
    ])
}

/// No material scatters: the bits of lambert.
pub fn mask_zero(bench: &Bench, method: Method) -> Measured {
    let lambert = torus(Method::Lambert, View::Final)?.linear(bench)?;
    let set = torus(method, View::Final)?;
    let own = lambert.differing(&set.linear(bench)?);
    let none = lambert.differing(&with_material(&set, |m| m.scatter = None).linear(bench)?);
    Ok(vec![Measure::new("pixels that differ", none as f64, own as f64, "wrong: the material scatters")])
}

/// A plane whose normal map turns normals by up to 70 degrees at random, seen at 5 degrees.
fn bumpy(method: Method, view: View) -> Result<Set, StressError> {
    let mut set = Set::new("shape:plane", 120., settings(method, view, [96, 72]))?;
    let mut scene = (*set.scene).clone();
    let side = 64u32;
    let mut seed = 7u64;
    let mut noise = || {
        seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (seed >> 56) as u8
    };
    let rgba8 = (0..side * side).flat_map(|_| [noise(), noise(), 150, 255]).collect();
    let wrap = [Wrap::Repeat; 2];
    scene.textures = vec![Texture {
        name: "bumps".into(),
        width: side,
        height: side,
        rgba8,
        srgb: false,
        wrap,
        filter: Filter::Linear,
    }];
    scene.materials[0].normal_texture = Some((0, 1.));
    scene.tangents = vec![[1., 0., 0., 1.]; scene.positions.len()];
    set.camera = Camera::orbit(15., 5., 120., None, 30., &scene);
    set.scene = Arc::new(scene);
    Ok(set)
}

/// Most of |H| times the pixel's footprint over a curvature picture.
fn footprints(bench: &Bench, set: &Set) -> Result<f64, StressError> {
    let h = set.seeing(View::Curvature).linear(bench)?;
    let z = set.seeing(View::Depth).linear(bench)?;
    let q = 2. * 15f64.to_radians().tan() / f64::from(set.settings.size.height);
    let one = |i: usize| f64::from(h.texels[i][0]).abs() * f64::from(z.texels[i][0]) * q;
    Ok(h.covered().map(one).fold(0., |m, x| if x.is_nan() { f64::INFINITY } else { m.max(x) }))
}

/// Strong bumps at a grazing view.
pub fn normal_map(bench: &Bench, method: Method) -> Measured {
    let set = bumpy(method, View::Scatter)?;
    let picture = set.linear(bench)?;
    let mut wrong = bumpy(method, View::Curvature)?;
    wrong.settings.curvature = Curvature::Vergne;
    let bound = footprints(bench, &set)?;
    // Scattering must even the bumps out, and not make them worse: the deviation of light from its neighbours.
    let rough = |p: &Picture| {
        let w = p.size[0];
        let pair = |i: &usize| !i.is_multiple_of(w) && p.texels[*i][3] > 0. && p.texels[i - 1][3] > 0.;
        let one = |i: usize| f64::from((p.texels[i][0] - p.texels[i - 1][0]).powi(2));
        let v: Vec<f64> = (0..p.texels.len()).filter(pair).map(one).collect();
        (v.iter().sum::<f64>() / v.len() as f64).sqrt()
    };
    let lambert = rough(&set.by(Method::Lambert).linear(bench)?);
    let relative = rough(&picture) / lambert;
    Ok(vec![
        Measure::new("outside 0..1", picture.outside(0., 1.001), picture.spoilt(-0.1).outside(0., 1.001), ""),
        Measure::new("|H| q", bound, 1. + bound, "H is measured on normals without the map"),
        Measure::new("roughness / lambert's", relative, 1.001 / relative.max(1e-3), format!("lambert's {lambert:.3}")),
    ])
}

/// A prism of eight sides around Y, its normals smooth or its faces'.
pub fn prism(smooth: bool) -> Scene {
    let (mut positions, mut normals, mut indices) = (Vec::new(), Vec::new(), Vec::new());
    let at = |i: u32| (TAU * i as f32 / 8.).sin_cos();
    for i in 0..8 {
        let first = positions.len() as u32;
        let middle = Vec3::new((TAU * (i as f32 + 0.5) / 8.).sin(), 0., (TAU * (i as f32 + 0.5) / 8.).cos());
        for (corner, y) in [(i, -60.), (i + 1, -60.), (i, 60.), (i + 1, 60.)] {
            let (s, c) = at(corner);
            positions.push([40. * s, y, 40. * c]);
            normals.push(if smooth { [s, 0., c] } else { middle.to_array() });
        }
        indices.extend([0, 1, 2, 2, 1, 3].map(|k| first + k));
    }
    triangles(if smooth { "smooth prism" } else { "flat prism" }, positions, normals, indices)
}

fn facetted(bench: &Bench, scene: Scene, method: Method) -> Measured {
    let mut set = Set::of(scene, 300., settings(method, View::Scatter, [120, 90]));
    set.settings.no_shadows = true;
    let picture = set.linear(bench)?;
    let q = footprints(bench, &set)?;
    let mut wild = set.clone();
    wild.settings.curvature = Curvature::Vergne;
    let vergne = footprints(bench, &wild)?;
    Ok(vec![
        Measure::new("|H| q", q, vergne.max(1.), "bound: half the reciprocal footprint; wrong: vergne, or 1"),
        Measure::new("outside 0..1", picture.outside(0., 1.001), picture.spoilt(f32::INFINITY).outside(0., 1.001), ""),
    ])
}

/// Smooth normals on flat sides.
pub fn smooth_prism(bench: &Bench, method: Method) -> Measured {
    facetted(bench, prism(true), method)
}

/// Flat normals on flat sides: a crease at every edge.
pub fn flat_prism(bench: &Bench, method: Method) -> Measured {
    facetted(bench, prism(false), method)
}

/// A torus of 800 flat-shaded facets.
pub fn flat_torus(bench: &Bench, method: Method) -> Measured {
    let (mut positions, mut normals, mut indices) = (Vec::new(), Vec::new(), Vec::new());
    let point = |i: u32, j: u32| {
        let ((s, c), (sin, cos)) = ((TAU * i as f32 / 40.).sin_cos(), (TAU * j as f32 / 20.).sin_cos());
        let ring = 70. + 25. * cos;
        Vec3::new(ring * s, 25. * sin, ring * c)
    };
    for i in 0..40 {
        for j in 0..20 {
            let (a, b, c, d) = (point(i, j), point(i + 1, j), point(i, j + 1), point(i + 1, j + 1));
            let n = (b - a).cross(c - a).normalize();
            let first = positions.len() as u32;
            positions.extend([a, b, c, d].map(|p| p.to_array()));
            normals.extend([n.to_array(); 4]);
            indices.extend([0, 1, 2, 2, 1, 3].map(|k| first + k));
        }
    }
    facetted(bench, triangles("facetted torus", positions, normals, indices), method)
}
