//! Coverage-guided fuzzing of the glTF loader: whatever the bytes, a scene that is sound or one line; no panic, no hang, no
//! more memory than 16 times the file and 256 MiB. A packed mesh or image by itself is read from a file made around it.
//! `tests/fuzz/run SECONDS` builds and runs it.
#![no_main]
#![allow(dead_code, unused_imports)]

extern crate self as pdss;

#[path = "../../../src/scene/mod.rs"]
pub mod scene;

#[path = "../../scene/check.rs"]
mod check;
mod glb;
mod json;
mod memory;
mod seeds;

use libfuzzer_sys::{fuzz_mutator, fuzz_target};
use scene::{LoadOptions, Pose, Scene};

/// What reading may take beside 16 times the file.
const FLOOR: usize = 256 << 20;

fuzz_target!(init: {
    // `run` asks so for the seeds, before the fuzzing.
    if let Some(from) = std::env::var_os("SEEDS_FROM") {
        seeds::collect(from.as_ref(), "seeds".as_ref(), 1 << 16);
    }
}, |bytes: &[u8]| {
    let path = std::env::temp_dir().join(format!("pdss-fuzz-{}.gltf", std::process::id()));
    let around = glb::around(bytes);
    let bytes = around.as_deref().unwrap_or(bytes);
    std::fs::write(&path, bytes).expect("a folder to write to");
    let pose = (bytes.len() % 4 < 2).then_some(Pose { animation: 0, time: 0.4 });
    let options = LoadOptions { mm_per_unit: None, keep_uvs: bytes.len() % 2 == 0, pose };
    let before = memory::restart();
    let read = Scene::load(&path, &options);
    let peak = memory::peak() - before;
    assert!(peak <= 16 * bytes.len() + FLOOR, "{} MiB for {} bytes", peak >> 20, bytes.len());
    match read {
        Ok(scene) => assert_eq!(check::fault_of(&scene), None),
        Err(error) => assert!(!error.to_string().contains('\n'), "{error}"),
    }
});

fuzz_mutator!(|data: &mut [u8], size: usize, max: usize, seed: u32| {
    // Bytes as libFuzzer sees fit half of the time; else values of the document, so that it stays one.
    if seed % 2 == 0
        && let Some(changed) = json::mutate(&data[..size], max, u64::from(seed))
    {
        data[..changed.len()].copy_from_slice(&changed);
        return changed.len();
    }
    libfuzzer_sys::fuzzer_mutate(data, size, max)
});
