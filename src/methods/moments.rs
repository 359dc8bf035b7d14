//! Ours: normals are blurred with every Gaussian of the profile and not normalised; mean and spread of n.l give each
//! Gaussian's share in closed form (`skin::moments`). No table; curvature only where ambient occlusion wants it.

use crate::frame::setup::Setup;
use crate::plan::Plan;
use crate::stages::{blur, curvature, gbuffer, inert, layer, light, shadow, sparse, tiles, translucent, visibility};

/// The frame.
pub fn frame(p: &mut Plan, s: &Setup) {
    shadow::add(p, s); //     meshes                                -> shadow
    gbuffer::add(p, s); //    meshes                                -> viewz normal albedo material bumped mass
    layer::add(p, s); //      viewz                                 -> viewz of each, of several profiles
    tiles::add(p, s); //      viewz                                 -> tile lists
    inert::add(p, s); //      meshes that do not scatter            -> inert
    sparse::add(p, s); //     shadow inert                          -> sparse      (a texel in so many)
    visibility::add(p, s); // viewz normal shadow                   -> lit
    curvature::add(p, s); //  viewz normal                          -> curvature   (for ambient occlusion)
    translucent::add(p, s); //viewz normal mass sparse softlit      -> softlit..  (wide levels, each between two of the blur's)
    blur::add(p, s); //       viewz normal curvature lit            -> soft0.. softlit0..
    light::add(p, s); //      G-buffer soft softlit                 -> ldr or exr
}
