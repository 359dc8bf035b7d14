//! seams: gutter, sheet -> sheet. Carries a sheet over the cuts of the unwrapping.

use crate::frame::setup::Setup;
use crate::plan::{Domain, Plan};
use crate::shaders;

/// Adds the pass for one sheet, where there are cuts.
pub fn add(plan: &mut Plan, s: &Setup, sheet: &str) {
    if s.gutter.is_empty() {
        return;
    }
    let threads = Domain::Threads([s.gutter.len() as u32, 1]);
    plan.compute(&format!("seams of {sheet}"), &shaders::SEAMS, threads).bind("sheet", sheet);
}
