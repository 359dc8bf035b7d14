//! The standard set, as data: what methods are compared on unless told otherwise.

use crate::frame::{Inputs, Output};
use crate::scene::{Camera, Light, LoadOptions, Scene, SceneError, framing_distance};
use crate::settings::{Settings, Size};
use crate::skin::profile::Profile;
use glam::{DMat3, DVec3};
use std::path::Path;

/// Vertical field of view, degrees, of cameras that no file brings.
const FOV: f64 = 30.;
/// Irradiance at normal incidence sums to about one, so that errors are parts of full light: yaw, pitch, irradiance.
const KEY_AND_FILL: [(f64, f64, f64); 2] = [(60., 25., 1.), (-70., 10., 0.2)];

/// How a base shape is changed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Form {
    /// It is not.
    Plain,
    /// Waves on a torus of this ring radius, along its normals: height mm, whole waves around its axis and around its tube.
    Bumps {
        /// mm.
        ring_mm: f64,
        /// mm.
        height_mm: f64,
        /// Whole numbers.
        waves: [f64; 2],
    },
    /// z moves by x^2 times this, 1/mm.
    Bend(f64),
}

/// Where the camera stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stand {
    /// The file's first camera, else one that sees everything.
    Own,
    /// Yaw and pitch in degrees; as far as frames the whole box, times this.
    Around(f64, f64, f64),
}

/// What lights a scene.
#[derive(Clone, Debug, PartialEq)]
pub enum Lit {
    /// A key and a fill.
    KeyAndFill,
    /// The file's own, else a key and a fill.
    Own,
    /// So many from all around, their irradiances one in sum.
    Ring(usize),
    /// These.
    These(Vec<Light>),
}

