//! How a scene changes: document, undo, picking, checks.

pub mod checks;
pub mod document;
pub mod edit;
pub mod immediate;
pub mod pick;
pub mod shape;

pub use document::{Document, Stale};
pub use edit::{Edit, EditError};
pub use shape::Shape;
