//! An interrupted integral goes on where it was, to the bit; a state of anything else is not used.

use pdss::frame::{Inputs, Output};
use pdss::scene::{Camera, Light, Scene};
use pdss::settings::{Settings, Size};
use pdss::skin::profile::Profile;
use pdss::truth::{self, Checkpoint, Effort, Truth};
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

type Outcome = Result<(), Box<dyn std::error::Error>>;

const EFFORT: Effort = Effort { samples: 200_000, max_error: 1., opening: 0.2 };

/// A sphere of 160 x 160 pixels lit from `yaw`; `half_way` is told when half is done.
fn solve(file: &Path, yaw: f64, half_way: impl Fn() + Sync) -> Result<Truth, Box<dyn std::error::Error>> {
    let mut scene = Scene::shape("shape:sphere:10")?;
    scene.assign_profile(None, 0)?;
    let settings = Settings { size: Size { width: 160, height: 160 }, no_shadows: true, ..Settings::default() };
    let inputs = Inputs {
        camera: Camera::orbit(0., 0., 50., None, 30., &scene),
        scene: &scene,
        lights: vec![Light::directional(yaw, 20., 1.)],
        profiles: vec![Profile::resolve("skin")?],
        settings,
        timing: None,
        output: Output::Linear,
    };
    let checkpoint = Checkpoint { file: file.to_owned(), every: Duration::ZERO };
    Ok(truth::resume(&inputs, None, &EFFORT, Some(&checkpoint), |part| {
        if part > 700 {
            half_way()
        }
    })?)
}

#[test]
fn an_interrupted_run_goes_on_to_the_same_bits() -> Outcome {
    let dir = tempfile::tempdir()?;
    let (file, left) = (dir.path().join("a.state"), dir.path().join("b.state"));
    // What a run that dies then leaves behind.
    let keep = || {
        let _ = std::fs::copy(&file, &left);
    };
    let whole = solve(&file, 60., keep)?;
    let (state, fresh) = (std::fs::read(&left)?, dir.path().join("c.state"));
    let resumed = solve(&left, 60., || ())?;
    println!("{} of {} pixels taken over", resumed.resumed, resumed.pixels.len());
    assert!(whole.resumed == 0 && resumed.resumed >= 8192 && resumed.resumed < resumed.pixels.len());
    assert!(resumed.pixels == whole.pixels && resumed.halves == whole.halves && resumed.error == whole.error);
    assert!(resumed.seconds > 0. && resumed.warnings == whole.warnings);
    let warned = |t: &Truth, words: &str| t.warnings.iter().any(|w| w.contains(words));
    // The twins. Another light: a state that is not used, said so.
    std::fs::write(&fresh, &state)?;
    let other = solve(&fresh, 61., || ())?;
    assert!(
        other.resumed == 0 && warned(&other, "other settings") && other.pixels != whole.pixels,
        "{:?}",
        other.warnings
    );
    // A bit of a result turned, the end lost, something else altogether.
    let mut bits = state.clone();
    bits[state.len() / 2] ^= 1;
    for (bytes, words) in
        [(&bits[..], "damaged"), (&state[..state.len() - 40], "damaged"), (b"not a state", "no state")]
    {
        std::fs::write(&fresh, bytes)?;
        let again = solve(&fresh, 60., || ())?;
        assert!(
            again.resumed == 0 && warned(&again, words) && again.pixels == whole.pixels,
            "{words}: {:?}",
            again.warnings
        );
    }
    Ok(())
}

#[test]
fn a_killed_run_leaves_no_half_a_picture_and_is_taken_up() -> Outcome {
    let dir = tempfile::tempdir()?;
    let run = |name: &str| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_pdss"));
        let file = dir.path().join(name);
        command.args(["truth", "shape:torus:10,4", "--size", "256x256", "--samples", "100000", "--light", "80,15"]);
        command.args(["--save-every", "0", "-o"]).arg(file);
        command
    };
    let there = |name: &str| dir.path().join(name).is_file();
    let mut child = run("a.exr").stdout(std::process::Stdio::null()).spawn()?;
    let start = Instant::now();
    while !there("a.exr.state") && child.try_wait()?.is_none() && start.elapsed() < Duration::from_secs(120) {
        std::thread::sleep(Duration::from_millis(2));
    }
    child.kill()?;
    let interrupted = !child.wait()?.success();
    assert!(interrupted && there("a.exr.state") && !there("a.exr") && !there("a.json") && !there("a.bands.exr"));
    assert!(run("a.exr").output()?.status.success() && run("b.exr").output()?.status.success());
    assert_eq!(std::fs::read(dir.path().join("a.exr"))?, std::fs::read(dir.path().join("b.exr"))?);
    let record = |name: &str| -> Result<serde_json::Value, Box<dyn std::error::Error>> {
        Ok(serde_json::from_slice(&std::fs::read(dir.path().join(name))?)?)
    };
    let (a, b) = (record("a.json")?, record("b.json")?);
    assert!(a["resumed_pixels"].as_u64() > Some(0) && b["resumed_pixels"] == 0, "{a} {b}");
    for key in ["error", "effort", "samples", "covered_pixels"] {
        assert_eq!(a[key], b[key], "{key}");
    }
    assert!(!there("a.exr.state") && !there("b.exr.state"), "the state goes when the result is there");
    Ok(())
}