/// A scene as it is to be built.
#[derive(Clone, Debug, PartialEq)]
pub struct Spec {
    /// What it is called in results.
    pub name: String,
    /// What it shows of methods.
    pub why: &'static str,
    /// A file or a shape.
    pub base: String,
    /// Its change.
    pub form: Form,
    /// Camera.
    pub stand: Stand,
    /// Lights.
    pub lit: Lit,
    /// Parts of the picture's width that the camera looks past the middle.
    pub aside: f64,
    /// The picture's sides as parts of the size asked for.
    pub scale: f64,
    /// What is swept, and its value.
    pub sweep: Option<(&'static str, f64)>,
}

impl Spec {
    /// A scene given on the command line, with its own camera and lights.
    pub fn given(base: &str) -> Spec {
        let stem = Path::new(base).file_stem().map_or(base.into(), |s| s.to_string_lossy());
        let name = if base.starts_with("shape:") { base } else { &stem };
        spec(name, "given", base, Form::Plain, Stand::Own, Lit::Own)
    }
}

fn spec(name: &str, why: &'static str, base: &str, form: Form, stand: Stand, lit: Lit) -> Spec {
    Spec { name: name.to_owned(), why, base: base.to_owned(), form, stand, lit, aside: 0., scale: 1., sweep: None }
}

/// The standard set; `bust` is what is drawn where no scene is named.
pub fn standard(bust: &str) -> Vec<Spec> {
    let bumps = Form::Bumps { ring_mm: 12., height_mm: 0.25, waves: [24., 12.] };
    let torus = "shape:torus:10,4";
    let (around, key) = (Stand::Around(30., 35., 1.), Lit::KeyAndFill);
    vec![
        spec("sphere", "one curvature, no cast shadow", "shape:sphere:8", Form::Plain, around, key.clone()),
        spec("torus", "stiff: as small as light travels; hidden parts", torus, Form::Plain, around, key.clone()),
        spec("bust", "a whole object with cast shadows", bust, Form::Plain, Stand::Own, key.clone()),
        spec("bumpy-torus", "relief finer than light travels", "shape:torus:12,5", bumps, around, key.clone()),
        spec(
            "thin-sheet",
            "an ear: the other side is near",
            "shape:ellipsoid:14,22,1.2",
            Form::Bend(0.02),
            Stand::Around(35., 10., 1.),
            key.clone(),
        ),
        spec("many-lights", "what a method pays per light", torus, Form::Plain, around, Lit::Ring(8)),
        spec(
            "mostly-empty",
            "what a method pays for pixels without a surface",
            torus,
            Form::Plain,
            Stand::Around(30., 35., 5.),
            key,
        ),
    ]
}

/// A scene, built, with everything that it is seen by.
pub struct Subject {
    /// How it was asked for.
    pub spec: Spec,
    /// What is drawn.
    pub scene: Scene,
    /// The eye.
    pub camera: Camera,
    /// The lights.
    pub lights: Vec<Light>,
    /// What scatters.
    pub profile: Profile,
    /// The picture that is timed.
    pub size: Size,
}

impl Subject {
    /// Loads and places. `material` is the one that scatters; none: every opaque dielectric.
    ///
    /// # Errors
    /// Those of the scene.
    pub fn build(
        spec: &Spec,
        profile: &Profile,
        material: Option<&str>,
        mm_per_unit: Option<f64>,
        size: Size,
    ) -> Result<Subject, SceneError> {
        // Methods that work in texture space need coordinates even where nothing is textured.
        let mut scene = Scene::open(&spec.base, &LoadOptions { mm_per_unit, keep_uvs: true, pose: None })?;
        match spec.form {
            Form::Plain => {}
            Form::Bumps { ring_mm, height_mm, waves } => deform(&mut scene, |p| bumps(p, ring_mm, height_mm, waves)),
            Form::Bend(per_mm) => deform(&mut scene, |p| p + DVec3::Z * (per_mm * p.x * p.x)),
        }
        scene.assign_profile(material, 0)?;
        let scaled = |n: u32| ((f64::from(n) * spec.scale).round() as u32).max(1);
        let size = Size { width: scaled(size.width), height: scaled(size.height) };
        let aspect = f64::from(size.width) / f64::from(size.height);
        let mut camera = match (spec.stand, scene.cameras.first()) {
            (Stand::Own, Some(camera)) => camera.clone(),
            (Stand::Own, None) => Camera::default_for(&scene, FOV, aspect),
            (Stand::Around(yaw, pitch, times), _) => {
                let half = scene.bounds.size().as_dvec3() / 2.;
                let distance = framing_distance(half, yaw, pitch, FOV, aspect) * times;
                Camera::orbit(yaw, pitch, distance, None, FOV, &scene)
            }
        };
        let distance = (scene.bounds.center() - camera.eye).dot(camera.forward);
        let width_mm = 2. * f64::from(distance) * (FOV / 2.).to_radians().tan() * aspect;
        camera.eye += camera.right * (spec.aside * width_mm) as f32;
        let lights = match &spec.lit {
            Lit::These(lights) => lights.clone(),
            Lit::Own if !scene.lights.is_empty() => scene.lights.clone(),
            Lit::Own | Lit::KeyAndFill => {
                KEY_AND_FILL.map(|(yaw, pitch, size)| Light::directional(yaw, pitch, size as f32)).to_vec()
            }
            Lit::Ring(n) => ring(*n),
        };
        Ok(Subject { spec: spec.clone(), scene, camera, lights, profile: profile.clone(), size })
    }

    /// The engine's inputs for these settings.
    pub fn inputs(&self, settings: Settings, output: Output) -> Inputs<'_> {
        Inputs {
            scene: &self.scene,
            camera: self.camera.clone(),
            lights: self.lights.clone(),
            profiles: vec![self.profile.clone()],
            settings,
            timing: None,
            output,
        }
    }
}

/// Directional lights all around, by the golden angle so that none is opposite another; the first is the key's.
fn ring(n: usize) -> Vec<Light> {
    let light = |i: usize| {
        let (yaw, pitch) = (60. + 137.507_764 * i as f64, 25. + 20. * (1.7 * i as f64).sin());
        Light::directional(yaw, pitch, 1. / n as f32)
    };
    (0..n).map(light).collect()
}

