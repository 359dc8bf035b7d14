//! Which lights cast shadows, and the matrices they are cast by.

use super::Inputs;
use super::uniforms::{LightEntry, MAX_LAYERS};
use crate::scene::{Aabb, Light, LightKind};
use crate::settings::{Method, Quality, Settings, Spared};
use glam::camera::rh::proj::vulkan::perspective_infinite_reverse;
use glam::{Mat4, Vec3, Vec4};

/// Channels of the visibility target: a light has one, or shares it with others of its colour.
pub const MAX_SLOTS: usize = 2;

/// Shadow maps of a frame.
#[derive(Clone, Debug, Default)]
pub struct Shadows {
    /// One a layer, from the scene's space to the layer's clip space, depth reversed.
    pub matrices: Vec<Mat4>,
    /// Texels on a side.
    pub size: u32,
    /// Channels of scattered visibility in use.
    pub slots: usize,
    /// Why there are none.
    pub why_none: &'static str,
    lights: Vec<Cast>,
    /// Lights beyond [`MAX_LAYERS`]: they shine through.
    pub beyond: usize,
    /// Lights without a map, for they reach nothing.
    pub far: usize,
}

/// A light's place among the maps.
#[derive(Clone, Copy, Debug)]
struct Cast {
    /// Its first layer, -1 none.
    layer: i32,
    texel_mm: f32,
    /// -1 none.
    slot: i32,
    /// Of the light of its slot.
    part: f32,
}

/// Root of 1/6 + 1/16: the same threshold as in `glsl/common/shadow.glsl`. A texel of a light at a place is so much per mm of distance, and
/// passes always: its pixels decide.
const SOFT_TEXELS: f64 = 0.4787;

const CASTS_NONE: Cast = Cast { layer: -1, texel_mm: 0., slot: -1, part: 1. };

impl Shadows {
    /// Decides layers and fits their matrices to what can cast.
    pub fn new(inputs: &Inputs<'_>) -> Shadows {
        let size = match inputs.settings.quality {
            Quality::Low => 1024,
            Quality::Medium | Quality::High => 2048,
            Quality::Ultra => 4096,
        };
        let mut s = Shadows { size, lights: vec![CASTS_NONE; inputs.lights.len()], ..Shadows::default() };
        if inputs.settings.no_shadows {
            s.why_none = "shadows are off";
            return s;
        }
        if inputs.lights.is_empty() {
            s.why_none = "there is no light";
            return s;
        }
        if inputs.scene.indices.is_empty() {
            s.why_none = "nothing casts";
            return s;
        }
        let on = |(_, l): &(usize, &Light)| l.intensity > 0. && l.color.iter().any(|c| *c > 0.);
        let (near, far): (Vec<_>, Vec<_>) =
            inputs.lights.iter().enumerate().filter(on).partition(|(_, l)| reaches(l, &inputs.scene.bounds));
        let idle =
            if spares(&inputs.settings).is_some_and(|s| inputs.settings.brings_back(s)) { &far[..] } else { &[] };
        s.far = far.len() - idle.len();
        // Exitance is linear in light, so lights of one colour are scattered as one. `pdss` asks how much of one light is left.
        let share = inputs.settings.method == Method::Moments;
        let mut leaders: Vec<&Light> = Vec::new();
        for (place, (i, light)) in near.iter().chain(idle).copied().enumerate() {
            let (matrices, texel) = cast(light, &inputs.scene.positions, size);
            if s.matrices.len() + matrices.len() > MAX_LAYERS {
                s.beyond += 1;
                continue;
            }
            let slot = if place >= near.len() {
                None
            } else if leaders.len() < MAX_SLOTS {
                leaders.push(light);
                Some(leaders.len() - 1)
            } else {
                leaders.iter().rposition(|l| share && scatters_as(l, light))
            };
            let slot = slot.map_or(-1, |slot| slot as i32);
            s.lights[i] = Cast { layer: s.matrices.len() as i32, texel_mm: texel, slot, part: 1. };
            s.matrices.extend(matrices);
        }
        s.slots = leaders.len();
        for slot in 0..s.slots as i32 {
            let of_slot = |c: &Cast| c.slot == slot;
            let all =
                s.lights.iter().zip(&inputs.lights).filter(|(c, _)| of_slot(c)).map(|(_, l)| strength(l)).sum::<f32>();
            for (cast, light) in s.lights.iter_mut().zip(&inputs.lights).filter(|(c, _)| of_slot(c)) {
                // Alone it is 1 to the bit.
                cast.part = strength(light) / all;
            }
        }
        if s.matrices.is_empty() {
            s.why_none = if s.far > 0 { "no light reaches anything" } else { "no light is on" };
        }
        s
    }

