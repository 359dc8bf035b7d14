//! Recording and submitting. [`Recorder::pass`] is the only way to record work: it emits the pass's barriers in one call,
//! opens the debug label, and on drop closes it and writes the timestamp. No pass can forget any of them.

use super::pipeline::{Pipeline, descriptor_type};
use super::timing::{Timer, TimingMode};
use super::usage::Barrier;
use super::{Buffer, Gpu, GpuError, Image, Named, Sampler};
use ash::vk;
use std::ffi::CString;
use std::sync::Arc;

/// A resource as a shader sees it.
#[derive(Clone, Copy)]
pub enum Bound<'a> {
    /// A storage image, in GENERAL layout.
    Image(&'a Image),
    /// An image with a sampler, in SHADER_READ_ONLY layout.
    Sampled(&'a Image, &'a Sampler),
    /// A buffer, whole.
    Buffer(&'a Buffer),
}

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
    gpu: Arc<Gpu>,
    pool: vk::CommandPool,
    commands: vk::CommandBuffer,
    timer: Option<Timer>,
    stamped: u32,
}

/// Work that can be submitted again and again.
pub struct Recorded {
    gpu: Arc<Gpu>,
    pool: vk::CommandPool,
    commands: vk::CommandBuffer,
    fence: vk::Fence,
    timer: Option<Timer>,
}

