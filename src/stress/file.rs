//! Hostile glTF, written and read back: normals, triangles, transforms, units, counts.

use super::studio::{Picture, Set, settings};
use super::{Bench, Measure, Measured, Spread, StressError};
use crate::scene::{LoadOptions, Scene, SceneError};
use crate::settings::{Method, View};
use glam::{DVec3, Vec3};
use serde_json::{Value, json};
use std::f32::consts::{PI, TAU};
use std::io::Write as _;

/// A mesh as a file has it, lengths in the file's unit.
#[derive(Clone, Default)]
struct Mesh {
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    uvs: Vec<[f32; 2]>,
    indices: Vec<u32>,
}

/// A sphere of radius `r` around the origin, 64 by 32.
fn sphere(r: f32) -> Mesh {
    let mut m = Mesh::default();
    for j in 0..=32u32 {
        for i in 0..=64u32 {
            // The seam closes to the bit.
            let ((s, c), (sin, cos)) = ((TAU * (i % 64) as f32 / 64.).sin_cos(), (PI * j as f32 / 32.).sin_cos());
            let n = [sin * s, cos, sin * c];
            m.positions.push(n.map(|x| x * r));
            m.normals.push(n);
            m.uvs.push([i as f32 / 64., j as f32 / 32.]);
        }
    }
    for j in 0..32 {
        for i in 0..64 {
            let (a, b) = (j * 65 + i, (j + 1) * 65 + i);
            // No slivers at the poles.
            if j < 31 {
                m.indices.extend([a, b, b + 1]);
            }
            if j > 0 {
                m.indices.extend([a, b + 1, a + 1]);
            }
        }
    }
    m
}

/// The mesh as a binary glTF, drawn once by each of `nodes`.
fn glb(mesh: &Mesh, nodes: Vec<Value>) -> Vec<u8> {
    let (mut bin, mut views, mut accessors) = (Vec::new(), Vec::new(), Vec::new());
    let mut add = |bytes: &[u8], accessor: Value| {
        views.push(json!({"buffer": 0, "byteOffset": bin.len(), "byteLength": bytes.len()}));
        bin.extend_from_slice(bytes);
        let mut accessor = accessor;
        accessor["bufferView"] = json!(views.len() - 1);
        accessors.push(accessor);
        accessors.len() - 1
    };
    let mut attributes = json!({});
    let vector = |kind: &str, count: usize| json!({"componentType": 5126, "type": kind, "count": count});
    attributes["POSITION"] = json!(add(bytemuck::cast_slice(&mesh.positions), vector("VEC3", mesh.positions.len())));
    if !mesh.normals.is_empty() {
        attributes["NORMAL"] = json!(add(bytemuck::cast_slice(&mesh.normals), vector("VEC3", mesh.normals.len())));
    }
    if !mesh.uvs.is_empty() {
        attributes["TEXCOORD_0"] = json!(add(bytemuck::cast_slice(&mesh.uvs), vector("VEC2", mesh.uvs.len())));
    }
    let mut primitive = json!({"attributes": attributes, "material": 0});
    if !mesh.indices.is_empty() {
        let accessor = json!({"componentType": 5125, "type": "SCALAR", "count": mesh.indices.len()});
        primitive["indices"] = json!(add(bytemuck::cast_slice(&mesh.indices), accessor));
    }
    let roots: Vec<usize> = (0..nodes.len()).collect();
    let document = json!({
        "asset": {"version": "2.0"}, "scenes": [{"nodes": roots}], "nodes": nodes,
        "meshes": [{"primitives": [primitive]}],
        "materials": [{"pbrMetallicRoughness": {"metallicFactor": 0}, "doubleSided": true}],
        "accessors": accessors, "bufferViews": views, "buffers": [{"byteLength": bin.len()}],
    });
    let mut text = document.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    bin.resize(bin.len().next_multiple_of(4), 0);
    let mut file = Vec::new();
    let total = 28 + text.len() + bin.len();
    for word in [0x4654_6c67u32, 2, total as u32, text.len() as u32, 0x4e4f_534a] {
        file.extend(word.to_le_bytes());
    }
    file.extend(text);
    for word in [bin.len() as u32, 0x004e_4942] {
        file.extend(word.to_le_bytes());
    }
    file.extend(bin);
    file
}

fn load(mesh: &Mesh, nodes: Vec<Value>, mm_per_unit: f64) -> Result<Scene, StressError> {
    let mut file = tempfile::Builder::new().suffix(".glb").tempfile()?;
    file.write_all(&glb(mesh, nodes))?;
    Ok(Scene::load(file.path(), &LoadOptions { mm_per_unit: Some(mm_per_unit), ..LoadOptions::default() })?)
}

fn plain(mesh: &Mesh) -> Result<Scene, StressError> {
    load(mesh, vec![json!({"mesh": 0})], 1.)
}

fn draw(bench: &Bench, scene: Scene, method: Method) -> Result<Picture, StressError> {
    let mut set = Set::of(scene, 200., settings(method, View::Scatter, [80, 60]));
    set.settings.no_shadows = true;
    set.linear(bench)
}

