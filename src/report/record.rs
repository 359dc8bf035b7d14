//! One measurement, complete enough to be compared with another: what ran, where, how, every sample, and what they say.

use super::measure::{Samples, Warmed};
use super::stats::Summary;
use super::traffic::{self, Traffic};
use crate::frame::CpuTimes;
use crate::gpu::DeviceInfo;
use crate::gpu::timing::TimingMode;
use crate::plan::{LeftOut, Plan};
use crate::settings::{Method, Settings};
use serde::Serialize;
use std::fmt::Write as _;

/// Version of the record's shape; it changes when a field changes its meaning.
pub const SCHEMA: u32 = 1;

/// What was run.
#[derive(Clone, Debug, Serialize)]
pub struct Subject {
    /// The scene as it was named.
    pub scene: String,
    /// Triangles of it.
    pub triangles: usize,
    /// Name of the diffusion profile; none where nothing scatters.
    pub profile: Option<String>,
    /// Lights.
    pub lights: usize,
    /// Everything else that was asked for.
    pub settings: Settings,
    /// How stages were timed.
    pub timing: TimingMode,
    /// The validation layers were on: times are not to be compared with times without.
    pub validation: bool,
    /// Pixels that the scene covers; none where nobody counted.
    pub covered_pixels: Option<u64>,
}

/// The frame as a whole.
#[derive(Clone, Debug, Serialize)]
pub struct FrameTimes {
    /// From before the submit to after the fence, on the host's clock.
    pub wall_ms: Option<Summary>,
    /// First stamp to last, on the device's clock.
    pub gpu_ms: Option<Summary>,
    /// Sum of the stages' medians, ms. Far from `gpu_ms`, the stages did not vary together.
    pub sum_of_stage_medians_ms: f64,
}

/// One pass of the frame.
#[derive(Clone, Debug, Serialize)]
pub struct StageTimes {
    /// Its name.
    pub name: String,
    /// Time between the stamps around it; none where no stamp was ever available.
    pub gpu_ms: Option<Summary>,
    /// Estimate, see [`traffic`].
    pub bytes_read: u64,
    /// Estimate, see [`traffic`].
    pub bytes_written: u64,
}

/// Memory of one target.
#[derive(Clone, Debug, Serialize)]
pub struct TargetMemory {
    /// Its name.
    pub target: String,
    /// Its texels.
    pub bytes: u64,
    /// Where it begins; images that are never needed at once may overlap.
    pub offset: u64,
}

/// The device memory of a frame's images.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct MemoryTotal {
    /// What is taken.
    pub shared: u64,
    /// What would be taken if no two targets took turns.
    pub unshared: u64,
}

/// The whole record.
#[derive(Clone, Debug, Serialize)]
pub struct Record {
    /// [`SCHEMA`].
    pub schema: u32,
    /// Device name.
    pub device: String,
    /// Driver name and version.
    pub driver: String,
    /// discrete, integrated, virtual, cpu or other.
    pub device_kind: &'static str,
    /// Version of this crate.
    pub version: &'static str,
    /// Commit that was built, where the build was told (PDSS_COMMIT).
    pub commit: Option<&'static str>,
    /// Method, also in `settings`.
    pub method: Method,
    /// Width and height in pixels, also in `settings`.
    pub size: [u32; 2],
    /// What was run.
    #[serde(flatten)]
    pub subject: Subject,
    /// Frames before the first sample.
    pub warmup: Warmed,
    /// The frame as a whole.
    pub frame: FrameTimes,
    /// Its passes in order.
    pub stages: Vec<StageTimes>,
    /// Its images.
    pub memory: Vec<TargetMemory>,
    /// Their sum.
    pub memory_total: MemoryTotal,
    /// Work of the host.
    pub cpu: CpuTimes,
    /// What this frame did without.
    pub left_out: Vec<LeftOut>,
    /// What a reader must know before quoting a figure.
    pub notes: Vec<String>,
    /// Every sample.
    pub samples: Samples,
}

