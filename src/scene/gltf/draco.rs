//! Primitives compressed by KHR_draco_mesh_compression: the bytes of the accessors that each unpacks to.

use std::collections::HashMap;

use draco_core::{DecoderBuffer, FaceIndex, Mesh, MeshDecoder, PointAttribute, PointIndex};

use super::accessor::{Budget, Component, View, read_component};
use super::json::At;
use crate::scene::error::Fault;

/// What decoding takes for each point and face that a stream claims, bytes: half as much again as was measured.
const WORK: usize = 192;

/// The bytes of each accessor that compressed primitives fill, by its index.
pub(super) fn unpack(root: &At, views: &[View], budget: &mut Budget) -> Result<HashMap<usize, Vec<u8>>, Fault> {
    let accessors = root.list("accessors")?;
    let mut filled = HashMap::new();
    for mesh in root.list("meshes")? {
        for primitive in mesh.list("primitives")? {
            if let Some(of) = primitive.extension("KHR_draco_mesh_compression")? {
                unpack_primitive(&primitive, &of, &accessors, views, budget, &mut filled)?;
            }
        }
    }
    Ok(filled)
}

fn unpack_primitive(
    primitive: &At,
    of: &At,
    accessors: &[At],
    views: &[View],
    budget: &mut Budget,
    filled: &mut HashMap<usize, Vec<u8>>,
) -> Result<(), Fault> {
    if primitive.uint("mode")?.unwrap_or(4) != 4 {
        return Err(Fault::new(primitive.place("mode"), "compressed primitives are read as lists of triangles alone"));
    }
    let view = of.index("bufferView", views.len(), "bufferViews")?;
    let mesh = decode(of, views[of.required(view, "bufferView")?].bytes, budget)?;
    let mut fill = |owner: &At, name: &str, values: &dyn Fn(&At) -> Result<Vec<u8>, Fault>| {
        let Some(index) = owner.index(name, accessors.len(), "accessors")? else { return Ok(()) };
        let bytes = values(&accessors[index])?;
        budget.take(of.path(), bytes.len(), 1)?;
        filled.insert(index, bytes);
        Ok(())
    };
    fill(primitive, "indices", &|accessor| indices(&mesh, accessor))?;
    let attributes = primitive.required(primitive.object("attributes")?, "attributes")?;
    let ids = of.required(of.object("attributes")?, "attributes")?;
    for name in ids.keys() {
        let id = ids.required(ids.uint(name)?, name)?;
        let attribute = u32::try_from(id).ok().and_then(|id| mesh.attribute_by_unique_id(id));
        let Some(attribute) = attribute else {
            return Err(Fault::new(ids.place(name), format!("the compressed mesh has no attribute {id}")));
        };
        fill(&attributes, name, &|accessor| values(&mesh, attribute, accessor))?;
    }
    Ok(())
}

fn decode(of: &At, packed: &[u8], budget: &Budget) -> Result<Mesh, Fault> {
    // The decoder takes no more than a face a bit for real; what it may build for that is still too much.
    let claimed = claimed(packed).unwrap_or(packed.len() as u64 * 8);
    budget.clone().take(of.path(), claimed.try_into().unwrap_or(usize::MAX), WORK)?;
    let mut mesh = Mesh::new();
    match MeshDecoder::new().decode(&mut DecoderBuffer::new(packed), &mut mesh) {
        Ok(()) => Ok(mesh),
        Err(reason) => Err(Fault::new(of.path(), format!("damaged: {reason}"))),
    }
}

/// Faces and points of a stream, by its own header; `None` where that cannot be read so easily.
fn claimed(packed: &[u8]) -> Option<u64> {
    const METADATA: u8 = 0x80;
    let header = packed.first_chunk::<11>().filter(|h| h.starts_with(b"DRACO") && h[10] & METADATA == 0)?;
    let mut rest = packed[11..].iter();
    // A mesh with connectivity of its own kind begins with that kind.
    if header[8] == 1 {
        rest.next()?;
    }
    let mut number = || {
        let mut value = 0u64;
        for shift in (0..35).step_by(7) {
            let byte = *rest.next()?;
            value |= u64::from(byte & 127) << shift;
            if byte < 128 {
                return Some(value);
            }
        }
        None
    };
    Some(number()? + number()?)
}

/// The triangles' corners, in the type that the accessor has.
fn indices(mesh: &Mesh, accessor: &At) -> Result<Vec<u8>, Fault> {
    let component = read_component(accessor)?;
    expect_count(accessor, 3 * mesh.num_faces())?;
    let corners = (0..mesh.num_faces()).flat_map(|face| mesh.face(FaceIndex(face as u32))).map(|point| point.0);
    let mut bytes = Vec::with_capacity(3 * mesh.num_faces() * component.size());
    for corner in corners {
        match component {
            Component::U8 if corner <= u8::MAX.into() => bytes.push(corner as u8),
            Component::U16 if corner <= u16::MAX.into() => bytes.extend((corner as u16).to_le_bytes()),
            Component::U32 => bytes.extend(corner.to_le_bytes()),
            _ => return Err(Fault::new(accessor.place("componentType"), format!("it cannot hold the index {corner}"))),
        }
    }
    Ok(bytes)
}

/// An attribute's values, a point after the other, in the type that both have.
fn values(mesh: &Mesh, attribute: &PointAttribute, accessor: &At) -> Result<Vec<u8>, Fault> {
    use draco_core::DataType;
    let component = read_component(accessor)?;
    expect_count(accessor, mesh.num_points())?;
    let same = match component {
        Component::I8 => DataType::Int8,
        Component::U8 => DataType::Uint8,
        Component::I16 => DataType::Int16,
        Component::U16 => DataType::Uint16,
        Component::U32 => DataType::Uint32,
        Component::F32 => DataType::Float32,
    };
    let width = usize::from(attribute.num_components());
    let meant = accessor.required(accessor.text("type")?, "type")?;
    let names: &[&str] = match width {
        1 => &["SCALAR"],
        2 => &["VEC2"],
        3 => &["VEC3"],
        4 => &["VEC4", "MAT2"],
        _ => &[],
    };
    if attribute.data_type() != same || !names.contains(&meant) {
        let reason = format!("the compressed mesh has {width} of {:?} there", attribute.data_type());
        return Err(Fault::new(accessor.place("type"), reason));
    }
    let (size, stride) = (width * component.size(), attribute.byte_stride().max(0) as usize);
    let mut bytes = Vec::with_capacity(size * mesh.num_points());
    for point in 0..mesh.num_points() {
        let start = attribute.mapped_index(PointIndex(point as u32)).0 as usize * stride;
        match attribute.buffer().data().get(start..start.saturating_add(size)) {
            Some(value) => bytes.extend(value),
            None => return Err(Fault::new(accessor.path(), "the compressed mesh ends before its last point")),
        }
    }
    Ok(bytes)
}

fn expect_count(accessor: &At, unpacked: usize) -> Result<(), Fault> {
    match accessor.required(accessor.uint("count")?, "count")? {
        count if count == unpacked as u64 => Ok(()),
        count => Err(Fault::new(accessor.place("count"), format!("{count}, but the compressed mesh has {unpacked}"))),
    }
}