    /// Nobody scatters visibility.
    pub fn without_slots(&mut self) {
        self.slots = 0;
        self.lights.iter_mut().for_each(|l| (l.slot, l.part) = (-1, 1.));
    }

    /// The widest texel (mm) of the lights with a slot, where every such light is directional: a light at a place does not
    /// give each texel the same flux.
    pub fn gatherable(&self, lights: &[Light]) -> Option<f32> {
        let slotted = || self.lights.iter().zip(lights).filter(|(l, _)| l.slot >= 0);
        let parallel = slotted().all(|(_, light)| matches!(light.kind, LightKind::Directional { .. }));
        slotted().map(|(l, _)| l.texel_mm).reduce(f32::max).filter(|_| parallel)
    }

    /// Whether light that scatters so far (mm) softens the edges of some light's shadows more than a texel does.
    pub fn softened(&self, narrow_mm: f64) -> bool {
        self.lights.iter().filter(|l| l.layer >= 0).any(|l| narrow_mm > SOFT_TEXELS * f64::from(l.texel_mm))
    }

    /// Some light without a slot casts a shadow: lighting must look it up.
    pub fn look_up(&self) -> bool {
        self.lights.iter().any(|l| l.layer >= 0 && l.slot < 0)
    }

    /// Lights whose visibility is scattered.
    pub fn scattered(&self) -> usize {
        self.lights.iter().filter(|l| l.slot >= 0).count()
    }

    /// Some of them have a slot together.
    pub fn shared(&self) -> bool {
        self.scattered() > self.slots
    }

    /// Layers up to the last of a light with a slot.
    pub fn slotted_layers(&self) -> u32 {
        self.lights.iter().filter(|l| l.slot >= 0).map(|l| l.layer + 1).max().unwrap_or(0) as u32
    }

    /// A light as the shaders see it.
    pub fn entry(&self, index: usize, light: &Light, view_from_world: Mat4) -> LightEntry {
        let Cast { layer, texel_mm, slot, part } = self.lights.get(index).copied().unwrap_or(CASTS_NONE);
        let rotate = |v: Vec3| view_from_world.transform_vector3(v).to_array();
        let place = |v: Vec3| view_from_world.transform_point3(v).to_array();
        let (position, kind, axis, inner_cos, outer_cos) = match light.kind {
            LightKind::Directional { direction } => (rotate(direction), 0, [0.; 3], 0., 0.),
            LightKind::Point { position } => (place(position), 1, [0.; 3], 0., 0.),
            LightKind::Spot { position, direction, inner_cos, outer_cos } => {
                (place(position), 2, rotate(direction), inner_cos, outer_cos)
            }
        };
        LightEntry {
            position,
            kind,
            color: light.color.map(|c| c * light.intensity),
            range_mm: light.range_mm.unwrap_or(0.),
            axis,
            inner_cos,
            outer_cos,
            layer,
            texel_mm,
            slot,
            part,
        }
    }
}

/// Two parallel lights of one colour.
fn scatters_as(a: &Light, b: &Light) -> bool {
    let parallel = |l: &Light| matches!(l.kind, LightKind::Directional { .. });
    let (p, q) = (Vec3::from(a.color), Vec3::from(b.color));
    parallel(a) && parallel(b) && p.cross(q).length() <= 1e-3 * p.length() * q.length()
}

fn strength(light: &Light) -> f32 {
    light.intensity * Vec3::from(light.color).length()
}

/// What brings the maps of lights that reach nothing back. What went through from the side of one, `texture-space` takes from all
/// lights' irradiance: it would find some.
pub fn spares(settings: &Settings) -> Option<Spared> {
    (settings.method != Method::TextureSpace).then_some(Spared::Shadow)
}

