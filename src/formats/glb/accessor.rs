//! Numbers of a glTF file: positions of corners, their places in a picture, and indices, read where they lie and checked against the bytes that are there.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};
use gltf::json::accessor::{Accessor, ComponentType, Type};
use gltf::json::validation::Checked;
use gltf::json::{Root, buffer};

use crate::FormatError;

/// The bytes of every buffer of a document.
pub(crate) type Buffers<'a> = [std::borrow::Cow<'a, [u8]>];

/// Positions of corners; nothing is copied.
pub(crate) struct Positions<'a> {
    numbers: AccessorElements<'a>,
    replaced: BTreeMap<u64, DVec3>,
}

/// Places of corners in a picture, from 0 to 1 across and down it.
pub(crate) struct PicturePlaces<'a>(AccessorElements<'a>);

/// Indices of corners, or simply their order.
pub(crate) enum Indices<'a> {
    /// The indices that the file lists.
    Listed(AccessorElements<'a>),
    /// No list: the corners in their order, so many of them.
    InOrder(u64),
}

/// Elements of one accessor in its buffer.
pub(crate) struct AccessorElements<'a> {
    /// Starts with the first element; `None` if all are zero.
    bytes: Option<&'a [u8]>,
    stride: usize,
    kind: ComponentType,
    normalized: bool,
    components: usize,
    count: u64,
}

impl<'a> Positions<'a> {
    /// From an accessor. Errors in one line if it holds no positions, or does not lie within its buffer.
    pub(crate) fn new(root: &Root, buffers: &'a Buffers<'_>, index: usize) -> Result<Self, FormatError> {
        let accessor = get(&root.accessors, index, "accessor")?;
        let numbers = AccessorElements::new(root, buffers, accessor, index)?;
        if numbers.components != 3 || matches!(numbers.kind, ComponentType::U32) {
            return Err(FormatError::new(format!(
                "accessor {index}: expected positions of three numbers each"
            )));
        }
        let mut replaced = BTreeMap::new();
        if let Some(sparse) = &accessor.sparse {
            let listed = AccessorElements {
                components: 1,
                normalized: false,
                kind: component(&sparse.indices.component_type)
                    .ok_or_else(|| wrong(index))?
                    .0,
                stride: component(&sparse.indices.component_type)
                    .ok_or_else(|| wrong(index))?
                    .1,
                count: sparse.count.0,
                bytes: Some(
                    from(
                        root,
                        buffers,
                        sparse.indices.buffer_view.value(),
                        sparse.indices.byte_offset.0,
                    )?
                    .0,
                ),
            }
            .checked(index)?;
            let (bytes, _) = from(
                root,
                buffers,
                sparse.values.buffer_view.value(),
                sparse.values.byte_offset.0,
            )?;
            let values = AccessorElements {
                bytes: Some(bytes),
                stride: numbers.tight(),
                count: sparse.count.0,
                ..numbers
            }
            .checked(index)?;
            let at = |i: u64| Some((listed.integer(i)?, values.vector(i)?));
            replaced = (0..sparse.count.0).filter_map(at).collect();
        }
        Ok(Self { numbers, replaced })
    }

    /// How many there are.
    pub(crate) fn count(&self) -> u64 {
        self.numbers.count
    }

    /// The position of a corner; `None` beyond the last one.
    pub(crate) fn get(&self, i: u64) -> Option<DVec3> {
        match self.replaced.get(&i) {
            Some(replaced) if i < self.numbers.count => Some(*replaced),
            _ => self.numbers.vector(i),
        }
    }
}

impl<'a> PicturePlaces<'a> {
    /// From an accessor. Errors in one line if it does not hold two numbers for each corner, or does not lie within its
    /// buffer.
    pub(crate) fn new(root: &Root, buffers: &'a Buffers<'_>, index: usize) -> Result<Self, FormatError> {
        let accessor = get(&root.accessors, index, "accessor")?;
        let numbers = AccessorElements::new(root, buffers, accessor, index)?;
        match numbers.components == 2 && accessor.sparse.is_none() {
            true => Ok(Self(numbers)),
            false => Err(FormatError::new(format!(
                "accessor {index}: expected places in a picture, of two numbers each"
            ))),
        }
    }

