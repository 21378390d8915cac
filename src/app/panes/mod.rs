//! The panes of the window: one file each.

pub mod box_views;
mod camera_header;
pub mod cameras;
pub mod checks;
pub mod compare;
pub(crate) mod headers;
pub mod history;
mod label;
pub mod lidar;
pub mod lit;
pub mod objects;
pub mod prompt;
mod thing_list;
mod things;
pub mod tools;
pub mod trade;
pub mod versions;
