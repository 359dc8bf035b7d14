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
    let state = Raster {
        colors: colors.iter().map(|n| format(n)).collect(),
        depth: format("depth"),
        compare: vk::CompareOp::GREATER,
        streams,
        ..Raster::default()
    };
    let colors = colors.into_iter().map(|n| (n.to_owned(), [0; 4])).collect();
    let depth = ("depth".to_owned(), None, 0.);
    let vertex = match (s.uvs, s.normal_maps) {
        (false, _) => &shaders::GBUFFER_VERT_PLAIN,
        (true, false) => &shaders::GBUFFER_VERT_UV,
        (true, true) => &shaders::GBUFFER_VERT_TANGENT,
    };
    plan.raster("gbuffer", vertex, Some(&shaders::GBUFFER_FRAG), state, colors, depth, Geometry::Materials);
}
