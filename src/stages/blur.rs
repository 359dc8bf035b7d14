//! blur: viewz, and normal + curvature + lit or a level -> a wider level. One pass a step of [`Levels`].
//!
//! [`Levels`]: crate::frame::levels::Levels

use super::{tiles, translucent};
use crate::frame::setup::Setup;
use crate::plan::Plan;
use crate::shaders;

/// Adds the passes.
pub fn add(plan: &mut Plan, s: &Setup) {
    for variance in &s.levels.below_a_pixel {
        let why = format!("sigma {:.3} mm projects below a pixel here", variance.sqrt());
        plan.leave_out("blur level", why, 8 * s.pixels());
    }
    let (mut source, mut source_level) = (String::new(), None);
    for (index, step) in s.levels.steps.iter().enumerate() {
        // A pass on the way to a level writes a target that only the next pass reads.
        let stem = step.level.map_or(format!("way{index}"), |l| l.to_string());
        let [target, visibility, geometry] = ["soft", "softlit", "softgeo"].map(|name| format!("{name}{stem}"));
        let seen = s.shadows.slots > 0;
        let size = s.size.map(|x| x.div_ceil(step.stride.1));
        plan.image_as(&target, ash::vk::Format::R32G32_UINT, size, 1);
        if seen {
            plan.image_as(&visibility, ash::vk::Format::R32_UINT, size, 1);
        }
        if s.detail {
            plan.image_as(&geometry, ash::vk::Format::R32_UINT, size, 1);
        }
        let shader = match (index, seen, s.detail) {
            (0, false, _) => &shaders::BLUR_FIRST,
            (0, true, false) => &shaders::BLUR_FIRST_LIT,
            (0, true, true) => &shaders::BLUR_FIRST_GEO,
            (_, false, _) => &shaders::BLUR_NEXT,
            (_, true, false) => &shaders::BLUR_NEXT_LIT,
            (_, true, true) => &shaders::BLUR_NEXT_GEO,
        };
        let pass = plan
            .compute(&format!("blur{index}"), shader, tiles::scattering(step.stride.1))
            .constant("SOURCE_STRIDE", step.stride.0)
            .constant("TARGET_STRIDE", step.stride.1)
            .constant("CURVATURE", u32::from(s.curvature))
            .constant("TURN", index as u32 % 2)
            .bind("normal", s.shading_normal())
            .bind("source", format!("soft{source}"))
            .bind("target", target)
            .bind("source_lit", if index == 0 { "lit".to_owned() } else { format!("softlit{source}") })
            .bind("target_lit", visibility)
            .bind("source_geo", if index == 0 { "litgeo".to_owned() } else { format!("softgeo{source}") })
            .bind("target_geo", geometry)
            .push(&(step.variance as f32));
        if !s.curvature {
            pass.absent("curvature");
        }
        // The level before has been read for the last time.
        if let Some(i) = source_level {
            translucent::level(plan, s, i);
        }
        source_level = step.level;
        source = stem;
    }
    if let Some(i) = source_level {
        translucent::level(plan, s, i);
    }
}
