//! Lights. Units are relative: a directional light's intensity is its irradiance at normal incidence, and a point or
//! spot light of intensity I gives I / d^2 at d *metres*, so that glTF's lux and candela are used as they stand.

use glam::{DVec3, Vec3};

/// One light of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// Where it is and how it points.
    pub kind: LightKind,
    /// Linear RGB, usually 0..1.
    pub color: [f32; 3],
    /// Irradiance at normal incidence (directional), or irradiance at one metre (point, spot). At least 0.
    pub intensity: f32,
    /// Distance in mm at which a point or spot light has faded to nothing; `None` never fades beyond its square law.
    pub range_mm: Option<f32>,
}

/// A light's place and direction, in world axes, positions relative to the scene's origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightKind {
    /// Parallel light.
    Directional {
        /// Unit vector towards the light: the direction it comes *from*.
        direction: Vec3,
    },
    /// Light from one point, the same in all directions.
    Point {
        /// mm, relative to the scene's origin.
        position: Vec3,
    },
    /// A cone of light; full inside the inner angle, smooth to zero at the outer.
    Spot {
        /// mm, relative to the scene's origin.
        position: Vec3,
        /// Unit axis of the cone, pointing *away* from the light.
        direction: Vec3,
        /// Cosine of the inner half angle, greater than `outer_cos`.
        inner_cos: f32,
        /// Cosine of the outer half angle, 0..1.
        outer_cos: f32,
    },
}

impl Light {
    /// A white directional light that shines from yaw and pitch (degrees, see [`direction_from`]); `intensity` is the
    /// irradiance at normal incidence.
    pub fn directional(yaw_deg: f64, pitch_deg: f64, intensity: f32) -> Self {
        Self {
            kind: LightKind::Directional { direction: direction_from(yaw_deg, pitch_deg).as_vec3() },
            color: [1.0; 3],
            intensity,
            range_mm: None,
        }
    }
}

/// The unit direction that yaw and pitch (degrees) name: (sin yaw cos pitch, sin pitch, cos yaw cos pitch). Zero, zero
/// is +Z, the viewer in front; pitch 90 is +Y.
pub fn direction_from(yaw_deg: f64, pitch_deg: f64) -> DVec3 {
    let (sin_yaw, cos_yaw) = yaw_deg.to_radians().sin_cos();
    let (sin_pitch, cos_pitch) = pitch_deg.to_radians().sin_cos();
    DVec3::new(sin_yaw * cos_pitch, sin_pitch, cos_yaw * cos_pitch)
}
