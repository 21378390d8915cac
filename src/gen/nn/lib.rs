//! Building blocks of networks: weight files, layers, and the processor's kernels.

mod cpu;
#[cfg(test)]
mod golden;
pub mod graph;
pub mod int8;
pub mod int8_attention;
pub mod kernels;
pub mod layers;
pub mod map;
pub mod ops;
pub mod packed_matrix;
mod precision;
pub mod ring;
pub mod rules;
pub mod sparse;
pub mod transformer;
mod view;
pub mod weights;

pub use cpu::Cpu;
pub use ops::Ops;
pub use precision::Precision;