    /// The place of a corner; `None` beyond the last one.
    pub(crate) fn get(&self, i: u64) -> Option<DVec2> {
        let [x, y] = self.0.parts(i)?;
        Some(DVec2::new(x, y))
    }
}

impl<'a> Indices<'a> {
    /// From an accessor, or of `corners` in their order without one.
    pub(crate) fn new(
        root: &Root,
        buffers: &'a Buffers<'_>,
        index: Option<usize>,
        corners: u64,
    ) -> Result<Self, FormatError> {
        let Some(index) = index else {
            return Ok(Self::InOrder(corners));
        };
        let accessor = get(&root.accessors, index, "accessor")?;
        let numbers = AccessorElements::new(root, buffers, accessor, index)?;
        let is_index = matches!(
            numbers.kind,
            ComponentType::U8 | ComponentType::U16 | ComponentType::U32
        );
        if numbers.components != 1 || !is_index || accessor.sparse.is_some() {
            return Err(FormatError::new(format!("accessor {index}: expected indices")));
        }
        Ok(Self::Listed(numbers))
    }

    /// How many there are.
    pub(crate) fn count(&self) -> u64 {
        match self {
            Self::Listed(numbers) => numbers.count,
            Self::InOrder(count) => *count,
        }
    }

    /// One of them.
    pub(crate) fn get(&self, i: u64) -> Option<u64> {
        match self {
            Self::Listed(numbers) => numbers.integer(i),
            Self::InOrder(count) => (i < *count).then_some(i),
        }
    }
}

impl<'a> AccessorElements<'a> {
    fn new(
        root: &Root,
        buffers: &'a Buffers<'_>,
        accessor: &Accessor,
        index: usize,
    ) -> Result<Self, FormatError> {
        let kind = match &accessor.component_type {
            Checked::Valid(kind) => kind.0,
            Checked::Invalid => return Err(wrong(index)),
        };
        let components = match &accessor.type_ {
            Checked::Valid(Type::Scalar) => 1,
            Checked::Valid(Type::Vec2) => 2,
            Checked::Valid(Type::Vec3) => 3,
            _ => return Err(wrong(index)),
        };
        let tight = components * kind.size();
        let (bytes, stride) = match &accessor.buffer_view {
            None => (None, tight),
            Some(view) => {
                let offset = accessor.byte_offset.map_or(0, |offset| offset.0);
                let (bytes, stride) = from(root, buffers, view.value(), offset)?;
                (Some(bytes), stride.unwrap_or(tight))
            }
        };
        let numbers = Self {
            bytes,
            stride,
            kind,
            normalized: accessor.normalized,
            components,
            count: accessor.count.0,
        };
        numbers.checked(index)
    }

    /// Bytes of an element.
    fn tight(&self) -> usize {
        self.components * self.kind.size()
    }

    /// Itself if the bytes hold as many elements as it claims.
    fn checked(self, index: usize) -> Result<Self, FormatError> {
        let Some(bytes) = self.bytes else {
            return Ok(self);
        };
        let tight = self.tight() as u64;
        let needed = match self.count {
            0 => Some(0),
            count => (count - 1)
                .checked_mul(self.stride as u64)
                .and_then(|n| n.checked_add(tight)),
        };
        match needed {
            Some(needed) if needed <= bytes.len() as u64 && self.stride > 0 => Ok(self),
            _ => Err(FormatError::new(format!(
                "accessor {index}: {} elements of {tight} bytes, expected them within the {} bytes of the buffer's view",
                self.count,
                bytes.len()
            ))),
        }
    }

