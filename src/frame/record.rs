//! Plan in, pipelines and a recorded command buffer out. This is the one place that walks a plan.

use super::FrameError;
use super::resources::{Maps, Resources};
use super::setup::alpha_cutoff;
use super::uniforms::MaterialPush;
use crate::gpu::commands::{Guarded, Recorder};
use crate::gpu::pass::{Attachments, Bound};
use crate::gpu::pipeline::{Pipeline, Raster};
use crate::gpu::submit::Recorded;
use crate::gpu::timing::{Timer, TimingMode};
use crate::gpu::usage::{Barrier, State, Usage};
use crate::gpu::{Buffer, Gpu, GpuError, Image};
use crate::plan::{Domain, Geometry, Pass, Plan, Work, of_profile};
use crate::scene::{Alpha, Draw, MAPS, Material};
use crate::shaders;
use crate::skin::profile::Profile;
use ash::vk;
use gpu_allocator::MemoryLocation;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::sync::Arc;

/// What a material's pipeline is specialised for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Class {
    maps: [bool; MAPS.len()],
    /// Bits of those that read the second coordinates.
    second: u32,
    masked: bool,
    double_sided: bool,
    /// Asked by the overlay alone, like the last map: other passes draw all such materials alike.
    unlit: bool,
    blended: bool,
    /// Profile, asked by passes in which it matters.
    profile: Option<usize>,
}

/// Pipeline of each pass, or of each class of material in it.
pub type Classes = Vec<BTreeMap<Option<ClassKey>, usize>>;
/// Opaque key of a class of materials.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct ClassKey(Class);

/// Everything that recording looks at.
pub struct World<'a> {
    /// The frame.
    pub plan: &'a Plan,
    /// Its images.
    pub images: &'a BTreeMap<String, Image>,
    /// Its buffers.
    pub buffers: &'a BTreeMap<String, Buffer>,
    /// Pipelines.
    pub pipelines: &'a [Pipeline],
    /// Which pipeline a pass uses.
    pub classes: &'a Classes,
    /// The scene on the device.
    pub resources: &'a Resources,
    /// What is drawn.
    pub draws: &'a [(Draw, &'a Material)],
    /// What is drawn over the picture.
    pub overlay: &'a [(Draw, &'a Material)],
    /// Indices of the whole scene.
    pub index_count: u32,
    /// Scattering materials are marked.
    pub scatters: bool,
    /// How they scatter, and how light is refracted into those that do not say.
    pub profiles: &'a [Profile],
    /// Gloss is more than plain lobes.
    pub coated: bool,
    /// The thickest that a material says it is, mm; 0 where nobody reads it.
    pub thickest_mm: f32,
}

fn class(material: &Material, geometry: Geometry, plan: &Plan, pass: &Pass) -> ClassKey {
    let over = geometry == Geometry::Overlay;
    let mut maps = material.maps().map(|m| m.is_some());
    maps[EMISSION] &= over;
    // White where there is none.
    WHITE.iter().for_each(|slot| maps[*slot] |= plan.textured && geometry == Geometry::Materials);
    let tested = plan.cut_out && geometry == Geometry::Materials;
    ClassKey(Class {
        maps,
        second: material.second_uvs,
        masked: tested || alpha_cutoff(material.alpha).is_some(),
        double_sided: material.double_sided,
        unlit: over && material.unlit,
        blended: over && material.alpha == Alpha::Blend,
        profile: profile(material, pass),
    })
}

/// The profile whose constants and tables a draw takes in a pass that draws materials of several.
fn profile(material: &Material, pass: &Pass) -> Option<usize> {
    let known = |k: &usize| pass.each.iter().any(|(of, _)| of == k);
    pass.each.first().map(|(first, _)| material.scatter.filter(known).unwrap_or(*first))
}

