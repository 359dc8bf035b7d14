//! view: any target -> exr, decoded to its unit.

use super::{curvature, tiles, visibility};
use crate::frame::setup::Setup;
use crate::plan::Plan;
use crate::settings::View;
use crate::shaders;

/// Adds the pass that shows the target a view names, and the target where the method does not make it.
pub fn add(plan: &mut Plan, s: &Setup) {
    let view = s.settings.view;
    if s.is_further() && !matches!(view, View::Curvature | View::SoftNormal | View::SoftCurvature) {
        return;
    }
    match view {
        View::Curvature if !plan.has("curvature") => curvature::add(plan, s),
        View::Lit if !plan.has("lit") => visibility::add(plan, s),
        _ => {}
    }
    let last = s.levels.levels.len().saturating_sub(1);
    let (shader, source) = match view {
        View::Albedo => (&shaders::VIEW_ALBEDO, "albedo".to_owned()),
        View::Material => (&shaders::VIEW_ALBEDO, "material".to_owned()),
        View::Normal => (&shaders::VIEW_NORMAL, "normal".to_owned()),
        View::ShadingNormal => (&shaders::VIEW_NORMAL, s.shading_normal().to_owned()),
        View::Position => (&shaders::VIEW_POSITION, String::new()),
        View::Curvature => (&shaders::VIEW_CURVATURE, "curvature".to_owned()),
        View::SoftNormal => (&shaders::VIEW_SOFT_NORMAL, format!("soft{last}")),
        View::SoftCurvature => (&shaders::VIEW_SOFT_CURVATURE, format!("soft{last}")),
        View::Lit => (&shaders::VIEW_LIT, "lit".to_owned()),
        _ => (&shaders::VIEW_DEPTH, String::new()),
    };
    tiles::background(plan, s);
    plan.compute("view", shader, tiles::surface())
        .constant("ROOTED", u32::from(view == View::Albedo))
        .constant("OWN", u32::from(s.is_further()))
        .constant("STRIDE", s.levels.levels.last().map_or(1, |l| l.stride))
        .bind("source", source);
}
