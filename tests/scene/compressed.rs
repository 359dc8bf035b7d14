//! Files whose bytes are packed: meshopt, Draco, KTX2. What they unpack to is what stands in the plain twin; what lies is
//! refused by its place.

use pdss::scene::Scene;
use serde_json::{Value, json};

use crate::check::assert_sound;
use crate::fixture::{Fixture, SQUARE, add_attribute, base64, bytes_of, square};

fn corners() -> Vec<[f32; 3]> {
    SQUARE.chunks(3).map(|c| [c[0], c[1], c[2]]).collect()
}

/// The square, its positions and indices packed by meshopt; `name` is the extension's.
fn packed(name: &str, indices: &[u32], mode: &str) -> Value {
    let corners = meshopt::encode_vertex_buffer(&corners()).unwrap();
    let triangles = match mode {
        "TRIANGLES" => meshopt::encode_index_buffer(indices, 4).unwrap(),
        _ => meshopt::encode_index_sequence(indices, 4).unwrap(),
    };
    let mut document = square();
    let split = corners.len();
    let bytes = [corners, triangles].concat();
    document["buffers"] = json!([
        {"byteLength": bytes.len(), "uri": base64(&bytes)},
        {"byteLength": 72, "extensions": {name: {"fallback": true}}},
    ]);
    let view = |start: usize, end: usize, count: usize, stride: usize, mode: &str| {
        json!({"buffer": 1, "byteLength": count * stride, "extensions": {name: {"buffer": 0, "byteOffset": start,
            "byteLength": end - start, "byteStride": stride, "count": count, "mode": mode}}})
    };
    document["bufferViews"] =
        json!([view(0, split, 4, 12, "ATTRIBUTES"), view(split, bytes.len(), indices.len(), 4, mode),]);
    document["accessors"][1]["componentType"] = json!(5125);
    document["extensionsRequired"] = json!([name]);
    document
}

fn same(a: &Scene, b: &Scene) {
    assert_sound(a);
    assert_eq!((&a.positions, &a.normals, &a.uvs, &a.indices), (&b.positions, &b.normals, &b.uvs, &b.indices));
}

#[test]
fn meshopt_unpacks_to_the_plain_square() {
    let made = Fixture::new();
    let plain = made.load(&square()).unwrap();
    for name in ["EXT_meshopt_compression", "KHR_meshopt_compression"] {
        for mode in ["TRIANGLES", "INDICES"] {
            let mut document = packed(name, &[0, 1, 2, 2, 1, 3], mode);
            same(&made.load(&document).unwrap(), &plain);
            // A buffer that is nowhere, and that nothing but compressed views names, need not say what it is for.
            document["buffers"][1].as_object_mut().unwrap().remove("extensions");
            same(&made.load(&document).unwrap(), &plain);
            document["bufferViews"][0].as_object_mut().unwrap().remove("extensions");
            assert!(made.refusal(&document).contains("buffers[1].uri: missing"));
        }
    }
}

#[test]
fn filters_of_meshopt_are_undone() {
    const NAME: &str = "KHR_meshopt_compression";
    let made = Fixture::new();
    let up = [[0.6f32, 0., 0.8, 0.]; 4];
    let normals = meshopt::encode_vertex_buffer(&meshopt::encode_filter_oct::<i8>(&up, 8)).unwrap();
    let exponential = meshopt::encode_filter_exp(&corners(), 15, meshopt::EncodeExpMode::Separate);
    let exponential = meshopt::encode_vertex_buffer(&exponential).unwrap();
    let colors = meshopt::encode_filter_color::<u8>(&[[0.2, 0.4, 0.6, 1.]; 4], 8);
    let colors = meshopt::encode_vertex_buffer(&colors).unwrap();
    let mut document = packed(NAME, &[0, 1, 2, 2, 1, 3], "TRIANGLES");
    let mut view = |bytes: &[u8], stride: usize, filter: &str| {
        let buffers = document["buffers"].as_array_mut().unwrap();
        buffers.push(json!({"byteLength": bytes.len(), "uri": base64(bytes)}));
        let view = json!({"buffer": 1, "byteLength": 4 * stride, "extensions": {NAME: {"buffer": buffers.len() - 1,
            "byteLength": bytes.len(), "byteStride": stride, "count": 4, "mode": "ATTRIBUTES", "filter": filter}}});
        let views = document["bufferViews"].as_array_mut().unwrap();
        views.push(view);
        views.len() - 1
    };
    let views = [view(&exponential, 12, "EXPONENTIAL"), view(&normals, 4, "OCTAHEDRAL"), view(&colors, 4, "COLOR")];
    document["bufferViews"][views[1]]["byteStride"] = json!(4);
    document["accessors"][0]["bufferView"] = json!(views[0]);
    let accessors = document["accessors"].as_array_mut().unwrap();
    let accessor = |view: usize, code: u32, kind: &str| json!({"bufferView": view, "componentType": code, "normalized": true, "type": kind, "count": 4});
    accessors.extend([accessor(views[1], 5120, "VEC3"), accessor(views[2], 5121, "VEC4")]);
    document["meshes"][0]["primitives"][0]["attributes"] = json!({"POSITION": 0, "NORMAL": 2, "COLOR_0": 3});
    let scene = made.load(&document).unwrap();
    assert_sound(&scene);
    assert_eq!(scene.positions, made.load(&square()).unwrap().positions);
    assert!(scene.normals.iter().all(|n| (n[0] - 0.6).abs() < 0.01 && n[1].abs() < 0.01 && (n[2] - 0.8).abs() < 0.01));
    let near = |c: &[f32; 4]| c.iter().zip([0.2, 0.4, 0.6, 1.]).all(|(a, b)| (a - b).abs() < 0.02);
    assert!(scene.colors.iter().all(near), "{:?}", scene.colors);
}

