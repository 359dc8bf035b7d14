//! Baking: a mesh's primitives and a node's transform become world-space triangles in mm, with everything that files
//! leave undefined defined.
//!
//! - A triangle with a corner that is not finite (or beyond 1e30 mm) is left out; so is one without area, and each
//!   repetition of a triangle of the same three vertices and winding, which would count twice as a source of light.
//! - A mirroring transform turns the winding over, so that the front stays the front.
//! - Normals missing, zero or not finite are made from the triangles (see [`super::normals`]); the others are brought to
//!   unit length. A triangle whose winding contradicts its normals stays as it is, and is counted.

use glam::{DAffine3, DMat3, DVec3, Vec3};
use rayon::slice::ParallelSliceMut;

use super::normals::smooth_normals;
use super::tangents;

/// Farther from the world's origin than this, in mm, a position is taken for damage.
const FARTHEST: f64 = 1e30;
/// A triangle thinner than this part of its longest edge has no area.
const THINNEST: f64 = 1e-12;
/// Normals off unit length by more than rounding to 8 bits explains.
const UNIT_SLACK: f64 = 0.05;

/// Vertices and triangles of one material as the file has them, all indices in range.
#[derive(Clone)]
pub(super) struct LocalPrimitive {
    /// Index of the scene's material.
    pub material: usize,
    pub positions: Vec<[f32; 3]>,
    pub normals: Option<Vec<[f32; 3]>>,
    pub tangents: Option<Vec<[f32; 4]>>,
    pub uvs: Option<Vec<[f32; 2]>>,
    pub second_uvs: Option<Vec<[f32; 2]>>,
    pub colors: Option<Vec<[f32; 4]>>,
    pub triangles: Vec<[u32; 3]>,
    /// Vertices after the last whole triangle.
    pub remainder: usize,
    pub needs_tangents: bool,
    /// Tangents follow the second UVs.
    pub tangents_second: bool,
    pub needs_uvs: bool,
    pub needs_second: bool,
}

/// The same in the world: mm, f64, since the origin is not known yet.
#[derive(Default)]
pub(super) struct BakedPrimitive {
    pub material: usize,
    pub positions: Vec<DVec3>,
    pub normals: Vec<[f32; 3]>,
    /// Empty if not needed, like `uvs` and `colors`.
    pub tangents: Vec<[f32; 4]>,
    pub uvs: Vec<[f32; 2]>,
    pub second_uvs: Vec<[f32; 2]>,
    pub colors: Vec<[f32; 4]>,
    pub triangles: Vec<[u32; 3]>,
}

/// How much was repaired.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Tally {
    pub not_finite: usize,
    pub degenerate: usize,
    pub duplicate: usize,
    pub inverted: usize,
    pub remainder: usize,
    /// Vertices whose primitive has no normals.
    pub without_normals: usize,
    pub bad_normals: usize,
    pub long_normals: usize,
    pub made_tangents: usize,
    pub bad_tangents: usize,
    pub without_uvs: usize,
}

impl Tally {
    pub fn add(&mut self, other: &Self) {
        self.not_finite += other.not_finite;
        self.degenerate += other.degenerate;
        self.duplicate += other.duplicate;
        self.inverted += other.inverted;
        self.remainder += other.remainder;
        self.without_normals += other.without_normals;
        self.bad_normals += other.bad_normals;
        self.long_normals += other.long_normals;
        self.made_tangents += other.made_tangents;
        self.bad_tangents += other.bad_tangents;
        self.without_uvs += other.without_uvs;
    }

