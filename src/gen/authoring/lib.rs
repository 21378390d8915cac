//! How a scene comes to be: from a file, a template, words, with what stands beside its roads. The window, the command line
//! and the judge share it.

pub mod memory;
pub mod open;
pub mod prompting;
pub mod roads;
pub mod scenery;
pub mod scenery_around;
pub mod text;
