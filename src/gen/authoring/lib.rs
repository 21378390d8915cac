//! Makes scenes: from a file, a template or words, and with scenery beside the roads. The window, the command line and the
//! judge use it.

mod afterwards;
pub mod again;
pub mod corner_case;
pub mod drives;
mod in_motion;
pub mod large;
pub mod memory;
pub mod new_ground;
pub mod open;
pub mod prompting;
pub mod read;
pub mod roads;
pub mod scenery;
pub mod scenery_around;
pub mod text;
mod tracks;
pub mod whole;
pub mod wildcards;

#[cfg(test)]
mod traffic_tests;
