//! pdss: pre-integrated deferred subsurface scattering on Vulkan.
#![deny(unsafe_code)]
pub mod skin;
