//! The weights of one network: a file, shards with an index, or a folder that holds either.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use candle_core::{DType, Tensor};
use safetensors::Dtype;
use serde::Deserialize;

use super::file::{TensorLocation, WeightFile};
use super::names::{Names, RequestedTensors};
use crate::config::read_json;
use crate::{Machine, StableError};

/// Names that a file of weights may have in its folder, in the order in which they are tried.
const NAMES: [&str; 4] = [
    "diffusion_pytorch_model.safetensors",
    "model.safetensors",
    "diffusion_pytorch_model.fp16.safetensors",
    "model.fp16.safetensors",
];
/// Largest size of an index of shards, bytes.
const MOST_INDEX: u64 = 16 << 20;
/// Number of names that a message lists.
const LISTED: usize = 3;

/// Tensors by name, on disk.
#[derive(Debug)]
pub struct Weights {
    path: PathBuf,
    files: Vec<WeightFile>,
    places: BTreeMap<String, (usize, TensorLocation)>,
}

#[derive(Deserialize)]
struct Index {
    weight_map: BTreeMap<String, String>,
}

impl Weights {
    /// Opens a folder with `diffusion_pytorch_model.safetensors`, `model.safetensors`, one of them in half precision
    /// (`.fp16.`), or the index of shards of such a name. Reads headers only. Errors if there is none, or if the files
    /// are damaged.
    pub fn of_folder(folder: &Path) -> Result<Self, StableError> {
        for name in NAMES {
            if folder.join(name).exists() {
                return Self::of_file(&folder.join(name));
            }
            // diffusers puts the variant of an index behind `index`; both spellings are in use.
            let plain = format!("{name}.index.json");
            let varied = name.replace(".fp16.safetensors", ".safetensors") + ".index.fp16.json";
            for index in [plain, varied] {
                let index = folder.join(index);
                if index.exists() {
                    return Self::of_index(folder, &index);
                }
            }
        }
        let there = |ending: &str| {
            let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
            entries
                .map(|e| e.file_name().to_string_lossy().into_owned())
                .any(|n| n.ends_with(ending))
        };
        let found = if !folder.is_dir() {
            "no folder"
        } else if there(".bin") || there(".ckpt") {
            "weights of another format"
        } else {
            "none"
        };
        Err(StableError::Folder {
            path: folder.to_owned(),
            expected: format!("{} or {}, whole or in shards", NAMES[0], NAMES[1]),
            found: found.into(),
        })
    }

    /// Opens one safetensors file. Reads its header only. Errors if it is damaged.
    pub fn of_file(path: &Path) -> Result<Self, StableError> {
        let (file, places) = WeightFile::open(path)?;
        Ok(Self {
            path: path.to_owned(),
            files: vec![file],
            places: places.into_iter().map(|(n, p)| (n, (0, p))).collect(),
        })
    }

    fn of_index(folder: &Path, index: &Path) -> Result<Self, StableError> {
        let map = read_json::<Index>(index, MOST_INDEX)?.weight_map;
        let refuse = |reason: String| StableError::Tensors {
            path: index.to_owned(),
            reason,
        };
        let names: BTreeSet<&String> = map.values().collect();
        let (mut files, mut places) = (Vec::new(), BTreeMap::new());
        for name in names {
            // A shard must lie beside its index.
            if name.contains(['/', '\\']) || name.starts_with('.') {
                return Err(refuse(format!(
                    "expected names of files beside it, found {name:?}"
                )));
            }
            let (file, found) = WeightFile::open(&folder.join(name))?;
            for (tensor, place) in found {
                if map.get(&tensor) == Some(name) {
                    places.insert(tensor, (files.len(), place));
                }
            }
            files.push(file);
        }
        let absent: Vec<String> = map.keys().filter(|n| !places.contains_key(*n)).cloned().collect();
        if !absent.is_empty() {
            let (n, names) = (absent.len(), first_of(&absent));
            let reason = format!("tensors: {n} not in the shards it names: {names}");
            return Err(refuse(reason));
        }
        Ok(Self {
            path: folder.to_owned(),
            files,
            places,
        })
    }

    /// The folder or file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Whether there is a tensor of this name.
    pub(crate) fn has(&self, name: &str) -> bool {
        self.places.contains_key(name)
    }

    /// Shape of a tensor; `None` if there is none of this name.
    pub(super) fn shape(&self, name: &str) -> Option<&[usize]> {
        self.places.get(name).map(|(_, p)| &*p.shape)
    }

