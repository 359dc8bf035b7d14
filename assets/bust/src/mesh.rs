//! From the field to triangles: the half x >= 0, its vertices on the surface itself, thinned where the surface is flat.
//! The half's only border is the chain of vertices at x = 0, so that its mirror image closes it.

use std::collections::{BTreeMap, BTreeSet};

use fast_surface_nets::ndshape::{RuntimeShape, Shape};
use fast_surface_nets::{SurfaceNetsBuffer, surface_nets};
use glam::{DVec3, dvec3};
use meshopt::SimplifyOptions;
use rayon::prelude::*;

use crate::body::{BASE, CROWN};
use crate::sculpt;

/// The box that holds the half, mm, before a margin of two cells.
const LOW: DVec3 = DVec3::new(0., BASE, -125.);
const HIGH: DVec3 = DVec3::new(192., CROWN + 6., 125.);
/// Samples along the edge of a block that is skipped as a whole.
const BLOCK: usize = 8;
/// The field may rise or fall faster than distance by this much.
const STEEPEST: f64 = 2.;
/// What a turn of the normal by a radian costs, against moving the surface by a part of its size.
const TURN: f32 = 0.02;
/// How often pinched places are locked, and how far around them, mm.
const LOCKINGS: usize = 20;
const LOCK_RADIUS: f64 = 4.;

/// Triangles, counter-clockwise from outside.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    pub positions: Vec<DVec3>,
    pub triangles: Vec<[u32; 3]>,
}

/// The half x >= 0 from cells of `cell` mm, thinned to about `triangles`.
pub fn half(cell: f64, triangles: usize) -> Mesh {
    let mut mesh = extract(cell);
    mesh.positions.par_iter_mut().for_each(|p| *p = settle(*p, cell));
    thin(&mut mesh, triangles);
    mesh
}

/// Naive surface nets (Gibson 1998). A layer of cells straddles x = 0; the field is even, so its vertices lie there.
fn extract(cell: f64) -> Mesh {
    let low = LOW - dvec3(1.5, 2., 2.) * cell;
    let count = ((HIGH - low) / cell).ceil().as_usizevec3() + glam::USizeVec3::splat(3);
    let shape = RuntimeShape::<u32, 3>::new([count.x as u32, count.y as u32, count.z as u32]);
    let mut field = vec![0f32; shape.usize()];
    field.par_chunks_mut(count.x * count.y * BLOCK).enumerate().for_each(|(slab, field)| {
        let deep = field.len() / (count.x * count.y);
        for y0 in (0..count.y).step_by(BLOCK) {
            for x0 in (0..count.x).step_by(BLOCK) {
                let first = low + dvec3(x0 as f64, y0 as f64, (slab * BLOCK) as f64) * cell;
                let half = cell * BLOCK as f64 / 2.;
                let middle = sculpt::skin(first + half);
                let far = middle.abs() > STEEPEST * half * 3f64.sqrt() + 2.;
                for z in 0..deep {
                    for y in y0..(y0 + BLOCK).min(count.y) {
                        for x in x0..(x0 + BLOCK).min(count.x) {
                            let p = first + dvec3((x - x0) as f64, (y - y0) as f64, z as f64) * cell;
                            let value = if far { middle } else { sculpt::skin(p) };
                            field[(z * count.y + y) * count.x + x] = value as f32;
                        }
                    }
                }
            }
        }
    });
    untangle(&mut field, count);
    let mut net = SurfaceNetsBuffer::default();
    surface_nets(&field, &shape, [0; 3], shape.as_array().map(|n| n - 1), &mut net);
    let positions: Vec<DVec3> = net
        .positions
        .iter()
        .map(|p| {
            let p = low + glam::Vec3::from(*p).as_dvec3() * cell;
            if p.x.abs() < 0.01 * cell { dvec3(0., p.y, p.z) } else { p }
        })
        .collect();
    let right = |t: &[u32; 3]| t.iter().all(|&i| positions[i as usize].x >= 0.);
    let triangles = net.indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).filter(right).collect();
    compact(Mesh { positions, triangles })
}

/// A cell holds one vertex, so its surface must be one sheet: where inside or outside is not connected along its edges, or
/// a face is a chequerboard, the sample nearest to the surface changes sides.
fn untangle(field: &mut [f32], count: glam::USizeVec3) {
    let (dy, dz) = (count.x, count.x * count.y);
    let corner = |k: usize| (k & 1) + (k >> 1 & 1) * dy + (k >> 2) * dz;
    let sound: Vec<bool> = (0..256).map(|inside| one_sheet(inside as u8)).collect();
    for _ in 0..100 {
        let samples = &*field;
        let bad: Vec<usize> = (0..count.z - 1)
            .into_par_iter()
            .flat_map_iter(|z| {
                let sound = &sound;
                (0..count.y - 1).flat_map(move |y| {
                    let cell = move |x: usize| z * dz + y * dy + x;
                    let inside =
                        move |i: usize| (0..8).fold(0, |m, k| m | usize::from(samples[i + corner(k)] < 0.) << k);
                    (1..count.x - 1).map(cell).filter(move |&i| !sound[inside(i)])
                })
            })
            .collect();
        if bad.is_empty() {
            return;
        }
        for i in bad {
            let near = (0..8).map(|k| i + corner(k)).min_by(|&a, &b| field[a].abs().total_cmp(&field[b].abs()));
            if let Some(near) = near {
                // Away from the surface, lest it change back for ever.
                field[near] *= -1.5;
            }
        }
        // The field stays even.
        for row in field.chunks_exact_mut(count.x) {
            (row[0], row[1]) = (row[3], row[2]);
        }
    }
}

