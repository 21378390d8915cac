//! Reads a weight file (safetensors, f16 or f32) and checks all of it before a network sees it.

use std::collections::{BTreeMap, HashMap};
use std::fs::{self, File};
use std::io::Read;
use std::path::{Path, PathBuf};

use numeric::hash::fnv1a_64;
use safetensors::{Dtype, SafeTensorError, SafeTensors};
use thiserror::Error;

use crate::ops::OpsError;

/// Most bytes of a weight file that is read: 2 GiB, some hundred times the largest that ships.
pub const MOST_BYTES: u64 = 1 << 31;

/// Error of weights that were refused. Every message is one line that names the file.
#[derive(Debug, Error)]
pub enum WeightsError {
    /// The file could not be read.
    #[error("{}: {source}", path.display())]
    Read {
        /// Path of the file.
        path: PathBuf,
        /// Error of the system.
        source: std::io::Error,
    },
    /// A folder, a device, a pipe.
    #[error("{}: expected a regular file of weights, found {found}", path.display())]
    NotAFile {
        /// Path that was given.
        path: PathBuf,
        /// Kind of thing at the path.
        found: &'static str,
    },
    /// More than any network of this program can use.
    #[error("{}: expected weights of at most {MOST_BYTES} bytes, found {found}", path.display())]
    TooLarge {
        /// Path of the file.
        path: PathBuf,
        /// Its size, bytes.
        found: u64,
    },
    /// The backend could not take the weights in.
    #[error("{file}: {reason}")]
    Backend {
        /// Name of the file.
        file: String,
        /// Reason that the backend gave.
        reason: OpsError,
    },
    /// The bytes end before or after the place that the header names.
    #[error(
        "{file}: not a usable safetensors file: expected {expected} bytes, as its header says, found {found}"
    )]
    Size {
        /// Name of the file.
        file: String,
        /// Size that header and tensors take, bytes.
        expected: u64,
        /// Size of the file, bytes.
        found: u64,
    },
    /// Not a safetensors file, or a damaged one.
    #[error("{file}: not a usable safetensors file: {reason}")]
    Malformed {
        /// Name of the file.
        file: String,
        /// Reason that the reader gave.
        reason: String,
    },
    /// The metadata does not describe a network that this build can run.
    #[error("{file}: metadata \"{field}\": {reason}")]
    Config {
        /// Name of the file.
        file: String,
        /// Name of the entry.
        field: &'static str,
        /// Fault of the entry.
        reason: String,
    },
    /// A tensor that the network needs is not there.
    #[error("{file}: tensor \"{tensor}\" is missing, expected shape {expected:?}")]
    Missing {
        /// Name of the file.
        file: String,
        /// Name of the tensor.
        tensor: String,
        /// The shape the network needs.
        expected: Vec<usize>,
    },
    /// A tensor of another shape.
    #[error("{file}: tensor \"{tensor}\": expected shape {expected:?}, found {found:?}")]
    Shape {
        /// Name of the file.
        file: String,
        /// Name of the tensor.
        tensor: String,
        /// The shape the network needs.
        expected: Vec<usize>,
        /// The shape in the file.
        found: Vec<usize>,
    },
    /// Numbers stored in a type that is not read.
    #[error("{file}: tensor \"{tensor}\": expected f16 or f32, found {found:?}")]
    Dtype {
        /// Name of the file.
        file: String,
        /// Name of the tensor.
        tensor: String,
        /// The type in the file.
        found: Dtype,
    },
    /// NaN or infinity.
    #[error("{file}: tensor \"{tensor}\": value {index} is {value}, {count} values are not finite")]
    NotFinite {
        /// Name of the file.
        file: String,
        /// Name of the tensor.
        tensor: String,
        /// Index of the first such value.
        index: usize,
        /// That value.
        value: f32,
        /// Number of such values.
        count: usize,
    },
    /// A tensor that the network does not know: the file belongs to another version.
    #[error("{file}: tensor \"{tensor}\" of shape {found:?} is not part of this network")]
    Unknown {
        /// Name of the file.
        file: String,
        /// Name of the tensor.
        tensor: String,
        /// Its shape.
        found: Vec<usize>,
    },
}

