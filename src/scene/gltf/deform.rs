//! Morph targets and skins: a primitive's vertices as one node shows them.

use glam::{DAffine3, DMat3, DVec3, Vec3};

use super::accessor::{Accessor, Budget, Component};
use super::json::At;
use super::meshes::{Geometry, MeshSource, PrimitiveSource};
use super::nodes::{Node, roots_of, walk};
use crate::scene::bake::{LocalPrimitive, normal_matrix};
use crate::scene::error::Fault;

/// A skin, its references checked.
pub(super) struct Skin {
    path: String,
    /// Nodes.
    joints: Vec<usize>,
    /// Accessor of a matrix for each joint; identity where absent.
    inverse_binds: Option<usize>,
}

/// Number of skins that nodes may name.
pub(super) fn count_skins(root: &At) -> Result<usize, Fault> {
    Ok(root.list("skins")?.len())
}

/// All skins of the file.
pub(super) fn read_skins(root: &At, nodes: usize, accessors: &[Accessor]) -> Result<Vec<Skin>, Fault> {
    let read = |at: &At| {
        let joints = at.indices("joints", nodes, "nodes")?;
        let inverse_binds = at.index("inverseBindMatrices", accessors.len(), "accessors")?;
        if let Some(matrices) = inverse_binds.map(|i| &accessors[i]) {
            let place = at.place("inverseBindMatrices");
            matrices.expect_width(&[16], &place)?;
            if matrices.component != Component::F32 || matrices.count < joints.len() {
                let reason = format!("{} float matrices are needed, one a joint", joints.len());
                return Err(Fault::new(place, reason));
            }
        }
        Ok(Skin { path: at.path().to_owned(), joints, inverse_binds })
    };
    root.list("skins")?.iter().map(read).collect()
}

/// World transforms of every node, whatever scene it is in: joints may stand beside the drawn ones.
pub(super) fn worlds(nodes: &[Node]) -> Vec<DAffine3> {
    let mut worlds = vec![DAffine3::IDENTITY; nodes.len()];
    for (node, world) in walk(nodes, &roots_of(nodes)) {
        worlds[node] = world;
    }
    worlds
}

impl Skin {
    /// What each joint does to a vertex: from the mesh's space to the world.
    fn matrices(&self, worlds: &[DAffine3], accessors: &[Accessor]) -> Vec<DAffine3> {
        let inverse = |i: usize| {
            let Some(accessor) = self.inverse_binds else { return DAffine3::IDENTITY };
            let m = accessors[accessor].floats::<16>(i).map(f64::from);
            let column = |c: usize| DVec3::new(m[c], m[c + 1], m[c + 2]);
            DAffine3 { matrix3: DMat3::from_cols(column(0), column(4), column(8)), translation: column(12) }
        };
        self.joints.iter().enumerate().map(|(i, &joint)| worlds[joint] * inverse(i)).collect()
    }
}

/// Everything that deforms.
pub(super) struct Deformer<'a> {
    pub accessors: &'a [Accessor<'a>],
    pub skins: &'a [Skin],
    pub worlds: &'a [DAffine3],
}

/// A mesh as one node shows it.
pub(super) struct Deformed {
    pub primitives: Vec<LocalPrimitive>,
    /// The vertices are in the world already: a skin places them, not its node.
    pub in_world: bool,
    /// Vertices of a skin that no joint moves.
    pub unweighted: usize,
}

