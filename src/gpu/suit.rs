//! What suits a device: the one place where stages run otherwise on one than on another. None of it changes a bit of a picture
//! (`tests/invariants/suits.rs`); glsl/README.md has the times.

use super::DeviceInfo;
use clap::ValueEnum;

/// Sides of a tile in pixels: a workgroup of 64 threads.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, ValueEnum, serde::Serialize)]
pub enum Tile {
    /// Square: least border for its area, least empty pixels beside what it holds.
    #[default]
    #[value(name = "8x8")]
    #[serde(rename = "8x8")]
    Square,
    /// Two squares' width, half their height.
    #[value(name = "16x4")]
    #[serde(rename = "16x4")]
    Broad,
    /// Two rows of 128 bytes, at four bytes a pixel.
    #[value(name = "32x2")]
    #[serde(rename = "32x2")]
    Flat,
    /// A piece of a row.
    #[value(name = "64x1")]
    #[serde(rename = "64x1")]
    Row,
}

impl Tile {
    /// Width and height, pixels.
    pub fn sides(self) -> [u32; 2] {
        match self {
            Tile::Square => [8, 8],
            Tile::Broad => [16, 4],
            Tile::Flat => [32, 2],
            Tile::Row => [64, 1],
        }
    }
}

/// How a compute stage loads a texel of an image that it only reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, ValueEnum, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Loads {
    /// From a storage image, in GENERAL layout as it was written: no transition.
    #[default]
    Storage,
    /// Fetched through the texture unit and its cache, in SHADER_READ_ONLY layout.
    Sampled,
}

/// How stages run on a device.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, serde::Serialize)]
pub struct Suit {
    /// Workgroups of the stages that run over tiles.
    pub tile: Tile,
    /// Loads.
    pub loads: Loads,
}

impl Suit {
    /// What was measured to be fastest on a device. Lavapipe alone has been measured as yet, so all run as it does.
    pub fn of(_device: &DeviceInfo) -> Suit {
        Suit::default()
    }
}
