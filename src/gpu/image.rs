//! Images and samplers. Transient images may share a [`Block`] of memory when their lifetimes do not meet.

use super::{Gpu, GpuError, Named};
use ash::vk;
use gpu_allocator::MemoryLocation;
use gpu_allocator::vulkan::{Allocation, AllocationCreateDesc, AllocationScheme};
use std::sync::Arc;

/// What an image is.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageDesc {
    /// Debug name.
    pub name: String,
    /// Texel format.
    pub format: vk::Format,
    /// Width and height in texels, at least 1.
    pub size: [u32; 2],
    /// Array layers; more than one makes it an array image.
    pub layers: u32,
    /// Mip levels.
    pub mips: u32,
    /// What it may be used for.
    pub usage: vk::ImageUsageFlags,
    /// The view is an array view even with one layer.
    pub array: bool,
}

impl ImageDesc {
    /// A plain 2-D image.
    pub fn new(name: &str, format: vk::Format, size: [u32; 2], usage: vk::ImageUsageFlags) -> Self {
        Self { name: name.to_owned(), format, size, layers: 1, mips: 1, usage, array: false }
    }

    fn info(&self) -> vk::ImageCreateInfo<'static> {
        vk::ImageCreateInfo::default()
            .image_type(vk::ImageType::TYPE_2D)
            .format(self.format)
            .extent(vk::Extent3D { width: self.size[0].max(1), height: self.size[1].max(1), depth: 1 })
            .mip_levels(self.mips)
            .array_layers(self.layers)
            .samples(vk::SampleCountFlags::TYPE_1)
            .tiling(vk::ImageTiling::OPTIMAL)
            .usage(self.usage)
            .initial_layout(vk::ImageLayout::UNDEFINED)
    }

    /// Depth or colour.
    pub fn aspect(&self) -> vk::ImageAspectFlags {
        if self.format == vk::Format::D32_SFLOAT { vk::ImageAspectFlags::DEPTH } else { vk::ImageAspectFlags::COLOR }
    }
}

/// Memory that several images take turns in.
pub struct Block {
    allocation: Option<Allocation>,
    gpu: Arc<Gpu>,
}

impl Block {
    /// A block of device memory.
    ///
    /// # Errors
    /// Where no memory type serves, or memory is out.
    pub fn new(gpu: &Arc<Gpu>, name: &str, requirements: vk::MemoryRequirements) -> Result<Arc<Block>, GpuError> {
        let allocation = gpu.allocate(&AllocationCreateDesc {
            name,
            requirements,
            location: MemoryLocation::GpuOnly,
            linear: false,
            allocation_scheme: AllocationScheme::GpuAllocatorManaged,
        })?;
        Ok(Arc::new(Block { allocation: Some(allocation), gpu: gpu.clone() }))
    }
}

impl Drop for Block {
    fn drop(&mut self) {
        if let Some(a) = self.allocation.take() {
            self.gpu.free(a);
        }
    }
}

/// Handle, view, memory and name.
pub struct Image {
    pub(super) handle: vk::Image,
    pub(super) view: vk::ImageView,
    /// One view a layer, for rendering into array images.
    pub(super) layer_views: Vec<vk::ImageView>,
    /// What it is.
    pub desc: ImageDesc,
    /// Bytes of memory it needs.
    pub bytes: u64,
    requirements: vk::MemoryRequirements,
    memory: Option<Arc<Block>>,
    gpu: Arc<Gpu>,
}

impl Image {
    /// An image with memory of its own.
    ///
    /// # Errors
    /// Where the driver or the allocator refuses.
    pub fn new(gpu: &Arc<Gpu>, desc: ImageDesc) -> Result<Self, GpuError> {
        let mut image = Self::unbound(gpu, desc)?;
        let block = Block::new(gpu, &image.desc.name.clone(), image.requirements)?;
        image.bind(&block, 0)?;
        Ok(image)
    }

    /// An image that has no memory yet: [`Image::bind`] gives it some.
    ///
    /// # Errors
    /// Where the driver refuses.
    pub fn unbound(gpu: &Arc<Gpu>, desc: ImageDesc) -> Result<Self, GpuError> {
        let limit = gpu.limits().max_image_dimension2_d;
        if desc.size[0] > limit || desc.size[1] > limit {
            return Err(GpuError::Misuse(format!(
                "{}: {} x {} texels, this device's limit is {limit}",
                desc.name, desc.size[0], desc.size[1]
            )));
        }
        let info = desc.info();
        // SAFETY: a valid create info; the handle is owned by what is returned.
        let handle = unsafe { gpu.device.create_image(&info, None) }.named("vkCreateImage", &desc.name)?;
        gpu.born(handle, &desc.name);
        // SAFETY: the handle is alive.
        let requirements = unsafe { gpu.device.get_image_memory_requirements(handle) };
        Ok(Image {
            handle,
            view: vk::ImageView::null(),
            layer_views: Vec::new(),
            desc,
            bytes: requirements.size,
            requirements,
            memory: None,
            gpu: gpu.clone(),
        })
    }

