//! Buffer views compressed by EXT_meshopt_compression or its successor KHR_meshopt_compression: what they unpack to. The
//! decoder is made for data that lies, but takes counts and sizes at their word, so those are checked here; what comes
//! out is checked by whoever reads it, as any view's bytes are.

use bytemuck::{TransparentWrapper, TransparentWrapperAlloc};

use super::accessor::{Budget, bytes_of};
use super::json::At;
use crate::scene::error::Fault;

const NAMES: [&str; 2] = ["EXT_meshopt_compression", "KHR_meshopt_compression"];

fn extension<'a>(at: &At<'a>) -> Result<Option<At<'a>>, Fault> {
    let [old, new] = NAMES.map(|name| at.extension(name));
    Ok(new?.or(old?))
}

/// Which buffers only stand in for what compressed views unpack to, and have no bytes of their own to be read: those that say so,
/// and those that are nowhere and that nothing else reads.
pub(super) fn stand_ins(root: &At) -> Result<Vec<bool>, Fault> {
    let buffers = root.list("buffers")?;
    let (mut packed, mut read) = (vec![false; buffers.len()], vec![false; buffers.len()]);
    for view in root.list("bufferViews")? {
        let of = extension(&view)?;
        let users = if of.is_some() { &mut packed } else { &mut read };
        view.index("buffer", buffers.len(), "buffers")?.into_iter().for_each(|b| users[b] = true);
        if let Some(of) = of {
            of.index("buffer", buffers.len(), "buffers")?.into_iter().for_each(|b| read[b] = true);
        }
    }
    let stands_in = |(index, buffer): (usize, &At)| {
        let says_so = extension(buffer)?.map_or(Ok(false), |of| of.flag("fallback"))?;
        Ok(says_so || (buffer.text("uri")?.is_none() && packed[index] && !read[index]))
    };
    buffers.iter().enumerate().map(stands_in).collect()
}

/// The bytes of each compressed buffer view; `None` for the others.
pub(super) fn unpack(root: &At, buffers: &[Vec<u8>], budget: &mut Budget) -> Result<Vec<Option<Vec<u8>>>, Fault> {
    let views = root.list("bufferViews")?;
    views.iter().map(|view| extension(view)?.map(|of| unpack_view(view, &of, buffers, budget)).transpose()).collect()
}

fn unpack_view(view: &At, of: &At, buffers: &[Vec<u8>], budget: &mut Budget) -> Result<Vec<u8>, Fault> {
    let packed = bytes_of(of, buffers)?;
    let stride = of.required(of.uint("byteStride")?, "byteStride")?;
    let count = of.required(of.uint("count")?, "count")?;
    let length = view.required(view.uint("byteLength")?, "byteLength")?;
    if count.checked_mul(stride) != Some(length) {
        let reason = format!("{count} elements of {stride} bytes are not the buffer view's {length} bytes");
        return Err(Fault::new(of.path(), reason));
    }
    // Filters work on a copy.
    budget.take(of.path(), length as usize, 2)?;
    let mode = of.required(of.text("mode")?, "mode")?;
    let filter = of.text("filter")?.unwrap_or("NONE");
    match decode(mode, filter, stride, packed, count as usize) {
        Some(Ok(bytes)) => Ok(bytes),
        Some(Err(_)) => Err(Fault::new(of.path(), format!("damaged: its bytes are not {count} elements of {mode}"))),
        None => {
            let reason = format!("there is no mode {mode} with filter {filter} for {count} elements of {stride} bytes");
            Err(Fault::new(of.path(), reason))
        }
    }
}

type Unpacked = meshopt::Result<Vec<u8>>;

/// `None` where the extensions define nothing of the kind.
fn decode(mode: &str, filter: &str, stride: u64, packed: &[u8], count: usize) -> Option<Unpacked> {
    let whole = count.is_multiple_of(3);
    Some(match (mode, filter, stride) {
        ("TRIANGLES", "NONE", 2) if whole => meshopt::decode_index_buffer::<u16>(packed, count).map(flat),
        ("TRIANGLES", "NONE", 4) if whole => meshopt::decode_index_buffer::<u32>(packed, count).map(flat),
        ("INDICES", "NONE", 2) => meshopt::decode_index_sequence::<u16>(packed, count).map(flat),
        ("INDICES", "NONE", 4) => meshopt::decode_index_sequence::<u32>(packed, count).map(flat),
        ("ATTRIBUTES", "OCTAHEDRAL", 4) => filtered(packed, count, meshopt::decode_filter_oct::<i8>),
        ("ATTRIBUTES", "OCTAHEDRAL", 8) => filtered(packed, count, meshopt::decode_filter_oct::<i16>),
        ("ATTRIBUTES", "QUATERNION", 8) => filtered(packed, count, meshopt::decode_filter_quat),
        ("ATTRIBUTES", "COLOR", 4) => filtered(packed, count, meshopt::decode_filter_color::<u8>),
        ("ATTRIBUTES", "COLOR", 8) => filtered(packed, count, meshopt::decode_filter_color::<u16>),
        ("ATTRIBUTES", "EXPONENTIAL", _) => attributes(stride, packed, count)?.map(|bytes| {
            let mut words: Vec<[u32; 1]> = bytemuck::pod_collect_to_vec(&bytes);
            meshopt::decode_filter_exp(&mut words);
            flat(words)
        }),
        ("ATTRIBUTES", "NONE", _) => attributes(stride, packed, count)?,
        _ => return None,
    })
}

fn filtered<T: bytemuck::Pod + Default>(packed: &[u8], count: usize, filter: fn(&mut [T])) -> Unpacked {
    let mut elements = meshopt::decode_vertex_buffer::<T>(packed, count)?;
    filter(&mut elements);
    Ok(flat(elements))
}

fn flat<T: bytemuck::Pod>(elements: Vec<T>) -> Vec<u8> {
    bytemuck::pod_collect_to_vec(&elements)
}

/// An element: the decoder knows its size by its type.
#[derive(Clone, Copy, TransparentWrapper)]
#[repr(transparent)]
struct Element<const N: usize>([u8; N]);

impl<const N: usize> Default for Element<N> {
    fn default() -> Self {
        Self([0; N])
    }
}

fn elements<const N: usize>(packed: &[u8], count: usize) -> Unpacked {
    let elements = meshopt::decode_vertex_buffer::<Element<N>>(packed, count)?;
    Ok(Element::peel_vec(elements).into_flattened())
}

/// Elements of any size that the format knows.
fn attributes(stride: u64, packed: &[u8], count: usize) -> Option<Unpacked> {
    macro_rules! of_size {
        ($($bytes:literal)*) => {
            match stride {
                $($bytes => Some(elements::<$bytes>(packed, count)),)*
                _ => None,
            }
        };
    }
    of_size!(4 8 12 16 20 24 28 32 36 40 44 48 52 56 60 64 68 72 76 80 84 88 92 96 100 104 108 112 116 120 124 128
        132 136 140 144 148 152 156 160 164 168 172 176 180 184 188 192 196 200 204 208 212 216 220 224 228 232 236 240
        244 248 252 256)
}