    /// One line for each kind of repair that was made.
    pub fn lines(&self) -> Vec<String> {
        let kinds = [
            (self.not_finite, "triangles with a corner that is not finite left out"),
            (self.degenerate, "triangles without area left out"),
            (self.duplicate, "repeated triangles left out"),
            (self.inverted, "triangles wound against their normals, kept as they are"),
            (self.remainder, "vertices after the last whole triangle ignored"),
            (self.without_normals, "vertices without normals; smooth ones were made"),
            (self.bad_normals, "normals zero or not finite; smooth ones were made"),
            (self.long_normals, "normals not of unit length, scaled"),
            (self.made_tangents, "vertices without tangents; MikkTSpace ones were made"),
            (self.without_uvs, "textured vertices without UVs; one texel colours them"),
            (self.bad_tangents, "tangents undefined; any across the normal was taken"),
        ];
        let said = kinds.iter().filter(|(count, _)| *count > 0);
        said.map(|(count, what)| format!("{count} {what}")).collect()
    }
}

/// Bakes the primitives of one mesh under one transform (mm).
pub(super) fn bake(primitives: &[&LocalPrimitive], world: &DAffine3) -> (Vec<BakedPrimitive>, Tally) {
    let mut tally = Tally::default();
    let mut baked: Vec<_> = primitives.iter().map(|local| place(local, world, &mut tally)).collect();
    set_normals(primitives, &mut baked, world, &mut tally);
    for (local, baked) in primitives.iter().zip(&mut baked) {
        tally.inverted += count_inverted(baked);
        if local.needs_tangents {
            let given = local.tangents.as_deref();
            tangents::set(baked, given, local.tangents_second, world, &mut tally);
        }
        drop_unused(baked);
    }
    (baked, tally)
}

/// World positions, and the triangles that are worth drawing.
fn place(local: &LocalPrimitive, world: &DAffine3, tally: &mut Tally) -> BakedPrimitive {
    let to_world = |p: &[f32; 3]| world.transform_point3(Vec3::from(*p).as_dvec3());
    let positions: Vec<DVec3> = local.positions.iter().map(to_world).collect();
    let mirrored = world.matrix3.determinant() < 0.0;
    let mut triangles = Vec::with_capacity(local.triangles.len());
    for &[a, b, c] in &local.triangles {
        let triangle = if mirrored { [a, c, b] } else { [a, b, c] };
        let corners = triangle.map(|i| positions[i as usize]);
        if !corners.iter().all(|p| p.abs().max_element() <= FARTHEST) {
            tally.not_finite += 1;
        } else if has_area(corners) {
            triangles.push(triangle);
        } else {
            tally.degenerate += 1;
        }
    }
    tally.duplicate += drop_duplicates(&mut triangles);
    tally.remainder += local.remainder;
    let lacks = local.needs_uvs && local.uvs.is_none() || local.needs_second && local.second_uvs.is_none();
    if lacks {
        tally.without_uvs += positions.len();
    }
    BakedPrimitive {
        material: local.material,
        positions,
        normals: Vec::new(),
        tangents: Vec::new(),
        uvs: local.uvs.clone().unwrap_or_default(),
        second_uvs: local.second_uvs.clone().unwrap_or_default(),
        colors: local.colors.clone().unwrap_or_default(),
        triangles,
    }
}

fn has_area([a, b, c]: [DVec3; 3]) -> bool {
    let (u, v, w) = (b - a, c - a, c - b);
    let longest = u.length_squared().max(v.length_squared()).max(w.length_squared());
    u.cross(v).length() > THINNEST * longest
}

/// Leaves the first of each set of equal triangles; returns how many went.
fn drop_duplicates(triangles: &mut Vec<[u32; 3]>) -> usize {
    // Turning a triangle so that its least index leads keeps the winding.
    let key = |&[a, b, c]: &[u32; 3]| {
        if a <= b && a <= c {
            [a, b, c]
        } else if b <= c {
            [b, c, a]
        } else {
            [c, a, b]
        }
    };
    let mut sorted: Vec<_> = triangles.iter().map(key).collect();
    sorted.par_sort_unstable();
    // Nearly all meshes have none; then nothing is hashed.
    if sorted.windows(2).all(|pair| pair[0] != pair[1]) {
        return 0;
    }
    let before = triangles.len();
    let mut seen = std::collections::HashSet::with_capacity(before);
    triangles.retain(|t| seen.insert(key(t)));
    before - triangles.len()
}

