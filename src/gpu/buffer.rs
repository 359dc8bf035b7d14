//! Buffers: handle, memory and name in one owner.

use super::{Gpu, GpuError, Named};
use ash::vk;
use gpu_allocator::MemoryLocation;
use gpu_allocator::vulkan::{Allocation, AllocationCreateDesc, AllocationScheme};
use std::sync::Arc;

/// A buffer and its memory.
pub struct Buffer {
    pub(super) handle: vk::Buffer,
    /// Bytes.
    pub size: u64,
    /// Debug name.
    pub name: String,
    allocation: Option<Allocation>,
    gpu: Arc<Gpu>,
}

impl Buffer {
    /// A buffer of `size` bytes (at least 4). `location` decides whether the host can map it.
    ///
    /// # Errors
    /// Where the driver or the allocator refuses.
    pub fn new(
        gpu: &Arc<Gpu>,
        name: &str,
        size: u64,
        usage: vk::BufferUsageFlags,
        location: MemoryLocation,
    ) -> Result<Self, GpuError> {
        let size = size.max(4);
        let info = vk::BufferCreateInfo::default().size(size).usage(usage).sharing_mode(vk::SharingMode::EXCLUSIVE);
        // SAFETY: a valid create info; the handle is owned by what is returned.
        let handle = unsafe { gpu.device.create_buffer(&info, None) }.named("vkCreateBuffer", name)?;
        gpu.born(handle, name);
        let mut buffer = Buffer { handle, size, name: name.to_owned(), allocation: None, gpu: gpu.clone() };
        // SAFETY: the handle is alive.
        let requirements = unsafe { gpu.device.get_buffer_memory_requirements(handle) };
        let allocation = gpu.allocate(&AllocationCreateDesc {
            name,
            requirements,
            location,
            linear: true,
            allocation_scheme: AllocationScheme::GpuAllocatorManaged,
        })?;
        // SAFETY: fresh memory of the required size and type, bound once.
        unsafe { gpu.device.bind_buffer_memory(handle, allocation.memory(), allocation.offset()) }
            .named("vkBindBufferMemory", name)?;
        buffer.allocation = Some(allocation);
        Ok(buffer)
    }

    /// Copies `bytes` to the start of a host-visible buffer.
    ///
    /// # Errors
    /// Where the buffer cannot be mapped or is too small.
    pub fn write(&mut self, bytes: &[u8]) -> Result<(), GpuError> {
        let name = &self.name;
        let slice = self.allocation.as_mut().and_then(|a| a.mapped_slice_mut());
        let target = slice.and_then(|s| s.get_mut(..bytes.len()));
        let target = target
            .ok_or_else(|| GpuError::Misuse(format!("{name}: {} bytes cannot be written by the host", bytes.len())))?;
        target.copy_from_slice(bytes);
        Ok(())
    }

    /// The content of a host-visible buffer.
    ///
    /// # Errors
    /// Where the buffer cannot be mapped.
    pub fn bytes(&self) -> Result<&[u8], GpuError> {
        let slice = self.allocation.as_ref().and_then(|a| a.mapped_slice());
        let slice = slice.and_then(|s| s.get(..self.size as usize));
        slice.ok_or_else(|| GpuError::Misuse(format!("{} cannot be read by the host", self.name)))
    }
}

impl Drop for Buffer {
    fn drop(&mut self) {
        self.gpu.died(self.handle);
        // SAFETY: the owner of the frame waits for its fence before it lets go of what the frame uses.
        unsafe { self.gpu.device.destroy_buffer(self.handle, None) };
        if let Some(a) = self.allocation.take() {
            self.gpu.free(a);
        }
    }
}

impl Gpu {
    pub(super) fn allocate(&self, desc: &AllocationCreateDesc<'_>) -> Result<Allocation, GpuError> {
        let error = |reason: String| GpuError::Memory { resource: desc.name.to_owned(), reason };
        let mut guard = self.allocator.lock().map_err(|_| error("the allocator is poisoned".into()))?;
        let allocator = guard.as_mut().ok_or_else(|| error("the device is closed".into()))?;
        allocator.allocate(desc).map_err(|e| error(format!("{} bytes: {e}", desc.requirements.size)))
    }

    pub(super) fn free(&self, allocation: Allocation) {
        if let Ok(mut guard) = self.allocator.lock()
            && let Some(allocator) = guard.as_mut()
        {
            let _ = allocator.free(allocation);
        }
    }
}
