//! Timestamps at the boundaries between passes.
//!
//! One stamp a boundary, written once the pass before it has finished its last stage: a start stamp at the top of the pipe
//! would not be ordered after the pass before it, and would charge one pass with its neighbour's work.

use super::{Gpu, GpuError, Named};
use ash::vk;
use std::sync::Arc;

/// What a stamp means.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum TimingMode {
    /// No barrier that the frame does not need: passes may overlap, and their times share what overlaps.
    #[default]
    Overlap,
    /// A full barrier on both sides of every stamp: each pass alone on the device.
    Isolated,
}

/// A pool of one stamp per boundary.
pub struct Timer {
    pub(super) pool: vk::QueryPool,
    pub(super) stamps: u32,
    /// Mode the frame was recorded with.
    pub mode: TimingMode,
    gpu: Arc<Gpu>,
}

impl Timer {
    /// Room for `passes` passes.
    ///
    /// # Errors
    /// Where the queue has no timestamps, or the driver refuses.
    pub fn new(gpu: &Arc<Gpu>, passes: usize, mode: TimingMode) -> Result<Self, GpuError> {
        if gpu.timestamp_bits == 0 || gpu.info().timestamp_period == 0. {
            return Err(GpuError::Misuse(format!("{} has no timestamps on its queue", gpu.info().name)));
        }
        let stamps = passes as u32 + 1;
        let info = vk::QueryPoolCreateInfo::default().query_type(vk::QueryType::TIMESTAMP).query_count(stamps);
        // SAFETY: a valid create info.
        let pool = unsafe { gpu.device.create_query_pool(&info, None) }.named("vkCreateQueryPool", "frame timer")?;
        gpu.born(pool, "frame timer");
        let timer = Timer { pool, stamps, mode, gpu: gpu.clone() };
        timer.reset();
        Ok(timer)
    }

    /// Makes the stamps unavailable again, from the host.
    pub fn reset(&self) {
        // SAFETY: hostQueryReset is enabled, and no submitted work uses the pool now.
        unsafe { self.gpu.device.reset_query_pool(self.pool, 0, self.stamps) };
    }

    /// Nanoseconds between neighbouring stamps, one a pass; none where a stamp was not available.
    ///
    /// # Errors
    /// Where the driver refuses.
    pub fn read(&self) -> Result<Vec<Option<f64>>, GpuError> {
        let mut data = vec![[0u64; 2]; self.stamps as usize];
        let flags = vk::QueryResultFlags::TYPE_64 | vk::QueryResultFlags::WITH_AVAILABILITY;
        // SAFETY: `data` has one value and one availability word per query.
        match unsafe { self.gpu.device.get_query_pool_results(self.pool, 0, &mut data, flags) } {
            Ok(()) | Err(vk::Result::NOT_READY) => {}
            Err(e) => return Err(e).named("vkGetQueryPoolResults", "frame timer"),
        }
        Ok(intervals(&data, self.gpu.timestamp_bits, self.gpu.info().timestamp_period))
    }
}

/// Differences modulo the counter's width, in nanoseconds.
fn intervals(stamps: &[[u64; 2]], bits: u32, period: f32) -> Vec<Option<f64>> {
    let mask = if bits >= 64 { u64::MAX } else { (1 << bits) - 1 };
    stamps
        .windows(2)
        .map(|w| {
            let available = w[0][1] != 0 && w[1][1] != 0;
            available.then(|| (w[1][0].wrapping_sub(w[0][0]) & mask) as f64 * f64::from(period))
        })
        .collect()
}

impl Drop for Timer {
    fn drop(&mut self) {
        self.gpu.died(self.pool);
        // SAFETY: the frame that wrote it has been waited for.
        unsafe { self.gpu.device.destroy_query_pool(self.pool, None) };
    }
}

#[cfg(test)]
mod tests {
    use super::intervals;

    #[test]
    fn wraps_at_the_counters_width_and_drops_what_is_missing() {
        let near_the_top = (1u64 << 36) - 10;
        let got = intervals(&[[near_the_top, 1], [5, 1], [25, 0]], 36, 2.);
        assert_eq!(got, vec![Some(30.), None]);
        // A reader that forgets the width would see some 2^64 ticks.
        assert_ne!(intervals(&[[near_the_top, 1], [5, 1]], 64, 2.), vec![Some(30.)]);
    }
}
