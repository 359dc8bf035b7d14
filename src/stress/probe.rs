//! Asks the device for look-ups and closed forms, one at a time: `common/scattering.glsl` by `lut_probe.comp`.

use super::StressError;
use crate::frame::uniforms::FrameBlock;
use crate::gpu::commands::{Guarded, Recorder};
use crate::gpu::image::{Image, ImageDesc, Sampler};
use crate::gpu::pass::Bound;
use crate::gpu::pipeline::Pipeline;
use crate::gpu::usage::State;
use crate::gpu::{Buffer, Gpu, Usage};
use crate::shaders::LUT_PROBE;
use crate::skin::lut::Lut;
use ash::vk;
use gpu_allocator::MemoryLocation;
use std::sync::Arc;

fn host(gpu: &Arc<Gpu>, name: &str, bytes: &[u8], usage: vk::BufferUsageFlags) -> Result<Buffer, StressError> {
    let mut b = Buffer::new(gpu, name, bytes.len() as u64, usage, MemoryLocation::CpuToGpu)?;
    b.write(bytes)?;
    Ok(b)
}

/// Of queries (mu, curvature in 1/mm, mean, spread): the table's rgb at (mu, curvature), and rectified(mean, spread).
///
/// # Errors
/// Where the device refuses.
pub fn ask(gpu: &Arc<Gpu>, lut: &Lut, queries: &[[f32; 4]]) -> Result<Vec<[f32; 4]>, StressError> {
    use vk::{BufferUsageFlags as B, ImageUsageFlags as I};
    let pipeline = Pipeline::compute(gpu, "lut probe", &LUT_PROBE, &[])?;
    let mut block: FrameBlock = bytemuck::Zeroable::zeroed();
    block.lut_knee = lut.knee_per_mm as f32;
    let frame = host(gpu, "frame", bytemuck::bytes_of(&block), B::UNIFORM_BUFFER)?;
    let asked = host(gpu, "queries", bytemuck::cast_slice(queries), B::STORAGE_BUFFER)?;
    let bytes = size_of_val(queries) as u64;
    let answers = Buffer::new(gpu, "answers", bytes, B::STORAGE_BUFFER, MemoryLocation::GpuToCpu)?;
    let (size, halves) = lut.planes();
    let staging = host(gpu, "staging", bytemuck::cast_slice(&halves), B::TRANSFER_SRC)?;
    let desc = ImageDesc::new("lut", vk::Format::R16_SFLOAT, size, I::SAMPLED | I::TRANSFER_DST);
    let image = Image::new(gpu, desc)?;
    let edge = [vk::SamplerAddressMode::CLAMP_TO_EDGE; 2];
    let sampler = Sampler::new(gpu, "linear", vk::Filter::LINEAR, edge, false)?;

    let mut recorder = Recorder::new(gpu, None)?;
    let (mut table, mut result) = (State::NEW, State::NEW);
    let before: Vec<_> = table.next(Usage::CopyTo, true).map(|b| (Guarded::Image(&image), b)).into_iter().collect();
    recorder.pass("upload", &before).upload(&staging, &image, &[(0, size)]);
    let before: Vec<_> =
        table.next(Usage::ComputeSampled, true).map(|b| (Guarded::Image(&image), b)).into_iter().collect();
    result.next(Usage::ComputeWrite, false);
    let mut pass = recorder.pass("probe", &before);
    pass.dispatch_over(&pipeline, [queries.len() as u32, 1], &[], |name| match name {
        "frame" => Some(Bound::Buffer(&frame)),
        "queries" => Some(Bound::Buffer(&asked)),
        "answers" => Some(Bound::Buffer(&answers)),
        "lut" => Some(Bound::Sampled(&image, &sampler)),
        _ => None,
    })?;
    drop(pass);
    let after: Vec<_> = result.next(Usage::Host, false).map(|b| (Guarded::Buffer(&answers), b)).into_iter().collect();
    drop(recorder.pass("to host", &after));
    recorder.finish()?.run()?;
    let texel = |b: &[u8]| bytemuck::pod_read_unaligned(b);
    Ok(answers.bytes()?[..bytes as usize].chunks_exact(16).map(texel).collect())
}
