//! What a frame can be asked for. Declared once, as data: the command line is made from these types.

use crate::gpu::suit::{Loads, Screen, Suit, Tile};
use clap::{Args, ValueEnum};

mod spared;

pub use spared::Spared;

/// A whole way to shade.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, ValueEnum, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// Nothing scatters: the floor.
    Lambert,
    /// Normals and curvature blurred by a cross-bilateral filter, pre-integrated lighting (Chen, Lambert & Penner 2014).
    #[default]
    Pdss,
    /// Un-normalised blurred normals and their spread, closed form per Gaussian of the profile.
    Moments,
    /// Forward: one look-up by the surface's curvature, blurred normal maps and shadow edges (Penner & Borshukov 2011).
    Preintegrated,
    /// Irradiance blurred over texture coordinates by a cascade of Gaussians (d'Eon & Luebke 2007).
    TextureSpace,
    /// Irradiance blurred in screen space, a separable pair of passes a Gaussian (Jimenez & Gutierrez 2010).
    Gaussians,
    /// Irradiance blurred in screen space by one separable pair of passes (Jimenez et al. 2015).
    Separable,
    /// Irradiance gathered in screen space from a disc of samples (Christensen & Burley 2015; Golubev 2018).
    Burley,
    /// Cosine stretched beyond the terminator as far as curvature scatters it, energy kept (McAuley; Hill 2011).
    Wrap,
}

/// Where the surface's colour acts, for methods that scatter light itself (d'Eon & Luebke 2007).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, ValueEnum, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Texturing {
    /// Where light leaves: texture stays crisp.
    #[default]
    Post,
    /// Its square root where light enters, and again where it leaves: texture softens as light does.
    PrePost,
}

/// Where the kernel of `separable` comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, ValueEnum, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum SeparableKernel {
    /// The profile's own integral along a line: exact for light that changes in one direction of the two.
    #[default]
    Profile,
    /// The constants of the authors' own code, made for skin; scaled with the profile's widest Gaussian.
    Authors,
}

/// Whether light that enters on the far side of a thin part leaves on the near one; `moments` finds that light by itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Transmittance {
    /// By the thickness that the shadow map measures, as the authors have it. `separable`, `gaussians`, `burley`: exp(-s^2/v), from
    /// .3 before the terminator on (Jimenez et al. 2010); `texture-space`: light blurred where it enters (d'Eon & Luebke 2007).
    Authors,
    /// Exact for a slab lit from behind: exp(-s^2/2v) over what both sides weigh, from the terminator on. `pdss`, `wrap` and
    /// `preintegrated` know but this one.
    Slab,
    /// Not.
    Off,
}

/// How much work a method does; passes and resolution of `pdss` and `moments` follow from it unless they are given. What it means to
/// the others is said where they are (`methods`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, ValueEnum, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Quality {
    /// `pdss` one wide level, `moments` two, as coarse as their widths allow, down to a quarter.
    Low,
    /// `pdss` two levels, `moments` three, down to a quarter.
    #[default]
    Medium,
    /// `pdss` three levels, `moments` four, wide ones at half resolution.
    High,
    /// All levels, at full resolution, a pass more each, shadow maps of twice the size.
    Ultra,
}

/// Screen-space curvature estimator.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, ValueEnum, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Curvature {
    /// Hessian of -n.xy/n.z (Vergne et al. 2009): the rival; divides by n.z.
    Vergne,
    /// trace(grad n)/2 by the projection's own Jacobian (the poster's equation 1).
    Trace,
    /// Four neighbours, measured tangent basis, side selection.
    #[default]
    Metric,
    /// Eight neighbours, weighted least squares.
    Fit,
    /// Vergne's as its author's own code tames it: a lower power of n.z, nothing at silhouettes.
    VergneMended,
}

/// Where `preintegrated` has its curvature from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ForwardCurvature {
    /// |fwidth N| / |fwidth P| of the pixel's quad, as published.
    Derivative,
    /// Of the mesh, computed once and interpolated: no facets.
    Vertex,
}

/// Resolution of the blur.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Resolution {
    /// Every pixel.
    Full,
    /// One of 2 x 2.
    Half,
    /// One of 4 x 4.
    Quarter,
}

impl Resolution {
    /// Pixels per texel and axis.
    pub fn stride(self) -> u32 {
        match self {
            Resolution::Full => 1,
            Resolution::Half => 2,
            Resolution::Quarter => 4,
        }
    }
}

/// Which twin of the hand-written kernels runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, ValueEnum, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kernels {
    /// As compiled from GLSL.
    #[default]
    Glsl,
    /// The hand-written SPIR-V, for the stages and estimators that have one.
    Spirv,
}

