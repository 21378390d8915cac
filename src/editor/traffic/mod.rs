//! Motions by template: an object or the ego vehicle drives along its lane, stops, cuts in, crosses, pulls out, parks or
//! follows the one ahead.

pub(crate) mod everybody;
pub mod follow;
pub mod gap;
pub mod lane_path;
pub mod template;
mod turning;

pub use scene::clip::Template;
pub use template::{Wish, motion_of, shown};
