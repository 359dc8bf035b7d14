//! A frame: planned, created and recorded once, submitted as often as one likes.

pub mod brightness;
pub mod constants;
mod environment;
mod inside;
pub mod levels;
mod mass;
pub mod meter;
mod overlay;
pub mod resources;
pub mod setup;
pub mod shadows;
mod specialise;
mod table;
pub mod uniforms;
mod upload;
pub mod view;

mod record;

pub use setup::{Output, Setup};

use crate::gpu::pipeline::Pipeline;
use crate::gpu::submit::Recorded;
use crate::gpu::timing::TimingMode;
use crate::gpu::{Block, Buffer, Gpu, GpuError, Image, Suit};
use crate::methods;
use crate::plan::{Need, Plan, PlanError};
use crate::scene::{Camera, Draw, Light, Material, Scene};
use crate::settings::{Integral, Settings, View};
use crate::skin::profile::Profile;
use ash::vk;
use gpu_allocator::MemoryLocation;
use resources::Resources;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Instant;

/// Why there is no frame.
#[derive(Debug, thiserror::Error)]
pub enum FrameError {
    /// The device.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// A stage and its shader disagree.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// A view of something that this frame does not make.
    #[error("--view {} needs {what}", clap::ValueEnum::to_possible_value(view).map_or_else(String::new, |v| v.get_name().to_owned()))]
    View {
        /// The view.
        view: View,
        /// What it would take.
        what: &'static str,
    },
    /// A scene whose texture coordinates a method cannot work over.
    #[error("--method texture-space: {scene}: {why}")]
    Atlas {
        /// The scene.
        scene: String,
        /// What is wrong and what would be right.
        why: String,
    },
    /// More profiles than a pixel tells apart.
    #[error("{count} profiles in one frame; the limit is {max}", max = uniforms::MAX_PROFILES)]
    Profiles {
        /// How many there are.
        count: usize,
    },
    /// More lights than the uniform block holds.
    #[error("{count} lights; the limit is {max}", max = uniforms::MAX_LIGHTS)]
    Lights {
        /// How many there are.
        count: usize,
    },
}

/// What a frame is made from.
pub struct Inputs<'a> {
    /// Meshes, materials, textures.
    pub scene: &'a Scene,
    /// The eye.
    pub camera: Camera,
    /// The lights, in order of importance: the first two have their shadows scattered, by `moments` all directional ones of their colours, too.
    pub lights: Vec<Light>,
    /// How the scattering materials scatter, by their own index ([`Material::scatter`]); none: nothing does.
    pub profiles: Vec<Profile>,
    /// Everything else.
    pub settings: Settings,
    /// Timestamps, if wanted.
    pub timing: Option<TimingMode>,
    /// What becomes of the picture.
    pub output: Output,
}

/// Milliseconds of CPU work, and microseconds of the last submit.
#[derive(Clone, Copy, Debug, Default, serde::Serialize)]
pub struct CpuTimes {
    /// Deciding the frame.
    pub plan_ms: f64,
    /// Making pipelines.
    pub pipelines_ms: f64,
    /// Uploading the scene, building the table.
    pub upload_ms: f64,
    /// Recording.
    pub record_ms: f64,
    /// Submit to fence, last run.
    pub last_run_ms: f64,
    /// The same without what the driver took, microseconds.
    pub last_own_us: f64,
}

/// A frame, ready to run.
pub struct Renderer {
    recorded: Recorded,
    /// The frame without what it has kept from an earlier one; none where it keeps nothing.
    rest: Option<Recorded>,
    /// What is kept must be drawn again.
    stale: bool,
    /// The last run drew it.
    drew: bool,
    readback: Option<(Recorded, Buffer)>,
    plan: Plan,
    images: BTreeMap<String, Image>,
    buffers: BTreeMap<String, Buffer>,
    // Never read again, but the recorded commands use them: they live as long.
    _pipelines: Vec<Pipeline>,
    resources: Resources,
    setups: Vec<Setup>,
    size: [u32; 2],
    output: Output,
    times: CpuTimes,
    gpu: Arc<Gpu>,
}

impl Renderer {
    /// Plans, creates everything, records once.
    ///
    /// # Errors
    /// Where a view cannot be shown, memory gives out, or the driver refuses.
    pub fn new(gpu: &Arc<Gpu>, inputs: Inputs<'_>) -> Result<Renderer, FrameError> {
        Self::edited(gpu, inputs, |_| {})
    }

