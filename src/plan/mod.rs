//! Scene and settings in; stages, targets and barriers out. Everything is decided, and can be printed, before anything is
//! created. Stages add themselves through [`Plan::compute`] and [`Plan::raster`]; what a pass reads and writes is read from
//! its shader, so that barriers follow from the SPIR-V and nobody lists them by hand.

use crate::gpu::image::ImageDesc;
use crate::gpu::pipeline::Raster;
use crate::gpu::suit::{Loads, Suit};
use crate::gpu::usage::{Barrier, Usage};
use crate::settings::Spared;
use crate::shaders::Shader;
use crate::targets;
use ash::vk;
use std::collections::BTreeMap;

mod finish;
mod memory;
mod pass;

pub use memory::Need;

/// What cannot be planned; a fault of a stage or a shader, not of the input.
#[derive(Debug, thiserror::Error)]
pub enum PlanError {
    /// A shader names a resource that nobody made.
    #[error("{pass}: nothing in the plan is called `{resource}`")]
    Unknown {
        /// The pass.
        pass: String,
        /// The name.
        resource: String,
    },
    /// A target is read before anyone wrote it.
    #[error("{pass} reads `{resource}` before anything has written it")]
    Unwritten {
        /// The pass.
        pass: String,
        /// The name.
        resource: String,
    },
}

/// Over what a compute pass runs.
#[derive(Clone, Debug, PartialEq)]
pub enum Domain {
    /// This many threads.
    Threads([u32; 2]),
    /// The tiles of a list, by indirect dispatch: the buffer of that name holds the count. The grid has so many pixels a texel.
    Tiles(String, u32),
}

/// What a pass does.
#[derive(Clone, Debug, PartialEq)]
pub enum Work {
    /// A compute shader.
    Compute {
        /// The module.
        shader: &'static Shader,
        /// Over what.
        domain: Domain,
    },
    /// A fragment shader over the tiles of a list, a point each, by indirect draw.
    Fragments {
        /// The module.
        shader: &'static Shader,
        /// The buffer that holds the list and its count.
        list: String,
        /// Colour targets by location; [`Plan::finish`] finds them.
        colors: Vec<String>,
        /// What they hold already is kept.
        keep: bool,
    },
    /// The scene's meshes, drawn.
    Raster {
        /// Vertex module.
        vertex: &'static Shader,
        /// Fragment module; none where only depth is wanted.
        fragment: Option<&'static Shader>,
        /// Fixed-function state.
        state: Raster,
        /// Colour targets and their clear values as raw bits; without one whatever was there may stay.
        colors: Vec<(String, Option<[u32; 4]>)>,
        /// Depth target, its layer, its clear value; none where nothing hides anything.
        depth: Option<(String, Option<u32>, f32)>,
        /// Which vertex attributes are fetched, and which materials are drawn.
        geometry: Geometry,
    },
    /// A few words written to the start of each of some buffers.
    Update {
        /// The buffers.
        buffers: Vec<String>,
        /// The words.
        bytes: Vec<u8>,
    },
    /// An image cleared to a colour.
    Clear {
        /// The image.
        image: String,
        /// The colour.
        value: [f32; 4],
    },
}

/// Which part of the scene a raster pass draws.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Geometry {
    /// Every material in one draw, positions alone.
    Depth,
    /// What does not scatter, positions alone.
    Inert,
    /// A draw per material, with its textures.
    Materials,
    /// The same, both sides of every triangle: whatever is in a light's way.
    Casters,
    /// The same for the materials that scatter alone, both sides of every triangle.
    Unwrapped,
    /// A draw per material of those that are drawn over the picture, blended ones in order.
    Overlay,
}

