//! The outside of a glTF file: GLB chunks, JSON text, buffers in files and in data URIs.

use std::fs::File;
use std::io::Read;
use std::path::{Component, Path, PathBuf};

use super::json::At;
use super::meshopt;
use crate::scene::error::Fault;

const GLB_MAGIC: &[u8] = b"glTF";
const CHUNK_JSON: u32 = 0x4E4F_534A;
const CHUNK_BIN: u32 = 0x004E_4942;

/// Splits a file into its JSON text and, for GLB, its binary chunk. Which of the two it is, the content says; names lie.
pub(super) fn split(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), Fault> {
    if bytes.starts_with(b"version https://git-lfs") {
        return Err(Fault::new("file", "this is a Git LFS pointer; fetch the file itself with `git lfs pull`"));
    }
    if bytes.starts_with(GLB_MAGIC) { split_glb(bytes) } else { Ok((bytes, None)) }
}

fn split_glb(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), Fault> {
    let header = |reason: String| Fault::new("GLB header", reason);
    let word = |at: usize| {
        let four = bytes.get(at..at + 4)?;
        Some(u32::from_le_bytes([four[0], four[1], four[2], four[3]]))
    };
    let (Some(version), Some(length)) = (word(4), word(8)) else {
        return Err(header(format!("the file ends after {} bytes; a header has 12", bytes.len())));
    };
    if version != 2 {
        return Err(header(format!("version {version}; only 2 is supported")));
    }
    if length as usize != bytes.len() {
        return Err(header(format!(
            "it promises {length} bytes but the file has {}; the file is cut short or was changed as if it were text",
            bytes.len()
        )));
    }
    let (mut at, mut json, mut bin) = (12, None, None);
    while at < bytes.len() {
        let place = format!("GLB chunk at byte {at}");
        let (Some(size), Some(kind)) = (word(at), word(at + 4)) else {
            return Err(Fault::new(place, "its header is cut short"));
        };
        let Some(data) = bytes[at + 8..].get(..size as usize) else {
            return Err(Fault::new(place, format!("it promises {size} bytes but {} are left", bytes.len() - at - 8)));
        };
        match kind {
            CHUNK_JSON if json.is_none() && at == 12 => json = Some(data),
            _ if json.is_none() => return Err(Fault::new(place, "the first chunk must be JSON")),
            CHUNK_JSON => return Err(Fault::new(place, "a second JSON chunk")),
            CHUNK_BIN if bin.is_none() => bin = Some(data),
            CHUNK_BIN => return Err(Fault::new(place, "a second BIN chunk")),
            // The format says to skip kinds it does not know.
            _ => {}
        }
        at += 8 + size as usize;
    }
    match json {
        Some(json) => Ok((json, bin)),
        None => Err(header("there is no JSON chunk".to_owned())),
    }
}

/// The bytes of every buffer, each exactly as long as it says; none of one that stands in for what others unpack to.
pub(super) fn read_buffers(root: &At, bin: Option<&[u8]>, folder: &Path) -> Result<Vec<Vec<u8>>, Fault> {
    let mut buffers = Vec::new();
    let stand_ins = meshopt::stand_ins(root)?;
    for (index, buffer) in root.list("buffers")?.iter().enumerate() {
        let length = buffer.required(buffer.uint("byteLength")?, "byteLength")? as usize;
        if stand_ins[index] {
            buffers.push(Vec::new());
            continue;
        }
        let bytes = match (buffer.text("uri")?, bin) {
            (Some(uri), _) => {
                read_uri(uri, folder, Some(length as u64)).map_err(|reason| Fault::new(buffer.place("uri"), reason))?
            }
            (None, Some(bin)) if index == 0 => bin[..length.min(bin.len())].to_vec(),
            (None, _) => {
                return Err(Fault::new(
                    buffer.place("uri"),
                    "missing; only the first buffer of a .glb may stand in the file itself",
                ));
            }
        };
        if bytes.len() < length {
            return Err(Fault::new(
                buffer.place("byteLength"),
                format!("{length} bytes promised but {} are there", bytes.len()),
            ));
        }
        buffers.push(bytes);
    }
    Ok(buffers)
}

/// Reads what a URI names: a base64 data URI, or a file beside the glTF, of which at most `limit` bytes are wanted.
pub(super) fn read_uri(uri: &str, folder: &Path, limit: Option<u64>) -> Result<Vec<u8>, String> {
    if let Some(data) = uri.strip_prefix("data:") {
        let Some((head, body)) = data.split_once(',') else {
            return Err("a data URI without a comma".to_owned());
        };
        if !head.ends_with(";base64") {
            return Err("a data URI that is not base64".to_owned());
        }
        return decode_base64(body.as_bytes());
    }
    let path = folder.join(relative_path(uri)?);
    let fail = |e: std::io::Error| format!("cannot read '{}': {e}", path.display());
    let file = File::open(&path).map_err(fail)?;
    let meta = file.metadata().map_err(fail)?;
    // A device or a pipe could go on for ever.
    if !meta.is_file() {
        return Err(format!("'{}' is not a file", path.display()));
    }
    let mut bytes = Vec::new();
    file.take(limit.unwrap_or(meta.len()).min(meta.len())).read_to_end(&mut bytes).map_err(fail)?;
    Ok(bytes)
}

/// The path that a relative URI names, with its %XX decoded.
pub(super) fn relative_path(uri: &str) -> Result<PathBuf, String> {
    let scheme = uri.split(['/', '?', '#']).next().unwrap_or_default();
    if scheme.contains(':') {
        return Err(format!("'{uri}' is not a relative path; only data: URIs and files beside the glTF are read"));
    }
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.bytes();
    while let Some(byte) = rest.next() {
        if byte != b'%' {
            bytes.push(byte);
            continue;
        }
        let pair: Vec<u8> = rest.by_ref().take(2).collect();
        let decoded = std::str::from_utf8(&pair)
            .ok()
            .filter(|pair| pair.len() == 2)
            .and_then(|pair| u8::from_str_radix(pair, 16).ok());
        bytes.push(decoded.ok_or_else(|| format!("'{uri}' has a % without two hex digits"))?);
    }
    let text = String::from_utf8(bytes).map_err(|_| format!("'{uri}' is not UTF-8"))?;
    let path = PathBuf::from(text);
    let beside = path.components().all(|c| !matches!(c, Component::RootDir | Component::Prefix(_)));
    if path.as_os_str().is_empty() || !beside {
        return Err(format!("'{uri}' is not a relative path"));
    }
    Ok(path)
}

/// Decodes base64 (RFC 4648, both alphabets), with or without padding.
pub(super) fn decode_base64(text: &[u8]) -> Result<Vec<u8>, String> {
    let body = text.strip_suffix(b"=").unwrap_or(text);
    let body = body.strip_suffix(b"=").unwrap_or(body);
    let mut bytes = Vec::with_capacity(body.len() / 4 * 3 + 3);
    let (mut bits, mut held) = (0u32, 0);
    for &c in body {
        let six = match c {
            b'A'..=b'Z' => c - b'A',
            b'a'..=b'z' => c - b'a' + 26,
            b'0'..=b'9' => c - b'0' + 52,
            b'+' | b'-' => 62,
            b'/' | b'_' => 63,
            _ => return Err(format!("byte {c:#04x} is not base64")),
        };
        bits = (bits << 6) | u32::from(six);
        held += 6;
        if held >= 8 {
            held -= 8;
            bytes.push((bits >> held) as u8);
        }
    }
    if body.len() % 4 == 1 {
        return Err("base64 that is cut short".to_owned());
    }
    Ok(bytes)
}
