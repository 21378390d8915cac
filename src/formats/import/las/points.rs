//! The points of a LAS file, as they are or unpacked from LAZ.
//!
//! LAZ is unpacked by the crate `laz`, chunk by chunk. The crate allocates as much memory as a chunk claims to need, so
//! the sizes that a chunk gives are checked here first, against the bytes that are there.

use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};

use glam::DVec3;
use laz::record::{LayeredPointRecordDecompressor, RecordDecompressor, SequentialPointRecordDecompressor};
use laz::{DecompressionSelection, LazItem, LazVlr};

use super::header::LasHeader;
use super::{LasError, wrong};

/// The fields of a point that are used.
pub(super) struct LasPoint {
    /// In the file's coordinates, m.
    pub(super) at_m: DVec3,
    /// Number of the standard.
    pub(super) classification: u8,
    /// The class in Occ3D, where the file has a byte for it.
    pub(super) class: Option<u8>,
    /// Deleted, in effect.
    pub(super) is_withheld: bool,
}

impl LasPoint {
    fn new(header: &LasHeader, bytes: &[u8]) -> Self {
        let int = |at: usize| bytes[at..].first_chunk().map_or(0, |b| i32::from_le_bytes(*b));
        let steps = DVec3::from_array([0, 4, 8].map(|at| f64::from(int(at))));
        let (classification, is_withheld) = match header.format {
            ..6 => (bytes[15] & 0x1f, bytes[15] & 0x80 != 0),
            _ => (bytes[16], bytes[15] & 0x04 != 0),
        };
        Self {
            at_m: steps * header.scale + header.offset_m,
            classification,
            class: header.class_at.map(|at| bytes[at]),
            is_withheld,
        }
    }
}

/// Every point in turn.
pub(super) fn each(
    header: &LasHeader,
    bytes: &[u8],
    mut take: impl FnMut(&LasPoint),
) -> Result<(), LasError> {
    let body = &bytes[header.body..];
    let Some(laszip) = &header.laszip else {
        let there = usize::try_from(header.points).unwrap_or(usize::MAX);
        for point in body.chunks_exact(header.length).take(there) {
            take(&LasPoint::new(header, point));
        }
        return Ok(());
    };
    let packing = Packing::read(header, laszip)?;
    // The first eight bytes say where the table of chunks is, which is not needed.
    let body = body
        .get(8..)
        .ok_or_else(|| wrong("the points", format!("{} bytes", body.len()), "at least 8"))?;
    // No way is known to make the crate panic; should it, the file is refused as any other.
    let unpacked = catch_unwind(AssertUnwindSafe(|| packing.unpack(header, body, &mut take)));
    unpacked.unwrap_or_else(|_| {
        Err(LasError::Packed {
            point: 0,
            problem: "the decompressor gave up, expected sound data".into(),
        })
    })
}

/// How the points are packed.
struct Packing {
    items: Vec<LazItem>,
    /// Points of a chunk; `None` if each chunk gives its own count.
    chunk: Option<u64>,
    /// Number of four-byte sizes of a chunk's layers; 0 where points are packed one after the other.
    layers: usize,
}

impl Packing {
    /// From LASzip's own record. It must describe exactly the fields of the point format.
    fn read(header: &LasHeader, record: &[u8]) -> Result<Self, LasError> {
        let expected = format!(
            "fields of point format {} with {} bytes",
            header.format, header.length
        );
        let refused = |found: &str| wrong("the record of LASzip", found, expected.clone());
        let word = |at: usize| record.get(at..at + 2).map(|b| u16::from_le_bytes([b[0], b[1]]));
        let (Some(compressor), Some(count)) = (word(0), word(32)) else {
            return Err(refused("cut off"));
        };
        let least = crate::las::record_length(header.format).unwrap_or(header.length);
        let extra = (header.length - least) as u16;
        let (fields, layers) = fields(header.format, extra);
        let is_layered = header.format >= 6;
        let found: Option<Vec<[u16; 3]>> = (0..usize::from(count))
            .map(|i| Some([word(34 + 6 * i)?, word(36 + 6 * i)?, word(38 + 6 * i)?]))
            .collect();
        let found = found.ok_or_else(|| refused("cut off"))?;
        let versions = if is_layered { 3..=4 } else { 1..=2 };
        let is_same = found.iter().map(|[kind, size, _]| [*kind, *size]).eq(fields);
        if !is_same || found.iter().any(|[_, _, version]| !versions.contains(version)) {
            return Err(refused("of other fields"));
        }
        let (one, chunked) = if is_layered { (3, 3) } else { (1, 2) };
        if compressor != one && compressor != chunked {
            return Err(refused("of another compressor"));
        }
        let vlr = LazVlr::from_buffer(record).map_err(|_| refused("damaged"))?;
        let chunk = match (compressor, vlr.uses_variable_size_chunks()) {
            (1, _) => Some(u64::MAX),
            (2, true) => return Err(refused("of chunks of many sizes without layers")),
            (3, true) => None,
            _ => Some(u64::from(vlr.chunk_size()).max(1)),
        };
        Ok(Self {
            items: vlr.items().clone(),
            chunk,
            layers: if is_layered { layers } else { 0 },
        })
    }