/// A parsed weight file. Networks [`take`](Self::take) their tensors; [`finish`](Self::finish) checks
/// that nothing is left over.
pub struct WeightFile<'data> {
    name: String,
    tensors: SafeTensors<'data>,
    metadata: HashMap<String, String>,
    taken: BTreeMap<String, ()>,
    hash: u64,
}

impl<'data> WeightFile<'data> {
    /// Parses the header; sizes are checked against the bytes that are there, so a header that
    /// promises more than the file holds allocates nothing.
    pub fn parse(name: &str, bytes: &'data [u8]) -> Result<Self, WeightsError> {
        let malformed = |reason: SafeTensorError| match (&reason, size_by_header(bytes)) {
            (SafeTensorError::MetadataIncompleteBuffer, Some(expected)) => WeightsError::Size {
                file: name.to_owned(),
                expected,
                found: bytes.len() as u64,
            },
            _ => WeightsError::Malformed {
                file: name.to_owned(),
                reason: reason.to_string().replace('\n', " "),
            },
        };
        let (_, header) = SafeTensors::read_metadata(bytes).map_err(malformed)?;
        let metadata = header.metadata().clone().unwrap_or_default();
        let tensors = SafeTensors::deserialize(bytes).map_err(malformed)?;
        Ok(Self {
            name: name.to_owned(),
            tensors,
            metadata,
            taken: BTreeMap::new(),
            hash: fnv1a_64(bytes),
        })
    }

    /// Name of the file, for messages.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// FNV-1a of the whole file: names the weights in reports.
    pub fn hash(&self) -> u64 {
        self.hash
    }

    /// The metadata entry as JSON of the wanted type.
    pub fn config<T: serde::de::DeserializeOwned>(&self, field: &'static str) -> Result<T, WeightsError> {
        let refuse = |reason: String| WeightsError::Config {
            file: self.name.clone(),
            field,
            reason,
        };
        let text = self
            .metadata
            .get(field)
            .ok_or_else(|| refuse("is missing".into()))?;
        serde_json::from_str(text).map_err(|e| refuse(e.to_string()))
    }

    /// An error about a metadata entry of this file.
    pub fn config_error(&self, field: &'static str, reason: String) -> WeightsError {
        WeightsError::Config {
            file: self.name.clone(),
            field,
            reason,
        }
    }

    /// Error of a backend about weights of this file.
    pub fn backend_error(&self, reason: OpsError) -> WeightsError {
        WeightsError::Backend {
            file: self.name.clone(),
            reason,
        }
    }

    /// A metadata entry as it stands.
    pub fn metadata(&self, field: &str) -> Option<&str> {
        self.metadata.get(field).map(String::as_str)
    }

    /// One tensor as f32, in C order; checks presence, shape, type and finite values.
    pub fn take(&mut self, tensor: &str, expected: &[usize]) -> Result<Vec<f32>, WeightsError> {
        let (file, tensor) = (self.name.clone(), tensor.to_owned());
        let Ok(view) = self.tensors.tensor(&tensor) else {
            return Err(WeightsError::Missing {
                file,
                tensor,
                expected: expected.to_vec(),
            });
        };
        if view.shape() != expected {
            return Err(WeightsError::Shape {
                file,
                tensor,
                expected: expected.to_vec(),
                found: view.shape().to_vec(),
            });
        }
        let values: Vec<f32> = match view.dtype() {
            Dtype::F16 => {
                let pairs = view.data().chunks_exact(2);
                pairs
                    .map(|b| half::f16::from_le_bytes([b[0], b[1]]).to_f32())
                    .collect()
            }
            Dtype::F32 => {
                let quads = view.data().chunks_exact(4);
                quads
                    .map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]))
                    .collect()
            }
            found => return Err(WeightsError::Dtype { file, tensor, found }),
        };
        if let Some(index) = values.iter().position(|v| !v.is_finite()) {
            return Err(WeightsError::NotFinite {
                file,
                tensor,
                index,
                value: values[index],
                count: values.iter().filter(|v| !v.is_finite()).count(),
            });
        }
        self.taken.insert(tensor, ());
        Ok(values)
    }

    /// Fails if the file holds a tensor that was not taken.
    pub fn finish(self) -> Result<(), WeightsError> {
        let mut names = self.tensors.names();
        names.sort_unstable();
        match names.into_iter().find(|n| !self.taken.contains_key(*n)) {
            None => Ok(()),
            Some(tensor) => Err(WeightsError::Unknown {
                tensor: tensor.to_owned(),
                found: self
                    .tensors
                    .tensor(tensor)
                    .map(|v| v.shape().to_vec())
                    .unwrap_or_default(),
                file: self.name,
            }),
        }
    }
}