/// What a pass draws of the scene: blended materials are drawn over the picture alone.
fn drawn<'a>(
    geometry: Geometry,
    of: Option<usize>,
    draws: &'a [(Draw, &'a Material)],
    overlay: &'a [(Draw, &'a Material)],
) -> impl Iterator<Item = &'a (Draw, &'a Material)> {
    let list = if geometry == Geometry::Overlay { overlay } else { draws };
    list.iter().filter(move |(d, m)| {
        let here = match geometry {
            Geometry::Overlay => true,
            Geometry::Unwrapped => m.scatter.is_some_and(|k| of.is_none_or(|of| of == k)) && m.alpha != Alpha::Blend,
            Geometry::Inert => m.scatter.is_none() && m.alpha != Alpha::Blend,
            Geometry::Depth | Geometry::Casters | Geometry::Materials => m.alpha != Alpha::Blend,
        };
        d.index_count > 0 && here
    })
}

/// Place of emission in [`MAPS`].
const EMISSION: usize = 4;
/// Places there of what white leaves alone: colour, roughness, occlusion.
const WHITE: [usize; 3] = [0, 1, 3];
/// No texture.
const NONE: Maps = [None; MAPS.len()];

/// A pipeline to make: its pass, its constants, the faces that are not drawn.
type Job<'a> = (&'a Pass, Vec<(&'static str, u32)>, vk::CullModeFlags);

/// Makes the pipelines of a plan.
///
/// # Errors
/// Where the driver refuses.
pub fn pipelines(
    gpu: &Arc<Gpu>,
    plan: &Plan,
    draws: &[(Draw, &Material)],
    overlay: &[(Draw, &Material)],
) -> Result<(Vec<Pipeline>, Classes), FrameError> {
    let mut jobs: Vec<Job<'_>> = Vec::new();
    let mut classes = Vec::new();
    for pass in &plan.passes {
        let mut map = BTreeMap::new();
        match &pass.work {
            Work::Compute { .. }
            | Work::Fragments { .. }
            | Work::Raster { geometry: Geometry::Depth | Geometry::Inert, .. } => {
                map.insert(None, jobs.len());
                jobs.push((pass, pass.constants.clone(), vk::CullModeFlags::NONE));
            }
            Work::Raster { geometry, .. } => {
                for (_, material) in drawn(*geometry, pass.profile, draws, overlay) {
                    let key = class(material, *geometry, plan, pass);
                    if map.contains_key(&Some(key)) {
                        continue;
                    }
                    let Class { maps, second, masked, double_sided, unlit, blended, profile } = key.0;
                    let mut constants = pass.constants.clone();
                    if let Some((_, own)) = pass.each.iter().find(|(of, _)| Some(*of) == profile) {
                        constants.retain(|(name, _)| own.iter().all(|(n, _)| n != name));
                        constants.extend(own);
                    }
                    constants.extend(MAPS.iter().zip(maps).map(|((_, n), m)| (*n, u32::from(m))));
                    constants.push(("SECOND", second));
                    let kinds = [("ALPHA_MASK", masked), ("UNLIT", unlit), ("BLEND", blended)];
                    constants.extend(kinds.map(|(name, is)| (name, u32::from(is))));
                    let both = double_sided || matches!(geometry, Geometry::Unwrapped | Geometry::Casters);
                    let cull = if both { vk::CullModeFlags::NONE } else { vk::CullModeFlags::BACK };
                    map.insert(Some(key), jobs.len());
                    jobs.push((pass, constants, cull));
                }
            }
            Work::Update { .. } | Work::Clear { .. } => {}
        }
        classes.push(map);
    }
    // Drivers compile here: as many at once as there are cores.
    let make = |(pass, constants, cull): &Job<'_>| match &pass.work {
        Work::Raster { vertex, fragment, state, .. } => {
            let state = Raster { cull: *cull, ..state.clone() };
            Pipeline::graphics(gpu, &pass.name, vertex, *fragment, constants, &state).map(Some)
        }
        Work::Compute { shader, .. } => Pipeline::compute(gpu, &pass.name, shader, constants).map(Some),
        Work::Fragments { shader, colors, .. } => {
            let formats = colors.iter().filter_map(|name| plan.targets.get(name)).map(|t| t.desc.format);
            let state = Raster { colors: formats.collect(), points: true, ..Raster::default() };
            Pipeline::graphics(gpu, &pass.name, &shaders::TILES_VERT, Some(shader), constants, &state).map(Some)
        }
        Work::Update { .. } | Work::Clear { .. } => Ok(None),
    };
    let made: Vec<Option<Pipeline>> = jobs.par_iter().map(make).collect::<Result<_, _>>()?;
    Ok((made.into_iter().flatten().collect(), classes))
}

