//! forward: meshes, shadow, lut, penumbra -> ldr or exr, depth. Lights what it draws: no G-buffer, no tiles.

use super::gbuffer::{self, Extra};
use super::transmittance;
use crate::frame::setup::Setup;
use crate::methods::preintegrated;
use crate::plan::{Geometry, Plan};
use crate::settings::{ForwardCurvature, View};
use crate::shaders;

/// Adds the pass, one for all profiles: what each draw reads of its own follows from its material.
pub fn add(plan: &mut Plan, s: &Setup) {
    plan.once("forward", |plan| all(plan, s));
    if s.several
        && let Some(pass) = plan.find("forward")
    {
        let mut own = s.gloss();
        own.push(("GAUSSIANS", transmittance::gaussians(s).unwrap_or(0)));
        pass.each.push((s.profile, own));
    }
}

fn all(plan: &mut Plan, s: &Setup) {
    let effort = preintegrated::effort(&s.settings);
    let lit = s.settings.view == View::Final;
    plan.image("depth", s.size);
    let bend = effort.curvature == ForwardCurvature::Vertex;
    let extra = if bend { Extra::Bend } else { Extra::None };
    let state = gbuffer::state(s, &[s.picture()], extra);
    if !bend {
        plan.leave_out("curvature of the mesh", "screen-space derivatives tell it", 0);
    }
    let gaussians = transmittance::said(plan, s);
    let colors = vec![(s.picture().to_owned(), Some([0; 4]))];
    let depth = Some(("depth".to_owned(), None, 0.));
    let fragment = if bend { &shaders::FORWARD_FRAG_VERTEX } else { &shaders::FORWARD_FRAG_DERIVATIVE };
    let vertex = gbuffer::vertex(s, extra);
    let pass = plan
        .raster("forward", vertex, Some(fragment), state, colors, depth, Geometry::Materials)
        .constant("TINT", u32::from(s.colors))
        .constant("OUTPUT", s.lit_output())
        .constant("SHADOWS", u32::from(!s.shadows.matrices.is_empty()))
        .constant("AMBIENT", u32::from(lit && s.ambient))
        .constant("CURVE", s.tone_curve())
        .constant("NORMALS", effort.normals - 1)
        .constant("TAPS", effort.taps)
        .constant("GAUSSIANS", gaussians)
        .constant("THICKEST", s.thickest_mm.to_bits());
    s.specialise_lights(pass);
    s.specialise_sky(pass);
    s.specialise_gloss(pass);
    if s.shadows.matrices.is_empty() {
        pass.bind("shadow", "no shadow");
    }
}
