//! Two records of `pdss profile --format json` against each other: what has become slower, beyond a threshold and the noise.

use super::stats::Summary;
use super::table::Table;
use serde_json::Value;
use std::fmt::{self, Display};

/// What must be the same in both, for their times to be comparable: where it is found, and what it is called.
const SAME: [(&str, &str); 12] = [
    ("/schema", "schema"),
    ("/device", "device"),
    ("/driver", "driver"),
    ("/scene", "scene"),
    ("/triangles", "triangles"),
    ("/method", "method"),
    ("/size", "size"),
    ("/profile", "profile"),
    ("/lights", "lights"),
    ("/settings", "settings"),
    ("/timing", "timing"),
    ("/validation", "validation"),
];

/// A change counts only where it is this many median absolute deviations of the noisier record, too.
const NOISE: f64 = 3.;

/// One time of both records, ms.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// The stage, or the frame.
    pub name: String,
    /// Median before and after; none where the stage is not there.
    pub ms: [Option<f64>; 2],
    /// What has come of it.
    pub verdict: Verdict,
}

/// How a time has changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// No more than the threshold or the noise.
    Same,
    /// By more than both.
    Slower,
    /// By more than both.
    Faster,
    /// One of the records does not have it.
    Alone,
}

/// The comparison.
#[derive(Clone, Debug)]
pub struct Versus {
    /// The frame, then stages in the order of the newer record, then those that are gone.
    pub rows: Vec<Row>,
}

impl Versus {
    /// Compares two records, or two sets of them as `cargo bench --bench frames` writes; `threshold` is the part of the older median by which the newer may exceed it.
    ///
    /// # Errors
    /// One line that says what the records do not have in common, or what one of them lacks.
    pub fn of(old: &Value, new: &Value, threshold: f64) -> Result<Versus, String> {
        let list = |r: &Value| r.get("records").and_then(Value::as_array).cloned();
        let (Some(before), Some(after)) = (list(old), list(new)) else { return Self::of_one(old, new, threshold) };
        let who = |r: &Value| {
            let words =
                ["/scene", "/method", "/settings/quality"].map(|p| r.pointer(p).and_then(Value::as_str).unwrap_or("?"));
            words.join(" ")
        };
        let mut rows = Vec::new();
        for new in &after {
            let Some(old) = before.iter().find(|old| who(old) == who(new)) else { continue };
            let pair = Self::of_one(old, new, threshold).map_err(|why| format!("{}: {why}", who(new)))?;
            rows.extend(pair.rows.into_iter().map(|r| Row { name: format!("{} {}", who(new), r.name), ..r }));
        }
        if rows.is_empty() { Err("the records have nothing in common".to_owned()) } else { Ok(Versus { rows }) }
    }

    fn of_one(old: &Value, new: &Value, threshold: f64) -> Result<Versus, String> {
        for (place, name) in SAME {
            let [a, b] = [old, new].map(|r| r.pointer(place));
            let (Some(a), Some(b)) = (a, b) else {
                return Err(format!("a record without `{name}`; pdss profile --format json writes one"));
            };
            if a != b {
                return Err(format!("not comparable: {name} {a} against {b}"));
            }
        }
        let clock = |r: &Value, name: &str| summary(r.pointer(&format!("/frame/{name}")));
        let mut rows: Vec<Row> = ["wall_ms", "gpu_ms"]
            .into_iter()
            .map(|c| row(format!("frame ({})", &c[..c.len() - 3]), clock(old, c), clock(new, c), threshold))
            .collect();
        if rows.iter().all(|r| r.verdict == Verdict::Alone) {
            return Err("the records have no frame time in common".to_owned());
        }
        let (before, after) = (stages(old), stages(new));
        let find =
            |list: &[(String, Option<Summary>)], name: &str| list.iter().find(|(n, _)| n == name).and_then(|(_, s)| *s);
        let gone = before.iter().filter(|(name, _)| !after.iter().any(|(n, _)| n == name));
        let names: Vec<&String> = after.iter().chain(gone).map(|(name, _)| name).collect();
        rows.extend(names.into_iter().map(|n| row(n.clone(), find(&before, n), find(&after, n), threshold)));
        rows.retain(|r| r.ms != [None; 2]);
        Ok(Versus { rows })
    }

    /// Names of what has become slower.
    pub fn slower(&self) -> Vec<&str> {
        self.rows.iter().filter(|r| r.verdict == Verdict::Slower).map(|r| r.name.as_str()).collect()
    }
}

fn summary(value: Option<&Value>) -> Option<Summary> {
    serde_json::from_value(value?.clone()).ok()
}

fn stages(record: &Value) -> Vec<(String, Option<Summary>)> {
    let list = record.get("stages").and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
    let name = |s: &Value| s.get("name").and_then(Value::as_str).unwrap_or_default().to_owned();
    list.iter().map(|s| (name(s), summary(s.get("gpu_ms")))).collect()
}

