//! What a labelled frame does not carry, inferred from its voxels: a layout from the ground, boxes from
//! the objects. Guesses that a user can correct, good enough to edit from.

mod boxes;
mod ground;

pub use boxes::{boxes, boxes_around};
pub use ground::layout;
