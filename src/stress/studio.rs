//! A scene, an eye, lights, a profile and settings that are asked for linear pictures again and again.

use super::{Bench, StressError};
use crate::frame::{Inputs, Output, Renderer};
use crate::scene::{Aabb, Camera, Light, Scene};
use crate::settings::{Ambient, Method, Settings, Size, View};
use crate::skin::profile::{Gaussian, Profile, Shape};
use std::sync::Arc;

/// A linear picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Pixels across and down.
    pub size: [usize; 2],
    /// RGBA row by row from the top, A coverage.
    pub texels: Vec<[f32; 4]>,
}

impl Picture {
    /// One texel; both below the size.
    pub fn at(&self, x: usize, y: usize) -> [f32; 4] {
        self.texels[y * self.size[0] + x]
    }

    /// Texels on a surface, by index.
    pub fn covered(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.texels.len()).filter(|i| self.texels[*i][3] > 0.)
    }

    /// Texels whose bits are not the same; pictures of two sizes differ in all.
    pub fn differing(&self, other: &Picture) -> usize {
        if self.size != other.size {
            return self.texels.len().max(other.texels.len());
        }
        let bits = |t: &[f32; 4]| t.map(f32::to_bits);
        self.texels.iter().zip(&other.texels).filter(|(a, b)| bits(a) != bits(b)).count()
    }

    /// Largest difference of a colour channel; infinite where one is not a number or the sizes are not the same.
    pub fn apart(&self, other: &Picture) -> f32 {
        if self.size != other.size {
            return f32::INFINITY;
        }
        let one = |a: &[f32; 4], b: &[f32; 4]| (0..3).map(|c| nan_apart(a[c], b[c])).fold(0., f32::max);
        self.texels.iter().zip(&other.texels).map(|(a, b)| one(a, b)).fold(0., f32::max)
    }

    /// Largest channel difference at each texel that both cover and `keep` keeps.
    pub fn differences(&self, other: &Picture, keep: impl Fn(usize) -> bool) -> Vec<f64> {
        let both = |i: &usize| self.texels[*i][3] > 0. && other.texels[*i][3] > 0. && keep(*i);
        let one = |i: usize| (0..3).map(|c| nan_apart(self.texels[i][c], other.texels[i][c])).fold(0., f32::max);
        (0..self.texels.len().min(other.texels.len())).filter(both).map(|i| f64::from(one(i))).collect()
    }

    /// How far colours of covered texels lie outside `low`..`high`; infinite where one is not a number, or none is covered.
    pub fn outside(&self, low: f32, high: f32) -> f64 {
        let mut worst = 0f32;
        let mut any = false;
        for i in self.covered() {
            any = true;
            for x in &self.texels[i][..3] {
                worst = if x.is_nan() { f32::INFINITY } else { worst.max(low - x).max(x - high) };
            }
        }
        if any { f64::from(worst) } else { f64::INFINITY }
    }

    /// The same with every colour times `factor`.
    pub fn times(&self, factor: f32) -> Picture {
        let mut p = self.clone();
        p.texels.iter_mut().for_each(|t| t[..3].iter_mut().for_each(|x| *x *= factor));
        p
    }

    /// The same with one covered texel's green spoilt: what a check for bounds must catch.
    pub fn spoilt(&self, value: f32) -> Picture {
        let mut p = self.clone();
        if let Some(i) = self.covered().next() {
            p.texels[i][1] = value;
        }
        p
    }

    /// Columns and rows from a corner on.
    pub fn crop(&self, from: [usize; 2], size: [usize; 2]) -> Picture {
        let texels = (0..size[0] * size[1]).map(|i| self.at(from[0] + i % size[0], from[1] + i / size[0])).collect();
        Picture { size, texels }
    }
}

fn nan_apart(a: f32, b: f32) -> f32 {
    let d = (a - b).abs();
    if d.is_nan() { f32::INFINITY } else { d }
}

/// One narrow and one wide Gaussian: a profile whose table is quick to build, red wider than blue.
pub fn wax() -> Profile {
    mixture("wax", vec![(1., [0.3, 0.6, 0.9]), (16., [0.7, 0.4, 0.1])])
}

/// A profile of Gaussians: variance in mm^2, weight.
pub fn mixture(name: &str, list: Vec<(f64, [f64; 3])>) -> Profile {
    let gaussians = list.into_iter().map(|(variance, weight)| Gaussian { variance, weight }).collect();
    Profile {
        name: name.into(),
        source: String::new(),
        shape: Shape::Gaussians(gaussians),
        ior: 1.5,
        albedo: None,
        lobes: None,
    }
}