    fn element(&self, i: u64) -> Option<&'a [u8]> {
        let at = usize::try_from(i).ok()?.checked_mul(self.stride)?;
        self.bytes?.get(at..at.checked_add(self.tight())?)
    }

    fn integer(&self, i: u64) -> Option<u64> {
        let element = (i < self.count).then(|| self.element(i))??;
        Some(match self.kind {
            ComponentType::U8 => u64::from(element[0]),
            ComponentType::U16 => u64::from(u16::from_le_bytes(element.try_into().ok()?)),
            ComponentType::U32 => u64::from(u32::from_le_bytes(element.try_into().ok()?)),
            _ => return None,
        })
    }

    fn vector(&self, i: u64) -> Option<DVec3> {
        self.parts(i).map(DVec3::from_array)
    }

    /// The first numbers of an element.
    fn parts<const N: usize>(&self, i: u64) -> Option<[f64; N]> {
        if i >= self.count {
            return None;
        }
        if self.bytes.is_none() {
            return Some([0.0; N]);
        }
        let element = self.element(i)?;
        let size = self.kind.size();
        let part = |axis: usize| -> Option<f64> {
            let bytes = element.get(axis * size..(axis + 1) * size)?;
            Some(match self.kind {
                ComponentType::F32 => f64::from(f32::from_le_bytes(bytes.try_into().ok()?)),
                ComponentType::U8 => self.share(f64::from(bytes[0]), 255.0),
                ComponentType::I8 => self.share(f64::from(bytes[0] as i8), 127.0),
                ComponentType::U16 => {
                    self.share(f64::from(u16::from_le_bytes(bytes.try_into().ok()?)), 65535.0)
                }
                ComponentType::I16 => {
                    self.share(f64::from(i16::from_le_bytes(bytes.try_into().ok()?)), 32767.0)
                }
                ComponentType::U32 => return None,
            })
        };
        let mut out = [0.0; N];
        for (axis, value) in out.iter_mut().enumerate() {
            *value = part(axis)?;
        }
        Some(out)
    }

    /// A quantised number (`KHR_mesh_quantization`).
    fn share(&self, value: f64, full: f64) -> f64 {
        match self.normalized {
            true => (value / full).max(-1.0),
            false => value,
        }
    }
}

fn wrong(index: usize) -> FormatError {
    FormatError::new(format!(
        "accessor {index}: a type of numbers that holds neither positions nor indices"
    ))
}

/// An entry of a list of the document.
pub(crate) fn get<'a, T>(list: &'a [T], index: usize, what: &str) -> Result<&'a T, FormatError> {
    list.get(index).ok_or_else(|| {
        FormatError::new(format!(
            "{what} {index} is referred to, expected one of {}",
            list.len()
        ))
    })
}

/// Kind and size of the indices of a sparse accessor.
fn component(of: &Checked<gltf::json::accessor::IndexComponentType>) -> Option<(ComponentType, usize)> {
    match of {
        Checked::Valid(kind) => Some((kind.0, kind.0.size())),
        Checked::Invalid => None,
    }
}

/// The bytes of a view from an offset on, and how far apart its elements lie if it says so.
pub(crate) fn from<'a>(
    root: &Root,
    buffers: &'a Buffers<'_>,
    view: usize,
    offset: u64,
) -> Result<(&'a [u8], Option<usize>), FormatError> {
    let found: &buffer::View = get(&root.buffer_views, view, "buffer view")?;
    let bytes = get(buffers, found.buffer.value(), "buffer")?;
    let begin = found.byte_offset.map_or(0, |offset| offset.0);
    let range = begin.checked_add(found.byte_length.0).and_then(|end| {
        let from = begin.checked_add(offset).filter(|from| *from <= end)?;
        bytes.get(usize::try_from(from).ok()?..usize::try_from(end).ok()?)
    });
    let range = range.ok_or_else(|| {
        FormatError::new(format!(
            "buffer view {view}: {} bytes from byte {begin}, expected them within the {} bytes of the buffer",
            found.byte_length.0,
            bytes.len()
        ))
    })?;
    Ok((range, found.byte_stride.map(|stride| stride.0)))
}