impl Record {
    /// Puts a record together. `memory` is bytes shared and unshared.
    pub fn new(
        device: &DeviceInfo,
        subject: Subject,
        plan: &Plan,
        memory: (u64, u64),
        cpu: CpuTimes,
        warmup: Warmed,
        samples: Samples,
    ) -> Record {
        let stages: Vec<StageTimes> = samples
            .stages
            .iter()
            .enumerate()
            .map(|(index, stage)| {
                let same = plan.passes.get(index).filter(|p| p.name == stage.name);
                let pass = same.or_else(|| plan.passes.iter().find(|p| p.name == stage.name));
                let Traffic { read, written } = pass.map(|p| traffic::of_pass(plan, p)).unwrap_or_default();
                let gpu_ms = Summary::of(&stage.gpu_ms);
                StageTimes { name: stage.name.clone(), gpu_ms, bytes_read: read, bytes_written: written }
            })
            .collect();
        let wall: Vec<Option<f64>> = samples.wall_ms.iter().copied().map(Some).collect();
        let frame = FrameTimes {
            wall_ms: Summary::of(&wall),
            gpu_ms: Summary::of(&samples.gpu_ms()),
            sum_of_stage_medians_ms: stages.iter().filter_map(|s| s.gpu_ms).map(|s| s.median).sum(),
        };
        let target = |(name, t): (&String, &crate::plan::TargetPlan)| TargetMemory {
            target: name.clone(),
            bytes: plan.target_bytes(t),
            offset: t.offset,
        };
        Record {
            schema: SCHEMA,
            device: device.name.clone(),
            driver: device.driver.clone(),
            device_kind: device.kind,
            version: env!("CARGO_PKG_VERSION"),
            commit: option_env!("PDSS_COMMIT"),
            method: subject.settings.method,
            size: [subject.settings.size.width, subject.settings.size.height],
            notes: notes(device, &subject, warmup, &stages),
            subject,
            warmup,
            frame,
            stages,
            memory: plan.targets.iter().map(target).collect(),
            memory_total: MemoryTotal { shared: memory.0, unshared: memory.1 },
            cpu,
            left_out: plan.left_out.clone(),
            samples,
        }
    }

    /// One row a pass, and one for the whole frame on each clock; times in ms. Fields that have no value are empty.
    pub fn csv(&self) -> String {
        let mut out = String::from(
            "stage,median_ms,p5_ms,p95_ms,min_ms,mad_ms,n,dropped,bytes_read,bytes_written,timing,validation\n",
        );
        let watched = if self.subject.validation { "on" } else { "off" };
        let mode = format!("{},{watched}", super::table::name_of(self.subject.timing));
        let mut row = |name: &str, times: Option<Summary>, bytes: Option<(u64, u64)>| {
            let quoted = if name.contains([',', '"', '\n']) {
                format!("\"{}\"", name.replace('"', "\"\""))
            } else {
                name.to_owned()
            };
            let times = times.map_or(",,,,,0,".to_owned(), |s| {
                format!("{},{},{},{},{},{},{}", s.median, s.p5, s.p95, s.min, s.mad, s.n, s.dropped)
            });
            let bytes = bytes.map_or(",".to_owned(), |(r, w)| format!("{r},{w}"));
            // Writing to a string does not fail.
            let _ = writeln!(out, "{quoted},{times},{bytes},{mode}");
        };
        for stage in &self.stages {
            row(&stage.name, stage.gpu_ms, Some((stage.bytes_read, stage.bytes_written)));
        }
        row("frame (gpu)", self.frame.gpu_ms, None);
        row("frame (wall)", self.frame.wall_ms, None);
        out
    }
}

