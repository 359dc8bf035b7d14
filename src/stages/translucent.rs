//! translucent: viewz, normal, sparse, and softlit + softgeo with normal maps -> softlit, for the wide levels. Light found in the
//! shadow map, hidden parts of the surface included.

use super::tiles;
use crate::frame::setup::Setup;
use crate::plan::Plan;
use crate::shaders;

/// Says why no level is gathered; those that are have their pass among the blur's ([`level`]).
pub fn add(plan: &mut Plan, s: &Setup) {
    if !s.mass {
        let why = if s.several {
            "several profiles scatter, and a shadow map does not say by which its surface does"
        } else if s.taps == 0 {
            "light is blurred on the screen alone with --no-translucent"
        } else if s.shadows.slots == 0 {
            "no light casts a shadow"
        } else {
            "not every light whose shadow is scattered is directional, or no level is wide beside a shadow texel"
        };
        plan.leave_out("light from the light's view", why, 4 * s.pixels());
    }
}

/// Adds the pass of one level, where it is gathered, over its blurred light. Once the next level's blur has read that: the light
/// by the triangles' normals is then needed no longer, and the next level can lie where it lay.
pub fn level(plan: &mut Plan, s: &Setup, i: usize) {
    let Some(level) = s.levels.levels.get(i).filter(|l| l.gathered) else { return };
    let shader = if s.detail { &shaders::TRANSLUCENT_DETAIL } else { &shaders::TRANSLUCENT_PLAIN };
    let pass = plan
        .compute(&format!("translucent{i}"), shader, tiles::scattering(level.stride))
        .constant("STRIDE", level.stride)
        .constant("TAPS", s.taps)
        .constant("STEP", s.sparse_step)
        .constant("SHARED", u32::from(s.shadows.shared()))
        .constant("GATHERED", i as u32 - s.levels.first_gathered())
        .bind("soft", format!("soft{i}"))
        .bind("normal", if s.detail { "facet" } else { "normal" })
        .bind("blurred", format!("softlit{i}"))
        .bind("blurred_geo", format!("softgeo{i}"))
        .push(&(level.variance as f32));
    s.specialise_lights(pass);
}
