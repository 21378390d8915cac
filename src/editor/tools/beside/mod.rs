//! The tools for things beside the road: buildings, trees, lines, shrubs, posts. Each file holds its draft and its row of
//! the table; `drawing` is the state machine that they share.

pub mod building;
mod choosing;
mod draft;
mod drawing;
pub mod line;
mod options;
pub mod post;
pub mod shrubs;
pub mod tree;
pub mod words;

pub use options::{ThingKind, ThingState};

pub(super) use draft::KERB_M;
use draft::{DraftResponse, GroundPointer, Phase, SceneryContext};
use drawing::{Coming, Draft, DraftTool};
