//! Recorded work: submitted as often as one likes, waited for each time.

use super::timing::Timer;
use super::{Gpu, GpuError, Named};
use ash::vk;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Work that can be submitted again and again.
pub struct Recorded {
    gpu: Arc<Gpu>,
    pool: vk::CommandPool,
    commands: vk::CommandBuffer,
    fence: vk::Fence,
    timer: Option<Timer>,
}

impl Recorded {
    pub(super) fn new(
        gpu: &Arc<Gpu>,
        pool: vk::CommandPool,
        commands: vk::CommandBuffer,
        fence: vk::Fence,
        timer: Option<Timer>,
    ) -> Self {
        Recorded { gpu: gpu.clone(), pool, commands, fence, timer }
    }

    /// Submits once and waits for the fence. Returns the time that was spent in the driver.
    ///
    /// # Errors
    /// Where the device is lost.
    pub fn run(&self) -> Result<Duration, GpuError> {
        if let Some(timer) = &self.timer {
            timer.reset();
        }
        let buffers = [vk::CommandBufferSubmitInfo::default().command_buffer(self.commands)];
        let submit = vk::SubmitInfo2::default().command_buffer_infos(&buffers);
        let start = Instant::now();
        // SAFETY: the command buffer is executable and not pending: every run waits for its fence.
        unsafe {
            self.gpu.device.queue_submit2(self.gpu.queue, &[submit], self.fence).named("vkQueueSubmit2", "frame")?;
            self.gpu.device.wait_for_fences(&[self.fence], true, u64::MAX).named("vkWaitForFences", "frame")?;
            self.gpu.device.reset_fences(&[self.fence]).named("vkResetFences", "frame")?;
        }
        Ok(start.elapsed())
    }

    /// The timer it was recorded with.
    pub fn timer(&self) -> Option<&Timer> {
        self.timer.as_ref()
    }
}

impl Drop for Recorded {
    fn drop(&mut self) {
        self.gpu.died(self.pool);
        self.gpu.died(self.fence);
        // SAFETY: every run has waited for its fence.
        unsafe {
            self.gpu.device.destroy_fence(self.fence, None);
            self.gpu.device.destroy_command_pool(self.pool, None);
        }
    }
}
