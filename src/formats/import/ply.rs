//! Point clouds as PLY (ascii, binary little and big endian): a cloud becomes the occupancy of a scene.
//!
//! The properties `x`, `y`, `z` of the element `vertex` are read, in metres, taken as the ego frame (x forward, y left,
//! z up, ground near z = 0), and a property of `LABELS` with the classes' numbers (Occ3D, 0 to 16). See `cloud` for the
//! use of points with and without labels. Other properties and elements are left out and counted, lists too. A file of
//! 3D Gaussians (`f_dc_0`, `scale_0`) is read as the points in their middles.

use std::collections::BTreeMap;

use glam::DVec3;
use scene::message::quoted;

use super::cloud::{Cloud, LABELS, NothingOnTheMap, STRENGTHS};
use super::{Content, ImportFile, Importer};
use crate::{FormatError, Holds};

/// Longest header, bytes; most elements, and most properties of one.
const LONGEST_HEADER: usize = 65_536;
const MOST_ELEMENTS: usize = 64;
const MOST_PROPERTIES: usize = 256;

/// See the module.
pub const IMPORTER: Importer = Importer {
    id: "ply",
    title: "point clouds, Gaussians as points",
    extensions: &["ply"],
    holds: &[Holds::Points],
    largest: 512 << 20,
    recognises: |head| head.starts_with(b"ply\n") || head.starts_with(b"ply\r\n"),
    in_folder: None,
    read: |source| read(source).map_err(FormatError::new),
    #[cfg(test)]
    sample: tests::sample,
};

