//! tiles: viewz -> lists of the tiles that hold a surface, and that hold a scattering one, at each stride in use.

use crate::frame::setup::Setup;
use crate::plan::{Domain, Plan};
use crate::settings::Spared;
use crate::shaders;

/// Tiles of the picture that hold any surface; for all profiles but the first, surface that scatters by it.
const SURFACE: &str = "surface_tiles";

/// Over the tiles of the picture that hold any surface.
pub fn surface() -> Domain {
    Domain::Tiles(SURFACE.to_owned(), 1)
}

/// Over the scattering tiles on a grid of `stride` pixels.
pub fn scattering(stride: u32) -> Domain {
    Domain::Tiles(scatter(stride).to_owned(), stride)
}

fn scatter(stride: u32) -> &'static str {
    match stride {
        1 => "scatter_tiles",
        2 => "scatter_tiles2",
        _ => "scatter_tiles4",
    }
}

/// Adds a clear of the picture, before whoever writes it: tiles without a surface are never visited, and their colour is the
/// clear's. As late as that, the picture can lie where what has been read already lay.
pub fn background(plan: &mut Plan, s: &Setup) {
    plan.once("clear", |plan| plan.clear("clear", s.picture(), [0.; 4]));
}

/// Adds the passes.
pub fn add(plan: &mut Plan, s: &Setup) {
    let mut strides: Vec<u32> = std::iter::once(1).chain(s.levels.levels.iter().map(|l| l.stride)).collect();
    strides.sort_unstable();
    strides.dedup();
    let [width, height] = plan.suit.tile.sides();
    let tiles = |stride: u32| s.size[0].div_ceil(width * stride) * s.size[1].div_ceil(height * stride);
    let mut lists = vec![(SURFACE, 1)];
    if s.scatters {
        lists.extend(strides.iter().map(|stride| (scatter(*stride), *stride)));
    } else {
        plan.leave_out("scatter tiles", "no material scatters", 0);
    }
    for (name, stride) in &lists {
        plan.buffer(name, 16 + 4 * u64::from(tiles(*stride)));
    }
    let empty: [u32; 4] = [0, 1, 1, 0];
    plan.update("reset tiles", lists.iter().map(|l| l.0.to_owned()).collect(), bytemuck::bytes_of(&empty).to_vec());
    for stride in strides {
        if stride > 1 && !s.scatters {
            continue;
        }
        let name = if stride == 1 { "tiles".to_owned() } else { format!("tiles/{stride}") };
        let pass = plan
            .compute(&name, &shaders::TILES, Domain::Threads([tiles(stride), 1]))
            .constant("STRIDE", stride)
            .constant("TILE_X", width)
            .constant("TILE_Y", height)
            .constant("SURFACE", u32::from(stride == 1))
            .constant("SCATTER", u32::from(s.scatters))
            .constant("OWN", u32::from(s.is_further()))
            .constant("EVERY", u32::from(s.settings.brings_back(Spared::Tiles)))
            .bind("scatter_tiles", if s.scatters { scatter(stride) } else { SURFACE });
        if stride > 1 {
            // Not touched as specialised; bound to the list that is written anyway, so that nobody waits for another.
            pass.bind("surface_tiles", scatter(stride));
        }
    }
}
