//! The engine's outline, so that what stands on it compiles before it lands.

use crate::gpu::timing::TimingMode;
use crate::gpu::{Gpu, GpuError};
use crate::plan::Plan;
use crate::scene::{Camera, Light, Scene};
use crate::settings::Settings;
use crate::skin::profile::Profile;
use std::sync::Arc;

/// What the host reads back.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Output {
    /// RGBA8, sRGB.
    Ldr,
    /// RGBA f32, linear.
    Linear,
}

/// What a frame is made of.
#[derive(Clone)]
pub struct Inputs<'a> {
    /// What is drawn.
    pub scene: &'a Scene,
    /// From where.
    pub camera: Camera,
    /// Lit by what.
    pub lights: Vec<Light>,
    /// What scatters.
    pub profile: Option<Profile>,
    /// How.
    pub settings: Settings,
    /// Timed how, if at all.
    pub timing: Option<TimingMode>,
    /// Read back as what.
    pub output: Output,
}

/// CPU work.
#[derive(Clone, Copy, Debug, Default, serde::Serialize)]
pub struct CpuTimes {
    /// Planning, ms.
    pub plan_ms: f64,
    /// Pipelines, ms.
    pub pipelines_ms: f64,
    /// Upload, ms.
    pub upload_ms: f64,
    /// Recording, ms.
    pub record_ms: f64,
    /// Last submit, us.
    pub last_submit_us: f64,
}

/// What can go wrong.
#[derive(Debug, thiserror::Error)]
pub enum FrameError {
    /// The device.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// Not there yet.
    #[error("the engine is not there yet")]
    Absent,
}

/// The engine.
pub struct Renderer;

#[allow(missing_docs, clippy::missing_errors_doc)]
impl Renderer {
    pub fn new(_: &Arc<Gpu>, _: Inputs<'_>) -> Result<Renderer, FrameError> {
        Err(FrameError::Absent)
    }
    pub fn plan_only(_: &Arc<Gpu>, _: &Inputs<'_>) -> Result<Plan, FrameError> {
        Err(FrameError::Absent)
    }
    pub fn plan(&self) -> &Plan {
        static PLAN: std::sync::LazyLock<Plan> = std::sync::LazyLock::new(Plan::default);
        &PLAN
    }
    pub fn run(&mut self) -> Result<(), FrameError> {
        Err(FrameError::Absent)
    }
    pub fn times(&self) -> Result<Vec<(String, Option<f64>)>, FrameError> {
        Err(FrameError::Absent)
    }
    pub fn ldr(&mut self) -> Result<Vec<u8>, FrameError> {
        Err(FrameError::Absent)
    }
    pub fn linear(&mut self) -> Result<Vec<[f32; 4]>, FrameError> {
        Err(FrameError::Absent)
    }
    pub fn memory(&self) -> (u64, u64) {
        (0, 0)
    }
    pub fn cpu_times(&self) -> CpuTimes {
        CpuTimes::default()
    }
}
