//! Where each image lies: images that are never needed at once take turns in the same bytes.

use super::{Plan, TargetPlan, texel_bytes};
use crate::gpu::Gpu;
use crate::gpu::image::ImageDesc;
use std::collections::BTreeMap;

/// What an image's memory must be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Need {
    /// Bytes: the texels where no device has been asked, what the device asks for otherwise.
    pub bytes: u64,
    /// What its offset is a multiple of.
    pub alignment: u64,
    /// A bit for each type of memory that serves.
    pub types: u32,
}

impl Need {
    /// Before a device has been asked: its texels, anywhere.
    pub fn of_texels(desc: &ImageDesc) -> Need {
        Need { bytes: texels(desc), alignment: 1, types: !0 }
    }

    /// As the device asks.
    pub fn on(gpu: &Gpu, desc: &ImageDesc) -> Need {
        let asked = gpu.requirements(desc);
        Need { bytes: asked.size, alignment: asked.alignment, types: asked.memory_type_bits }
    }
}

/// Bytes of texels of an image.
pub fn texels(desc: &ImageDesc) -> u64 {
    u64::from(desc.size[0]) * u64::from(desc.size[1]) * u64::from(desc.layers) * texel_bytes(desc.format)
}

impl Plan {
    /// Replaces what images were thought to need by what a device asks for, and arranges memory and barriers anew.
    pub fn fit(&mut self, ask: impl Fn(&ImageDesc) -> Need) {
        self.targets.values_mut().for_each(|t| t.need = ask(&t.desc));
        self.arrange();
    }

    /// Bytes of device memory for the frame's images: what they take, and what they would take if none shared any.
    pub fn bytes(&self) -> (u64, u64) {
        (self.arenas().values().map(|a| a.bytes).sum(), self.targets.values().map(|t| t.need.bytes).sum())
    }

    /// What each arena must be.
    pub fn arenas(&self) -> BTreeMap<usize, Need> {
        let mut all: BTreeMap<usize, Need> = BTreeMap::new();
        for t in self.targets.values() {
            let arena = all.entry(t.arena).or_insert(Need { bytes: 0, alignment: 1, types: t.need.types });
            arena.bytes = arena.bytes.max(t.offset + t.need.bytes);
            arena.alignment = arena.alignment.max(t.need.alignment);
        }
        all
    }

    /// The images that lie over some byte of this one.
    pub fn overlapping(&self, name: &str, t: &TargetPlan) -> Vec<String> {
        let over = |x: &TargetPlan| {
            x.arena == t.arena && x.offset < t.offset + t.need.bytes && t.offset < x.offset + x.need.bytes
        };
        self.targets.iter().filter(|(n, x)| *n != name && over(x)).map(|(n, _)| n.clone()).collect()
    }

    /// Places each image as low as the ones that live at the same time let it. Which order packs best depends on the frame,
    /// so several are tried: the largest first, those that live longest first, those that are needed first.
    pub(super) fn share_memory(&mut self) {
        let mut kinds: Vec<u32> = self.targets.values().map(|t| t.need.types).collect();
        kinds.sort_unstable();
        kinds.dedup();
        for t in self.targets.values_mut() {
            t.arena = kinds.iter().position(|k| *k == t.need.types).unwrap_or_default();
        }
        type Key = fn(&TargetPlan) -> (u64, u64);
        let orders: [Key; 3] = [
            |t| (!t.need.bytes, t.lifetime.0 as u64),
            |t| (!((t.lifetime.1 - t.lifetime.0) as u64), !t.need.bytes),
            |t| (t.lifetime.0 as u64, !t.need.bytes),
        ];
        let placed = orders.map(|key| self.placed(key));
        let best = placed.into_iter().min_by_key(|(bytes, _)| *bytes).map(|(_, offsets)| offsets).unwrap_or_default();
        for (name, offset) in best {
            self.targets.entry(name).and_modify(|t| t.offset = offset);
        }
    }

