//! Debian and Ubuntu ship a `libshaderc_combined.a` that combines nothing: glslang and
//! SPIRV-Tools stay in archives of their own, and a program that links only the first
//! ends in undefined symbols. Where that is so, link the others too. Elsewhere (a
//! shared libshaderc, a complete archive, a build from source) do nothing.

use std::{
    env, fs,
    path::{Path, PathBuf},
};

/// Whatever glslang's releases call their parts; those that are present are linked.
const PARTS: [&str; 9] = [
    "glslang",
    "MachineIndependent",
    "GenericCodeGen",
    "OSDependent",
    "OGLCompiler",
    "HLSL",
    "SPIRV",
    "SPIRV-Tools-opt",
    "SPIRV-Tools",
];

/// A function of glslang, `glslang::InitializeProcess()`: an archive that defines it needs no help.
const INSIDE: &str = "_ZN7glslang17InitializeProcessEv";

/// `stub_library_function()`: all there is in the archives that newer releases of glslang keep
/// for their names' sake, and in every one of them the same, so two cannot be linked whole.
const STUB: &str = "_Z21stub_library_functionv";

fn main() {
    println!("cargo::rerun-if-env-changed=SHADERC_LIB_DIR");
    println!("cargo::rerun-if-env-changed=VULKAN_SDK");
    if var("CARGO_CFG_TARGET_OS") != "linux" {
        return;
    }
    let Some(directory) = directory() else {
        return;
    };
    let combined = directory.join("libshaderc_combined.a");
    let Ok(archive) = fs::read(&combined) else {
        return;
    };
    println!("cargo::rerun-if-changed={}", combined.display());
    if defines(&archive, INSIDE) {
        return;
    }

    println!("cargo::rustc-link-search=native={}", directory.display());
    for part in PARTS {
        let archive = fs::read(directory.join(format!("lib{part}.a")));
        if archive.is_ok_and(|archive| !defines(&archive, STUB)) {
            // Whole, because rustc names these before shaderc's archive, which needs them,
            // and GNU ld takes from an archive only what is wanted when it comes by. What
            // stays unused is dropped again by --gc-sections.
            println!("cargo::rustc-link-lib=static:-bundle,+whole-archive={part}");
        }
    }
}

/// Where shaderc-sys takes its archive from. It tells nobody, so this is its search over
/// again: what the environment names, what pkg-config knows, what the system uses.
fn directory() -> Option<PathBuf> {
    if let Ok(named) = env::var("SHADERC_LIB_DIR") {
        return Some(named.into());
    }
    if let Ok(sdk) = env::var("VULKAN_SDK") {
        return Some(Path::new(&sdk).join("lib"));
    }
    if let Ok(mut found) = pkg_config::Config::new().cargo_metadata(false).probe("shaderc") {
        if !found.link_paths.is_empty() {
            return Some(found.link_paths.swap_remove(0));
        }
    }
    let multiarch = format!("/usr/lib/{}-linux-gnu", var("CARGO_CFG_TARGET_ARCH"));
    [&multiarch, "/usr/lib64", "/usr/lib"].into_iter().map(PathBuf::from).find(|path| path.is_dir())
}

fn var(name: &str) -> String {
    env::var(name).unwrap_or_default()
}

/// Whether an archive's symbol table lists a definition of `symbol`.
///
/// The table is the first member of a GNU archive, named `/`: a big-endian count, as many
/// offsets, then the names, each closed by a zero byte. The member's header of 60 bytes
/// follows the 8 of the archive's magic, and holds the size, in decimal, at 48.
fn defines(archive: &[u8], symbol: &str) -> bool {
    let table = || {
        let header = archive.strip_prefix(b"!<arch>\n")?.get(..60)?;
        let size: usize = str::from_utf8(&header[48..58]).ok()?.trim().parse().ok()?;
        let member = archive.get(68..68 + size)?;
        let count = u32::from_be_bytes(member.get(..4)?.try_into().ok()?) as usize;
        header.starts_with(b"/ ").then_some(())?;
        member.get(4 + 4 * count..)
    };
    table().is_some_and(|names| names.split(|&byte| byte == 0).any(|name| name == symbol.as_bytes()))
}