/// Settings of a small picture of `view` by `method`.
pub fn settings(method: Method, view: View, size: [u32; 2]) -> Settings {
    let ambient = Ambient { up: [0.05; 3], down: [0.02; 3] };
    Settings { method, view, size: Size { width: size[0], height: size[1] }, ambient, ..Settings::default() }
}

/// Everything that a frame is made from.
#[derive(Clone, Debug)]
pub struct Set {
    /// Meshes.
    pub scene: Arc<Scene>,
    /// The eye.
    pub camera: Camera,
    /// The lights.
    pub lights: Vec<Light>,
    /// How the scene scatters.
    pub profile: Option<Profile>,
    /// How what has the index 1 scatters.
    pub other: Option<Profile>,
    /// The rest.
    pub settings: Settings,
}

impl Set {
    /// A shape, all of it scattering, from yaw 20, pitch 30 at `distance` mm, one light from the upper left.
    pub fn new(text: &str, distance: f64, settings: Settings) -> Result<Set, StressError> {
        Ok(Self::of(Scene::shape(text)?, distance, settings))
    }

    /// The same of any scene.
    pub fn of(mut scene: Scene, distance: f64, settings: Settings) -> Set {
        scene.materials.iter_mut().for_each(|m| m.scatter = Some(0));
        let camera = Camera::orbit(20., 30., distance, None, 30., &scene);
        let lights = vec![Light::directional(-40., 35., 1.)];
        Set { scene: Arc::new(scene), camera, lights, profile: Some(wax()), other: None, settings }
    }

    /// With another view of the same.
    pub fn seeing(&self, view: View) -> Set {
        let mut set = self.clone();
        set.settings.view = view;
        set
    }

    /// By another method.
    pub fn by(&self, method: Method) -> Set {
        let mut set = self.clone();
        set.settings.method = method;
        set
    }

    /// What a frame is made from.
    pub fn inputs(&self) -> Inputs<'_> {
        Inputs {
            scene: &self.scene,
            camera: self.camera.clone(),
            lights: self.lights.clone(),
            profiles: self.profile.clone().into_iter().chain(self.other.clone()).collect(),
            settings: self.settings.clone(),
            timing: None,
            output: Output::Linear,
        }
    }

    /// Pixels across and down.
    pub fn size(&self) -> [usize; 2] {
        [self.settings.size.width as usize, self.settings.size.height as usize]
    }

    /// The linear picture.
    pub fn linear(&self, bench: &Bench) -> Result<Picture, StressError> {
        let mut renderer = Renderer::new(&bench.gpu, self.inputs())?;
        renderer.run()?;
        Ok(Picture { size: self.size(), texels: renderer.linear()? })
    }

    /// The scene, its camera, its lights and, where asked, its profile `factor` times as large.
    pub fn scaled(&self, factor: f64, with_profile: bool) -> Set {
        let mut set = self.clone();
        let f = factor as f32;
        let mut scene = (*self.scene).clone();
        scene.positions.iter_mut().flatten().for_each(|x| *x *= f);
        scene.bounds = Aabb::around(&scene.positions);
        set.scene = Arc::new(scene);
        set.camera.eye *= f;
        set.camera.near_mm *= f;
        if with_profile {
            set.profile = set.profile.map(|p| p.scaled(factor));
        }
        set
    }
}

/// A scene of triangles made in code: positions, normals, indices.
pub fn triangles(name: &str, positions: Vec<[f32; 3]>, normals: Vec<[f32; 3]>, indices: Vec<u32>) -> Scene {
    let mut material = crate::scene::Material::new(name);
    material.double_sided = true;
    Scene {
        name: name.to_owned(),
        origin: glam::DVec3::ZERO,
        bounds: Aabb::around(&positions),
        second_uvs: Vec::new(),
        colors: Vec::new(),
        draws: vec![crate::scene::Draw { material: 0, first_index: 0, index_count: indices.len() as u32 }],
        uvs: vec![[0.; 2]; positions.len()],
        positions,
        normals,
        tangents: Vec::new(),
        indices,
        materials: vec![material],
        textures: Vec::new(),
        lights: Vec::new(),
        cameras: Vec::new(),
        environment: None,
        warnings: Vec::new(),
    }
}
