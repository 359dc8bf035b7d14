//! A plan in words: what runs, what waits for what and why, what is kept where, and what is not there at all.

use super::table::Table;
use super::traffic::{self, human};
use crate::gpu::usage::Barrier;
use crate::plan::{Domain, Geometry, LeftOut, Pass, Plan, Work};
use crate::skin::profile::Profile;
use crate::targets;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt::{self, Display};

/// A plan, explained.
#[derive(Clone, Debug, Serialize)]
pub struct Explanation {
    /// Version of this record's shape.
    pub schema: u32,
    /// The diffusion profiles, if something scatters.
    pub profiles: Vec<ProfileWords>,
    /// Passes in order.
    pub passes: Vec<PassWords>,
    /// Images of the frame.
    pub targets: Vec<TargetWords>,
    /// Buffers that the device writes: name and bytes.
    pub buffers: Vec<(String, u64)>,
    /// Bytes of images as they share memory.
    pub bytes_shared: u64,
    /// Bytes of images if none shared.
    pub bytes_unshared: u64,
    /// Estimated bytes read and written per frame and pixel of the picture.
    pub bytes_per_pixel: f64,
    /// Bytes of images beside G-buffer and shadow maps, the picture among them, per pixel of it, as they share memory.
    pub bytes_per_pixel_beside_gbuffer: f64,
    /// What is not there.
    pub left_out: Vec<LeftOut>,
    /// Bytes of images as they share memory that each of these would take if it were brought back.
    pub saved_bytes: BTreeMap<String, u64>,
    /// Median ms of a frame that brings each of these back, less a frame that does not; where it was measured.
    pub saved_ms: BTreeMap<String, f64>,
}

/// What every deferred frame has, whatever it does with light.
const GBUFFER: [&str; 7] = ["depth", "viewz", "normal", "bumped", "albedo", "material", "coat"];

/// A profile as the frame uses it.
#[derive(Clone, Debug, Serialize)]
pub struct ProfileWords {
    /// Its name.
    pub name: String,
    /// Where its figures come from.
    pub source: String,
    /// Variance in mm^2 and weight per channel of each Gaussian.
    pub gaussians: Vec<(f64, [f64; 3])>,
    /// L1 error of 2 pi r R(r), the worst channel; 0 where the profile is such a sum itself.
    pub fit_error: f64,
}

impl ProfileWords {
    /// Fits the profile, and says how well.
    pub fn of(profile: &Profile) -> ProfileWords {
        let fit = profile.gaussians();
        ProfileWords {
            name: profile.name.clone(),
            source: profile.source.clone(),
            gaussians: fit.gaussians.iter().map(|g| (g.variance, g.weight)).collect(),
            fit_error: fit.error,
        }
    }
}

impl Display for ProfileWords {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let how =
            if self.fit_error == 0. { "exact".to_owned() } else { format!("fitted, L1 error {:.3}", self.fit_error) };
        writeln!(f, "profile {}: {} Gaussians, {how} ({})", self.name, self.gaussians.len(), self.source)?;
        for (variance, [r, g, b]) in &self.gaussians {
            writeln!(f, "    sigma {:7.4} mm, weight {r:.3} {g:.3} {b:.3}", variance.sqrt())?;
        }
        Ok(())
    }
}

