//! Reads reference vectors for the tests of this crate: f32 inputs, f64 expected outputs.

use safetensors::{Dtype, SafeTensors};

/// A reference file of tests/reference.
pub struct Golden(Vec<u8>);

impl Golden {
    /// Network blocks computed by torch 2.15.0 in float64; tolerances in design's reference/nn.json.
    pub fn nn() -> Self {
        let path =
            std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../tests/reference/nn.safetensors");
        Self(std::fs::read(path).expect("tests/reference/nn.safetensors"))
    }

    fn values<const N: usize>(&self, name: &str, dtype: Dtype) -> Vec<[u8; N]> {
        let file = SafeTensors::deserialize(&self.0).expect("a safetensors file");
        let tensor = file.tensor(name).expect("a tensor of the reference");
        assert_eq!(tensor.dtype(), dtype, "{name}");
        tensor
            .data()
            .chunks_exact(N)
            .map(|b| b.try_into().expect("N bytes"))
            .collect()
    }

    /// An input.
    pub fn f32(&self, name: &str) -> Vec<f32> {
        self.values(name, Dtype::F32)
            .into_iter()
            .map(f32::from_le_bytes)
            .collect()
    }

    /// An expected output.
    pub fn f64(&self, name: &str) -> Vec<f64> {
        self.values(name, Dtype::F64)
            .into_iter()
            .map(f64::from_le_bytes)
            .collect()
    }
}

/// Largest difference, relative to the largest expected value.
#[allow(dead_code, reason = "only the tests of nets need it")]
pub fn gap(found: &[f32], truth: &[f64]) -> f64 {
    assert_eq!(found.len(), truth.len());
    let scale = truth.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
    found
        .iter()
        .zip(truth)
        .map(|(f, t)| (f64::from(*f) - t).abs())
        .fold(0.0, f64::max)
        / scale
}
