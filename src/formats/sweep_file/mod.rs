//! Files of one sweep, record by record: its returns, and the same file with some of them changed. Records that are not changed
//! keep their bytes.
//!
//! Read are scans of KITTI and nuScenes, PCD and PLY. Fields are found by their names; all others are copied.

mod pcd;
mod ply;
mod records;
mod scalar;
#[cfg(test)]
mod tests;
mod write;

use std::borrow::Cow;

use glam::DVec3;
use scene::message::quoted;
use scene::{Pose, RecordedReturn};

use crate::{FormatError, lzf};
use pcd::PcdData;
pub(crate) use pcd::{LARGEST_PCD, PcdError, PcdHeader};
use ply::Encoding;
pub(crate) use ply::{PlyBody, PlyError, PlyHeader, Property};
use records::{RecordField, RecordOrder, Records, lines};
use scalar::Scalar;

/// Ids of formats, as importers have them.
pub(crate) const KITTI: &str = "kitti";
pub(crate) const NUSCENES: &str = "nuscenes-lidar";
pub(crate) const PCD: &str = "pcd";
pub(crate) const PLY: &str = "ply";

/// Fields of points whose numbers are classes of Occ3D, in small letters.
pub(crate) const LABELS: [&str; 6] = [
    "label",
    "labels",
    "class",
    "semantic",
    "scalar_label",
    "scalar_class",
];

/// Fields of points whose numbers are strengths of echoes, in small letters, the best first.
pub(crate) const STRENGTHS: [&str; 4] = ["reflectivity", "intensity", "scalar_intensity", "remission"];

/// Fields whose numbers are rings, in small letters.
const RINGS: [&str; 5] = ["ring", "channel", "laser_number", "laser_id", "scalar_ring"];

/// Fields whose numbers are distances from the sensor, in small letters.
const RANGES: [&str; 3] = ["range", "distance", "depth"];

/// Records of a file at most.
const MOST_RECORDS: usize = 2_000_000;
/// Farthest place of a return along an axis, m.
const FARTHEST_M: f32 = 1e6;
/// Nearest return to the sensor, m: nearer places, and those that are not finite, are slots without one.
const NEAREST_M: f64 = 0.1;

/// A file of one sweep.
pub struct SweepFile<'a> {
    bytes: &'a [u8],
    kind: SweepFileKind,
    records: Records<'a>,
    axes: [usize; 3],
    strength: Option<usize>,
    ring: Option<usize>,
    label: Option<usize>,
    /// Fields of the distance from the sensor.
    ranges: Vec<usize>,
}

/// Count of records, as a file tells it.
#[derive(Clone, Copy, PartialEq)]
enum SweepFileKind {
    /// By the length of the file.
    Scan,
    /// By lines of a header; slots of an organized cloud stay.
    Pcd {
        is_packed: bool,
        /// Records of a row of an organized cloud.
        row: Option<usize>,
    },
    Ply,
}

impl<'a> SweepFile<'a> {
    /// The records of a file in the format of this id. Errors in one line if it is none of the formats above, damaged, or has
    /// more than two million records.
    pub fn open(format: &str, bytes: &'a [u8]) -> Result<Self, FormatError> {
        let (kind, records) = match format {
            NUSCENES => scan(bytes, &["x", "y", "z", "intensity", "ring"])?,
            KITTI => scan(bytes, &["x", "y", "z", "intensity"])?,
            PLY => ply(bytes)?,
            PCD => pcd(bytes).map_err(FormatError::new)?,
            other => {
                let other = quoted(other, 40);
                return Err(FormatError::new(format!("{other}, expected a format of sweeps")));
            }
        };
        let axis = |name: &str| {
            let at = records.field(&[name]);
            at.ok_or_else(|| FormatError::new(format!("no field {name} in the records")))
        };
        Ok(Self {
            bytes,
            kind,
            axes: [axis("x")?, axis("y")?, axis("z")?],
            strength: records.field(&STRENGTHS),
            ring: records.field(&RINGS),
            label: records.field(&LABELS),
            ranges: RANGES.iter().filter_map(|name| records.field(&[name])).collect(),
            records,
        })
    }

    /// Returns of all records in their order; `None` where nothing came back.
    pub fn returns(&self, world_from_file: &Pose) -> Vec<Option<RecordedReturn>> {
        let each = (0..self.records.count).map(|i| {
            let at = self.place(i);
            let at_m = world_from_file.apply(at).as_vec3().to_array();
            let is_place = at_m.iter().all(|m| m.abs() <= FARTHEST_M);
            (is_place && at.length_squared() >= NEAREST_M * NEAREST_M).then(|| RecordedReturn {
                at_m,
                strength: self
                    .strength
                    .map_or(f32::NAN, |f| self.records.value(i, f) as f32),
                ring: self.ring(i),
            })
        });
        each.collect()
    }

    fn place(&self, record: usize) -> DVec3 {
        DVec3::from_array(self.axes.map(|axis| self.records.value(record, axis)))
    }

    fn ring(&self, record: usize) -> u16 {
        let row = match self.kind {
            SweepFileKind::Pcd { row: Some(row), .. } if self.ring.is_none() => record / row.max(1),
            _ => usize::from(RecordedReturn::NO_RING),
        };
        let number = self.ring.map_or(row as f64, |f| self.records.value(record, f));
        match (0.0..f64::from(RecordedReturn::NO_RING)).contains(&number) {
            true => number as u16,
            false => RecordedReturn::NO_RING,
        }
    }
}

