//! UVs without overlap: the half is a disc, and a disc maps one-to-one onto a convex outline if every vertex is a convex
//! combination of its neighbours (Tutte 1963, Floater 2003). The middle of the face becomes the straight side at u = 1/2;
//! the cut along the back, from crown to base, becomes the curved side. The mirror image takes the other half.

use std::collections::{BTreeMap, BTreeSet};

use anyhow::{Result, ensure};
use glam::{DVec2, DVec3, dvec2, dvec3};
use rayon::prelude::*;

use crate::mesh::Mesh;

/// Where the cut begins, under the hair, and where it ends, under the front edge of the base, mm.
const CUT: [DVec3; 2] = [dvec3(0., 112., 30.), dvec3(0., -272., 25.)];
/// Room left around the chart, in UV.
const MARGIN: f64 = 0.012;
/// Squareness of the outline: above 2, so that the square is filled, and strictly convex, so that no triangle is flat.
const SQUARE: f64 = 5.;
/// How often the weights follow the stretch (Yoshizawa et al. 2004).
const ROUNDS: usize = 12;

/// UVs of the half, one a vertex, 1/2 <= u <= 1.
pub fn unwrap(mesh: &Mesh) -> Result<Vec<DVec2>> {
    let border = border(mesh)?;
    let mut uv = vec![dvec2(0.75, 0.5); mesh.positions.len()];
    pin(mesh, &border, &mut uv)?;
    let mut fixed = vec![false; uv.len()];
    border.iter().for_each(|&i| fixed[i as usize] = true);
    let mut rows = weights(mesh);
    settle(&rows, &fixed, &mut uv)?;
    for _ in 0..ROUNDS {
        let stretch: Vec<f64> = stretch(mesh, &uv).iter().map(|s| s.powf(-0.4)).collect();
        for (i, row) in rows.iter_mut().enumerate() {
            row.iter_mut().for_each(|(j, w)| *w *= stretch[i] * stretch[*j as usize]);
        }
        settle(&rows, &fixed, &mut uv)?;
    }
    Ok(uv)
}

/// How many texels a stretch of surface deserves, against the back of the chest.
fn worth(p: DVec3) -> f64 {
    let face = (-((p - dvec3(0., -25., 90.)) / dvec3(70., 85., 75.)).length_squared()).exp();
    let ear = (-((p - dvec3(78., -17., -14.)) / dvec3(22., 40., 28.)).length_squared()).exp();
    0.6 + 1.4 * face.max(0.8 * ear)
}

/// The vertices of the border in order, with the surface on the left.
fn border(mesh: &Mesh) -> Result<Vec<u32>> {
    let edges = || mesh.triangles.iter().flat_map(|t| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]]);
    let mut all = BTreeSet::new();
    for edge in edges() {
        ensure!(all.insert(edge), "more than two triangles meet at {}", mesh.positions[edge[0] as usize]);
    }
    let mut next = BTreeMap::new();
    for [a, b] in edges().filter(|&[a, b]| !all.contains(&[b, a])) {
        ensure!(mesh.positions[a as usize].x == 0., "a hole at {}", mesh.positions[a as usize]);
        ensure!(next.insert(a, b).is_none(), "the border forks at {}", mesh.positions[a as usize]);
    }
    let Some((&first, _)) = next.first_key_value() else { anyhow::bail!("the half has no border") };
    let mut walk = vec![first];
    while let Some(&i) = next.get(&walk[walk.len() - 1]) {
        if i == first {
            break;
        }
        walk.push(i);
        ensure!(walk.len() <= next.len(), "the border does not close");
    }
    ensure!(walk.len() == next.len(), "the half has more than one border: {} of {} edges", walk.len(), next.len());
    Ok(walk)
}

/// Lays the border on the outline by its length.
fn pin(mesh: &Mesh, border: &[u32], uv: &mut [DVec2]) -> Result<()> {
    let spot = |i: u32| mesh.positions[i as usize];
    let nearest = |to: DVec3| {
        let by = |a: &usize, b: &usize| spot(border[*a]).distance(to).total_cmp(&spot(border[*b]).distance(to));
        (0..border.len()).min_by(by).unwrap_or(0)
    };
    let (top, bottom) = (nearest(CUT[0]), nearest(CUT[1]));
    ensure!(top != bottom, "the cut has no length");
    let n = border.len();
    let run =
        |from: usize, to: usize| -> Vec<u32> { (0..=(to + n - from) % n).map(|k| border[(from + k) % n]).collect() };
    // One run from top to bottom crosses the face, the other is the cut.
    let (one, mut other) = (run(top, bottom), run(bottom, top));
    other.reverse();
    let depth = |run: &[u32]| run.iter().map(|&i| spot(i).z).sum::<f64>() / run.len() as f64;
    let (front, cut) = if depth(&one) > depth(&other) { (one, other) } else { (other, one) };
    let half = 0.5 - MARGIN;
    for (i, t) in front.iter().zip(measure(mesh, &front)) {
        uv[*i as usize] = dvec2(0.5, 0.5 + half * (2. * t - 1.));
    }
    // The outline, traced finely and then divided by length.
    let at = |t: f64| {
        let (s, c) = (std::f64::consts::PI * t).sin_cos();
        let power = |x: f64| x.signum() * x.abs().powf(2. / SQUARE);
        dvec2(0.5 + half * power(s.max(0.)), 0.5 - half * power(c))
    };
    const FINE: usize = 20_000;
    let mut along = vec![0.];
    for k in 1..=FINE {
        along.push(along[k - 1] + at(k as f64 / FINE as f64).distance(at((k - 1) as f64 / FINE as f64)));
    }
    for (i, t) in cut.iter().zip(measure(mesh, &cut)) {
        if t > 0. && t < 1. {
            let k = along.partition_point(|&l| l < t * along[FINE]);
            uv[*i as usize] = at(k as f64 / FINE as f64);
        }
    }
    Ok(())
}

