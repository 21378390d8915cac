//! Point clouds (PCL's PCD, ascii, binary and compressed): a cloud becomes the occupancy of a scene.
//!
//! The fields `x`, `y`, `z` are read, in metres, taken as the ego frame (x forward, y left, z up, ground near z = 0),
//! and a field `label`, `labels`, `class` or `semantic` with the classes' numbers (Occ3D, 0 to 16). See `cloud` for the
//! use of points with and without labels. Other fields, a viewpoint, points that are not finite or lie beside the map
//! are left out and counted.

use std::borrow::Cow;
use std::collections::BTreeMap;

use glam::DVec3;
use scene::message::quoted;

use super::cloud::{Cloud, LABELS, NothingOnTheMap, STRENGTHS};
use super::{Content, ImportFile, Importer};
use crate::{FormatError, Holds, lzf};

/// Longest header, bytes, and most fields in it.
const LONGEST_HEADER: usize = 16_384;
const MOST_FIELDS: usize = 64;
/// Most values of one field.
const MOST_VALUES: usize = 4096;
/// Largest file, and most bytes of points that a compressed one is unpacked to.
const LARGEST: u64 = 512 << 20;

/// See the module.
pub const IMPORTER: Importer = Importer {
    id: "pcd",
    title: "point clouds",
    extensions: &["pcd"],
    holds: &[Holds::Points],
    largest: LARGEST,
    recognises: |head| {
        let text = String::from_utf8_lossy(head);
        text.starts_with("# .PCD") || (text.contains("FIELDS ") && text.contains("SIZE "))
    },
    in_folder: None,
    read: |source| read(source).map_err(FormatError::new),
    #[cfg(test)]
    sample: tests::sample,
};

