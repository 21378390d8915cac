//! The header of a LAS file and the records after it, checked against the bytes that are there.

use glam::DVec3;
use scene::message::quoted;

use super::{LasError, wrong};
use crate::las::{CLASS_FIELD, SOFTWARE, record_length};

/// Bytes of the header of LAS 1.0 to 1.2, and of 1.4.
const SHORT: usize = 227;
const LONG: usize = 375;
/// Bytes before the data of a variable length record.
const RECORD: usize = 54;
/// Bytes of one description of an extra byte.
const DESCRIPTION: usize = 192;
/// Points that a byte of LAZ can stand for at most before a file is taken for a bomb.
const MOST_PER_BYTE: u64 = 32;
/// Most points that are read.
const MOST_POINTS: u64 = 200_000_000;

/// The fields of a header that are used.
pub(super) struct LasHeader {
    /// Point format, 0 to 10.
    pub(super) format: u8,
    /// Bytes of one point.
    pub(super) length: usize,
    /// Points in the file; uncompressed ones are all there.
    pub(super) points: u64,
    /// Where the points begin.
    pub(super) body: usize,
    pub(super) scale: DVec3,
    pub(super) offset_m: DVec3,
    /// Place of the byte with the class in Occ3D in a point.
    pub(super) class_at: Option<usize>,
    /// Content of the LASzip record; `None` if the points are not compressed.
    pub(super) laszip: Option<Vec<u8>>,
    /// Written by this program: points are in the ego frame.
    pub(super) is_own: bool,
}

impl LasHeader {
    pub(super) fn read(bytes: &[u8]) -> Result<Self, LasError> {
        if !bytes.starts_with(b"LASF") {
            let found = quoted(&String::from_utf8_lossy(&bytes[..bytes.len().min(4)]), 8);
            return Err(wrong("the signature", format!("{found:?}"), "LASF"));
        }
        if bytes.len() < SHORT {
            return Err(wrong(
                "the header",
                format!("{} bytes", bytes.len()),
                "at least 227",
            ));
        }
        let (major, minor) = (bytes[24], bytes[25]);
        if major != 1 || minor > 4 {
            return Err(wrong("the version", format!("{major}.{minor}"), "1.0 to 1.4"));
        }
        let is_long = minor == 4;
        let header_length = usize::from(u16_at(bytes, 94));
        let least = if is_long { LONG } else { SHORT };
        if header_length < least || header_length > bytes.len() {
            let expected = format!("{least} to {} (the file)", bytes.len());
            return Err(wrong("the size of the header", header_length, expected));
        }
        let body = u32_at(bytes, 96) as usize;
        if body < header_length || body > bytes.len() {
            let expected = format!("{header_length} (the header) to {} (the file)", bytes.len());
            return Err(wrong("the start of the points", body, expected));
        }
        // The two upper bits say that points are compressed.
        let (format, is_packed) = (bytes[104] & 0x3f, bytes[104] & 0xc0 != 0);
        let length = usize::from(u16_at(bytes, 105));
        let least = record_length(format).ok_or_else(|| wrong("the point format", format, "0 to 10"))?;
        if length < least {
            return Err(wrong(
                "the length of a point",
                length,
                format!("at least {least} for format {format}"),
            ));
        }
        let points = match (u32_at(bytes, 107), is_long) {
            (0, true) => u64_at(bytes, 247),
            (n, _) => u64::from(n),
        };
        let (scale, offset_m) = (vector_at(bytes, 131), vector_at(bytes, 155));
        if !scale.is_finite() || !offset_m.is_finite() || scale.to_array().contains(&0.0) {
            return Err(wrong(
                "scale and offset",
                format!("{scale} and {offset_m}"),
                "finite numbers, the scale not 0",
            ));
        }
        let mut header = Self {
            format,
            length,
            points,
            body,
            scale,
            offset_m,
            class_at: None,
            laszip: None,
            is_own: bytes[58..90].starts_with(SOFTWARE.as_bytes()),
        };
        header.read_records(bytes, header_length, u32_at(bytes, 100))?;
        if is_packed && header.laszip.is_none() {
            return Err(wrong(
                "the record of LASzip",
                "not there",
                "one, as the points are compressed",
            ));
        }
        if !is_packed {
            header.laszip = None;
        }
        header.check_points(bytes)?;
        Ok(header)
    }