impl Deformer<'_> {
    /// The node's mesh deformed; `None` where the mesh as it is stored will do.
    pub fn of_node(
        &self,
        node: &Node,
        mesh: &MeshSource,
        stored: &[Geometry],
        budget: &mut Budget,
    ) -> Result<Option<Deformed>, Fault> {
        let weights = if node.weights.is_empty() { &mesh.weights } else { &node.weights };
        let morphs = weights.iter().any(|w| *w != 0.0) && mesh.primitives.iter().any(|p| !p.targets.is_empty());
        let skin = node.skin.map(|s| &self.skins[s]).filter(|_| mesh.primitives.iter().any(|p| !p.joints.is_empty()));
        if !morphs && skin.is_none() {
            return Ok(None);
        }
        let mut deformed = Deformed { primitives: Vec::new(), in_world: skin.is_some(), unweighted: 0 };
        if let Some(skin) = skin {
            budget.take(&skin.path, skin.joints.len(), size_of::<DAffine3>())?;
        }
        let matrices = skin.map_or_else(Vec::new, |skin| skin.matrices(self.worlds, self.accessors));
        for (source, stored) in mesh.primitives.iter().zip(stored) {
            budget.take(&source.path, stored.kept.len(), 48)?;
            budget.take(&source.path, stored.local.triangles.len(), 12)?;
            let mut local = stored.local.clone();
            self.morph(source, &stored.kept, weights, &mut local);
            if let Some(skin) = skin {
                deformed.unweighted += self.skin(source, &stored.kept, skin, &matrices, &mut local)?;
            }
            deformed.primitives.push(local);
        }
        Ok(Some(deformed))
    }

    /// Adds each target's differences, weighted. Normals and tangents are left for baking to bring to unit length.
    fn morph(&self, source: &PrimitiveSource, kept: &[usize], weights: &[f64], local: &mut LocalPrimitive) {
        for (target, weight) in source.targets.iter().zip(weights).filter(|(_, w)| **w != 0.0) {
            let weight = *weight as f32;
            let add = |to: &mut [f32], from: Option<usize>, vertex: usize| {
                if let Some(accessor) = from {
                    let delta = self.accessors[accessor].floats::<3>(vertex);
                    to.iter_mut().zip(delta).for_each(|(x, d)| *x += weight * d);
                }
            };
            for (i, &vertex) in kept.iter().enumerate() {
                add(&mut local.positions[i], target.position, vertex);
                if let Some(normals) = &mut local.normals {
                    add(&mut normals[i], target.normal, vertex);
                }
                if let Some(tangents) = &mut local.tangents {
                    add(&mut tangents[i][..3], target.tangent, vertex);
                }
            }
        }
        if let Some(normals) = &mut local.normals {
            // Sums of differences are seldom of unit length; that is no fault of the file.
            normals.iter_mut().for_each(|n| *n = Vec3::from(*n).normalize_or_zero().to_array());
        }
    }

    /// Moves every vertex by its joints (linear blend skinning); returns how many have no weight and stay.
    fn skin(
        &self,
        source: &PrimitiveSource,
        kept: &[usize],
        skin: &Skin,
        matrices: &[DAffine3],
        local: &mut LocalPrimitive,
    ) -> Result<usize, Fault> {
        let (mut unweighted, mut mirrored) = (0, 0);
        for (i, &vertex) in kept.iter().enumerate() {
            let (mut sum, mut total) = (DAffine3::ZERO, 0.0);
            for [joints, weights] in &source.joints {
                let weights = self.accessors[*weights].floats::<4>(vertex).map(f64::from);
                let joints = self.accessors[*joints].integers::<4>(vertex);
                for (joint, weight) in joints.into_iter().zip(weights).filter(|(_, w)| *w > 0.0 && w.is_finite()) {
                    let Some(matrix) = matrices.get(joint as usize) else {
                        let reason = format!(
                            "joint {joint} of vertex {vertex} is out of range; {} has {}",
                            skin.path,
                            matrices.len()
                        );
                        return Err(Fault::new(&source.path, reason));
                    };
                    sum.matrix3 += matrix.matrix3 * weight;
                    sum.translation += matrix.translation * weight;
                    total += weight;
                }
            }
            if total <= 0.0 {
                unweighted += 1;
                continue;
            }
            let moved = DAffine3 { matrix3: sum.matrix3 * total.recip(), translation: sum.translation * total.recip() };
            mirrored += usize::from(moved.matrix3.determinant() < 0.0);
            let stored = Vec3::from(local.positions[i]).as_dvec3();
            local.positions[i] = moved.transform_point3(stored).as_vec3().to_array();
            if let Some(normals) = &mut local.normals {
                let normal = normal_matrix(&moved.matrix3) * Vec3::from(normals[i]).as_dvec3();
                normals[i] = normal.normalize_or_zero().as_vec3().to_array();
            }
            if let Some(tangents) = &mut local.tangents {
                let [x, y, z, sign] = tangents[i];
                let along = (moved.matrix3 * DVec3::new(x.into(), y.into(), z.into())).normalize_or_zero().as_vec3();
                tangents[i] = along.extend(sign).to_array();
            }
        }
        if 2 * mirrored > kept.len() {
            local.triangles.iter_mut().for_each(|t| t.swap(1, 2));
        }
        Ok(unweighted)
    }
}
