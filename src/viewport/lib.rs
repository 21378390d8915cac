//! Draws a scene with wgpu into its own colour and depth target, in the window and without one.
//!
//! [`Viewport::render`] draws only if something changed; [`Viewport::color_view`] is what the window
//! shows (an egui native texture) and [`Viewport::render_to_image`] what a screenshot saves. All
//! coordinates are in the ego frame, which is the world of this view. One drawable is one file here
//! and one shader of the same name in `shaders/`; they stand in one table, `drawable::all`.

pub mod appearance;
mod background;
mod camera;
mod change;
mod device;
mod drawable;
mod ego;
mod error;
mod faces;
mod ground;
mod image;
pub mod light;
mod lines;
mod marks;
pub mod meshing;
mod options;
mod points;
mod pool;
pub mod shaders;
mod shared;
pub mod splats;
mod target;
mod track_color;
pub mod ui_mesh;
mod view;
mod voxels;

pub use appearance::{APPEARANCE_UNIFORM_BYTES, AppearanceError, AppearanceRenderer};
pub use camera::{ViewCamera, ViewPreset};
pub use device::headless_device;
pub use error::ViewportError;
pub use image::MAX_SUPERSAMPLE;
pub use options::{Background, LayoutPlane, LidarView, MarkedVoxels, ViewOptions, ViewScene};
pub use points::{LidarColorMode, lidar_colors};
pub use shared::{COLOR_FORMAT, FRAME_UNIFORM_BYTES, FrameUniforms};
pub use splats::{SPLAT_UNIFORM_BYTES, SplatError, SplatRenderer};
pub use track_color::track_color;
pub use view::Viewport;

use scene::Lattice;

/// Top of the ground bin, m: where the drawn ground is, 0.6 m below the physical one.
pub const GROUND_TOP_M: f64 = Lattice::OCC3D.bottom_m() + Lattice::OCC3D.voxel_m();
