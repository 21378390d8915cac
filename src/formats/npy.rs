//! Numpy arrays, read: headers are checked before a parser sees them, and rows of numbers are taken as they lie in the file.

use npyz::{NpyHeader, Order};
use scene::message::{quoted, shortened};

/// Longest header of an array, bytes, and most brackets in it: its parser calls itself for each, and a file of nothing
/// but brackets would end the program.
const LONGEST_HEADER: usize = 4096;
const MOST_BRACKETS: usize = 64;

/// Where the values of an array begin; errors on a header that numpy would not write: too long, nested too deeply, or with a
/// shape of more values than can be counted, which its parser multiplies.
pub(crate) fn values_at(bytes: &[u8]) -> Result<usize, String> {
    // Magic (6), version (2), length (2 bytes in version 1, 4 later), text.
    let (length, start) = match bytes {
        [_, _, _, _, _, _, 1, _, a, b, ..] => (usize::from(u16::from_le_bytes([*a, *b])), 10),
        [_, _, _, _, _, _, _, _, a, b, c, d, ..] => (u32::from_le_bytes([*a, *b, *c, *d]) as usize, 12),
        _ => return Err(format!("{} bytes, expected an npy file", bytes.len())),
    };
    if length > LONGEST_HEADER {
        return Err(format!(
            "a header of {length} bytes, expected at most {LONGEST_HEADER}"
        ));
    }
    let text = &bytes[start..];
    let text = &text[..length.min(text.len())];
    let brackets = text.iter().filter(|b| matches!(b, b'(' | b'[' | b'{')).count();
    if brackets > MOST_BRACKETS {
        return Err(format!(
            "a header with {brackets} brackets, expected at most {MOST_BRACKETS}"
        ));
    }
    match product(text) {
        Some(_) => Ok(start + length),
        None => Err("a shape of more than 2^64 bytes".into()),
    }
}

/// All whole numbers of a text multiplied, zeros left out; `None` beyond 2^64.
fn product(text: &[u8]) -> Option<u64> {
    let mut numbers = text.split(|b| !b.is_ascii_digit()).filter(|n| !n.is_empty());
    numbers.try_fold(1u64, |product, digits| {
        let number: u64 = std::str::from_utf8(digits).ok()?.parse().ok()?;
        product.checked_mul(number.max(1))
    })
}

/// An array of two axes, of any type of whole or floating point numbers.
pub(crate) struct NpyMatrix<'a> {
    /// Length of the first axis.
    pub rows: usize,
    /// Length of the second axis.
    pub columns: usize,
    kind: NpyType,
    /// True if the values of a column, not those of a row, lie one after another.
    by_column: bool,
    values: &'a [u8],
}

/// Type of a number: letter and bytes, and whether its first byte is the highest.
#[derive(Clone, Copy)]
struct NpyType {
    letter: u8,
    size: usize,
    big_endian: bool,
}

impl<'a> NpyMatrix<'a> {
    /// From the bytes of an `.npy` file. Errors say what was found and what was expected.
    pub fn read(bytes: &'a [u8]) -> Result<Self, String> {
        let start = values_at(bytes)?;
        let header = NpyHeader::from_reader(bytes).map_err(|e| {
            let said = e.to_string();
            shortened(&said.split_whitespace().collect::<Vec<_>>().join(" "), 200)
        })?;
        let &[rows, columns] = header.shape() else {
            let shape = shortened(&format!("{:?}", header.shape()), 80);
            return Err(format!("an array of shape {shape}, expected rows and columns"));
        };
        let descr = header.dtype().descr();
        let kind = NpyType::from_descr(&descr).ok_or_else(|| {
            let found = quoted(&descr, 40);
            format!("values of type {found}, expected whole or floating point numbers")
        })?;
        let values = bytes.get(start..).unwrap_or_default();
        let [rows, columns] = [rows, columns].map(|n| usize::try_from(n).unwrap_or(usize::MAX));
        let needed = rows.checked_mul(columns).and_then(|n| n.checked_mul(kind.size));
        match needed.and_then(|needed| values.get(..needed)) {
            Some(values) => Ok(Self {
                rows,
                columns,
                kind,
                by_column: header.order() == Order::Fortran,
                values,
            }),
            None => Err(format!(
                "{} bytes of values, expected {rows} x {columns} of {} bytes",
                values.len(),
                kind.size
            )),
        }
    }

    /// The value at a place inside the array.
    #[inline]
    pub fn get(&self, row: usize, column: usize) -> f64 {
        let at = match self.by_column {
            true => column * self.rows + row,
            false => row * self.columns + column,
        };
        self.kind.value(&self.values[at * self.kind.size..])
    }
}

