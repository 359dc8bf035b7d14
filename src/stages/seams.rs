//! seams: gutter, sheet -> sheet. Carries a sheet over the cuts of the unwrapping.

use crate::frame::setup::Setup;
use crate::plan::{Domain, Plan};
use crate::shaders;

/// Threads in a row: a device need not allow more than 65535 workgroups along an axis.
const ROW: u32 = 1 << 18;

/// Adds the pass for one sheet, where there are cuts.
pub fn add(plan: &mut Plan, s: &Setup, sheet: &str) {
    if s.gutter.is_empty() {
        return;
    }
    let count = s.gutter.len() as u32;
    let threads = Domain::Threads([count.min(ROW), count.div_ceil(ROW)]);
    plan.compute(&format!("seams of {sheet}"), &shaders::SEAMS, threads).bind("sheet", sheet);
}
