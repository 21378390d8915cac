//! The window with its panes. It knows every other room; only the command line knows it.

mod baking;
pub mod batch;
mod bev_image;
pub mod camera_views;
pub mod canvas;
mod canvas_draw;
mod canvas_tools;
mod chosen;
pub mod capture;
pub mod clip_export;
pub mod command;
pub mod export;
pub(crate) mod fields;
mod finding_marks;
pub mod findings;
pub mod graphics;
mod map_edges;
mod marks;
pub mod paint;
pub mod panes;
pub mod picture;
mod pipeline;
pub mod playback;
mod pointer;
mod screen_map;
pub mod seen;
pub mod sensing;
pub mod shell;
pub mod state;
mod thing_outlines;
pub mod tools;
mod track_marks;
pub mod trade_plot;
pub mod truth;
mod unsettled_marks;
pub mod view3d;
pub mod views_shown;
pub mod windows;

pub use authoring::again::{again, scene_of};
pub use authoring::{memory, open, prompting, scenery, text};

pub use command::Command;
pub use panes::compare;
pub use shell::app::{AppConfig, BuildPipeline, NewScene, OpenScene, SaveScene, SceneloomApp};
pub use shell::run::{run_window, run_window_with};
pub use shell::{dock, keymap, live, recovery, settings};