fn row(name: String, old: Option<Summary>, new: Option<Summary>, threshold: f64) -> Row {
    let verdict = match (old, new) {
        (Some(a), Some(b)) => {
            let change = b.median - a.median;
            if change.abs() <= threshold * a.median || change.abs() <= NOISE * a.mad.max(b.mad) {
                Verdict::Same
            } else if change > 0. {
                Verdict::Slower
            } else {
                Verdict::Faster
            }
        }
        _ => Verdict::Alone,
    };
    Row { name, ms: [old, new].map(|s| s.map(|s| s.median)), verdict }
}

impl Display for Versus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut table = Table::new(&["ms", "before", "after", "change", ""]);
        for Row { name, ms, verdict } in &self.rows {
            let ms_of = |x: Option<f64>| x.map_or("-".to_owned(), |x| format!("{x:.3}"));
            let change = match ms {
                [Some(a), Some(b)] if *a > 0. => format!("{:+.1} %", 100. * (b / a - 1.)),
                _ => "-".to_owned(),
            };
            let word = match verdict {
                Verdict::Same => "",
                Verdict::Slower => "slower",
                Verdict::Faster => "faster",
                Verdict::Alone => "in one record alone",
            };
            table.row([name.clone(), ms_of(ms[0]), ms_of(ms[1]), change, word.to_owned()]);
        }
        write!(f, "{table}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::timing::TimingMode;
    use crate::report::record::tests::sample;

    fn record() -> Value {
        serde_json::to_value(sample("a driver", TimingMode::Isolated)).expect("serialisable")
    }

    fn slowed(mut record: Value, place: &str, factor: f64, mad: f64) -> Value {
        let times = record.pointer_mut(place).expect("there");
        times["median"] = (times["median"].as_f64().expect("a number") * factor).into();
        times["mad"] = mad.into();
        record
    }

    #[test]
    fn what_is_slower_is_named_and_nothing_else() {
        let calm = slowed(slowed(record(), "/frame/wall_ms", 1., 0.01), "/stages/0/gpu_ms", 1., 0.01);
        let same = Versus::of(&calm, &calm, 0.05).expect("comparable");
        assert!(same.slower().is_empty() && same.rows.len() == 4, "{same}");
        let slow = slowed(calm.clone(), "/stages/0/gpu_ms", 1.2, 0.01);
        let found = Versus::of(&calm, &slow, 0.05).expect("comparable");
        assert_eq!(found.slower(), ["gbuffer"], "{found}");
        assert_eq!(Versus::of(&slow, &calm, 0.05).expect("comparable").slower(), [""; 0], "faster is no regression");
        assert_eq!(Versus::of(&calm, &slow, 0.25).expect("comparable").slower(), [""; 0], "within the threshold");
        let noisy = slowed(calm.clone(), "/stages/0/gpu_ms", 1.2, 0.5);
        assert_eq!(Versus::of(&calm, &noisy, 0.05).expect("comparable").slower(), [""; 0], "within the noise");
        let set = |r: &Value| serde_json::json!({"records": [r]});
        let sets = Versus::of(&set(&calm), &set(&slow), 0.05).expect("comparable");
        assert_eq!(sets.slower(), ["shape:torus pdss medium gbuffer"]);
        let frame = slowed(calm.clone(), "/frame/wall_ms", 2., 0.01);
        assert_eq!(Versus::of(&calm, &frame, 0.05).expect("comparable").slower(), ["frame (wall)"]);
    }

    #[test]
    fn records_of_different_things_are_refused() {
        let whole = record();
        for (place, other) in [
            ("/device", Value::from("another device")),
            ("/driver", "newer".into()),
            ("/size", serde_json::json!([1, 1])),
            ("/settings/quality", "ultra".into()),
            ("/validation", true.into()),
            ("/timing", "overlap".into()),
        ] {
            let mut changed = whole.clone();
            *changed.pointer_mut(place).unwrap_or_else(|| panic!("{place}")) = other;
            let refusal = Versus::of(&whole, &changed, 0.05).expect_err(place);
            assert!(refusal.starts_with("not comparable"), "{refusal}");
        }
        assert!(Versus::of(&whole, &serde_json::json!({"a": 1}), 0.05).is_err());
        let mut stage = whole.clone();
        stage["stages"][1]["name"] = "another".into();
        let alone = Versus::of(&whole, &stage, 0.05).expect("comparable");
        let names = |v: &Versus| {
            v.rows.iter().filter(|r| r.verdict == Verdict::Alone).map(|r| r.name.clone()).collect::<Vec<_>>()
        };
        assert_eq!(names(&alone), ["another", "light, warm"]);
    }
}
