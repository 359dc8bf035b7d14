//! One device, watched by the validation layers, and frames on it.
#![allow(dead_code, reason = "shared by several test programs, none of which uses all of it")]
use glam::{Mat4, Vec3};
use pdss::frame::{FrameError, Inputs, Output, Renderer};
use pdss::gpu::{Gpu, Options};
use pdss::scene::{Aabb, Camera, Light, Scene};
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

/// A torus, sphere or ellipsoid of a quarter of the triangles, which small pictures do not miss: every second vertex of its grids.
pub fn thinned(scene: &Scene) -> Arc<Scene> {
    let [columns, rows] = if scene.positions.len() == 321 * 161 { [320, 160] } else { [128, 128] };
    let grid = (columns + 1) * (rows + 1);
    assert_eq!(scene.positions.len() % grid, 0, "{} is no grid", scene.name);
    let kept: Vec<usize> = (0..scene.positions.len())
        .filter(|i| i % grid % (columns + 1) % 2 == 0 && i % grid / (columns + 1) % 2 == 0)
        .collect();
    let mut thin = scene.clone();
    thin.positions = kept.iter().map(|i| scene.positions[*i]).collect();
    thin.normals = kept.iter().map(|i| scene.normals[*i]).collect();
    thin.uvs = kept.iter().map(|i| scene.uvs[*i]).collect();
    let [across, down] = [columns as u32 / 2, rows as u32 / 2];
    let squares = (0..(scene.positions.len() / grid) as u32).flat_map(|g| {
        (0..down).flat_map(move |j| (0..across).map(move |i| g * (across + 1) * (down + 1) + j * (across + 1) + i))
    });
    thin.indices = squares.flat_map(|a| [a, a + across + 1, a + across + 2, a, a + across + 2, a + 1]).collect();
    thin.draws[0].index_count = thin.indices.len() as u32;
    Arc::new(thin)
}

/// Plates of 80 mm: each a place of its middle and a normal in the plane of x and z.
pub fn plates(list: &[(Vec3, f32)]) -> Scene {
    let plane = shape("shape:plane");
    let mut scene = (*plane).clone();
    let (positions, normals, indices) = (plane.positions.clone(), plane.normals.clone(), plane.indices.clone());
    (scene.positions, scene.normals, scene.indices) = (Vec::new(), Vec::new(), Vec::new());
    for (middle, yaw) in list {
        // The plane faces +Y; make it face +Z, then turn it.
        let turn = Mat4::from_rotation_y(*yaw) * Mat4::from_rotation_x(std::f32::consts::FRAC_PI_2);
        let first = scene.positions.len() as u32;
        scene
            .positions
            .extend(positions.iter().map(|p| (*middle + turn.transform_vector3(Vec3::from(*p) * 0.4)).to_array()));
        scene.normals.extend(normals.iter().map(|n| turn.transform_vector3(Vec3::from(*n)).to_array()));
        scene.indices.extend(indices.iter().map(|i| i + first));
    }
    scene.uvs = vec![[0.; 2]; scene.positions.len()];
    scene.bounds = Aabb::around(&scene.positions);
    scene.draws[0].index_count = scene.indices.len() as u32;
    scene
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
            profiles: self.profile.clone().into_iter().collect(),
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
