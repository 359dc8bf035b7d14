//! What every command that draws is told: the scene, the eye, the lights, the profile, the device.

use super::failure::Failure;
use super::sky::Sky;
use super::{profiles, say};
use clap::Args;
use glam::DVec3;
use pdss::cache::Cache;
use pdss::frame::{Inputs, Output, meter};
use pdss::gpu::timing::TimingMode;
use pdss::gpu::{Gpu, GpuError, Options};
use pdss::scene::{Camera, Light, LoadOptions, Pose, Scene};
use pdss::settings::{Method, Settings, Size, View as Show};
use pdss::skin::profile::Profile;
use std::f64::consts::PI;
use std::sync::Arc;

/// What is drawn where no scene is named.
pub const DEFAULT_SCENE: &str = "bust";
/// Vertical field of view where none is given, degrees.
const DEFAULT_FOV: f64 = 30.;
/// Key and fill where neither the command line nor the file has a light: yaw, pitch, irradiance at normal incidence.
const DEFAULT_LIGHTS: [Aim; 2] = [Aim { yaw: 60., pitch: 25., size: PI }, Aim { yaw: -70., pitch: 10., size: 0.6 }];

/// A direction in degrees and how far or how strong.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aim {
    yaw: f64,
    pitch: f64,
    size: f64,
}

impl Aim {
    /// The directional light that it aims.
    pub fn light(&self) -> Light {
        Light::directional(self.yaw, self.pitch, self.size as f32)
    }
}

/// The scene and how it is seen.
#[derive(Clone, Debug, Args)]
pub struct View {
    /// A .gltf or .glb file, bust (the head that comes with the program), or shape:plane, shape:sphere:R, shape:cylinder:R, shape:torus:R,r, shape:saddle:a,
    /// shape:cube:a, shape:ellipsoid:a,b,c (mm).
    #[arg(value_name = "SCENE", default_value = DEFAULT_SCENE)]
    scene: String,
    /// Eye at yaw and pitch (degrees) and distance (mm) from the target. Default: the file's first camera, else one that
    /// sees everything.
    #[arg(long, value_name = "YAW,PITCH,MM", allow_hyphen_values = true, value_parser = parse_camera)]
    camera: Option<Aim>,
    /// What the camera looks at, world mm. Default: the centre of the scene's bounding box.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = parse_target, requires = "camera")]
    target: Option<DVec3>,
    /// A camera of the file, from 0.
    #[arg(long, value_name = "N", conflicts_with_all = ["camera", "target", "fov"])]
    camera_index: Option<usize>,
    /// Vertical field of view in degrees. Default: 30.
    #[arg(long, value_name = "DEG", allow_hyphen_values = true, value_parser = parse_fov)]
    fov: Option<f64>,
    /// Directional light that shines from yaw and pitch (degrees), with its irradiance at normal incidence (1 if left out);
    /// may be repeated. Default: the file's lights, else a key and a fill.
    #[arg(long = "light", value_name = "YAW,PITCH[,INTENSITY]", allow_hyphen_values = true, value_parser = parse_light)]
    lights: Vec<Aim>,
    #[command(flatten)]
    sky: Sky,
    /// Diffusion profile: a built-in name, a .toml file, or none. Default: what the file says of the inside of each
    /// scattering material, else skin.
    #[arg(long, value_name = "NAME|FILE")]
    profile: Option<String>,
    /// A material that has the profile, or, as NAME=PROFILE, one of its own (none: it does not scatter); may be repeated.
    /// Default: those the file says light passes into, else every opaque dielectric.
    #[arg(long = "profile-material", value_name = "NAME[=PROFILE]")]
    profile_materials: Vec<String>,
    /// Millimetres in one unit of the file. Default: 1000.
    #[arg(long, value_name = "X", allow_hyphen_values = true, value_parser = parse_positive)]
    mm_per_unit: Option<f64>,
    /// Pose the scene by an animation of the file, from 0. Default: 0 where --time is given, else none.
    #[arg(long, value_name = "N")]
    animation: Option<usize>,
    /// Time of the animation, seconds.
    #[arg(long, value_name = "T", allow_hyphen_values = true, value_parser = parse_time)]
    time: Option<f64>,
    #[command(flatten)]
    settings: Settings,
    #[command(flatten)]
    device: Device,
    /// Say more on stderr.
    #[arg(long, short)]
    verbose: bool,
}