/// How far along a run of vertices each lies, 0..1, by length and worth.
fn measure(mesh: &Mesh, run: &[u32]) -> Vec<f64> {
    let mut along = vec![0.];
    for pair in run.windows(2) {
        let (a, b) = (mesh.positions[pair[0] as usize], mesh.positions[pair[1] as usize]);
        along.push(along[along.len() - 1] + a.distance(b).max(1e-6) * worth((a + b) / 2.));
    }
    let all = along[along.len() - 1];
    along.iter().map(|l| l / all).collect()
}

/// Mean value weights (Floater 2003), which are positive, the same in both directions of an edge: their sum.
fn weights(mesh: &Mesh) -> Vec<Vec<(u32, f64)>> {
    let mut rows = vec![BTreeMap::new(); mesh.positions.len()];
    for t in &mesh.triangles {
        for k in 0..3 {
            let [i, j, l] = [t[k], t[(k + 1) % 3], t[(k + 2) % 3]];
            let (p, a, b) = (mesh.positions[i as usize], mesh.positions[j as usize], mesh.positions[l as usize]);
            let tangent = ((a - p).angle_between(b - p) / 2.).clamp(0.01, 1.5).tan();
            for (to, at) in [(j, a), (l, b)] {
                let w = tangent / at.distance(p).max(0.02);
                *rows[i as usize].entry(to).or_insert(0.) += w;
                *rows[to as usize].entry(i).or_insert(0.) += w;
            }
        }
    }
    rows.into_iter().map(|row| row.into_iter().collect()).collect()
}

/// Puts every free vertex at the weighted mean of its neighbours: conjugate gradients, preconditioned by the diagonal.
fn settle(rows: &[Vec<(u32, f64)>], fixed: &[bool], uv: &mut [DVec2]) -> Result<()> {
    let sums: Vec<f64> = rows.iter().map(|row| row.iter().map(|(_, w)| w).sum()).collect();
    // How far a vertex is from where its neighbours pull it; zero where it is held.
    let pull =
        |x: &[DVec2]| -> Vec<DVec2> {
            (0..rows.len())
                .into_par_iter()
                .map(|i| {
                    if fixed[i] { DVec2::ZERO } else { rows[i].iter().map(|&(j, w)| w * (x[j as usize] - x[i])).sum() }
                })
                .collect()
        };
    // Both coordinates are one system with two right sides, each with its own steps.
    let dot = |a: &[DVec2], b: &[DVec2]| -> DVec2 { a.iter().zip(b).map(|(a, b)| *a * *b).sum() };
    let scaled = |r: &[DVec2]| -> Vec<DVec2> { r.iter().zip(&sums).map(|(r, s)| *r / *s).collect() };
    let mut residual = pull(uv);
    let mut z = scaled(&residual);
    let mut way = z.clone();
    let mut rz = dot(&residual, &z);
    for _ in 0..20_000 {
        if rz.max_element() < 1e-20 {
            return Ok(());
        }
        let image: Vec<DVec2> = pull(&way).iter().map(|v| -*v).collect();
        let step = rz / dot(&way, &image).max(DVec2::splat(1e-300));
        uv.iter_mut().zip(&way).for_each(|(x, w)| *x += step * *w);
        residual.iter_mut().zip(&image).for_each(|(r, a)| *r -= step * *a);
        z = scaled(&residual);
        let next = dot(&residual, &z);
        let keep = next / rz.max(DVec2::splat(1e-300));
        way.iter_mut().zip(&z).for_each(|(w, z)| *w = *z + keep * *w);
        rz = next;
    }
    anyhow::bail!("the chart does not settle: {rz}")
}

/// Root mean square stretch from the chart to the surface at each vertex (Sander et al. 2001), times its worth, over the
/// mean.
fn stretch(mesh: &Mesh, uv: &[DVec2]) -> Vec<f64> {
    let mut sum = vec![(0., 0.); uv.len()];
    for t in &mesh.triangles {
        let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
        let [ua, ub, uc] = t.map(|i| uv[i as usize]);
        let (e, f) = (ub - ua, uc - ua);
        let area = e.perp_dot(f).abs().max(1e-14);
        let du = ((b - a) * f.y - (c - a) * e.y) / area;
        let dv = ((c - a) * e.x - (b - a) * f.x) / area;
        let size = (b - a).cross(c - a).length() / 2.;
        let square = (du.length_squared() + dv.length_squared()) / 2. * worth((a + b + c) / 3.).powi(2);
        for &i in t {
            sum[i as usize].0 += size * square;
            sum[i as usize].1 += size;
        }
    }
    let value: Vec<f64> = sum.iter().map(|(s, w)| (s / w.max(1e-12)).sqrt()).collect();
    let mean = value.iter().sum::<f64>() / value.len() as f64;
    value.iter().map(|v| (v / mean).clamp(0.05, 20.)).collect()
}