/// Bytes of a file by its header: the eight of the length, the header, and the tensors up to the last offset.
fn size_by_header(bytes: &[u8]) -> Option<u64> {
    let length = u64::from_le_bytes(bytes.first_chunk().copied()?);
    let text = bytes.get(8..8 + usize::try_from(length).ok()?)?;
    let header: serde_json::Map<String, serde_json::Value> = serde_json::from_slice(text).ok()?;
    let ends = header.values().filter_map(|t| t["data_offsets"][1].as_u64());
    Some(8 + length + ends.max().unwrap_or(0))
}

/// Reads a whole file. Refuses anything but a regular file, and more than [`MOST_BYTES`], before reading.
pub fn read(path: &Path) -> Result<Vec<u8>, WeightsError> {
    let refused = |source| WeightsError::Read {
        path: path.to_owned(),
        source,
    };
    let too_large = |found| WeightsError::TooLarge {
        path: path.to_owned(),
        found,
    };
    // Before opening, since opening a pipe waits for a writer.
    let kind = fs::metadata(path).map_err(refused)?;
    if !kind.is_file() {
        return Err(WeightsError::NotAFile {
            path: path.to_owned(),
            found: if kind.is_dir() {
                "a folder"
            } else {
                "a device or a pipe"
            },
        });
    }
    if kind.len() > MOST_BYTES {
        return Err(too_large(kind.len()));
    }
    let mut bytes = Vec::with_capacity(kind.len() as usize);
    let file = File::open(path).map_err(refused)?;
    // It may grow while it is read.
    file.take(MOST_BYTES + 1)
        .read_to_end(&mut bytes)
        .map_err(refused)?;
    match bytes.len() as u64 {
        found if found > MOST_BYTES => Err(too_large(found)),
        _ => Ok(bytes),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use safetensors::tensor::TensorView;

    fn file(values: &[f32], shape: &[usize], name: &str) -> Vec<u8> {
        let data: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        let view = TensorView::new(Dtype::F32, shape.to_vec(), &data).expect("data of that shape");
        safetensors::serialize([(name, view)], None).expect("serializable")
    }

    #[test]
    fn takes_what_is_there() {
        let bytes = file(&[1.0, -2.5, 3.0, 0.0], &[2, 2], "a.weight");
        let mut weights = WeightFile::parse("w", &bytes).expect("valid");
        assert_eq!(
            weights.take("a.weight", &[2, 2]).expect("there"),
            [1.0, -2.5, 3.0, 0.0]
        );
        weights.finish().expect("nothing left");
    }

    #[test]
    fn refusals_name_file_tensor_and_shapes() {
        let bytes = file(&[1.0; 4], &[2, 2], "a.weight");
        let mut weights = WeightFile::parse("w.safetensors", &bytes).expect("valid");
        let text = |e: WeightsError| e.to_string();
        assert_eq!(
            text(weights.take("b.bias", &[7]).expect_err("not there")),
            "w.safetensors: tensor \"b.bias\" is missing, expected shape [7]"
        );
        assert_eq!(
            text(weights.take("a.weight", &[4, 1]).expect_err("misshapen")),
            "w.safetensors: tensor \"a.weight\": expected shape [4, 1], found [2, 2]"
        );
        assert_eq!(
            text(weights.finish().expect_err("left over")),
            "w.safetensors: tensor \"a.weight\" of shape [2, 2] is not part of this network"
        );
        for bad in [f32::NAN, f32::INFINITY] {
            let bytes = file(&[1.0, bad, 2.0, bad], &[4], "a");
            let mut weights = WeightFile::parse("w", &bytes).expect("valid");
            let error = text(weights.take("a", &[4]).expect_err("not finite"));
            assert_eq!(
                error,
                format!("w: tensor \"a\": value 1 is {bad}, 2 values are not finite")
            );
        }
        let bytes = {
            let view = TensorView::new(Dtype::I32, vec![1], &[0; 4]).expect("four bytes");
            safetensors::serialize([("a", view)], None).expect("serializable")
        };
        let mut weights = WeightFile::parse("w", &bytes).expect("valid");
        assert!(matches!(
            weights.take("a", &[1]),
            Err(WeightsError::Dtype {
                found: Dtype::I32,
                ..
            })
        ));
        assert!(matches!(
            weights.config::<u32>("config"),
            Err(WeightsError::Config { .. })
        ));
    }

    /// Row 62 of the extremes table: every truncation, and a header that promises too much.
    #[test]
    fn row_62_files() {
        let bytes = file(&[1.0; 64], &[8, 8], "a.weight");
        for length in 0..bytes.len() {
            let error = WeightFile::parse("cut", &bytes[..length])
                .map(|_| ())
                .expect_err("truncated");
            assert!(
                matches!(error, WeightsError::Malformed { .. } | WeightsError::Size { .. }),
                "{length}: {error}"
            );
            assert!(!error.to_string().contains('\n'));
        }
        for shape in [
            "[1099511627776,1099511627776]",
            "[4611686018427387904]",
            "[18446744073709551615,2]",
        ] {
            let header = format!("{{\"a\":{{\"dtype\":\"F32\",\"shape\":{shape},\"data_offsets\":[0,16]}}}}");
            let mut bomb = (header.len() as u64).to_le_bytes().to_vec();
            bomb.extend(header.as_bytes());
            bomb.extend([0; 16]);
            assert!(WeightFile::parse("bomb", &bomb).is_err());
        }
        let mut longer = bytes.clone();
        longer.push(0);
        let error = WeightFile::parse("w", &longer)
            .map(|_| ())
            .expect_err("too long")
            .to_string();
        let (all, more) = (bytes.len(), longer.len());
        assert_eq!(
            error,
            format!(
                "w: not a usable safetensors file: expected {all} bytes, as its header says, found {more}"
            )
        );
        let missing = read(Path::new("/nowhere/at/all")).expect_err("no such file");
        assert!(missing.to_string().starts_with("/nowhere/at/all: "));
    }

    /// Row 62: what never ends or is too large is refused before it is read, in one line.
    #[cfg(unix)]
    #[test]
    fn row_62_endless_files() {
        let folder = std::env::temp_dir().join(format!("sceneloom-weights-{}", std::process::id()));
        fs::create_dir_all(&folder).expect("a folder");
        let (pipe, sparse) = (folder.join("pipe"), folder.join("sparse"));
        let made = std::process::Command::new("mkfifo").arg(&pipe).status();
        assert!(made.expect("mkfifo runs").success());
        File::create(&sparse)
            .and_then(|f| f.set_len(MOST_BYTES + 1))
            .expect("a sparse file");
        let told = |path: &Path| read(path).expect_err("refused").to_string();
        let no_file = "expected a regular file of weights, found a device or a pipe";
        assert_eq!(told(Path::new("/dev/zero")), format!("/dev/zero: {no_file}"));
        assert_eq!(told(&pipe), format!("{}: {no_file}", pipe.display()));
        assert!(told(&folder).ends_with("found a folder"));
        let most = "expected weights of at most 2147483648 bytes, found 2147483649";
        assert_eq!(told(&sparse), format!("{}: {most}", sparse.display()));
        fs::remove_dir_all(&folder).expect("removed");
    }
}
