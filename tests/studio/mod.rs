//! One device, watched by the validation layers, and frames on it.
#![allow(dead_code, reason = "shared by several test programs, none of which uses all of it")]
use pdss::frame::{FrameError, Inputs, Output, Renderer};
use pdss::gpu::{Gpu, Options};
use pdss::scene::{Camera, Light, Scene};
use pdss::settings::Settings;
use pdss::skin::profile::Profile;
#[allow(unused_imports, reason = "shared by several test programs, none of which uses all of it")]
pub use pdss::stress::studio::{Picture, settings, wax};
use std::sync::Arc;

/// Opens the device with core and synchronization validation. No layer or no device is a failure, not a reason to skip.
pub fn open() -> Arc<Gpu> {
    let gpu = Gpu::open(&Options { validate: true, device: None }).expect("a Vulkan device and the validation layer");
    println!("driver: {} ({}), Vulkan {}", gpu.info().name, gpu.info().driver, gpu.info().api);
    gpu
}

/// Closes it: no message has come, nothing is alive.
pub fn close(gpu: Arc<Gpu>) {
    assert_eq!(gpu.messages(), Vec::<String>::new(), "validation messages");
    gpu.close().expect("nothing leaks");
}

/// Everything that a frame is made from.
#[derive(Clone)]
pub struct Set {
    pub scene: Arc<Scene>,
    pub camera: Camera,
    pub lights: Vec<Light>,
    pub profile: Option<Profile>,
    pub settings: Settings,
    pub output: Output,
}

/// The scene of a shape, all of it scattering.
pub fn shape(text: &str) -> Arc<Scene> {
    let mut scene = Scene::shape(text).expect("a shape");
    scene.assign_profile(None, 0).expect("a material");
    Arc::new(scene)
}

impl Set {
    /// A shape seen from yaw 20, pitch 30 at `distance` mm, one light from the upper left.
    pub fn new(text: &str, distance: f64, settings: Settings) -> Set {
        let scene = shape(text);
        let camera = Camera::orbit(20., 30., distance, None, 30., &scene);
        let lights = vec![Light::directional(-40., 35., 1.)];
        Set { scene, camera, lights, profile: Some(wax()), settings, output: Output::Linear }
    }

    pub fn inputs(&self) -> Inputs<'_> {
        Inputs {
            scene: &self.scene,
            camera: self.camera.clone(),
            lights: self.lights.clone(),
            profile: self.profile.clone(),
            settings: self.settings.clone(),
            timing: None,
            output: self.output,
        }
    }

    pub fn size(&self) -> [usize; 2] {
        [self.settings.size.width as usize, self.settings.size.height as usize]
    }

    /// The linear picture.
    pub fn try_linear(&self, gpu: &Arc<Gpu>) -> Result<Picture, FrameError> {
        let mut renderer = Renderer::new(gpu, self.inputs())?;
        renderer.run()?;
        Ok(Picture { size: self.size(), texels: renderer.linear()? })
    }

    pub fn linear(&self, gpu: &Arc<Gpu>) -> Picture {
        self.try_linear(gpu).expect("a frame")
    }
}
