//! What suits a device changes no bit: the shape of a tile, how images are loaded.
use crate::Outcome;
use crate::same_bits::{SCATTERING, torus};
use pdss::frame::Renderer;
use pdss::gpu::Gpu;
use pdss::gpu::suit::{Loads, Tile};
use pdss::gpu::usage::Usage;
use pdss::settings::{Kernels, Method, Quality, View};
use std::sync::Arc;

pub fn same_bits(gpu: &Arc<Gpu>) -> Vec<Outcome> {
    const GLSL: Kernels = Kernels::Glsl;
    let all = [
        (Tile::Row, Loads::Sampled, GLSL),
        (Tile::Row, Loads::Storage, Kernels::Spirv),
        (Tile::Broad, Loads::Sampled, Kernels::Spirv),
        (Tile::Flat, Loads::Storage, GLSL),
    ];
    let mut outcomes = Vec::new();
    // `preintegrated` draws all it does.
    let over_tiles = SCATTERING.into_iter().filter(|m| *m != Method::Preintegrated);
    for method in std::iter::once(Method::Lambert).chain(over_tiles) {
        let mut set = torus(method, View::Final);
        set.settings.quality = Quality::Medium;
        let plain = set.linear(gpu);
        for (tile, loads, kernels) in &all[..if method == Method::Pdss { all.len() } else { 1 }] {
            let mut other = torus(method, View::Final);
            other.settings.quality = Quality::Medium;
            (other.settings.tile, other.settings.loads, other.settings.kernels) = (Some(*tile), Some(*loads), *kernels);
            let n = plain.differing(&other.linear(gpu));
            // The plan is not the same, or nothing was tried: its tiles have these sides, and images are sampled.
            let plan = Renderer::plan_only(&other.inputs()).expect("a plan");
            let tiled = plan.passes.iter().flat_map(|p| &p.constants).filter(|c| c.0 == "TILE_X");
            let widths: Vec<u32> = tiled.map(|c| c.1).collect();
            let sampled = plan.passes.iter().flat_map(|p| &p.accesses);
            let sampled = sampled.filter(|(name, usage)| name == "viewz" && *usage == Usage::ComputeSampled).count();
            let tried = !widths.is_empty()
                && widths.iter().all(|w| *w == tile.sides()[0])
                && (sampled > 0) == (*loads == Loads::Sampled);
            // The twin: a picture that is not the same, by one part in a thousand.
            let mut brighter = plain.clone();
            brighter.texels.iter_mut().flatten().for_each(|x| *x *= 1.001);
            let off = plain.differing(&brighter);
            let text = format!(
                "{method:?}, {tile:?}, {loads:?}, {kernels:?}: {n} pixels differ; {} passes over such tiles, {sampled} sample viewz; brighter by .1 %: {off}",
                widths.len()
            );
            outcomes.push(Outcome { text, holds: n == 0 && tried, can_fail: off > 500 });
        }
    }
    outcomes
}
