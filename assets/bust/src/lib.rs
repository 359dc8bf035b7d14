//! The bust in `assets/`: sculpted as a signed distance field, meshed, unwrapped and painted.
//!
//! Millimetres; +Y up, the face looks along +Z; y = 0 is the height of the pupils, z = 0 that of the ear canals.

pub mod bake;
pub mod body;
pub mod ear;
pub mod eyes;
pub mod face;
pub mod glb;
pub mod hair;
pub mod mesh;
pub mod paint;
pub mod sculpt;
pub mod sdf;
pub mod unwrap;
