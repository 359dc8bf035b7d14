//! Nothing scatters: the floor that every method is held against.

use crate::frame::setup::Setup;
use crate::plan::Plan;
use crate::stages::{curvature, gbuffer, shadow, tiles};

/// The frame up to lighting.
pub fn frame(p: &mut Plan, s: &Setup) {
    shadow::add(p, s); //    meshes         -> shadow
    gbuffer::add(p, s); //   meshes         -> viewz normal albedo material bumped
    tiles::add(p, s); //     viewz          -> tile lists
    curvature::add(p, s); // viewz normal   -> curvature   (only where a view asks)
}
