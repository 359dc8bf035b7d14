//! curvature: viewz, normal -> curvature. The estimator and the twin (GLSL or hand-written SPIR-V) are settings.

use super::tiles;
use crate::frame::setup::Setup;
use crate::plan::Plan;
use crate::settings::{Curvature, Kernels, Spared, View};
use crate::shaders;

/// Adds the pass, if anything uses curvature.
pub fn add(plan: &mut Plan, s: &Setup) {
    if !s.curvature {
        let back = s.scatters.then_some(Spared::Curvature);
        plan.leave_out("curvature", s.why_no_curvature, 8 * s.pixels()).back = back;
        return;
    }
    plan.image("curvature", s.size);
    let shader = match (s.settings.kernels, s.settings.curvature) {
        (Kernels::Spirv, Curvature::Metric) => &shaders::CURVATURE_SPIRV,
        (_, Curvature::Vergne) => &shaders::CURVATURE_VERGNE,
        (_, Curvature::VergneMended) => &shaders::CURVATURE_VERGNE_MENDED,
        (_, Curvature::Trace) => &shaders::CURVATURE_TRACE,
        (_, Curvature::Metric) => &shaders::CURVATURE_METRIC,
        (_, Curvature::Fit) => &shaders::CURVATURE_FIT,
    };
    let domain = if s.settings.view == View::Curvature { tiles::surface() } else { tiles::scattering(1) };
    plan.compute("curvature", shader, domain);
}
