//! The `config.json` of each part, as typed values. A value that changes a computation and is not known here is refused
//! in one line; values that do not matter for drawing are ignored.

mod control;
mod scheduler;
mod text;
mod unet;
mod vae;

use std::io::Read;
use std::path::Path;

use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};

use crate::StableError;

pub use control::{ControlConfig, MpiConfig};
pub use scheduler::{BetaSchedule, Predicts, SchedulerConfig, SchedulerKind, Steps};
pub use text::{Activation, TextConfig, TokenizerConfig};
pub use unet::{Connector, NeighbourFusion, UnetBlockKind, UnetConfig};
pub use vae::VaeConfig;

/// Largest size of a configuration, bytes.
const MOST_BYTES: u64 = 1 << 20;

/// One number for all levels, or one for each.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(untagged, expecting = "a whole number, or a list of them")]
pub enum Each {
    /// One number for all levels.
    All(usize),
    /// One number for each level, from the finest to the coarsest.
    Of(Vec<usize>),
}

impl Each {
    /// The numbers of so many levels; `None` if the list has another length.
    pub fn of(&self, levels: usize) -> Option<Vec<usize>> {
        match self {
            Self::All(n) => Some(vec![*n; levels]),
            Self::Of(all) if all.len() == levels => Some(all.clone()),
            Self::Of(_) => None,
        }
    }
}

/// Reads a JSON file as the wanted type. Errors in one line if it cannot be read, has more than `most` bytes, or has
/// other content.
pub(crate) fn read_json<T: DeserializeOwned>(path: &Path, most: u64) -> Result<T, StableError> {
    let bytes = read_bounded(path, most)?;
    serde_json::from_slice(&bytes).map_err(|e| refused(path, e.to_string()))
}

/// Reads a regular file of at most `most` bytes.
pub(crate) fn read_bounded(path: &Path, most: u64) -> Result<Vec<u8>, StableError> {
    let unread = |source| StableError::Read {
        path: path.to_owned(),
        source,
    };
    let kind = std::fs::metadata(path).map_err(unread)?;
    if !kind.is_file() {
        return Err(StableError::Folder {
            path: path.to_owned(),
            expected: "a regular file".into(),
            found: if kind.is_dir() {
                "a folder"
            } else {
                "a device or a pipe"
            }
            .into(),
        });
    }
    let mut bytes = Vec::new();
    let file = std::fs::File::open(path).map_err(unread)?;
    // The file may grow while it is read.
    file.take(most + 1).read_to_end(&mut bytes).map_err(unread)?;
    if bytes.len() as u64 > most {
        return Err(refused(
            path,
            format!("expected at most {most} bytes, found more"),
        ));
    }
    Ok(bytes)
}

/// Reads the configuration of a file and checks it by `check`.
fn read_config<T: DeserializeOwned>(
    path: &Path,
    check: impl FnOnce(&T) -> Result<(), String>,
) -> Result<T, StableError> {
    let text = plain_numbers(&read_bounded(path, MOST_BYTES)?);
    let config = serde_json::from_slice(&text).map_err(|e| refused(path, e.to_string()))?;
    check(&config).map_err(|reason| refused(path, reason))?;
    Ok(config)
}

/// JSON text with the numbers `Infinity`, `-Infinity` and `NaN`, which Python writes, replaced by `null`.
fn plain_numbers(text: &[u8]) -> Vec<u8> {
    let mut out = Vec::with_capacity(text.len());
    let (mut rest, mut quoted) = (text, false);
    while let Some((first, more)) = rest.split_first() {
        let names: [&[u8]; 3] = [b"-Infinity", b"Infinity", b"NaN"];
        let name = names.into_iter().find(|n| !quoted && rest.starts_with(n));
        match (name, first, more.first()) {
            (Some(name), ..) => {
                out.extend(b"null");
                rest = &rest[name.len()..];
            }
            (None, b'\\', Some(next)) if quoted => {
                out.extend([*first, *next]);
                rest = &rest[2..];
            }
            _ => {
                quoted ^= *first == b'"';
                out.push(*first);
                rest = more;
            }
        }
    }
    out
}

fn refused(path: &Path, reason: String) -> StableError {
    StableError::Config {
        path: path.to_owned(),
        reason: reason.replace('\n', " "),
    }
}

#[cfg(test)]
#[test]
fn numbers_that_json_has_not_are_none() {
    let text = br#"{"a": -Infinity, "b": [NaN,1], "NaN\" Infinity": Infinity, "c": "-Infinity"}"#;
    let plain = br#"{"a": null, "b": [null,1], "NaN\" Infinity": null, "c": "-Infinity"}"#;
    assert_eq!(plain_numbers(text), plain);
}

/// Fails at a field that has another value than those listed, written as in JSON.
fn check_plain(rest: &Map<String, Value>, plain: &[(&str, &[&str])]) -> Result<(), String> {
    for (name, allowed) in plain {
        let Some(value) = rest.get(*name) else { continue };
        let text = value.to_string();
        if !allowed.contains(&text.as_str()) {
            let short: String = text.chars().take(60).collect();
            return Err(format!("{name} is {short}, expected {}", allowed.join(" or ")));
        }
    }
    Ok(())
}

/// Fails unless a number lies in a range.
fn check_range(name: &str, found: usize, range: std::ops::RangeInclusive<usize>) -> Result<(), String> {
    if range.contains(&found) {
        return Ok(());
    }
    Err(format!(
        "{name} is {found}, expected {} to {}",
        range.start(),
        range.end()
    ))
}

/// Fails unless widths can be divided into groups of channels.
fn check_widths(widths: &[usize], groups: usize) -> Result<(), String> {
    check_range("the number of block_out_channels", widths.len(), 1..=8)?;
    for &width in widths {
        check_range("block_out_channels", width, 1..=8192)?;
        if groups == 0 || !width.is_multiple_of(groups) {
            return Err(format!(
                "norm_num_groups is {groups}, expected a divisor of {width}, a width of block_out_channels"
            ));
        }
    }
    Ok(())
}