/// The integral behind the look-up table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, ValueEnum, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Integral {
    /// Over a sphere, exact energy.
    #[default]
    Sphere,
    /// Over a ring, each Gaussian integrated along the cylinder: exact for a cylinder.
    Ring,
    /// Over a ring, the literal reading of Penner & Borshukov 2011.
    RingLiteral,
}

/// Tone curve of the PNG.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, ValueEnum, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ToneMap {
    /// Khronos PBR Neutral: hue-preserving, identity in the mid tones.
    #[default]
    Neutral,
    /// None: clamp and encode as sRGB.
    Linear,
}

/// What the picture shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, ValueEnum, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum View {
    /// The lit picture.
    #[default]
    Final,
    /// Base colour, linear.
    Albedo,
    /// Unit normal that curvature is measured on, world space.
    Normal,
    /// Unit normal that light falls on, world space.
    ShadingNormal,
    /// World position, mm.
    Position,
    /// Distance along the view axis, mm.
    Depth,
    /// Roughness, metallic, occlusion.
    Material,
    /// H in 1/mm, K in 1/mm^2, confidence.
    Curvature,
    /// The widest level's normal, un-normalised, world space.
    SoftNormal,
    /// The widest level's H in 1/mm.
    SoftCurvature,
    /// Ambient visibility from curvature, 0..1.
    Ao,
    /// Clamped cosine times visibility of the first two lights, or the mean of those that share their slots, before it is scattered.
    Lit,
    /// Irradiance, unscattered, with shadows.
    Irradiance,
    /// Diffuse exitance with unit-white albedo, no specular, no ambient, no environment: what truth also writes.
    Scatter,
}

/// Everything that decides a frame besides its scene, camera, lights and profile.
#[derive(Clone, Debug, Args, serde::Serialize)]
pub struct Settings {
    /// Way to shade.
    #[arg(long, value_enum, default_value_t)]
    pub method: Method,
    /// Work per frame; decides passes and resolution unless they are given.
    #[arg(long, value_enum, default_value_t)]
    pub quality: Quality,
    /// Curvature estimator.
    #[arg(long, value_enum, default_value_t)]
    pub curvature: Curvature,
    /// Blur passes, 1 to 12.
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=12))]
    pub passes: Option<u32>,
    /// Resolution of the blur.
    #[arg(long, value_enum)]
    pub resolution: Option<Resolution>,
    /// Which kernels run where there are two.
    #[arg(long, value_enum, default_value_t)]
    pub kernels: Kernels,
    /// Pixels of a workgroup [default: what suits the device].
    #[arg(long, value_enum)]
    pub tile: Option<Tile>,
    /// How compute stages load images [default: what suits the device].
    #[arg(long, value_enum)]
    pub loads: Option<Loads>,
    /// What stages over tiles are [default: what suits the device, stage by stage].
    #[arg(long, value_enum)]
    pub screen: Option<Screen>,
    /// Curvature of `preintegrated`; default: derivative at low and medium quality, vertex above.
    #[arg(long, value_enum)]
    pub forward_curvature: Option<ForwardCurvature>,
    /// Integral behind the look-up table of `pdss` and `preintegrated`.
    #[arg(long, value_enum, default_value_t)]
    pub integral: Integral,
    /// Where the surface's colour acts, for methods that scatter light itself; with the others it acts where light leaves.
    #[arg(long, value_enum, default_value_t)]
    pub texturing: Texturing,
    /// Kernel of `separable`.
    #[arg(long, value_enum, default_value_t)]
    pub separable_kernel: SeparableKernel,
    /// Light through thin parts. Default: slab; off for pdss and wrap, whose integral over a sphere holds the light that passes
    /// through it already.
    #[arg(long, value_enum)]
    pub transmittance: Option<Transmittance>,
    /// What the picture shows.
    #[arg(long, value_enum, default_value_t)]
    pub view: View,
    /// Tone curve of the PNG.
    #[arg(long, value_enum, default_value_t)]
    pub tone_map: ToneMap,
    /// Exposure in stops. Default: 0; for a PNG under --env, as a light meter held at the scene would have it.
    #[arg(long, allow_hyphen_values = true)]
    #[serde(serialize_with = "or_none")]
    pub exposure: Option<f32>,
    /// Ambient radiance, r,g,b or one grey number: from above and, after a colon, from below.
    #[arg(long, default_value = "0.03", value_parser = parse_ambient)]
    pub ambient: Ambient,
    /// Sheen of fine hair over the materials that have the profile, 0 (none) to 1.
    #[arg(long, default_value_t = 0., value_name = "X", value_parser = parse_share)]
    #[serde(skip_serializing_if = "is_zero")]
    pub fuzz: f32,
    /// Cast no shadows.
    #[arg(long)]
    pub no_shadows: bool,
    /// Draw shadow maps once and keep them from frame to frame, until a light moves: faster where scene and lights stand still,
    /// and nothing else may lie in their memory.
    #[arg(long)]
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub still: bool,
    /// No ambient occlusion from curvature.
    #[arg(long)]
    pub no_ao: bool,
    /// Gather no light from the shadow map: `moments` blurs all of it on the screen.
    #[arg(long)]
    pub no_translucent: bool,
    /// Bring back what the scene does not need, by name or all of it: the picture has the same bits, and takes longer.
    #[arg(long, value_name = "NAME", value_enum, value_delimiter = ',', num_args = 0.., require_equals = true, default_missing_value = "all")]
    pub no_elide: Vec<Spared>,
    /// Picture size in pixels.
    #[arg(long, default_value = "1650x1080", value_parser = parse_size, value_name = "WxH")]
    pub size: Size,
}

