//! `pdss devices`: what there is to run on.

use super::explain::Format;
use super::failure::Failure;
use super::{print, print_json};
use clap::Args;
use pdss::gpu::Gpu;
use pdss::report::table;

/// Options of `pdss devices`.
#[derive(Debug, Args)]
pub struct Devices {
    /// For people or for programs.
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

impl Devices {
    /// Lists the devices. None that can be used is a failure, after the list has said why.
    pub fn run(&self) -> Result<(), Failure> {
        let devices = Gpu::devices()?;
        match self.format {
            Format::Table => print(&table::of_devices(&devices))?,
            Format::Json => print_json(&devices)?,
        }
        if devices.iter().any(|d| d.unusable.is_none()) {
            Ok(())
        } else {
            Err(Failure::Device(
                "no usable Vulkan device (Debian: mesa-vulkan-drivers has a software driver)".to_owned(),
            ))
        }
    }
}
