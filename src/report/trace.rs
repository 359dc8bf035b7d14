//! The median frame as a Chrome trace, for ui.perfetto.dev: one track for the host's clock, one for the device's stages.

use super::record::Record;
use super::stats;
use serde_json::{Value, json};

/// A trace of the frame whose wall time is the median.
///
/// Only lengths are measured: stages follow one another from the frame's start, a stage without a stamp has no length.
pub fn of_record(record: &Record) -> Value {
    let frame = stats::median_index(&record.samples.wall_ms);
    let mut events = vec![
        json!({"ph": "M", "pid": 1, "name": "process_name", "args": {"name": format!("{} ({})", record.device, record.driver)}}),
        track_name(1, "frame, wall clock"),
        track_name(2, "stages, device clock"),
    ];
    if let Some(frame) = frame {
        let wall = record.samples.wall_ms.get(frame).copied().unwrap_or(0.);
        events.push(slice(1, "frame", 0., wall, json!({"frame": frame})));
        let mut start = 0.;
        for (samples, stage) in record.samples.stages.iter().zip(&record.stages) {
            let time = samples.gpu_ms.get(frame).copied().flatten();
            let args = json!({
                "bytes_read": stage.bytes_read,
                "bytes_written": stage.bytes_written,
                "stamped": time.is_some(),
                "median_ms": stage.gpu_ms.map(|s| s.median),
            });
            let length = time.unwrap_or(0.);
            events.push(slice(2, &stage.name, start, length, args));
            start += length;
        }
    }
    json!({
        "traceEvents": events,
        "displayTimeUnit": "ms",
        "otherData": {
            "schema": record.schema,
            "scene": record.subject.scene,
            "method": record.method,
            "size": record.size,
            "timing": record.subject.timing,
            "validation": record.subject.validation,
            "notes": record.notes,
        },
    })
}

fn track_name(track: u32, name: &str) -> Value {
    json!({"ph": "M", "pid": 1, "tid": track, "name": "thread_name", "args": {"name": name}})
}

/// A complete event; the format counts in microseconds.
fn slice(track: u32, name: &str, start_ms: f64, length_ms: f64, args: Value) -> Value {
    json!({"ph": "X", "pid": 1, "tid": track, "name": name, "ts": start_ms * 1e3, "dur": length_ms * 1e3, "args": args})
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::timing::TimingMode;
    use crate::report::record::tests::sample;

    #[test]
    fn stages_of_the_median_frame_follow_one_another() {
        let trace = of_record(&sample("d", TimingMode::Isolated));
        let slices: Vec<&Value> =
            trace["traceEvents"].as_array().into_iter().flatten().filter(|e| e["ph"] == "X").collect();
        let figures: Vec<(Option<f64>, Option<f64>)> =
            slices.iter().map(|s| (s["ts"].as_f64(), s["dur"].as_f64())).collect();
        // The third frame of 5, 3 and 4 ms; its stages took 2 and 0.5 ms.
        let want = [(0., 4000.), (0., 2000.), (2000., 500.)].map(|(a, b)| (Some(a), Some(b)));
        assert_eq!(figures, want);
    }
}
