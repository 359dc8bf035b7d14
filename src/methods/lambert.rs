//! Nothing scatters: the floor that every method is held against.

use crate::frame::setup::Setup;
use crate::plan::Plan;
use crate::stages::{gbuffer, light, shadow, tiles};

/// The frame.
pub fn frame(p: &mut Plan, s: &Setup) {
    shadow::add(p, s); //    meshes         -> shadow
    gbuffer::add(p, s); //   meshes         -> viewz normal albedo material bumped
    tiles::add(p, s); //     viewz          -> tile lists
    light::add(p, s); //     G-buffer       -> ldr or exr
}