/// One step of the frame.
#[derive(Clone, Debug)]
pub struct Pass {
    /// Name, also the debug label and the name in timings.
    pub name: String,
    /// What it does.
    pub work: Work,
    /// Specialization constants.
    pub constants: Vec<(&'static str, u32)>,
    /// Push constants.
    pub push: Vec<u8>,
    /// Shader binding names that mean another resource here.
    pub aliases: BTreeMap<&'static str, String>,
    /// What it touches, in order of first use.
    pub accesses: Vec<(String, Usage)>,
    /// What must be waited for before it; filled by [`Plan::finish`].
    pub barriers: Vec<(String, Barrier)>,
    /// The profile of several that it works for: names mean that profile's own where there are such.
    pub profile: Option<usize>,
    /// Specialization constants that differ by the profile of what is drawn, for a pass that draws the materials of several.
    pub each: Vec<(usize, Vec<(&'static str, u32)>)>,
}

/// An image of the frame.
#[derive(Clone, Debug)]
pub struct TargetPlan {
    /// What it is.
    pub desc: ImageDesc,
    /// First and last pass that touch it.
    pub lifetime: (usize, usize),
    /// What its memory must be.
    pub need: Need,
    /// Memory it lies in: images that the same kinds of memory serve share one.
    pub arena: usize,
    /// Where it begins there, bytes. Images that are never needed at once may overlap.
    pub offset: u64,
    /// It outlives the frame: the host reads it.
    pub kept: bool,
}

/// A buffer of the frame, written by the device.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BufferPlan {
    /// Name.
    pub name: String,
    /// Bytes.
    pub bytes: u64,
}

/// Something that this scene or these settings do not need.
#[derive(Clone, Debug, serde::Serialize)]
pub struct LeftOut {
    /// What is not there.
    pub what: String,
    /// Why.
    pub why: String,
    /// Bytes of images that are not made.
    pub bytes: u64,
    /// What brings it back, so that what it would cost can be timed; none where the picture would not have the same bits, or
    /// nothing would run.
    pub back: Option<Spared>,
}

/// The whole frame, decided.
#[derive(Clone, Debug, Default)]
pub struct Plan {
    /// Passes in order.
    pub passes: Vec<Pass>,
    /// Images by name.
    pub targets: BTreeMap<String, TargetPlan>,
    /// Device-written buffers by name.
    pub buffers: BTreeMap<String, BufferPlan>,
    /// So many passes at the start draw what stands still; frames to come may begin behind them ([`Plan::keep_still`]).
    pub still: usize,
    /// Materials are drawn as if each had textures of colour, roughness and occlusion.
    pub textured: bool,
    /// Materials are drawn as if each were cut out.
    pub cut_out: bool,
    /// What was left out.
    pub left_out: Vec<LeftOut>,
    /// How it runs on the device that it is for.
    pub suit: Suit,
    /// Resources made outside of the frame and never written by it (scene buffers, tables).
    pub external: Vec<String>,
    /// What is added belongs to this profile of several; none: to all of them, or there is one.
    pub profile: Option<usize>,
    /// What all profiles share and is there already.
    pub done: Vec<&'static str>,
}

/// A name as the profile of that index knows it, where several have one of their own.
pub fn of_profile(name: &str, profile: usize) -> String {
    format!("{name}@{profile}")
}

impl Plan {
    /// Declares an image by its line in [`targets::TARGETS`].
    pub fn image(&mut self, name: &str, size: [u32; 2]) {
        self.image_as(name, targets::describe(name).map_or(vk::Format::R32_UINT, |t| t.format), size, 1);
    }

    /// Declares an image of another format or with layers.
    pub fn image_as(&mut self, name: &str, format: vk::Format, size: [u32; 2], layers: u32) {
        let array = matches!(name, "shadow" | "entrance" | "inert" | "sparse");
        let name = self.own(name);
        let mut desc = ImageDesc::new(&name, format, size, vk::ImageUsageFlags::empty());
        (desc.layers, desc.array) = (layers, array);
        let (need, lifetime) = (Need::of_texels(&desc), (usize::MAX, 0));
        self.targets.insert(name, TargetPlan { desc, lifetime, need, arena: 0, offset: 0, kept: false });
    }

    /// Declares a buffer that the device writes.
    pub fn buffer(&mut self, name: &str, bytes: u64) {
        let name = self.own(name);
        self.buffers.insert(name.clone(), BufferPlan { name, bytes });
    }

    /// The name of something that is being made: a profile of several makes its own.
    fn own(&self, name: &str) -> String {
        self.profile.map_or_else(|| name.to_owned(), |k| of_profile(name, k))
    }

    /// What a name means to a profile of several: its own, if it has one, else what all share.
    fn meant(&self, name: &str, profile: Option<usize>) -> String {
        let known =
            |n: &String| self.targets.contains_key(n) || self.buffers.contains_key(n) || self.external.contains(n);
        profile.map(|k| of_profile(name, k)).filter(known).unwrap_or_else(|| name.to_owned())
    }

    /// Adds what all profiles of the frame share, for the first of them that comes to it.
    pub fn once(&mut self, what: &'static str, add: impl FnOnce(&mut Plan)) {
        if !self.done.contains(&what) {
            self.done.push(what);
            self.shared(add);
        }
    }

    /// Adds what is of no profile's own.
    pub fn shared(&mut self, add: impl FnOnce(&mut Plan)) {
        let profile = self.profile.take();
        add(self);
        self.profile = profile;
    }

    /// Whether a frame recorded from this plan is one of `other`, too: the same passes with the same constants over the same
    /// images. Where those lie may differ.
    pub fn records_as(&self, other: &Plan) -> bool {
        let images = |p: &Plan| -> Vec<_> {
            p.targets.iter().map(|(n, t)| (n.clone(), t.desc.format, t.desc.size, t.desc.layers)).collect()
        };
        let same = |(a, b): (&Pass, &Pass)| {
            (&a.name, &a.work, &a.constants, &a.push, &a.aliases, &a.each)
                == (&b.name, &b.work, &b.constants, &b.push, &b.aliases, &b.each)
        };
        self.passes.len() == other.passes.len()
            && self.passes.iter().zip(&other.passes).all(same)
            && images(self) == images(other)
            && self.buffers == other.buffers
    }

    /// Notes something that is not needed.
    pub fn leave_out(&mut self, what: &str, why: impl Into<String>, bytes: u64) -> &mut LeftOut {
        self.left_out.push(LeftOut { what: self.own(what), why: why.into(), bytes, back: None });
        let last = self.left_out.len() - 1;
        &mut self.left_out[last]
    }

    /// Whether there is a target of this name.
    pub fn has(&self, name: &str) -> bool {
        self.targets.contains_key(&self.meant(name, self.profile))
    }

    /// Keeps a target's content for the host: no other is laid over it until the next frame begins. In a plan that is finished
    /// already, [`Plan::fit`] must follow.
    pub fn keep(&mut self, name: &str) {
        if let Some(t) = self.targets.get_mut(name) {
            t.kept = true;
            t.lifetime.1 = self.passes.len();
            t.desc.usage |= vk::ImageUsageFlags::TRANSFER_SRC;
        }
    }

    /// Keeps from frame to frame what the passes at the start draw into these images alone, if no later one does.
    pub fn keep_still(&mut self, images: &[&str]) {
        let draws = |pass: &Pass| match &pass.work {
            Work::Raster { colors, depth, .. } => {
                let mut all = colors.iter().map(|c| &c.0).chain(depth.as_ref().map(|d| &d.0));
                all.all(|name| images.contains(&name.as_str()))
            }
            _ => false,
        };
        let first = self.passes.iter().take_while(|p| draws(p)).count();
        if first == 0 || self.passes[first..].iter().any(draws) {
            return;
        }
        self.still = first;
        for name in images {
            if let Some(t) = self.targets.get_mut(*name) {
                t.lifetime.1 = self.passes.len();
            }
        }
    }

    fn pass(&mut self, name: &str, work: Work) -> &mut Pass {
        self.passes.push(Pass {
            name: self.own(name),
            profile: self.profile,
            each: Vec::new(),
            work,
            constants: Vec::new(),
            push: Vec::new(),
            aliases: BTreeMap::new(),
            accesses: Vec::new(),
            barriers: Vec::new(),
        });
        let last = self.passes.len() - 1;
        &mut self.passes[last]
    }

    /// Adds a compute pass, or over tiles a fragment pass where that suits the device; what it touches is read from the shader.
    pub fn compute(&mut self, name: &str, shader: &'static Shader, domain: Domain) -> &mut Pass {
        let as_suits = |s: &'static Shader| s.sampled.filter(|_| self.suit.loads == Loads::Sampled).unwrap_or(s);
        let drawn = shader.fragment.filter(|_| self.suit.fragments.contains(&shader.stem));
        let [width, height] = self.suit.tile.sides();
        let (list, grid) = match &domain {
            Domain::Threads(_) => return self.pass(name, Work::Compute { shader: as_suits(shader), domain }),
            Domain::Tiles(list, grid) => (list.clone(), *grid),
        };
        let work = match drawn.map(as_suits) {
            Some(shader) => Work::Fragments { shader, list: list.clone(), colors: Vec::new(), keep: false },
            None => Work::Compute { shader: as_suits(shader), domain },
        };
        let pass = self.pass(name, work);
        pass.bind("tile_list", list).constant("TILE_X", width).constant("TILE_Y", height);
        if drawn.is_some() {
            pass.constant("GRID", grid);
        }
        pass
    }

    /// Adds a raster pass over the scene's meshes.
    #[allow(clippy::too_many_arguments)]
    pub fn raster(
        &mut self,
        name: &str,
        vertex: &'static Shader,
        fragment: Option<&'static Shader>,
        state: Raster,
        colors: Vec<(String, Option<[u32; 4]>)>,
        depth: Option<(String, Option<u32>, f32)>,
        geometry: Geometry,
    ) -> &mut Pass {
        self.pass(name, Work::Raster { vertex, fragment, state, colors, depth, geometry })
    }

    /// The pass of that name, if it is there.
    pub fn find(&mut self, name: &str) -> Option<&mut Pass> {
        self.passes.iter_mut().find(|p| p.name == name)
    }

    /// Adds a write of a few words into buffers.
    pub fn update(&mut self, name: &str, buffers: Vec<String>, bytes: Vec<u8>) {
        self.pass(name, Work::Update { buffers, bytes });
    }

    /// Adds a clear of an image.
    pub fn clear(&mut self, name: &str, image: &str, value: [f32; 4]) {
        self.pass(name, Work::Clear { image: image.to_owned(), value });
    }

    /// Bytes of texels of one image.
    pub fn target_bytes(&self, t: &TargetPlan) -> u64 {
        memory::texels(&t.desc)
    }
}

/// Bytes of a texel of the formats in use.
pub fn texel_bytes(format: vk::Format) -> u64 {
    match format {
        vk::Format::R32G32_UINT | vk::Format::R16G16B16A16_SFLOAT => 8,
        vk::Format::R32G32B32A32_SFLOAT | vk::Format::R32G32B32A32_UINT => 16,
        _ => 4,
    }
}
