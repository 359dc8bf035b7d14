//! What a frame needs, found out from scene, camera, lights, profile and settings before anything is planned.

use super::levels::{LEAST_SIGMA_PX, Levels};
use super::overlay::Overlay;
use super::shadows::Shadows;
use super::uniforms::{MAX_LIGHTS, MAX_PROFILES};
use super::view::ViewFacts;
use super::{FrameError, Inputs};
use crate::methods::{self, texture_space};
use crate::scene::{Alpha, Atlas, Filled, Light, LightKind, gutter, is_convex};
use crate::settings::{Curvature, Method, Quality, Settings, Spared, Texturing, Transmittance, View};
use crate::skin::profile::Profile;
use crate::skin::specular::Lobes;
use ash::vk;

/// What becomes of the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Output {
    /// Tone-mapped, 8 bit, sRGB.
    Ldr,
    /// Linear, 32-bit float, exposed but not tone-mapped.
    Linear,
}

/// The facts that stages decide by.
#[derive(Clone, Debug)]
pub struct Setup {
    /// As asked for.
    pub settings: Settings,
    /// Index into the frame's profiles of the one that it is about.
    pub profile: usize,
    /// There are others beside it.
    pub several: bool,
    /// One of them comes before it.
    further: bool,
    /// Pixels.
    pub size: [u32; 2],
    /// 8-bit or linear; views other than lit ones are always linear.
    pub output: Output,
    /// Some visible material scatters.
    pub scatters: bool,
    /// Some material has a normal map.
    pub normal_maps: bool,
    /// Light falls on a normal of its own beside the interpolated one.
    pub bumped: bool,
    /// Some material is textured.
    pub uvs: bool,
    /// Some texture reads second coordinates.
    pub second_uvs: bool,
    /// Vertices have colours.
    pub colors: bool,
    /// Gloss is more than plain lobes: some material has a coat, sheen, or specular of its own.
    pub coated: bool,
    /// Some material reflects light.
    pub glossy: bool,
    /// Some material scatters a share of the light alone.
    pub masked: bool,
    /// The thickest that a scattering material says it is under its surface, mm; 0 where nobody says, or nobody asks.
    pub thickest_mm: f32,
    /// What is drawn over the lit picture.
    pub overlay: Overlay,
    /// The scene has texture coordinates, used or not.
    pub has_uvs: bool,
    /// Some material's colour is a texture.
    pub base_maps: bool,
    /// Some material is cut out by its alpha.
    pub cut_outs: bool,
    /// Timestamps are asked for.
    pub timed: bool,
    /// Some light travels further than a pixel under the surface.
    pub diffuses: bool,
    /// The blur of `pdss` and `moments`.
    pub levels: Levels,
    /// What the shaders of other methods read of the profile (`methods::kernel`).
    pub kernel: Vec<[f64; 4]>,
    /// The last rows of it: the Gaussians through which light may come from behind (`methods::behind`).
    pub behind: u32,
    /// Light is gathered, and divided by the kernel's mass.
    pub mass: bool,
    /// Shadows fall where shading normals stray from the triangles' own.
    pub facets: bool,
    /// Something that casts a shadow does not scatter.
    pub inert: bool,
    /// Gathered light lacks what shading normals add to the triangles' own; that is blurred beside it.
    pub detail: bool,
    /// Samples of each gathered Gaussian and light.
    pub taps: u32,
    /// One texel in so many of the shadow maps is gathered from, along each axis; 0 where nothing is.
    pub sparse_step: u32,
    /// The scene's texture coordinates, where the method works over them.
    pub atlas: Option<Atlas>,
    /// Part of a sheet's side that lies beside the unit square.
    pub border: f32,
    /// Texels beside the cuts of the unwrapping, and what fills them.
    pub gutter: Vec<Filled>,
    /// Shadow maps and slots.
    pub shadows: Shadows,
    /// Curvature is used.
    pub curvature: bool,
    /// Why it is not.
    pub why_no_curvature: &'static str,
    /// Ambient occlusion is used.
    pub ao: bool,
    /// It would be, and nothing is concave.
    pub convex: bool,
    /// There is ambient light.
    pub ambient: bool,
    /// Gloss of two lobes on the profile's materials.
    pub lobes: Option<Lobes>,
    /// Light comes from a picture of the sky, instead of from the two ambient colours.
    pub sky: bool,
    /// There is such a picture, of intensity 0.
    pub dark_sky: bool,
    /// The sky is drawn behind the scene.
    pub background: bool,
    /// Lights.
    pub lights: u32,
    /// What `shadows` were fitted to.
    shining: Vec<Light>,
    /// None of them is a point or a spot.
    pub all_directional: bool,
    /// Projection facts.
    pub view: ViewFacts,
}

