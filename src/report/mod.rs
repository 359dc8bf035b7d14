//! What comes out: pictures, tables, records and traces. No Vulkan call is made here; see [`crate::frame`] for those.

pub mod canvas;
pub mod explain;
pub mod layers;
pub mod measure;
pub mod picture;
pub mod preview;
pub mod record;
pub mod stats;
pub mod supersample;
pub mod table;
pub mod tone;
pub mod trace;
pub mod traffic;
pub mod versus;