/// Records the frame from pass `first` on. What the passes before it have drawn is where the last frame has left it: seen by
/// whoever reads it, in the layout that they read it in.
///
/// # Errors
/// Where a resource is missing, or the driver refuses.
pub fn record(
    gpu: &Arc<Gpu>,
    first: usize,
    timing: Option<TimingMode>,
    world: &World<'_>,
) -> Result<Recorded, FrameError> {
    let passes = &world.plan.passes;
    let timer = timing.map(|mode| Timer::new(gpu, passes.len() - first, mode)).transpose()?;
    let kept = |name: &String| passes[..first].iter().any(|p| p.accesses.iter().any(|(n, _)| n == name));
    let mut recorder = Recorder::new(gpu, timer)?;
    for (index, pass) in passes.iter().enumerate().skip(first) {
        let waits = pass.barriers.iter().filter(|(name, _)| !kept(name));
        let barriers: Vec<(Guarded<'_>, Barrier)> =
            waits.filter_map(|(name, b)| Some((world.guarded(name)?, *b))).collect();
        let mut open = recorder.pass(&pass.name, &barriers);
        match &pass.work {
            Work::Compute { domain, .. } => {
                let pipeline = world.pipeline(index, None)?;
                let find = |name: &str| world.find_of(pass, name, &NONE, None);
                match domain {
                    Domain::Threads(threads) => open.dispatch_over(pipeline, *threads, &pass.push, find)?,
                    Domain::Tiles(list, _) => {
                        open.indirect(pipeline, (world.list(pass, list)?, 0), &pass.push, find)?;
                    }
                }
            }
            Work::Fragments { list, colors, keep, .. } => {
                let pipeline = world.pipeline(index, None)?;
                let find = |name: &str| world.find_of(pass, name, &NONE, None);
                let target = |name: &String| {
                    let image = world.images.get(name);
                    image.map(|i| (i, None)).ok_or_else(|| GpuError::Misuse(format!("{}: no target {name}", pass.name)))
                };
                let colors = colors.iter().map(target).collect::<Result<Vec<_>, GpuError>>()?;
                open.render(&Attachments { colors: &colors, depth: None, keep: *keep });
                open.indirect(pipeline, (world.list(pass, list)?, 0), &pass.push, find)?;
                open.end_render();
            }
            Work::Raster { state, colors, depth, geometry, .. } => {
                let target = |name: &str| {
                    world.images.get(name).ok_or_else(|| GpuError::Misuse(format!("{}: no target {name}", pass.name)))
                };
                let colors =
                    colors.iter().map(|(n, clear)| Ok((target(n)?, *clear))).collect::<Result<Vec<_>, GpuError>>()?;
                let depth = depth.as_ref().map(|d| Ok::<_, GpuError>((target(&d.0)?, d.1, d.2))).transpose()?;
                open.render(&Attachments { colors: &colors, depth, keep: state.over });
                let streams: Vec<&Buffer> = world.resources.streams.iter().collect();
                let indices = &world.resources.indices;
                match geometry {
                    Geometry::Depth | Geometry::Inert if world.index_count > 0 => {
                        let pipeline = world.pipeline(index, None)?;
                        let find = |name: &str| world.find_of(pass, name, &NONE, None);
                        open.prepare(pipeline, &streams[..1], indices, &pass.push, find)?;
                        let all = *geometry == Geometry::Depth;
                        if all && world.draws.iter().all(|(_, m)| m.alpha != Alpha::Blend) {
                            open.draw(0, world.index_count);
                        } else {
                            drawn(*geometry, None, world.draws, &[])
                                .for_each(|(d, _)| open.draw(d.first_index, d.index_count));
                        }
                    }
                    Geometry::Depth | Geometry::Inert => {}
                    Geometry::Materials | Geometry::Casters | Geometry::Unwrapped | Geometry::Overlay => {
                        for (draw, material) in drawn(*geometry, pass.profile, world.draws, world.overlay) {
                            let pipeline = world.pipeline(index, Some(class(material, *geometry, world.plan, pass)))?;
                            let push = material_push(material, world);
                            let of = profile(material, pass);
                            let find = |name: &str| world.find_of(pass, name, &material.maps(), of);
                            open.prepare(pipeline, &streams, indices, bytemuck::bytes_of(&push), find)?;
                            open.draw(draw.first_index, draw.index_count);
                        }
                    }
                }
                open.end_render();
            }
            Work::Update { buffers, bytes } => {
                for name in buffers {
                    if let Some(buffer) = world.buffers.get(name) {
                        open.update(buffer, bytes);
                    }
                }
            }
            Work::Clear { image, value } => {
                if let Some(image) = world.images.get(image) {
                    open.clear(image, *value);
                }
            }
        }
    }
    Ok(recorder.finish()?)
}

impl<'a> World<'a> {
    fn guarded(&self, name: &str) -> Option<Guarded<'a>> {
        let image = self.images.get(name).map(Guarded::Image);
        image.or_else(|| self.buffers.get(name).map(Guarded::Buffer))
    }

    fn list(&self, pass: &Pass, list: &str) -> Result<&'a Buffer, GpuError> {
        self.buffers.get(list).ok_or_else(|| GpuError::Misuse(format!("{}: no list {list}", pass.name)))
    }

    fn pipeline(&self, pass: usize, key: Option<ClassKey>) -> Result<&'a Pipeline, GpuError> {
        let index = self.classes.get(pass).and_then(|m| m.get(&key)).copied();
        index
            .and_then(|i| self.pipelines.get(i))
            .ok_or_else(|| GpuError::Misuse(format!("pass {pass} has no pipeline")))
    }

    /// What stands behind a name; of those that each profile has, the one of this profile.
    fn find_of(&self, pass: &Pass, name: &str, maps: &Maps, of: Option<usize>) -> Option<Bound<'a>> {
        let name = pass.aliases.get(name).map_or(name, String::as_str);
        if let Some(image) = self.images.get(name) {
            let sampled = pass
                .accesses
                .iter()
                .any(|(n, u)| n == name && matches!(u, Usage::ComputeSampled | Usage::FragmentSampled));
            return Some(if sampled { Bound::Sampled(image, self.resources.nearest()) } else { Bound::Image(image) });
        }
        let own = of.map(|k| of_profile(name, k));
        let own = own.as_deref().and_then(|own| self.resources.find(own, maps));
        own.or_else(|| self.buffers.get(name).map(Bound::Buffer)).or_else(|| self.resources.find(name, maps))
    }
}

