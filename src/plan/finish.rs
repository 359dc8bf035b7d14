//! From what passes touch to lifetimes, shared memory and barriers.

use super::{Domain, Plan, PlanError, Work};
use crate::gpu::usage::{State, Usage};
use crate::shaders::{self, BindingKind, Shader};
use ash::vk;
use std::collections::BTreeMap;

impl Plan {
    /// Decides accesses, lifetimes, shared memory and barriers.
    ///
    /// # Errors
    /// Where a shader names a resource that is not there, or reads one that nobody has written.
    pub fn finish(&mut self) -> Result<(), PlanError> {
        for index in 0..self.passes.len() {
            let accesses = self.accesses(index)?;
            for (name, usage) in &accesses {
                if let Some(t) = self.targets.get_mut(name) {
                    if t.lifetime.0 == usize::MAX && !usage.access().discards && !name.starts_with("absent") {
                        return Err(PlanError::Unwritten {
                            pass: self.passes[index].name.clone(),
                            resource: name.clone(),
                        });
                    }
                    t.lifetime = (t.lifetime.0.min(index), t.lifetime.1.max(index));
                    t.desc.usage |= image_usage(*usage);
                }
            }
            self.passes[index].accesses = accesses;
        }
        let unused: Vec<String> =
            self.targets.iter().filter(|(_, t)| t.lifetime.0 == usize::MAX).map(|(n, _)| n.clone()).collect();
        for name in unused {
            self.targets.remove(&name);
        }
        self.arrange();
        Ok(())
    }

    /// Gives each image its place in memory, and places the barriers that follow.
    pub(super) fn arrange(&mut self) {
        self.share_memory();
        let tenants = self.targets.iter().map(|(name, t)| (name.clone(), self.overlapping(name, t))).collect();
        self.place_barriers(&tenants);
    }

