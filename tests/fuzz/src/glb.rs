//! Documents and the bytes beside them in one file.

use serde_json::{Value, json};

/// The file of a document (its first chunk) and the chunks that follow it as they are in a file.
pub fn write(document: &Value, rest: &[u8]) -> Vec<u8> {
    let mut text = document.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut file = b"glTF\x02\0\0\0".to_vec();
    file.extend((20 + text.len() as u32 + rest.len() as u32).to_le_bytes());
    file.extend((text.len() as u32).to_le_bytes());
    file.extend_from_slice(b"JSON");
    file.extend(text);
    file.extend(rest);
    file
}

/// A chunk of plain bytes.
pub fn binary(bytes: &[u8]) -> Vec<u8> {
    let length = bytes.len().next_multiple_of(4);
    let mut chunk = (length as u32).to_le_bytes().to_vec();
    chunk.extend_from_slice(b"BIN\0");
    chunk.extend(bytes);
    chunk.resize(8 + length, 0);
    chunk
}

/// A Draco mesh or a KTX2 image as the only one of a file; `None` for other bytes.
pub fn around(bytes: &[u8]) -> Option<Vec<u8>> {
    let mut document = json!({
        "asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "buffers": [{"byteLength": bytes.len()}], "bufferViews": [{"buffer": 0, "byteLength": bytes.len()}],
        "accessors": [{"componentType": 5126, "type": "VEC3", "count": 4}, {"componentType": 5121, "type": "SCALAR", "count": 6}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
    });
    if bytes.starts_with(b"DRACO") {
        document["meshes"][0]["primitives"][0]["extensions"] =
            json!({"KHR_draco_mesh_compression": {"bufferView": 0, "attributes": {"POSITION": 0}}});
    } else if bytes.starts_with(b"\xABKTX 20") {
        document["images"] = json!([{"bufferView": 0, "mimeType": "image/ktx2"}]);
        document["textures"] = json!([{"extensions": {"KHR_texture_basisu": {"source": 0}}}]);
        document["materials"] = json!([{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}]);
        document["meshes"][0]["primitives"][0]["material"] = json!(0);
    } else {
        return None;
    }
    Some(write(&document, &binary(bytes)))
}
