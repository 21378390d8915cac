//! Theme, fonts, icons and small controls of the window, and drawing of the window by a software rasteriser.

pub mod chip;
mod damage;
pub mod fonts;
pub mod hint;
mod icon;
mod icon_shapes;
pub mod icons;
pub mod menu;
pub mod software_ui;
pub mod theme;
pub mod thumbnail;
