//! Nothing scatters: the floor that every method is held against.

use crate::frame::setup::Setup;
use crate::plan::Plan;
use crate::stages::{gbuffer, layer, light, shadow, tiles};

/// The frame.
pub fn frame(p: &mut Plan, s: &Setup) {
    shadow::add(p, s); //    meshes         -> shadow
    gbuffer::add(p, s); //   meshes         -> viewz normal albedo material bumped
    layer::add(p, s); //     viewz          -> viewz of each, of several profiles
    tiles::add(p, s); //     viewz          -> tile lists
    light::add(p, s); //     G-buffer       -> ldr or exr
}
