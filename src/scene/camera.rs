//! Cameras: a rigid placement and a projection. View space looks down -Z with +Y up; clip space is Vulkan's, y down,
//! with depth reversed (1 near, 0 far), which keeps the relative precision of f32 at every distance.

use glam::camera::rh::proj::vulkan::perspective_infinite_reverse;
use glam::{DVec3, Mat4, Vec3};

use super::Scene;
use super::light::direction_from;

/// Near plane of a camera as a part of its distance. Reversed infinite depth loses nothing to a near plane this close.
const NEAR_PER_DISTANCE: f64 = 1e-4;
/// Room left around a framed box: the box fills at most this part of the picture.
const FRAME_FILL: f64 = 0.9;

/// A camera in the scene's space.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// Name in the file, or what made it.
    pub name: String,
    /// mm, relative to the scene's origin.
    pub eye: Vec3,
    /// Unit vector to the right of the picture.
    pub right: Vec3,
    /// Unit vector to the top of the picture.
    pub up: Vec3,
    /// Unit vector into the picture; right x up = -forward.
    pub forward: Vec3,
    /// How the view becomes a picture.
    pub projection: Projection,
    /// Distance of the near plane in mm: positive for a perspective, any number for an orthographic projection.
    pub near_mm: f32,
    /// Distance of the far plane in mm. Perspectives have none and leave this infinite.
    pub far_mm: f32,
}

/// The shape of the volume a camera sees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// A pyramid without end.
    Perspective {
        /// Vertical field of view in radians, inside 0..pi.
        fov_y: f32,
    },
    /// A box.
    Orthographic {
        /// Height of the picture in mm.
        height_mm: f32,
    },
}

impl Camera {
    /// A perspective camera at `target + distance * d`, d being the direction of yaw and pitch in degrees (see
    /// [`direction_from`]), looking at the target. `target_mm` is in *world* mm (the centre of the scene's bounding box
    /// if absent); `fov_y_deg` is the vertical field of view. The arguments must be finite, the distance positive.
    /// At pitch 90 or -90 the right of the picture is still the one that yaw gives, so nothing is undefined there.
    pub fn orbit(
        yaw_deg: f64,
        pitch_deg: f64,
        distance_mm: f64,
        target_mm: Option<DVec3>,
        fov_y_deg: f64,
        scene: &Scene,
    ) -> Self {
        let target = match target_mm {
            Some(world) => world - scene.origin,
            None => scene.bounds.center().as_dvec3(),
        };
        let back = direction_from(yaw_deg, pitch_deg);
        let (sin_yaw, cos_yaw) = yaw_deg.to_radians().sin_cos();
        let right = DVec3::new(cos_yaw, 0.0, -sin_yaw);
        Self {
            name: "orbit".to_owned(),
            eye: (target + distance_mm * back).as_vec3(),
            right: right.as_vec3(),
            up: back.cross(right).as_vec3(),
            forward: -back.as_vec3(),
            projection: Projection::Perspective { fov_y: fov_y_deg.to_radians() as f32 },
            near_mm: ((distance_mm * NEAR_PER_DISTANCE) as f32).max(f32::MIN_POSITIVE),
            far_mm: f32::INFINITY,
        }
    }

    /// A perspective camera that sees the whole bounding box from the front (+Z), or from above where the box is flat
    /// and lies; of a flat box the side that more of its surface faces. `fov_y_deg` is vertical, in degrees; `aspect` is
    /// width over height.
    pub fn default_for(scene: &Scene, fov_y_deg: f64, aspect: f64) -> Self {
        let half = scene.bounds.size().as_dvec3() / 2.0;
        let lies = half.y < 0.05 * half.x.max(half.z);
        let stands = half.z < 0.05 * half.x.max(half.y);
        let (yaw, pitch) = match (lies, stands) {
            (true, _) if faces(scene).y < 0.0 => (0.0, -60.0),
            (true, _) => (0.0, 60.0),
            (_, true) if faces(scene).z < 0.0 => (180.0, 0.0),
            _ => (0.0, 0.0),
        };
        let distance = framing_distance(half, yaw, pitch, fov_y_deg, aspect);
        let mut camera = Self::orbit(yaw, pitch, distance, None, fov_y_deg, scene);
        camera.name = "default".to_owned();
        camera
    }

