//! Recording and submitting. [`Recorder::pass`] is the only way to record work: it emits the pass's barriers in one call,
//! opens the debug label, and on drop closes it and writes the timestamp. No pass can forget any of them.

use super::pass::Pass;
use super::submit::Recorded;
use super::timing::{Timer, TimingMode};
use super::usage::Barrier;
use super::{Buffer, Gpu, GpuError, Image, Named};
use ash::vk;
use std::ffi::CString;
use std::sync::Arc;

/// What a barrier is for.
#[derive(Clone, Copy)]
pub enum Guarded<'a> {
    /// An image.
    Image(&'a Image),
    /// A buffer.
    Buffer(&'a Buffer),
}

/// A command buffer being recorded.
pub struct Recorder {
    pub(super) gpu: Arc<Gpu>,
    pool: vk::CommandPool,
    pub(super) commands: vk::CommandBuffer,
    timer: Option<Timer>,
    stamped: u32,
}

impl Recorder {
    /// Starts recording.
    ///
    /// # Errors
    /// Where the driver refuses.
    pub fn new(gpu: &Arc<Gpu>, timer: Option<Timer>) -> Result<Self, GpuError> {
        let info = vk::CommandPoolCreateInfo::default().queue_family_index(gpu.family);
        // SAFETY: the family is the queue's.
        let pool = unsafe { gpu.device.create_command_pool(&info, None) }.named("vkCreateCommandPool", "frame")?;
        gpu.born(pool, "frame commands");
        let mut recorder = Recorder { gpu: gpu.clone(), pool, commands: vk::CommandBuffer::null(), timer, stamped: 0 };
        let info = vk::CommandBufferAllocateInfo::default().command_pool(pool).command_buffer_count(1);
        // SAFETY: the pool is alive, and used by this thread alone.
        unsafe {
            recorder.commands =
                gpu.device.allocate_command_buffers(&info).named("vkAllocateCommandBuffers", "frame")?[0];
            gpu.device
                .begin_command_buffer(recorder.commands, &vk::CommandBufferBeginInfo::default())
                .named("vkBeginCommandBuffer", "frame")?;
        }
        recorder.stamp(vk::PipelineStageFlags2::ALL_COMMANDS);
        Ok(recorder)
    }

    /// Opens a pass: its barriers in one call, then its label.
    pub fn pass(&mut self, name: &str, barriers: &[(Guarded<'_>, Barrier)]) -> Pass<'_> {
        self.barriers(barriers);
        if let (Some(debug), Ok(name)) = (&self.gpu.debug, CString::new(name)) {
            let label = vk::DebugUtilsLabelEXT::default().label_name(&name);
            // SAFETY: recording; the label's string outlives the call.
            unsafe { debug.cmd_begin_debug_utils_label(self.commands, &label) };
        }
        Pass::open(self)
    }

    fn barriers(&self, barriers: &[(Guarded<'_>, Barrier)]) {
        if barriers.is_empty() {
            return;
        }
        let mut images = Vec::new();
        let mut buffers = Vec::new();
        for (what, b) in barriers {
            match what {
                Guarded::Image(image) => images.push(
                    vk::ImageMemoryBarrier2::default()
                        .src_stage_mask(b.src_stage)
                        .src_access_mask(b.src_access)
                        .dst_stage_mask(b.dst_stage)
                        .dst_access_mask(b.dst_access)
                        .old_layout(b.old_layout)
                        .new_layout(b.new_layout)
                        .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
                        .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
                        .image(image.handle)
                        .subresource_range(image.range()),
                ),
                Guarded::Buffer(buffer) => buffers.push(
                    vk::BufferMemoryBarrier2::default()
                        .src_stage_mask(b.src_stage)
                        .src_access_mask(b.src_access)
                        .dst_stage_mask(b.dst_stage)
                        .dst_access_mask(b.dst_access)
                        .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
                        .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
                        .buffer(buffer.handle)
                        .size(vk::WHOLE_SIZE),
                ),
            }
        }
        let info = vk::DependencyInfo::default().image_memory_barriers(&images).buffer_memory_barriers(&buffers);
        // SAFETY: recording outside of a rendering; the handles are alive.
        unsafe { self.gpu.device.cmd_pipeline_barrier2(self.commands, &info) };
    }

    fn full_barrier(&self) {
        let all = [vk::MemoryBarrier2::default()
            .src_stage_mask(vk::PipelineStageFlags2::ALL_COMMANDS)
            .src_access_mask(vk::AccessFlags2::MEMORY_WRITE)
            .dst_stage_mask(vk::PipelineStageFlags2::ALL_COMMANDS)
            .dst_access_mask(vk::AccessFlags2::MEMORY_READ | vk::AccessFlags2::MEMORY_WRITE)];
        let info = vk::DependencyInfo::default().memory_barriers(&all);
        // SAFETY: recording outside of a rendering.
        unsafe { self.gpu.device.cmd_pipeline_barrier2(self.commands, &info) };
    }

    pub(super) fn stamp(&mut self, last: vk::PipelineStageFlags2) {
        let Some(timer) = &self.timer else { return };
        if self.stamped >= timer.stamps {
            return;
        }
        let isolated = timer.mode == TimingMode::Isolated;
        if isolated {
            self.full_barrier();
        }
        let stage = if isolated { vk::PipelineStageFlags2::ALL_COMMANDS } else { last };
        // SAFETY: recording outside of a rendering; the query exists and was reset from the host.
        unsafe { self.gpu.device.cmd_write_timestamp2(self.commands, stage, timer.pool, self.stamped) };
        if isolated {
            self.full_barrier();
        }
        self.stamped += 1;
    }

    /// Ends recording.
    ///
    /// # Errors
    /// Where the driver refuses.
    pub fn finish(mut self) -> Result<Recorded, GpuError> {
        // SAFETY: recording; a default fence info is valid.
        let fence = unsafe {
            self.gpu.device.end_command_buffer(self.commands).named("vkEndCommandBuffer", "frame")?;
            self.gpu.device.create_fence(&vk::FenceCreateInfo::default(), None).named("vkCreateFence", "frame")?
        };
        self.gpu.born(fence, "frame fence");
        let pool = std::mem::replace(&mut self.pool, vk::CommandPool::null());
        Ok(Recorded::new(&self.gpu, pool, self.commands, fence, self.timer.take()))
    }
}

impl Drop for Recorder {
    fn drop(&mut self) {
        if self.pool != vk::CommandPool::null() {
            self.gpu.died(self.pool);
            // SAFETY: never submitted.
            unsafe { self.gpu.device.destroy_command_pool(self.pool, None) };
        }
    }
}