/// The device and how closely it is watched.
#[derive(Clone, Debug, Args)]
pub struct Device {
    /// Device by its index in `pdss devices` or part of its name. Default: the fastest kind there is.
    #[arg(long, value_name = "INDEX|NAME")]
    device: Option<String>,
    /// Core and synchronization validation: any message is a failure.
    #[arg(long)]
    pub(super) validate: bool,
    /// Neither read nor keep what is dear to make (pipelines, the kernel's mass of a mesh) in the user's cache.
    #[arg(long)]
    no_cache: bool,
}

/// Everything a frame is made of, loaded.
pub struct Stage {
    /// The scene as it was named.
    pub name: String,
    /// What is drawn.
    pub scene: Scene,
    camera: Camera,
    /// Lit by what.
    pub lights: Vec<Light>,
    /// What scatters.
    pub profiles: Vec<Profile>,
    /// How.
    pub settings: Settings,
}

impl Stage {
    /// The engine's inputs.
    pub fn inputs(&self, timing: Option<TimingMode>, output: Output) -> Inputs<'_> {
        Inputs {
            scene: &self.scene,
            camera: self.camera.clone(),
            lights: self.lights.clone(),
            profiles: self.profiles.clone(),
            settings: self.settings.clone(),
            timing,
            output,
        }
    }

    /// Meters the light of a sky, unless the exposure is given, and says what came of it.
    pub fn meter(&mut self) -> String {
        if let (None, Some(sky)) = (self.settings.exposure, &self.scene.environment) {
            self.settings.exposure = Some(meter::stops(sky, &self.lights, self.scene.bounds.center(), &self.camera));
        }
        format!("exposure {:+.2} stops", self.settings.exposure.unwrap_or(0.))
    }

    /// Whether the picture is made by lighting, and not of a target's numbers.
    pub fn lit(&self) -> bool {
        matches!(self.settings.view, Show::Final | Show::Scatter | Show::Irradiance | Show::Ao)
    }

    /// Width and height of the picture in pixels.
    pub fn size(&self) -> [u32; 2] {
        [self.settings.size.width, self.settings.size.height]
    }
}

impl View {
    /// The scene as it was named.
    pub fn scene(&self) -> &str {
        &self.scene
    }

    /// The device it is drawn on.
    pub fn device(&self) -> &Device {
        &self.device
    }

    /// The same view of another scene, in a picture of this size.
    pub fn of(&self, scene: &str, size: Size) -> View {
        let settings = Settings { size, ..self.settings.clone() };
        View { scene: scene.to_owned(), settings, ..self.clone() }
    }

    /// The same view `seconds` later.
    pub fn later(&self, seconds: f64) -> View {
        View { time: Some(self.time.unwrap_or(0.) + seconds), ..self.clone() }
    }

    fn pose(&self) -> Option<Pose> {
        let posed = self.animation.is_some() || self.time.is_some();
        posed.then(|| Pose { animation: self.animation.unwrap_or(0), time: self.time.unwrap_or(0.) })
    }

    /// Loads the scene and the profile, places the camera and the lights.
    pub fn load(&self) -> Result<Stage, Failure> {
        let stage = self.load_silently()?;
        // What is odd about the bust is known; nobody who draws it can mend it.
        let mendable = self.verbose || self.scene != DEFAULT_SCENE;
        for warning in stage.scene.warnings.iter().filter(|_| mendable) {
            say(&format!("warning: {}: {warning}", self.scene));
        }
        if self.verbose {
            let profile = Profile::joined(&stage.profiles);
            say(&format!(
                "{}: {} triangles, {} materials, profile {profile}, camera {}, {} lights",
                self.scene,
                stage.scene.triangle_count(),
                stage.scene.materials.len(),
                stage.camera.name,
                stage.lights.len()
            ));
        }
        Ok(stage)
    }

