//! What the shaders read of the eye, the lights and the profile: all that another view of the same scene changes.

use super::Inputs;
use super::brightness::light_unit;
use super::setup::Setup;
use super::uniforms::{FrameBlock, LightBlock, MAX_LEVELS};

/// The content of the constant buffers of a profile.
pub struct Constants {
    /// `FrameBlock`.
    pub frame: FrameBlock,
    /// Rows of `methods::kernel`.
    pub kernel: Vec<[f32; 4]>,
}

impl Constants {
    /// Of these inputs; `lut_knee` is the table's, 1/mm; `sky` the most irradiance that comes from all around.
    pub fn of(inputs: &Inputs<'_>, s: &Setup, lut_knee: f32, sky: f32) -> Constants {
        Constants {
            frame: frame_block(inputs, s, lut_knee, sky),
            kernel: s.kernel.iter().map(|row| row.map(|x| x as f32)).collect(),
        }
    }
}

/// The lights, and from the scene's space to each shadow layer's clip space.
pub fn lights_of(inputs: &Inputs<'_>, s: &Setup) -> (LightBlock, Vec<[[f32; 4]; 4]>) {
    let view = inputs.camera.view_from_world();
    let world = inputs.camera.world_from_view();
    let mut lights: LightBlock = bytemuck::Zeroable::zeroed();
    for (entry, (i, light)) in lights.light.iter_mut().zip(inputs.lights.iter().enumerate()) {
        *entry = s.shadows.entry(i, light, view);
    }
    for (matrix, m) in lights.shadow_from_view.iter_mut().zip(&s.shadows.matrices) {
        *matrix = (*m * world).to_cols_array_2d();
    }
    (lights, s.shadows.matrices.iter().map(|m| m.to_cols_array_2d()).collect())
}

fn frame_block(inputs: &Inputs<'_>, s: &Setup, lut_knee: f32, sky: f32) -> FrameBlock {
    let camera = &inputs.camera;
    let view = camera.view_from_world();
    let aspect = s.size[0] as f32 / s.size[1] as f32;
    let settings = &s.settings;
    let (up, down) = (settings.ambient.up, settings.ambient.down);
    let mut block: FrameBlock = bytemuck::Zeroable::zeroed();
    block.clip_from_world = (camera.clip_from_view(aspect) * view).to_cols_array_2d();
    block.view_from_world = view.to_cols_array_2d();
    block.world_from_view = camera.world_from_view().to_cols_array_2d();
    block.ray_scale = s.view.ray_scale.map(|x| x as f32);
    block.ray_offset = s.view.ray_offset.map(|x| x as f32);
    block.size = s.size.map(|x| x as i32);
    block.perspective = s.view.perspective;
    block.pixels_per_mm = s.view.pixels_per_mm as f32;
    block.origin = inputs.scene.origin.as_vec3().to_array();
    block.light_unit = light_unit(&inputs.lights, sky, &inputs.scene.positions, &inputs.scene.bounds);
    block.ambient_mean = std::array::from_fn(|c| (up[c] + down[c]) / 2.);
    block.ambient_slope = std::array::from_fn(|c| (up[c] - down[c]) / 2.);
    block.exposure = settings.exposure.unwrap_or(0.).exp2();
    block.length_mm = s.levels.length_mm as f32;
    block.up = view.transform_vector3(glam::Vec3::Y).to_array();
    block.lut_knee = lut_knee;
    let four = |v: [f64; 3], w: f64| [v[0] as f32, v[1] as f32, v[2] as f32, w as f32];
    block.share[0] = four(s.levels.sharp, 0.);
    block.sharp = four(s.levels.sharp, s.levels.narrow_mm);
    for (i, level) in s.levels.levels.iter().enumerate().take(MAX_LEVELS) {
        block.level[i] = four(level.weight, level.variance);
        block.share[i + 1] = four(level.share, 0.);
        // Curvature of a patch is known over a couple of sigma: that far it may occlude.
        let radius = crate::skin::occlusion::RADIUS_SIGMAS * level.variance.sqrt();
        block.occlusion[i] = [(radius / s.levels.length_mm) as f32, 1., 0., 0.];
    }
    block
}
