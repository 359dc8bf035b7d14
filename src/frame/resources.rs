//! What a frame reads and never writes: vertex streams, textures, tables, constants.

use super::brightness::of_ambient;
use super::constants::lights_of;
use super::environment::{self, Bands, Filtered};
use super::inside::{self, Inside};
use super::mass;
use super::setup::Setup;
use super::upload::{Pixels, Upload, constants, single, texels};
use super::{FrameError, Inputs, table};
use crate::gpu::pass::Bound;
use crate::gpu::{Buffer, Gpu, Image, ImageDesc, Sampler};
use crate::methods::preintegrated;
use crate::plan::of_profile;
use crate::scene::{Environment, Filter, MAPS, Mips, Texture, Wrap, vertex_curvature};
use crate::settings::{ForwardCurvature, Method};
use crate::skin::specular;
use ash::vk;
use rayon::prelude::*;
use std::sync::Arc;

/// Names that shaders may bind and that no plan makes, beside those of a profile ([`inside::NAMES`]).
const EXTERNAL: &[&str] = &[
    "lights",
    "shadow_world",
    "no shadow",
    "white",
    "gloss_table",
    "sky",
    "sheen_table",
    "base_color_map",
    "metallic_roughness_map",
    "normal_map",
    "occlusion_map",
    "emission_map",
    "scatter_map",
    "thickness_map",
    "coat_map",
    "coat_roughness_map",
    "sheen_map",
    "sheen_roughness_map",
    "specular_map",
    "specular_color_map",
];

/// All names that shaders may bind and that no plan makes, with this many profiles.
pub fn external(profiles: usize) -> Vec<String> {
    let own = |k: usize| inside::NAMES.iter().map(move |n| of_profile(n, k));
    let common = EXTERNAL.iter().chain(inside::NAMES).map(|n| (*n).to_owned());
    common.chain((0..profiles).flat_map(own)).collect()
}

/// Textures of a material, in the order of [`MAPS`].
pub type Maps = [Option<usize>; MAPS.len()];

/// Scene data on the device.
pub struct Resources {
    /// Positions, normals, texture coordinates, tangents; those that are used.
    pub streams: Vec<Buffer>,
    /// Indices.
    pub indices: Buffer,
    textures: Vec<(Image, usize)>,
    white: Image,
    no_shadow: Image,
    samplers: Vec<Sampler>,
    linear: Sampler,
    nearest: Sampler,
    lights: Buffer,
    shadow_world: Buffer,
    gloss: Image,
    sheen: Option<Image>,
    sky: Option<Sky>,
    insides: Vec<Inside>,
}

/// Light from all around.
struct Sky {
    bands: Bands,
    picture: Image,
    sampler: Sampler,
}