/// What a reader must know before quoting a figure of this record.
fn notes(device: &DeviceInfo, subject: &Subject, warmup: Warmed, stages: &[StageTimes]) -> Vec<String> {
    let mut notes = Vec::new();
    let llvmpipe = device.name.contains("llvmpipe") || device.driver.contains("llvmpipe");
    match subject.timing {
        TimingMode::Overlap if llvmpipe => notes.push(
            "on llvmpipe a stamp without a full barrier after it is written too early: these stage times are not times. \
             The frame's wall time is; so are the stages of --timing isolated"
                .to_owned(),
        ),
        TimingMode::Overlap => {
            notes.push("overlap: neighbouring stages may share time; a stage alone is timed with --timing isolated".to_owned());
        }
        TimingMode::Isolated => {
            notes.push("isolated: barriers around every stage; the whole frame is slower than without them".to_owned());
        }
    }
    if subject.validation {
        notes.push("the validation layers were on: not to be compared with times without".to_owned());
    }
    if warmup.settled == Some(false) {
        notes.push(format!("after {} frames of warming up the frame time had not settled", warmup.frames));
    }
    let dropped: usize = stages.iter().filter_map(|s| s.gpu_ms).map(|s| s.dropped).sum();
    let never = stages.iter().filter(|s| s.gpu_ms.is_none()).count();
    if dropped > 0 || never > 0 {
        notes.push(format!("{dropped} stamps were not available in time; {never} stages have no time at all"));
    }
    notes
}

#[cfg(test)]
pub(in crate::report) mod tests {
    use super::*;
    use crate::report::measure::StageSamples;

    /// A record of two passes over three frames, one stamp missing.
    pub(in crate::report) fn sample(driver: &str, timing: TimingMode) -> Record {
        let device = DeviceInfo {
            index: 0,
            name: "a device".to_owned(),
            driver: driver.to_owned(),
            api: "1.3.0".to_owned(),
            kind: "cpu",
            unusable: None,
            timestamp_period: 1.,
            large_points: true,
        };
        let subject = Subject {
            scene: "shape:torus".to_owned(),
            triangles: 2,
            profile: None,
            lights: 1,
            settings: Settings::default(),
            timing,
            validation: false,
            covered_pixels: None,
        };
        let stage =
            |name: &str, times: [Option<f64>; 3]| StageSamples { name: name.to_owned(), gpu_ms: times.to_vec() };
        let samples = Samples {
            wall_ms: vec![5., 3., 4.],
            stages: vec![
                stage("gbuffer", [Some(1.), Some(1.5), Some(2.)]),
                stage("light, warm", [Some(1.), None, Some(0.5)]),
            ],
        };
        let warmed = Warmed { frames: 10, settled: Some(true) };
        Record::new(&device, subject, &Plan::default(), (1, 2), CpuTimes::default(), warmed, samples)
    }

    #[test]
    fn json_has_the_fields_that_others_rely_on() {
        let json = serde_json::to_value(sample("d", TimingMode::Isolated)).expect("a record is serialisable");
        assert_eq!(json["schema"], 1);
        assert_eq!(json["size"], serde_json::json!([1650, 1080]));
        assert_eq!((&json["method"], &json["timing"]), (&"pdss".into(), &"isolated".into()));
        for clock in ["wall_ms", "gpu_ms"] {
            for field in ["median", "p5", "p95", "min", "mad", "n"] {
                assert!(json["frame"][clock][field].is_number(), "frame.{clock}.{field}");
            }
        }
        assert_eq!(json["stages"][1]["gpu_ms"]["dropped"], 1);
        assert_eq!(json["frame"]["gpu_ms"]["n"], 2, "a frame that lacks a stamp has no time");
        assert!(json["stages"][0]["bytes_read"].is_number() && json["memory"].is_array());
        assert!(json["commit"].is_null() || json["commit"].is_string());
        assert_eq!(json["samples"]["wall_ms"], serde_json::json!([5., 3., 4.]));
    }

    #[test]
    fn csv_rows_are_as_wide_as_their_header() {
        let csv = sample("d", TimingMode::Overlap).csv();
        let width = |line: &str| line.replace("\"light, warm\"", "light").split(',').count();
        let mut lines = csv.lines();
        let header = lines.next().map(width);
        assert_eq!(header, Some(12));
        assert!(lines.clone().count() == 4 && lines.all(|l| Some(width(l)) == header), "{csv}");
    }

    #[test]
    fn times_that_are_not_times_are_called_so() {
        let warns = |driver, timing| sample(driver, timing).notes.iter().any(|n| n.contains("not times"));
        assert!(warns("llvmpipe Mesa 22.3.6", TimingMode::Overlap));
        assert!(!warns("llvmpipe Mesa 22.3.6", TimingMode::Isolated));
        assert!(!warns("another", TimingMode::Overlap));
    }
}