impl Setup {
    /// Finds the facts, for each profile; for none where there is none.
    ///
    /// # Errors
    /// Where a view shows something that the method does not make.
    pub fn all(inputs: &Inputs<'_>) -> Result<Vec<Setup>, FrameError> {
        Self::after(&[], inputs)
    }

    /// As [`Setup::all`]; what another frame of the same scene has found out is not looked for again.
    pub(super) fn after(before: &[Setup], inputs: &Inputs<'_>) -> Result<Vec<Setup>, FrameError> {
        let count = inputs.profiles.len().max(1);
        if count > MAX_PROFILES {
            return Err(FrameError::Profiles { count });
        }
        let mut all: Vec<Setup> =
            (0..count).map(|k| Self::of(before.get(k), inputs, k)).collect::<Result<_, FrameError>>()?;
        let mut found = false;
        for s in &mut all {
            s.further = found;
            found |= s.scatters;
        }
        // What one of them needs of the G-buffer all draw.
        let atlas = all.iter().find_map(|s| s.atlas.clone());
        if atlas.is_some() {
            all.iter_mut().for_each(|s| (s.uvs, s.atlas) = (true, s.atlas.take().or_else(|| atlas.clone())));
        }
        Ok(all)
    }

    fn of(before: Option<&Setup>, inputs: &Inputs<'_>, index: usize) -> Result<Setup, FrameError> {
        let (scene, settings) = (inputs.scene, &inputs.settings);
        let (profile, several) = (inputs.profiles.get(index), inputs.profiles.len() > 1);
        if inputs.lights.len() > MAX_LIGHTS {
            return Err(FrameError::Lights { count: inputs.lights.len() });
        }
        let size = [settings.size.width, settings.size.height];
        let view = ViewFacts::new(&inputs.camera, size, scene.bounds.min, scene.bounds.max);
        let used = |test: &dyn Fn(&crate::scene::Material) -> bool| {
            scene.draws.iter().any(|d| d.index_count > 0 && scene.materials.get(d.material).is_some_and(test))
        };
        // What is left out changes no bit of the picture; without leaving out, it runs for nothing.
        let back = |what| settings.brings_back(what);
        let scatters = profile.is_some() && used(&|m| m.scatter == Some(index)) && settings.method != Method::Lambert;
        let mut levels = match profile {
            Some(profile) if scatters => Levels::new(profile, settings, view.magnification),
            _ => Levels { sharp: [1.; 3], length_mm: 1., ..Levels::default() },
        };
        let blurs = |p: &Profile| !Levels::new(p, settings, view.magnification).levels.is_empty();
        let blurred = !levels.levels.is_empty();
        let least_sigma_mm = LEAST_SIGMA_PX / view.magnification.nearest;
        let wide = |p: &Profile| p.gaussians().gaussians.iter().any(|g| g.variance.sqrt() >= least_sigma_mm);
        // One forward pass draws all of them.
        let together = settings.method == Method::Preintegrated && inputs.profiles.iter().any(wide);
        let diffuses = scatters && (together || profile.is_some_and(wide));
        let atlas = if diffuses && settings.method == Method::TextureSpace {
            let wrong = |why| FrameError::Atlas { scene: scene.name.clone(), why };
            let known = before.and_then(|b| b.atlas.clone());
            Some(known.map_or_else(|| Atlas::new(scene, index).map_err(wrong), Ok)?)
        } else {
            None
        };
        let reach_mm = profile.map_or(0., texture_space::reach_mm);
        let border = atlas.as_ref().map_or(0., |a| a.border(reach_mm) as f32);
        let side = texture_space::effort(settings.quality).0;
        let texel_mm = |a: &Atlas| a.side_mm / (f64::from(side) * f64::from(1. - 2. * border));
        let fill = |a: &Atlas| gutter(a, side, f64::from(border), reach_mm / a.side_mm);
        let gutter = match before {
            Some(b) => b.gutter.clone(),
            None => atlas.as_ref().map_or(Vec::new(), fill),
        };
        let kernel = match profile {
            Some(profile) if diffuses => {
                methods::kernel(settings, profile, least_sigma_mm, atlas.as_ref().map_or(0., texel_mm))
            }
            _ => Vec::new(),
        };
        let passes = !matches!(settings.method, Method::Lambert | Method::Moments | Method::TextureSpace);
        let behind = profile.filter(|_| diffuses && passes).map_or(0, |p| methods::behind(p).len() as u32);
        let environment = scene.environment.as_ref().filter(|_| settings.view == View::Final);
        let shines = environment.is_some_and(|e| e.intensity > 0.);
        let sky = shines || environment.is_some() && back(Spared::Environment);
        let colors = settings.ambient.up.iter().chain(&settings.ambient.down);
        let ambient = !shines && (back(Spared::Ambient) || colors.into_iter().any(|x| *x > 0.));
        let lit = matches!(settings.view, View::Final | View::Ao);
        let asked = ((ambient || shines) && !settings.no_ao) || settings.view == View::Ao;
        let asked = lit && asked && !levels.levels.is_empty();
        // Other estimators see edges and contours as hollows.
        let metric = settings.curvature == Curvature::Metric;
        let convex = asked && metric && before.map_or_else(|| is_convex(scene), |b| b.convex);
        let ao = asked && (!convex || settings.view == View::Ao || back(Spared::Occlusion));
        let wanted = settings.view == View::Curvature || settings.view == View::SoftCurvature;
        let bent = match settings.method {
            Method::Pdss => blurred,
            Method::Wrap => diffuses,
            _ => false,
        };
        let curvature = wanted || ao || bent || (back(Spared::Curvature) && scatters);
        let why_no_curvature = match (scatters, settings.method) {
            (false, _) => "no material scatters",
            (_, Method::Pdss) if !blurred => "every level projects below a pixel",
            (_, Method::Lambert) => "nothing scatters",
            _ => "the method does not use curvature, and no ambient occlusion does",
        };
        let soft = matches!(settings.view, View::SoftNormal | View::SoftCurvature);
        let mut shadows = match before {
            Some(b) if b.shining == inputs.lights => b.shadows.clone(),
            _ => Shadows::new(inputs),
        };
        if !(blurred || several && inputs.profiles.iter().any(blurs)) && settings.view != View::Lit {
            // Nobody blurs visibility: lighting looks it up itself, at full precision.
            shadows.without_slots();
        }
        // A shadow map does not say by which profile its surface scatters.
        let taps = if several { 0 } else { gather_taps(settings, shadows.scattered() as u32) };
        let texel = shadows.gatherable(&inputs.lights).filter(|_| taps > 0 && is_lit(settings.view));
        let sparse_step = texel.map_or(0, |texel| levels.gather(f64::from(texel)));
        let mass = levels.levels.iter().any(|l| l.gathered);
        let normal_maps = used(&|m| m.normal_texture.is_some()) && !scene.tangents.is_empty();
        let missing = if soft && !blurred {
            Some("a blurred level; take --method pdss or moments, a scattering profile, and come closer")
        } else if settings.view == View::Lit && shadows.slots == 0 {
            Some("a light that casts a shadow")
        } else if settings.view == View::Ao && !ao {
            Some("a blurred level of curvature; take --method pdss or moments and a scattering profile")
        } else {
            None
        };
        if let Some(what) = missing {
            return Err(FrameError::View { view: settings.view, what });
        }
        let overlay = match settings.view {
            View::Final => Overlay::new(scene, &inputs.camera),
            _ => Overlay::default(),
        };
        let through = scatters
            && is_lit(settings.view)
            && settings.view != View::Irradiance
            && settings.through() != Transmittance::Off
            && !matches!(settings.method, Method::Lambert | Method::Moments);
        let has_uvs = !scene.uvs.is_empty();
        let idle_uvs = back(Spared::TextureCoordinates) || back(Spared::Textures);
        let uvs = (idle_uvs || used(&|m| m.is_textured()) || atlas.is_some()) && has_uvs;
        let falls = !shadows.matrices.is_empty() && (is_lit(settings.view) || shadows.slots > 0);
        let facets = falls && before.map_or_else(|| normal_maps || super::mass::strays(scene), |b| b.facets);
        let lit_picture = settings.view == View::Final;
        let glossy = lit_picture && (back(Spared::Specular) || settings.fuzz > 0. || used(&|m| m.reflects()));
        Ok(Setup {
            profile: index,
            several,
            further: false,
            size,
            output: if is_lit(settings.view) { inputs.output } else { Output::Linear },
            scatters,
            // The shaders that write mass alone have no place for it.
            bumped: normal_maps || back(Spared::NormalMap) && (facets || !mass),
            normal_maps,
            uvs,
            second_uvs: uvs && !scene.second_uvs.is_empty(),
            colors: !scene.colors.is_empty(),
            glossy,
            coated: glossy && (back(Spared::Coat) || used(&|m| m.is_coated())),
            masked: scatters
                && used(&|m| m.scatter.is_some() && (m.scatter_mask < 1. || m.scatter_mask_texture.is_some())),
            thickest_mm: if through { thickest(scene) } else { 0. },
            overlay,
            has_uvs,
            base_maps: used(&|m| m.base_color_texture.is_some()),
            cut_outs: used(&|m| alpha_cutoff(m.alpha).is_some()),
            timed: inputs.timing.is_some() || back(Spared::Timestamps),
            diffuses,
            mass,
            facets,
            inert: used(&|m| m.scatter.is_none() && m.alpha != Alpha::Blend),
            detail: mass && facets,
            taps,
            sparse_step,
            levels,
            kernel,
            behind,
            atlas,
            border,
            gutter,
            shadows,
            curvature,
            why_no_curvature,
            ao,
            convex,
            ambient,
            lobes: profile.and_then(|p| p.lobes).filter(|_| used(&|m| m.scatter == Some(index))),
            sky,
            dark_sky: environment.is_some() && !shines,
            background: shines && environment.is_some_and(|e| e.background.is_some()),
            lights: inputs.lights.len() as u32,
            shining: inputs.lights.clone(),
            all_directional: !back(Spared::Places)
                && inputs.lights.iter().all(|l| matches!(l.kind, LightKind::Directional { .. })),
            view,
            settings: settings.clone(),
        })
    }

