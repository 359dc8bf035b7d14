//! Texels and buffers on their way to the device.

use super::FrameError;
use crate::gpu::commands::{Guarded, Recorder};
use crate::gpu::usage::{State, Usage};
use crate::gpu::{Buffer, Gpu, Image, ImageDesc};
use ash::vk;
use gpu_allocator::MemoryLocation;
use std::sync::Arc;

/// A texture made ready on the CPU: all mips in one run of bytes.
pub(super) struct Pixels {
    pub desc: ImageDesc,
    pub bytes: Vec<u8>,
    /// Where each level begins, and its size.
    pub mips: Vec<(u64, [u32; 2])>,
}

/// A buffer that the host writes, for the frame to read.
pub(super) fn constants(
    gpu: &Arc<Gpu>,
    name: &str,
    bytes: &[u8],
    usage: vk::BufferUsageFlags,
) -> Result<Buffer, FrameError> {
    let mut buffer = Buffer::new(gpu, name, bytes.len() as u64, usage, MemoryLocation::CpuToGpu)?;
    buffer.write(bytes)?;
    Ok(buffer)
}

/// An image of one texel.
pub(super) fn single(name: &str, format: vk::Format, bytes: &[u8]) -> Pixels {
    texels(name, format, [1, 1], bytes)
}

/// An image without mips.
pub(super) fn texels(name: &str, format: vk::Format, size: [u32; 2], bytes: &[u8]) -> Pixels {
    let usage = vk::ImageUsageFlags::SAMPLED | vk::ImageUsageFlags::TRANSFER_DST;
    Pixels { desc: ImageDesc::new(name, format, size, usage), bytes: bytes.to_vec(), mips: vec![(0, size)] }
}

/// Copies in flight: recorded together, submitted once.
pub(super) struct Upload {
    gpu: Arc<Gpu>,
    recorder: Recorder,
    staging: Vec<Buffer>,
}

impl Upload {
    pub fn new(gpu: &Arc<Gpu>) -> Result<Self, FrameError> {
        Ok(Upload { gpu: gpu.clone(), recorder: Recorder::new(gpu, None)?, staging: Vec::new() })
    }

    fn stage(&mut self, name: &str, bytes: &[u8]) -> Result<(), FrameError> {
        self.staging.push(constants(&self.gpu, &format!("{name} staging"), bytes, vk::BufferUsageFlags::TRANSFER_SRC)?);
        Ok(())
    }

    pub fn buffer(&mut self, name: &str, bytes: &[u8], usage: vk::BufferUsageFlags) -> Result<Buffer, FrameError> {
        let usage = usage | vk::BufferUsageFlags::TRANSFER_DST;
        let buffer = Buffer::new(&self.gpu, name, bytes.len() as u64, usage, MemoryLocation::GpuOnly)?;
        if !bytes.is_empty() {
            self.stage(name, bytes)?;
            if let Some(staging) = self.staging.last() {
                self.recorder.pass(name, &[]).copy(staging, &buffer, bytes.len() as u64);
            }
        }
        Ok(buffer)
    }

    pub fn image(&mut self, pixels: Pixels) -> Result<Image, FrameError> {
        let image = Image::new(&self.gpu, pixels.desc)?;
        self.stage(&image.desc.name.clone(), &pixels.bytes)?;
        let mut state = State::NEW;
        let before: Vec<_> = state.next(Usage::CopyTo, true).map(|b| (Guarded::Image(&image), b)).into_iter().collect();
        if let Some(staging) = self.staging.last() {
            self.recorder.pass(&image.desc.name, &before).upload(staging, &image, &pixels.mips);
        }
        let after: Vec<_> =
            state.next(Usage::FragmentSampled, true).map(|b| (Guarded::Image(&image), b)).into_iter().collect();
        drop(self.recorder.pass("ready", &after));
        Ok(image)
    }

    /// Submits and waits: the staging buffers may go, and later submits see everything.
    pub fn run(self) -> Result<(), FrameError> {
        self.recorder.finish()?.run()?;
        Ok(())
    }
}
