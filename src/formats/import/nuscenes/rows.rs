//! Rows of a table, one after another, so that a table of all scenes costs no more than the rows of one.

use std::fmt;
use std::marker::PhantomData;

use scene::message::one_line;
use serde::Deserializer as _;
use serde::de::{DeserializeOwned, SeqAccess, Visitor};

use crate::FormatError;
use crate::import::ImportFile;

/// Largest table that is read, bytes: `sample_data.json` of all of nuScenes has about 1.3 GB.
const LARGEST: u64 = 2 << 30;

/// The rows of the table of that name for which `keep` holds. Errors if the file is not there or no such table.
pub(super) fn of<T: DeserializeOwned>(
    source: &ImportFile<'_>,
    table: &str,
    keep: impl FnMut(&T) -> bool,
) -> Result<Vec<T>, FormatError> {
    let file = format!("{table}.json");
    let bytes = source.beside(&file, LARGEST)?;
    parse(&bytes, keep).map_err(|e| FormatError::new(e).at(&file))
}

/// Reads rows as [`of`] does from a table that may be missing; there are none then.
pub(super) fn of_optional<T: DeserializeOwned>(
    source: &ImportFile<'_>,
    table: &str,
    keep: impl FnMut(&T) -> bool,
) -> Result<Vec<T>, FormatError> {
    match source.place(&format!("{table}.json"))?.exists() {
        true => of(source, table, keep),
        false => Ok(Vec::new()),
    }
}

/// The rows in the bytes of a table for which `keep` holds. Errors in one line.
pub(super) fn parse<T: DeserializeOwned>(
    bytes: &[u8],
    keep: impl FnMut(&T) -> bool,
) -> Result<Vec<T>, String> {
    let mut json = serde_json::Deserializer::from_slice(bytes);
    let rows = json
        .deserialize_seq(Keep(keep, PhantomData))
        .map_err(|e| one_line(&e))?;
    json.end().map_err(|e| one_line(&e))?;
    Ok(rows)
}

struct Keep<T, F>(F, PhantomData<T>);

impl<'de, T: DeserializeOwned, F: FnMut(&T) -> bool> Visitor<'de> for Keep<T, F> {
    type Value = Vec<T>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a table: an array of rows")
    }

    fn visit_seq<A: SeqAccess<'de>>(mut self, mut rows: A) -> Result<Vec<T>, A::Error> {
        let mut out = Vec::new();
        while let Some(row) = rows.next_element::<T>()? {
            if (self.0)(&row) {
                out.push(row);
            }
        }
        Ok(out)
    }
}
