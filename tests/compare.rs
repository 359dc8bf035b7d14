//! `pdss compare` from outside: a run, the same run again, a run in parts, and what it refuses.

use pdss::compare::check::{Sheet, check};
use std::collections::BTreeMap;
use std::error::Error;
use std::path::Path;
use std::process::{Command, Output};

type Outcome = Result<(), Box<dyn Error>>;

/// A run of seconds on a processor.
const QUICK: [&str; 14] = [
    "--size",
    "40x28",
    "--methods",
    "moments,gaussians",
    "--qualities",
    "low",
    "--rounds",
    "2",
    "--frames",
    "1",
    "--samples",
    "5000",
    "--truth-error",
    "0.01",
];

fn pdss(args: &[&str]) -> Result<Output, std::io::Error> {
    Command::new(env!("CARGO_BIN_EXE_pdss")).args(args).output()
}

fn compare(scenes: &[&str], directory: &Path, more: &[&str]) -> Result<Output, Box<dyn Error>> {
    let directory = directory.display().to_string();
    Ok(pdss(&[&["compare"], scenes, &["-o", &directory], &QUICK, more].concat())?)
}

fn merge(parts: &[&Path], directory: &Path) -> Result<Output, Box<dyn Error>> {
    let text = |p: &Path| p.display().to_string();
    let mut args = vec!["compare".to_owned(), "-o".to_owned(), text(directory), "--merge".to_owned()];
    args.extend(parts.iter().map(|p| text(p)));
    Ok(pdss(&args.iter().map(String::as_str).collect::<Vec<_>>())?)
}

fn stderr(out: &Output) -> String {
    String::from_utf8_lossy(&out.stderr).into_owned()
}

/// Why this is not a refusal in one line with exit code 2 that has these words.
fn fault(out: &Output, words: &str) -> Option<String> {
    let text = stderr(out);
    let good = out.status.code() == Some(2) && text.contains(words) && !text.contains("panicked");
    let ours = text.starts_with("pdss: ") && text.lines().count() == 1 || text.starts_with("error: ");
    (!(good && ours && out.stdout.is_empty())).then(|| format!("{:?}: {text}", out.status))
}

/// There is nothing to time where there is no device.
fn no_device() -> bool {
    let none = pdss(&["devices"]).is_ok_and(|o| o.status.code() == Some(3));
    if none {
        eprintln!("skipped: no Vulkan device");
    }
    none
}

/// A table's rows by column name; a small reader of RFC 4180.
fn table(file: &Path) -> Result<Vec<BTreeMap<String, String>>, Box<dyn Error>> {
    let text = std::fs::read_to_string(file)?;
    let split = |line: &str| {
        let (mut cells, mut quoted) = (vec![String::new()], false);
        for c in line.chars() {
            match c {
                '"' => quoted = !quoted,
                ',' if !quoted => cells.push(String::new()),
                c => cells.last_mut().map_or((), |cell| cell.push(c)),
            }
        }
        cells
    };
    let mut lines = text.lines().map(split);
    let header = lines.next().ok_or("a table has a header")?;
    Ok(lines.map(|cells| header.iter().cloned().zip(cells).collect()).collect())
}

/// Rows without what no two runs share: times, and who is ahead by them.
fn timeless(mut rows: Vec<BTreeMap<String, String>>) -> Vec<BTreeMap<String, String>> {
    for row in &mut rows {
        row.retain(|name, _| !name.ends_with("_ms") && name != "front" && !name.contains("rival"));
    }
    rows
}

