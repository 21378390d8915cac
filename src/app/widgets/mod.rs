//! Small parts that several panes and windows draw.

pub(crate) mod chip;
pub mod fields;
mod icon;
mod icon_shapes;
pub(crate) mod icons;
pub(crate) mod thumbnail;
