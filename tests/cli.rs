//! The command line from outside: exit codes, which stream says what, and files that appear whole or not at all.

use std::error::Error;
use std::path::Path;
use std::process::{Command, Output};

type Outcome = Result<(), Box<dyn Error>>;

fn pdss(args: &[&str]) -> Result<Output, std::io::Error> {
    Command::new(env!("CARGO_BIN_EXE_pdss")).args(args).output()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Why the output is not that of a refusal with this code: one line of ours on stderr (clap says more), nothing on stdout.
fn fault(out: &Output, code: i32, words: &str) -> Option<String> {
    let err = text(&out.stderr);
    let ours = err.starts_with("pdss: ") && err.lines().count() == 1;
    let good = out.status.code() == Some(code)
        && out.stdout.is_empty()
        && (ours || err.starts_with("error: "))
        && err.contains(words)
        && !err.contains("panicked");
    (!good).then(|| format!("{:?}: {err}", out.status))
}

/// There is no point in asking for a picture where there is no device; everywhere else a failure is a failure.
fn no_device() -> bool {
    let none = pdss(&["devices"]).is_ok_and(|o| o.status.code() == Some(3));
    if none {
        eprintln!("skipped: no Vulkan device");
    }
    none
}

#[test]
fn bad_usage_and_bad_input_exit_with_2_and_say_why() -> Outcome {
    let dir = tempfile::tempdir()?;
    let picture = dir.path().join("a.png");
    let picture = picture.to_str().ok_or("temporary directories have plain names")?;
    let render = |more: &[&'static str]| [&["render", "-o", picture], more].concat();
    let cases: Vec<(Vec<&str>, &str)> = vec![
        (vec![], "Usage"),
        (vec!["paint"], "paint"),
        (vec!["render"], "-output"),
        (vec!["render", "-o", "a.jpg"], ".png or .exr"),
        (vec!["render", "-o", "no/such/directory/a.png"], "no/such/directory"),
        (render(&["shape:teapot"]), "teapot"),
        (render(&["shape:sphere:-1"]), "-1"),
        (render(&["no-such-file.glb"]), "no-such-file.glb"),
        (render(&["--profile", "adamantium"]), "skin"),
        (render(&["--profile", "no-such-file.toml"]), "no-such-file.toml"),
        (render(&["--profile", "skin", "--profile-material", "nobody"]), "nobody"),
        (render(&["--profile-material", "Hair=adamantium"]), "adamantium"),
        (render(&["--profile-material", "nobody=marble"]), "'Hair'"),
        (render(&["--size", "640"]), "640"),
        (render(&["--size", "0x480"]), "0x480"),
        (render(&["--method", "magic"]), "lambert"),
        (render(&["--camera", "1,2"]), "yaw,pitch,distance"),
        (render(&["--camera", "-35,5,-750"]), "above 0"),
        (render(&["--camera-index", "3"]), "bust has 1 cameras"),
        (render(&["--light", "1,2,-3"]), "negative"),
        (render(&["--fov", "180"]), "180"),
        (render(&["--mm-per-unit", "0"]), "above 0"),
        (vec!["profile", "--frames", "0"], "--frames"),
        (vec!["profile", "--timing", "guess"], "isolated"),
        (vec!["explain", "shape:teapot"], "teapot"),
    ];
    for (args, words) in cases {
        let out = pdss(&args)?;
        if args.is_empty() {
            assert_eq!(out.status.code(), Some(2));
            assert!(text(&out.stderr).contains(words));
        } else if let Some(fault) = fault(&out, 2, words) {
            panic!("{args:?}: {fault}");
        }
    }
    assert_eq!(std::fs::read_dir(dir.path())?.count(), 0, "a refusal leaves nothing behind");
    Ok(())
}

#[test]
fn the_check_of_a_refusal_can_fail() -> Outcome {
    let help = pdss(&["--help"])?;
    assert!(help.status.success() && !help.stdout.is_empty());
    assert!(fault(&help, 2, "").is_some());
    let refused = pdss(&["explain", "shape:teapot"])?;
    assert!(fault(&refused, 3, "teapot").is_some(), "another code");
    assert!(fault(&refused, 2, "kettle").is_some(), "other words");
    Ok(())
}

#[test]
fn a_device_that_is_not_there_exits_with_3() -> Outcome {
    let dir = tempfile::tempdir()?;
    let picture = dir.path().join("a.png").to_string_lossy().into_owned();
    let out = pdss(&["render", "-o", &picture, "--device", "no such device", "--size", "8x8"])?;
    assert_eq!(fault(&out, 3, "no usable Vulkan device"), None);
    Ok(())
}

#[test]
fn devices_are_listed_as_json() -> Outcome {
    if no_device() {
        return Ok(());
    }
    let out = pdss(&["devices", "--format", "json"])?;
    let list: serde_json::Value = serde_json::from_slice(&out.stdout)?;
    assert!(list[0]["name"].is_string() && list[0]["driver"].is_string(), "{list}");
    Ok(())
}

#[test]
fn pictures_have_the_size_that_was_asked_for() -> Outcome {
    if no_device() {
        return Ok(());
    }
    let dir = tempfile::tempdir()?;
    let render = |name: &str, more: &[&str]| -> Result<image::DynamicImage, Box<dyn Error>> {
        let file = dir.path().join(name).to_string_lossy().into_owned();
        let fixed = [
            "render",
            "shape:sphere:20",
            "-o",
            &file,
            "--size",
            "96x64",
            "--camera",
            "-35,5,200",
            "--light",
            "-70,10,0.6",
        ];
        let out = pdss(&[&fixed, more].concat())?;
        assert!(out.status.success() && out.stdout.is_empty(), "{more:?}: {}", text(&out.stderr));
        Ok(image::ImageReader::open(Path::new(&file))?.decode()?)
    };
    for more in [&[][..], &["--view", "curvature"], &["--method", "lambert"]] {
        let png = render("a.png", more)?.into_rgba8();
        assert_eq!(png.dimensions(), (96, 64));
        assert!(png.pixels().any(|p| p != png.get_pixel(0, 0)), "{more:?}: a picture of nothing");
    }
    let exr = render("a.exr", &["--view", "normal"])?.into_rgba32f();
    let length = |p: &[f32; 4]| p[..3].iter().map(|x| x * x).sum::<f32>().sqrt();
    let covered: Vec<[f32; 4]> = exr.pixels().map(|p| p.0).filter(|p| p[3] > 0.).collect();
    let odd: Vec<_> = covered.iter().filter(|p| p[3] != 1. || (length(p) - 1.).abs() > 1e-3).take(4).collect();
    // The silhouette's radius is 32 px tan(asin(20 / 200)) / tan(15 degrees) = 12.0 px.
    assert!((440..465).contains(&covered.len()), "{} pixels covered", covered.len());
    assert!(odd.is_empty(), "normals are not unit, or A is not coverage: {odd:?}");
    Ok(())
}

#[test]
fn a_profile_is_json_on_stdout_alone() -> Outcome {
    if no_device() {
        return Ok(());
    }
    let args = ["profile", "shape:sphere:20", "--size", "96x64", "--frames", "3", "--warmup", "1", "--format"];
    for timing in ["overlap", "isolated"] {
        let out = pdss(&[&args[..], &["json", "--timing", timing]].concat())?;
        assert!(out.status.success(), "{}", text(&out.stderr));
        let record: serde_json::Value = serde_json::from_slice(&out.stdout)?;
        assert_eq!(record["timing"], timing);
        assert_eq!(record["size"], serde_json::json!([96, 64]));
        assert_eq!(record["frame"]["wall_ms"]["n"], 3);
        let covered = record["covered_pixels"].as_u64().unwrap_or(0);
        assert!((500..96 * 64).contains(&covered), "{covered} pixels covered");
        let stages = record["stages"].as_array().map_or(0, Vec::len);
        assert!(stages > 3 && out.stderr.is_empty(), "{stages} stages; {}", text(&out.stderr));
    }
    let trace: serde_json::Value = serde_json::from_slice(&pdss(&[&args[..], &["trace"]].concat())?.stdout)?;
    assert!(trace["traceEvents"].as_array().is_some_and(|e| e.len() > 5));
    let csv = text(&pdss(&[&args[..], &["csv"]].concat())?.stdout);
    assert!(csv.starts_with("stage,median_ms,") && csv.lines().last().is_some_and(|l| l.starts_with("frame (wall),")));
    Ok(())
}

#[test]
fn a_plan_explains_every_wait() -> Outcome {
    let out = pdss(&["explain", "shape:sphere:20", "--format", "json"])?;
    assert!(out.status.success(), "{}", text(&out.stderr));
    let plan: serde_json::Value = serde_json::from_slice(&out.stdout)?;
    let passes = plan["passes"].as_array().ok_or("a plan has passes")?;
    let reasons: Vec<&str> = passes
        .iter()
        .flat_map(|p| p["barriers"].as_array().into_iter().flatten())
        .filter_map(|b| b["reason"].as_str())
        .collect();
    let kinds = [
        "read after write: ",
        "write after read: ",
        "write after write: ",
        "layout: ",
        "next frame: ",
        "reuse of memory: ",
    ];
    let odd: Vec<&&str> = reasons.iter().filter(|r| !kinds.iter().any(|k| r.starts_with(k))).collect();
    assert!(odd.is_empty(), "{odd:?}");
    for kind in ["read after write: ", "next frame: "] {
        assert!(reasons.iter().any(|r| r.starts_with(kind)), "no {kind}among {reasons:?}");
    }
    let table = text(&pdss(&["explain", "shape:sphere:20"])?.stdout);
    assert!(table.contains("left out") && table.contains("bytes per pixel"), "{table}");
    Ok(())
}

#[test]
fn truth_is_written_whole_with_its_error_and_diff_reads_it_back() -> Outcome {
    let dir = tempfile::tempdir()?;
    let path = |name: &str| dir.path().join(name).display().to_string();
    let (whole, window, narrow) = (path("a.exr"), path("b.exr"), path("c.exr"));
    let solve = |more: &[&str]| {
        let scene = ["truth", "shape:sphere:10", "--light", "60,20", "--samples", "20000"];
        pdss(&[&scene, more].concat())
    };
    assert!(solve(&["--size", "24x16", "-o", &whole])?.status.success());
    assert!(solve(&["--size", "24x16", "--crop", "8,4,8,8", "-o", &window])?.status.success());
    assert!(solve(&["--size", "8x8", "--profile", "none", "-o", &narrow])?.status.success());
    let record: serde_json::Value = serde_json::from_slice(&std::fs::read(path("a.json"))?)?;
    assert_eq!((&record["schema"], &record["size"]), (&1.into(), &serde_json::json!([24, 16])));
    assert!(record["error"]["rms"].as_f64().is_some_and(|e| e > 0. && e < 0.01), "{record}");
    let diff = |args: &[&str]| pdss(&[&["diff"], args].concat());
    let json = |args: &[&str]| -> Result<serde_json::Value, Box<dyn Error>> {
        Ok(serde_json::from_slice(&diff(&[args, &["--format", "json"]].concat())?.stdout)?)
    };
    let same = json(&[&whole, &whole, "-o", &path("heat.png")])?;
    assert_eq!((&same["whole"]["rmse"], &same["bands"][0][0]), (&0.0.into(), &"silhouette".into()));
    assert!(dir.path().join("heat.png").is_file());
    let other = json(&[&window, &narrow])?;
    assert!(other["whole"]["rmse"].as_f64().is_some_and(|e| e > 0.01), "the twin: different pictures differ: {other}");
    assert!(text(&diff(&[&whole, &whole])?.stdout).contains("terminator"));
    let missing = path("none.exr");
    let png = path("codes.png");
    image::RgbaImage::from_pixel(8, 8, image::Rgba([188, 188, 188, 255])).save(&png)?;
    let flat = path("flat.exr");
    pdss::report::picture::write_exr(Path::new(&flat), [8, 8], &[[0.502_886_5, 0.502_886_5, 0.502_886_5, 1.]; 64])?;
    let codes = json(&[&png, &flat])?;
    assert!(codes["whole"]["rmse"].as_f64().is_some_and(|e| e < 1e-6), "code 188 is half of white's light: {codes}");
    assert_eq!(codes["read_as"][0], "display light, decoded from sRGB");
    let left = path("left.png");
    let white = |x: u32, _| image::Rgba([if x < 4 { 255 } else { 0 }, 0, 0, 255]);
    image::RgbaImage::from_fn(8, 8, white).save(&left)?;
    let pixels = |args: &[&str]| json(args).map(|j| j["whole"]["pixels"].as_u64());
    assert_eq!((pixels(&[&flat, &flat])?, pixels(&[&flat, &flat, "--mask", &left])?), (Some(64), Some(32)));
    let hdr = json(&[&window, &narrow, "--hdr"])?;
    assert!(hdr["hdr_flip"]["mean"].as_f64().is_some_and(|f| f > 0.01), "{hdr}");
    let cases: [(&[&str], &str); 8] = [
        (&[&whole, &window], "8x8"),
        (&[&whole, &missing], "none.exr"),
        (&[&whole, &path("a.json")], "a.json"),
        (&[&whole, &whole, "--mask", &window], "mask"),
        (&[&whole, &whole, "--bands", &window], "bands"),
        (&[&png, &flat, "--hdr"], "two .exr"),
        (&[&whole, &whole, "--full", "0"], "above 0"),
        (&[&whole, &whole, "-o", &missing], ".png"),
    ];
    for (args, words) in cases {
        if let Some(fault) = fault(&diff(args)?, 2, words) {
            panic!("{args:?}: {fault}");
        }
    }
    for (args, words) in
        [(["--crop", "20,0,8,8"], "window"), (["--max-error", "0"], "above 0"), (["-o", "a.png"], ".exr")]
    {
        let output = path("d.exr");
        let output: &[&str] = if args[0] == "-o" { &[] } else { &["-o", &output] };
        if let Some(fault) = fault(&solve(&[&["--size", "24x16"], &args[..], output].concat())?, 2, words) {
            panic!("{args:?}: {fault}");
        }
    }
    assert_eq!(
        std::fs::read_dir(dir.path())?.count(),
        13,
        "three truths of three files each, a map, three pictures of the test's own, nothing half-written"
    );
    Ok(())
}

#[test]
fn without_any_driver_the_exit_code_is_3() -> Outcome {
    let no_driver = Path::new(env!("CARGO_MANIFEST_DIR")).join("no such driver.json");
    let run = |args: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_pdss"));
        command.args(args).env("VK_DRIVER_FILES", &no_driver).env("VK_ICD_FILENAMES", &no_driver).output()
    };
    let out = run(&["render", "shape:plane", "-o", "never.png", "--size", "8x8"])?;
    assert_eq!(out.status.code(), Some(3), "{}", text(&out.stderr));
    assert!(text(&out.stderr).contains("no usable Vulkan device"), "{}", text(&out.stderr));
    assert!(!Path::new("never.png").exists());
    // The twin: what needs no device works without a driver.
    assert_eq!(run(&["explain", "shape:plane"])?.status.code(), Some(0));
    Ok(())
}

/// Scenes that can be drawn, and in its place the reason of one that cannot.
#[test]
fn a_contact_sheet_holds_what_can_be_drawn_and_says_what_cannot() -> Outcome {
    if no_device() {
        return Ok(());
    }
    let dir = tempfile::tempdir()?;
    let (sheet, broken) = (dir.path().join("sheet.png"), dir.path().join("broken.gltf"));
    std::fs::write(&broken, r#"{"asset": {"version": "2.0"}, "scene": 5, "scenes": []}"#)?;
    let [path, bad] = [&sheet, &broken].map(|p| p.display().to_string());
    let cells = ["--contact-sheet", "--cell", "64x48", "--validate", "-o"];
    let out = pdss(&[&["render", "shape:sphere:30", &bad, "shape:cube:20"], &cells[..], &[&path]].concat())?;
    assert_eq!(out.status.code(), Some(0), "{}", text(&out.stderr));
    assert!(text(&out.stderr).contains("refused: ") && text(&out.stderr).contains("broken.gltf: scene: "));
    let picture = image::open(&sheet)?.into_rgb8();
    // Colours of paper and letters alone in the broken one's cell, many in the others.
    let colours = |column: u32, row: u32| {
        let (x, y) = (6 + column * 70, 6 + row * 64);
        let all = (0..48 * 64).map(|i| picture.get_pixel(x + i % 64, y + i / 64).0);
        all.collect::<std::collections::HashSet<_>>().len()
    };
    assert_eq!(picture.dimensions(), (2 * 70 + 6, 2 * 64 + 6));
    assert!(
        colours(0, 0) > 50 && colours(1, 0) == 2 && colours(0, 1) > 4,
        "{} {} {}",
        colours(0, 0),
        colours(1, 0),
        colours(0, 1)
    );
    let alone = pdss(&["render", "shape:cube:20", "shape:sphere:30", "-o", &path])?;
    assert_eq!(fault(&alone, 2, "contact-sheet"), None);
    Ok(())
}
