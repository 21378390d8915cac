//! How a scene changes: document, undo, picking, checks, and the arithmetic of the tools.

pub mod arrange;
pub mod checks;
pub mod choose;
pub mod document;
pub mod edit;
pub mod flood;
pub mod immediate;
mod junction;
pub mod kerb;
pub mod lane_strip;
pub mod lanes;
pub mod measure;
pub mod outline;
pub mod part;
pub mod pick;
pub mod pick_things;
pub mod shape;
mod things;
pub mod tools;
pub mod transform;
pub mod voxel_ops;

pub use document::{Document, Stale};
pub use edit::{Edit, EditError};
pub use part::Part;
pub use shape::Shape;
pub use things::columns_between;
