//! The GPU layer: the only unsafe code of the crate.
//!
//! A few fat owners (image, buffer, pipeline) hold an `Arc<Gpu>`; dropping one never waits: only [`submit::Recorded`]
//! waits for its fence. All synchronization is in [`usage`].
#![allow(unsafe_code)]

pub mod buffer;
pub mod commands;
pub mod device;
pub mod image;
pub mod pass;
pub mod pipeline;
pub mod submit;
pub mod suit;
pub mod timing;
pub mod usage;
pub mod validation;

pub use buffer::Buffer;
pub use device::{DeviceInfo, Gpu, Options};
pub use image::{Block, Image, ImageDesc, Sampler};
pub use suit::Suit;
pub use usage::Usage;

use ash::vk;

/// What can go wrong between us and the driver.
#[derive(Debug, thiserror::Error)]
pub enum GpuError {
    /// A Vulkan call failed.
    #[error("{call} failed for {resource}: {result}")]
    Vulkan {
        /// The call.
        call: &'static str,
        /// The object it was for.
        resource: String,
        /// What the driver said.
        result: vk::Result,
    },
    /// No loader, no driver, or no device that is good enough.
    #[error("no usable Vulkan device: {0}")]
    NoDevice(String),
    /// Validation was asked for and the layer is not installed.
    #[error(
        "validation was asked for, but VK_LAYER_KHRONOS_validation is not installed (Debian: vulkan-validationlayers)"
    )]
    NoValidation,
    /// Memory could not be had.
    #[error("allocating {resource}: {reason}")]
    Memory {
        /// The object it was for.
        resource: String,
        /// Why.
        reason: String,
    },
    /// A use of this layer that the layer refuses.
    #[error("{0}")]
    Misuse(String),
    /// Objects were still alive when the device was closed.
    #[error("leaked at device close: {0}")]
    Leak(String),
}

/// Names the call and the object of a failed Vulkan call.
pub(crate) trait Named<T> {
    fn named(self, call: &'static str, resource: &str) -> Result<T, GpuError>;
}

impl<T> Named<T> for Result<T, vk::Result> {
    fn named(self, call: &'static str, resource: &str) -> Result<T, GpuError> {
        self.map_err(|result| GpuError::Vulkan { call, resource: resource.to_owned(), result })
    }
}
