//! Headers and values of PLY: ascii, binary little and big endian.

use scene::message::quoted;

use super::scalar::Scalar;

/// Longest header, bytes; most elements, and most properties of one.
const LONGEST_HEADER: usize = 65_536;
const MOST_ELEMENTS: usize = 64;
const MOST_PROPERTIES: usize = 256;

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
}

/// The type that a header names.
fn scalar_named(name: &str) -> Option<Scalar> {
    Some(match name {
        "char" | "int8" => Scalar::I8,
        "uchar" | "uint8" => Scalar::U8,
        "short" | "int16" => Scalar::I16,
        "ushort" | "uint16" => Scalar::U16,
        "int" | "int32" => Scalar::I32,
        "uint" | "uint32" => Scalar::U32,
        "float" | "float32" => Scalar::F32,
        "double" | "float64" => Scalar::F64,
        _ => return None,
    })
}

pub(crate) struct Property {
    pub(crate) name: String,
    pub(super) number: Scalar,
    /// Type of the length, for a list; `None` for a single value.
    pub(crate) length: Option<Scalar>,
}

pub(crate) struct Element {
    pub(crate) name: String,
    pub(crate) count: usize,
    pub(crate) properties: Vec<Property>,
}

impl Element {
    /// Bytes of one element in a binary file; `None` if it has lists.
    pub(super) fn size(&self) -> Option<usize> {
        let sizes = self.properties.iter().map(|p| match p.length {
            Some(_) => None,
            None => Some(p.number.size()),
        });
        sizes.sum()
    }
}

#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Encoding {
    Ascii,
    Little,
    Big,
}

pub(crate) struct PlyHeader {
    pub(crate) encoding: Encoding,
    pub(crate) elements: Vec<Element>,
    /// Where the numbers begin.
    pub(crate) body: usize,
}

impl PlyHeader {
    pub(crate) fn read(bytes: &[u8]) -> Result<Self, PlyError> {
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
                    let types: Vec<Option<Scalar>> = kind.iter().map(|k| scalar_named(k)).collect();
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
pub(crate) struct PlyBody<'a> {
    pub(super) rest: &'a [u8],
    encoding: Encoding,
}

impl<'a> PlyBody<'a> {
    pub(crate) fn new(rest: &'a [u8], encoding: Encoding) -> Self {
        Self { rest, encoding }
    }

    /// Reads all of an element and gives the wanted properties of each entry; none of these may be a list.
    pub(crate) fn pass(
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