/// Why a file is no point cloud that is read. One line each.
#[derive(Debug, PartialEq, thiserror::Error)]
pub enum PcdError {
    /// A line of the header.
    #[error("header, {key}: {found}, expected {expected}")]
    Header {
        /// Keyword of the line.
        key: &'static str,
        /// The value that was found.
        found: String,
        /// The value that was expected.
        expected: String,
    },
    /// The file holds less than its header says.
    #[error("{found} points, expected {expected} as in the header")]
    Short {
        /// Points there.
        found: usize,
        /// Points promised.
        expected: usize,
    },
    /// A value that is no number.
    #[error("point {point}: field {field} is {found:?}, expected a number")]
    Number {
        /// Which point, from 0.
        point: usize,
        /// Which field.
        field: String,
        /// The text in its place.
        found: String,
    },
    /// Compressed points that cannot be unpacked.
    #[error("binary_compressed: {found}, expected {expected}")]
    Packed {
        /// The sizes that were found.
        found: String,
        /// The sizes that were expected.
        expected: String,
    },
    /// No point would be left.
    #[error(transparent)]
    Nothing(#[from] NothingOnTheMap),
}

fn wrong(key: &'static str, found: impl Into<String>, expected: impl Into<String>) -> PcdError {
    PcdError::Header {
        key,
        found: found.into(),
        expected: expected.into(),
    }
}

fn read(source: &ImportFile<'_>) -> Result<Content, PcdError> {
    let header = PcdHeader::read(source.bytes)?;
    let body = &source.bytes[header.body..];
    let axis = |name| {
        header
            .field(&[name])
            .ok_or_else(|| wrong("FIELDS", "no such field", name))
    };
    let mut wanted = vec![axis("x")?, axis("y")?, axis("z")?];
    let first = |names: &[&str]| names.iter().find_map(|name| header.field(&[name]));
    let beside = [first(&LABELS), first(&STRENGTHS)];
    let kept = wanted.iter().copied().chain(beside[0]).collect::<Vec<_>>();
    let beside = beside.map(|field| {
        wanted.extend(field);
        field.map(|_| wanted.len() - 1)
    });
    let mut cloud = Cloud::from_source(source);
    header.each_point(body, &wanted, |v| {
        let [label, strength] = beside.map(|at| at.map(|at| v[at]));
        cloud.add(DVec3::new(v[0], v[1], v[2]), label, strength)
    })?;
    let mut left_out = BTreeMap::new();
    for (at, field) in header.fields.iter().enumerate() {
        if !kept.contains(&at) {
            left_out.insert(format!("field {}", quoted(&field.name, 40)), 1);
        }
    }
    if header.has_viewpoint {
        left_out.insert("viewpoint".into(), 1);
    }
    let loaded = cloud.scene(source.name, left_out)?;
    Ok(Content::Scene(Box::new(loaded)))
}

/// One field of a point.
struct PcdField {
    name: String,
    /// `F`, `I` or `U`, and bytes of one value.
    kind: (u8, usize),
    /// Values of the field; the first one is read.
    count: usize,
    /// Bytes before it in a binary point, and values before it in a line.
    bytes_before: usize,
    values_before: usize,
}

impl PcdField {
    /// Its first value, `at` being where the field begins.
    fn value(&self, at: &[u8]) -> f64 {
        macro_rules! number {
            ($type:ty) => {
                at.first_chunk()
                    .map_or(f64::NAN, |b| <$type>::from_le_bytes(*b) as f64)
            };
        }
        match self.kind {
            (b'F', 4) => number!(f32),
            (b'F', _) => number!(f64),
            (b'I', 1) => number!(i8),
            (b'I', 2) => number!(i16),
            (b'I', 4) => number!(i32),
            (b'I', _) => number!(i64),
            (_, 1) => number!(u8),
            (_, 2) => number!(u16),
            (_, 4) => number!(u32),
            _ => number!(u64),
        }
    }
}

/// How the points are written.
#[derive(Clone, Copy, PartialEq)]
enum Data {
    Ascii,
    Binary,
    /// One field after the other, packed by LZF.
    Compressed,
}

struct PcdHeader {
    fields: Vec<PcdField>,
    points: usize,
    data: Data,
    has_viewpoint: bool,
    /// Where the points begin.
    body: usize,
}

impl PcdHeader {
    fn read(bytes: &[u8]) -> Result<Self, PcdError> {
        let mut lines: BTreeMap<String, Vec<String>> = BTreeMap::new();
        let mut at = 0;
        while !lines.contains_key("DATA") {
            let rest = &bytes[at..bytes.len().min(LONGEST_HEADER)];
            let Some(length) = rest.iter().position(|b| *b == b'\n') else {
                return Err(wrong(
                    "DATA",
                    "no such line",
                    "ascii, binary or binary_compressed",
                ));
            };
            let line = String::from_utf8_lossy(&rest[..length]);
            let mut words = line.split_whitespace().map(str::to_owned);
            if let Some(key) = words.next().filter(|w| !w.starts_with('#')) {
                lines.insert(key.to_uppercase(), words.collect());
            }
            at += length + 1;
        }
        let line = |key: &'static str| lines.get(key).map(Vec::as_slice);
        let data = match line("DATA").and_then(<[String]>::first).map(String::as_str) {
            Some("ascii") => Data::Ascii,
            Some("binary") => Data::Binary,
            Some("binary_compressed") => Data::Compressed,
            other => {
                let found = quoted(other.unwrap_or("nothing"), 40);
                return Err(wrong("DATA", found, "ascii, binary or binary_compressed"));
            }
        };
        let fields = fields(&lines)?;
        let size = |key| line(key).map(|l| whole(key, l.first(), usize::MAX)).transpose();
        let points = match size("POINTS")? {
            Some(points) => points,
            None => size("WIDTH")?
                .zip(size("HEIGHT")?)
                .and_then(|(w, h)| w.checked_mul(h))
                .ok_or_else(|| wrong("POINTS", "no such line", "the number of points"))?,
        };
        let origin = ["0", "0", "0", "1", "0", "0", "0"];
        Ok(Self {
            fields,
            points,
            data,
            has_viewpoint: line("VIEWPOINT").is_some_and(|v| {
                let number = |s: &str| s.parse::<f64>().ok();
                !v.iter().map(|s| number(s)).eq(origin.iter().map(|s| number(s)))
            }),
            body: at,
        })
    }

    fn field(&self, names: &[&str]) -> Option<usize> {
        let of = |f: &PcdField| names.contains(&f.name.to_lowercase().as_str());
        self.fields.iter().position(of)
    }