/// Attachments of a raster pass.
pub struct Attachments<'a> {
    /// Colour targets with their clear values (as raw bits); without one the old content may be anything.
    pub colors: &'a [(&'a Image, Option<[u32; 4]>)],
    /// Depth target, its layer if it is an array, its clear value.
    pub depth: (&'a Image, Option<u32>, f32),
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
        Pass { recorder: self, last: vk::PipelineStageFlags2::ALL_COMMANDS }
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

    fn stamp(&mut self, last: vk::PipelineStageFlags2) {
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
        Ok(Recorded { gpu: self.gpu.clone(), pool, commands: self.commands, fence, timer: self.timer.take() })
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

/// An open pass.
pub struct Pass<'a> {
    recorder: &'a mut Recorder,
    last: vk::PipelineStageFlags2,
}

impl Pass<'_> {
    fn bind<'b>(&mut self, pipeline: &Pipeline, resources: impl Fn(&str) -> Option<Bound<'b>>) -> Result<(), GpuError> {
        let mut images = Vec::with_capacity(pipeline.bindings.len());
        let mut buffers = Vec::with_capacity(pipeline.bindings.len());
        for b in &pipeline.bindings {
            let missing = || GpuError::Misuse(format!("{}: nothing is bound to `{}`", pipeline.name, b.name));
            let (mut image, mut buffer) = (vk::DescriptorImageInfo::default(), vk::DescriptorBufferInfo::default());
            match resources(b.name).ok_or_else(missing)? {
                Bound::Image(i) => image = image.image_view(i.view).image_layout(vk::ImageLayout::GENERAL),
                Bound::Sampled(i, s) => {
                    image = image
                        .image_view(i.view)
                        .sampler(s.handle)
                        .image_layout(vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL);
                }
                Bound::Buffer(x) => buffer = buffer.buffer(x.handle).range(vk::WHOLE_SIZE),
            }
            images.push([image]);
            buffers.push([buffer]);
        }
        let writes: Vec<_> = pipeline
            .bindings
            .iter()
            .zip(images.iter().zip(&buffers))
            .map(|(b, (image, buffer))| {
                let write =
                    vk::WriteDescriptorSet::default().dst_binding(b.binding).descriptor_type(descriptor_type(b.kind));
                match b.kind {
                    crate::shaders::BindingKind::StorageImage | crate::shaders::BindingKind::SampledImage => {
                        write.image_info(image)
                    }
                    _ => write.buffer_info(buffer),
                }
            })
            .collect();
        let r = &self.recorder;
        // SAFETY: recording; pipeline and resources are alive and stay so until the fence (the frame owns them).
        unsafe {
            r.gpu.device.cmd_bind_pipeline(r.commands, pipeline.point, pipeline.handle);
            r.gpu.push.cmd_push_descriptor_set(r.commands, pipeline.point, pipeline.layout, 0, &writes);
        }
        Ok(())
    }

    fn push(&mut self, pipeline: &Pipeline, bytes: &[u8]) -> Result<(), GpuError> {
        if bytes.len() != pipeline.push_size as usize {
            return Err(GpuError::Misuse(format!(
                "{}: {} bytes of push constants, the shader has {}",
                pipeline.name,
                bytes.len(),
                pipeline.push_size
            )));
        }
        if !bytes.is_empty() {
            let r = &self.recorder;
            // SAFETY: recording; stages and size are the layout's own.
            unsafe { r.gpu.device.cmd_push_constants(r.commands, pipeline.layout, pipeline.push_stages, 0, bytes) };
        }
        Ok(())
    }

    /// Runs a compute pipeline over at least `threads` threads.
    ///
    /// # Errors
    /// Where a resource is missing or the push constants do not fit.
    pub fn dispatch_over<'b>(
        &mut self,
        pipeline: &Pipeline,
        threads: [u32; 2],
        push: &[u8],
        resources: impl Fn(&str) -> Option<Bound<'b>>,
    ) -> Result<(), GpuError> {
        self.bind(pipeline, resources)?;
        self.push(pipeline, push)?;
        let groups = [threads[0].div_ceil(pipeline.workgroup[0]), threads[1].div_ceil(pipeline.workgroup[1])];
        let r = &self.recorder;
        // SAFETY: recording; pipeline and descriptors are bound.
        unsafe { r.gpu.device.cmd_dispatch(r.commands, groups[0], groups[1], 1) };
        self.last = vk::PipelineStageFlags2::COMPUTE_SHADER;
        Ok(())
    }

    /// Runs a compute pipeline over as many workgroups as the buffer says at `offset`.
    ///
    /// # Errors
    /// Where a resource is missing or the push constants do not fit.
    pub fn dispatch_indirect<'b>(
        &mut self,
        pipeline: &Pipeline,
        arguments: (&Buffer, u64),
        push: &[u8],
        resources: impl Fn(&str) -> Option<Bound<'b>>,
    ) -> Result<(), GpuError> {
        self.bind(pipeline, resources)?;
        self.push(pipeline, push)?;
        let r = &self.recorder;
        // SAFETY: recording; the buffer holds a VkDispatchIndirectCommand at that offset.
        unsafe { r.gpu.device.cmd_dispatch_indirect(r.commands, arguments.0.handle, arguments.1) };
        self.last = vk::PipelineStageFlags2::COMPUTE_SHADER;
        Ok(())
    }

    /// Writes a few words into a buffer.
    pub fn update(&mut self, buffer: &Buffer, bytes: &[u8]) {
        let r = &self.recorder;
        // SAFETY: recording; at most 65536 bytes, a multiple of four, within the buffer.
        unsafe { r.gpu.device.cmd_update_buffer(r.commands, buffer.handle, 0, bytes) };
        self.last = vk::PipelineStageFlags2::ALL_TRANSFER;
    }

    /// Copies the first `size` bytes of one buffer to another.
    pub fn copy(&mut self, from: &Buffer, to: &Buffer, size: u64) {
        let region = [vk::BufferCopy { src_offset: 0, dst_offset: 0, size }];
        let r = &self.recorder;
        // SAFETY: recording; both buffers are at least that long.
        unsafe { r.gpu.device.cmd_copy_buffer(r.commands, from.handle, to.handle, &region) };
        self.last = vk::PipelineStageFlags2::ALL_TRANSFER;
    }

    /// Clears a colour image in TRANSFER_DST layout.
    pub fn clear(&mut self, image: &Image, value: [f32; 4]) {
        let color = vk::ClearColorValue { float32: value };
        let r = &self.recorder;
        // SAFETY: recording; the barrier of the pass brought the image into this layout.
        unsafe {
            let layout = vk::ImageLayout::TRANSFER_DST_OPTIMAL;
            r.gpu.device.cmd_clear_color_image(r.commands, image.handle, layout, &color, &[image.range()]);
        }
        self.last = vk::PipelineStageFlags2::ALL_TRANSFER;
    }

    /// Copies a whole image (TRANSFER_SRC layout, first mip and layer) into a buffer.
    pub fn read_back(&mut self, image: &Image, buffer: &Buffer) {
        let region = copy_region(image, 0, image.desc.size, 0);
        let r = &self.recorder;
        // SAFETY: recording; the buffer was made large enough by the caller, who owns both.
        unsafe {
            let layout = vk::ImageLayout::TRANSFER_SRC_OPTIMAL;
            r.gpu.device.cmd_copy_image_to_buffer(r.commands, image.handle, layout, buffer.handle, &[region]);
        }
        self.last = vk::PipelineStageFlags2::ALL_TRANSFER;
    }

    /// Copies each mip of an image (TRANSFER_DST layout) from a buffer that holds them one after another.
    pub fn upload(&mut self, buffer: &Buffer, image: &Image, mips: &[(u64, [u32; 2])]) {
        let regions: Vec<_> =
            mips.iter().enumerate().map(|(m, (offset, size))| copy_region(image, *offset, *size, m as u32)).collect();
        let r = &self.recorder;
        // SAFETY: recording; offsets and sizes lie inside the buffer and the image.
        unsafe {
            let layout = vk::ImageLayout::TRANSFER_DST_OPTIMAL;
            r.gpu.device.cmd_copy_buffer_to_image(r.commands, buffer.handle, image.handle, layout, &regions);
        }
        self.last = vk::PipelineStageFlags2::ALL_TRANSFER;
    }

    /// Opens a rendering over the attachments' full extent.
    pub fn render(&mut self, attachments: &Attachments<'_>) {
        let colors: Vec<_> = attachments
            .colors
            .iter()
            .map(|(image, clear)| {
                vk::RenderingAttachmentInfo::default()
                    .image_view(image.view)
                    .image_layout(vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL)
                    .load_op(if clear.is_some() {
                        vk::AttachmentLoadOp::CLEAR
                    } else {
                        vk::AttachmentLoadOp::DONT_CARE
                    })
                    .store_op(vk::AttachmentStoreOp::STORE)
                    .clear_value(vk::ClearValue { color: vk::ClearColorValue { uint32: clear.unwrap_or_default() } })
            })
            .collect();
        let (image, layer, clear) = attachments.depth;
        let view = layer.and_then(|l| image.layer_views.get(l as usize)).copied().unwrap_or(image.view);
        let depth = vk::RenderingAttachmentInfo::default()
            .image_view(view)
            .image_layout(vk::ImageLayout::DEPTH_ATTACHMENT_OPTIMAL)
            .load_op(vk::AttachmentLoadOp::CLEAR)
            .store_op(vk::AttachmentStoreOp::STORE)
            .clear_value(vk::ClearValue { depth_stencil: vk::ClearDepthStencilValue { depth: clear, stencil: 0 } });
        let extent = vk::Extent2D { width: image.desc.size[0], height: image.desc.size[1] };
        let area = vk::Rect2D { offset: vk::Offset2D::default(), extent };
        let info = vk::RenderingInfo::default()
            .render_area(area)
            .layer_count(1)
            .color_attachments(&colors)
            .depth_attachment(&depth);
        let viewport = vk::Viewport {
            width: extent.width as f32,
            height: extent.height as f32,
            max_depth: 1.,
            ..Default::default()
        };
        let r = &self.recorder;
        // SAFETY: recording; the views are alive and in the named layouts through the pass's barriers.
        unsafe {
            r.gpu.device.cmd_begin_rendering(r.commands, &info);
            r.gpu.device.cmd_set_viewport(r.commands, 0, &[viewport]);
            r.gpu.device.cmd_set_scissor(r.commands, 0, &[area]);
        }
        self.last = if colors.is_empty() {
            vk::PipelineStageFlags2::LATE_FRAGMENT_TESTS
        } else {
            vk::PipelineStageFlags2::COLOR_ATTACHMENT_OUTPUT
        };
    }

    /// Binds a graphics pipeline with its resources, constants and vertex streams.
    ///
    /// # Errors
    /// Where a resource is missing or the push constants do not fit.
    pub fn prepare<'b>(
        &mut self,
        pipeline: &Pipeline,
        streams: &[&Buffer],
        indices: &Buffer,
        push: &[u8],
        resources: impl Fn(&str) -> Option<Bound<'b>>,
    ) -> Result<(), GpuError> {
        self.bind(pipeline, resources)?;
        self.push(pipeline, push)?;
        let handles: Vec<_> = streams.iter().map(|b| b.handle).collect();
        let r = &self.recorder;
        // SAFETY: recording; the streams match the pipeline's vertex input.
        unsafe {
            r.gpu.device.cmd_bind_vertex_buffers(r.commands, 0, &handles, &vec![0; handles.len()]);
            r.gpu.device.cmd_bind_index_buffer(r.commands, indices.handle, 0, vk::IndexType::UINT32);
        }
        Ok(())
    }

    /// Draws a range of the index buffer.
    pub fn draw(&mut self, first_index: u32, count: u32) {
        let r = &self.recorder;
        // SAFETY: inside a rendering, pipeline and buffers bound; the range lies inside the index buffer.
        unsafe { r.gpu.device.cmd_draw_indexed(r.commands, count, 1, first_index, 0, 0) };
    }

    /// Closes the rendering.
    pub fn end_render(&mut self) {
        let r = &self.recorder;
        // SAFETY: a rendering is open.
        unsafe { r.gpu.device.cmd_end_rendering(r.commands) };
    }
}

