//! Irradiance at points spread over the surface, and sums over them: a tree whose distant branches count as one point.

use super::kernel::Kernel;
use super::lighting;
use super::random::{Shift, hash};
use super::surface::Surface;
use crate::scene::Light;
use glam::DVec3;
use rayon::prelude::*;
use std::collections::HashSet;

/// Points in a leaf.
const LEAF: usize = 6;
/// Fewer points than this are sorted by one thread.
const SMALL: usize = 4096;

/// One surface sample: a place, the area that it stands for, and the flux on it.
#[derive(Clone, Copy, Debug)]
pub struct Speck {
    position: DVec3,
    area: f32,
    flux: [f32; 3],
}

#[derive(Clone, Copy, Debug)]
struct Node {
    centre: DVec3,
    area: f64,
    flux: [f64; 3],
    /// Radius around the centre that holds all of its specks, mm.
    radius: f64,
    /// Nodes of the subtree, this one included.
    skip: u32,
    /// Specks of a leaf.
    first: u32,
    count: u32,
}

/// A numerator and a denominator per channel: with irradiance, and without.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sum {
    /// The integral of R E dA.
    pub lit: [f64; 3],
    /// The integral of R dA: 1 on an infinite plane.
    pub mass: [f64; 3],
}

impl Sum {
    /// Adds a weight per channel with an irradiance.
    pub fn add(&mut self, weight: [f64; 3], irradiance: [f64; 3]) {
        for c in 0..3 {
            self.lit[c] += weight[c] * irradiance[c];
            self.mass[c] += weight[c];
        }
    }

    /// Adds an area and its flux, under a kernel's value.
    fn point(&mut self, kernel: [f64; 3], area: f64, flux: [f64; 3]) {
        for (c, k) in kernel.into_iter().enumerate() {
            self.lit[c] += k * flux[c];
            self.mass[c] += k * area;
        }
    }

    /// This and another.
    pub fn plus(mut self, other: &Sum) -> Sum {
        for c in 0..3 {
            self.lit[c] += other.lit[c];
            self.mass[c] += other.mass[c];
        }
        self
    }

    /// This times a factor.
    pub fn times(self, factor: f64) -> Sum {
        Sum { lit: self.lit.map(|x| x * factor), mass: self.mass.map(|x| x * factor) }
    }

    /// Exitance; `otherwise` where nothing was found.
    pub fn ratio(&self, otherwise: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|c| if self.mass[c] > 1e-9 { self.lit[c] / self.mass[c] } else { otherwise[c] })
    }
}

/// Which faces any pixel can draw light from: those that scatter by the same profile and lie within `reach` of a seen place, roughly.
pub fn faces_in_reach(surface: &Surface<'_>, profile: usize, seen: &[DVec3], reach: f64) -> Vec<u32> {
    let cell = |x: f64| (x / reach).floor() as i64;
    let cells: HashSet<[i64; 3]> = seen.iter().map(|p| p.to_array().map(cell)).collect();
    let near = |face: &u32| {
        let corners = surface.faces[*face as usize].corners;
        let low = corners[0].min(corners[1]).min(corners[2]).to_array().map(|x| cell(x) - 1);
        let high = corners[0].max(corners[1]).max(corners[2]).to_array().map(|x| cell(x) + 1);
        let count = (0..3).map(|i| (high[i] - low[i] + 1) as f64).product::<f64>();
        // A face this large is surely near something; it is not worth asking.
        count > 1e3
            || (low[0]..=high[0])
                .any(|x| (low[1]..=high[1]).any(|y| (low[2]..=high[2]).any(|z| cells.contains(&[x, y, z]))))
    };
    (0..surface.faces.len() as u32)
        .into_par_iter()
        .filter(|f| surface.profile(*f) == Some(profile) && near(f))
        .collect()
}

/// Samples of a set of faces.
pub struct Cloud {
    specks: Vec<Speck>,
    nodes: Vec<Node>,
}

