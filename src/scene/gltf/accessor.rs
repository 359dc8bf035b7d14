//! Accessors: typed arrays inside buffers. All are checked against the bytes that are really there before any element
//! is read; elements are then read one at a time, so nothing is allocated for what a header claims.

use std::cmp::Ordering;
use std::collections::HashMap;

use super::json::At;
use crate::scene::error::Fault;

/// Memory that may still be filled from a file, so that a small file cannot ask for a large scene by repetition.
#[derive(Clone)]
pub(super) struct Budget {
    left: u64,
    total: u64,
}

impl Budget {
    pub fn new(total: u64) -> Self {
        Self { left: total, total }
    }

    /// Takes `count` things of `bytes` each, or says that the file asks for too much.
    pub fn take(&mut self, place: &str, count: usize, bytes: usize) -> Result<(), Fault> {
        let wanted = (count as u64).saturating_mul(bytes as u64);
        match self.left.checked_sub(wanted) {
            Some(left) => {
                self.left = left;
                Ok(())
            }
            None => Err(Fault::new(
                place,
                format!(
                    "{count} elements pass the limit of {} MiB of geometry for a file of this size",
                    self.total >> 20
                ),
            )),
        }
    }
}

/// A stretch of a buffer.
#[derive(Clone, Copy)]
pub(super) struct View<'a> {
    pub bytes: &'a [u8],
    pub stride: Option<usize>,
}

/// All buffer views, inside their buffers, or as they were unpacked.
pub(super) fn read_views<'a>(
    root: &At,
    buffers: &'a [Vec<u8>],
    unpacked: &'a [Option<Vec<u8>>],
) -> Result<Vec<View<'a>>, Fault> {
    let read = |(view, unpacked): (&At, &'a Option<Vec<u8>>)| {
        let bytes = match unpacked {
            Some(unpacked) => unpacked,
            None => bytes_of(view, buffers)?,
        };
        Ok(View { bytes, stride: view.uint("byteStride")?.map(|stride| stride as usize) })
    };
    root.list("bufferViews")?.iter().zip(unpacked).map(read).collect()
}

/// The stretch of a buffer that an object names.
pub(super) fn bytes_of<'a>(at: &At, buffers: &'a [Vec<u8>]) -> Result<&'a [u8], Fault> {
    let buffer = at.index("buffer", buffers.len(), "buffers")?;
    let buffer = &buffers[at.required(buffer, "buffer")?];
    let offset = at.uint("byteOffset")?.unwrap_or(0);
    let length = at.required(at.uint("byteLength")?, "byteLength")?;
    match offset.checked_add(length).filter(|&end| end <= buffer.len() as u64) {
        Some(end) => Ok(&buffer[offset as usize..end as usize]),
        None => {
            Err(Fault::new(at.path(), format!("bytes {offset} + {length} reach past the buffer's {}", buffer.len())))
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn from_code(code: u64) -> Option<Self> {
        Some(match code {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => return None,
        })
    }

    pub fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// Reads the first component of `b`, which holds at least [`size`](Self::size) bytes.
    fn float(self, b: &[u8], normalized: bool) -> f32 {
        // Signed integers: the most negative one clamps, as glTF defines.
        let scaled = |value: f32, max: f32| {
            if normalized { (value / max).max(-1.0) } else { value }
        };
        match self {
            Self::I8 => scaled(f32::from(b[0] as i8), 127.0),
            Self::U8 => scaled(f32::from(b[0]), 255.0),
            Self::I16 => scaled(f32::from(i16::from_le_bytes([b[0], b[1]])), 32767.0),
            Self::U16 => scaled(f32::from(u16::from_le_bytes([b[0], b[1]])), 65535.0),
            Self::U32 => self.uint(b) as f32,
            Self::F32 => f32::from_le_bytes([b[0], b[1], b[2], b[3]]),
        }
    }

    fn uint(self, b: &[u8]) -> u32 {
        match self {
            Self::I8 | Self::U8 => u32::from(b[0]),
            Self::I16 | Self::U16 => u32::from(u16::from_le_bytes([b[0], b[1]])),
            Self::U32 | Self::F32 => u32::from_le_bytes([b[0], b[1], b[2], b[3]]),
        }
    }
}

/// Elements at a stride in checked bytes.
#[derive(Clone, Copy)]
struct Stripe<'a> {
    bytes: &'a [u8],
    stride: usize,
}

