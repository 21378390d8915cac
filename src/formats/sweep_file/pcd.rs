//! Headers and values of PCL's PCD: ascii, binary and compressed.

use std::borrow::Cow;
use std::collections::BTreeMap;

use scene::message::quoted;

use super::STRENGTHS;
use super::scalar::Scalar;
use crate::lzf;

/// Longest header, bytes, and most fields in it.
const LONGEST_HEADER: usize = 16_384;
const MOST_FIELDS: usize = 64;
/// Most values of one field.
const MOST_VALUES: usize = 4096;
/// Largest file, and most bytes of points that a compressed one is unpacked to.
pub(crate) const LARGEST_PCD: u64 = 512 << 20;

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
    /// More points than a sweep has.
    #[error("{found} points, expected at most {most}")]
    TooMany {
        /// Points in the header.
        found: usize,
        /// Most of a sweep.
        most: usize,
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
}

impl PcdError {
    /// A field that must be there is not.
    pub(crate) fn missing(name: &str) -> Self {
        wrong("FIELDS", "no such field", name)
    }
}

fn wrong(key: &'static str, found: impl Into<String>, expected: impl Into<String>) -> PcdError {
    PcdError::Header {
        key,
        found: found.into(),
        expected: expected.into(),
    }
}

/// One field of a point.
pub(crate) struct PcdField {
    pub(crate) name: String,
    pub(super) number: Scalar,
    /// Values of the field; the first one is read.
    pub(super) count: usize,
    /// Bytes before it in a binary point, and values before it in a line.
    pub(super) bytes_before: usize,
    pub(super) values_before: usize,
}

impl PcdField {
    /// Bytes of all its values in a point.
    pub(super) fn bytes(&self) -> usize {
        self.number.size() * self.count
    }
}

/// How the points are written.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum PcdData {
    Ascii,
    Binary,
    /// One field after the other, packed by LZF.
    Compressed,
}

pub(crate) struct PcdHeader {
    pub(crate) fields: Vec<PcdField>,
    pub(super) points: usize,
    /// Rows of an organized cloud, else 1.
    pub(super) rows: usize,
    pub(super) data: PcdData,
    /// True unless the viewpoint is the origin.
    pub(crate) has_viewpoint: bool,
    /// Where the points begin.
    pub(crate) body: usize,
}

impl PcdHeader {
    pub(crate) fn read(bytes: &[u8]) -> Result<Self, PcdError> {
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
            Some("ascii") => PcdData::Ascii,
            Some("binary") => PcdData::Binary,
            Some("binary_compressed") => PcdData::Compressed,
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
            rows: size("HEIGHT").ok().flatten().unwrap_or(1),
            data,
            has_viewpoint: line("VIEWPOINT").is_some_and(|v| {
                let number = |s: &str| s.parse::<f64>().ok();
                !v.iter().map(|s| number(s)).eq(origin.iter().map(|s| number(s)))
            }),
            body: at,
        })
    }

    /// The first field of one of these names, in small letters.
    pub(crate) fn field(&self, names: &[&str]) -> Option<usize> {
        let of = |f: &PcdField| names.contains(&f.name.to_lowercase().as_str());
        self.fields.iter().position(of)
    }

    /// The first values of these fields, of each point in turn.
    pub(crate) fn each_point(
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
        if self.data != PcdData::Ascii {
            let stride: usize = self.fields.iter().map(PcdField::bytes).sum();
            let (body, by_field) = match self.data {
                PcdData::Compressed => (Cow::Owned(self.unpacked(body, stride)?), true),
                _ => (Cow::Borrowed(body), false),
            };
            let found = body.len() / stride.max(1);
            if found < self.points {
                return Err(short(found));
            }
            for point in 0..self.points {
                for (value, field) in values.iter_mut().zip(&wanted) {
                    let at = match by_field {
                        true => self.points * field.bytes_before + point * field.bytes(),
                        false => point * stride + field.bytes_before,
                    };
                    *value = field.number.value(&body[at..], false);
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
    pub(super) fn unpacked(&self, body: &[u8], stride: usize) -> Result<Vec<u8>, PcdError> {
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
        let most = small.saturating_mul(lzf::MOST_PER_BYTE).min(LARGEST_PCD as usize);
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
        let number = Scalar::of_kind(letter, size).ok_or_else(|| {
            let found = format!("{} of {size} bytes", quoted(letter, 40));
            wrong("TYPE", found, "F of 4 or 8, I or U of 1, 2, 4 or 8 bytes")
        })?;
        let count = match counts {
            Some(counts) => whole("COUNT", counts.get(i), MOST_VALUES)?.max(1),
            None => 1,
        };
        fields.push(PcdField {
            name: name.clone(),
            number,
            count,
            bytes_before,
            values_before,
        });
        bytes_before += size * count;
        values_before += count;
    }
    Ok(fields)
}