    /// Gives the image its memory, from `offset` bytes into a block, and makes its views.
    ///
    /// # Errors
    /// Where the block is too short, or the driver refuses.
    pub fn bind(&mut self, block: &Arc<Block>, offset: u64) -> Result<(), GpuError> {
        let Some(allocation) = &block.allocation else {
            return Err(GpuError::Misuse(format!("{}: the block has no memory", self.desc.name)));
        };
        if offset + self.bytes > allocation.size() {
            let text = format!("{}: {} bytes from {offset} do not fit its block", self.desc.name, self.bytes);
            return Err(GpuError::Misuse(text));
        }
        // SAFETY: the block is of a type that serves its tenants, and ends behind this one; an image is bound once.
        unsafe { self.gpu.device.bind_image_memory(self.handle, allocation.memory(), allocation.offset() + offset) }
            .named("vkBindImageMemory", &self.desc.name)?;
        self.memory = Some(block.clone());
        let array = self.desc.array || self.desc.layers > 1;
        self.view = self.make_view(array, 0, self.desc.layers)?;
        let attachments = vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT | vk::ImageUsageFlags::COLOR_ATTACHMENT;
        if array && self.desc.usage.intersects(attachments) {
            self.layer_views = (0..self.desc.layers).map(|l| self.make_view(false, l, 1)).collect::<Result<_, _>>()?;
        }
        Ok(())
    }

    fn make_view(&self, array: bool, first: u32, count: u32) -> Result<vk::ImageView, GpuError> {
        let range = vk::ImageSubresourceRange {
            aspect_mask: self.desc.aspect(),
            base_mip_level: 0,
            level_count: self.desc.mips,
            base_array_layer: first,
            layer_count: count,
        };
        let info = vk::ImageViewCreateInfo::default()
            .image(self.handle)
            .view_type(if array { vk::ImageViewType::TYPE_2D_ARRAY } else { vk::ImageViewType::TYPE_2D })
            .format(self.desc.format)
            .subresource_range(range);
        // SAFETY: the image has memory, and the range lies inside it.
        let view =
            unsafe { self.gpu.device.create_image_view(&info, None) }.named("vkCreateImageView", &self.desc.name)?;
        self.gpu.born(view, &format!("{} view", self.desc.name));
        Ok(view)
    }

    pub(super) fn range(&self) -> vk::ImageSubresourceRange {
        vk::ImageSubresourceRange {
            aspect_mask: self.desc.aspect(),
            base_mip_level: 0,
            level_count: self.desc.mips,
            base_array_layer: 0,
            layer_count: self.desc.layers,
        }
    }
}

impl Drop for Image {
    fn drop(&mut self) {
        self.gpu.died(self.handle);
        // SAFETY: the owner of the frame waits for its fence before it lets go of what the frame uses.
        unsafe {
            for view in std::iter::once(self.view).chain(self.layer_views.drain(..)) {
                if view != vk::ImageView::null() {
                    self.gpu.died(view);
                    self.gpu.device.destroy_image_view(view, None);
                }
            }
            self.gpu.device.destroy_image(self.handle, None);
        }
    }
}

impl Gpu {
    /// What an image would ask of its memory, without making it.
    pub fn requirements(&self, desc: &ImageDesc) -> vk::MemoryRequirements {
        let info = desc.info();
        let ask = vk::DeviceImageMemoryRequirements::default().create_info(&info);
        let mut answer = vk::MemoryRequirements2::default();
        // SAFETY: a valid create info; maintenance4 is enabled.
        unsafe { self.device.get_device_image_memory_requirements(&ask, &mut answer) };
        answer.memory_requirements
    }
}

/// A sampler.
pub struct Sampler {
    pub(super) handle: vk::Sampler,
    gpu: Arc<Gpu>,
}

impl Sampler {
    /// A sampler: filter, address mode per axis, mips used or not.
    ///
    /// # Errors
    /// Where the driver refuses.
    pub fn new(
        gpu: &Arc<Gpu>,
        name: &str,
        filter: vk::Filter,
        wrap: [vk::SamplerAddressMode; 2],
        mips: bool,
    ) -> Result<Self, GpuError> {
        let mode =
            if filter == vk::Filter::LINEAR { vk::SamplerMipmapMode::LINEAR } else { vk::SamplerMipmapMode::NEAREST };
        let info = vk::SamplerCreateInfo::default()
            .mag_filter(filter)
            .min_filter(filter)
            .mipmap_mode(mode)
            .address_mode_u(wrap[0])
            .address_mode_v(wrap[1])
            .address_mode_w(vk::SamplerAddressMode::CLAMP_TO_EDGE)
            .max_lod(if mips { vk::LOD_CLAMP_NONE } else { 0. });
        // SAFETY: a valid create info; the handle is owned by what is returned.
        let handle = unsafe { gpu.device.create_sampler(&info, None) }.named("vkCreateSampler", name)?;
        gpu.born(handle, name);
        Ok(Sampler { handle, gpu: gpu.clone() })
    }
}

impl Drop for Sampler {
    fn drop(&mut self) {
        self.gpu.died(self.handle);
        // SAFETY: as for images.
        unsafe { self.gpu.device.destroy_sampler(self.handle, None) };
    }
}
