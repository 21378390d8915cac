//! Measures the quality of what the program makes: suites over held-out worlds, for the command `sceneloom eval`. Nothing else
//! knows this room, so that a plain program does without it.

pub mod markdown;
pub mod options;
pub mod origin;
pub mod suite;
pub mod suites;
pub mod table;
