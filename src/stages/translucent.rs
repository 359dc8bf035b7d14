//! translucent: viewz, normal, shadow, and softlit + softgeo with normal maps -> gathered, for the wide levels. Light found in the shadow map, hidden parts of the surface included.

use super::tiles;
use crate::frame::setup::Setup;
use crate::plan::{Domain, Plan};
use crate::shaders;

/// Adds a pass for each level that is gathered.
pub fn add(plan: &mut Plan, s: &Setup) {
    for (i, level) in s.levels.levels.iter().enumerate().filter(|(_, l)| l.gathered) {
        let target = format!("gathered{i}");
        plan.image_as(&target, ash::vk::Format::R32_UINT, s.size.map(|x| x.div_ceil(level.stride)), 1);
        let shader = if s.detail { &shaders::TRANSLUCENT_DETAIL } else { &shaders::TRANSLUCENT_PLAIN };
        let pass = plan
            .compute(&format!("translucent{i}"), shader, Domain::Tiles(tiles::scatter(level.stride)))
            .constant("STRIDE", level.stride)
            .constant("TAPS", s.taps)
            .constant("GATHERED", i as u32 - s.levels.first_gathered())
            .bind("target", target)
            .bind("soft", format!("soft{i}"))
            .bind("normal", if s.detail { "facet" } else { "normal" })
            .bind("blurred", format!("softlit{i}"))
            .bind("blurred_geo", format!("softgeo{i}"))
            .push(&(level.variance as f32));
        s.specialise_lights(pass);
    }
}