impl Cloud {
    /// About `count` samples spread evenly by area over the faces, at least one a face; `seed` sets where they fall.
    pub fn new(surface: &Surface<'_>, faces: &[u32], lights: &[Light], shadows: bool, count: usize, seed: u64) -> Self {
        let area: f64 = faces.iter().map(|f| surface.faces[*f as usize].area()).sum();
        let each = area / count.max(1) as f64;
        let mut specks: Vec<Speck> = faces
            .par_iter()
            .flat_map_iter(|&face| {
                let area = surface.faces[face as usize].area();
                let n = (area / each).round().max(1.) as usize;
                let share = area / n as f64;
                let shift = Shift::new(hash(seed, u64::from(face)));
                (0..n).map(move |i| {
                    // The unit square folded to the triangle.
                    let [u, v] = shift.point(i);
                    let at = if u + v > 1. { [1. - u, 1. - v] } else { [u, v] };
                    let place = surface.place(face, at);
                    let e = lighting::irradiance(surface, lights, shadows, &place);
                    Speck { position: place.position, area: share as f32, flux: e.map(|x| (x * share) as f32) }
                })
            })
            .collect();
        let nodes = build(&mut specks, 0);
        Self { specks, nodes }
    }

    /// How many samples there are.
    pub fn len(&self) -> usize {
        self.specks.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.specks.is_empty()
    }

    /// The far part of the kernel around `x`; a branch counts as one point where its radius is below `opening` times its
    /// distance.
    pub fn far(&self, kernel: &Kernel, x: DVec3, opening: f64) -> Sum {
        let mut sum = Sum::default();
        let inner = 0.5 * kernel.split;
        let mut i = 0;
        while let Some(node) = self.nodes.get(i) {
            let distance = node.centre.distance(x);
            let past = i + node.skip as usize;
            if distance - node.radius > kernel.reach || distance + node.radius < inner {
                i = past;
            } else if node.radius <= opening * distance {
                sum.point(kernel.far(distance), node.area, node.flux);
                i = past;
            } else if node.count > 0 {
                for speck in &self.specks[node.first as usize..(node.first + node.count) as usize] {
                    let k = kernel.far(speck.position.distance(x));
                    sum.point(k, f64::from(speck.area), speck.flux.map(f64::from));
                }
                i = past;
            } else {
                i += 1;
            }
        }
        sum
    }
}

/// The nodes over a run of specks, which are sorted on the way; `first` is the run's place among all.
fn build(specks: &mut [Speck], first: u32) -> Vec<Node> {
    if specks.is_empty() {
        return Vec::new();
    }
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let (mut centre, mut area, mut flux) = (DVec3::ZERO, 0., [0.; 3]);
    for s in specks.iter() {
        (low, high) = (low.min(s.position), high.max(s.position));
        let a = f64::from(s.area);
        centre += s.position * a;
        area += a;
        (0..3).for_each(|c| flux[c] += f64::from(s.flux[c]));
    }
    centre = if area > 0. { centre / area } else { low.midpoint(high) };
    let radius = (high - centre).max(centre - low).length();
    let mut node = Node { centre, area, flux, radius, skip: 1, first, count: specks.len() as u32 };
    if specks.len() <= LEAF {
        return vec![node];
    }
    let extent = high - low;
    let axis = if extent.x >= extent.y.max(extent.z) { 0 } else { 1 + usize::from(extent.z > extent.y) };
    let middle = specks.len() / 2;
    specks.select_nth_unstable_by(middle, |a, b| a.position[axis].total_cmp(&b.position[axis]));
    let parallel = specks.len() > SMALL;
    let (a, b) = specks.split_at_mut(middle);
    let second = first + middle as u32;
    let (a, b) = if parallel {
        rayon::join(|| build(a, first), || build(b, second))
    } else {
        (build(a, first), build(b, second))
    };
    node.count = 0;
    node.skip = 1 + (a.len() + b.len()) as u32;
    let mut nodes = Vec::with_capacity(node.skip as usize);
    nodes.push(node);
    nodes.extend(a);
    nodes.extend(b);
    nodes
}
