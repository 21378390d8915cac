//! The calls, one file per kind.

pub mod apply;
pub mod check;
pub mod diff;
pub mod export;
pub mod files;
pub mod generate;
pub mod history;
mod names;
pub mod new;
pub mod open;
pub mod place_model;
pub mod prompt;
pub mod render;
pub mod save;
pub mod show;
pub mod state;
pub mod tracks;
pub mod versions;
