//! Parity with diffusers and transformers on the models of `training/goldens_stable.py`, and what must hold besides. The largest
//! differences are printed as rows of a table: `cargo test --release -p sceneloom-stable --lib parity -- --nocapture`.

mod behaviour;
mod blocks;
mod damaged;
mod refusals;
mod ring;
mod runs;
mod schedules;
mod shapes;
mod speed;
mod words;

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use candle_core::{DType, Device, Tensor};
use safetensors::{Dtype, SafeTensors};

use crate::{Folders, Machine, Pipeline};

/// Largest difference from diffusers.
const TOLERANCE: f32 = 1e-3;

fn folder(model: &str) -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../tests/reference/stable");
    root.join(model)
}

fn opened(model: &str) -> Pipeline {
    Pipeline::open(&Folders::from_base(&folder(model)), &Machine::cpu())
        .unwrap_or_else(|e| panic!("{model}: {e}"))
}

/// Arrays by name.
struct Golden(HashMap<String, (Vec<usize>, Vec<f32>)>);

impl Golden {
    fn open(file: &str) -> Self {
        let bytes = std::fs::read(folder(file)).unwrap_or_else(|e| panic!("{file}: {e}"));
        let arrays = SafeTensors::deserialize(&bytes).expect("a safetensors file");
        let read = |name: &str| {
            let array = arrays.tensor(name).expect("a name of the file");
            let quads = array.data().chunks_exact(4).map(|b| [b[0], b[1], b[2], b[3]]);
            let numbers = match array.dtype() {
                Dtype::I32 => quads.map(|b| i32::from_le_bytes(b) as f32).collect(),
                _ => quads.map(f32::from_le_bytes).collect(),
            };
            (name.to_owned(), (array.shape().to_vec(), numbers))
        };
        Self(arrays.names().into_iter().map(read).collect())
    }

    fn numbers(&self, name: &str) -> &[f32] {
        &self.0.get(name).unwrap_or_else(|| panic!("no array {name}")).1
    }

    fn tensor(&self, name: &str) -> Tensor {
        let shape = self.0[name].0.as_slice();
        Tensor::from_slice(self.numbers(name), shape, &Device::Cpu).expect("numbers of that shape")
    }

    /// Prints a row of the table; fails if the difference is too large.
    fn compare(&self, model: &str, name: &str, found: &Tensor) {
        let expected = &self.0[name].0;
        assert_eq!(found.dims(), expected.as_slice(), "{name}");
        let flat = found
            .to_dtype(DType::F32)
            .and_then(|t| t.contiguous()?.flatten_all()?.to_vec1());
        self.compare_numbers(model, name, &flat.expect("numbers"));
    }

    fn compare_numbers(&self, model: &str, name: &str, found: &[f32]) {
        let off = largest_difference(found, self.numbers(name));
        println!("| {model} | {name} | {off:.1e} |");
        assert!(off <= TOLERANCE, "{model} {name}: {off}");
    }
}

fn largest_difference(a: &[f32], b: &[f32]) -> f32 {
    assert_eq!(a.len(), b.len());
    let off = a.iter().zip(b).map(|(a, b)| (a - b).abs());
    // A NaN is never within a tolerance.
    off.fold(
        0.0,
        |most, off| if off > most || off.is_nan() { off } else { most },
    )
}