/// The matrix that carries normals: the cofactors, which are the inverse transpose up to a positive factor but also
/// exist where a node is scaled flat.
pub(super) fn normal_matrix(m: &DMat3) -> DMat3 {
    let sign = if m.determinant() < 0.0 { -1.0 } else { 1.0 };
    DMat3::from_cols(m.y_axis.cross(m.z_axis) * sign, m.z_axis.cross(m.x_axis) * sign, m.x_axis.cross(m.y_axis) * sign)
}

/// Unit normals for every vertex of every primitive.
fn set_normals(primitives: &[&LocalPrimitive], baked: &mut [BakedPrimitive], world: &DAffine3, tally: &mut Tally) {
    // Brought to unit scale first: cofactors square what may be 1e-4 of a micron a unit.
    let scale = (0..3).map(|i| world.matrix3.col(i).length()).fold(0.0, f64::max);
    let to_world = normal_matrix(&(world.matrix3 * if scale > 0.0 { scale.recip() } else { 0.0 }));
    let mut holes = false;
    for (local, baked) in primitives.iter().zip(baked.iter_mut()) {
        let Some(normals) = &local.normals else {
            tally.without_normals += baked.positions.len();
            holes = true;
            continue;
        };
        baked.normals = normals
            .iter()
            .map(|&normal| {
                let normal = Vec3::from(normal).as_dvec3();
                let long = (normal.length() - 1.0).abs() > UNIT_SLACK;
                match (to_world * normal).try_normalize() {
                    Some(unit) => {
                        tally.long_normals += usize::from(long);
                        unit.as_vec3().to_array()
                    }
                    None => {
                        tally.bad_normals += 1;
                        holes = true;
                        [0.0; 3]
                    }
                }
            })
            .collect();
    }
    if !holes {
        return;
    }
    let smooth = smooth_normals(baked);
    for (baked, smooth) in baked.iter_mut().zip(smooth) {
        if baked.normals.is_empty() {
            baked.normals = smooth;
        } else {
            for (normal, smooth) in baked.normals.iter_mut().zip(smooth) {
                if *normal == [0.0; 3] {
                    *normal = smooth;
                }
            }
        }
    }
}

/// Triangles whose front faces away from all three of their normals.
fn count_inverted(baked: &BakedPrimitive) -> usize {
    let against = |t: &&[u32; 3]| {
        let [a, b, c] = t.map(|i| baked.positions[i as usize]);
        let front = (b - a).cross(c - a);
        t.iter().all(|&i| Vec3::from(baked.normals[i as usize]).as_dvec3().dot(front) < 0.0)
    };
    baked.triangles.iter().filter(against).count()
}

/// Removes the vertices that no triangle names any more: they may not be finite, and would count in the bounds.
fn drop_unused(baked: &mut BakedPrimitive) {
    let mut new = vec![u32::MAX; baked.positions.len()];
    for &i in baked.triangles.iter().flatten() {
        new[i as usize] = 0;
    }
    let mut kept = 0;
    for place in new.iter_mut().filter(|place| **place == 0) {
        *place = kept;
        kept += 1;
    }
    if kept as usize == baked.positions.len() {
        return;
    }
    for i in baked.triangles.iter_mut().flatten() {
        *i = new[*i as usize];
    }
    keep(&mut baked.positions, &new);
    keep(&mut baked.normals, &new);
    keep(&mut baked.tangents, &new);
    keep(&mut baked.uvs, &new);
    keep(&mut baked.second_uvs, &new);
    keep(&mut baked.colors, &new);
}

/// Keeps the items (if there are any) whose new number is not `u32::MAX`.
fn keep<T>(items: &mut Vec<T>, new: &[u32]) {
    let mut numbers = new.iter();
    items.retain(|_| numbers.next().is_some_and(|&n| n != u32::MAX));
}
