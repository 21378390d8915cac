//! The window's look: colours and fonts, icons, small controls, and how it is drawn where the processor draws.

pub mod chip;
mod damage;
pub mod hint;
mod icon;
mod icon_shapes;
pub mod icons;
pub mod software_ui;
pub mod theme;
pub mod thumbnail;
