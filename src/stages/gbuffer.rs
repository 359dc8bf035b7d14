//! gbuffer: meshes -> depth, viewz, normal, albedo, material; bumped where the scene has a normal map; mass where light is
//! gathered; facet where shadows fall and shading normals stray from the triangles' own.

use crate::frame::setup::Setup;
use crate::gpu::pipeline::Raster;
use crate::plan::{Geometry, Plan};
use crate::settings::Spared;
use crate::shaders::{self, Shader};
use crate::targets;
use ash::vk;

/// A vertex stream of one stage's own, behind those that every material needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extra {
    /// None.
    None,
    /// Unsigned curvature of the mesh, 1/mm.
    Bend,
    /// The kernel's mass per channel, and the distance to the mesh's border in mm.
    Mass,
}

/// Adds the pass.
pub fn add(plan: &mut Plan, s: &Setup) {
    plan.once("gbuffer", |plan| all(plan, s));
}

fn all(plan: &mut Plan, s: &Setup) {
    let mut colors = vec!["viewz", "normal", "albedo", "material"];
    let layered = s.coated || s.thickest_mm > 0.;
    if layered {
        colors.push("coat");
    } else if s.lit_view() {
        let why = "no material has a coat, sheen, specular of its own or thickness that is seen";
        plan.leave_out("coat", why, 8 * s.pixels()).back = s.glossy.then_some(Spared::Coat);
    }
    if s.atlas.is_some() {
        colors.push("chart");
    }
    if s.mass {
        colors.push("mass");
    }
    if s.facets {
        colors.push("facet");
    } else if s.lit_view() {
        let why = "no shadow falls where shading normals stray from the triangles' own by .02";
        plan.leave_out("facet", why, 4 * s.pixels());
    }
    if s.bumped {
        colors.push("bumped");
    } else {
        let back = (s.facets || !s.mass).then_some(Spared::NormalMap);
        plan.leave_out("bumped", "no material has a normal map", 4 * s.pixels()).back = back;
    }
    for name in colors.iter().chain(&["depth"]) {
        plan.image(name, s.size);
    }
    if !s.uvs {
        let back = s.has_uvs.then_some(Spared::TextureCoordinates);
        plan.leave_out("texture coordinates", "no material is textured", 0).back = back;
    }
    if !s.second_uvs {
        plan.leave_out("second texture coordinates", "no texture reads any", 0);
    }
    if !s.colors {
        plan.leave_out("vertex colours", "no vertex has one", 0);
    }
    let extra = if s.mass { Extra::Mass } else { Extra::None };
    let fragment = match (s.mass, s.atlas.is_some(), s.facets, layered) {
        (true, _, false, false) => &shaders::GBUFFER_FRAG_MASS,
        (true, _, true, false) => &shaders::GBUFFER_FRAG_MASS_FACET,
        (true, _, false, true) => &shaders::GBUFFER_FRAG_MASS_COAT,
        (true, _, true, true) => &shaders::GBUFFER_FRAG_MASS_FACET_COAT,
        (_, false, false, false) => &shaders::GBUFFER_FRAG_PLAIN,
        (_, false, true, false) => &shaders::GBUFFER_FRAG_FACET,
        (_, false, false, true) => &shaders::GBUFFER_FRAG_PLAIN_COAT,
        (_, false, true, true) => &shaders::GBUFFER_FRAG_FACET_COAT,
        (_, true, false, false) => &shaders::GBUFFER_FRAG_CHART,
        (_, true, true, false) => &shaders::GBUFFER_FRAG_CHART_FACET,
        (_, true, false, true) => &shaders::GBUFFER_FRAG_CHART_COAT,
        (_, true, true, true) => &shaders::GBUFFER_FRAG_CHART_FACET_COAT,
    };
    let state = state(s, &colors, extra);
    // A viewz of 0 says that nothing else of the pixel means anything, so nothing else is cleared.
    let colors = colors.into_iter().map(|n| (n.to_owned(), (n == "viewz").then_some([0; 4]))).collect();
    let depth = Some(("depth".to_owned(), None, 0.));
    let pass = plan
        .raster("gbuffer", vertex(s, extra), Some(fragment), state, colors, depth, Geometry::Materials)
        .constant("TINT", u32::from(s.colors))
        .constant("SEVERAL", u32::from(s.several));
    if s.mass {
        pass.constant("FIRST", s.levels.first_gathered()).constant("LEVELS", s.levels.levels.len() as u32);
    }
}

