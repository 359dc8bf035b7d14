//! Tangents for normal maps: the file's own, carried into the world, or MikkTSpace's.

use std::collections::HashMap;

use bevy_mikktspace::{Geometry, TangentSpace, generate_tangents};
use glam::{DAffine3, DVec3, Vec3};

use super::bake::{BakedPrimitive, Tally};

/// Sets the tangents of a primitive whose normals are in place. Vertices that need two tangents are split.
///
/// `second`: the normal map reads the second UVs.
pub(super) fn set(
    baked: &mut BakedPrimitive,
    given: Option<&[[f32; 4]]>,
    second: bool,
    world: &DAffine3,
    tally: &mut Tally,
) {
    let uvs = if second { &baked.second_uvs } else { &baked.uvs };
    match given {
        Some(given) => carry(baked, given, world, tally),
        // Without UVs nothing says which way a texture runs.
        None if uvs.is_empty() => {
            baked.tangents = baked.normals.iter().map(|&n| across(n)).collect();
        }
        None => make(baked, second, tally),
    }
}

/// Any unit vector across a unit normal.
pub(super) fn across(normal: [f32; 3]) -> [f32; 4] {
    Vec3::from(normal).any_orthonormal_vector().extend(1.0).to_array()
}

fn carry(baked: &mut BakedPrimitive, given: &[[f32; 4]], world: &DAffine3, tally: &mut Tally) {
    // Mirroring turns normal x tangent over against the carried bitangent.
    let mirror = if world.matrix3.determinant() < 0.0 { -1.0 } else { 1.0 };
    let carried = given.iter().zip(&baked.normals).map(|(&[x, y, z, w], &normal)| {
        let along = world.matrix3 * DVec3::new(x.into(), y.into(), z.into());
        let n = Vec3::from(normal).as_dvec3();
        match (along - n * n.dot(along)).try_normalize() {
            Some(t) => {
                let sign = if w < 0.0 { -mirror } else { mirror };
                t.as_vec3().extend(sign).to_array()
            }
            None => {
                tally.bad_tangents += 1;
                across(normal)
            }
        }
    });
    baked.tangents = carried.collect();
}

/// A primitive as MikkTSpace sees it, and the tangent of every corner.
struct Corners<'a> {
    baked: &'a BakedPrimitive,
    uvs: &'a [[f32; 2]],
    /// The middle of the primitive, so that positions in f32 are exact.
    center: DVec3,
    tangents: Vec<Option<[f32; 4]>>,
}

impl Corners<'_> {
    fn vertex(&self, face: usize, corner: usize) -> usize {
        self.baked.triangles[face][corner] as usize
    }
}

impl Geometry for Corners<'_> {
    fn num_faces(&self) -> usize {
        self.baked.triangles.len()
    }

    fn num_vertices_of_face(&self, _face: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        let p = self.baked.positions[self.vertex(face, corner)];
        (p - self.center).as_vec3().to_array()
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        self.baked.normals[self.vertex(face, corner)]
    }

    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        let [u, v] = self.uvs[self.vertex(face, corner)];
        // MikkTSpace's v points up, glTF's down: green in a normal map is up (+Y), against v.
        [u, 1.0 - v]
    }

    fn set_tangent(&mut self, space: Option<TangentSpace>, face: usize, corner: usize) {
        self.tangents[3 * face + corner] = space.map(|space| space.tangent_encoded());
    }
}

fn make(baked: &mut BakedPrimitive, second: bool, tally: &mut Tally) {
    tally.made_tangents += baked.positions.len();
    let Some(&center) = baked.triangles.first().map(|t| &baked.positions[t[0] as usize]) else {
        baked.tangents = baked.normals.iter().map(|&n| across(n)).collect();
        return;
    };
    let uvs = if second { &baked.second_uvs } else { &baked.uvs };
    let mut corners = Corners { baked, uvs, center, tangents: vec![None; 3 * baked.triangles.len()] };
    // Its error type has no values; were there one, the tangents would stay None and be replaced below.
    let _ = generate_tangents(&mut corners);
    let tangents = corners.tangents;
    split(baked, tangents, tally);
}

/// An attribute's value of a vertex once more, where the primitive has the attribute.
fn double<T: Copy>(attribute: &mut Vec<T>, vertex: usize) {
    attribute.extend(attribute.get(vertex).copied());
}

/// Gives each vertex its corners' tangent; where corners differ, the vertex is doubled.
fn split(baked: &mut BakedPrimitive, corners: Vec<Option<[f32; 4]>>, tally: &mut Tally) {
    let mut tangents: Vec<Option<[f32; 4]>> = vec![None; baked.positions.len()];
    let mut doubles: HashMap<(u32, [u32; 4]), u32> = HashMap::new();
    for (corner, tangent) in corners.into_iter().enumerate() {
        let index = &mut baked.triangles[corner / 3][corner % 3];
        let old = *index as usize;
        let sound = tangent.filter(|t| Vec3::from_slice(t).is_normalized());
        let tangent = sound.unwrap_or_else(|| {
            tally.bad_tangents += 1;
            across(baked.normals[old])
        });
        match tangents[old] {
            None => tangents[old] = Some(tangent),
            Some(first) if first == tangent => {}
            Some(_) => {
                let key = (*index, tangent.map(f32::to_bits));
                *index = *doubles.entry(key).or_insert_with(|| {
                    baked.positions.push(baked.positions[old]);
                    baked.normals.push(baked.normals[old]);
                    double(&mut baked.uvs, old);
                    double(&mut baked.second_uvs, old);
                    double(&mut baked.colors, old);
                    tangents.push(Some(tangent));
                    tangents.len() as u32 - 1
                });
            }
        }
    }
    // A vertex of no triangle is dropped later; until then it has some tangent.
    let normals = baked.normals.iter();
    baked.tangents =
        tangents.into_iter().zip(normals).map(|(tangent, &normal)| tangent.unwrap_or_else(|| across(normal))).collect();
}