    fn unpack(
        &self,
        header: &LasHeader,
        body: &[u8],
        take: &mut impl FnMut(&LasPoint),
    ) -> Result<(), LasError> {
        let mut point = vec![0; header.length];
        let packed = |point: u64, problem: String| LasError::Packed { point, problem };
        if self.layers == 0 {
            let mut unpacker = SequentialPointRecordDecompressor::new(Cursor::new(body));
            for at in 0..header.points {
                if self.chunk.is_some_and(|chunk| at % chunk == 0) {
                    unpacker.reset();
                    let ready = unpacker.set_fields_from(&self.items);
                    ready.map_err(|e| packed(at, e.to_string()))?;
                }
                unpacker
                    .decompress_next(&mut point)
                    .map_err(|e| packed(at, e.to_string()))?;
                take(&LasPoint::new(header, &point));
            }
            return Ok(());
        }
        let (mut rest, mut at) = (body, 0);
        while at < header.points {
            let (chunk, points) = self
                .chunk_of(header, rest)
                .ok_or_else(|| packed(at, "a chunk of layers longer than the bytes there".into()))?;
            let mut unpacker = LayeredPointRecordDecompressor::new(Cursor::new(chunk));
            let ready = unpacker.set_fields_from(&self.items);
            ready.map_err(|e| packed(at, e.to_string()))?;
            let needed = DecompressionSelection::base()
                .decompress_z()
                .decompress_classification()
                .decompress_flags()
                .decompress_extra_bytes();
            unpacker.set_selection(needed);
            for _ in 0..points.min(header.points - at) {
                unpacker
                    .decompress_next(&mut point)
                    .map_err(|e| packed(at, e.to_string()))?;
                take(&LasPoint::new(header, &point));
                at += 1;
            }
            rest = &rest[chunk.len()..];
        }
        Ok(())
    }

    /// The first chunk of layers in these bytes, and its number of points. It consists of a point as it is, the number
    /// of points, the sizes of the layers, and the layers. `None` if it is longer than the bytes.
    fn chunk_of<'a>(&self, header: &LasHeader, bytes: &'a [u8]) -> Option<(&'a [u8], u64)> {
        let word = |i: usize| {
            let at = header.length + 4 * i;
            let word = bytes.get(at..at + 4)?.first_chunk()?;
            Some(u32::from_le_bytes(*word))
        };
        let points = u64::from(word(0)?);
        let mut length = header.length + 4 * (1 + self.layers);
        for layer in 1..=self.layers {
            length = length.checked_add(word(layer)? as usize)?;
        }
        let is_full = self.chunk.is_none_or(|most| points <= most);
        (points > 0 && is_full).then_some((bytes.get(..length)?, points))
    }
}

/// Kinds and sizes of LASzip's fields of a point format, in their order, and how many layers they have in all.
fn fields(format: u8, extra: u16) -> (Vec<[u16; 2]>, usize) {
    let mut fields = match format {
        0 => vec![[6, 20]],
        1 => vec![[6, 20], [7, 8]],
        2 => vec![[6, 20], [8, 6]],
        3 => vec![[6, 20], [7, 8], [8, 6]],
        4 => vec![[6, 20], [7, 8], [9, 29]],
        5 => vec![[6, 20], [7, 8], [8, 6], [9, 29]],
        6 => vec![[10, 30]],
        7 => vec![[10, 30], [11, 6]],
        8 => vec![[10, 30], [12, 8]],
        9 => vec![[10, 30], [13, 29]],
        _ => vec![[10, 30], [12, 8], [13, 29]],
    };
    if extra > 0 {
        fields.push([if format >= 6 { 14 } else { 0 }, extra]);
    }
    let layers = fields.iter().map(|[kind, size]| match kind {
        10 => 9,
        11 | 13 => 1,
        12 => 2,
        14 => usize::from(*size),
        _ => 0,
    });
    let layers = layers.sum();
    (fields, layers)
}
