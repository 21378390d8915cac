//! Helpers for tests against the numbers of a network's twin in Python. These lie in training/weights; both sides make
//! their inputs alike.

use std::path::PathBuf;

use safetensors::{Dtype, SafeTensors};

/// Largest difference, as a share of the largest number of the twin.
pub const TOLERANCE: f64 = 1e-4;

/// A folder of training/weights.
pub struct Twin(pub &'static str);

impl Twin {
    /// A file of the folder.
    pub fn path(&self, name: &str) -> PathBuf {
        PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(format!("../../../training/weights/{}/{name}", self.0))
    }

    /// Numbers of the twin.
    pub fn numbers(&self, name: &str) -> Vec<f64> {
        let bytes = std::fs::read(self.path("golden.safetensors")).expect("the golden");
        let file = SafeTensors::deserialize(&bytes).expect("a safetensors file");
        let tensor = file.tensor(name).expect("a tensor of the golden");
        assert_eq!(tensor.dtype(), Dtype::F32, "{name}");
        let (quads, _) = tensor.data().as_chunks::<4>();
        quads.iter().map(|q| f64::from(f32::from_le_bytes(*q))).collect()
    }

    /// Prints the largest difference from the twin's numbers, and fails if it is too large.
    pub fn compare(&self, name: &str, found: &[f32]) {
        let gap = crate::golden::gap(found, &self.numbers(name));
        println!("{name}: {gap:.1e} of the largest number");
        assert!(gap <= TOLERANCE, "{name}: {gap}, expected at most {TOLERANCE}");
    }
}

/// Numbers from -1.75 to 1.75 as training/export.py makes them.
pub fn uniform(count: usize, stream: u64) -> Vec<f32> {
    let number = |i: u64| {
        let h = (i * 2_654_435_761 + stream * 40_503 + 12_345) % (1 << 32);
        let h = (h ^ (h >> 15)) * 2_246_822_519 % (1 << 32);
        (h as f64 / 4_294_967_296.0 * 3.5 - 1.75) as f32
    };
    (0..count as u64).map(number).collect()
}

/// Returns of a LiDAR around the origin; two are outside the window, two are not finite.
pub fn returns() -> Vec<[f32; 4]> {
    let numbers = uniform(400 * 4, 1);
    let (numbers, _) = numbers.as_chunks::<4>();
    let mut points: Vec<[f32; 4]> = numbers
        .iter()
        .map(|[x, y, z, strength]| [x * 1.25, y * 1.25, z * 3.0 + 1.0, strength * 64.0 + 120.0])
        .collect();
    points[0][0] = 40.0;
    points[1][1] = -41.0;
    points[2][2] = f32::NAN;
    points[3][3] = f32::INFINITY;
    points
}
