//! The panels around the views: each draws from values and pushes commands.

pub mod box_views;
pub mod camera_header;
pub mod cameras;
pub mod checks;
mod chip;
pub mod dialogs;
pub mod export;
pub mod fields;
pub mod layers;
pub mod lidar_sweep;
pub mod lit;
pub mod objects;
pub mod palette;
pub mod panes;
pub mod performance;
pub mod prompt;
pub mod prompt_plan;
pub mod recovery;
pub mod sensors;
pub mod settings;
pub mod shortcuts;
pub mod start;
pub mod status;
pub mod toasts;
pub mod toolbar;
pub mod trade;
pub mod versions;