    /// The same without a word.
    pub fn load_silently(&self) -> Result<Stage, Failure> {
        let options = LoadOptions {
            mm_per_unit: self.mm_per_unit,
            keep_uvs: self.settings.method == Method::TextureSpace,
            pose: self.pose(),
        };
        if options.pose.is_some() && self.scene.starts_with("shape:") {
            return Err(Failure::Input(format!("--animation: {} stands still; a glTF file may move", self.scene)));
        }
        let wish = profiles::Wish { profile: self.profile.as_deref(), materials: &self.profile_materials };
        wish.check()?;
        let mut scene = Scene::open(&self.scene, &options)?;
        let profiles = wish.assign(&mut scene)?;
        scene.environment = self.sky.load()?.map(Arc::new);
        let camera = self.camera(&scene)?;
        let lights = self.lights(&scene);
        Ok(Stage { name: self.scene.clone(), scene, camera, lights, profiles, settings: self.settings.clone() })
    }

    /// Opens the device, and refuses a picture that it cannot hold.
    pub fn open(&self) -> Result<Arc<Gpu>, Failure> {
        let gpu = self.device.open()?;
        let (size, most) = (self.settings.size, gpu.limits().max_image_dimension2_d);
        if self.verbose {
            say(&format!("device {}: {} ({})", gpu.info().index, gpu.info().name, gpu.info().driver));
        }
        if size.width.max(size.height) > most {
            let name = &gpu.info().name;
            return Err(Failure::Input(format!(
                "--size {}x{}: {name} has images of {most} at most",
                size.width, size.height
            )));
        }
        Ok(gpu)
    }

    /// A line for people who asked for more.
    pub fn tell(&self, line: &str) {
        if self.verbose {
            say(line);
        }
    }

    /// Whether the validation layers are on.
    pub fn validates(&self) -> bool {
        self.device.validates()
    }

    fn camera(&self, scene: &Scene) -> Result<Camera, Failure> {
        let fov = self.fov.unwrap_or(DEFAULT_FOV);
        let size = self.settings.size;
        if let Some(index) = self.camera_index {
            return scene.cameras.get(index).cloned().ok_or_else(|| {
                Failure::Input(format!("--camera-index {index}: {} has {} cameras", self.scene, scene.cameras.len()))
            });
        }
        Ok(match (self.camera, scene.cameras.first()) {
            (Some(Aim { yaw, pitch, size }), _) => Camera::orbit(yaw, pitch, size, self.target, fov, scene),
            (None, Some(camera)) if self.fov.is_none() => camera.clone(),
            _ => Camera::default_for(scene, fov, f64::from(size.width) / f64::from(size.height)),
        })
    }

    fn lights(&self, scene: &Scene) -> Vec<Light> {
        let directional = |aims: &[Aim]| -> Vec<Light> { aims.iter().map(Aim::light).collect() };
        if !self.lights.is_empty() {
            return directional(&self.lights);
        }
        if !scene.lights.is_empty() {
            return scene.lights.clone();
        }
        if scene.environment.is_some() {
            return Vec::new();
        }
        if self.verbose {
            say("no light given and none in the scene: a key from 60,25,3.14 and a fill from -70,10,0.6");
        }
        directional(&DEFAULT_LIGHTS)
    }
}

impl Device {
    /// Whether the validation layers are on.
    pub fn validates(&self) -> bool {
        self.validate
    }

    /// Opens the device.
    pub fn open(&self) -> Result<Arc<Gpu>, Failure> {
        let cache = if self.no_cache { None } else { Cache::of_user() };
        Ok(Gpu::open_with(&Options { validate: self.validate, device: self.device.clone() }, cache)?)
    }

