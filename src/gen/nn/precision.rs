//! Precision in which a network computes.

use serde::{Deserialize, Serialize};

/// Precision of the denoising network's products.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Precision {
    /// 32-bit numbers: the reference.
    #[default]
    F32,
    /// Eight bits with exact 32-bit sums: faster where the machine has AVX-512 VNNI, the same bits everywhere.
    Int8,
}
