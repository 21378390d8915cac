//! The lexicon's tables: what English words mean for a driving scene.

pub mod edits;
pub mod objects;
pub mod phrases;
pub mod places;
pub mod plain;
pub mod style;
pub mod verbs;