impl Resources {
    /// Uploads a scene and the constants of a frame.
    ///
    /// # Errors
    /// Where memory or the driver gives out.
    pub fn new(gpu: &Arc<Gpu>, inputs: &Inputs<'_>, setups: &[Setup]) -> Result<Resources, FrameError> {
        // What all profiles share, each of them knows.
        let (scene, s) = (inputs.scene, &setups[0]);
        let forward = s.settings.method == Method::Preintegrated && s.diffuses;
        let mut uploads = Upload::new(gpu)?;
        let vertex = vk::BufferUsageFlags::VERTEX_BUFFER;
        let mut streams = vec![
            uploads.buffer("positions", bytemuck::cast_slice(&scene.positions), vertex)?,
            uploads.buffer("normals", bytemuck::cast_slice(&scene.normals), vertex)?,
        ];
        if s.uvs {
            let both: Vec<[[f32; 2]; 2]>;
            let uvs = if s.second_uvs {
                both = scene.uvs.iter().zip(&scene.second_uvs).map(|(a, b)| [*a, *b]).collect();
                bytemuck::cast_slice(&both)
            } else {
                bytemuck::cast_slice(&scene.uvs)
            };
            streams.push(uploads.buffer("uvs", uvs, vertex)?);
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
        let mut charts = s.atlas.as_ref().map_or(Vec::new(), |a| a.charts.clone());
        for other in setups[1..].iter().filter_map(|s| s.atlas.as_ref()) {
            charts.iter_mut().zip(&other.charts).for_each(|(all, own)| *all = own.max(*all));
        }
        if !charts.is_empty() {
            streams.push(uploads.buffer("charts", bytemuck::cast_slice(&charts), vertex)?);
        }
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
        let side = [specular::SIDE as u32; 2];
        let gloss =
            uploads.image(texels("gloss table", vk::Format::R16G16_SFLOAT, side, &table::gloss(gpu.store())))?;
        let sheen = s.coated.then(|| {
            let bytes = bytemuck::cast_slice(specular::sheen_table());
            uploads.image(texels("sheen table", vk::Format::R16_SFLOAT, side, bytes))
        });
        let sky =
            inputs.scene.environment.as_deref().filter(|_| s.sky).map(|e| sky(gpu, &mut uploads, e)).transpose()?;
        let most = most(inputs, sky.as_ref());
        let bands = sky.as_ref().map(|s| &s.bands);
        let insides: Vec<Inside> = setups
            .iter()
            .map(|s| Inside::new(gpu, &mut uploads, inputs, s, bands, most))
            .collect::<Result<_, FrameError>>()?;
        uploads.run()?;

        let storage = vk::BufferUsageFlags::STORAGE_BUFFER;
        let (lights, shadow_world) = lights_of(inputs, s);
        let clamp = [vk::SamplerAddressMode::CLAMP_TO_EDGE; 2];
        Ok(Resources {
            streams,
            indices,
            textures,
            white,
            no_shadow,
            samplers,
            linear: Sampler::new(gpu, "linear sampler", vk::Filter::LINEAR, clamp, false)?,
            nearest: Sampler::new(gpu, "nearest sampler", vk::Filter::NEAREST, clamp, false)?,
            lights: constants(gpu, "lights", bytemuck::bytes_of(&lights), vk::BufferUsageFlags::UNIFORM_BUFFER)?,
            shadow_world: constants(gpu, "shadow_world", bytemuck::cast_slice(&shadow_world), storage)?,
            gloss,
            sheen: sheen.transpose()?,
            sky,
            insides,
        })
    }

    /// Writes the constants of another eye or other lights over those of the last frame, which has been waited for.
    ///
    /// # Errors
    /// Where a buffer is not the host's to write.
    pub fn rewrite(&mut self, inputs: &Inputs<'_>, setups: &[Setup]) -> Result<(), FrameError> {
        let most = most(inputs, self.sky.as_ref());
        let bands = self.sky.as_ref().map(|s| &s.bands);
        for (inside, s) in self.insides.iter_mut().zip(setups) {
            inside.rewrite(inputs, s, bands, most)?;
        }
        let (lights, shadow_world) = lights_of(inputs, &setups[0]);
        self.lights.write(bytemuck::bytes_of(&lights))?;
        self.shadow_world.write(bytemuck::cast_slice(&shadow_world))?;
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
            "lights" => Bound::Buffer(&self.lights),
            "shadow_world" => Bound::Buffer(&self.shadow_world),
            "no shadow" => Bound::Sampled(&self.no_shadow, &self.nearest),
            "white" => Bound::Sampled(&self.white, &self.linear),
            "gloss_table" => Bound::Sampled(&self.gloss, &self.linear),
            "sheen_table" => Bound::Sampled(self.sheen.as_ref().unwrap_or(&self.white), &self.linear),
            "sky" => self.sky.as_ref().map(|s| Bound::Sampled(&s.picture, &s.sampler))?,
            _ => {
                if let Some(slot) = MAPS.iter().position(|(map, _)| *map == name) {
                    return Some(map(slot));
                }
                let (name, of) = name.split_once('@').unwrap_or((name, "0"));
                return self.insides.get(of.parse::<usize>().ok()?)?.find(name, &self.linear);
            }
        })
    }

    /// The sampler of the frame's own images: depth and placeholders are read by texel.
    pub fn nearest(&self) -> &Sampler {
        &self.nearest
    }
}

fn address(wrap: Wrap) -> vk::SamplerAddressMode {
    match wrap {
        Wrap::Repeat => vk::SamplerAddressMode::REPEAT,
        Wrap::Clamp => vk::SamplerAddressMode::CLAMP_TO_EDGE,
        Wrap::Mirror => vk::SamplerAddressMode::MIRRORED_REPEAT,
    }
}

/// The most irradiance that comes from all around.
fn most(inputs: &Inputs<'_>, sky: Option<&Sky>) -> f32 {
    match (sky, inputs.scene.environment.as_deref()) {
        (Some(sky), Some(environment)) if environment.intensity > 0. => {
            environment::most_irradiance(&sky.bands.harmonics, environment.intensity)
        }
        _ => of_ambient(&inputs.settings.ambient),
    }
}

/// The sky of a scene: its picture with the filtered levels, and its bands.
fn sky(gpu: &Arc<Gpu>, uploads: &mut Upload, from: &Environment) -> Result<Sky, FrameError> {
    let Filtered { sizes, bytes, first } = Filtered::of(from);
    let bands = Bands { harmonics: environment::harmonics(from), levels: (first, sizes.len() - 1) };
    let mut picture = texels("sky", vk::Format::R16G16B16A16_SFLOAT, sizes[0], &bytes);
    picture.desc.mips = sizes.len() as u32;
    let mut start = 0;
    picture.mips.clear();
    for size in sizes {
        picture.mips.push((start, size));
        start += 8 * u64::from(size[0]) * u64::from(size[1]);
    }
    let around = [vk::SamplerAddressMode::REPEAT, vk::SamplerAddressMode::CLAMP_TO_EDGE];
    Ok(Sky {
        bands,
        picture: uploads.image(picture)?,
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