/// Whether the corners inside, a bit each, and those outside are each connected along the edges of the cell, and no face is
/// a chequerboard.
fn one_sheet(inside: u8) -> bool {
    let connected = |set: u8| {
        let mut seen = set & set.wrapping_neg();
        for _ in 0..8 {
            (0..8u8).filter(|k| seen >> k & 1 == 1).collect::<Vec<_>>().iter().for_each(|k| {
                [1, 2, 4].iter().for_each(|axis| seen |= set & 1 << (k ^ axis));
            });
        }
        seen == set
    };
    let chequered = |axis: u8, side: u8| {
        let [a, b] = [1u8, 2, 4].into_iter().filter(|&x| x != axis).collect::<Vec<_>>()[..] else { return false };
        let at = |k: u8| inside >> (k | side) & 1;
        at(0) == at(a | b) && at(a) == at(b) && at(0) != at(a)
    };
    connected(inside)
        && connected(!inside)
        && ![1, 2, 4].iter().any(|&axis| chequered(axis, 0) || chequered(axis, axis))
}

/// Onto the surface by Newton's steps, at most a cell away; what lies at x = 0 stays there.
fn settle(start: DVec3, cell: f64) -> DVec3 {
    let mut p = start;
    for _ in 0..3 {
        let mut n = sculpt::normal(p);
        if start.x == 0. {
            n = dvec3(0., n.y, n.z).normalize_or_zero();
        }
        p -= n * sculpt::skin(p).clamp(-0.4 * cell, 0.4 * cell);
    }
    if start.x > 0. {
        p.x = p.x.max(0.05 * cell);
    }
    p
}

/// Quadric edge collapse (Garland & Heckbert 1997), which keeps a subset of the vertices; the turn of the normal counts.
/// The collapses do not look whether they pinch the surface: where one did, the place is locked and all is done again.
fn thin(mesh: &mut Mesh, target: usize) {
    let narrow: Vec<[f32; 3]> = mesh.positions.iter().map(|p| p.as_vec3().to_array()).collect();
    let normals: Vec<f32> =
        mesh.positions.par_iter().flat_map_iter(|&p| sculpt::normal(p).as_vec3().to_array()).collect();
    let mut locked = vec![false; narrow.len()];
    for _ in 0..LOCKINGS {
        let thinned = meshopt::simplify_with_attributes_and_locks_decoder(
            mesh.triangles.as_flattened(),
            &narrow,
            &normals,
            &[TURN; 3],
            3 * size_of::<f32>(),
            &locked,
            target * 3,
            1.,
            SimplifyOptions::None,
            None,
        );
        let triangles: Vec<_> = thinned.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect();
        let pinched = pinches(&triangles, &mesh.positions);
        if pinched.is_empty() {
            *mesh = compact(Mesh { positions: std::mem::take(&mut mesh.positions), triangles });
            return;
        }
        // Locking mends only what the collapses pinched; a field that is pinched itself is refused where it is unwrapped.
        if !pinches(&mesh.triangles, &mesh.positions).is_empty() {
            return;
        }
        for i in pinched {
            let at = mesh.positions[i as usize];
            let near = |p: &DVec3| p.distance_squared(at) < LOCK_RADIUS * LOCK_RADIUS;
            locked.iter_mut().zip(&mesh.positions).filter(|(_, p)| near(p)).for_each(|(l, _)| *l = true);
        }
    }
}

/// Vertices around which the triangles are not one fan, open only on the border.
fn pinches(triangles: &[[u32; 3]], positions: &[DVec3]) -> Vec<u32> {
    let mut fans: BTreeMap<u32, Vec<[u32; 2]>> = BTreeMap::new();
    for t in triangles {
        (0..3).for_each(|k| fans.entry(t[k]).or_default().push([t[(k + 1) % 3], t[(k + 2) % 3]]));
    }
    let whole = |i: u32, edges: &[[u32; 2]]| {
        let next: BTreeMap<u32, u32> = edges.iter().map(|e| (e[0], e[1])).collect();
        let ends: BTreeSet<u32> = edges.iter().map(|e| e[1]).collect();
        // From the first edge of an open fan, or from any of a closed one.
        let open: Vec<u32> = next.keys().copied().filter(|a| !ends.contains(a)).collect();
        let mut at = *open.first().unwrap_or(&edges[0][0]);
        let start = at;
        let mut steps = 0;
        while let Some(&b) = next.get(&at) {
            (at, steps) = (b, steps + 1);
            if at == start || steps > edges.len() {
                break;
            }
        }
        next.len() == edges.len()
            && ends.len() == edges.len()
            && open.len() <= usize::from(positions[i as usize].x == 0.)
            && steps == edges.len()
    };
    fans.into_iter().filter(|(i, edges)| !whole(*i, edges)).map(|(i, _)| i).collect()
}

/// Drops vertices that no triangle uses; the others in the order of their first use.
fn compact(mesh: Mesh) -> Mesh {
    let mut place = vec![u32::MAX; mesh.positions.len()];
    let mut positions = Vec::new();
    let mut triangles = mesh.triangles;
    for i in triangles.as_flattened_mut() {
        let place = &mut place[*i as usize];
        if *place == u32::MAX {
            *place = positions.len() as u32;
            positions.push(mesh.positions[*i as usize]);
        }
        *i = *place;
    }
    Mesh { positions, triangles }
}