impl<'a> Stripe<'a> {
    /// `count` elements of `size` bytes at `offset` of a view, all inside it.
    fn new(at: &At, view: View<'a>, offset: u64, size: usize, count: usize) -> Result<Self, Fault> {
        let stride = view.stride.unwrap_or(size);
        if stride < size {
            return Err(Fault::new(at.path(), format!("elements of {size} bytes overlap at a byteStride of {stride}")));
        }
        let last = (count as u64).saturating_sub(1);
        let end = last.checked_mul(stride as u64).and_then(|start| start.checked_add(offset)?.checked_add(size as u64));
        match end {
            _ if count == 0 => Ok(Self { bytes: &[], stride }),
            Some(end) if end <= view.bytes.len() as u64 => Ok(Self { bytes: &view.bytes[offset as usize..], stride }),
            _ => Err(Fault::new(
                at.path(),
                format!(
                    "{count} elements of {size} bytes at offset {offset}, stride {stride}, reach past the buffer view's {} bytes",
                    view.bytes.len()
                ),
            )),
        }
    }

    fn element(&self, index: usize) -> &'a [u8] {
        &self.bytes[index * self.stride..]
    }
}

/// Elements that replace others.
struct Sparse<'a> {
    /// Which ones: strictly increasing.
    targets: Stripe<'a>,
    component: Component,
    count: usize,
    values: Stripe<'a>,
}

impl<'a> Sparse<'a> {
    fn target(&self, place: usize) -> u32 {
        self.component.uint(self.targets.element(place))
    }

    /// The replacement of an element, if it has one.
    fn find(&self, index: usize) -> Option<&'a [u8]> {
        let (mut low, mut high) = (0, self.count);
        while low < high {
            let middle = low.midpoint(high);
            match (self.target(middle) as usize).cmp(&index) {
                Ordering::Less => low = middle + 1,
                Ordering::Equal => return Some(self.values.element(middle)),
                Ordering::Greater => high = middle,
            }
        }
        None
    }
}

/// A typed array whose every element is known to lie inside its buffer.
pub(super) struct Accessor<'a> {
    pub path: String,
    pub count: usize,
    pub component: Component,
    pub width: usize,
    normalized: bool,
    /// Absent: all zero.
    base: Option<Stripe<'a>>,
    sparse: Option<Sparse<'a>>,
}

/// All accessors of a file; `filled` are those whose bytes stand in no view.
pub(super) fn read_accessors<'a>(
    root: &At,
    views: &[View<'a>],
    filled: &'a HashMap<usize, Vec<u8>>,
) -> Result<Vec<Accessor<'a>>, Fault> {
    let list = root.list("accessors")?;
    let read = |(index, at)| Accessor::read(at, views, filled.get(&index).map(Vec::as_slice));
    list.iter().enumerate().map(read).collect()
}

impl<'a> Accessor<'a> {
    fn read(at: &At, views: &[View<'a>], filled: Option<&'a [u8]>) -> Result<Self, Fault> {
        let component = read_component(at)?;
        let kind = at.required(at.text("type")?, "type")?;
        let (rows, columns) = match kind {
            "SCALAR" => (1, 1),
            "VEC2" => (2, 1),
            "VEC3" => (3, 1),
            "VEC4" => (4, 1),
            "MAT2" => (2, 2),
            "MAT3" => (3, 3),
            "MAT4" => (4, 4),
            other => return Err(Fault::new(at.place("type"), format!("there is no type '{other}'"))),
        };
        let width = rows * columns;
        // Columns of matrices of small components are padded to 4 bytes; such matrices are never read, only measured.
        let size = match columns {
            1 => rows * component.size(),
            _ => columns * (rows * component.size()).next_multiple_of(4),
        };
        let count = at.required(at.uint("count")?, "count")? as usize;
        for key in ["min", "max"] {
            let bounds = at.list(key)?.len();
            if bounds != 0 && bounds != width {
                return Err(Fault::new(at.place(key), format!("{bounds} numbers where {kind} has {width}")));
            }
        }
        let base = match at.index("bufferView", views.len(), "bufferViews")? {
            _ if filled.is_some() => {
                let whole = View { bytes: filled.unwrap_or_default(), stride: None };
                Some(Stripe::new(at, whole, 0, size, count)?)
            }
            Some(view) => {
                let offset = at.uint("byteOffset")?.unwrap_or(0);
                Some(Stripe::new(at, views[view], offset, size, count)?)
            }
            None => None,
        };
        let sparse = match at.object("sparse")? {
            Some(sparse) => Some(read_sparse(&sparse, views, size, count)?),
            None => None,
        };
        Ok(Self {
            path: at.path().to_owned(),
            count,
            component,
            width,
            normalized: at.flag("normalized")?,
            base,
            sparse,
        })
    }

    /// All the values that scalar elements have, in no useful order. An accessor without bytes of its own is all zero
    /// save its sparse values, whatever count it claims: the count is not walked.
    pub fn distinct_uints(&self) -> impl Iterator<Item = u32> + use<'_, 'a> {
        let walked = if self.base.is_some() { self.count } else { self.count.min(1) };
        let replaced = self
            .sparse
            .iter()
            .flat_map(|sparse| (0..sparse.count).map(|i| self.component.uint(sparse.values.element(i))));
        (0..walked).map(|i| self.uint(i)).chain(replaced)
    }

    /// Fails unless elements have `width` components.
    pub fn expect_width(&self, width: &[usize], user: &str) -> Result<(), Fault> {
        if width.contains(&self.width) {
            Ok(())
        } else {
            Err(Fault::new(user, format!("{} has {} components where {} are needed", self.path, self.width, width[0])))
        }
    }

    /// The bytes of one element, or `None` for zero. `index` must be below `count`.
    fn bytes(&self, index: usize) -> Option<&'a [u8]> {
        let replaced = self.sparse.as_ref().and_then(|sparse| sparse.find(index));
        replaced.or_else(|| self.base.map(|base| base.element(index)))
    }

