//! unwrap: meshes, shadow -> sheet0, stretch. Irradiance over texture coordinates.

use crate::frame::setup::Setup;
use crate::gpu::pipeline::Raster;
use crate::methods::texture_space;
use crate::plan::{Geometry, Plan};
use crate::settings::View;
use crate::{shaders, targets};
use ash::vk;

/// Adds the pass, where the picture shows scattered light.
pub fn add(plan: &mut Plan, s: &Setup) {
    if !s.lit_view() || s.settings.view == View::Irradiance {
        return;
    }
    let side = texture_space::effort(s.settings.quality).0;
    let format = |name: &str| targets::describe(name).map_or(vk::Format::UNDEFINED, |t| t.format);
    let mut streams = vec![(0, vk::Format::R32G32B32_SFLOAT), (1, vk::Format::R32G32B32_SFLOAT), (2, s.uv_format())];
    if s.normal_maps {
        streams.push((3, vk::Format::R32G32B32A32_SFLOAT));
    }
    if s.colors {
        streams.push((6, vk::Format::R32G32B32A32_SFLOAT));
    }
    streams.push((5, vk::Format::R32_SFLOAT));
    let names = ["sheet0", "stretch"];
    for name in names {
        plan.image(name, [side; 2]);
    }
    let state = Raster { colors: names.map(format).to_vec(), streams, ..Raster::default() };
    let colors = names.map(|n| (n.to_owned(), Some([0; 4]))).to_vec();
    let vertex = match (s.normal_maps, s.colors) {
        (false, false) => &shaders::UNWRAP_VERT_UV,
        (true, false) => &shaders::UNWRAP_VERT_TANGENT,
        (false, true) => &shaders::UNWRAP_VERT_UV_COLOR,
        (true, true) => &shaders::UNWRAP_VERT_TANGENT_COLOR,
    };
    let pass = plan
        .raster("unwrap", vertex, Some(&shaders::UNWRAP_FRAG), state, colors, None, Geometry::Unwrapped)
        .constant("TINT", u32::from(s.colors))
        .constant("SHADOWS", u32::from(!s.shadows.matrices.is_empty()))
        .constant("AMBIENT", u32::from(s.settings.view == View::Final && s.ambient))
        .constant("SHEET_BORDER", s.border.to_bits())
        .constant("PRE", u32::from(s.pre_textured()));
    s.specialise_lights(pass);
    s.specialise_sky(pass);
    if s.shadows.matrices.is_empty() {
        pass.bind("shadow", "no shadow");
    }
}