#[test]
fn meshopt_that_lies_is_refused() {
    const NAME: &str = "EXT_meshopt_compression";
    let made = Fixture::new();
    let whole = packed(NAME, &[0, 1, 2, 2, 1, 3], "TRIANGLES");
    let of = "bufferViews[0].extensions.EXT_meshopt_compression: ";
    let cases: [(&[(&str, Value)], &str); 7] = [
        (&[("byteLength", json!(30))], "damaged: its bytes are not 4 elements of ATTRIBUTES"),
        (&[("byteLength", json!(9000))], "reach past the buffer's"),
        (&[("count", json!(5))], "5 elements of 12 bytes are not the buffer view's 48 bytes"),
        (&[("count", json!(u64::MAX))], "are not the buffer view's 48 bytes"),
        (&[("count", json!(8)), ("byteStride", json!(6))], "there is no mode ATTRIBUTES with filter NONE for 8"),
        (&[("mode", json!("TRIANGLES"))], "there is no mode TRIANGLES"),
        (&[("filter", json!("OCTAHEDRAL"))], "there is no mode ATTRIBUTES with filter OCTAHEDRAL"),
    ];
    for (changes, expected) in cases {
        let mut document = whole.clone();
        for (key, value) in changes {
            document["bufferViews"][0]["extensions"][NAME][key] = value.clone();
        }
        let line = made.refusal(&document);
        assert!(line.contains(of) && line.contains(expected), "{line}");
    }
    let mut greedy = whole;
    greedy["bufferViews"][0]["byteLength"] = json!(12u64 << 32);
    greedy["bufferViews"][0]["extensions"][NAME]["count"] = json!(1u64 << 32);
    assert!(made.refusal(&greedy).contains("pass the limit"));
    let outside = made.refusal(&packed(NAME, &[0, 1, 2, 2, 1, 9], "TRIANGLES"));
    assert!(outside.contains("indices: 9 is out of range; the primitive has 4 vertices"), "{outside}");
}

/// The square as Draco writes it where it packs nothing: sequential connectivity, plain bytes and floats.
fn draco(corners: [u8; 6]) -> Vec<u8> {
    const MESH: u8 = 1;
    let mut bytes = b"DRACO".to_vec();
    bytes.extend([2, 2, MESH, 0, 0, 0]);
    // Faces, points, connectivity as it is.
    bytes.extend([2, 4, 1]);
    bytes.extend(corners);
    // One decoder of one attribute: positions of three floats, not normalised, number 7; values as they are.
    bytes.extend([1, 1, 0, 9, 3, 0, 7, 0]);
    bytes.extend(bytes_of(&SQUARE));
    bytes
}

