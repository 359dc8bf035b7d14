//! Pre-integrated skin shading (Penner & Borshukov 2011), forward as its authors have it: one raster pass lights what it draws,
//! by a table over the cosine to the light and the surface's curvature, normals that are filtered as wide as each channel
//! scatters, and a table over the penumbra of shadows.

use crate::frame::setup::Setup;
use crate::plan::Plan;
use crate::settings::{ForwardCurvature, Quality, Settings};
use crate::skin::penumbra;
use crate::skin::profile::Profile;
use crate::stages::{forward, gbuffer, layer, shadow, tiles};

/// The frame.
pub fn frame(p: &mut Plan, s: &Setup) {
    shadow::add(p, s); //     meshes                       -> shadow
    if s.lit_view() {
        forward::add(p, s); // meshes shadow lut penumbra  -> ldr or exr
    } else {
        // Only what shows other targets has use for them.
        gbuffer::add(p, s); // meshes                      -> viewz normal albedo material bumped
        layer::add(p, s); //   viewz                       -> viewz of each, of several profiles
        tiles::add(p, s); //   viewz                       -> tile lists
    }
}

/// How much of the method runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Effort {
    /// Where curvature comes from.
    pub curvature: ForwardCurvature,
    /// Normals a pixel: one; the sharp and the widest with blends between them; one a channel.
    pub normals: u32,
    /// Taps of the disc that measures a shadow's penumbra; 1 leaves shadows hard.
    pub taps: u32,
}

/// The ladder. Low is the look-up alone, as the talk opens with it (Penner 2011); medium adds the two-normal blend and the
/// penumbra table, as NVIDIA FaceWorks ships them; high and ultra take the chapter's curvature of the mesh and a normal a
/// channel, with more taps.
pub fn effort(settings: &Settings) -> Effort {
    let (curvature, normals, taps) = match settings.quality {
        Quality::Low => (ForwardCurvature::Derivative, 1, 1),
        Quality::Medium => (ForwardCurvature::Derivative, 2, 16),
        Quality::High => (ForwardCurvature::Vertex, 3, 32),
        Quality::Ultra => (ForwardCurvature::Vertex, 3, 64),
    };
    Effort { curvature: settings.forward_curvature.unwrap_or(curvature), normals, taps }
}

/// One entry: the sigma of each channel (mm), by which its normal is blurred, and the diameter of the shadow's disc (mm).
pub fn kernel(profile: &Profile) -> Vec<[f64; 4]> {
    let [r, g, b] = profile.mean_variance().map(f64::sqrt);
    vec![[r, g, b, penumbra::width_mm(profile)]]
}
