//! The layout network.

pub mod input;
