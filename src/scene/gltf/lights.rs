//! Lights and cameras of a file, placed by the nodes that carry them.

use glam::{DAffine3, DVec3, Vec3};

use super::json::At;
use crate::scene::camera::{Camera, Projection};
use crate::scene::error::Fault;
use crate::scene::light::{Light, LightKind};

/// A light or a camera in its own space, and the way to place it.
#[derive(Clone, Copy)]
pub(super) struct Placement {
    /// World from node, in the file's units.
    pub world: DAffine3,
    pub mm_per_unit: f64,
    /// mm.
    pub origin: DVec3,
}

impl Placement {
    fn position(&self) -> Vec3 {
        // Infinity in a file would be infinity in every picture.
        let far = DVec3::splat(f32::MAX.into());
        (self.world.translation * self.mm_per_unit - self.origin).clamp(-far, far).as_vec3()
    }

    /// A unit vector along an axis of the node, whatever its scale; `axis` itself if the scale is zero.
    fn axis(&self, axis: DVec3) -> DVec3 {
        self.world.matrix3.mul_vec3(axis).try_normalize().unwrap_or(axis)
    }
}

/// A light of KHR_lights_punctual, at its node's origin along its -Z.
pub(super) struct LightSource {
    color: [f32; 3],
    intensity: f32,
    /// In units of the file.
    range: Option<f64>,
    /// Inner and outer half angle, radians.
    cone: Option<[f64; 2]>,
    parallel: bool,
}

/// All lights of the file.
pub(super) fn read_lights(root: &At) -> Result<Vec<LightSource>, Fault> {
    match root.extension("KHR_lights_punctual")? {
        Some(extension) => extension.list("lights")?.iter().map(read_light).collect(),
        None => Ok(Vec::new()),
    }
}

fn read_light(at: &At) -> Result<LightSource, Fault> {
    let kind = at.required(at.text("type")?, "type")?;
    if !["directional", "point", "spot"].contains(&kind) {
        return Err(Fault::new(at.place("type"), format!("'{kind}' is no light; directional, point and spot are")));
    }
    let cone = if kind == "spot" {
        let spot = at.required(at.object("spot")?, "spot")?;
        let inner = spot.number("innerConeAngle")?.unwrap_or(0.0);
        let outer = spot.number("outerConeAngle")?.unwrap_or(std::f64::consts::FRAC_PI_4);
        if !(inner >= 0.0 && inner < outer && outer <= std::f64::consts::FRAC_PI_2 + 1e-6) {
            return Err(Fault::new(
                spot.path(),
                format!("angles {inner} and {outer}; 0 <= inner < outer <= pi/2 is needed"),
            ));
        }
        Some([inner, outer])
    } else {
        None
    };
    let intensity = at.number("intensity")?.unwrap_or(1.0);
    let color = at.numbers::<3>("color")?.unwrap_or([1.0; 3]);
    if intensity < 0.0 || color.iter().any(|&c| c < 0.0) {
        return Err(Fault::new(at.path(), "a light cannot be negative"));
    }
    Ok(LightSource {
        color: color.map(finite),
        intensity: finite(intensity),
        range: at.number("range")?.filter(|&range| range > 0.0),
        cone,
        parallel: kind == "directional",
    })
}

/// A number as f32, the largest one instead of infinity.
fn finite(value: f64) -> f32 {
    (value as f32).clamp(-f32::MAX, f32::MAX)
}

impl LightSource {
    pub fn place(&self, place: &Placement) -> Light {
        let position = place.position();
        let axis = place.axis(DVec3::NEG_Z);
        let kind = match self.cone {
            _ if self.parallel => LightKind::Directional { direction: -axis.as_vec3() },
            Some([inner, outer]) => LightKind::Spot {
                position,
                direction: axis.as_vec3(),
                inner_cos: inner.cos() as f32,
                // Beyond a right angle by rounding only.
                outer_cos: outer.cos().max(0.0) as f32,
            },
            None => LightKind::Point { position },
        };
        Light {
            kind,
            color: self.color,
            intensity: self.intensity,
            range_mm: self.range.map(|range| finite(range * place.mm_per_unit)),
        }
    }
}

/// A camera of the file, looking along its node's -Z; lengths in units of the file.
pub(super) struct CameraSource {
    name: String,
    /// Vertical field of view, radians, or half the height of the picture.
    fov_y: Option<f64>,
    half_height: f64,
    near: f64,
    far: f64,
}

/// All cameras of the file.
pub(super) fn read_cameras(root: &At) -> Result<Vec<CameraSource>, Fault> {
    root.list("cameras")?.iter().map(read_camera).collect()
}

fn read_camera(at: &At) -> Result<CameraSource, Fault> {
    let kind = at.required(at.text("type")?, "type")?;
    let perspective = match kind {
        "perspective" => true,
        "orthographic" => false,
        other => {
            return Err(Fault::new(
                at.place("type"),
                format!("'{other}' is no camera; perspective and orthographic are"),
            ));
        }
    };
    let of = at.required(at.object(kind)?, kind)?;
    let number = |key: &str| of.required(of.number(key)?, key);
    let near = number("znear")?;
    let (fov_y, half_height, far) = if perspective {
        (Some(number("yfov")?), 0.0, f64::INFINITY)
    } else {
        (None, number("ymag")?.abs(), number("zfar")?)
    };
    let sound = match fov_y {
        Some(fov) => near > 0.0 && fov > 0.0 && fov < std::f64::consts::PI,
        None => far > near && half_height > 0.0,
    };
    if !sound {
        return Err(Fault::new(of.path(), "it sees nothing: znear < zfar, 0 < yfov < pi and ymag > 0 are needed"));
    }
    Ok(CameraSource { name: at.text("name")?.unwrap_or_default().to_owned(), fov_y, half_height, near, far })
}

impl CameraSource {
    /// `node` names the camera if the file does not.
    pub fn place(&self, place: &Placement, node: &str) -> Camera {
        // A camera is rigid: its node's scale and shear are dropped, the direction of view being kept.
        let back = place.axis(DVec3::Z);
        let up = place.axis(DVec3::Y);
        let right = up.cross(back);
        let right = right.try_normalize().unwrap_or_else(|| back.any_orthonormal_vector());
        let mm = place.mm_per_unit;
        Camera {
            name: if self.name.is_empty() { node } else { &self.name }.to_owned(),
            eye: place.position(),
            right: right.as_vec3(),
            up: back.cross(right).as_vec3(),
            forward: -back.as_vec3(),
            projection: match self.fov_y {
                Some(fov_y) => Projection::Perspective { fov_y: fov_y as f32 },
                None => Projection::Orthographic { height_mm: finite(2.0 * self.half_height * mm) },
            },
            near_mm: match self.fov_y {
                Some(_) => finite(self.near * mm).max(f32::MIN_POSITIVE),
                None => finite(self.near * mm),
            },
            far_mm: (self.far * mm) as f32,
        }
    }
}
