//! What crosses to the shaders, in scalar layout. GLSL twins: `glsl/common/frame.glsl`, `glsl/common/lights.glsl`, the push
//! blocks of the stages; `tests/layout.rs` compares every member's offset with the compiled SPIR-V.

use bytemuck::{Pod, Zeroable};

/// Most levels that lighting reads.
pub const MAX_LEVELS: usize = 6;
/// Most lights: what 16 KiB of uniform block, the least that every device has, hold beside the shadow matrices.
pub const MAX_LIGHTS: usize = 128;
/// Most profiles: what the lowest bits of a `viewz` tell apart (`glsl/common/profile_code.glsl`).
pub const MAX_PROFILES: usize = 8;
/// Most layers of shadow maps: a point light takes six.
pub const MAX_LAYERS: usize = 16;

/// The block `FrameBlock`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[allow(missing_docs, reason = "each member is documented at its twin in glsl/common/frame.glsl")]
pub struct FrameBlock {
    pub clip_from_world: [[f32; 4]; 4],
    pub view_from_world: [[f32; 4]; 4],
    pub world_from_view: [[f32; 4]; 4],
    pub ray_scale: [f32; 2],
    pub ray_offset: [f32; 2],
    pub size: [i32; 2],
    pub perspective: f32,
    pub pixels_per_mm: f32,
    pub origin: [f32; 3],
    pub light_unit: f32,
    pub ambient_mean: [f32; 3],
    pub exposure: f32,
    pub ambient_slope: [f32; 3],
    pub length_mm: f32,
    pub up: [f32; 3],
    pub lut_knee: f32,
    pub level: [[f32; 4]; MAX_LEVELS],
    pub share: [[f32; 4]; MAX_LEVELS + 1],
    pub occlusion: [[f32; 4]; MAX_LEVELS],
    pub sharp: [f32; 4],
}

/// One element of `LightBlock`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[allow(missing_docs, reason = "each member is documented at its twin in glsl/common/lights.glsl")]
pub struct LightEntry {
    pub position: [f32; 3],
    pub kind: i32,
    pub color: [f32; 3],
    pub range_mm: f32,
    pub axis: [f32; 3],
    pub inner_cos: f32,
    pub outer_cos: f32,
    pub layer: i32,
    pub texel_mm: f32,
    pub slot: i32,
    pub part: f32,
}

/// The block `LightBlock`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[allow(missing_docs, reason = "each member is documented at its twin in glsl/common/lights.glsl")]
pub struct LightBlock {
    pub shadow_from_view: [[[f32; 4]; 4]; MAX_LAYERS],
    pub light: [LightEntry; MAX_LIGHTS],
}

/// The block `EnvironmentBlock`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[allow(missing_docs, reason = "each member is documented at its twin in glsl/common/environment.glsl")]
pub struct EnvironmentBlock {
    pub sky_from_view: [[f32; 3]; 3],
    pub intensity: f32,
    pub first: f32,
    pub last: f32,
    pub blur: f32,
    pub knee: f32,
    pub harmonic: [[f32; 3]; 9],
}

/// Push constants of `gbuffer.frag`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[allow(missing_docs, reason = "each member is documented at its twin in glsl/gbuffer.frag")]
pub struct MaterialPush {
    pub base_color: [f32; 4],
    pub roughness: f32,
    pub metallic: f32,
    pub normal_scale: f32,
    pub occlusion_strength: f32,
    pub alpha_cutoff: f32,
    pub reflectance: f32,
    pub bare: f32,
    pub scatter: f32,
    pub emission: [f32; 3],
    pub thickness: f32,
    pub sheen: [f32; 3],
    pub sheen_roughness: f32,
    pub specular_tint: [f32; 3],
    pub specular: f32,
    pub coat: f32,
    pub coat_roughness: f32,
    pub profile: u32,
}

/// Push constants of a pass that draws what does not scatter.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct InertPush {
    /// Of the shadow maps.
    pub layer: u32,
    /// From the texels of the small map to those that are kept of the large one, in clip space.
    pub shift: f32,
}
