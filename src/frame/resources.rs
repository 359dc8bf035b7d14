//! What a frame reads and never writes: vertex streams, textures, tables, constants.

use super::brightness::of_ambient;
use super::constants::Constants;
use super::environment::{self, Filtered};
use super::mass;
use super::setup::Setup;
use super::{FrameError, Inputs};
use crate::gpu::commands::{Guarded, Recorder};
use crate::gpu::pass::Bound;
use crate::gpu::usage::{State, Usage};
use crate::gpu::{Buffer, Gpu, Image, ImageDesc, Sampler};
use crate::methods::preintegrated;
use crate::scene::{Environment, Filter, Mips, Texture, Wrap, vertex_curvature};
use crate::settings::{ForwardCurvature, Method};
use crate::skin::lut::Lut;
use crate::skin::sky::Harmonics;
use crate::skin::{self, penumbra, specular};
use ash::vk;
use gpu_allocator::MemoryLocation;
use rayon::prelude::*;
use std::sync::Arc;

/// Names that shaders may bind and that no plan makes.
pub const EXTERNAL: &[&str] = &[
    "frame",
    "lights",
    "shadow_world",
    "lut",
    "penumbra",
    "kernel",
    "gutter",
    "no shadow",
    "white",
    "gloss_table",
    "environment",
    "sky",
    "bands",
    "base_color_map",
    "metallic_roughness_map",
    "normal_map",
    "occlusion_map",
    "emission_map",
];

/// Textures of a material: base colour, metallic and roughness, normal, occlusion, emission.
pub type Maps = [Option<usize>; 5];

/// Scene data on the device.
pub struct Resources {
    /// Positions, normals, texture coordinates, tangents; those that are used.
    pub streams: Vec<Buffer>,
    /// Indices.
    pub indices: Buffer,
    textures: Vec<(Image, usize)>,
    white: Image,
    no_shadow: Image,
    lut: Option<Image>,
    penumbra: Option<Image>,
    samplers: Vec<Sampler>,
    linear: Sampler,
    nearest: Sampler,
    frame: Buffer,
    lights: Buffer,
    shadow_world: Buffer,
    kernel: Option<Buffer>,
    gutter: Option<Buffer>,
    lut_knee: f32,
    gloss: Image,
    sky: Option<Sky>,
}

/// Light from all around.
struct Sky {
    bands_of: Harmonics,
    levels: (usize, usize),
    block: Buffer,
    picture: Image,
    bands: Image,
    sampler: Sampler,
}

/// A texture made ready on the CPU: all mips in one run of bytes.
struct Pixels {
    desc: ImageDesc,
    bytes: Vec<u8>,
    mips: Vec<(u64, [u32; 2])>,
}

