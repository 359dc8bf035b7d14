//! Pre-integrated deferred subsurface scattering (Chen, Lambert & Penner, SIGGRAPH 2014 poster): curvature and normals are
//! diffused by a cross-bilateral blur, then lit through a table that holds the scattering (Penner & Borshukov 2011).

use crate::frame::setup::Setup;
use crate::plan::Plan;
use crate::stages::{blur, curvature, gbuffer, layer, light, shadow, tiles, visibility};

/// The frame.
pub fn frame(p: &mut Plan, s: &Setup) {
    shadow::add(p, s); //     meshes                                -> shadow
    gbuffer::add(p, s); //    meshes                                -> viewz normal albedo material bumped
    layer::add(p, s); //      viewz                                 -> viewz of each, of several profiles
    tiles::add(p, s); //      viewz                                 -> tile lists
    visibility::add(p, s); // viewz normal shadow                   -> lit
    curvature::add(p, s); //  viewz normal                          -> curvature
    blur::add(p, s); //       viewz normal curvature lit            -> soft0.. softlit0..
    light::add(p, s); //      G-buffer soft softlit lut             -> ldr or exr
}
