//! What a frame leaves out, and `--no-elide` brings back.

use clap::ValueEnum;

/// What can be run for nothing where a scene does not need it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Spared {
    /// All of these.
    All,
    /// Tiles, 64 pixels each, that hold no surface, or none that scatters.
    Tiles,
    /// Curvature that neither the method nor ambient occlusion reads.
    Curvature,
    /// Ambient occlusion, where nothing is concave.
    Occlusion,
    /// Ambient light of nothing.
    Ambient,
    /// A sky of intensity 0.
    Environment,
    /// Gloss, where no material reflects anything.
    Specular,
    /// Coat, sheen and specular of their own, where no material has any.
    Coat,
    /// A normal for light to fall on beside the interpolated one, where no material has a normal map.
    NormalMap,
    /// Textures of colour, roughness and occlusion that no material has: white ones are looked up.
    Textures,
    /// Texture coordinates that no texture is looked up by.
    TextureCoordinates,
    /// An alpha test that nothing fails.
    AlphaTest,
    /// Distance and cone of lights that are all directional.
    Places,
    /// Shadow maps of lights that reach nothing.
    Shadow,
    /// Shadow maps while `light` runs, although it looks nothing up in them.
    ShadowMap,
    /// Shadow maps drawn in each frame, although they stand still.
    Still,
    /// Timestamps that nobody reads.
    Timestamps,
}