fn with_draco(bytes: &[u8]) -> Value {
    let mut document = square();
    document["buffers"] = json!([{"byteLength": bytes.len(), "uri": base64(bytes)}]);
    document["bufferViews"] = json!([{"buffer": 0, "byteLength": bytes.len()}]);
    for accessor in document["accessors"].as_array_mut().unwrap() {
        accessor.as_object_mut().unwrap().remove("bufferView");
    }
    document["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
    document["meshes"][0]["primitives"][0]["extensions"] =
        json!({"KHR_draco_mesh_compression": {"bufferView": 0, "attributes": {"POSITION": 7}}});
    document
}

#[test]
fn draco_unpacks_to_the_plain_square_and_lies_are_refused() {
    let made = Fixture::new();
    let whole = draco([0, 1, 2, 2, 1, 3]);
    same(&made.load(&with_draco(&whole)).unwrap(), &made.load(&square()).unwrap());
    for length in 0..whole.len() {
        let line = made.refusal(&with_draco(&whole[..length]));
        assert!(line.contains("KHR_draco_mesh_compression") && !line.contains('\n'), "{length}: {line}");
    }
    let outside = made.refusal(&with_draco(&draco([0, 1, 2, 2, 1, 9])));
    assert!(outside.contains("out of range") || outside.contains("damaged"), "{outside}");
    let of = "/meshes/0/primitives/0/extensions/KHR_draco_mesh_compression";
    for (place, value, expected) in [
        ("/accessors/0/count".to_owned(), json!(5), "accessors[0].count: 5, but the compressed mesh has 4"),
        ("/accessors/1/count".to_owned(), json!(9), "accessors[1].count: 9, but the compressed mesh has 6"),
        ("/accessors/0/componentType".to_owned(), json!(5123), "accessors[0].type: the compressed mesh has 3 of"),
        (format!("{of}/attributes/POSITION"), json!(6), "POSITION: the compressed mesh has no attribute 6"),
        (format!("{of}/bufferView"), json!(1), "bufferView: 1 is out of range"),
    ] {
        let mut document = with_draco(&whole);
        *document.pointer_mut(&place).unwrap() = value;
        let line = made.refusal(&document);
        assert!(line.contains(expected), "{line}");
    }
    // A claim of faces and points that nothing stands behind.
    let mut greedy = whole[..11].to_vec();
    greedy.extend([0xff, 0xff, 0xff, 0xff, 0x0f, 0xff, 0xff, 0xff, 0xff, 0x0f, 1]);
    assert!(made.refusal(&with_draco(&greedy)).contains("pass the limit"));
}

/// A KTX2 file of blocks that are one colour each, by UASTC's mode for that; `zstd`: inside a frame that packs nothing.
fn ktx2(side: u32, color: [u8; 4], zstd: bool) -> Vec<u8> {
    const SOLID: u128 = 0b10111;
    let block = SOLID | u128::from(u32::from_le_bytes(color)) << 5;
    let blocks = side.div_ceil(4).pow(2) as usize;
    let plain = block.to_le_bytes().repeat(blocks);
    let mut level = plain.clone();
    if zstd {
        // One segment, its length in a byte; one block, the last, as it is.
        level = vec![0x28, 0xb5, 0x2f, 0xfd, 0x20, plain.len() as u8];
        level.extend(&((plain.len() as u32) << 3 | 1).to_le_bytes()[..3]);
        level.extend(&plain);
    }
    let (descriptor, data) = (104u32, 148u64);
    let mut bytes = b"\xABKTX 20\xBB\r\n\x1A\n".to_vec();
    for word in [0, 1, side, side, 0, 0, 1, 1, if zstd { 2 } else { 0 }, descriptor, 44, 0, 0, 0, 0, 0, 0] {
        bytes.extend(u32::to_le_bytes(word));
    }
    for word in [data, level.len() as u64, plain.len() as u64] {
        bytes.extend(word.to_le_bytes());
    }
    // Colour model 166: UASTC; sRGB; blocks of 4 x 4; channel 3: RGBA.
    for word in [44u32, 0, 40 << 16 | 2, 2 << 16 | 1 << 8 | 166, 3 << 8 | 3, 16, 0, 3 << 24 | 127 << 16, 0, 0, !0] {
        bytes.extend(word.to_le_bytes());
    }
    bytes.extend(level);
    bytes
}

fn with_texture(bytes: &[u8]) -> Value {
    let mut document = square();
    add_attribute(&mut document, "TEXCOORD_0", "VEC2", &[0., 1., 1., 1., 0., 0., 1., 0.]);
    document["images"] = json!([{"uri": base64(bytes)}]);
    document["textures"] = json!([{"extensions": {"KHR_texture_basisu": {"source": 0}}}]);
    document["materials"] = json!([{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}]);
    document["meshes"][0]["primitives"][0]["material"] = json!(0);
    document["extensionsRequired"] = json!(["KHR_texture_basisu"]);
    document
}

#[test]
fn ktx2_is_decoded_and_what_lies_in_it_is_refused() {
    let made = Fixture::new();
    let color = [200, 100, 50, 255];
    for zstd in [false, true] {
        let whole = ktx2(8, color, zstd);
        let scene = made.load(&with_texture(&whole)).unwrap();
        assert_sound(&scene);
        let texture = &scene.textures[0];
        assert_eq!((texture.width, texture.height, texture.srgb), (8, 8, true));
        assert!(texture.rgba8.chunks(4).all(|texel| texel == color), "{:?}", &texture.rgba8[..4]);
        for length in 12..whole.len() {
            let line = made.refusal(&with_texture(&whole[..length]));
            assert!(line.contains("images[0]: damaged image: ") && !line.contains('\n'), "{length}: {line}");
        }
        // Sizes that nothing stands behind.
        for (place, value) in [(20, 60_000u32), (20, 30_000), (24, 30_000), (96, !0), (88, !0)] {
            let mut lying = whole.clone();
            lying[place..place + 4].copy_from_slice(&value.to_le_bytes());
            assert!(made.refusal(&with_texture(&lying)).contains("images[0]: damaged image: "), "{place}");
        }
    }
    // Not Basis Universal: no fault of the file.
    let mut other = ktx2(8, color, false);
    other[12] = 37;
    let scene = made.load(&with_texture(&other)).unwrap();
    assert!(scene.textures.is_empty());
    assert!(scene.warnings.iter().any(|w| w.contains("KTX2 of Vulkan's format 37 is not read")));
}