    /// The variable length records between header and points.
    fn read_records(&mut self, bytes: &[u8], mut at: usize, count: u32) -> Result<(), LasError> {
        if count as usize > (self.body - at) / RECORD {
            let expected = format!(
                "at most {} in the bytes before the points",
                (self.body - at) / RECORD
            );
            return Err(wrong("the number of records", count, expected));
        }
        for _ in 0..count {
            let record = &bytes[at..self.body];
            let data = record.get(RECORD..).and_then(|data| {
                let size = usize::from(u16_at(record, 20));
                data.get(..size)
            });
            let data =
                data.ok_or_else(|| wrong("a record", "longer than the bytes before the points", "shorter"))?;
            match (text(&record[2..18]), u16_at(record, 18)) {
                ("laszip encoded", 22204) => self.laszip = Some(data.to_vec()),
                ("LASF_Spec", 4) => self.class_at = self.place_of_class(data),
                _ => {}
            }
            at += RECORD + data.len();
        }
        Ok(())
    }

    /// Where the extra byte with the class is: after the fields of the format come the extra bytes in the order of their
    /// descriptions.
    fn place_of_class(&self, descriptions: &[u8]) -> Option<usize> {
        // Sizes of the types 1 to 10; type 0 gives its size in the options.
        const SIZES: [usize; 10] = [1, 1, 2, 2, 4, 4, 8, 8, 4, 8];
        let mut at = record_length(self.format)?;
        for one in descriptions.chunks_exact(DESCRIPTION) {
            let kind = usize::from(one[2]);
            if text(&one[4..36]) == CLASS_FIELD && kind == 1 {
                return (at < self.length).then_some(at);
            }
            at += match kind {
                0 => usize::from(one[3]),
                1..=30 => SIZES[(kind - 1) % 10] * ((kind - 1) / 10 + 1),
                _ => return None,
            };
        }
        None
    }

    fn check_points(&self, bytes: &[u8]) -> Result<(), LasError> {
        let there = (bytes.len() - self.body) as u64;
        let most = match self.laszip {
            None => there / self.length as u64,
            Some(_) => (there.saturating_mul(MOST_PER_BYTE)).min(MOST_POINTS),
        };
        if self.points <= most {
            return Ok(());
        }
        Err(match self.laszip {
            None => LasError::Short {
                found: most,
                expected: self.points,
            },
            Some(_) => wrong(
                "the number of points",
                self.points,
                format!("at most {most} in {there} bytes"),
            ),
        })
    }
}

/// Text up to the first zero.
fn text(bytes: &[u8]) -> &str {
    let end = bytes.iter().position(|b| *b == 0).unwrap_or(bytes.len());
    std::str::from_utf8(&bytes[..end]).unwrap_or_default()
}

// The header has been measured before these are called.
fn u16_at(bytes: &[u8], at: usize) -> u16 {
    bytes[at..].first_chunk().map_or(0, |b| u16::from_le_bytes(*b))
}

fn u32_at(bytes: &[u8], at: usize) -> u32 {
    bytes[at..].first_chunk().map_or(0, |b| u32::from_le_bytes(*b))
}

fn u64_at(bytes: &[u8], at: usize) -> u64 {
    bytes[at..].first_chunk().map_or(0, |b| u64::from_le_bytes(*b))
}

fn vector_at(bytes: &[u8], at: usize) -> DVec3 {
    DVec3::from_array([0, 8, 16].map(|i| f64::from_bits(u64_at(bytes, at + i))))
}
