//! Sentences about scenery, as typed values. A clause is taken only if every word of it is known here and it names a
//! thing of the background; all other clauses are left to the two readers.

pub mod edits;
mod lexicon;
mod place;
mod read;
mod targets;
#[cfg(test)]
mod tests;
mod tokens;
pub mod wishes;

pub use ::place::beside_road::{Amount, NearTo, SceneryClause, SceneryKind, SideOf, Verb, Where};
pub use read::{SceneryClauses, blank, may_be_barrier, take};
