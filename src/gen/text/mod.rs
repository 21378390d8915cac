//! From words to a scene: prompt, structured description, scene graph, placement; and edits of an open scene by text.

mod again;
mod amounts;
mod back;
mod carried;
mod common;
mod compounds;
pub mod description;
pub mod edit;
mod edit_command;
mod edit_count;
mod edit_grammar;
mod edit_move;
mod edit_moving;
mod edit_place;
mod edit_settle;
mod ellipsis;
mod exchange;
mod existence;
mod finish;
mod foremost;
pub mod holds;
mod inferred_places;
mod inverted;
pub mod lanes;
pub mod lexicon;
mod measures;
mod mention;
mod order;
pub mod parse;
pub mod place;
mod reciprocal;
mod rephrase;
pub mod road;
mod said;
mod select;
mod spots;
mod spots_strips;
pub mod tag;
mod titles;
pub mod to_graph;
pub mod tokens;
mod wishes;
mod wording;
mod words;

pub use description::{Description, Reading};
pub use parse::read;

#[cfg(test)]
mod tests;
