//! The layout network.

pub mod input;
pub mod net;
