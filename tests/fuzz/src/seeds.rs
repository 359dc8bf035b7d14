//! What fuzzing starts from.

use super::glb;
use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};

/// Every glTF file under `from` that takes at most so many bytes as one file, in `to`; and what lies packed in them, alone.
pub fn collect(from: &Path, to: &Path, most: usize) {
    let all = files(from).into_iter().filter_map(|path| seeds(&path)).flatten();
    for (i, seed) in all.filter(|seed| seed.len() <= most).enumerate() {
        fs::write(to.join(i.to_string()), seed).expect("a folder to write to");
    }
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    entries.flat_map(|path| if path.is_dir() { files(&path) } else { vec![path] }).collect()
}

/// Nothing where the file is no glTF, or lacks what it names.
fn seeds(path: &Path) -> Option<Vec<Vec<u8>>> {
    let bytes = fs::read(path).ok()?;
    let word = |at: usize| Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?) as usize);
    if path.extension()? == "glb" {
        let text = word(12)?;
        let document = serde_json::from_slice(bytes.get(20..20 + text)?).ok();
        let packed = document.map(|d| packed(&d, bytes.get(28 + text..).unwrap_or(&[])));
        return Some([vec![bytes], packed.unwrap_or_default()].concat());
    }
    if path.extension()? != "gltf" {
        return None;
    }
    let mut document: Value = serde_json::from_slice(&bytes).ok()?;
    let folder = path.parent()?;
    let beside =
        |item: &Value| fs::read(folder.join(item["uri"].as_str().filter(|uri| !uri.starts_with("data:"))?)).ok();
    let Some(mut chunk) = document["buffers"].get(0).and_then(beside) else { return Some(vec![bytes]) };
    document["buffers"][0].as_object_mut()?.remove("uri");
    for i in 0..document["images"].as_array().map_or(0, Vec::len) {
        if let Some(image) = beside(&document["images"][i]) {
            chunk.resize(chunk.len().next_multiple_of(4), 0);
            let view = document["bufferViews"].as_array()?.len();
            document["bufferViews"]
                .as_array_mut()?
                .push(json!({"buffer": 0, "byteOffset": chunk.len(), "byteLength": image.len()}));
            document["images"][i].as_object_mut()?.remove("uri");
            document["images"][i]["bufferView"] = json!(view);
            chunk.extend(image);
        }
    }
    document["buffers"][0]["byteLength"] = json!(chunk.len());
    let packed = packed(&document, &chunk);
    Some([vec![glb::write(&document, &glb::binary(&chunk))], packed].concat())
}

/// What starts a view of the file's own chunk as a packed mesh or image does.
fn packed(document: &Value, chunk: &[u8]) -> Vec<Vec<u8>> {
    let views = document["bufferViews"].as_array().into_iter().flatten();
    let own = views.filter(|view| view["buffer"] == 0).filter_map(|view| {
        let start = view["byteOffset"].as_u64().unwrap_or(0) as usize;
        chunk.get(start..start + view["byteLength"].as_u64()? as usize)
    });
    own.filter(|bytes| glb::around(bytes).is_some()).map(<[u8]>::to_vec).collect()
}
