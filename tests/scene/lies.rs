//! Files that contradict themselves or ask for too much.

use serde_json::{Value, json};

use crate::fixture::{Fixture, square};

#[test]
fn lies_are_refused_by_place() {
    let made = Fixture::new();
    assert!(made.load(&square()).is_ok());
    let huge = json!(u64::MAX);
    let cases: [(&str, Value, &str); 24] = [
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
        ("/scene", json!("hello"), "scene: a whole number, 0 or more, was expected, not 'hello'"),
        (
            "/materials",
            json!([{"alphaCutoff": 1, "normalTexture": {"index": "x"}}]),
            "materials[0].normalTexture.index: a whole",
        ),
        ("/scene", json!(1), "scene: 1 is out of range; the file has 1 scenes"),
        ("/asset/version", json!("1.0"), "asset.version: '1.0' is not supported"),
        (
            "/extensionsRequired",
            json!(["EXT_mesh_gpu_instancing"]),
            "extensionsRequired: EXT_mesh_gpu_instancing not supported",
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