impl NpyType {
    /// From numpy's description: `'<i8'`.
    fn from_descr(descr: &str) -> Option<Self> {
        let kind = match descr.trim_matches('\'').as_bytes() {
            [order @ (b'<' | b'>' | b'|' | b'='), letter, size] if size.is_ascii_digit() => Self {
                letter: *letter,
                size: usize::from(size - b'0'),
                big_endian: *order == b'>',
            },
            _ => return None,
        };
        let known = matches!(
            (kind.letter, kind.size),
            (b'i' | b'u', 1 | 2 | 4 | 8) | (b'f', 4 | 8) | (b'b', 1)
        );
        known.then_some(kind)
    }

    #[inline]
    fn value(self, at: &[u8]) -> f64 {
        macro_rules! number {
            ($type:ty) => {
                at.first_chunk()
                    .map_or(f64::NAN, |b| match self.big_endian {
                        true => <$type>::from_be_bytes(*b) as f64,
                        false => <$type>::from_le_bytes(*b) as f64,
                    })
            };
        }
        match (self.letter, self.size) {
            (b'f', 4) => number!(f32),
            (b'f', _) => number!(f64),
            (b'i', 1) => number!(i8),
            (b'i', 2) => number!(i16),
            (b'i', 4) => number!(i32),
            (b'i', _) => number!(i64),
            (_, 1) => number!(u8),
            (_, 2) => number!(u16),
            (_, 4) => number!(u32),
            _ => number!(u64),
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// The bytes of an array of that type and shape.
    pub(crate) fn npy(descr: &str, fortran: bool, shape: &str, values: &[u8]) -> Vec<u8> {
        let fortran = if fortran { "True" } else { "False" };
        let header = format!("{{'descr': '{descr}', 'fortran_order': {fortran}, 'shape': {shape}, }}\n");
        let mut out = b"\x93NUMPY\x01\x00".to_vec();
        out.extend((header.len() as u16).to_le_bytes());
        out.extend(header.as_bytes());
        out.extend(values);
        out
    }

    #[test]
    fn every_type_and_order_reads_alike() {
        let numbers = [1, 2, 3, 4, 5, 100];
        let bytes = |of: fn(i8) -> Vec<u8>| numbers.iter().flat_map(|n| of(*n)).collect::<Vec<u8>>();
        let cases = [
            ("|u1", bytes(|n| vec![n as u8])),
            ("|i1", bytes(|n| n.to_le_bytes().to_vec())),
            ("<u2", bytes(|n| (n as u16).to_le_bytes().to_vec())),
            (">i2", bytes(|n| i16::from(n).to_be_bytes().to_vec())),
            ("<u4", bytes(|n| (n as u32).to_le_bytes().to_vec())),
            ("<i4", bytes(|n| i32::from(n).to_le_bytes().to_vec())),
            (">u8", bytes(|n| (n as u64).to_be_bytes().to_vec())),
            ("<i8", bytes(|n| i64::from(n).to_le_bytes().to_vec())),
            ("<f4", bytes(|n| f32::from(n).to_le_bytes().to_vec())),
            (">f8", bytes(|n| f64::from(n).to_be_bytes().to_vec())),
        ];
        for (descr, values) in cases {
            let file = npy(descr, false, "(2, 3)", &values);
            let table = NpyMatrix::read(&file).expect(descr);
            assert_eq!((table.rows, table.columns), (2, 3));
            assert_eq!([table.get(0, 1), table.get(1, 2)], [2.0, 100.0], "{descr}");
            let file = npy(descr, true, "(3, 2)", &values);
            let table = NpyMatrix::read(&file).expect(descr);
            assert_eq!([table.get(1, 0), table.get(2, 1)], [2.0, 100.0], "{descr}");
        }
    }

    #[test]
    fn what_is_no_table_is_one_line() {
        for (file, expected) in [
            (
                npy("|u1", false, "(2, 3)", &[1; 5]),
                "5 bytes of values, expected 2 x 3 of 1 bytes",
            ),
            (
                npy("<i8", false, "(18446744073709551615, 4)", &[]),
                "a shape of more than",
            ),
            (
                npy("<i8", false, "(0, 9223372036854775808, 4)", &[]),
                "a shape of more than",
            ),
            (
                npy("<i8", false, "(99999999999, 4)", &[]),
                "0 bytes of values, expected",
            ),
            (
                npy("|u1", false, "(4, 4, 4)", &[0; 64]),
                "an array of shape [4, 4, 4], expected rows and columns",
            ),
            (npy("<c8", false, "(1, 1)", &[0; 8]), "values of type"),
            (npy("|S3", false, "(1, 1)", &[0; 8]), "values of type"),
            (b"\x93NUM".to_vec(), "4 bytes, expected an npy file"),
        ] {
            let line = NpyMatrix::read(&file).err().expect(expected);
            assert!(line.starts_with(expected), "{line}");
        }
    }
}