/// State of a pass that draws the scene's meshes as the eye sees them, with the streams that their materials need.
pub fn state(s: &Setup, colors: &[&str], extra: Extra) -> Raster {
    let format = |name: &str| targets::describe(name).map_or(vk::Format::UNDEFINED, |t| t.format);
    let mut streams = vec![(0, vk::Format::R32G32B32_SFLOAT), (1, vk::Format::R32G32B32_SFLOAT)];
    if s.uvs {
        streams.push((2, s.uv_format()));
    }
    if s.normal_maps {
        streams.push((3, vk::Format::R32G32B32A32_SFLOAT));
    }
    if s.colors {
        streams.push((6, vk::Format::R32G32B32A32_SFLOAT));
    }
    match extra {
        Extra::None => {}
        Extra::Bend => streams.push((4, vk::Format::R32_SFLOAT)),
        Extra::Mass => streams.push((4, vk::Format::R32G32B32A32_SFLOAT)),
    }
    Raster {
        colors: colors.iter().map(|n| format(n)).collect(),
        depth: format("depth"),
        compare: vk::CompareOp::GREATER,
        streams,
        ..Raster::default()
    }
}

/// The vertex shader for those streams.
pub fn vertex(s: &Setup, extra: Extra) -> &'static Shader {
    match (extra, s.uvs, s.normal_maps, s.colors) {
        (Extra::None, false, _, false) => &shaders::GBUFFER_VERT_PLAIN,
        (Extra::None, true, false, false) => &shaders::GBUFFER_VERT_UV,
        (Extra::None, true, true, false) => &shaders::GBUFFER_VERT_TANGENT,
        (Extra::Bend, false, _, false) => &shaders::GBUFFER_VERT_PLAIN_BEND,
        (Extra::Bend, true, false, false) => &shaders::GBUFFER_VERT_UV_BEND,
        (Extra::Bend, true, true, false) => &shaders::GBUFFER_VERT_TANGENT_BEND,
        (Extra::Mass, false, _, false) => &shaders::GBUFFER_VERT_PLAIN_MASS,
        (Extra::Mass, true, false, false) => &shaders::GBUFFER_VERT_UV_MASS,
        (Extra::Mass, true, true, false) => &shaders::GBUFFER_VERT_TANGENT_MASS,
        (Extra::None, false, _, true) => &shaders::GBUFFER_VERT_PLAIN_COLOR,
        (Extra::None, true, false, true) => &shaders::GBUFFER_VERT_UV_COLOR,
        (Extra::None, true, true, true) => &shaders::GBUFFER_VERT_TANGENT_COLOR,
        (Extra::Bend, false, _, true) => &shaders::GBUFFER_VERT_PLAIN_BEND_COLOR,
        (Extra::Bend, true, false, true) => &shaders::GBUFFER_VERT_UV_BEND_COLOR,
        (Extra::Bend, true, true, true) => &shaders::GBUFFER_VERT_TANGENT_BEND_COLOR,
        (Extra::Mass, false, _, true) => &shaders::GBUFFER_VERT_PLAIN_MASS_COLOR,
        (Extra::Mass, true, false, true) => &shaders::GBUFFER_VERT_UV_MASS_COLOR,
        (Extra::Mass, true, true, true) => &shaders::GBUFFER_VERT_TANGENT_MASS_COLOR,
    }
}
