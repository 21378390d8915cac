//! Parts that a labelled frame does not carry, inferred from its voxels: a layout from the ground, boxes from the
//! objects, things from the scenery. Guesses that a user can correct, good enough to edit from.

mod background;
mod boxes;
mod ground;
mod relief;

pub use background::background;
pub use boxes::{boxes, boxes_around};
pub use ground::layout;
pub use relief::{relief, smooth_relief};