/// One pass.
#[derive(Clone, Debug, Serialize)]
pub struct PassWords {
    /// Its name.
    pub name: String,
    /// Over what it runs.
    pub domain: String,
    /// Shaders, by name.
    pub shaders: Vec<&'static str>,
    /// Specialization constants.
    pub constants: Vec<(&'static str, u32)>,
    /// Resources of the frame it reads.
    pub reads: Vec<String>,
    /// Resources of the frame it writes.
    pub writes: Vec<String>,
    /// Estimated bytes read.
    pub bytes_read: u64,
    /// Estimated bytes written.
    pub bytes_written: u64,
    /// What it waits for.
    pub barriers: Vec<BarrierWords>,
}

/// One barrier.
#[derive(Clone, Debug, Serialize)]
pub struct BarrierWords {
    /// What it guards.
    pub resource: String,
    /// Stages waited for, and the writes made available.
    pub from: String,
    /// Stages that wait, and the accesses made visible to.
    pub to: String,
    /// Layout before and after; none for buffers.
    pub layouts: Option<String>,
    /// Why it is needed.
    pub reason: String,
}

/// One image.
#[derive(Clone, Debug, Serialize)]
pub struct TargetWords {
    /// Its name.
    pub name: String,
    /// Texel format.
    pub format: String,
    /// Width, height, layers.
    pub size: [u32; 3],
    /// Bytes of texels.
    pub bytes: u64,
    /// First and last pass that touch it.
    pub lifetime: [String; 2],
    /// Where it begins in the frame's memory, bytes; images that are never needed at once may overlap.
    pub offset: u64,
    /// The host reads it after the frame.
    pub kept: bool,
    /// What a texel means, who writes and who reads it.
    pub meaning: &'static str,
}

impl Explanation {
    /// Explains a plan for a picture of this many pixels.
    pub fn of(plan: &Plan, pixels: u64) -> Explanation {
        let (bytes_shared, bytes_unshared) = plan.bytes();
        let frame = traffic::of_frame(plan);
        Explanation {
            schema: super::record::SCHEMA,
            profiles: Vec::new(),
            passes: (0..plan.passes.len()).map(|i| pass_words(plan, i)).collect(),
            targets: target_words(plan),
            buffers: plan.buffers.values().map(|b| (b.name.clone(), b.bytes)).collect(),
            bytes_shared,
            bytes_unshared,
            bytes_per_pixel: (frame.read + frame.written) as f64 / pixels.max(1) as f64,
            bytes_per_pixel_beside_gbuffer: beside(plan, bytes_shared) as f64 / pixels.max(1) as f64,
            left_out: plan.left_out.clone(),
            saved_bytes: BTreeMap::new(),
            saved_ms: BTreeMap::new(),
        }
    }
}

/// What is left of `bytes` without the G-buffer and shadow maps.
fn beside(plan: &Plan, bytes: u64) -> u64 {
    let fixed = plan.targets.iter().filter(|(n, _)| GBUFFER.contains(&n.as_str()) || *n == "shadow");
    bytes.saturating_sub(fixed.map(|(_, t)| t.need.bytes).sum())
}

fn pass_words(plan: &Plan, index: usize) -> PassWords {
    let pass = &plan.passes[index];
    let names = |wanted: fn((bool, bool)) -> bool| -> Vec<String> {
        let mut list: Vec<String> = Vec::new();
        for (name, usage) in &pass.accesses {
            if wanted(traffic::directions(*usage)) && !list.contains(name) {
                list.push(name.clone());
            }
        }
        list
    };
    let traffic = traffic::of_pass(plan, pass);
    PassWords {
        name: pass.name.clone(),
        domain: domain(pass),
        shaders: match &pass.work {
            Work::Compute { shader, .. } | Work::Fragments { shader, .. } => vec![shader.name],
            Work::Raster { vertex, fragment, .. } => {
                std::iter::once(vertex.name).chain(fragment.map(|f| f.name)).collect()
            }
            Work::Update { .. } | Work::Clear { .. } => Vec::new(),
        },
        constants: pass.constants.clone(),
        reads: names(|(reads, _)| reads),
        writes: names(|(_, writes)| writes),
        bytes_read: traffic.read,
        bytes_written: traffic.written,
        barriers: pass.barriers.iter().map(|(name, b)| barrier_words(plan, index, name, b)).collect(),
    }
}

fn domain(pass: &Pass) -> String {
    match &pass.work {
        Work::Compute { shader, domain } => {
            let [x, y, _] = shader.workgroup;
            match domain {
                Domain::Threads([w, h]) => format!("{w} x {h} threads in groups of {x} x {y}"),
                Domain::Tiles(list, _) => tiles(pass, list),
            }
        }
        Work::Fragments { list, .. } => format!("{}, a point each", tiles(pass, list)),
        Work::Raster { geometry: Geometry::Depth, .. } => "all meshes in one draw, positions alone".to_owned(),
        Work::Raster { geometry: Geometry::Inert, .. } => "meshes that do not scatter, positions alone".to_owned(),
        Work::Raster { geometry: Geometry::Materials, .. } => "meshes, a draw per material".to_owned(),
        Work::Raster { geometry: Geometry::Overlay, .. } => {
            "what is blended, unlit or gives off light, back to front".to_owned()
        }
        Work::Raster { geometry: Geometry::Casters, .. } => "meshes, both sides, a draw per material".to_owned(),
        Work::Raster { geometry: Geometry::Unwrapped, .. } => {
            "scattering meshes laid out by their texture coordinates, a draw per material".to_owned()
        }
        Work::Update { bytes, .. } => format!("an update of {} bytes", bytes.len()),
        Work::Clear { .. } => "a clear".to_owned(),
    }
}

fn tiles(pass: &Pass, list: &str) -> String {
    let side = |name| pass.constants.iter().find(|c| c.0 == name).map_or(0, |c| c.1);
    format!("the tiles listed in {list}, of {} x {}", side("TILE_X"), side("TILE_Y"))
}

fn barrier_words(plan: &Plan, index: usize, name: &str, barrier: &Barrier) -> BarrierWords {
    let image = plan.targets.contains_key(name);
    let side = |stage: String, access: String| match (stage.is_empty(), access.is_empty()) {
        (true, _) => "nothing".to_owned(),
        (false, true) => stage,
        (false, false) => format!("{stage} ({access})"),
    };
    let layouts = if barrier.old_layout == barrier.new_layout {
        format!("stays {:?}", barrier.new_layout)
    } else {
        format!("{:?} -> {:?}", barrier.old_layout, barrier.new_layout)
    };
    BarrierWords {
        resource: name.to_owned(),
        from: side(format!("{:?}", barrier.src_stage), format!("{:?}", barrier.src_access)),
        to: side(format!("{:?}", barrier.dst_stage), format!("{:?}", barrier.dst_access)),
        layouts: image.then_some(layouts),
        reason: reason(plan, index, name, barrier),
    }
}

/// Why a pass waits for a resource.
fn reason(plan: &Plan, index: usize, name: &str, barrier: &Barrier) -> String {
    let me = &plan.passes[index].name;
    let usages = |i: usize| plan.passes[i].accesses.iter().filter(|(n, _)| n == name).map(|(_, u)| *u);
    let writes = |i: usize| usages(i).any(|u| u.access().writes);
    let transition = plan.targets.contains_key(name) && barrier.old_layout != barrier.new_layout;
    let Some(last) = (0..index).rev().find(|&i| usages(i).next().is_some()) else {
        return first_use(plan, index, name, barrier);
    };
    let writer = (0..index).rev().find(|&i| writes(i));
    let readers: Vec<&str> = (writer.map_or(0, |w| w + 1)..index)
        .filter(|&i| usages(i).next().is_some())
        .map(|i| plan.passes[i].name.as_str())
        .collect();
    let written_by = writer.map_or("the frame before", |w| plan.passes[w].name.as_str());
    let hazard = match (writes(index), readers.is_empty()) {
        (true, false) => format!("write after read: {me} writes what {} read", readers.join(", ")),
        (true, true) if usages(index).any(|u| u.access().writes && !u.access().discards) => {
            format!("read after write: {me} reads and adds to what {written_by} wrote")
        }
        (true, true) => format!("write after write: {me} writes over what {written_by} wrote"),
        (false, _) if transition && last != writer.unwrap_or(usize::MAX) => {
            return format!(
                "layout: {} read it as {:?}, {me} reads it as {:?}",
                plan.passes[last].name, barrier.old_layout, barrier.new_layout
            );
        }
        (false, _) => format!("read after write: {me} reads what {written_by} wrote"),
    };
    if transition { format!("{hazard}, in another layout") } else { hazard }
}

/// Why a pass waits before it is the first of its frame to touch a resource.
fn first_use(plan: &Plan, index: usize, name: &str, barrier: &Barrier) -> String {
    let me = &plan.passes[index].name;
    if barrier.src_stage.is_empty() {
        return format!("layout: {me} starts it with undefined content");
    }
    let last_user = |resource: &str| {
        let last = plan.passes.iter().rposition(|p| p.accesses.iter().any(|(n, _)| n == resource));
        last.map(|i| (i, format!("{resource} ({})", plan.passes[i].name)))
    };
    let own = last_user(name).map_or_else(|| name.to_owned(), |(_, words)| words);
    let over = plan.targets.get(name).map_or(Vec::new(), |t| plan.overlapping(name, t));
    let sharers: Vec<(usize, String)> = over.iter().filter_map(|n| last_user(n)).collect();
    let Some((_, words)) = sharers.iter().filter(|(i, _)| *i < index).max_by_key(|(i, _)| *i) else {
        let mut before: Vec<String> = sharers.into_iter().map(|(_, words)| words).collect();
        before.push(own);
        return format!("next frame: {me} waits until the frame before is done with {}", before.join(", "));
    };
    format!("reuse of memory: {me} takes bytes over from {words}")
}

fn target_words(plan: &Plan) -> Vec<TargetWords> {
    let pass = |i: usize| plan.passes.get(i).map_or("the host".to_owned(), |p| p.name.clone());
    let words = |(name, t): (&String, &crate::plan::TargetPlan)| TargetWords {
        name: name.clone(),
        format: format!("{:?}", t.desc.format),
        size: [t.desc.size[0], t.desc.size[1], t.desc.layers],
        bytes: plan.target_bytes(t),
        lifetime: [pass(t.lifetime.0), pass(t.lifetime.1)],
        offset: t.offset,
        kept: t.kept,
        meaning: targets::describe(name).map_or("", |d| d.meaning),
    };
    plan.targets.iter().map(words).collect()
}

impl Display for Explanation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for profile in &self.profiles {
            writeln!(f, "{profile}")?;
        }
        for (number, pass) in self.passes.iter().enumerate() {
            writeln!(f, "{:>2}. {}: {}", number + 1, pass.name, pass.domain)?;
            if !pass.shaders.is_empty() {
                let constants: Vec<String> = pass.constants.iter().map(|(n, v)| format!("{n}={v}")).collect();
                writeln!(f, "    runs    {} {}", pass.shaders.join(" + "), constants.join(" "))?;
            }
            writeln!(f, "    reads   {} ({})", list(&pass.reads), human(pass.bytes_read))?;
            writeln!(f, "    writes  {} ({})", list(&pass.writes), human(pass.bytes_written))?;
            for b in &pass.barriers {
                writeln!(f, "    waits   {}: {}", b.resource, b.reason)?;
                let layouts = b.layouts.as_ref().map_or(String::new(), |l| format!("; {l}"));
                writeln!(f, "            {} -> {}{layouts}", b.from, b.to)?;
            }
        }
        let mut table = Table::new(&["target", "format", "size", "bytes", "at", "from", "to", "meaning"]);
        for t in &self.targets {
            let layers = if t.size[2] > 1 { format!(" x {}", t.size[2]) } else { String::new() };
            table.row([
                t.name.clone(),
                t.format.clone(),
                format!("{} x {}{layers}", t.size[0], t.size[1]),
                human(t.bytes),
                format!("{}{}", human(t.offset), if t.kept { " kept" } else { "" }),
                t.lifetime[0].clone(),
                t.lifetime[1].clone(),
                t.meaning.to_owned(),
            ]);
        }
        writeln!(f, "\n{table}")?;
        for (name, bytes) in &self.buffers {
            writeln!(f, "buffer {name}: {}", human(*bytes))?;
        }
        writeln!(f, "images: {}; {} if none shared memory", human(self.bytes_shared), human(self.bytes_unshared))?;
        writeln!(
            f,
            "beside the G-buffer and shadow maps: {:.1} bytes per pixel of the picture",
            self.bytes_per_pixel_beside_gbuffer
        )?;
        writeln!(f, "estimated traffic: {:.1} bytes per pixel of the picture", self.bytes_per_pixel)?;
        writeln!(f, "\nleft out:{}", if self.left_out.is_empty() { " nothing" } else { "" })?;
        for l in &self.left_out {
            let ms = self.saved_ms.get(&l.what).map_or(String::new(), |ms| format!(", {ms:.2} ms"));
            let shared = self
                .saved_bytes
                .get(&l.what)
                .map_or(String::new(), |b| format!(", {} as they share memory", human(*b)));
            writeln!(f, "  {}: {} (saves {} of images{shared}{ms})", l.what, l.why, human(l.bytes))?;
        }
        Ok(())
    }
}

fn list(names: &[String]) -> String {
    if names.is_empty() { "nothing of the frame".to_owned() } else { names.join(", ") }
}