fn material_push(m: &Material, world: &World<'_>) -> MaterialPush {
    let profile = m.scatter.and_then(|k| world.profiles.get(k));
    // glTF's own default counts as nothing stated.
    let stated = m.ior != Material::DEFAULT_IOR;
    let ior = profile.filter(|_| !stated).map_or(m.ior, |p| p.ior as f32);
    // Where the shaders know the factor, they apply it themselves.
    let factor = if world.coated { 1. } else { m.specular.factor };
    let reflectance = |ior: f32| ((ior - 1.) / (ior + 1.)).powi(2) * factor;
    MaterialPush {
        base_color: m.base_color,
        roughness: m.roughness,
        metallic: m.metallic,
        normal_scale: m.normal_texture.map_or(1., |t| t.1),
        occlusion_strength: m.occlusion_texture.map_or(1., |t| t.1),
        alpha_cutoff: alpha_cutoff(m.alpha).unwrap_or(0.),
        reflectance: reflectance(ior),
        bare: reflectance(m.ior),
        scatter: match m.scatter {
            Some(_) if world.scatters && profile.is_some() => m.scatter_mask,
            // Where nothing scatters there are no passes of each profile, and gloss is the first one's.
            Some(0) if profile.is_some() => -1.,
            _ => 0.,
        },
        emission: m.emission,
        thickness: if world.thickest_mm > 0. { m.thickness_mm / world.thickest_mm } else { 0. },
        sheen: m.sheen.color,
        sheen_roughness: m.sheen.roughness,
        specular_tint: m.specular.color,
        specular: m.specular.factor,
        coat: m.coat.factor,
        coat_roughness: m.coat.roughness,
        profile: m.scatter.unwrap_or(0) as u32,
    }
}