impl Resources {
    /// Uploads a scene and the constants of a frame.
    ///
    /// # Errors
    /// Where memory or the driver gives out.
    pub fn new(gpu: &Arc<Gpu>, inputs: &Inputs<'_>, s: &Setup) -> Result<Resources, FrameError> {
        let scene = inputs.scene;
        let forward = s.settings.method == Method::Preintegrated && s.diffuses;
        let lut = (forward || s.settings.method == Method::Pdss && !s.levels.levels.is_empty())
            .then(|| inputs.profile.as_ref().map(|p| Lut::build(p, s.settings.integral.into())))
            .flatten();
        let mut uploads = Upload::new(gpu)?;
        let vertex = vk::BufferUsageFlags::VERTEX_BUFFER;
        let mut streams = vec![
            uploads.buffer("positions", bytemuck::cast_slice(&scene.positions), vertex)?,
            uploads.buffer("normals", bytemuck::cast_slice(&scene.normals), vertex)?,
        ];
        if s.uvs {
            streams.push(uploads.buffer("uvs", bytemuck::cast_slice(&scene.uvs), vertex)?);
        }
        if s.normal_maps {
            streams.push(uploads.buffer("tangents", bytemuck::cast_slice(&scene.tangents), vertex)?);
        }
        if s.colors {
            streams.push(uploads.buffer("vertex colours", bytemuck::cast_slice(&scene.colors), vertex)?);
        }
        if s.mass {
            let mass = mass::kept(gpu.store(), scene, &s.levels);
            streams.push(uploads.buffer("mass", bytemuck::cast_slice(&mass), vertex)?);
        }
        if forward && preintegrated::effort(&s.settings).curvature == ForwardCurvature::Vertex {
            let bend = vertex_curvature(scene);
            streams.push(uploads.buffer("mesh curvature", bytemuck::cast_slice(&bend), vertex)?);
        }
        if let Some(atlas) = &s.atlas {
            streams.push(uploads.buffer("charts", bytemuck::cast_slice(&atlas.charts), vertex)?);
        }
        let gutter = if s.gutter.is_empty() {
            None
        } else {
            Some(uploads.buffer("gutter", bytemuck::cast_slice(&s.gutter), vk::BufferUsageFlags::STORAGE_BUFFER)?)
        };
        let indices: &[u32] = &match s.overlay.indices.as_slice() {
            [] => std::borrow::Cow::Borrowed(scene.indices.as_slice()),
            behind => std::borrow::Cow::Owned([&scene.indices, behind].concat()),
        };
        let indices = uploads.buffer("indices", bytemuck::cast_slice(indices), vk::BufferUsageFlags::INDEX_BUFFER)?;
        let mut samplers = Vec::new();
        let mut kinds: Vec<([Wrap; 2], Filter)> = Vec::new();
        let mut textures = Vec::new();
        let ready: Vec<Pixels> = scene.textures.par_iter().map(mipped).collect();
        for (texture, pixels) in scene.textures.iter().zip(ready) {
            let kind = (texture.wrap, texture.filter);
            let index = match kinds.iter().position(|k| *k == kind) {
                Some(i) => i,
                None => {
                    kinds.push(kind);
                    let filter =
                        if texture.filter == Filter::Nearest { vk::Filter::NEAREST } else { vk::Filter::LINEAR };
                    samplers.push(Sampler::new(gpu, "texture sampler", filter, texture.wrap.map(address), true)?);
                    samplers.len() - 1
                }
            };
            textures.push((uploads.image(pixels)?, index));
        }
        let white = uploads.image(single("white", vk::Format::R8G8B8A8_UNORM, &[255; 4]))?;
        let mut none = single("no shadow", vk::Format::R8G8B8A8_UNORM, &[0; 4]);
        none.desc.array = true;
        let no_shadow = uploads.image(none)?;
        let lut_pixels = lut.as_ref().map(|l| {
            let (size, halves) = l.planes();
            let bytes = halves.iter().flat_map(|h| h.to_le_bytes()).collect();
            let usage = vk::ImageUsageFlags::SAMPLED | vk::ImageUsageFlags::TRANSFER_DST;
            Pixels { desc: ImageDesc::new("lut", vk::Format::R16_SFLOAT, size, usage), bytes, mips: vec![(0, size)] }
        });
        let penumbra = match (&inputs.profile, s.kernel.first()) {
            (Some(profile), Some(row)) if forward => {
                let bytes = penumbra::table(profile, row[3]).iter().flat_map(|h| h.to_le_bytes()).collect();
                let usage = vk::ImageUsageFlags::SAMPLED | vk::ImageUsageFlags::TRANSFER_DST;
                let desc = ImageDesc::new("penumbra", vk::Format::R16G16B16A16_SFLOAT, penumbra::SIZE, usage);
                Some(uploads.image(Pixels { desc, bytes, mips: vec![(0, penumbra::SIZE)] })?)
            }
            _ => None,
        };
        let lut_image = lut_pixels.map(|p| uploads.image(p)).transpose()?;
        let side = [specular::SIDE as u32; 2];
        let gloss = uploads.image(texels(
            "gloss table",
            vk::Format::R16G16_SFLOAT,
            side,
            bytemuck::cast_slice(specular::table()),
        ))?;
        let sky = inputs
            .scene
            .environment
            .as_deref()
            .filter(|_| s.sky)
            .map(|e| sky(gpu, &mut uploads, e, inputs))
            .transpose()?;
        uploads.run()?;

        let storage = vk::BufferUsageFlags::STORAGE_BUFFER;
        let lut_knee = lut.as_ref().map_or(1., |l| l.knee_per_mm as f32);
        let Constants { frame, lights, shadow_world, kernel } =
            Constants::of(inputs, s, lut_knee, most(inputs, sky.as_ref()));
        let kernel = (!kernel.is_empty()).then(|| constants(gpu, "kernel", bytemuck::cast_slice(&kernel), storage));
        let clamp = [vk::SamplerAddressMode::CLAMP_TO_EDGE; 2];
        Ok(Resources {
            streams,
            indices,
            textures,
            white,
            no_shadow,
            lut: lut_image,
            penumbra,
            samplers,
            linear: Sampler::new(gpu, "linear sampler", vk::Filter::LINEAR, clamp, false)?,
            nearest: Sampler::new(gpu, "nearest sampler", vk::Filter::NEAREST, clamp, false)?,
            frame: constants(gpu, "frame", bytemuck::bytes_of(&frame), vk::BufferUsageFlags::UNIFORM_BUFFER)?,
            lights: constants(gpu, "lights", bytemuck::bytes_of(&lights), vk::BufferUsageFlags::UNIFORM_BUFFER)?,
            shadow_world: constants(gpu, "shadow_world", bytemuck::cast_slice(&shadow_world), storage)?,
            kernel: kernel.transpose()?,
            gutter,
            lut_knee,
            gloss,
            sky,
        })
    }