    /// What a pass touches, from its shader and attachments.
    fn accesses(&mut self, index: usize) -> Result<Vec<(String, Usage)>, PlanError> {
        self.resolve(index);
        let pass = self.passes[index].clone();
        let mut list: Vec<(String, Usage)> = Vec::new();
        let shaders: Vec<&'static Shader> = match &pass.work {
            Work::Compute { shader, domain } => {
                if let Domain::Tiles(buffer, _) = domain {
                    list.push((buffer.clone(), Usage::Indirect));
                }
                vec![shader]
            }
            Work::Fragments { shader, list: tiles, colors, keep } => {
                list.push((tiles.clone(), Usage::Indirect));
                let color = if *keep { Usage::ColorOver } else { Usage::ColorAttachment };
                list.extend(colors.iter().map(|name| (name.clone(), color)));
                vec![&shaders::TILES_VERT, shader]
            }
            Work::Raster { vertex, fragment, state, colors, depth, .. } => {
                let (color, tested) = match state.over {
                    true => (Usage::ColorOver, Usage::DepthTest),
                    false => (Usage::ColorAttachment, Usage::DepthAttachment),
                };
                list.extend(colors.iter().map(|(name, _)| (name.clone(), color)));
                list.extend(depth.iter().map(|d| (d.0.clone(), tested)));
                std::iter::once(*vertex).chain(*fragment).collect()
            }
            Work::Update { buffers, .. } => return Ok(buffers.iter().map(|b| (b.clone(), Usage::CopyTo)).collect()),
            Work::Clear { image, .. } => return Ok(vec![(image.clone(), Usage::CopyTo)]),
        };
        let compute = matches!(pass.work, Work::Compute { .. });
        for b in shaders.iter().flat_map(|s| s.bindings) {
            let name = pass.aliases.get(b.name).map_or(b.name, String::as_str);
            let mut name = self.meant(name, pass.profile);
            if pass.profile.is_some() {
                self.passes[index].aliases.insert(b.name, name.clone());
            }
            if self.external.contains(&name) {
                continue;
            }
            let usage = match (b.kind, compute, b.read, b.write) {
                (BindingKind::SampledImage, true, ..) => Usage::ComputeSampled,
                (BindingKind::SampledImage, false, ..) => Usage::FragmentSampled,
                (BindingKind::Uniform, true, ..) => Usage::ComputeUniform,
                (BindingKind::Uniform, false, ..) => Usage::GraphicsUniform,
                (_, false, ..) => Usage::GraphicsRead,
                (_, true, true, false) => Usage::ComputeRead,
                (BindingKind::StorageImage, true, false, true) => Usage::ComputeWrite,
                (_, true, ..) => Usage::ComputeReadWrite,
            };
            if name.is_empty() {
                name = self.placeholder(b.kind, b.format);
                self.passes[index].aliases.insert(b.name, name.clone());
            }
            if !self.targets.contains_key(&name) && !self.buffers.contains_key(&name) {
                return Err(PlanError::Unknown { pass: pass.name, resource: name });
            }
            if !list.iter().any(|(n, u)| *n == name && *u == usage) {
                list.push((name, usage));
            }
        }
        Ok(list)
    }

    /// Says of what a pass works on, apart from its shader, whose it is.
    fn resolve(&mut self, index: usize) {
        let profile = self.passes[index].profile;
        let mut work = self.passes[index].work.clone();
        let meant = |name: &mut String| *name = self.meant(name, profile);
        match &mut work {
            Work::Compute { domain: Domain::Tiles(list, _), .. } => meant(list),
            Work::Fragments { shader, list, colors, keep } => {
                meant(list);
                let aliases = &self.passes[index].aliases;
                let output = |name: &&'static str| aliases.get(name).map_or((*name).to_owned(), String::clone);
                // What this pass does not write comes last.
                *colors = shader.outputs.iter().map(output).take_while(|name| !name.is_empty()).collect();
                colors.iter_mut().for_each(meant);
                *keep = colors.iter().any(|c| self.targets.get(c).is_some_and(|t| t.lifetime.0 != usize::MAX));
            }
            Work::Compute { .. } => {}
            Work::Raster { colors, depth, .. } => {
                colors.iter_mut().for_each(|c| meant(&mut c.0));
                depth.iter_mut().for_each(|d| meant(&mut d.0));
            }
            Work::Update { buffers, .. } => buffers.iter_mut().for_each(meant),
            Work::Clear { image, .. } => meant(image),
        }
        self.passes[index].work = work;
    }

    /// A texel to bind where a specialised shader names a resource that it will not read.
    fn placeholder(&mut self, kind: BindingKind, format: vk::Format) -> String {
        let sampled = kind == BindingKind::SampledImage;
        let format = match format {
            vk::Format::UNDEFINED if sampled => vk::Format::R8G8B8A8_UNORM,
            format => format,
        };
        let name = format!("absent {} {format:?}", if sampled { "sampled" } else { "storage" });
        if !self.targets.contains_key(&name) {
            self.image_as(&name, format, [1, 1], 1);
        }
        name
    }

    /// Walks the frame twice: the first round finds how each resource ends a frame, the second starts from there, so that
    /// a frame may follow another without the host between them.
    fn place_barriers(&mut self, tenants: &BTreeMap<String, Vec<String>>) {
        let mut states: BTreeMap<String, State> = BTreeMap::new();
        for _ in 0..2 {
            let mut first_use: BTreeMap<String, bool> = BTreeMap::new();
            let mut drawn: BTreeMap<String, Vec<u32>> = BTreeMap::new();
            for pass in &mut self.passes {
                pass.barriers.clear();
                let layer = match &pass.work {
                    Work::Raster { depth: Some((_, layer, _)), .. } => *layer,
                    _ => None,
                };
                for (name, usage) in &pass.accesses {
                    let image = self.targets.contains_key(name);
                    // Each layer is another piece of memory: who draws one waits for nobody who has drawn others.
                    let array = self.targets.get(name).is_some_and(|t| t.desc.array);
                    if let Some(layer) = layer.filter(|_| array) {
                        let before = drawn.entry(name.clone()).or_default();
                        let apart = !before.is_empty() && !before.contains(&layer);
                        before.push(layer);
                        if apart {
                            continue;
                        }
                    }
                    let known = states.get(name).copied().unwrap_or(State::NEW);
                    let mut state = known;
                    if image && !std::mem::replace(first_use.entry(name.clone()).or_insert(false), true) {
                        state = state.reborn();
                        for other in tenants.get(name).into_iter().flatten() {
                            state = state.and(states.get(other).unwrap_or(&State::NEW));
                        }
                    }
                    if let Some(barrier) = state.next(*usage, image) {
                        pass.barriers.push((name.clone(), barrier));
                    }
                    states.insert(name.clone(), state);
                }
            }
        }
    }
}

fn image_usage(usage: Usage) -> vk::ImageUsageFlags {
    match usage {
        Usage::ComputeRead | Usage::ComputeWrite | Usage::ComputeReadWrite | Usage::GraphicsRead => {
            vk::ImageUsageFlags::STORAGE
        }
        Usage::ComputeSampled | Usage::FragmentSampled => vk::ImageUsageFlags::SAMPLED,
        Usage::ColorAttachment | Usage::ColorOver => vk::ImageUsageFlags::COLOR_ATTACHMENT,
        Usage::DepthAttachment | Usage::DepthTest => vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT,
        Usage::CopyFrom => vk::ImageUsageFlags::TRANSFER_SRC,
        Usage::CopyTo => vk::ImageUsageFlags::TRANSFER_DST,
        _ => vk::ImageUsageFlags::empty(),
    }
}