/// A point of a torus around +Y moved along its normal.
fn bumps(p: DVec3, ring_mm: f64, height_mm: f64, [around, about]: [f64; 2]) -> DVec3 {
    let out = DVec3::new(p.x, 0., p.z).normalize_or_zero();
    let from_ring = p - out * ring_mm;
    let (s, t) = (p.x.atan2(p.z), from_ring.y.atan2(from_ring.dot(out)));
    p + from_ring.normalize_or_zero() * (height_mm * (around * s).sin() * (about * t).sin())
}

/// Moves every vertex, and turns its normal by the map's cofactors.
fn deform(scene: &mut Scene, map: impl Fn(DVec3) -> DVec3) {
    // Far above f64's rounding at these sizes, far below what bends.
    const STEP_MM: f64 = 1e-4;
    for (position, normal) in scene.positions.iter_mut().zip(&mut scene.normals) {
        let p = DVec3::from_array(position.map(f64::from));
        let slope = |axis: DVec3| (map(p + axis * STEP_MM) - map(p - axis * STEP_MM)) / (2. * STEP_MM);
        let j = DMat3::from_cols(slope(DVec3::X), slope(DVec3::Y), slope(DVec3::Z));
        let cofactors = DMat3::from_cols(j.y_axis.cross(j.z_axis), j.z_axis.cross(j.x_axis), j.x_axis.cross(j.y_axis));
        let n = cofactors * DVec3::from_array(normal.map(f64::from));
        *normal = n.normalize_or(DVec3::Y).as_vec3().to_array();
        *position = map(p).as_vec3().to_array();
    }
    scene.bounds = crate::scene::Aabb::around(&scene.positions);
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use std::collections::HashMap;

    /// The greatest angle, degrees, between a vertex normal and the mean of the facets around it.
    fn worst_angle(scene: &Scene) -> f64 {
        let at = |i: u32| Vec3::from(scene.positions[i as usize]).as_dvec3();
        // Vertices of one place share their facets, so that a seam has both sides.
        let place = |i: u32| scene.positions[i as usize].map(f32::to_bits);
        let mut sums: HashMap<[u32; 3], DVec3> = HashMap::new();
        for t in scene.indices.chunks_exact(3) {
            let cross = (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0]));
            t.iter().for_each(|i| *sums.entry(place(*i)).or_default() += cross);
        }
        let angle = |i: u32| {
            let normal = Vec3::from(scene.normals[i as usize]).as_dvec3();
            sums.get(&place(i)).map_or(180., |sum| sum.angle_between(normal).to_degrees())
        };
        scene.indices.iter().map(|i| angle(*i)).fold(0., f64::max)
    }

    #[test]
    fn a_deformed_surface_has_the_normals_of_its_facets() -> Result<(), Box<dyn std::error::Error>> {
        let profile = Profile::resolve("skin")?;
        for spec in standard("shape:sphere:60").iter().filter(|s| s.form != Form::Plain) {
            let mut subject = Subject::build(spec, &profile, None, None, Size { width: 64, height: 48 })?;
            let angle = worst_angle(&subject.scene);
            println!("{}: {angle:.3} degrees", spec.name);
            // A bump's wave spans thirteen triangles, a corner of the sheet's grid ends in three of unlike size.
            assert!(angle < 4., "{}: {angle}", spec.name);
            // The twin: the base's own normals on the moved surface.
            subject.scene.normals = Scene::shape(&spec.base)?.normals;
            assert!(worst_angle(&subject.scene) > 20., "{}", spec.name);
        }
        Ok(())
    }

    #[test]
    fn names_are_unique_and_the_set_is_whole() {
        let set = standard("shape:sphere:60");
        let mut names: Vec<&str> = set.iter().map(|s| s.name.as_str()).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), 7);
        assert_eq!(ring(5).iter().map(|l| l.intensity).sum::<f32>(), 1.);
    }
}