    /// Offsets by first fit in this order, and the sum of where they end in each arena.
    fn placed(&self, key: fn(&TargetPlan) -> (u64, u64)) -> (u64, Vec<(String, u64)>) {
        let mut order: Vec<(&String, &TargetPlan)> = self.targets.iter().collect();
        order.sort_by_key(|(_, t)| key(t));
        let mut done: Vec<(&String, &TargetPlan, u64)> = Vec::new();
        let mut ends: BTreeMap<usize, u64> = BTreeMap::new();
        for (name, t) in order {
            let meets =
                |x: &TargetPlan| x.arena == t.arena && x.lifetime.0 <= t.lifetime.1 && t.lifetime.0 <= x.lifetime.1;
            let mut taken: Vec<(u64, u64)> =
                done.iter().filter(|(_, x, _)| meets(x)).map(|(_, x, at)| (*at, at + x.need.bytes)).collect();
            taken.sort_unstable();
            let mut offset = 0u64;
            for (from, to) in taken {
                if offset + t.need.bytes > from {
                    offset = offset.max(to.next_multiple_of(t.need.alignment));
                }
            }
            let end = ends.entry(t.arena).or_default();
            *end = (*end).max(offset + t.need.bytes);
            done.push((name, t, offset));
        }
        (ends.values().sum(), done.into_iter().map(|(n, _, at)| (n.clone(), at)).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ash::vk;

    /// Images by side of a square of 4-byte texels and lifetime.
    fn plan(images: &[(u32, (usize, usize))]) -> Plan {
        let mut p = Plan::default();
        for (i, (side, lifetime)) in images.iter().enumerate() {
            let name = format!("image{i}");
            p.image_as(&name, vk::Format::R32_UINT, [*side; 2], 1);
            p.targets.entry(name).and_modify(|t| t.lifetime = *lifetime);
        }
        p
    }

    /// Pairs that live at once and lie over each other.
    fn clashes(p: &Plan) -> usize {
        let meets = |a: &TargetPlan, b: &TargetPlan| a.lifetime.0 <= b.lifetime.1 && b.lifetime.0 <= a.lifetime.1;
        let of = |(name, t): (&String, &TargetPlan)| {
            p.overlapping(name, t).iter().filter(|other| meets(t, &p.targets[*other])).count()
        };
        p.targets.iter().map(of).sum::<usize>() / 2
    }

    #[test]
    fn who_lives_at_once_lies_apart_and_the_rest_share() {
        // Two small ones take the place of a large one; a third lives with all of them.
        let mut p = plan(&[(8, (0, 3)), (4, (4, 6)), (4, (5, 9)), (2, (0, 9)), (8, (7, 8))]);
        p.share_memory();
        assert_eq!(clashes(&p), 0);
        let (shared, unshared) = p.bytes();
        assert_eq!(unshared, 4 * (64 + 16 + 16 + 4 + 64));
        assert_eq!(shared, 4 * (64 + 16 + 4), "as much as pass 7 needs, and no byte more");
        // The twin: one lifetime longer than was planned with.
        p.targets.entry("image0".to_owned()).and_modify(|t| t.lifetime.1 = 9);
        assert!(clashes(&p) > 0);
    }

    #[test]
    fn a_device_that_asks_for_more_gets_it() {
        let mut p = plan(&[(8, (0, 1)), (4, (0, 1)), (4, (2, 3))]);
        p.fit(|desc| Need { bytes: texels(desc) + 1, alignment: 256, types: if desc.size[0] == 8 { 1 } else { 2 } });
        assert!(p.targets.values().all(|t| t.offset % 256 == 0));
        assert_eq!(p.targets["image0"].arena, 0);
        assert_eq!((p.targets["image1"].arena, p.targets["image2"].arena), (1, 1), "another kind of memory");
        assert_eq!(p.bytes(), (257 + 65, 257 + 65 + 65));
    }
}