/// The format of a file by its name, for files of several formats in one folder.
pub(crate) fn format_of(name: &str) -> &'static str {
    let name = name.to_lowercase();
    match name {
        _ if name.ends_with(".pcd.bin") => NUSCENES,
        _ if name.ends_with(".bin") => KITTI,
        _ if name.ends_with(".ply") => PLY,
        _ => PCD,
    }
}

fn too_many(count: usize) -> FormatError {
    FormatError::new(format!("{count} records, expected at most {MOST_RECORDS}"))
}

fn scan<'a>(bytes: &'a [u8], names: &[&str]) -> Result<(SweepFileKind, Records<'a>), FormatError> {
    let stride = 4 * names.len();
    if bytes.is_empty() || !bytes.len().is_multiple_of(stride) {
        let line = format!("{} bytes, expected records of {stride}", bytes.len());
        return Err(FormatError::new(line));
    }
    if bytes.len() / stride > MOST_RECORDS {
        return Err(too_many(bytes.len() / stride));
    }
    let field = |(i, name): (usize, &&str)| RecordField {
        name: (*name).to_owned(),
        number: Scalar::F32,
        at: 4 * i,
        bytes: 4,
    };
    let records = Records {
        before: &[],
        after: &[],
        body: Cow::Borrowed(bytes),
        order: RecordOrder::Rows(stride),
        is_big: false,
        fields: names.iter().enumerate().map(field).collect(),
        count: bytes.len() / stride,
    };
    Ok((SweepFileKind::Scan, records))
}

fn pcd(bytes: &[u8]) -> Result<(SweepFileKind, Records<'_>), PcdError> {
    let header = PcdHeader::read(bytes)?;
    if header.points > MOST_RECORDS {
        return Err(PcdError::TooMany {
            found: header.points,
            most: MOST_RECORDS,
        });
    }
    let (before, body) = bytes.split_at(header.body);
    let stride: usize = header.fields.iter().map(pcd::PcdField::bytes).sum();
    let is_text = header.data == PcdData::Ascii;
    let length = header.points.saturating_mul(stride);
    let (body, order, after) = match header.data {
        PcdData::Ascii => {
            let lines = lines(body, header.points);
            (Cow::Borrowed(body), RecordOrder::Lines(lines), &body[..0])
        }
        PcdData::Binary => {
            let (body, after) = body.split_at(length.min(body.len()));
            (Cow::Borrowed(body), RecordOrder::Rows(stride), after)
        }
        PcdData::Compressed => {
            let unpacked = header.unpacked(body, stride)?;
            (Cow::Owned(unpacked), RecordOrder::Fields, &body[..0])
        }
    };
    let found = match &order {
        RecordOrder::Lines(lines) => lines.len(),
        _ => body.len() / stride.max(1),
    };
    if found < header.points {
        return Err(PcdError::Short {
            found,
            expected: header.points,
        });
    }
    let field = |f: &pcd::PcdField| RecordField {
        name: f.name.clone(),
        number: f.number,
        at: if is_text { f.values_before } else { f.bytes_before },
        bytes: f.bytes(),
    };
    let records = Records {
        before,
        after,
        body,
        order,
        is_big: false,
        fields: header.fields.iter().map(field).collect(),
        count: header.points,
    };
    let kind = SweepFileKind::Pcd {
        is_packed: header.data == PcdData::Compressed,
        row: (header.rows > 1).then(|| header.points / header.rows),
    };
    Ok((kind, records))
}

fn ply(bytes: &[u8]) -> Result<(SweepFileKind, Records<'_>), FormatError> {
    let header = PlyHeader::read(bytes).map_err(FormatError::new)?;
    let vertex = header.elements.first().filter(|e| e.name == "vertex");
    let vertex = vertex.ok_or_else(|| FormatError::new("the first element is not vertex"))?;
    let stride = vertex
        .size()
        .filter(|_| header.elements[1..].iter().all(|e| e.count == 0));
    let stride = stride.ok_or_else(|| FormatError::new("lists, or elements behind the points"))?;
    let is_text = header.encoding == Encoding::Ascii;
    let (before, body) = bytes.split_at(header.body);
    if vertex.count > MOST_RECORDS {
        return Err(too_many(vertex.count));
    }
    let short = || FormatError::new(format!("fewer than {} points", vertex.count));
    let (order, body, after) = match is_text {
        true => {
            let lines = lines(body, vertex.count);
            if lines.len() < vertex.count {
                return Err(short());
            }
            (RecordOrder::Lines(lines), body, &body[..0])
        }
        false => {
            let length = vertex.count.checked_mul(stride).ok_or_else(short)?;
            let (body, after) = body.split_at_checked(length).ok_or_else(short)?;
            (RecordOrder::Rows(stride), body, after)
        }
    };
    let (mut fields, mut at) = (Vec::new(), 0);
    for (i, p) in vertex.properties.iter().enumerate() {
        fields.push(RecordField {
            name: p.name.clone(),
            number: p.number,
            at: if is_text { i } else { at },
            bytes: p.number.size(),
        });
        at += p.number.size();
    }
    let records = Records {
        before,
        after,
        body: Cow::Borrowed(body),
        order,
        is_big: header.encoding == Encoding::Big,
        fields,
        count: vertex.count,
    };
    Ok((SweepFileKind::Ply, records))
}

/// Points of a compressed PCD: two sizes, then the bytes packed.
fn packed(unpacked: &[u8]) -> Vec<u8> {
    let small = lzf::stored(unpacked);
    let sizes = [small.len(), unpacked.len()].map(|n| (n as u32).to_le_bytes());
    [sizes.concat(), small].concat()
}