    /// One element as floats, the first `N` of its components. `index` must be below `count`.
    pub fn floats<const N: usize>(&self, index: usize) -> [f32; N] {
        let Some(bytes) = self.bytes(index) else {
            return [0.0; N];
        };
        let size = self.component.size();
        std::array::from_fn(|i| {
            if i < self.width { self.component.float(&bytes[i * size..], self.normalized) } else { 0.0 }
        })
    }

    /// One element as unsigned integers, the first `N` of its components. `index` must be below `count`.
    pub fn integers<const N: usize>(&self, index: usize) -> [u32; N] {
        let size = self.component.size();
        let read = |bytes: &[u8]| {
            std::array::from_fn(|i| if i < self.width { self.component.uint(&bytes[i * size..]) } else { 0 })
        };
        self.bytes(index).map_or([0; N], read)
    }

    /// Whether elements stand in a buffer, so that there are no more than its bytes.
    pub fn is_stored(&self) -> bool {
        self.base.is_some()
    }

    /// One scalar element as an unsigned integer. `index` must be below `count`.
    pub fn uint(&self, index: usize) -> u32 {
        self.bytes(index).map_or(0, |b| self.component.uint(b))
    }
}

pub(super) fn read_component(at: &At) -> Result<Component, Fault> {
    let code = at.required(at.uint("componentType")?, "componentType")?;
    Component::from_code(code).ok_or_else(|| {
        Fault::new(at.place("componentType"), format!("there is no type {code}; 5120..5123, 5125 and 5126 are"))
    })
}

fn read_sparse<'a>(at: &At, views: &[View<'a>], size: usize, target_count: usize) -> Result<Sparse<'a>, Fault> {
    let count = at.required(at.uint("count")?, "count")? as usize;
    let part = |key: &str, size: Option<usize>| {
        let part = at.required(at.object(key)?, key)?;
        let view = part.index("bufferView", views.len(), "bufferViews")?;
        let view = views[part.required(view, "bufferView")?];
        let component = match size {
            Some(_) => Component::F32,
            None => read_component(&part)?,
        };
        let size = size.unwrap_or(component.size());
        let offset = part.uint("byteOffset")?.unwrap_or(0);
        // Sparse data is tightly packed whatever its view says.
        let view = View { stride: None, ..view };
        Ok::<_, Fault>((Stripe::new(&part, view, offset, size, count)?, component))
    };
    let (indices, component) = part("indices", None)?;
    let (values, _) = part("values", Some(size))?;
    let sparse = Sparse { targets: indices, component, count, values };
    let ordered = (1..count).all(|i| sparse.target(i - 1) < sparse.target(i));
    let inside = count == 0 || (sparse.target(count - 1) as usize) < target_count;
    if !(ordered && inside) {
        return Err(Fault::new(
            at.place("indices"),
            format!("they must increase and stay below the accessor's count, {target_count}"),
        ));
    }
    Ok(sparse)
}