    /// The first values of these fields, of each point in turn.
    fn each_point(
        &self,
        body: &[u8],
        wanted: &[usize],
        mut take: impl FnMut(&[f64]),
    ) -> Result<(), PcdError> {
        let short = |found| PcdError::Short {
            found,
            expected: self.points,
        };
        let wanted: Vec<&PcdField> = wanted.iter().filter_map(|at| self.fields.get(*at)).collect();
        let mut values = vec![0.0; wanted.len()];
        if self.data != Data::Ascii {
            let stride: usize = self.fields.iter().map(|f| f.kind.1 * f.count).sum();
            let (body, by_field) = match self.data {
                Data::Compressed => (Cow::Owned(self.unpacked(body, stride)?), true),
                _ => (Cow::Borrowed(body), false),
            };
            let found = body.len() / stride.max(1);
            if found < self.points {
                return Err(short(found));
            }
            for point in 0..self.points {
                for (value, field) in values.iter_mut().zip(&wanted) {
                    let at = match by_field {
                        true => self.points * field.bytes_before + point * field.kind.1 * field.count,
                        false => point * stride + field.bytes_before,
                    };
                    *value = field.value(&body[at..]);
                }
                take(&values);
            }
            return Ok(());
        }
        let text = String::from_utf8_lossy(body);
        let mut lines = text.lines().filter(|l| !l.trim().is_empty());
        for point in 0..self.points {
            let line = lines.next().ok_or_else(|| short(point))?;
            let words: Vec<&str> = line.split_whitespace().collect();
            for (value, field) in values.iter_mut().zip(&wanted) {
                let word = words.get(field.values_before).copied().unwrap_or_default();
                *value = match word.parse() {
                    Ok(value) => value,
                    // A guess gets along without it.
                    Err(_) if STRENGTHS.contains(&field.name.to_lowercase().as_str()) => f64::NAN,
                    Err(_) => {
                        return Err(PcdError::Number {
                            point,
                            field: quoted(&field.name, 40),
                            found: quoted(word, 40),
                        });
                    }
                };
            }
            take(&values);
        }
        Ok(())
    }

    /// Unpacks `DATA binary_compressed`: two sizes, then the fields packed together.
    fn unpacked(&self, body: &[u8], stride: usize) -> Result<Vec<u8>, PcdError> {
        let packed = |found: String, expected: String| PcdError::Packed { found, expected };
        let size = |at: usize| {
            body.get(at..at + 4)?
                .first_chunk()
                .map(|b| u32::from_le_bytes(*b))
        };
        let (Some(small), Some(large)) = (size(0), size(4)) else {
            return Err(packed(
                format!("{} bytes", body.len()),
                "two sizes of 4 bytes each".into(),
            ));
        };
        let (small, large) = (small as usize, large as usize);
        let most = small.saturating_mul(lzf::MOST_PER_BYTE).min(LARGEST as usize);
        if small > body.len() - 8 || large > most {
            return Err(packed(
                format!("{} bytes for {small} that unpack to {large}", body.len() - 8),
                format!("as many, and at most {most}"),
            ));
        }
        if self.points.checked_mul(stride) != Some(large) {
            return Err(packed(
                format!("{large} bytes unpacked"),
                format!("{} points of {stride} bytes", self.points),
            ));
        }
        let unpacked = lzf::decompress(&body[8..8 + small], large);
        unpacked.ok_or_else(|| packed("damaged data".into(), format!("{large} bytes packed by LZF")))
    }
}

fn whole(key: &'static str, word: Option<&String>, most: usize) -> Result<usize, PcdError> {
    let found = word.map_or("nothing", String::as_str);
    let value = found.parse().ok().filter(|n| *n <= most);
    value.ok_or_else(|| wrong(key, quoted(found, 40), format!("a whole number up to {most}")))
}

/// From the lines FIELDS, SIZE, TYPE and COUNT.
fn fields(lines: &BTreeMap<String, Vec<String>>) -> Result<Vec<PcdField>, PcdError> {
    let of = |key: &'static str| {
        lines
            .get(key)
            .ok_or_else(|| wrong(key, "no such line", "one word per field"))
    };
    let (names, sizes, kinds) = (of("FIELDS")?, of("SIZE")?, of("TYPE")?);
    let counts = lines.get("COUNT");
    if names.is_empty() || names.len() > MOST_FIELDS {
        return Err(wrong(
            "FIELDS",
            format!("{} words", names.len()),
            format!("1 to {MOST_FIELDS}"),
        ));
    }
    let (mut fields, mut bytes_before, mut values_before) = (Vec::new(), 0, 0);
    for (i, name) in names.iter().enumerate() {
        let size = whole("SIZE", sizes.get(i), 8)?;
        let letter = kinds.get(i).map_or("nothing", String::as_str);
        let kind = match (letter, size) {
            ("F", 4 | 8) | ("I" | "U", 1 | 2 | 4 | 8) => letter.as_bytes()[0],
            _ => {
                let found = format!("{} of {size} bytes", quoted(letter, 40));
                return Err(wrong("TYPE", found, "F of 4 or 8, I or U of 1, 2, 4 or 8 bytes"));
            }
        };
        let count = match counts {
            Some(counts) => whole("COUNT", counts.get(i), MOST_VALUES)?.max(1),
            None => 1,
        };
        fields.push(PcdField {
            name: name.clone(),
            kind: (kind, size),
            count,
            bytes_before,
            values_before,
        });
        bytes_before += size * count;
        values_before += count;
    }
    Ok(fields)
}

#[cfg(test)]
#[path = "pcd_tests.rs"]
mod tests;