    /// The network that `build` makes of the weights. `build` runs twice. The first time it gets placeholders, and all
    /// names, shapes and types that it asks for are compared with the files; only if they fit are tensors read.
    /// `ignored` are ends of names that may be left over. Errors list the first few names that are missing, misshapen
    /// or belong to another network, and give the number of the others.
    pub(crate) fn build<M>(
        &self,
        machine: &Machine,
        ignored: &[&str],
        build: impl Fn(&Names<'_>) -> Result<M, StableError>,
    ) -> Result<M, StableError> {
        self.check(ignored, &build)?;
        build(&Names::reading(self, machine))
    }

    /// Checks that `build` could be made of the weights, without reading any. Errors as [`build`](Self::build).
    pub(crate) fn check<M>(
        &self,
        ignored: &[&str],
        build: impl Fn(&Names<'_>) -> Result<M, StableError>,
    ) -> Result<(), StableError> {
        let asked = RequestedTensors::default();
        build(&Names::checking(self, &asked))?;
        self.compare(&asked, ignored)
    }

    /// Errors unless the tensors asked for are those in the files.
    fn compare(&self, asked: &RequestedTensors, ignored: &[&str]) -> Result<(), StableError> {
        let (mut missing, mut misshapen, mut mistyped) = (Vec::new(), Vec::new(), Vec::new());
        let mut taken = BTreeSet::new();
        for (name, expected) in asked.all() {
            taken.insert(name.clone());
            match self.places.get(&name) {
                None => missing.push(format!("{name} of shape {expected:?}")),
                Some((_, place)) if place.shape != expected => {
                    misshapen.push(format!("{name} is {:?}, expected {expected:?}", place.shape));
                }
                Some((_, place)) if type_of(place.dtype).is_none() => {
                    mistyped.push(format!("{name} is {:?}", place.dtype));
                }
                Some(_) => {}
            }
        }
        let is_foreign = |n: &&String| !taken.contains(*n) && !ignored.iter().any(|end| n.ends_with(end));
        let foreign: Vec<&String> = self.places.keys().filter(is_foreign).collect();
        let foreign: Vec<String> = foreign.into_iter().cloned().collect();
        let kinds = [
            (missing, "missing"),
            (misshapen, "misshapen"),
            (mistyped, "neither f16 nor bf16 nor f32"),
            (foreign, "not part of this network"),
        ];
        let wrong: Vec<_> = kinds.iter().filter(|(names, _)| !names.is_empty()).collect();
        if wrong.is_empty() {
            return Ok(());
        }
        // The faults come before the names: if the line is too long, its middle is left out.
        let counts = wrong
            .iter()
            .map(|(names, what)| format!("{} {what}", names.len()));
        let counts = counts.collect::<Vec<_>>().join(", ");
        let names = wrong.iter().map(|(names, _)| first_of(names));
        Err(StableError::Tensors {
            path: self.path.clone(),
            reason: format!("tensors: {counts}: {}", names.collect::<Vec<_>>().join("; ")),
        })
    }

    /// Reads one tensor onto a machine, in the machine's type. Errors if the file cannot be read, or a number is not
    /// finite.
    pub(super) fn read(&self, name: &str, machine: &Machine) -> Result<Tensor, StableError> {
        let refuse = |reason: String| StableError::Tensors {
            path: self.path.clone(),
            reason,
        };
        let Some((file, place)) = self.places.get(name) else {
            return Err(refuse(format!("1 tensor missing: {name}")));
        };
        let Some(dtype) = type_of(place.dtype) else {
            return Err(refuse(format!("{name} is {:?}", place.dtype)));
        };
        let file = &self.files[*file];
        let bytes = file.read(place)?;
        if let Some(index) = first_not_finite(&bytes, place.dtype) {
            let path = file.path().to_owned();
            let reason = format!("{name}: value {index} is not finite");
            return Err(StableError::Tensors { path, reason });
        }
        let tensor = Tensor::from_raw_buffer(&bytes, dtype, &place.shape, &candle_core::Device::Cpu)?;
        Ok(tensor.to_dtype(machine.dtype)?.to_device(&machine.device)?)
    }
}

/// The types that can be read; `None` for others.
fn type_of(dtype: Dtype) -> Option<DType> {
    match dtype {
        Dtype::F16 => Some(DType::F16),
        Dtype::BF16 => Some(DType::BF16),
        Dtype::F32 => Some(DType::F32),
        _ => None,
    }
}

/// Index of the first infinity or NaN: the exponent is all ones.
fn first_not_finite(bytes: &[u8], dtype: Dtype) -> Option<usize> {
    let short = |exponent: u16| {
        let mut pairs = bytes.chunks_exact(2);
        pairs.position(|b| u16::from_le_bytes([b[0], b[1]]) & exponent == exponent)
    };
    match dtype {
        Dtype::F16 => short(0x7c00),
        Dtype::BF16 => short(0x7f80),
        _ => {
            let exponent = 0x7f80_0000;
            let mut quads = bytes.chunks_exact(4);
            quads.position(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]) & exponent == exponent)
        }
    }
}

/// "a, b, c and 9 more".
fn first_of(names: &[String]) -> String {
    let listed = names[..names.len().min(LISTED)].join(", ");
    match names.len().saturating_sub(LISTED) {
        0 => listed,
        n => format!("{listed} and {n} more"),
    }
}
