//! Weights as diffusers keeps them: folders of safetensors files, whole or in shards.
//!
//! Files are read tensor by tensor at their offsets, not mapped into memory. A map would need `unsafe` (if somebody
//! changes a file under a map, behaviour is undefined) and would gain nothing: every tensor is read once, converted
//! once, and then lies in its own memory, so at most one tensor is held twice.

mod file;
mod folder;
mod names;

pub use folder::Weights;
pub(crate) use names::Names;
