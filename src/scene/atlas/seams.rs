//! Where the unwrapping is cut: edges at which the surface goes on elsewhere in the unit square. A strip beside each of them, the
//! gutter, is filled with what lies on the other side, so that a blur which runs over the edge finds what it would find on the
//! surface.

use super::super::Scene;
use super::Atlas;
use glam::{DVec2, DVec3, Vec2, Vec3};
use std::collections::HashMap;

/// How far past the ends of its edge a gutter reaches, as a part of the distance from it: closes the wedges between the edges of
/// a curved cut.
const FAN: f64 = 0.1;

/// One side of a cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seam {
    /// Number of the chart that ends here.
    pub chart: f32,
    /// Where its edge starts and ends, in texture coordinates.
    pub edge: [DVec2; 2],
    /// Unit vector out of the chart.
    pub out: DVec2,
    /// Where the edge starts on the other side.
    pub there: DVec2,
    /// The whole edge there.
    pub along: DVec2,
    /// What a unit step along `out` is there.
    pub across: DVec2,
}

/// What fills one texel of a gutter: its x and y (16 bits each), the place in texels that it shows (two floats' bits), and the
/// bits of the number of the chart that it belongs to, as a float.
pub type Filled = [u32; 4];

/// An edge of a chart: the ends of one triangle's side, and its third corner.
struct Rim {
    corners: [u32; 3],
}

/// Finds the cuts: sides that one triangle has and no other by place and texture coordinate, and a second one by place alone.
/// Borders of the surface itself have no other side.
pub(super) fn find(scene: &Scene, triangles: &[[u32; 3]], charts: &[f32]) -> Vec<Seam> {
    let place = |i: u32| scene.positions[i as usize].map(|x| (x + 0.).to_bits());
    let whole = |i: u32| {
        let [x, y, z] = place(i);
        let [u, v] = scene.uvs[i as usize].map(|x| (x + 0.).to_bits());
        [x, y, z, u, v]
    };
    let mut sides: HashMap<[[u32; 5]; 2], (usize, [u32; 3])> = HashMap::with_capacity(triangles.len() * 3 / 2);
    for t in triangles {
        for k in 0..3 {
            let corners = [t[k], t[(k + 1) % 3], t[(k + 2) % 3]];
            let (a, b) = (whole(corners[0]), whole(corners[1]));
            sides.entry([a.min(b), a.max(b)]).or_insert((0, corners)).0 += 1;
        }
    }
    let mut rims: HashMap<[[u32; 3]; 2], Vec<Rim>> = HashMap::new();
    for (count, corners) in sides.into_values() {
        let (a, b) = (place(corners[0]), place(corners[1]));
        if count == 1 && a != b {
            rims.entry([a.min(b), a.max(b)]).or_default().push(Rim { corners });
        }
    }
    let mut seams = Vec::new();
    for pair in rims.values() {
        let [one, two] = pair.as_slice() else { continue };
        for (here, there) in [(one, two), (two, one)] {
            let turned = place(here.corners[0]) != place(there.corners[0]);
            seams.extend(seam(scene, here.corners, there.corners, turned, charts));
        }
    }
    // A hash map's order differs from run to run; a picture must not.
    seams.sort_by(|a, b| a.edge[0].x.total_cmp(&b.edge[0].x).then(a.edge[0].y.total_cmp(&b.edge[0].y)));
    seams
}

/// The step over one side: the surface's own continuation, bent over the edge, in the coordinates of the other triangle.
fn seam(scene: &Scene, here: [u32; 3], there: [u32; 3], turned: bool, charts: &[f32]) -> Option<Seam> {
    let uv = |i: u32| Vec2::from(scene.uvs[i as usize]).as_dvec2();
    let at = |i: u32| Vec3::from(scene.positions[i as usize]).as_dvec3();
    let [a, b, c] = here.map(uv);
    let (va, vb) = if turned { (uv(there[1]), uv(there[0])) } else { (uv(there[0]), uv(there[1])) };
    let vc = uv(there[2]);
    let (pa, pb) = (at(here[0]), at(here[1]));
    let (edge, length) = (b - a, (pb - pa).length());
    let e = (pb - pa) / length;
    // The third corner of each triangle, as millimetres along the edge and away from it.
    let split = |p: DVec3| {
        let along = (p - pa).dot(e);
        (along, (p - pa - e * along).length())
    };
    let ((along, height), (along_there, height_there)) = (split(at(here[2])), split(at(there[2])));
    let normal = edge.perp().try_normalize()?;
    let out = if normal.dot(c - a) > 0. { -normal } else { normal };
    let depth = -out.dot(c - a);
    if depth <= 0. || height <= 0. || height_there <= 0. || length <= 0. {
        return None;
    }
    // A unit along `out` is (c's height, less what c is off along the edge) over c's depth, on the surface.
    let foot = (c - a).dot(edge) / edge.length_squared() * length;
    let (mm_across, mm_along) = (height / depth, (foot - along) / depth);
    let unit_along = (vb - va) / length;
    let unit_across = ((vc - va) - unit_along * along_there) / height_there;
    Some(Seam {
        chart: charts[here[0] as usize],
        edge: [a, b],
        out,
        there: va,
        along: vb - va,
        across: unit_across * mm_across + unit_along * mm_along,
    })
}

/// The texels of a sheet of `side` texels, whose unit square begins `border` of it from each side, within `reach` (texture
/// coordinates) of a cut, and what each shows. Texels at the
/// rim of a chart may be among them: only the device knows exactly which it covers.
pub fn gutter(atlas: &Atlas, side: u32, border: f64, reach: f64) -> Vec<Filled> {
    let size = f64::from(side);
    let scale = size * (1. - 2. * border);
    let mut nearest: HashMap<(u32, u32), (f64, Filled)> = HashMap::new();
    for s in &atlas.seams {
        let edge = s.edge[1] - s.edge[0];
        let length = edge.length();
        let corners = [s.edge[0], s.edge[1], s.edge[0] + s.out * reach, s.edge[1] + s.out * reach];
        let fan = DVec2::splat(FAN * reach);
        let texel = |p: DVec2| p * scale + size * border;
        let least = texel(corners.iter().fold(corners[0], |m, p| m.min(*p)) - fan).floor().max(DVec2::ZERO);
        let most = texel(corners.iter().fold(corners[0], |m, p| m.max(*p)) + fan).ceil().min(DVec2::splat(size - 1.));
        for y in least.y as i64..=most.y as i64 {
            for x in least.x as i64..=most.x as i64 {
                let place = (DVec2::new(x as f64 + 0.5, y as f64 + 0.5) - size * border) / scale;
                if atlas.is_inside(place) {
                    continue;
                }
                let at = place - s.edge[0];
                let (t, d) = (at.dot(edge) / length, at.dot(s.out));
                let over = (t - length).max(-t).max(0.);
                // Half a texel inwards: what a chart's edge leaves uncovered.
                if d < -0.5 / scale || d > reach || over > FAN * d.max(0.) + 0.5 / scale {
                    continue;
                }
                let shows = texel(s.there + s.along * (t / length) + s.across * d);
                let entry = [
                    x as u32 | (y as u32) << 16,
                    (shows.x as f32).to_bits(),
                    (shows.y as f32).to_bits(),
                    s.chart.to_bits(),
                ];
                let square = d * d + over * over;
                let known = nearest.entry((x as u32, y as u32)).or_insert((f64::INFINITY, entry));
                if square < known.0 {
                    *known = (square, entry);
                }
            }
        }
    }
    let mut list: Vec<Filled> = nearest.into_values().map(|(_, entry)| entry).collect();
    list.sort_unstable();
    list
}
