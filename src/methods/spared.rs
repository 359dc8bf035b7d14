//! What is left out of a whole frame rather than of one stage; stages say for themselves what they leave out.

use crate::frame::setup::{Output, Setup};
use crate::plan::Plan;
use crate::settings::{Method, Spared, View};

/// Notes what this frame does without.
pub fn note(plan: &mut Plan, s: &Setup) {
    let lit = s.lit_view();
    if s.settings.method != Method::Lambert && !s.diffuses {
        let why =
            if s.scatters { "all of it projects below a pixel: a point of light" } else { "no material scatters" };
        plan.leave_out("scattering", why, 0);
    }
    if lit && !s.ambient {
        plan.leave_out("ambient light", "its radiance is 0", 0).back = Some(Spared::Ambient);
    }
    if lit && s.diffuses && !s.ao && matches!(s.settings.method, Method::Pdss | Method::Moments) {
        let why = if s.convex {
            "nothing is concave"
        } else if s.settings.no_ao {
            "--no-ao"
        } else if s.settings.view != View::Final {
            "the view shows none"
        } else {
            "there is no ambient light"
        };
        plan.leave_out("ambient occlusion", why, 0).back = s.convex.then_some(Spared::Occlusion);
    }
    if s.settings.view == View::Final && !s.glossy {
        plan.leave_out("specular", "no material reflects anything", 0).back = Some(Spared::Specular);
    }
    if lit && s.lights == 0 {
        plan.leave_out("light loop", "there is no light", 0);
    } else if lit && s.all_directional {
        plan.leave_out("distance and cone of lights", "all lights are directional", 0).back = Some(Spared::Places);
    }
    if !(s.base_maps || plan.textured) {
        plan.leave_out("albedo textures", "no material has one: no look-up is compiled in", 0).back =
            s.has_uvs.then_some(Spared::Textures);
    }
    if !(s.cut_outs || plan.cut_out) {
        plan.leave_out("alpha test", "no material is cut out: depth is tested before shading", 0).back =
            Some(Spared::AlphaTest);
    }
    if s.output == Output::Linear {
        plan.leave_out("tone map", "the picture is linear", 0);
    }
    if !s.timed {
        plan.leave_out("timestamps", "not asked for", 0).back = Some(Spared::Timestamps);
    }
    if s.settings.method != Method::Preintegrated && !s.settings.brings_back(Spared::Tiles) {
        plan.leave_out("empty tiles", "stages run over lists of those that hold a surface, or a scattering one", 0)
            .back = Some(Spared::Tiles);
    }
}