/// Warnings that are said as often as they should be: each of `expected` once and with its count. How many are not.
fn unsaid(scene: &Scene, expected: &[(usize, &str)]) -> f64 {
    let said = |(count, text): &&(usize, &str)| {
        scene.warnings.iter().filter(|w| w.contains(text) && w.contains(&format!("{count} "))).count() == 1
    };
    expected.iter().filter(|e| !said(e)).count() as f64
}

/// A sphere with every kind of broken normal and triangle, and the same without.
pub fn damage(bench: &Bench, method: Method) -> Measured {
    let clean = sphere(40.);
    let mut hurt = clean.clone();
    hurt.normals[500] = [0.; 3];
    hurt.normals[700] = [f32::NAN; 3];
    for i in [900, 901, 902] {
        hurt.normals[i] = hurt.normals[i].map(|x| x * 7.);
    }
    let first: [u32; 3] = [hurt.indices[300], hurt.indices[301], hurt.indices[302]];
    hurt.indices.extend([400, 400, 401]);
    hurt.indices.extend(first);
    // Wound against its normals, on the far side.
    let mut inner = clean.positions[66 * 10].map(|x| x * 0.5);
    hurt.positions.push(inner);
    inner[0] = f32::NAN;
    hurt.positions.push(inner);
    hurt.normals.extend([[0., 1., 0.]; 2]);
    hurt.uvs.extend([[0.; 2]; 2]);
    let last = hurt.positions.len() as u32 - 1;
    hurt.indices.extend([100, 101, last]);
    let scene = plain(&hurt)?;
    let whole = plain(&clean)?;
    let expected = [
        (2, "normals zero or not finite"),
        (3, "normals not of unit length"),
        (1, "triangles without area"),
        (1, "repeated triangles"),
        (1, "not finite left out"),
    ];
    let (missing, none) = (unsaid(&scene, &expected), unsaid(&whole, &expected));
    let text = scene.warnings.join("; ");
    let base = draw(bench, whole.clone(), method)?;
    let s = Spread::of(base.differences(&draw(bench, scene, method)?, |_| true));
    let mut turned = clean.clone();
    turned.normals.iter_mut().take(1200).for_each(|n| *n = [0., 1., 0.]);
    let wrong = Spread::of(base.differences(&draw(bench, plain(&turned)?, method)?, |_| true)).p99;
    Ok(vec![
        Measure::new("repairs not said once", missing, none, text),
        Measure::new("picture p99", s.p99, wrong, format!("{s}, against the undamaged mesh")),
    ])
}

/// Without normals, without texture coordinates, without indices.
pub fn missing(bench: &Bench, method: Method) -> Measured {
    let whole = sphere(40.);
    let base = draw(bench, plain(&whole)?, method)?;
    let bare = Mesh { normals: Vec::new(), uvs: Vec::new(), ..whole.clone() };
    let pick = |v: &[[f32; 3]]| whole.indices.iter().map(|i| v[*i as usize]).collect();
    let loose = Mesh { positions: pick(&whole.positions), normals: pick(&whole.normals), ..Mesh::default() };
    let apart = |m: &Mesh| -> Result<Spread, StressError> {
        Ok(Spread::of(base.differences(&draw(bench, plain(m)?, method)?, |_| true)))
    };
    let (smooth, unshared) = (apart(&bare)?, apart(&loose)?);
    let mut wrong = whole.clone();
    wrong.normals.iter_mut().for_each(|n| *n = [0., 1., 0.]);
    let wrong = apart(&wrong)?.p99;
    Ok(vec![
        Measure::new("no normals p99", smooth.p99, wrong, format!("{smooth}; smooth ones are made")),
        Measure::new("no indices p99", unshared.p99, wrong, format!("{unshared}")),
    ])
}

/// Non-uniform, negative and zero scale of a node.
pub fn scales(bench: &Bench, method: Method) -> Measured {
    let mesh = sphere(40.);
    let node = |scale: [f64; 3]| load(&mesh, vec![json!({"mesh": 0, "scale": scale})], 1.);
    // Normals of the ellipsoid that a scaled sphere is.
    let off = |scene: &Scene, axes: DVec3| {
        let one = |(p, n): (&[f32; 3], &[f32; 3])| {
            let p = Vec3::from(*p).as_dvec3();
            let want = (p / (axes * axes)).normalize();
            want.angle_between(Vec3::from(*n).as_dvec3())
        };
        scene.positions.iter().zip(&scene.normals).map(one).fold(0., f64::max)
    };
    let stretched = node([2., 0.5, 1e-3])?;
    let angle = off(&stretched, DVec3::new(80., 20., 0.04));
    let base = draw(bench, node([1.; 3])?, method)?;
    let apart = |scene: Scene| -> Result<Spread, StressError> {
        Ok(Spread::of(base.differences(&draw(bench, scene, method)?, |_| true)))
    };
    let mirrored = apart(node([-1., 1., 1.])?)?;
    let wrong = apart(node([1., 0.8, 1.])?)?.p99;
    let mut bad = 0f64;
    for scale in [[0., 0., 0.], [1., 0., 1.], [0., 1., 1.]] {
        let picture = draw(bench, node(scale)?, method)?;
        bad = bad.max(picture.texels.iter().flatten().filter(|x| !(0. ..=1.001).contains(*x)).count() as f64);
    }
    Ok(vec![
        Measure::new("2, .5, .001: normal, rad", angle, off(&node([2., 0.5, 2e-3])?, DVec3::new(80., 20., 0.04)), ""),
        Measure::new("mirrored p99", mirrored.p99, wrong, format!("{mirrored}")),
        Measure::new(
            "zero: pixels out of 0..1",
            bad,
            base.spoilt(f32::NAN).texels.iter().flatten().filter(|x| !(0. ..=1.001).contains(*x)).count() as f64,
            "",
        ),
    ])
}

