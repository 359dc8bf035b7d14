//! An open pass: binding, drawing, dispatching, copying.

use super::commands::Recorder;
use super::pipeline::{Pipeline, descriptor_type};
use super::{Buffer, GpuError, Image, Sampler};
use ash::vk;

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

/// Attachments of a raster pass.
pub struct Attachments<'a> {
    /// Colour targets with their clear values (as raw bits); without one the old content may be anything.
    pub colors: &'a [(&'a Image, Option<[u32; 4]>)],
    /// Depth target, its layer if it is an array, its clear value; none where nothing hides anything. Colour targets that are arrays
    /// are written in the same layer.
    pub depth: Option<(&'a Image, Option<u32>, f32)>,
    /// What all of them hold is kept, and drawn over.
    pub keep: bool,
}

/// An open pass.
pub struct Pass<'a> {
    recorder: &'a mut Recorder,
    last: vk::PipelineStageFlags2,
}

impl<'a> Pass<'a> {
    pub(super) fn open(recorder: &'a mut Recorder) -> Self {
        Pass { recorder, last: vk::PipelineStageFlags2::ALL_COMMANDS }
    }

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

    /// Runs a pipeline over as many tiles as the buffer says at an offset: a workgroup each or, inside a rendering, a point each.
    ///
    /// # Errors
    /// Where a resource is missing or the push constants do not fit.
    pub fn indirect<'b>(
        &mut self,
        pipeline: &Pipeline,
        arguments: (&Buffer, u64),
        push: &[u8],
        resources: impl Fn(&str) -> Option<Bound<'b>>,
    ) -> Result<(), GpuError> {
        self.bind(pipeline, resources)?;
        self.push(pipeline, push)?;
        let r = &self.recorder;
        let (buffer, offset) = (arguments.0.handle, arguments.1);
        if pipeline.point == vk::PipelineBindPoint::GRAPHICS {
            // SAFETY: recording, inside a rendering; the buffer holds count, 1, 1, 0 there, a VkDrawIndirectCommand, too.
            unsafe { r.gpu.device.cmd_draw_indirect(r.commands, buffer, offset, 1, 16) };
        } else {
            // SAFETY: recording; the buffer holds a VkDispatchIndirectCommand at that offset.
            unsafe { r.gpu.device.cmd_dispatch_indirect(r.commands, buffer, offset) };
            self.last = vk::PipelineStageFlags2::COMPUTE_SHADER;
        }
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
        let layer = attachments.depth.and_then(|d| d.1);
        let layered =
            |image: &Image| layer.and_then(|l| image.layer_views.get(l as usize)).copied().unwrap_or(image.view);
        let colors: Vec<_> = attachments
            .colors
            .iter()
            .map(|(image, clear)| {
                vk::RenderingAttachmentInfo::default()
                    .image_view(layered(image))
                    .image_layout(vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL)
                    .load_op(if attachments.keep {
                        vk::AttachmentLoadOp::LOAD
                    } else if clear.is_some() {
                        vk::AttachmentLoadOp::CLEAR
                    } else {
                        vk::AttachmentLoadOp::DONT_CARE
                    })
                    .store_op(vk::AttachmentStoreOp::STORE)
                    .clear_value(vk::ClearValue { color: vk::ClearColorValue { uint32: clear.unwrap_or_default() } })
            })
            .collect();
        let depth = vk::RenderingAttachmentInfo::default()
            .image_view(attachments.depth.map_or(vk::ImageView::null(), |d| layered(d.0)))
            .image_layout(vk::ImageLayout::DEPTH_ATTACHMENT_OPTIMAL)
            .load_op(if attachments.keep { vk::AttachmentLoadOp::LOAD } else { vk::AttachmentLoadOp::CLEAR })
            .store_op(if attachments.keep { vk::AttachmentStoreOp::NONE } else { vk::AttachmentStoreOp::STORE })
            .clear_value(vk::ClearValue {
                depth_stencil: vk::ClearDepthStencilValue { depth: attachments.depth.map_or(0., |d| d.2), stencil: 0 },
            });
        let size =
            attachments.depth.map(|d| d.0).or(attachments.colors.first().map(|c| c.0)).map_or([1; 2], |i| i.desc.size);
        let extent = vk::Extent2D { width: size[0], height: size[1] };
        let area = vk::Rect2D { offset: vk::Offset2D::default(), extent };
        let info = vk::RenderingInfo::default().render_area(area).layer_count(1).color_attachments(&colors);
        let info = if attachments.depth.is_some() { info.depth_attachment(&depth) } else { info };
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