impl Drop for Pass<'_> {
    fn drop(&mut self) {
        if let Some(debug) = &self.recorder.gpu.debug {
            // SAFETY: the label was opened by `Recorder::pass`.
            unsafe { debug.cmd_end_debug_utils_label(self.recorder.commands) };
        }
        self.recorder.stamp(self.last);
    }
}

fn copy_region(image: &Image, offset: u64, size: [u32; 2], mip: u32) -> vk::BufferImageCopy {
    vk::BufferImageCopy::default()
        .buffer_offset(offset)
        .image_subresource(vk::ImageSubresourceLayers {
            aspect_mask: image.desc.aspect(),
            mip_level: mip,
            base_array_layer: 0,
            layer_count: 1,
        })
        .image_extent(vk::Extent3D { width: size[0], height: size[1], depth: 1 })
}

impl Recorded {
    /// Submits once and waits for the fence.
    ///
    /// # Errors
    /// Where the device is lost.
    pub fn run(&self) -> Result<(), GpuError> {
        if let Some(timer) = &self.timer {
            timer.reset();
        }
        let buffers = [vk::CommandBufferSubmitInfo::default().command_buffer(self.commands)];
        let submit = vk::SubmitInfo2::default().command_buffer_infos(&buffers);
        // SAFETY: the command buffer is executable and not pending: every run waits for its fence.
        unsafe {
            self.gpu.device.queue_submit2(self.gpu.queue, &[submit], self.fence).named("vkQueueSubmit2", "frame")?;
            self.gpu.device.wait_for_fences(&[self.fence], true, u64::MAX).named("vkWaitForFences", "frame")?;
            self.gpu.device.reset_fences(&[self.fence]).named("vkResetFences", "frame")
        }
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