    /// As [`Renderer::new`], the plan changed before anything is made from it. A plan is data: tests take a barrier out of
    /// one and see whether anybody notices.
    ///
    /// # Errors
    /// As [`Renderer::new`], and where the changed plan does not hold together.
    pub fn edited(gpu: &Arc<Gpu>, inputs: Inputs<'_>, edit: impl FnOnce(&mut Plan)) -> Result<Renderer, FrameError> {
        let mut times = CpuTimes::default();
        let start = Instant::now();
        let setups = Setup::all(&inputs)?;
        let mut plan = methods::plan(&setups, Suit::of(gpu.info()))?;
        // What all profiles share, each of them knows.
        let setup = &setups[0];
        plan.fit(|desc| Need::on(gpu, desc));
        edit(&mut plan);
        times.plan_ms = milliseconds(start);
        let start = Instant::now();
        let resources = Resources::new(gpu, &inputs, &setups)?;
        times.upload_ms = milliseconds(start);
        let images = create_images(gpu, &plan)?;
        let mut buffers = BTreeMap::new();
        for b in plan.buffers.values() {
            let usage = vk::BufferUsageFlags::STORAGE_BUFFER
                | vk::BufferUsageFlags::INDIRECT_BUFFER
                | vk::BufferUsageFlags::TRANSFER_DST
                | vk::BufferUsageFlags::TRANSFER_SRC;
            buffers.insert(b.name.clone(), Buffer::new(gpu, &b.name, b.bytes, usage, MemoryLocation::GpuOnly)?);
        }
        let start = Instant::now();
        let draws: Vec<(Draw, &Material)> =
            inputs.scene.draws.iter().filter_map(|d| Some((*d, inputs.scene.materials.get(d.material)?))).collect();
        let overlay: Vec<(Draw, &Material)> =
            setup.overlay.draws.iter().filter_map(|d| Some((*d, inputs.scene.materials.get(d.material)?))).collect();
        let (pipelines, classes) = record::pipelines(gpu, &plan, &draws, &overlay)?;
        times.pipelines_ms = milliseconds(start);
        let start = Instant::now();
        let world = record::World {
            plan: &plan,
            images: &images,
            buffers: &buffers,
            pipelines: &pipelines,
            classes: &classes,
            resources: &resources,
            draws: &draws,
            overlay: &overlay,
            index_count: inputs.scene.indices.len() as u32,
            scatters: setups.iter().any(|s| s.scatters),
            profiles: &inputs.profiles,
            coated: setup.coated,
            thickest_mm: setup.thickest_mm,
        };
        let idle = (setup.timed && gpu.info().timestamp_period > 0.).then(TimingMode::default);
        let timing = inputs.timing.or(idle);
        let recorded = record::record(gpu, 0, timing, &world)?;
        let rest = (plan.still > 0).then(|| record::record(gpu, plan.still, timing, &world)).transpose()?;
        times.record_ms = milliseconds(start);
        Ok(Renderer {
            recorded,
            rest,
            stale: true,
            drew: true,
            readback: None,
            plan,
            images,
            buffers,
            _pipelines: pipelines,
            resources,
            size: setup.size,
            output: setup.output,
            setups,
            times,
            gpu: gpu.clone(),
        })
    }

    /// What would run, without creating anything, on a device that nobody has measured.
    ///
    /// # Errors
    /// Where a view cannot be shown.
    pub fn plan_only(inputs: &Inputs<'_>) -> Result<Plan, FrameError> {
        Ok(methods::plan(&Setup::all(inputs)?, Suit::default())?)
    }

    /// The frame, decided.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// One submit; waits for it. With [`Settings::still`] shadow maps are drawn by the first, and by the first after
    /// [`Renderer::look`] moved a light.
    ///
    /// # Errors
    /// Where the device is lost.
    pub fn run(&mut self) -> Result<(), FrameError> {
        let start = Instant::now();
        self.drew = self.stale || self.rest.is_none();
        let driver = self.last().run()?;
        self.stale = false;
        let all = start.elapsed();
        self.times.last_run_ms = all.as_secs_f64() * 1e3;
        self.times.last_own_us = all.saturating_sub(driver).as_secs_f64() * 1e6;
        Ok(())
    }

    /// What the last run submitted.
    fn last(&self) -> &Recorded {
        self.rest.as_ref().filter(|_| !self.drew).unwrap_or(&self.recorded)
    }

    /// Moves the eye or the lights, for the next [`Renderer::run`]: a write of some constants, nothing is recorded again. All
    /// other inputs, the scene first of all, must be those that the frame was made from. False where the frame needs other
    /// steps from there (blur levels that become a pixel wide, another kind or number of lights): then nothing has changed,
    /// and a new frame must be made.
    ///
    /// # Errors
    /// As [`Renderer::new`].
    pub fn look(&mut self, inputs: &Inputs<'_>) -> Result<bool, FrameError> {
        let setups = Setup::after(&self.setups, inputs)?;
        let plan = methods::plan(&setups, Suit::of(self.gpu.info()))?;
        let alike = |(a, b): (&Setup, &Setup)| {
            a.levels == b.levels
                && a.kernel.len() == b.kernel.len()
                && (&a.overlay.draws, &a.overlay.indices) == (&b.overlay.draws, &b.overlay.indices)
        };
        let same = self.setups.len() == setups.len()
            && self.setups.iter().zip(&setups).all(alike)
            && self.plan.records_as(&plan);
        if same {
            self.resources.rewrite(inputs, &setups)?;
            self.stale |= self.setups[0].shadows.matrices != setups[0].shadows.matrices;
            self.setups = setups;
        }
        Ok(same)
    }

