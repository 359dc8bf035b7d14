//! Files made by others, through loading and drawing: within time and memory, on one device, without a word of the
//! validation layers. `tests/scene/collection.rs` looks at what was loaded.
#[path = "fuzz/src/memory.rs"]
mod memory;
mod studio;

use pdss::frame::{Output, Renderer};
use pdss::scene::{Alpha, Camera, Light, LoadOptions, Scene};
use pdss::settings::{Method, Settings, Size};
use std::path::{Path, PathBuf};
use std::time::Instant;
use studio::Set;

const SIZE: u32 = 48;
/// What loading may allocate beside 16 times the bytes of the file and of those it names.
const FLOOR: u64 = 256 << 20;
/// Longer than this for a file is taken for a hang, seconds: the largest takes 2 here.
const PATIENCE: f64 = 30.;

fn models() -> Option<PathBuf> {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../shared/models"));
    let there = folder.is_dir();
    if !there {
        eprintln!("skipped: the model collection is not here");
    }
    there.then(|| folder.to_owned())
}

fn files_below(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap().flatten() {
        let path = entry.path();
        match path.extension().and_then(|e| e.to_str()) {
            _ if path.is_dir() => files_below(&path, found),
            Some("gltf" | "glb") => found.push(path),
            _ => {}
        }
    }
}

/// Bytes of a file and of all beside it that its text could mean: what its reader has to take in.
fn bytes_of(file: &Path) -> u64 {
    let beside = std::fs::read_dir(file.parent().unwrap()).unwrap().flatten();
    let text = String::from_utf8_lossy(&std::fs::read(file).unwrap()).replace("%20", " ");
    let named = |path: &Path| path == file || path.file_name().is_some_and(|n| text.contains(&*n.to_string_lossy()));
    let files = beside.map(|e| e.path()).filter(|p| p.is_file() && named(p));
    files.map(|p| p.metadata().unwrap().len()).sum()
}

/// A picture of a scene; how many of its pixels show something, and whether all are numbers.
fn draw(gpu: &std::sync::Arc<pdss::gpu::Gpu>, scene: &Scene) -> (usize, bool) {
    let size = Size { width: SIZE, height: SIZE };
    let mut scene = scene.clone();
    scene.assign_profile(None, 0).unwrap();
    let set = Set {
        camera: scene.cameras.first().cloned().unwrap_or_else(|| Camera::default_for(&scene, 30., 1.)),
        lights: vec![Light::directional(60., 25., 3.), Light::directional(-70., 10., 0.6)],
        profile: Some(studio::wax()),
        settings: Settings { method: Method::Pdss, size, ..Settings::default() },
        output: Output::Linear,
        scene: scene.into(),
    };
    let mut renderer = Renderer::new(gpu, set.inputs()).unwrap();
    renderer.run().unwrap();
    let pixels = renderer.linear().unwrap();
    (pixels.iter().filter(|p| p[3] > 0.).count(), pixels.as_flattened().iter().all(|x| x.is_finite()))
}

#[test]
fn every_file_is_drawn_or_refused_in_one_line() {
    let Some(folder) = models() else { return };
    // The meter sees what is taken, and given back.
    let before = memory::restart();
    drop(std::hint::black_box(vec![1u8; 64 << 20]));
    assert!((64 << 20..80 << 20).contains(&(memory::peak() - before)));
    let table = std::fs::read_to_string(folder.join("malformed/EXPECTED.tsv")).unwrap();
    let verdict = |file: &Path| {
        let path = file.strip_prefix(folder.join("malformed")).ok()?.to_str()?;
        table.lines().find_map(|l| {
            let columns: Vec<_> = l.split('\t').collect();
            (columns.get(1) == Some(&path)).then(|| columns[2].to_owned())
        })
    };
    let mut files = Vec::new();
    files_below(&folder, &mut files);
    files.sort();
    let gpu = studio::open();
    let (mut drawn, mut empty, mut refused, mut faults) = (0, 0, 0, Vec::new());
    let (mut slowest, mut greatest) = ((0f64, String::new()), (0f64, String::new()));
    for file in &files {
        let short = file.strip_prefix(&folder).unwrap().display().to_string();
        let (bytes, start, before) = (bytes_of(file), Instant::now(), memory::restart() as u64);
        let read = Scene::load(file, &LoadOptions::default());
        let (seconds, peak) = (start.elapsed().as_secs_f64(), memory::peak() as u64 - before);
        let part = peak as f64 / (16 * bytes + FLOOR) as f64;
        if part > greatest.0 {
            greatest = (part, format!("{short}: {} MiB for {} KiB", peak >> 20, bytes >> 10));
        }
        if seconds > slowest.0 {
            slowest = (seconds, short.clone());
        }
        if part > 1. || seconds > PATIENCE {
            faults.push(format!("{short}: {} MiB for {} KiB, {seconds:.1} s", peak >> 20, bytes >> 10));
        }
        let expected = verdict(file);
        match read {
            Ok(_) if expected.as_deref() == Some("REFUSE") => faults.push(format!("{short}: it must be refused")),
            Ok(scene) if scene.triangle_count() == 0 => empty += 1,
            Ok(scene) => {
                drawn += 1;
                let blends = scene.materials.iter().filter(|m| m.alpha == Alpha::Blend).count();
                let (seen, finite) = draw(&gpu, &scene);
                // Files that lie may put everything out of sight, and a blend may be clear; all others show something.
                if !finite || (seen == 0 && expected.is_none() && blends < scene.materials.len()) {
                    faults.push(format!("{short}: {seen} pixels, finite: {finite}"));
                }
                for message in gpu.messages().into_iter().take(1) {
                    faults.push(format!("{short}: {message}"));
                }
            }
            Err(error) => {
                refused += 1;
                let line = error.to_string();
                // The file, the place in it, what is wrong.
                if line.contains('\n') || !line.contains(&short) || line.matches(": ").count() < 2 {
                    faults.push(format!("{short}: not one line of file, place and reason: {line}"));
                }
            }
        }
    }
    println!("{} files: {drawn} drawn, {empty} without triangles, {refused} refused", files.len());
    println!(
        "memory: {:.2} of what is allowed, {}; slowest: {:.2} s, {}",
        greatest.0, greatest.1, slowest.0, slowest.1
    );
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert!(drawn > 70 && refused > 20);
    studio::close(gpu);
}