    /// Of several profiles that scatter, it is not the first: what all share is there already.
    pub fn is_further(&self) -> bool {
        self.further
    }

    /// The picture is made by lighting, not by showing a target.
    pub fn lit_view(&self) -> bool {
        is_lit(self.settings.view)
    }

    /// The target that lighting ends in.
    pub fn picture(&self) -> &'static str {
        if self.overlay.draws.is_empty() { self.kept() } else { "exr" }
    }

    /// The target that the frame ends in.
    pub fn kept(&self) -> &'static str {
        if self.output == Output::Linear { "exr" } else { "ldr" }
    }

    /// Half of the surface's colour acts before scattering.
    pub fn pre_textured(&self) -> bool {
        self.settings.texturing == Texturing::PrePost && self.settings.view == View::Final
    }

    /// Format of the stream of texture coordinates.
    pub fn uv_format(&self) -> vk::Format {
        if self.second_uvs { vk::Format::R32G32B32A32_SFLOAT } else { vk::Format::R32G32_SFLOAT }
    }

    /// Pixels of the picture.
    pub fn pixels(&self) -> u64 {
        u64::from(self.size[0]) * u64::from(self.size[1])
    }

    /// The target that holds the normal that light falls on.
    pub fn shading_normal(&self) -> &'static str {
        if self.bumped { "bumped" } else { "normal" }
    }
}

