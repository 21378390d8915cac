//! Records of a file of returns: numbers by field, and records written anew.

use std::borrow::Cow;
use std::ops::Range;

use super::scalar::Scalar;

/// Decimals of a number in a text that has none to go by.
const DECIMALS: usize = 4;
/// Decimals that a number is written with at most.
const MOST_DECIMALS: usize = 17;

/// Records of a file, and the bytes around them.
pub(super) struct Records<'a> {
    /// Bytes before the records.
    pub(super) before: &'a [u8],
    /// Bytes behind them.
    pub(super) after: &'a [u8],
    /// The records, unpacked.
    pub(super) body: Cow<'a, [u8]>,
    /// Order of their numbers.
    pub(super) order: RecordOrder,
    /// True if the highest byte of a number comes first.
    pub(super) is_big: bool,
    /// Fields of a record.
    pub(super) fields: Vec<RecordField>,
    /// Number of records.
    pub(super) count: usize,
}

/// Order of numbers.
pub(super) enum RecordOrder {
    /// One record behind the other, of so many bytes each.
    Rows(usize),
    /// One field of all records behind the other.
    Fields,
    /// A line of text each.
    Lines(Vec<Range<usize>>),
}

/// A field of a record.
pub(super) struct RecordField {
    pub(super) name: String,
    pub(super) number: Scalar,
    /// Bytes before it in a record; words before it in a line.
    pub(super) at: usize,
    /// Bytes of all its values in a record.
    pub(super) bytes: usize,
}

/// A record of the file that is written.
pub(super) enum NewRecord {
    /// One of the file as it is.
    Kept(usize),
    /// One of the file with other numbers in some fields.
    Like(usize, Vec<(usize, f64)>),
}

impl Records<'_> {
    /// The first field of one of these names, in small letters.
    pub(super) fn field(&self, names: &[&str]) -> Option<usize> {
        let at = |name: &&str| self.fields.iter().position(|f| f.name.to_lowercase() == **name);
        names.iter().find_map(at)
    }

    /// The first number of a field; NaN if there is none.
    pub(super) fn value(&self, record: usize, field: usize) -> f64 {
        let Some(f) = self.fields.get(field) else {
            return f64::NAN;
        };
        let at = match &self.order {
            RecordOrder::Rows(stride) => record * stride + f.at,
            RecordOrder::Fields => self.count * f.at + record * f.bytes,
            RecordOrder::Lines(lines) => {
                let word = lines.get(record).and_then(|line| self.words(line).nth(f.at));
                let word = word.and_then(|word| std::str::from_utf8(&self.body[word]).ok()?.parse().ok());
                return word.unwrap_or(f64::NAN);
            }
        };
        self.body
            .get(at..)
            .map_or(f64::NAN, |bytes| f.number.value(bytes, self.is_big))
    }

    /// Bytes of these records in the order of the file.
    pub(super) fn written(&self, records: &[NewRecord]) -> Vec<u8> {
        let mut out = Vec::with_capacity(self.body.len());
        if let RecordOrder::Lines(lines) = &self.order {
            for record in records {
                let (at, values) = record.parts();
                self.put_line(&lines[at], values, &mut out);
            }
            return out;
        }
        let fields: &[RecordField] = match self.order {
            RecordOrder::Fields => &self.fields,
            _ => &[],
        };
        if fields.is_empty() {
            let RecordOrder::Rows(stride) = self.order else {
                return out;
            };
            for record in records {
                let (at, values) = record.parts();
                let from = out.len();
                out.extend_from_slice(&self.body[at * stride..][..stride]);
                for (field, value) in values {
                    let f = &self.fields[*field];
                    f.number.put(*value, self.is_big, &mut out[from + f.at..]);
                }
            }
        }
        for (i, f) in fields.iter().enumerate() {
            for record in records {
                let (at, values) = record.parts();
                let from = out.len();
                out.extend_from_slice(&self.body[self.count * f.at + at * f.bytes..][..f.bytes]);
                if let Some((_, value)) = values.iter().find(|(field, _)| *field == i) {
                    f.number.put(*value, self.is_big, &mut out[from..]);
                }
            }
        }
        out
    }

    /// Ranges of the words of a line in the body.
    fn words(&self, line: &Range<usize>) -> impl Iterator<Item = Range<usize>> + '_ {
        let (text, from) = (&self.body[line.clone()], line.start);
        let mut at = 0;
        std::iter::from_fn(move || {
            let begin = at + text[at..].iter().position(|b| !b.is_ascii_whitespace())?;
            let length = text[begin..].iter().position(u8::is_ascii_whitespace);
            at = begin + length.unwrap_or(text.len() - begin);
            Some(from + begin..from + at)
        })
    }

    fn put_line(&self, line: &Range<usize>, values: &[(usize, f64)], out: &mut Vec<u8>) {
        let mut from = line.start;
        for (i, word) in self.words(line).enumerate() {
            let of_word = |(field, _): &&(usize, f64)| self.fields.get(*field).is_some_and(|f| f.at == i);
            if let Some((field, value)) = values.iter().find(of_word) {
                out.extend_from_slice(&self.body[from..word.start]);
                let decimals = match self.fields[*field].number.is_float() {
                    true => decimals(&self.body[word.clone()]).clamp(DECIMALS, MOST_DECIMALS),
                    false => 0,
                };
                out.extend_from_slice(format!("{value:.decimals$}").as_bytes());
                from = word.end;
            }
        }
        out.extend_from_slice(&self.body[from..line.end]);
        if !out.ends_with(b"\n") {
            out.push(b'\n');
        }
    }
}

impl NewRecord {
    fn parts(&self) -> (usize, &[(usize, f64)]) {
        match self {
            Self::Kept(at) => (*at, &[]),
            Self::Like(at, values) => (*at, values),
        }
    }
}

/// Digits behind the point of a number.
fn decimals(word: &[u8]) -> usize {
    let point = word.iter().position(|b| *b == b'.');
    point.map_or(0, |at| {
        word[at + 1..].iter().take_while(|b| b.is_ascii_digit()).count()
    })
}

/// Ranges of lines that are not empty, with their ends: at most `count` of them.
pub(super) fn lines(body: &[u8], count: usize) -> Vec<Range<usize>> {
    let mut at = 0;
    let each = body.split_inclusive(|b| *b == b'\n').filter_map(|line| {
        let range = at..at + line.len();
        at = range.end;
        (!line.trim_ascii().is_empty()).then_some(range)
    });
    each.take(count).collect()
}