/// The same real size in units of .1 mm to 10 km.
pub fn units(bench: &Bench, method: Method) -> Measured {
    let base = draw(bench, plain(&sphere(40.))?, method)?;
    let at = |mm: f64, r: f64| -> Result<Spread, StressError> {
        let scene = load(&sphere((r / mm) as f32), vec![json!({"mesh": 0})], mm)?;
        Ok(Spread::of(base.differences(&draw(bench, scene, method)?, |_| true)))
    };
    let (mut worst, mut text) = (0f64, String::new());
    for mm in [0.1, 1000., 1e7] {
        let s = at(mm, 40.)?;
        worst = if s.p99.is_nan() { f64::INFINITY } else { worst.max(s.p99) };
        text.push_str(&format!("{mm:.0e} mm: p99 {:.1e}; ", s.p99));
    }
    Ok(vec![Measure::new("p99", worst, at(1., 42.)?.p99, text.trim_end_matches("; "))])
}

/// 0, 1, 2, 65,535 and 70,000 vertices; every triangle drawn, or one line that says why not.
pub fn vertices(bench: &Bench) -> Measured {
    let strip = |count: usize| Mesh {
        // Separate triangles in a grid of unit squares, vertices shared by none.
        positions: (0..count)
            .map(|i| {
                let (t, k) = (i / 3, i % 3);
                [(t % 160) as f32 + f32::from(u8::from(k == 1)), (t / 160) as f32 + f32::from(u8::from(k == 2)), 0.]
            })
            .collect(),
        normals: vec![[0., 0., 1.]; count],
        ..Mesh::default()
    };
    let (mut bad, mut text) = (0., String::new());
    let mut twin = 0.;
    for count in [0usize, 1, 2, 65_535, 70_000] {
        match plain(&strip(count)) {
            Ok(scene) => {
                let drawn = scene.triangle_count();
                let picture = draw(bench, scene, Method::Pdss)?;
                let fine = picture.texels.iter().flatten().all(|x| (0. ..=1.001).contains(x));
                bad += f64::from(u8::from(drawn != count / 3 || !fine));
                twin += f64::from(u8::from(drawn != count.div_ceil(3)));
                text.push_str(&format!("{count}: {drawn} triangles; "));
            }
            Err(StressError::Scene(e @ SceneError::Invalid { .. })) => {
                bad += f64::from(u8::from(e.to_string().contains('\n')));
                text.push_str(&format!("{count}: refused; "));
            }
            Err(e) => return Err(e),
        }
    }
    Ok(vec![Measure::new("counts gone wrong", bad, twin, text.trim_end_matches("; "))])
}

/// 10,000 nodes of one triangle each are one mesh of 10,000.
pub fn nodes(bench: &Bench, method: Method) -> Measured {
    let tile = Mesh {
        positions: vec![[0., 0., 0.], [0.9, 0., 0.], [0., 0.9, 0.]],
        normals: vec![[0., 0., 1.]; 3],
        ..Mesh::default()
    };
    let place = |i: usize| [(i % 100) as f32, (i / 100) as f32, 0f32];
    let many = load(&tile, (0..10_000).map(|i| json!({"mesh": 0, "translation": place(i)})).collect(), 1.)?;
    let shift = |p: &[f32; 3], i: usize| [p[0] + place(i)[0], p[1] + place(i)[1], 0.];
    let one = Mesh {
        positions: (0..10_000)
            .flat_map(|i| tile.positions.iter().map(move |p| shift(p, i)).collect::<Vec<_>>())
            .collect(),
        normals: vec![[0., 0., 1.]; 30_000],
        ..Mesh::default()
    };
    let (count, base) = (many.triangle_count(), draw(bench, plain(&one)?, method)?);
    let apart = |p: &Picture| f64::from(base.apart(p));
    let figure = apart(&draw(bench, many, method)?);
    let fewer = load(&tile, (0..5_000).map(|i| json!({"mesh": 0, "translation": place(i)})).collect(), 1.)?;
    let wrong = apart(&draw(bench, fewer, method)?);
    Ok(vec![Measure::new("largest difference", figure, wrong, format!("{count} triangles; wrong: 5,000 nodes"))])
}
