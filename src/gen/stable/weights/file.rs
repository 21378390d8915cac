//! One safetensors file: its header, and its tensors at their offsets.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use safetensors::Dtype;
use safetensors::tensor::Metadata;

use crate::StableError;

/// Largest size of a header, bytes; the format allows no more.
const MOST_HEADER: u64 = 100_000_000;

/// Position of a tensor in a file.
#[derive(Clone, Debug)]
pub(super) struct TensorLocation {
    /// Type of its numbers.
    pub dtype: Dtype,
    /// Its shape.
    pub shape: Vec<usize>,
    /// Index of its first byte in the file.
    start: u64,
    /// Number of its bytes.
    length: usize,
}

/// An open file whose header has been checked against its length.
#[derive(Debug)]
pub(super) struct WeightFile {
    path: PathBuf,
    file: Mutex<File>,
}

impl WeightFile {
    /// Opens a file. Also gives the name and place of each tensor. Only the header is read. Errors if it is no regular
    /// file, damaged, or shorter or longer than its header says.
    pub fn open(path: &Path) -> Result<(Self, Vec<(String, TensorLocation)>), StableError> {
        let refused = |source| StableError::Read {
            path: path.to_owned(),
            source,
        };
        let malformed = |reason: String| StableError::Malformed {
            path: path.to_owned(),
            reason: reason.replace('\n', " "),
        };
        // Checked before opening, because opening a pipe waits until somebody writes to it.
        let kind = std::fs::metadata(path).map_err(refused)?;
        if !kind.is_file() {
            return Err(StableError::Folder {
                path: path.to_owned(),
                expected: "a regular file of weights".into(),
                found: if kind.is_dir() {
                    "a folder"
                } else {
                    "a device or a pipe"
                }
                .into(),
            });
        }
        let found = kind.len();
        let mut file = File::open(path).map_err(refused)?;
        let mut head = Vec::new();
        (&mut file).take(8).read_to_end(&mut head).map_err(refused)?;
        let Some(length) = head.first_chunk().map(|b| u64::from_le_bytes(*b)) else {
            return Err(malformed(format!("expected a header, found {found} bytes")));
        };
        if length > MOST_HEADER || length > found.saturating_sub(8) {
            return Err(malformed(format!(
                "its header should have {length} bytes, the file has {found}"
            )));
        }
        (&mut file).take(length).read_to_end(&mut head).map_err(refused)?;
        // This also checks that offsets have no gaps and each tensor has as many bytes as its shape takes.
        let header = serde_json::from_slice::<Metadata>(&head[8..]).map_err(|e| malformed(e.to_string()))?;
        let mut places = Vec::new();
        let mut end = 0;
        for (name, info) in header.tensors() {
            let (from, to) = info.data_offsets;
            end = end.max(to as u64);
            let place = TensorLocation {
                dtype: info.dtype,
                shape: info.shape.clone(),
                start: 8 + length + from as u64,
                length: to.saturating_sub(from),
            };
            places.push((name, place));
        }
        let expected = 8 + length + end;
        if found != expected {
            return Err(malformed(format!(
                "expected {expected} bytes, as its header says, found {found}"
            )));
        }
        let file = Self {
            path: path.to_owned(),
            file: Mutex::new(file),
        };
        Ok((file, places))
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The bytes of a tensor. Errors if the file has become shorter since it was opened.
    pub fn read(&self, place: &TensorLocation) -> Result<Vec<u8>, StableError> {
        let refused = |source| StableError::Read {
            path: self.path.clone(),
            source,
        };
        let mut bytes = vec![0; place.length];
        // A reader that panicked leaves only the position changed, which is set again.
        let mut file = self.file.lock().unwrap_or_else(|e| e.into_inner());
        file.seek(SeekFrom::Start(place.start)).map_err(refused)?;
        file.read_exact(&mut bytes).map_err(refused)?;
        Ok(bytes)
    }
}
