//! The ways to shade: one file a method, its whole frame as a list, one line a stage.

mod lambert;
mod moments;
mod pdss;

use crate::frame::resources::EXTERNAL;
use crate::frame::setup::{Output, Setup};
use crate::plan::{Plan, PlanError};
use crate::settings::{Method, View};
use crate::stages;

/// Plans the frame of a method, and the view asked for.
///
/// # Errors
/// Where a stage and its shader disagree, or a view shows what the method does not make.
pub fn plan(s: &Setup) -> Result<Plan, PlanError> {
    let external = EXTERNAL.iter().map(|n| (*n).to_owned()).collect();
    let mut plan = Plan { external, ..Plan::default() };
    let kept = if s.output == Output::Linear { "exr" } else { "ldr" };
    // Tiles without a surface are never visited: their colour is the clear's.
    plan.image(kept, s.size);
    plan.clear("clear", kept, [0.; 4]);
    match s.settings.method {
        Method::Lambert => lambert::frame(&mut plan, s),
        Method::Pdss => pdss::frame(&mut plan, s),
        Method::Moments => moments::frame(&mut plan, s),
    }
    match s.settings.view {
        View::Final | View::Scatter | View::Irradiance | View::Ao => stages::light::add(&mut plan, s),
        _ => stages::view::add(&mut plan, s),
    }
    plan.keep(kept);
    plan.finish()?;
    Ok(plan)
}