/// Whether any of its light falls on anything in the box: lights of a range end there, and spots at their cone.
fn reaches(light: &Light, bounds: &Aabb) -> bool {
    let nearest = |p: Vec3| p.clamp(bounds.min, bounds.max);
    let within = |p: Vec3| light.range_mm.is_none_or(|range| (nearest(p) - p).length() < range);
    match light.kind {
        LightKind::Directional { .. } => true,
        LightKind::Point { position } => within(position),
        LightKind::Spot { position, direction, outer_cos, .. } => {
            // The sphere around the box, against the cone.
            let (to, radius) = (bounds.center() - position, bounds.size().length() / 2.);
            let distance = to.length();
            let beside = || to.angle_between(direction) <= outer_cos.acos() + (radius / distance).asin();
            within(position) && (distance <= radius || beside())
        }
    }
}

/// The layers of one light, and what a texel covers: mm for a parallel light, mm per mm of distance for the others.
fn cast(light: &Light, positions: &[[f32; 3]], size: u32) -> (Vec<Mat4>, f32) {
    match light.kind {
        LightKind::Directional { direction } => {
            let (matrix, texel) = parallel(direction, positions, size);
            (vec![matrix], texel)
        }
        LightKind::Point { position } => {
            // A little more than a right angle, so that the filter finds its neighbours at the seams.
            let fov = 92f32.to_radians();
            let axes = [Vec3::X, -Vec3::X, Vec3::Y, -Vec3::Y, Vec3::Z, -Vec3::Z];
            let near = nearest(position, positions);
            let matrices = axes.iter().map(|axis| looking(position, *axis, fov, near)).collect();
            (matrices, 2. * (fov / 2.).tan() / size as f32)
        }
        LightKind::Spot { position, direction, outer_cos, .. } => {
            let fov = (2f32 * outer_cos.clamp(-0.98, 0.9999).acos() * 1.02).min(2.8);
            let near = nearest(position, positions);
            (vec![looking(position, direction, fov, near)], 2. * (fov / 2.).tan() / size as f32)
        }
    }
}

/// A near plane just before the nearest vertex; with reversed infinite depth its place costs no precision.
fn nearest(from: Vec3, positions: &[[f32; 3]]) -> f32 {
    let square = positions.iter().map(|p| (Vec3::from(*p) - from).length_squared()).fold(f32::INFINITY, f32::min);
    // A face can be nearer than its vertices; a tenth is safe, and costs nothing.
    (square.sqrt() * 0.1).max(1e-3)
}

fn looking(position: Vec3, direction: Vec3, fov: f32, near: f32) -> Mat4 {
    let up = if direction.y.abs() > 0.9 { Vec3::X } else { Vec3::Y };
    let view = glam::camera::rh::view::look_to_mat4(position, direction, up);
    perspective_infinite_reverse(fov, 1., near) * view
}

/// A box around everything that casts, as the light sees it. It follows the scene, not the camera, so nothing swims.
fn parallel(direction: Vec3, positions: &[[f32; 3]], size: u32) -> (Mat4, f32) {
    let (right, up) = direction.any_orthonormal_pair();
    let (mut min, mut max) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for p in positions {
        let p = Vec3::from(*p);
        let q = Vec3::new(p.dot(right), p.dot(up), p.dot(direction));
        min = min.min(q);
        max = max.max(q);
    }
    // Room for the filter at the border, and an extent even for a flat scene.
    let extent = (max - min).max(Vec3::splat((max - min).max_element().max(f32::MIN_POSITIVE) * 1e-3));
    let middle = (min + max) / 2.;
    let half = extent / 2. * (1. + 8. / size as f32);
    let row = |axis: Vec3, centre: f32, half: f32| (axis / half).extend(-centre / half);
    let (x, y) = (row(right, middle.x, half.x), row(up, middle.y, half.y));
    let d = row(direction, middle.z, half.z);
    let z = Vec4::new(d.x, d.y, d.z, d.w + 1.) * 0.5;
    let texel = 2. * half.x.max(half.y) / size as f32;
    (Mat4::from_cols(x, y, z, Vec4::W).transpose(), texel)
}
