//! Pipelines. Set layout and push range come from the shaders' own SPIR-V; everything is one push-descriptor set.

use super::{Gpu, GpuError, Named};
use crate::shaders::{Binding, BindingKind, Shader, ShaderStage};
use ash::vk;
use std::sync::Arc;

/// Specialization constants by name.
pub type Constants<'a> = &'a [(&'a str, u32)];

/// Fixed-function state of a raster pass.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Raster {
    /// Formats of the colour attachments.
    pub colors: Vec<vk::Format>,
    /// Format of the depth attachment; UNDEFINED: there is none.
    pub depth: vk::Format,
    /// Depth test.
    pub compare: vk::CompareOp,
    /// Premultiplied colour is drawn over what is there: out = src + (1 - src.a) dst; depth is tested and not written.
    pub over: bool,
    /// Faces that are not drawn.
    pub cull: vk::CullModeFlags,
    /// Slope-scaled and constant depth bias.
    pub bias: Option<(f32, f32)>,
    /// Points are drawn, not triangles.
    pub points: bool,
    /// Vertices beyond the depth range are clamped to it instead of clipped.
    pub clamp: bool,
    /// One tightly packed stream per entry: shader location and format.
    pub streams: Vec<(u32, vk::Format)>,
}

/// A pipeline with the layout it was made for.
pub struct Pipeline {
    pub(super) handle: vk::Pipeline,
    pub(super) layout: vk::PipelineLayout,
    set_layout: vk::DescriptorSetLayout,
    pub(super) point: vk::PipelineBindPoint,
    pub(super) push_stages: vk::ShaderStageFlags,
    /// Resources by binding number.
    pub bindings: Vec<Binding>,
    /// Threads of a workgroup.
    pub workgroup: [u32; 3],
    /// Bytes of push constants.
    pub push_size: u32,
    /// Debug name.
    pub name: String,
    gpu: Arc<Gpu>,
}

fn stage_flags(stage: ShaderStage) -> vk::ShaderStageFlags {
    match stage {
        ShaderStage::Compute => vk::ShaderStageFlags::COMPUTE,
        ShaderStage::Vertex => vk::ShaderStageFlags::VERTEX,
        ShaderStage::Fragment => vk::ShaderStageFlags::FRAGMENT,
    }
}

impl Pipeline {
    /// A compute pipeline.
    ///
    /// # Errors
    /// Where the driver refuses.
    pub fn compute(
        gpu: &Arc<Gpu>,
        name: &str,
        shader: &'static Shader,
        constants: Constants<'_>,
    ) -> Result<Self, GpuError> {
        let mut pipeline = Self::layout(gpu, name, &[shader], vk::PipelineBindPoint::COMPUTE)?;
        let module = Module::new(gpu, shader)?;
        let special = Special::new(shader, constants);
        let info = special.info();
        let stage = vk::PipelineShaderStageCreateInfo::default()
            .stage(vk::ShaderStageFlags::COMPUTE)
            .module(module.0)
            .name(c"main")
            .specialization_info(&info);
        let create = vk::ComputePipelineCreateInfo::default().stage(stage).layout(pipeline.layout);
        // SAFETY: module, layout and specialization data outlive the call.
        let made = unsafe { gpu.device.create_compute_pipelines(gpu.cache, &[create], None) };
        pipeline.handle = made.map_err(|(_, e)| e).named("vkCreateComputePipelines", name)?[0];
        gpu.born(pipeline.handle, name);
        Ok(pipeline)
    }

    /// A graphics pipeline of a vertex shader and, unless only depth is wanted, a fragment shader. Dynamic viewport and scissor.
    ///
    /// # Errors
    /// Where the driver refuses.
    pub fn graphics(
        gpu: &Arc<Gpu>,
        name: &str,
        vertex: &'static Shader,
        fragment: Option<&'static Shader>,
        constants: Constants<'_>,
        raster: &Raster,
    ) -> Result<Self, GpuError> {
        let shaders: Vec<&'static Shader> = std::iter::once(vertex).chain(fragment).collect();
        let mut pipeline = Self::layout(gpu, name, &shaders, vk::PipelineBindPoint::GRAPHICS)?;
        let modules: Vec<Module<'_>> = shaders.iter().map(|s| Module::new(gpu, s)).collect::<Result<_, _>>()?;
        let special: Vec<Special> = shaders.iter().map(|s| Special::new(s, constants)).collect();
        let infos: Vec<_> = special.iter().map(Special::info).collect();
        let stages: Vec<_> = shaders
            .iter()
            .zip(&modules)
            .zip(&infos)
            .map(|((shader, module), info)| {
                vk::PipelineShaderStageCreateInfo::default()
                    .stage(stage_flags(shader.stage))
                    .module(module.0)
                    .name(c"main")
                    .specialization_info(info)
            })
            .collect();
        let vertex_bindings: Vec<_> = raster
            .streams
            .iter()
            .enumerate()
            .map(|(i, (_, f))| vk::VertexInputBindingDescription::default().binding(i as u32).stride(bytes_of(*f)))
            .collect();
        let attributes: Vec<_> = raster
            .streams
            .iter()
            .enumerate()
            .map(|(i, (l, f))| vk::VertexInputAttributeDescription::default().binding(i as u32).location(*l).format(*f))
            .collect();
        let input = vk::PipelineVertexInputStateCreateInfo::default()
            .vertex_binding_descriptions(&vertex_bindings)
            .vertex_attribute_descriptions(&attributes);
        let topology =
            if raster.points { vk::PrimitiveTopology::POINT_LIST } else { vk::PrimitiveTopology::TRIANGLE_LIST };
        let assembly = vk::PipelineInputAssemblyStateCreateInfo::default().topology(topology);
        let viewport = vk::PipelineViewportStateCreateInfo::default().viewport_count(1).scissor_count(1);
        let (slope, constant) = raster.bias.unwrap_or_default();
        let rasterizer = vk::PipelineRasterizationStateCreateInfo::default()
            .polygon_mode(vk::PolygonMode::FILL)
            .cull_mode(raster.cull)
            .front_face(vk::FrontFace::COUNTER_CLOCKWISE)
            .depth_bias_enable(raster.bias.is_some())
            .depth_bias_slope_factor(slope)
            .depth_bias_constant_factor(constant)
            .depth_clamp_enable(raster.clamp)
            .line_width(1.);
        let samples =
            vk::PipelineMultisampleStateCreateInfo::default().rasterization_samples(vk::SampleCountFlags::TYPE_1);
        let depth = vk::PipelineDepthStencilStateCreateInfo::default()
            .depth_test_enable(raster.depth != vk::Format::UNDEFINED)
            .depth_write_enable(raster.depth != vk::Format::UNDEFINED && !raster.over)
            .depth_compare_op(raster.compare);
        let blends = vec![
            vk::PipelineColorBlendAttachmentState::default()
                .color_write_mask(vk::ColorComponentFlags::RGBA)
                .blend_enable(raster.over)
                .src_color_blend_factor(vk::BlendFactor::ONE)
                .dst_color_blend_factor(vk::BlendFactor::ONE_MINUS_SRC_ALPHA)
                .src_alpha_blend_factor(vk::BlendFactor::ONE)
                .dst_alpha_blend_factor(vk::BlendFactor::ONE_MINUS_SRC_ALPHA);
            raster.colors.len()
        ];
        let blend = vk::PipelineColorBlendStateCreateInfo::default().attachments(&blends);
        let states = [vk::DynamicState::VIEWPORT, vk::DynamicState::SCISSOR];
        let dynamic = vk::PipelineDynamicStateCreateInfo::default().dynamic_states(&states);
        let mut rendering = vk::PipelineRenderingCreateInfo::default()
            .color_attachment_formats(&raster.colors)
            .depth_attachment_format(raster.depth);
        let create = vk::GraphicsPipelineCreateInfo::default()
            .stages(&stages)
            .vertex_input_state(&input)
            .input_assembly_state(&assembly)
            .viewport_state(&viewport)
            .rasterization_state(&rasterizer)
            .multisample_state(&samples)
            .depth_stencil_state(&depth)
            .color_blend_state(&blend)
            .dynamic_state(&dynamic)
            .layout(pipeline.layout)
            .push_next(&mut rendering);
        // SAFETY: everything pointed to outlives the call.
        let made = unsafe { gpu.device.create_graphics_pipelines(gpu.cache, &[create], None) };
        pipeline.handle = made.map_err(|(_, e)| e).named("vkCreateGraphicsPipelines", name)?[0];
        gpu.born(pipeline.handle, name);
        Ok(pipeline)
    }

    /// The layout that the shaders ask for; a binding that two stages share is one binding.
    fn layout(
        gpu: &Arc<Gpu>,
        name: &str,
        shaders: &[&'static Shader],
        point: vk::PipelineBindPoint,
    ) -> Result<Self, GpuError> {
        let mut bindings: Vec<Binding> = Vec::new();
        let mut push_size = 0;
        let mut push_stages = vk::ShaderStageFlags::empty();
        let stages = shaders.iter().fold(vk::ShaderStageFlags::empty(), |s, x| s | stage_flags(x.stage));
        for shader in shaders {
            for b in shader.bindings {
                match bindings.iter().find(|have| have.binding == b.binding) {
                    None => bindings.push(*b),
                    Some(have) if have.name == b.name && have.kind == b.kind => {}
                    Some(have) => {
                        return Err(GpuError::Misuse(format!(
                            "{name}: binding {} is {} in one stage and {} in another",
                            b.binding, have.name, b.name
                        )));
                    }
                }
            }
            if shader.push_size > 0 {
                push_size = push_size.max(shader.push_size);
                push_stages |= stage_flags(shader.stage);
            }
        }
        let infos: Vec<_> = bindings
            .iter()
            .map(|b| {
                vk::DescriptorSetLayoutBinding::default()
                    .binding(b.binding)
                    .descriptor_type(descriptor_type(b.kind))
                    .descriptor_count(1)
                    .stage_flags(stages)
            })
            .collect();
        let info = vk::DescriptorSetLayoutCreateInfo::default()
            .flags(vk::DescriptorSetLayoutCreateFlags::PUSH_DESCRIPTOR_KHR)
            .bindings(&infos);
        // SAFETY: a valid create info.
        let set_layout = unsafe { gpu.device.create_descriptor_set_layout(&info, None) }
            .named("vkCreateDescriptorSetLayout", name)?;
        gpu.born(set_layout, name);
        let mut pipeline = Pipeline {
            handle: vk::Pipeline::null(),
            layout: vk::PipelineLayout::null(),
            set_layout,
            point,
            push_stages,
            bindings,
            workgroup: shaders[0].workgroup,
            push_size,
            name: name.to_owned(),
            gpu: gpu.clone(),
        };
        let sets = [set_layout];
        let ranges = [vk::PushConstantRange { stage_flags: push_stages, offset: 0, size: push_size }];
        let info = vk::PipelineLayoutCreateInfo::default().set_layouts(&sets).push_constant_ranges(if push_size > 0 {
            &ranges
        } else {
            &[]
        });
        // SAFETY: the set layout is alive.
        pipeline.layout =
            unsafe { gpu.device.create_pipeline_layout(&info, None) }.named("vkCreatePipelineLayout", name)?;
        gpu.born(pipeline.layout, name);
        Ok(pipeline)
    }
}

impl Drop for Pipeline {
    fn drop(&mut self) {
        self.gpu.died(self.handle);
        self.gpu.died(self.layout);
        self.gpu.died(self.set_layout);
        // SAFETY: the owner of the frame waits for its fence before it lets go of what the frame uses.
        unsafe {
            self.gpu.device.destroy_pipeline(self.handle, None);
            self.gpu.device.destroy_pipeline_layout(self.layout, None);
            self.gpu.device.destroy_descriptor_set_layout(self.set_layout, None);
        }
    }
}

pub(super) fn descriptor_type(kind: BindingKind) -> vk::DescriptorType {
    match kind {
        BindingKind::StorageImage => vk::DescriptorType::STORAGE_IMAGE,
        BindingKind::SampledImage => vk::DescriptorType::COMBINED_IMAGE_SAMPLER,
        BindingKind::Uniform => vk::DescriptorType::UNIFORM_BUFFER,
        BindingKind::Storage => vk::DescriptorType::STORAGE_BUFFER,
    }
}

fn bytes_of(format: vk::Format) -> u32 {
    match format {
        vk::Format::R32G32_SFLOAT => 8,
        vk::Format::R32G32B32_SFLOAT => 12,
        vk::Format::R32G32B32A32_SFLOAT => 16,
        _ => 4,
    }
}

/// A shader module for as long as a pipeline is being made.
struct Module<'a>(vk::ShaderModule, &'a Gpu);

impl<'a> Module<'a> {
    fn new(gpu: &'a Gpu, shader: &Shader) -> Result<Self, GpuError> {
        let words: Vec<u32> =
            shader.code.chunks_exact(4).map(|c| u32::from_le_bytes([c[0], c[1], c[2], c[3]])).collect();
        let info = vk::ShaderModuleCreateInfo::default().code(&words);
        // SAFETY: the build's compiler or assembler wrote this SPIR-V.
        let module =
            unsafe { gpu.device.create_shader_module(&info, None) }.named("vkCreateShaderModule", shader.name)?;
        Ok(Module(module, gpu))
    }
}

impl Drop for Module<'_> {
    fn drop(&mut self) {
        // SAFETY: a module may go once its pipelines are made.
        unsafe { self.1.device.destroy_shader_module(self.0, None) };
    }
}

/// Specialization data of one shader: the constants that it has.
struct Special {
    entries: Vec<vk::SpecializationMapEntry>,
    data: Vec<u8>,
}

impl Special {
    fn new(shader: &Shader, constants: Constants<'_>) -> Self {
        let mut special = Special { entries: Vec::new(), data: Vec::new() };
        for (name, value) in constants {
            // The tile's sides have two ids: the workgroup's own, and the numbers to reckon with.
            for (_, id) in shader.constants.iter().filter(|c| c.0 == *name) {
                let offset = special.data.len() as u32;
                special.entries.push(vk::SpecializationMapEntry { constant_id: *id, offset, size: 4 });
                special.data.extend_from_slice(&value.to_le_bytes());
            }
        }
        special
    }

    fn info(&self) -> vk::SpecializationInfo<'_> {
        vk::SpecializationInfo::default().map_entries(&self.entries).data(&self.data)
    }
}
