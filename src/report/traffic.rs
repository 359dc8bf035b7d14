//! Bytes that a pass moves, estimated from the plan: each texel of each image once per access, each buffer once. Caches
//! make reads cheaper than this, many taps a pixel make them dearer; a pass over a list of tiles touches less.

use crate::gpu::Usage;
use crate::plan::{Pass, Plan};

/// Bytes read and written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Traffic {
    /// Bytes read.
    pub read: u64,
    /// Bytes written.
    pub written: u64,
}

/// Whether a usage reads, and whether it writes.
pub fn directions(usage: Usage) -> (bool, bool) {
    let access = usage.access();
    let reads = !access.discards || usage == Usage::DepthAttachment;
    (reads, access.writes)
}

/// Bytes of a resource of the plan; 0 for those made outside of it.
pub fn resource_bytes(plan: &Plan, name: &str) -> u64 {
    let image = plan.targets.get(name).map(|t| plan.target_bytes(t));
    image.or_else(|| plan.buffers.get(name).map(|b| b.bytes)).unwrap_or(0)
}

/// What a pass moves.
pub fn of_pass(plan: &Plan, pass: &Pass) -> Traffic {
    let mut sum = Traffic::default();
    for (name, usage) in &pass.accesses {
        let bytes = resource_bytes(plan, name);
        let (reads, writes) = directions(*usage);
        sum.read += if reads { bytes } else { 0 };
        sum.written += if writes { bytes } else { 0 };
    }
    sum
}

/// What a frame moves.
pub fn of_frame(plan: &Plan) -> Traffic {
    plan.passes
        .iter()
        .map(|p| of_pass(plan, p))
        .fold(Traffic::default(), |a, b| Traffic { read: a.read + b.read, written: a.written + b.written })
}

/// A number of bytes for people.
pub fn human(bytes: u64) -> String {
    match bytes {
        0..=9_999 => format!("{bytes} B"),
        10_000..=1_048_575 => format!("{:.1} KiB", bytes as f64 / 1024.),
        _ => format!("{:.1} MiB", bytes as f64 / 1_048_576.),
    }
}
