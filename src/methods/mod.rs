//! The ways to shade: one file a method, its whole frame as a list, one line a stage.

pub mod burley;
mod gaussians;
mod lambert;
mod moments;
mod pdss;
pub mod preintegrated;
pub mod separable;
mod spared;
pub mod texture_space;
mod wrap;

use crate::frame::resources::external;
use crate::frame::setup::Setup;
use crate::gpu::Suit;
use crate::plan::{Plan, PlanError};
use crate::settings::{Method, Settings, Spared, View};
use crate::skin::profile::{Gaussian, Profile};
use crate::stages;

/// Plans the frame of a method, and the view asked for: of each profile that scatters, one after the other. What they share
/// the first brings.
///
/// # Errors
/// Where a stage and its shader disagree, or a view shows what the method does not make.
pub fn plan(setups: &[Setup], suit: Suit) -> Result<Plan, PlanError> {
    let mut plan = Plan { external: external(setups.len()), ..Plan::default() };
    let Some(first) = setups.first() else { return Ok(plan) };
    plan.suit = first.settings.on(suit);
    let back = |what| first.settings.brings_back(what);
    (plan.textured, plan.cut_out) = (back(Spared::Textures) && first.uvs, back(Spared::AlphaTest));
    plan.image(first.picture(), first.size);
    let scattering: Vec<&Setup> = setups.iter().filter(|s| s.scatters).collect();
    for s in if scattering.is_empty() { vec![first] } else { scattering } {
        plan.profile = s.several.then_some(s.profile);
        frame(&mut plan, s);
    }
    plan.profile = None;
    stages::background::add(&mut plan, first);
    if first.settings.view == View::Final && !first.sky {
        let why = if first.dark_sky { "its intensity is 0" } else { "no sky is given: ambient light has two colours" };
        plan.leave_out("environment", why, 0).back = first.dark_sky.then_some(Spared::Environment);
    }
    stages::overlay::add(&mut plan, first);
    stages::tonemap::add(&mut plan, first);
    spared::note(&mut plan, first);
    plan.keep(first.kept());
    if first.settings.still && !back(Spared::Still) {
        plan.keep_still(&["shadow", "entrance"]);
        if plan.still > 0 {
            plan.leave_out("shadow maps, but in the first frame", "--still: no light moves", 0).back =
                Some(Spared::Still);
        }
    }
    plan.finish()?;
    Ok(plan)
}

fn frame(plan: &mut Plan, s: &Setup) {
    // What projects below a pixel everywhere is a point, and nothing is left to scatter.
    let method = if s.diffuses { s.settings.method } else { Method::Lambert };
    match method {
        Method::Lambert => lambert::frame(plan, s),
        Method::Pdss => pdss::frame(plan, s),
        Method::Moments => moments::frame(plan, s),
        Method::Preintegrated => preintegrated::frame(plan, s),
        Method::TextureSpace => texture_space::frame(plan, s),
        Method::Gaussians => gaussians::frame(plan, s),
        Method::Separable => separable::frame(plan, s),
        Method::Burley => burley::frame(plan, s),
        Method::Wrap => wrap::frame(plan, s),
    }
    if s.pre_textured() && !plan.has("irradiance") {
        plan.leave_out(
            "colour before scattering",
            "the method scatters no light, so colour acts where light leaves",
            0,
        );
    }
    if !s.lit_view() {
        stages::view::add(plan, s);
    }
}

/// What a method's own shaders read of the profile: a few rows of four, empty where the method needs none. What projects
/// to fewer pixels than a Gaussian of `least_sigma_mm` does is not told from a point; `texel_mm` is the size of a texel where the
/// method works over texture coordinates.
pub fn kernel(settings: &Settings, profile: &Profile, least_sigma_mm: f64, texel_mm: f64) -> Vec<[f64; 4]> {
    match settings.method {
        Method::Lambert | Method::Moments => Vec::new(),
        Method::Pdss => behind(profile),
        Method::Preintegrated => [preintegrated::kernel(profile), behind(profile)].concat(),
        Method::TextureSpace => texture_space::kernel(settings, profile, least_sigma_mm, texel_mm),
        Method::Gaussians => [gaussians::kernel(settings.quality, profile, least_sigma_mm), behind(profile)].concat(),
        Method::Separable => [separable::kernel(settings, profile), behind(profile)].concat(),
        Method::Burley => [burley::kernel(profile), behind(profile)].concat(),
        Method::Wrap => [wrap::kernel(profile), behind(profile)].concat(),
    }
}

/// The Gaussians through which light comes from behind, the last rows of [`kernel`] where the method has any: weight, variance in
/// mm^2.
pub fn behind(profile: &Profile) -> Vec<[f64; 4]> {
    let all = profile.gaussians().gaussians.into_iter();
    let rows = all.map(|Gaussian { weight: [r, g, b], variance }| [r, g, b, variance]);
    rows.collect()
}