    /// Writes the constants of another eye or other lights over those of the last frame, which has been waited for.
    ///
    /// # Errors
    /// Where a buffer is not the host's to write.
    pub fn rewrite(&mut self, inputs: &Inputs<'_>, s: &Setup) -> Result<(), FrameError> {
        let Constants { frame, lights, shadow_world, kernel } =
            Constants::of(inputs, s, self.lut_knee, most(inputs, self.sky.as_ref()));
        self.frame.write(bytemuck::bytes_of(&frame))?;
        self.lights.write(bytemuck::bytes_of(&lights))?;
        self.shadow_world.write(bytemuck::cast_slice(&shadow_world))?;
        if let Some(buffer) = &mut self.kernel {
            buffer.write(bytemuck::cast_slice(&kernel))?;
        }
        if let (Some(sky), Some(environment)) = (&mut self.sky, inputs.scene.environment.as_deref()) {
            let block = environment::block(environment, &sky.bands_of, sky.levels, inputs);
            sky.block.write(bytemuck::bytes_of(&block))?;
        }
        Ok(())
    }

    /// The resource behind a name; `material` decides the texture maps.
    pub fn find(&self, name: &str, maps: &Maps) -> Option<Bound<'_>> {
        let map = |slot: usize| {
            let texture = maps[slot].and_then(|i| self.textures.get(i));
            match texture {
                Some((image, sampler)) => Bound::Sampled(image, self.samplers.get(*sampler).unwrap_or(&self.linear)),
                None => Bound::Sampled(&self.white, &self.linear),
            }
        };
        Some(match name {
            "frame" => Bound::Buffer(&self.frame),
            "lights" => Bound::Buffer(&self.lights),
            "shadow_world" => Bound::Buffer(&self.shadow_world),
            "no shadow" => Bound::Sampled(&self.no_shadow, &self.nearest),
            "white" => Bound::Sampled(&self.white, &self.linear),
            "gloss_table" => Bound::Sampled(&self.gloss, &self.linear),
            "environment" => Bound::Buffer(&self.sky.as_ref()?.block),
            "sky" => self.sky.as_ref().map(|s| Bound::Sampled(&s.picture, &s.sampler))?,
            "bands" => Bound::Sampled(&self.sky.as_ref()?.bands, &self.linear),
            "gutter" => Bound::Buffer(self.gutter.as_ref()?),
            "kernel" => Bound::Buffer(self.kernel.as_ref()?),
            "penumbra" => Bound::Sampled(self.penumbra.as_ref()?, &self.linear),
            "lut" => Bound::Sampled(self.lut.as_ref()?, &self.linear),
            "base_color_map" => map(0),
            "metallic_roughness_map" => map(1),
            "normal_map" => map(2),
            "occlusion_map" => map(3),
            "emission_map" => map(4),
            _ => return None,
        })
    }

    /// The sampler of the frame's own images: depth and placeholders are read by texel.
    pub fn nearest(&self) -> &Sampler {
        &self.nearest
    }
}

fn constants(gpu: &Arc<Gpu>, name: &str, bytes: &[u8], usage: vk::BufferUsageFlags) -> Result<Buffer, FrameError> {
    let mut buffer = Buffer::new(gpu, name, bytes.len() as u64, usage, MemoryLocation::CpuToGpu)?;
    buffer.write(bytes)?;
    Ok(buffer)
}

fn address(wrap: Wrap) -> vk::SamplerAddressMode {
    match wrap {
        Wrap::Repeat => vk::SamplerAddressMode::REPEAT,
        Wrap::Clamp => vk::SamplerAddressMode::CLAMP_TO_EDGE,
        Wrap::Mirror => vk::SamplerAddressMode::MIRRORED_REPEAT,
    }
}