#[test]
fn a_run_is_whole_goes_on_where_it_stopped_and_adds_up_from_its_parts() -> Outcome {
    if no_device() {
        return Ok(());
    }
    let temporary = tempfile::tempdir()?;
    let at = |name: &str| temporary.path().join(name);
    let (scenes, cache) = (["sphere", "many-lights"], at("truth").display().to_string());
    let more = ["--cache", &cache, "--validate"];
    let out = compare(&scenes, &at("whole"), &more)?;
    assert!(out.status.success(), "{}", stderr(&out));
    let rows = table(&at("whole").join("results.csv"))?;
    let names: Vec<[&str; 2]> = rows.iter().map(|r| [r["scene"].as_str(), r["method"].as_str()]).collect();
    let wanted = scenes.iter().flat_map(|s| ["lambert", "moments", "gaussians"].map(|m| [*s, m]));
    assert_eq!(names, wanted.collect::<Vec<_>>());
    for row in &rows {
        let figure = |name: &str| row[name].parse::<f64>();
        assert!(figure("frame_ms")? > 0. && figure("memory_bytes")? > 0., "{row:?}");
        assert!(figure("rmse")? > figure("truth_rms")? && figure("rmse")? < 0.1, "{row:?}");
        assert_eq!((row["wall_n"].as_str(), row["schema"].as_str(), row["validation"].as_str()), ("2", "1", "on"));
    }
    let rmse = |i: usize| rows[i]["rmse"].parse::<f64>();
    assert!(rmse(5)? < rmse(3)?, "a blur of light is nearer to truth than none on a small torus");
    assert_eq!(rows[0]["scatter_ms"], "0", "lambert spends nothing on scattering");
    assert_eq!(rows[3]["lights"], "8");
    let json: serde_json::Value = serde_json::from_slice(&std::fs::read(at("whole").join("results.json"))?)?;
    assert_eq!(json["cells"][0]["time"]["wall_samples_ms"].as_array().map(Vec::len), Some(2), "every sample is kept");

    report_is_the_tables(&at("whole"))?;

    // Nothing is measured twice: times would not repeat to the last digit.
    let csv = std::fs::read(at("whole").join("results.csv"))?;
    assert!(compare(&scenes, &at("whole"), &more)?.status.success());
    assert_eq!(std::fs::read(at("whole").join("results.csv"))?, csv);
    // Interrupted in the second scene: what was done of the first stays, the rest is measured.
    let lost = rows[4]["key"].clone() + ".json";
    std::fs::remove_file(at("whole").join("cells").join(lost))?;
    assert!(compare(&scenes, &at("whole"), &more)?.status.success());
    let again = table(&at("whole").join("results.csv"))?;
    assert_eq!(again[..3], rows[..3]);
    assert_ne!(again[4], rows[4], "the twin: what is measured again has other times");
    assert_eq!(timeless(again), timeless(rows.clone()));

    // In two parts, put together.
    for part in ["0/2", "1/2"] {
        let out = compare(&scenes, &at(&part[..1]), &[&more[..], &["--shard", part]].concat())?;
        assert!(out.status.success(), "{}", stderr(&out));
    }
    assert!(merge(&[&at("1"), &at("0")], &at("merged"))?.status.success());
    assert_eq!(timeless(table(&at("merged").join("results.csv"))?), timeless(rows));
    let pictures =
        |name: &str| -> Result<usize, std::io::Error> { Ok(std::fs::read_dir(at(name).join("pictures"))?.count()) };
    assert_eq!(pictures("merged")?, pictures("whole")?);

    // One thing changed, all else held.
    let out = compare(&["torus"], &at("swept"), &["--cache", &cache, "--sweep", "resolution"])?;
    assert!(out.status.success(), "{}", stderr(&out));
    let swept = table(&at("swept").join("results.csv"))?;
    let widths: Vec<&str> = swept.iter().filter(|r| r["method"] == "moments").map(|r| r["width"].as_str()).collect();
    assert_eq!(widths, ["10", "20", "30", "40"]);
    check(
        &std::fs::read_to_string(at("swept").join("report.html"))?,
        &Sheet::read(&std::fs::read_to_string(at("swept").join("results.csv"))?),
    )
    .map_err(|wrong| wrong.join("\n"))?;

    // Half a cell is neither taken for one nor thrown away unasked.
    let half = at("swept").join("cells").join(swept[0]["key"].clone() + ".json");
    let text = std::fs::read(&half)?;
    std::fs::write(&half, &text[..text.len() / 2])?;
    let out = compare(&["torus"], &at("swept"), &["--cache", &cache, "--sweep", "resolution"])?;
    assert_eq!(fault(&out, "cut short"), None);

    // What is not one result is not made one.
    let spoil = |name: &str, from: &str, to: &str| -> Outcome {
        std::fs::create_dir_all(at(name))?;
        let text = std::fs::read_to_string(at("1").join("results.json"))?;
        let spoilt = text.replacen(from, to, 1);
        assert_ne!(text, spoilt, "{from}");
        Ok(std::fs::write(at(name).join("results.json"), spoilt)?)
    };
    spoil("other device", "\"device\": \"", "\"device\": \"another ")?;
    spoil("other rounds", "\"rounds\": 2", "\"rounds\": 3")?;
    spoil("future", "\"schema\": 1", "\"schema\": 7")?;
    let cut = std::fs::read(at("1").join("results.json"))?;
    std::fs::create_dir_all(at("cut"))?;
    std::fs::write(at("cut").join("results.json"), &cut[..cut.len() / 2])?;
    std::fs::create_dir_all(at("empty"))?;
    let cases = [
        ("other device", "device"),
        ("other rounds", "plan"),
        ("future", "schema 7"),
        ("cut", "cut short"),
        ("empty", "not finished"),
        ("missing", "no such directory"),
        ("0", "share no cell"),
    ];
    for (name, words) in cases {
        if let Some(fault) = fault(&merge(&[&at("0"), &at(name)], &at("never"))?, words) {
            panic!("{name}: {fault}");
        }
        assert!(!at("never").exists(), "{name}: a refusal leaves nothing behind");
    }
    assert!(fault(&merge(&[&at("0"), &at("1")], &at("twin"))?, "").is_some(), "the twin: what may be merged is");
    Ok(())
}