/// Commands that copy a kept picture to a host buffer, and leave the image as the frame expects it: with any content.
///
/// # Errors
/// Where the driver refuses.
pub fn read_back(gpu: &Arc<Gpu>, plan: &Plan, name: &str, image: &Image) -> Result<(Recorded, Buffer), FrameError> {
    let size = image.desc.size.map(u64::from);
    let bytes = size[0] * size[1] * crate::plan::texel_bytes(image.desc.format);
    let usage = vk::BufferUsageFlags::TRANSFER_DST;
    let buffer = Buffer::new(gpu, "read-back", bytes, usage, MemoryLocation::GpuToCpu)?;
    // How the frame leaves it: its last use.
    let mut state = State::NEW;
    for (_, usage) in plan.passes.iter().flat_map(|p| &p.accesses).filter(|(n, _)| n == name) {
        state.next(*usage, true);
    }
    let left = state;
    let mut recorder = Recorder::new(gpu, None)?;
    let before: Vec<_> = state.next(Usage::CopyFrom, true).map(|b| (Guarded::Image(image), b)).into_iter().collect();
    recorder.pass("read back", &before).read_back(image, &buffer);
    let mut host = State::NEW;
    host.next(Usage::CopyTo, false);
    let mut after: Vec<_> = host.next(Usage::Host, false).map(|b| (Guarded::Buffer(&buffer), b)).into_iter().collect();
    // Back to the layout it was found in, so that it can be read again without a frame between.
    let barrier = Barrier {
        src_stage: vk::PipelineStageFlags2::ALL_TRANSFER,
        src_access: vk::AccessFlags2::NONE,
        dst_stage: vk::PipelineStageFlags2::ALL_COMMANDS,
        dst_access: vk::AccessFlags2::MEMORY_READ | vk::AccessFlags2::MEMORY_WRITE,
        old_layout: state.layout(),
        new_layout: left.layout(),
    };
    after.push((Guarded::Image(image), barrier));
    drop(recorder.pass("to host", &after));
    Ok((recorder.finish()?, buffer))
}

/// Copies the first bytes of a device buffer to the host, once.
///
/// # Errors
/// Where the driver refuses.
pub fn read_buffer(gpu: &Arc<Gpu>, from: &Buffer, to: &Buffer) -> Result<(), FrameError> {
    let mut recorder = Recorder::new(gpu, None)?;
    let mut state = State::NEW;
    state.next(Usage::ComputeReadWrite, false);
    let before: Vec<_> = state.next(Usage::CopyFrom, false).map(|b| (Guarded::Buffer(from), b)).into_iter().collect();
    recorder.pass("read buffer", &before).copy(from, to, to.size);
    let mut host = State::NEW;
    host.next(Usage::CopyTo, false);
    let after: Vec<_> = host.next(Usage::Host, false).map(|b| (Guarded::Buffer(to), b)).into_iter().collect();
    drop(recorder.pass("to host", &after));
    recorder.finish()?.run()?;
    Ok(())
}
