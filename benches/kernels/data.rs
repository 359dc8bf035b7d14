//! A frame on the device, timed stage by stage, and its targets as the processor's kernels read them.

use super::blur::Level;
use half::f16;
use pdss::frame::constants::{Constants, lights_of};
use pdss::frame::uniforms::{FrameBlock, LightBlock};
use pdss::frame::{FrameError, Inputs, Output, Renderer, Setup};
use pdss::gpu::Gpu;
use pdss::gpu::timing::TimingMode;
use pdss::plan::Need;
use pdss::scene::{Camera, Light, Scene};
use pdss::settings::{Kernels, Method, Quality, Resolution, Settings, Size, Spared};
use pdss::skin::lut::Lut;
use pdss::skin::profile::Profile;
use pdss::skin::specular;
use std::sync::Arc;

/// The projection, as every kernel has it; perspective.
pub struct Screen {
    pub size: [usize; 2],
    pub ray_scale: [f32; 2],
    pub ray_offset: [f32; 2],
    pub pixels_per_mm: f32,
}

/// Targets, an array a component.
pub struct Data {
    pub screen: Screen,
    pub z: Vec<f32>,
    pub normal: Vec<u32>,
    pub mean: Vec<f32>,
    pub rest: Vec<u32>,
    pub lit: Vec<u32>,
    pub albedo: Vec<u32>,
    pub material: Vec<u32>,
}

impl Data {
    /// No surface in these pixels: the device visits no such tile.
    #[inline(always)]
    pub fn empty(&self, from: usize, count: usize) -> bool {
        self.z[from..from + count].iter().all(|z| *z == 0.)
    }
}

/// A table to interpolate in: `size` texels, and in each plane a column and a row more, so that the last ones have neighbours.
pub struct Table {
    pub size: [usize; 2],
    pub channels: Vec<Vec<f32>>,
}

impl Table {
    fn new([across, down]: [usize; 2], channels: usize, texel: impl Fn(usize, usize, usize) -> f16) -> Table {
        let plane = |c| {
            let row = |y: usize| (0..=across).map(move |x| (x.min(across - 1), y.min(down - 1)));
            (0..=down).flat_map(row).map(|(x, y)| texel(c, x, y).to_f32()).collect()
        };
        // One more: the very last texel asks for what lies right of what lies below it.
        let widened = |mut p: Vec<f32>| {
            p.push(0.);
            p
        };
        Table { size: [across, down], channels: (0..channels).map(plane).map(widened).collect() }
    }

    /// The table of `pdss`.
    pub fn lut(lut: &Lut) -> Table {
        let ([w, h], halves) = lut.planes();
        let (w, h) = (w as usize, h as usize / 3);
        Table::new([w, h], 3, |c, x, y| halves[(c * h + y) * w + x])
    }

    /// The table of directional albedo.
    pub fn gloss() -> Table {
        let t = specular::table();
        Table::new([specular::SIDE; 2], 2, |c, x, y| t[y * specular::SIDE + x][c])
    }
}

/// What a frame of these measurements is made from: everything at full resolution, all light blurred on the screen.
pub fn inputs(scene: &Scene, camera: Camera, method: Method, kernels: Kernels, size: Size) -> Inputs<'_> {
    Inputs {
        scene,
        camera,
        lights: vec![Light::directional(60., 25., 1.), Light::directional(-70., 10., 0.2)],
        profiles: Profile::resolve("skin").into_iter().collect(),
        settings: Settings {
            method,
            kernels,
            size,
            quality: Quality::High,
            resolution: Some(Resolution::Full),
            no_translucent: true,
            // Convex shapes do without, and there would be nothing to measure.
            no_elide: vec![Spared::Curvature, Spared::Occlusion],
            ..Settings::default()
        },
        timing: Some(TimingMode::Isolated),
        output: Output::Ldr,
    }
}

/// A frame whose targets can be read.
pub struct Shot {
    pub renderer: Renderer,
    pub frame: FrameBlock,
    pub lights: LightBlock,
    pub setup: Setup,
    pub lut: Lut,
    size: [usize; 2],
}

impl Shot {
    pub fn new(gpu: &Arc<Gpu>, inputs: Inputs<'_>) -> Result<Shot, FrameError> {
        let setup = Setup::all(&inputs)?.remove(0);
        let profile = inputs.profiles.first().expect("a built-in profile");
        let lut = Lut::build(profile, inputs.settings.integral.into());
        let frame = Constants::of(&inputs, &setup, lut.knee_per_mm as f32, 0.).frame;
        let (lights, _) = lights_of(&inputs, &setup);
        let size = [inputs.settings.size.width as usize, inputs.settings.size.height as usize];
        let renderer = Renderer::edited(gpu, inputs, |plan| {
            let names: Vec<String> = plan.targets.keys().filter(|n| !n.starts_with("absent")).cloned().collect();
            names.iter().filter(|n| *n != "shadow" && *n != "depth").for_each(|n| plan.keep(n));
            plan.fit(|desc| Need::on(gpu, desc));
        })?;
        Ok(Shot { renderer, frame, lights, setup, lut, size })
    }

    /// The words of a target, `n` a texel, an array each.
    pub fn words(&mut self, name: &str, n: usize) -> Result<Vec<Vec<u32>>, FrameError> {
        let bytes = self.renderer.texels(name)?;
        let words: Vec<u32> = bytes.chunks_exact(4).map(bytemuck::pod_read_unaligned).collect();
        Ok((0..n).map(|i| words.iter().skip(i).step_by(n).copied().collect()).collect())
    }

    fn word(&mut self, name: &str) -> Result<Vec<u32>, FrameError> {
        Ok(self.words(name, 1)?.remove(0))
    }

    pub fn data(&mut self) -> Result<Data, FrameError> {
        let frame = &self.frame;
        let screen = Screen {
            size: self.size,
            ray_scale: frame.ray_scale,
            ray_offset: frame.ray_offset,
            pixels_per_mm: frame.pixels_per_mm,
        };
        let floats = |words: Vec<u32>| words.into_iter().map(f32::from_bits).collect::<Vec<_>>();
        let z = floats(self.word("viewz")?);
        let mut bend = self.words("curvature", 2)?;
        let rest = bend.remove(1);
        Ok(Data {
            screen,
            z,
            normal: self.word("normal")?,
            mean: floats(bend.remove(0)),
            rest,
            lit: self.word("lit")?,
            albedo: self.word("albedo")?,
            material: self.word("material")?,
        })
    }

    /// A level by the number in its targets' names.
    pub fn level(&mut self, stem: &str) -> Result<Level, FrameError> {
        let mut soft = self.words(&format!("soft{stem}"), 2)?;
        let second = soft.remove(1);
        Ok(Level { first: soft.remove(0), second, lit: self.word(&format!("softlit{stem}"))? })
    }

    /// Time of a stage of the last run, ms.
    pub fn stage_ms(&self, name: &str) -> Result<f64, FrameError> {
        let times = self.renderer.times()?;
        Ok(times.into_iter().find(|(n, _)| n == name).and_then(|t| t.1).map_or(f64::NAN, |ns| ns * 1e-6))
    }
}
