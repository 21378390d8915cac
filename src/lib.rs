//! Sceneloom: an interactive editor for driving scenes. The rooms and who may know whom are in README.md.

pub mod app;
pub mod editor;
pub mod formats;
#[path = "gen/mod.rs"] // `gen` is a reserved word in edition 2024
pub mod generation;
pub mod scene;
pub mod viewport;