fn single(name: &str, format: vk::Format, bytes: &[u8]) -> Pixels {
    texels(name, format, [1, 1], bytes)
}

fn texels(name: &str, format: vk::Format, size: [u32; 2], bytes: &[u8]) -> Pixels {
    let usage = vk::ImageUsageFlags::SAMPLED | vk::ImageUsageFlags::TRANSFER_DST;
    Pixels { desc: ImageDesc::new(name, format, size, usage), bytes: bytes.to_vec(), mips: vec![(0, size)] }
}

/// The most irradiance that comes from all around.
fn most(inputs: &Inputs<'_>, sky: Option<&Sky>) -> f32 {
    match (sky, inputs.scene.environment.as_deref()) {
        (Some(sky), Some(environment)) => environment::most_irradiance(&sky.bands_of, environment.intensity),
        _ => of_ambient(&inputs.settings.ambient),
    }
}

/// The sky of a scene: its picture with the filtered levels, the table of what scattering leaves of its bands, its constants.
fn sky(gpu: &Arc<Gpu>, uploads: &mut Upload, from: &Environment, inputs: &Inputs<'_>) -> Result<Sky, FrameError> {
    let Filtered { sizes, bytes, first } = Filtered::of(from);
    let gaussians = inputs.profile.as_ref().map_or(Vec::new(), |p| p.gaussians().gaussians);
    let (bands_of, levels) = (environment::harmonics(from), (first, sizes.len() - 1));
    let block = environment::block(from, &bands_of, levels, inputs);
    let mut picture = texels("sky", vk::Format::R16G16B16A16_SFLOAT, sizes[0], &bytes);
    picture.desc.mips = sizes.len() as u32;
    let mut start = 0;
    picture.mips.clear();
    for size in sizes {
        picture.mips.push((start, size));
        start += 8 * u64::from(size[0]) * u64::from(size[1]);
    }
    let rows = skin::sky::table(&gaussians, skin::sky::knee(&gaussians));
    let halves: Vec<half::f16> = rows.iter().flatten().map(|x| half::f16::from_f32(*x)).collect();
    let size = [skin::sky::TABLE as u32, 2];
    let bands = texels("bands", vk::Format::R16G16B16A16_SFLOAT, size, bytemuck::cast_slice(&halves));
    let around = [vk::SamplerAddressMode::REPEAT, vk::SamplerAddressMode::CLAMP_TO_EDGE];
    Ok(Sky {
        bands_of,
        levels,
        block: constants(gpu, "environment", bytemuck::bytes_of(&block), vk::BufferUsageFlags::UNIFORM_BUFFER)?,
        picture: uploads.image(picture)?,
        bands: uploads.image(bands)?,
        sampler: Sampler::new(gpu, "sky sampler", vk::Filter::LINEAR, around, true)?,
    })
}

/// A texture with its mips.
fn mipped(texture: &Texture) -> Pixels {
    let format = if texture.srgb { vk::Format::R8G8B8A8_SRGB } else { vk::Format::R8G8B8A8_UNORM };
    let Mips { bytes, levels } = Mips::of(texture);
    let usage = vk::ImageUsageFlags::SAMPLED | vk::ImageUsageFlags::TRANSFER_DST;
    let mut desc = ImageDesc::new(&texture.name, format, [texture.width, texture.height], usage);
    desc.mips = levels.len() as u32;
    Pixels { desc, bytes, mips: levels }
}

/// Copies in flight: recorded together, submitted once.
struct Upload {
    gpu: Arc<Gpu>,
    recorder: Recorder,
    staging: Vec<Buffer>,
}

impl Upload {
    fn new(gpu: &Arc<Gpu>) -> Result<Self, FrameError> {
        Ok(Upload { gpu: gpu.clone(), recorder: Recorder::new(gpu, None)?, staging: Vec::new() })
    }

    fn stage(&mut self, name: &str, bytes: &[u8]) -> Result<(), FrameError> {
        self.staging.push(constants(&self.gpu, &format!("{name} staging"), bytes, vk::BufferUsageFlags::TRANSFER_SRC)?);
        Ok(())
    }

    fn buffer(&mut self, name: &str, bytes: &[u8], usage: vk::BufferUsageFlags) -> Result<Buffer, FrameError> {
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

    fn image(&mut self, pixels: Pixels) -> Result<Image, FrameError> {
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
    fn run(self) -> Result<(), FrameError> {
        self.recorder.finish()?.run()?;
        Ok(())
    }
}