/// Why a file is no PLY that is read. One line each.
#[derive(Debug, PartialEq, thiserror::Error)]
pub enum PlyError {
    /// A line of the header.
    #[error("header, line {line}: {found}, expected {expected}")]
    Header {
        /// Which line, from 1.
        line: usize,
        /// Text of the line.
        found: String,
        /// The text that was expected.
        expected: &'static str,
    },
    /// The header has no such property of points.
    #[error("no property {0} of the element vertex")]
    Missing(&'static str),
    /// The file holds less than its header says.
    #[error("{element} {at} of {expected} is not there: the file ends before")]
    Short {
        /// Name of the element.
        element: String,
        /// Which of them, from 0.
        at: usize,
        /// How many the header promises.
        expected: usize,
    },
    /// A value that is no number.
    #[error("{element} {at}: property {property} is {found}, expected a number")]
    Number {
        /// Name of the element.
        element: String,
        /// Which of them, from 0.
        at: usize,
        /// Which property.
        property: String,
        /// The value that was found.
        found: String,
    },
    /// No point would be left.
    #[error(transparent)]
    Nothing(#[from] NothingOnTheMap),
}

fn read(source: &ImportFile<'_>) -> Result<Content, PlyError> {
    let header = PlyHeader::read(source.bytes)?;
    let vertex = header.elements.iter().position(|e| e.name == "vertex");
    let at = vertex.ok_or(PlyError::Missing("x"))?;
    let points = &header.elements[at];
    let property = |is: &dyn Fn(&str) -> bool| {
        let of = |p: &Property| p.length.is_none() && is(&p.name);
        points.properties.iter().position(of)
    };
    let axis = |name: &'static str| property(&|p| p == name).ok_or(PlyError::Missing(name));
    let mut wanted = vec![axis("x")?, axis("y")?, axis("z")?];
    let beside = [LABELS.as_slice(), &STRENGTHS].map(|names| {
        let at = names
            .iter()
            .find_map(|name| property(&|p| p.to_lowercase() == *name));
        wanted.extend(at);
        at.map(|_| wanted.len() - 1)
    });

    let mut body = PlyBody::new(&source.bytes[header.body..], header.encoding);
    for before in &header.elements[..at] {
        body.pass(before, &[], |_| {})?;
    }
    let mut cloud = Cloud::from_source(source);
    let is_gaussian = |name: &str| points.properties.iter().any(|p| p.name == name);
    let are_gaussians = is_gaussian("f_dc_0") && is_gaussian("scale_0");
    if are_gaussians {
        cloud.is_map();
    }
    body.pass(points, &wanted, |v| {
        let [label, strength] = beside.map(|at| at.map(|at| v[at]));
        cloud.add(DVec3::new(v[0], v[1], v[2]), label, strength)
    })?;

    let mut left_out = BTreeMap::new();
    if are_gaussians {
        let what = "colours, sizes and turns of Gaussians, read as the points in their middles";
        left_out.insert(what.to_owned(), points.count);
    } else {
        for (i, p) in points.properties.iter().enumerate() {
            if !wanted.contains(&i) || Some(i) == beside[1].map(|at| wanted[at]) {
                left_out.insert(format!("property {}", quoted(&p.name, 40)), 1);
            }
        }
    }
    for (i, element) in header.elements.iter().enumerate() {
        if i != at && element.count > 0 {
            left_out.insert(format!("element {}", quoted(&element.name, 40)), element.count);
        }
    }
    let loaded = cloud.scene(source.name, left_out)?;
    Ok(Content::Scene(Box::new(loaded)))
}

/// Type of a number.
#[derive(Clone, Copy, Debug, PartialEq)]
enum PlyScalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl PlyScalar {
    fn named(name: &str) -> Option<Self> {
        Some(match name {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// The number at the beginning of these bytes; NaN if they are too few.
    fn value(self, bytes: &[u8], is_big: bool) -> f64 {
        macro_rules! number {
            ($type:ty) => {
                bytes.first_chunk().map_or(f64::NAN, |b| match is_big {
                    true => <$type>::from_be_bytes(*b) as f64,
                    false => <$type>::from_le_bytes(*b) as f64,
                })
            };
        }
        match self {
            Self::I8 => number!(i8),
            Self::U8 => number!(u8),
            Self::I16 => number!(i16),
            Self::U16 => number!(u16),
            Self::I32 => number!(i32),
            Self::U32 => number!(u32),
            Self::F32 => number!(f32),
            Self::F64 => number!(f64),
        }
    }
}

struct Property {
    name: String,
    number: PlyScalar,
    /// Type of the length, for a list; `None` for a single value.
    length: Option<PlyScalar>,
}

struct Element {
    name: String,
    count: usize,
    properties: Vec<Property>,
}

impl Element {
    /// Bytes of one element in a binary file; `None` if it has lists.
    fn size(&self) -> Option<usize> {
        let sizes = self.properties.iter().map(|p| match p.length {
            Some(_) => None,
            None => Some(p.number.size()),
        });
        sizes.sum()
    }
}

#[derive(Clone, Copy, PartialEq)]
enum Encoding {
    Ascii,
    Little,
    Big,
}

struct PlyHeader {
    encoding: Encoding,
    elements: Vec<Element>,
    /// Where the numbers begin.
    body: usize,
}

impl PlyHeader {
    fn read(bytes: &[u8]) -> Result<Self, PlyError> {
        let (mut at, mut number) = (0, 0);
        let mut encoding = None;
        let mut elements: Vec<Element> = Vec::new();
        loop {
            number += 1;
            let rest = &bytes[at..bytes.len().min(LONGEST_HEADER)];
            let wrong = |found: String, expected| PlyError::Header {
                line: number,
                found,
                expected,
            };
            let Some(length) = rest.iter().position(|b| *b == b'\n') else {
                return Err(wrong("no end".into(), "end_header within 65,536 bytes"));
            };
            let line = String::from_utf8_lossy(&rest[..length]);
            let words: Vec<&str> = line.split_whitespace().collect();
            let said = || quoted(line.trim_end(), 60);
            at += length + 1;
            match words.as_slice() {
                ["ply"] if number == 1 => {}
                _ if number == 1 => return Err(wrong(said(), "ply")),
                [] | ["comment" | "obj_info", ..] => {}
                ["format", name, "1.0"] => {
                    encoding = Some(match *name {
                        "ascii" => Encoding::Ascii,
                        "binary_little_endian" => Encoding::Little,
                        "binary_big_endian" => Encoding::Big,
                        _ => {
                            let expected = "ascii, binary_little_endian or binary_big_endian";
                            return Err(wrong(said(), expected));
                        }
                    });
                }
                ["element", name, count] if elements.len() < MOST_ELEMENTS => {
                    let count = count.parse().ok().filter(|n| *n <= bytes.len());
                    elements.push(Element {
                        name: (*name).to_owned(),
                        count: count.ok_or_else(|| {
                            wrong(said(), "element, a name and a number of at most the file's bytes")
                        })?,
                        properties: Vec::new(),
                    });
                }
                ["property", kind @ .., name] => {
                    let types: Vec<Option<PlyScalar>> = kind.iter().map(|k| PlyScalar::named(k)).collect();
                    let (number, length) = match types.as_slice() {
                        [Some(number)] => (*number, None),
                        [None, Some(length), Some(number)] if kind[0] == "list" => (*number, Some(*length)),
                        _ => return Err(wrong(said(), "property, one type (or list and two) and a name")),
                    };
                    let properties = elements.last_mut().map(|e| &mut e.properties);
                    let properties = properties.filter(|p| p.len() < MOST_PROPERTIES);
                    let properties = properties
                        .ok_or_else(|| wrong(said(), "at most 256 properties, after their element"))?;
                    properties.push(Property {
                        name: (*name).to_owned(),
                        number,
                        length,
                    });
                }
                ["end_header"] => {
                    let encoding = encoding.ok_or_else(|| wrong(said(), "a line format before"))?;
                    return Ok(Self {
                        encoding,
                        elements,
                        body: at,
                    });
                }
                _ => return Err(wrong(said(), "format, element, property, comment or end_header")),
            }
        }
    }
}

/// The bytes after the header, read from the front.
struct PlyBody<'a> {
    rest: &'a [u8],
    encoding: Encoding,
}

impl<'a> PlyBody<'a> {
    fn new(rest: &'a [u8], encoding: Encoding) -> Self {
        Self { rest, encoding }
    }

    /// Reads all of an element and gives the wanted properties of each entry; none of these may be a list.
    fn pass(
        &mut self,
        element: &Element,
        wanted: &[usize],
        mut take: impl FnMut(&[f64]),
    ) -> Result<(), PlyError> {
        let mut values = vec![f64::NAN; wanted.len()];
        let put = |values: &mut [f64], property: usize, value: f64| {
            for (to, _) in values.iter_mut().zip(wanted).filter(|(_, w)| **w == property) {
                *to = value;
            }
        };
        for at in 0..element.count {
            let short = || PlyError::Short {
                element: quoted(&element.name, 40),
                at,
                expected: element.count,
            };
            if self.encoding == Encoding::Ascii {
                let line = self.line().ok_or_else(short)?;
                let mut words = line.split_ascii_whitespace();
                for (i, p) in element.properties.iter().enumerate() {
                    let number = |word: Option<&str>| {
                        let word = word.unwrap_or("nothing");
                        word.parse::<f64>().map_err(|_| PlyError::Number {
                            element: quoted(&element.name, 40),
                            at,
                            property: quoted(&p.name, 40),
                            found: quoted(word, 40),
                        })
                    };
                    let first = number(words.next())?;
                    match p.length {
                        None => put(&mut values, i, first),
                        Some(_) if first >= 1.0 => drop(words.nth(first as usize - 1).ok_or_else(short)?),
                        Some(_) => {}
                    }
                }
            } else {
                let is_big = self.encoding == Encoding::Big;
                if element.size().is_some_and(|size| size == 0) {
                    return Ok(()); // nothing of it is in the file
                }
                for (i, p) in element.properties.iter().enumerate() {
                    let first = p.length.unwrap_or(p.number);
                    let value = first.value(self.bytes(first.size()).ok_or_else(short)?, is_big);
                    match p.length {
                        None => put(&mut values, i, value),
                        Some(_) if value.is_nan() || value < 0.0 => return Err(short()),
                        Some(_) => {
                            let items = (value as usize).checked_mul(p.number.size());
                            self.bytes(items.ok_or_else(short)?).ok_or_else(short)?;
                        }
                    }
                }
            }
            take(&values);
        }
        Ok(())
    }

    fn bytes(&mut self, count: usize) -> Option<&'a [u8]> {
        let (taken, rest) = self.rest.split_at_checked(count)?;
        self.rest = rest;
        Some(taken)
    }

    /// The next line that is not empty.
    fn line(&mut self) -> Option<std::borrow::Cow<'a, str>> {
        loop {
            if self.rest.is_empty() {
                return None;
            }
            let length = self.rest.iter().position(|b| *b == b'\n');
            let length = length.map_or(self.rest.len(), |at| at + 1);
            let line = self.bytes(length)?.trim_ascii();
            if !line.is_empty() {
                return Some(String::from_utf8_lossy(line));
            }
        }
    }
}

#[cfg(test)]
#[path = "ply_tests.rs"]
mod tests;
