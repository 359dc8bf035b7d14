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

/// What the stages over tiles are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Screen {
    /// Compute shaders, a workgroup a tile.
    Compute,
    /// Fragment shaders, a point a tile, where tiles are squares and the device has large points; but those that store to what
    /// they read stay compute shaders.
    Fragment,
}

impl Screen {
    /// Stems of the shaders that are fragment shaders then.
    pub fn fragments(self) -> &'static [&'static str] {
        match self {
            Screen::Compute => &[],
            Screen::Fragment => &[
                "blur",
                "burley",
                "combine",
                "curvature",
                "gather",
                "gaussians",
                "irradiance",
                "light",
                "separable",
                "view",
                "visibility",
            ],
        }
    }
}

/// How stages run on a device.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, serde::Serialize)]
pub struct Suit {
    /// Workgroups of the stages that run over tiles.
    pub tile: Tile,
    /// Loads.
    pub loads: Loads,
    /// Stems of the shaders over tiles that run as fragment shaders.
    pub fragments: &'static [&'static str],
    /// The device draws no points as large as a tile: no stage is a fragment shader.
    pub small_points: bool,
}

impl Suit {
    /// What was measured to be fastest on a device. Lavapipe alone has been measured as yet: there an output costs a fifth of a store.
    /// Others store alike from both, and cards without a display draw slowly: they compute.
    pub fn of(device: &DeviceInfo) -> Suit {
        let screen = if device.name.starts_with("llvmpipe") { Screen::Fragment } else { Screen::Compute };
        Suit { fragments: screen.fragments(), small_points: !device.large_points, ..Suit::default() }
    }
}