/// Plots are there in both forms, and the page says nothing that the table does not.
fn report_is_the_tables(directory: &Path) -> Outcome {
    for name in ["plot", "plot-sphere", "plot-many-lights"] {
        let svg = std::fs::read_to_string(directory.join(format!("{name}.svg")))?;
        assert!(svg.starts_with("<svg") && svg.matches("<circle").count() >= 3, "{name}");
        let png = image::open(directory.join(format!("{name}.png")))?.into_rgb8();
        assert!(png.width() > 900 && png.pixels().any(|p| p.0 == [222, 94, 0]), "{name}: moments has its colour");
    }
    let page = std::fs::read_to_string(directory.join("report.html"))?;
    let sheet = Sheet::read(&std::fs::read_to_string(directory.join("results.csv"))?);
    let figures = check(&page, &sheet).map_err(|wrong| wrong.join("\n"))?;
    println!("{figures} figures on {} bytes, all in the table", page.len());
    assert!(figures > 100 && page.matches("data:image/jpeg").count() > 10);
    let (at, _) = page.match_indices("</data>").nth(40).ok_or("a page has figures")?;
    let digit = if page[..at].ends_with('7') { "3" } else { "7" };
    let changed = format!("{}{digit}{}", &page[..at - 1], &page[at..]);
    assert!(check(&changed, &sheet).is_err(), "the twin: a changed figure is caught");
    Ok(())
}

#[test]
fn a_calibrated_device_chooses_and_says_why() -> Outcome {
    if no_device() {
        return Ok(());
    }
    let temporary = tempfile::tempdir()?;
    let cache = temporary.path().join("cache");
    let picture = temporary.path().join("a.png").display().to_string();
    let run =
        |args: &[&str]| Command::new(env!("CARGO_BIN_EXE_pdss")).args(args).env("XDG_CACHE_HOME", &cache).output();
    let render =
        |more: &[&str]| run(&[&["render", "shape:torus:10,4", "-o", &picture, "--size", "40x28"], more].concat());
    assert_eq!(fault(&render(&["--budget-ms", "100"])?, "run pdss calibrate"), None);
    let out = run(&[&["calibrate", "torus"], &QUICK[..]].concat())?;
    assert!(out.status.success(), "{}", stderr(&out));
    assert!(String::from_utf8_lossy(&out.stdout).contains("gaussians"));
    let rich = render(&["--budget-ms", "100000"])?;
    assert!(rich.status.success() && stderr(&rich).contains("moments low: error "), "{}", stderr(&rich));
    let fast = render(&["--max-error", "1"])?;
    assert!(fast.status.success() && stderr(&fast).contains(" ms expected, "), "{}", stderr(&fast));
    let cases: [(&[&str], &str); 4] = [
        (&["--budget-ms", "0.000001"], "the fastest that is right enough"),
        (&["--max-error", "0.000001"], "the rightest is"),
        (&["--budget-ms", "0"], "above 0"),
        (&["--budget-ms", "9", "--method", "pdss"], "--method"),
    ];
    for (args, words) in cases {
        assert_eq!(fault(&render(args)?, words), None, "{args:?}");
    }
    Ok(())
}

#[test]
fn bad_questions_and_bad_directories_exit_with_2() -> Outcome {
    let temporary = tempfile::tempdir()?;
    let file = temporary.path().join("file");
    std::fs::write(&file, "")?;
    let directory = temporary.path().join("d");
    let cases: [(&[&str], &Path, &[&str], &str); 8] = [
        (&["shape:teapot"], &directory, &[], "teapot"),
        (&["no-such-file.glb"], &directory, &[], "no-such-file.glb"),
        (&["sphere", "sphere"], &directory, &[], "told apart"),
        (&["sphere"], &file, &[], "that is a file"),
        (&["sphere"], &directory, &["--shard", "2/2"], "I below N"),
        (&["sphere"], &directory, &["--shard", "1/2"], "1 scene"),
        (&["sphere"], &directory, &["--profile", "none"], "lambert"),
        (&["sphere"], &directory, &["--rounds", "0"], "--rounds"),
    ];
    for (scenes, directory, more, words) in cases {
        // What needs a device to be found out is not found out where there is none.
        let out = compare(scenes, directory, more)?;
        if out.status.code() == Some(3) && no_device() {
            continue;
        }
        if let Some(fault) = fault(&out, words) {
            panic!("{scenes:?} {more:?}: {fault}");
        }
    }
    Ok(())
}

/// A run that goes on reads what an earlier one wrote: one unit in the last place would be a
/// figure that differs between two tables of the same measurement.
#[test]
fn figures_read_back_from_a_record_have_the_same_bits() -> Outcome {
    let mut state = 1_u64;
    let (mut tried, mut wrong) = (0, 0);
    for _ in 0..20_000 {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let figure = (state >> 11) as f64 * (-53_f64).exp2() * 40.;
        let read: f64 = serde_json::from_str(&serde_json::to_string(&figure)?)?;
        tried += 1;
        wrong += i32::from(read.to_bits() != figure.to_bits());
    }
    println!("{wrong} of {tried} figures came back with other bits");
    assert_eq!(wrong, 0);
    Ok(())
}
