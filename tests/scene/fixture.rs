//! Small glTF files made in code.

use glam::Vec3;
use pdss::scene::{LoadOptions, Scene, SceneError};
use serde_json::{Value, json};

/// A folder for one test's files.
pub struct Fixture(pub tempfile::TempDir);

impl Fixture {
    pub fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub fn load(&self, document: &Value) -> Result<Scene, SceneError> {
        self.load_with(document, &LoadOptions::default())
    }

    pub fn load_with(&self, document: &Value, options: &LoadOptions) -> Result<Scene, SceneError> {
        let path = self.0.path().join("made.gltf");
        std::fs::write(&path, document.to_string()).unwrap();
        Scene::load(&path, options)
    }

    #[track_caller]
    pub fn refusal(&self, document: &Value) -> String {
        self.load(document).expect_err("it must be refused").to_string()
    }
}

pub fn bytes_of(floats: &[f32]) -> Vec<u8> {
    floats.iter().flat_map(|f| f.to_le_bytes()).collect()
}

pub fn base64(bytes: &[u8]) -> String {
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
pub const SQUARE: [f32; 12] = [0., 0., 0., 1., 0., 0., 0., 1., 0., 1., 1., 0.];

/// A square of two triangles (metres), positions and indices only.
pub fn square() -> Value {
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
pub fn area(scene: &Scene) -> (f64, bool) {
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

/// Adds floats as an attribute of the first primitive, in a buffer of their own.
pub fn add_attribute(document: &mut Value, name: &str, kind: &str, floats: &[f32]) {
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

/// Adds bytes as an accessor in a buffer of its own; returns its index.
pub fn add_bytes(document: &mut Value, kind: &str, component: u32, count: usize, bytes: &[u8]) -> usize {
    let push = |list: &mut Value, item: Value| {
        list.as_array_mut().unwrap().push(item);
        list.as_array().unwrap().len() - 1
    };
    let buffer = push(&mut document["buffers"], json!({"byteLength": bytes.len(), "uri": base64(bytes)}));
    let view = push(&mut document["bufferViews"], json!({"buffer": buffer, "byteLength": bytes.len()}));
    let accessor = json!({"bufferView": view, "componentType": component, "type": kind, "count": count});
    push(&mut document["accessors"], accessor)
}
