//! The node graph: local transforms composed into world transforms, in f64, for the nodes of the chosen scene.

use glam::{DAffine3, DMat3, DQuat, DVec3};

use super::json::At;
use crate::scene::error::Fault;

/// What a node carries; indices are checked.
pub(super) struct Node {
    pub local: Local,
    children: Vec<usize>,
    pub mesh: Option<usize>,
    pub skin: Option<usize>,
    /// Weights of the mesh's morph targets; empty: the mesh's own.
    pub weights: Vec<f64>,
    pub camera: Option<usize>,
    pub light: Option<usize>,
    pub instanced: bool,
    pub name: Option<String>,
}

/// A transform in the node's parent.
pub(super) struct Local {
    /// Given whole; then the parts mean nothing.
    pub matrix: Option<DAffine3>,
    pub translation: DVec3,
    /// Not always of unit length.
    pub rotation: DQuat,
    pub scale: DVec3,
}

impl Local {
    fn affine(&self) -> DAffine3 {
        let length = self.rotation.length();
        let rotation =
            if length > 0.0 && length.is_finite() { self.rotation * length.recip() } else { DQuat::IDENTITY };
        let parts = || DAffine3::from_scale_rotation_translation(self.scale, rotation, self.translation);
        self.matrix.unwrap_or_else(parts)
    }
}

/// How many things of each kind nodes may point to.
pub(super) struct Counts {
    pub meshes: usize,
    pub cameras: usize,
    pub lights: usize,
    pub skins: usize,
}

/// Reads all nodes and checks that they are a forest.
pub(super) fn read_nodes(root: &At, counts: &Counts) -> Result<Vec<Node>, Fault> {
    let list = root.list("nodes")?;
    let mut nodes = Vec::with_capacity(list.len());
    for at in &list {
        let light = match at.extension("KHR_lights_punctual")? {
            Some(light) => light.index("light", counts.lights, "lights")?,
            None => None,
        };
        nodes.push(Node {
            local: read_transform(at)?,
            children: at.indices("children", list.len(), "nodes")?,
            mesh: at.index("mesh", counts.meshes, "meshes")?,
            camera: at.index("camera", counts.cameras, "cameras")?,
            light,
            skin: at.index("skin", counts.skins, "skins")?,
            weights: at.all_numbers("weights")?,
            instanced: at.extension("EXT_mesh_gpu_instancing")?.is_some(),
            name: at.text("name")?.map(str::to_owned),
        });
    }
    let mut parent = vec![None; nodes.len()];
    for (index, node) in nodes.iter().enumerate() {
        for &child in &node.children {
            if let Some(first) = parent[child].replace(index) {
                return Err(Fault::new(
                    format!("nodes[{index}].children"),
                    format!("node {child} is already a child of node {first}; a node has one parent"),
                ));
            }
        }
    }
    // With one parent each, what no root reaches is a cycle.
    let roots = roots_of(&nodes);
    let mut reached = vec![false; nodes.len()];
    for (node, _) in walk(&nodes, &roots) {
        reached[node] = true;
    }
    match reached.iter().position(|&r| !r) {
        Some(node) => {
            Err(Fault::new(format!("nodes[{node}].children"), "the node is its own ancestor; nodes must form trees"))
        }
        None => Ok(nodes),
    }
}

fn read_transform(at: &At) -> Result<Local, Fault> {
    let matrix = at.numbers::<16>("matrix")?.map(|m| {
        let column = |i: usize| DVec3::new(m[i], m[i + 1], m[i + 2]);
        DAffine3 { matrix3: DMat3::from_cols(column(0), column(4), column(8)), translation: column(12) }
    });
    let translation = at.numbers::<3>("translation")?.unwrap_or([0.0; 3]);
    let rotation = DQuat::from_array(at.numbers::<4>("rotation")?.unwrap_or([0.0, 0.0, 0.0, 1.0]));
    let scale = at.numbers::<3>("scale")?.unwrap_or([1.0; 3]);
    if !(rotation.length() > 1e-6 && rotation.length().is_finite()) {
        return Err(Fault::new(at.place("rotation"), "a quaternion of length 0 is no rotation"));
    }
    Ok(Local { matrix, translation: translation.into(), rotation, scale: scale.into() })
}

/// The nodes that are nobody's child.
pub(super) fn roots_of(nodes: &[Node]) -> Vec<usize> {
    let mut is_root = vec![true; nodes.len()];
    for &child in nodes.iter().flat_map(|node| &node.children) {
        is_root[child] = false;
    }
    (0..nodes.len()).filter(|&n| is_root[n]).collect()
}

/// The roots of the scene to draw, and a note if it was not the plain case.
pub(super) fn choose_scene(root: &At, nodes: &[Node]) -> Result<(Vec<usize>, Option<String>), Fault> {
    let scenes = root.list("scenes")?;
    let chosen = root.index("scene", scenes.len(), "scenes")?;
    let mut lists = Vec::with_capacity(scenes.len());
    for scene in &scenes {
        lists.push(scene.indices("nodes", nodes.len(), "nodes")?);
    }
    if lists.is_empty() {
        return Ok((roots_of(nodes), None));
    }
    let index = chosen.unwrap_or(0);
    let note = (lists.len() > 1).then(|| {
        let which = if chosen.is_some() { "default" } else { "first" };
        format!("only scene {index}, the {which} of {}, is drawn", lists.len())
    });
    Ok((lists.swap_remove(index), note))
}

/// The nodes below these roots with their world transforms, parents first, each once.
pub(super) fn walk(nodes: &[Node], roots: &[usize]) -> Vec<(usize, DAffine3)> {
    let mut seen = vec![false; nodes.len()];
    let mut found = Vec::new();
    // A stack of our own: a chain of nodes may be deeper than the thread's.
    let mut todo: Vec<_> = roots.iter().rev().map(|&r| (r, DAffine3::IDENTITY)).collect();
    while let Some((index, above)) = todo.pop() {
        if std::mem::replace(&mut seen[index], true) {
            continue;
        }
        let node = &nodes[index];
        let world = above * node.local.affine();
        found.push((index, world));
        todo.extend(node.children.iter().rev().map(|&child| (child, world)));
    }
    found
}
