//! What the shaders are specialised by, from the facts of a frame.

use super::setup::{Output, Setup};
use crate::settings::{ToneMap, View};
use crate::skin::specular::Lobes;

impl Setup {
    /// Adds the specialization constants of a pass that loops over the lights.
    pub fn specialise_lights(&self, pass: &mut crate::plan::Pass) {
        pass.constant("LIGHTS", self.lights).constant("ALL_DIRECTIONAL", u32::from(self.all_directional));
    }

    /// Binds what a pass knows of the triangles, if it asks shadow maps and there is any.
    pub fn specialise_facets(&self, pass: &mut crate::plan::Pass, asks: bool) {
        let read = self.facets && asks;
        let soft = asks && self.diffuses && self.shadows.softened(self.levels.narrow_mm);
        pass.constant("SOFT", u32::from(soft));
        pass.constant("FACETS", u32::from(read));
        if !read {
            pass.absent("facet");
        }
    }

    /// Binds what light from all around is read from, or, where there is none, whatever is there anyway: specialised, the shader
    /// reads none of it.
    pub fn specialise_sky(&self, pass: &mut crate::plan::Pass) {
        pass.constant("SKY", u32::from(self.sky));
        if !self.sky {
            pass.bind("environment", "frame").bind("sky", "white").bind("bands", "white");
        }
    }

    /// Adds the specialization constants of a pass that reflects light, and what it reads of the G-buffer for it.
    pub fn specialise_gloss(&self, pass: &mut crate::plan::Pass) {
        pass.constants.extend(self.gloss());
        pass.constant("SPECULAR", u32::from(self.glossy));
        pass.constant("COATED", u32::from(self.coated)).constant("MASKED", u32::from(self.masked));
        if self.coated {
            pass.bind("smooth_normal", "normal");
        } else {
            pass.absent("smooth_normal");
            if self.thickest_mm == 0. {
                pass.absent("coat");
            }
        }
    }

    /// The same, by themselves.
    pub fn gloss(&self) -> Vec<(&'static str, u32)> {
        let mut gloss = vec![("FUZZ", self.settings.fuzz.to_bits()), ("TWO_LOBES", u32::from(self.lobes.is_some()))];
        if let Some(Lobes { roughness: [first, second], mix }) = self.lobes {
            let of = [("LOBE_FIRST", first), ("LOBE_SECOND", second), ("LOBE_MIX", mix)];
            gloss.extend(of.map(|(name, x)| (name, (x as f32).to_bits())));
        }
        gloss
    }

    /// What lighting writes, as the shaders count it: the lit picture, scattered light, irradiance, ambient visibility.
    pub fn lit_output(&self) -> u32 {
        match self.settings.view {
            View::Scatter => 1,
            View::Irradiance => 2,
            View::Ao => 3,
            _ => 0,
        }
    }

    /// The tone curve, as the shaders count them.
    pub fn tone_curve(&self) -> u32 {
        match (self.output, self.settings.tone_map) {
            (Output::Linear, _) => 2,
            _ if !self.overlay.draws.is_empty() => 2,
            (_, ToneMap::Linear) => 1,
            (_, ToneMap::Neutral) => 0,
        }
    }
}