    /// Nanoseconds per pass of the last run; none where a stamp was missing. Empty without timestamps.
    ///
    /// # Errors
    /// Where the driver refuses.
    pub fn times(&self) -> Result<Vec<(String, Option<f64>)>, FrameError> {
        let Some(timer) = self.last().timer() else { return Ok(Vec::new()) };
        let kept = if self.drew { 0 } else { self.plan.still };
        let names = self.plan.passes.iter().skip(kept).map(|p| p.name.clone());
        Ok(names.zip(timer.read()?).collect())
    }

    /// CPU times so far.
    pub fn cpu_times(&self) -> CpuTimes {
        self.times
    }

    /// Whether the picture is 8 bit or linear.
    pub fn output(&self) -> Output {
        self.output
    }

    /// Bytes of device memory of the frame's images: as they share it, and as they would not.
    pub fn memory(&self) -> (u64, u64) {
        self.plan.bytes()
    }

    /// The 8-bit picture of the last run, sRGB, RGBA row by row from the top.
    ///
    /// # Errors
    /// Where the frame is linear, or the device is lost.
    pub fn ldr(&mut self) -> Result<Vec<u8>, FrameError> {
        self.read("ldr", |bytes| bytes.to_vec())
    }

    /// The linear picture of the last run, RGBA row by row from the top, A = coverage.
    ///
    /// # Errors
    /// Where the frame is 8 bit, or the device is lost.
    pub fn linear(&mut self) -> Result<Vec<[f32; 4]>, FrameError> {
        self.read("exr", |bytes| bytes.chunks_exact(16).map(bytemuck::pod_read_unaligned).collect())
    }

    /// How many tiles each list of the last run holds.
    ///
    /// # Errors
    /// Where the device is lost.
    pub fn tile_counts(&self) -> Result<BTreeMap<String, u32>, FrameError> {
        let mut counts = BTreeMap::new();
        for (name, buffer) in self.buffers.iter().filter(|(n, _)| n.contains("tiles")) {
            let host =
                Buffer::new(&self.gpu, "tile count", 16, vk::BufferUsageFlags::TRANSFER_DST, MemoryLocation::GpuToCpu)?;
            record::read_buffer(&self.gpu, buffer, &host)?;
            counts.insert(name.clone(), bytemuck::pod_read_unaligned(&host.bytes()?[..4]));
        }
        Ok(counts)
    }

    /// The bytes of a target that the plan keeps, after the last run, row by row from the top.
    ///
    /// # Errors
    /// Where there is no such target, or the device is lost.
    pub fn texels(&self, name: &str) -> Result<Vec<u8>, FrameError> {
        let image =
            self.images.get(name).ok_or_else(|| GpuError::Misuse(format!("this frame has no target {name}")))?;
        let (commands, buffer) = record::read_back(&self.gpu, &self.plan, name, image)?;
        commands.run()?;
        Ok(buffer.bytes()?.to_vec())
    }

    fn read<T>(&mut self, name: &str, decode: impl Fn(&[u8]) -> Vec<T>) -> Result<Vec<T>, FrameError> {
        let image =
            self.images.get(name).ok_or_else(|| GpuError::Misuse(format!("this frame has no {name} picture")))?;
        if self.readback.is_none() {
            self.readback = Some(record::read_back(&self.gpu, &self.plan, name, image)?);
        }
        let Some((commands, buffer)) = &self.readback else { return Ok(Vec::new()) };
        commands.run()?;
        let texel = crate::plan::texel_bytes(image.desc.format);
        let bytes = u64::from(self.size[0]) * u64::from(self.size[1]) * texel;
        Ok(decode(&buffer.bytes()?[..bytes as usize]))
    }
}

fn milliseconds(since: Instant) -> f64 {
    since.elapsed().as_secs_f64() * 1e3
}

/// Makes every image, where the plan says.
fn create_images(gpu: &Arc<Gpu>, plan: &Plan) -> Result<BTreeMap<String, Image>, FrameError> {
    let block = |(arena, need): (usize, Need)| {
        let requirements =
            vk::MemoryRequirements { size: need.bytes, alignment: need.alignment, memory_type_bits: need.types };
        Ok((arena, Block::new(gpu, &format!("targets {arena}"), requirements)?))
    };
    let blocks = plan.arenas().into_iter().map(block).collect::<Result<BTreeMap<_, _>, GpuError>>()?;
    let mut images = BTreeMap::new();
    for (name, t) in &plan.targets {
        let desc = &t.desc;
        if !gpu.supports(desc.format, desc.usage) {
            let text = format!("{name}: {:?} cannot be used as {:?} on {}", desc.format, desc.usage, gpu.info().name);
            return Err(GpuError::Misuse(text).into());
        }
        let mut image = Image::unbound(gpu, desc.clone())?;
        image.bind(&blocks[&t.arena], t.offset)?;
        images.insert(name.clone(), image);
    }
    Ok(images)
}

impl From<Integral> for crate::skin::lut::Integral {
    fn from(i: Integral) -> Self {
        match i {
            Integral::Sphere => Self::Sphere,
            Integral::Ring => Self::Ring,
            Integral::RingLiteral => Self::RingLiteral,
        }
    }
}
