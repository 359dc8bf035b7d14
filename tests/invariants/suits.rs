//! What suits a device changes no bit: the shape of a tile, how images are loaded, whether a stage is a compute or a fragment shader.
use crate::Outcome;
use crate::same_bits::{SCATTERING, torus};
use pdss::frame::Renderer;
use pdss::gpu::Gpu;
use pdss::gpu::suit::{Loads, Screen, Tile};
use pdss::gpu::usage::Usage;
use pdss::plan::Work;
use pdss::settings::{Kernels, Method, Quality, View};
use pdss::shaders::ALL;
use std::sync::Arc;

pub fn same_bits(gpu: &Arc<Gpu>) -> Vec<Outcome> {
    const GLSL: Kernels = Kernels::Glsl;
    let all = [
        (Tile::Row, Loads::Sampled, GLSL, Screen::Compute),
        (Tile::Square, Loads::Storage, GLSL, Screen::Fragment),
        (Tile::Row, Loads::Storage, Kernels::Spirv, Screen::Compute),
        (Tile::Square, Loads::Sampled, Kernels::Spirv, Screen::Fragment),
        (Tile::Flat, Loads::Storage, GLSL, Screen::Compute),
    ];
    let mut outcomes = Vec::new();
    // `preintegrated` draws all it does.
    let over_tiles = SCATTERING.into_iter().filter(|m| *m != Method::Preintegrated);
    for method in std::iter::once(Method::Lambert).chain(over_tiles) {
        let mut set = torus(method, View::Final);
        (set.settings.quality, set.settings.screen) = (Quality::Medium, Some(Screen::Compute));
        let plain = set.linear(gpu);
        for (tile, loads, kernels, screen) in &all[..if method == Method::Pdss { all.len() } else { 2 }] {
            let mut other = torus(method, View::Final);
            other.settings.quality = Quality::Medium;
            (other.settings.tile, other.settings.loads, other.settings.kernels) = (Some(*tile), Some(*loads), *kernels);
            other.settings.screen = Some(*screen);
            let n = plain.differing(&other.linear(gpu));
            // The plan is not the same, or nothing was tried: its tiles have these sides, images are sampled, stages draw.
            let plan = Renderer::plan_only(&other.inputs()).expect("a plan");
            let tiled = plan.passes.iter().flat_map(|p| &p.constants).filter(|c| c.0 == "TILE_X");
            let widths: Vec<u32> = tiled.map(|c| c.1).collect();
            let sampled = plan.passes.iter().flat_map(|p| &p.accesses);
            let sampled = sampled.filter(|(name, usage)| name == "viewz" && is_sampled(*usage)).count();
            let draws = plan.passes.iter().filter(|p| matches!(p.work, Work::Fragments { .. })).count();
            let tried = !widths.is_empty()
                && widths.iter().all(|w| *w == tile.sides()[0])
                && (sampled > 0) == (*loads == Loads::Sampled)
                && (draws > 0) == (*screen == Screen::Fragment);
            // The twin: a picture that is not the same, by one part in a thousand.
            let mut brighter = plain.clone();
            brighter.texels.iter_mut().flatten().for_each(|x| *x *= 1.001);
            let off = plain.differing(&brighter);
            let text = format!(
                "{method:?}, {tile:?}, {loads:?}, {kernels:?}, {screen:?}: {n} pixels differ; {} passes over such tiles, {draws} draw, {sampled} sample viewz; brighter by .1 %: {off}",
                widths.len()
            );
            outcomes.push(Outcome { text, holds: n == 0 && tried, can_fail: off > 500 });
        }
    }
    outcomes
}

/// Every stem that the settings name has a fragment shader, and no stage that has one is forgotten.
pub fn fragments() -> Outcome {
    let made = |stem: &str| ALL.iter().any(|s| s.stem == stem && s.fragment.is_some());
    let named = Screen::Fragment.fragments();
    let forgotten = ALL.iter().filter(|s| s.fragment.is_some() && !named.contains(&s.stem)).count();
    let holds = named.iter().all(|stem| made(stem)) && forgotten == 0;
    // The twin: a stage that stores to what it reads has none.
    let text = format!("{} stems have fragment shaders, {forgotten} forgotten", named.len());
    Outcome { text, holds, can_fail: !made("translucent") && made("visibility") }
}

fn is_sampled(usage: Usage) -> bool {
    matches!(usage, Usage::ComputeSampled | Usage::FragmentSampled)
}