/// Fewest samples of a light among many, and of all of them.
const LEAST_TAPS: (u32, u32) = (16, 128);

/// Samples of each Gaussian that is gathered from the shadow map of one of so many lights; 0: light is blurred on the screen alone.
/// Where there are more than two, all take together what two would, or so many that a few lights are no worse for it.
fn gather_taps(settings: &Settings, lights: u32) -> u32 {
    let taps = match (settings.method, settings.quality) {
        _ if settings.no_translucent => 0,
        (Method::Moments, Quality::Low) => 32,
        (Method::Moments, Quality::Medium | Quality::High) => 64,
        (Method::Moments, Quality::Ultra) => 128,
        _ => 0,
    };
    if lights > 2 && taps > 0 { ((2 * taps).max(LEAST_TAPS.1) / lights).max(LEAST_TAPS.0) } else { taps }
}

fn is_lit(view: View) -> bool {
    matches!(view, View::Final | View::Scatter | View::Irradiance | View::Ao)
}

/// The thickest that a drawn material that scatters says it is, mm.
fn thickest(scene: &crate::scene::Scene) -> f32 {
    let drawn = scene.draws.iter().filter_map(|d| scene.materials.get(d.material));
    drawn.filter(|m| m.scatter.is_some()).map(|m| m.thickness_mm).fold(0., f32::max)
}

/// What a material that is drawn with an alpha test covers at least.
pub fn alpha_cutoff(alpha: Alpha) -> Option<f32> {
    match alpha {
        Alpha::Mask(cutoff) => Some(cutoff),
        Alpha::Opaque | Alpha::Blend => None,
    }
}
