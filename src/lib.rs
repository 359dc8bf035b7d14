//! pdss: pre-integrated deferred subsurface scattering on Vulkan.
#![deny(unsafe_code)]
#![warn(missing_docs)]

pub mod frame;
pub mod gpu;
pub mod methods;
pub mod plan;
pub mod report;
pub mod scene;
pub mod settings;
pub mod shaders;
pub mod skin;
pub mod stages;
pub mod targets;
pub mod truth;
