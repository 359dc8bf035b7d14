//! gbuffer: meshes -> depth, viewz, normal, albedo, material, and bumped where the scene has a normal map.

use crate::frame::setup::Setup;
use crate::gpu::pipeline::Raster;
use crate::plan::{Geometry, Plan};
use crate::shaders::{self, Shader};
use crate::targets;
use ash::vk;

/// Adds the pass.
pub fn add(plan: &mut Plan, s: &Setup) {
    let mut colors = vec!["viewz", "normal", "albedo", "material"];
    if s.atlas.is_some() {
        colors.push("chart");
    }
    if s.normal_maps {
        colors.push("bumped");
    } else {
        plan.leave_out("bumped", "no material has a normal map", 4 * s.pixels());
    }
    for name in colors.iter().chain(&["depth"]) {
        plan.image(name, s.size);
    }
    if !s.uvs {
        plan.leave_out("texture coordinates", "no material is textured", 0);
    }
    let state = state(s, &colors);
    // A viewz of 0 says that nothing else of the pixel means anything, so nothing else is cleared.
    let colors = colors.into_iter().map(|n| (n.to_owned(), (n == "viewz").then_some([0; 4]))).collect();
    let depth = Some(("depth".to_owned(), None, 0.));
    let fragment = if s.atlas.is_some() { &shaders::GBUFFER_FRAG_CHART } else { &shaders::GBUFFER_FRAG_PLAIN };
    plan.raster("gbuffer", vertex(s, false), Some(fragment), state, colors, depth, Geometry::Materials);
}

/// State of a pass that draws the scene's meshes as the eye sees them, with the streams that their materials need.
pub fn state(s: &Setup, colors: &[&str]) -> Raster {
    let format = |name: &str| targets::describe(name).map_or(vk::Format::UNDEFINED, |t| t.format);
    let mut streams = vec![(0, vk::Format::R32G32B32_SFLOAT), (1, vk::Format::R32G32B32_SFLOAT)];
    if s.uvs {
        streams.push((2, vk::Format::R32G32_SFLOAT));
    }
    if s.normal_maps {
        streams.push((3, vk::Format::R32G32B32A32_SFLOAT));
    }
    Raster {
        colors: colors.iter().map(|n| format(n)).collect(),
        depth: format("depth"),
        compare: vk::CompareOp::GREATER,
        streams,
        ..Raster::default()
    }
}

/// The vertex shader for those streams; `bend`: and for the curvature of the mesh behind them.
pub fn vertex(s: &Setup, bend: bool) -> &'static Shader {
    match (s.uvs, s.normal_maps, bend) {
        (false, _, false) => &shaders::GBUFFER_VERT_PLAIN,
        (true, false, false) => &shaders::GBUFFER_VERT_UV,
        (true, true, false) => &shaders::GBUFFER_VERT_TANGENT,
        (false, _, true) => &shaders::GBUFFER_VERT_PLAIN_BEND,
        (true, false, true) => &shaders::GBUFFER_VERT_UV_BEND,
        (true, true, true) => &shaders::GBUFFER_VERT_TANGENT_BEND,
    }
}