    /// The same place and direction with a parallel projection, the picture `height_mm` high. Depth spans the scene.
    pub fn with_orthographic(mut self, height_mm: f32, scene: &Scene) -> Self {
        let center = (scene.bounds.center() - self.eye).dot(self.forward);
        // Never an empty range, not even for a scene of one point.
        let radius = (scene.bounds.size().length() / 2.0).max(height_mm * 0.5) * 1.01;
        self.projection = Projection::Orthographic { height_mm };
        self.near_mm = center - radius;
        self.far_mm = center + radius;
        self
    }

    /// Rigid transform from view space (looking down -Z, +Y up) to the scene's space, mm.
    pub fn world_from_view(&self) -> Mat4 {
        Mat4::from_cols(self.right.extend(0.0), self.up.extend(0.0), (-self.forward).extend(0.0), self.eye.extend(1.0))
    }

    /// Inverse of [`world_from_view`](Self::world_from_view).
    pub fn view_from_world(&self) -> Mat4 {
        // The transpose of a rotation is its inverse, without the rounding of a general one.
        let rotation =
            Mat4::from_cols(self.right.extend(0.0), self.up.extend(0.0), (-self.forward).extend(0.0), glam::Vec4::W)
                .transpose();
        rotation * Mat4::from_translation(-self.eye)
    }

    /// Projection to Vulkan's clip space, y down, depth 1 at the near plane and 0 at the far one or at infinity.
    /// `aspect` is width over height.
    pub fn clip_from_view(&self, aspect: f32) -> Mat4 {
        match self.projection {
            Projection::Perspective { fov_y } => perspective_infinite_reverse(fov_y, aspect, self.near_mm),
            Projection::Orthographic { height_mm } => {
                let depth = 1.0 / (self.far_mm - self.near_mm);
                Mat4::from_cols_array(&[
                    2.0 / (height_mm * aspect),
                    0.0,
                    0.0,
                    0.0,
                    0.0,
                    -2.0 / height_mm,
                    0.0,
                    0.0,
                    0.0,
                    0.0,
                    depth,
                    0.0,
                    0.0,
                    0.0,
                    self.far_mm * depth,
                    1.0,
                ])
            }
        }
    }
}

/// Smallest distance from the centre of a box (half sizes `half`, mm) at which all its corners are in the picture.
pub(crate) fn framing_distance(half: DVec3, yaw: f64, pitch: f64, fov_y_deg: f64, aspect: f64) -> f64 {
    let back = direction_from(yaw, pitch);
    let (sin_yaw, cos_yaw) = yaw.to_radians().sin_cos();
    let right = DVec3::new(cos_yaw, 0.0, -sin_yaw);
    let up = back.cross(right);
    let tan_y = (fov_y_deg.to_radians() / 2.0).tan() * FRAME_FILL;
    let tan_x = tan_y * aspect;
    let corners = (0..8).map(|bits| {
        let sign = |bit: i32| if bits & bit == 0 { -1.0 } else { 1.0 };
        half * DVec3::new(sign(1), sign(2), sign(4))
    });
    let distance =
        corners.map(|c| c.dot(back) + (c.dot(right).abs() / tan_x).max(c.dot(up).abs() / tan_y)).fold(0.0, f64::max);
    // A scene of one point, or none, is seen from a metre.
    if distance > 0.0 { distance } else { 1000.0 }
}

/// Twice the vector area of the drawn triangles, mm^2: where a flat surface faces.
fn faces(scene: &Scene) -> DVec3 {
    let corner = |i: u32| Vec3::from(scene.positions[i as usize]).as_dvec3();
    let vector = |t: &[u32]| (corner(t[1]) - corner(t[0])).cross(corner(t[2]) - corner(t[0]));
    scene.indices.chunks_exact(3).map(vector).sum()
}
