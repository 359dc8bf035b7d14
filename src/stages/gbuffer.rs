//! gbuffer: meshes -> depth, viewz, normal, albedo, material, and bumped where the scene has a normal map.

use crate::frame::setup::Setup;
use crate::gpu::pipeline::Raster;
use crate::plan::{Geometry, Plan};
use crate::{shaders, targets};
use ash::vk;

/// Adds the pass.
pub fn add(plan: &mut Plan, s: &Setup) {
    let mut colors = vec!["viewz", "normal", "albedo", "material"];
    if s.normal_maps {
        colors.push("bumped");
    } else {
        plan.leave_out("bumped", "no material has a normal map", 4 * s.pixels());
    }
    if s.mass {
        colors.push("mass");
    }
    if s.detail {
        colors.push("facet");
    }
    for name in colors.iter().chain(&["depth"]) {
        plan.image(name, s.size);
    }
    let format = |name: &str| targets::describe(name).map_or(vk::Format::UNDEFINED, |t| t.format);
    let mut streams = vec![(0, vk::Format::R32G32B32_SFLOAT), (1, vk::Format::R32G32B32_SFLOAT)];
    if s.uvs {
        streams.push((2, vk::Format::R32G32_SFLOAT));
    } else {
        plan.leave_out("texture coordinates", "no material is textured", 0);
    }
    if s.normal_maps {
        streams.push((3, vk::Format::R32G32B32A32_SFLOAT));
    }
    if s.mass {
        streams.push((4, vk::Format::R32G32B32A32_SFLOAT));
    }
    let state = Raster {
        colors: colors.iter().map(|n| format(n)).collect(),
        depth: format("depth"),
        compare: vk::CompareOp::GREATER,
        streams,
        ..Raster::default()
    };
    // A viewz of 0 says that nothing else of the pixel means anything, so nothing else is cleared.
    let colors = colors.into_iter().map(|n| (n.to_owned(), (n == "viewz").then_some([0; 4]))).collect();
    let depth = ("depth".to_owned(), None, 0.);
    let vertex = match (s.uvs, s.normal_maps, s.mass) {
        (false, _, false) => &shaders::GBUFFER_VERT_PLAIN,
        (true, false, false) => &shaders::GBUFFER_VERT_UV,
        (true, true, false) => &shaders::GBUFFER_VERT_TANGENT,
        (false, _, true) => &shaders::GBUFFER_VERT_PLAIN_MASS,
        (true, false, true) => &shaders::GBUFFER_VERT_UV_MASS,
        (true, true, true) => &shaders::GBUFFER_VERT_TANGENT_MASS,
    };
    let fragment = match (s.mass, s.detail, s.normal_maps) {
        (false, _, _) => &shaders::GBUFFER_FRAG_PLAIN,
        (true, false, _) => &shaders::GBUFFER_FRAG_MASS,
        (true, true, false) => &shaders::GBUFFER_FRAG_MASS_FACET,
        (true, true, true) => &shaders::GBUFFER_FRAG_BUMPED_MASS_FACET,
    };
    let pass = plan.raster("gbuffer", vertex, Some(fragment), state, colors, depth, Geometry::Materials);
    if s.mass {
        let first = s.levels.levels.iter().take_while(|l| !l.gathered).count();
        pass.constant("FIRST", first as u32).constant("LEVELS", s.levels.levels.len() as u32);
    }
}