/// Width and height in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Size {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
}

/// Ambient radiance of a two-colour sky.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Ambient {
    /// From above.
    pub up: [f32; 3],
    /// From below.
    pub down: [f32; 3],
}

/// A record says what was taken.
fn or_none<S: serde::Serializer>(stops: &Option<f32>, to: S) -> Result<S::Ok, S::Error> {
    to.serialize_f32(stops.unwrap_or(0.))
}

impl Settings {
    /// How light passes through thin parts.
    pub fn through(&self) -> Transmittance {
        self.transmittance.unwrap_or(match self.method {
            Method::Pdss | Method::Wrap => Transmittance::Off,
            _ => Transmittance::Slab,
        })
    }

    /// These settings on a device: what nobody asked for is what suits it.
    pub fn on(&self, suit: Suit) -> Suit {
        let tile = self.tile.unwrap_or(suit.tile);
        let drawn = !suit.small_points && tile == Tile::Square;
        let fragments = self.screen.map_or(suit.fragments, Screen::fragments);
        Suit { tile, loads: self.loads.unwrap_or(suit.loads), fragments: if drawn { fragments } else { &[] }, ..suit }
    }

    /// Whether this runs although the scene may not need it.
    pub fn brings_back(&self, what: Spared) -> bool {
        self.no_elide.iter().any(|x| *x == what || *x == Spared::All)
    }
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            method: Method::default(),
            quality: Quality::default(),
            curvature: Curvature::default(),
            passes: None,
            resolution: None,
            kernels: Kernels::default(),
            tile: None,
            loads: None,
            screen: None,
            forward_curvature: None,
            integral: Integral::default(),
            texturing: Texturing::default(),
            separable_kernel: SeparableKernel::default(),
            transmittance: None,
            view: View::default(),
            tone_map: ToneMap::default(),
            exposure: None,
            ambient: Ambient { up: [0.03; 3], down: [0.03; 3] },
            fuzz: 0.,
            no_shadows: false,
            still: false,
            no_ao: false,
            no_translucent: false,
            no_elide: Vec::new(),
            size: Size { width: 1650, height: 1080 },
        }
    }
}

/// Width and height with an x between them, each 1 to 16384.
///
/// # Errors
/// A line that says what would be right.
pub fn parse_size(text: &str) -> Result<Size, String> {
    let wrong = || format!("{text:?} is not a size; 1650x1080 would be");
    let (w, h) = text.split_once(['x', 'X']).ok_or_else(wrong)?;
    let size = Size { width: w.parse().map_err(|_| wrong())?, height: h.parse().map_err(|_| wrong())? };
    if (1..=16384).contains(&size.width) && (1..=16384).contains(&size.height) {
        Ok(size)
    } else {
        Err(format!("{text:?} is out of range; each side is 1 to 16384 pixels"))
    }
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde's signature")]
fn is_zero(x: &f32) -> bool {
    *x == 0.
}

fn parse_share(text: &str) -> Result<f32, String> {
    let right = |x: &f32| (0. ..=1.).contains(x);
    text.parse().ok().filter(right).ok_or_else(|| "that does not lie in 0..1; 0.3 would".to_owned())
}

fn parse_ambient(text: &str) -> Result<Ambient, String> {
    let color = |t: &str| -> Result<[f32; 3], String> {
        let v: Vec<f32> =
            t.split(',').filter_map(|x| x.trim().parse().ok()).filter(|x: &f32| x.is_finite() && *x >= 0.).collect();
        match (v.as_slice(), t.split(',').count()) {
            ([g], 1) => Ok([*g; 3]),
            ([r, g, b], 3) => Ok([*r, *g, *b]),
            _ => Err(format!("{t:?} is not a colour; 0.03 or 0.02,0.03,0.04 would be")),
        }
    };
    let (up, down) = text.split_once(':').unwrap_or((text, text));
    Ok(Ambient { up: color(up)?, down: color(down)? })
}
