//! Small parts that several panes and windows draw.

pub(crate) mod chip;
pub mod fields;
pub mod hint;
mod icon;
mod icon_shapes;
pub(crate) mod icons;
pub(crate) mod thumbnail;