    /// Opens it with validation, asked for or not.
    pub fn open_validated(&self) -> Result<Arc<Gpu>, GpuError> {
        Gpu::open(&Options { validate: true, device: self.device.clone() })
    }
}

/// Closes the device. Messages of the validation layers and leaked objects are a check that failed.
pub fn close(gpu: Arc<Gpu>) -> Result<(), Failure> {
    let messages = gpu.messages();
    for message in &messages {
        say(&format!("validation: {message}"));
    }
    gpu.close()?;
    match messages.len() {
        0 => Ok(()),
        1 => Err(Failure::Run("1 validation message".to_owned())),
        n => Err(Failure::Run(format!("{n} validation messages"))),
    }
}

/// Finite numbers with commas between them.
fn numbers(text: &str) -> Option<Vec<f64>> {
    text.split(',').map(|t| t.trim().parse().ok().filter(|x: &f64| x.is_finite())).collect()
}

fn parse_camera(text: &str) -> Result<Aim, String> {
    match numbers(text).as_deref() {
        Some([yaw, pitch, size]) if *size > 0. => Ok(Aim { yaw: *yaw, pitch: *pitch, size: *size }),
        Some([_, _, _]) => Err("the distance must be above 0 mm".to_owned()),
        _ => Err("that is not yaw,pitch,distance; -35,5,750 would be".to_owned()),
    }
}

pub fn parse_light(text: &str) -> Result<Aim, String> {
    match numbers(text).as_deref() {
        Some([yaw, pitch]) => Ok(Aim { yaw: *yaw, pitch: *pitch, size: 1. }),
        Some([yaw, pitch, size]) if *size >= 0. => Ok(Aim { yaw: *yaw, pitch: *pitch, size: *size }),
        Some([_, _, _]) => Err("the intensity must not be negative".to_owned()),
        _ => Err("that is not yaw,pitch or yaw,pitch,intensity; -70,10,0.6 would be".to_owned()),
    }
}

fn parse_target(text: &str) -> Result<DVec3, String> {
    match numbers(text).as_deref() {
        Some([x, y, z]) => Ok(DVec3::new(*x, *y, *z)),
        _ => Err("that is not x,y,z in mm; 0,120,-3.5 would be".to_owned()),
    }
}

fn parse_fov(text: &str) -> Result<f64, String> {
    let right = |x: &f64| *x > 0. && *x < 180.;
    text.parse()
        .ok()
        .filter(right)
        .ok_or_else(|| "the vertical field of view lies between 0 and 180 degrees".to_owned())
}

fn parse_time(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|x: &f64| x.is_finite())
        .ok_or_else(|| "that is no time in seconds; 1.5 would be".to_owned())
}

pub fn parse_positive(text: &str) -> Result<f64, String> {
    let right = |x: &f64| *x > 0. && x.is_finite();
    text.parse().ok().filter(right).ok_or_else(|| "that is not a number above 0; 1000 would be".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_may_be_negative_and_nonsense_is_refused() {
        assert_eq!(parse_camera("-35,5,750"), Ok(Aim { yaw: -35., pitch: 5., size: 750. }));
        assert_eq!(parse_light("-70, 10"), Ok(Aim { yaw: -70., pitch: 10., size: 1. }));
        assert_eq!(parse_target("-1,2,-3.5"), Ok(DVec3::new(-1., 2., -3.5)));
        for wrong in ["", "1,2", "1,2,0", "1,2,-3", "1,2,NaN", "1,2,inf", "1,2,3,4", "1;2;3"] {
            assert!(parse_camera(wrong).is_err(), "{wrong}");
        }
        for wrong in ["", "1", "1,2,-1", "1,2,3,4", "--light"] {
            assert!(parse_light(wrong).is_err(), "{wrong}");
        }
        for wrong in ["0", "180", "-5", "NaN", "x"] {
            assert!(parse_fov(wrong).is_err(), "{wrong}");
        }
        for wrong in ["0", "-1", "inf", "NaN"] {
            assert!(parse_positive(wrong).is_err(), "{wrong}");
        }
    }
}
