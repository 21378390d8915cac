//! Content and options of one picture.

use scene::Lattice;

use super::GROUND_TOP_M;
use scene::{BoxId, LidarSweep, SceneBox, SensorRig, VoxelGrid};

/// Background behind the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Background {
    /// Vertical gradient, sRGB.
    Gradient {
        /// At the upper edge.
        top: [u8; 3],
        /// At the lower edge.
        bottom: [u8; 3],
    },
    /// No background: alpha 0. Fog is off.
    Transparent,
}

impl Background {
    /// For a dark window.
    pub const DARK: Background = Background::Gradient {
        top: [58, 66, 80],
        bottom: [27, 30, 37],
    };
    /// For a light window.
    pub const LIGHT: Background = Background::Gradient {
        top: [206, 218, 231],
        bottom: [238, 240, 243],
    };
}

/// Where the layout is drawn as a plane on the ground.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LayoutPlane {
    /// Nowhere.
    Off,
    /// In columns without any voxel.
    WhereEmpty,
    /// Everywhere, over ground voxels too.
    Always,
}

/// Options of a picture: what is shown and how.
#[derive(Clone, Debug, PartialEq)]
pub struct ViewOptions {
    /// Show the occupancy.
    pub voxels: bool,
    /// Bit c hides class c.
    pub hidden_classes: u32,
    /// Hide voxels above this height, ego z, m; the bin that holds it stays.
    pub clip_above_m: Option<f64>,
    /// Thin lines between voxels.
    pub voxel_edges: bool,
    /// Sun shadows, and shading by how much of the sky a place sees.
    pub shadows: bool,
    /// Road markings of the layout on ground voxels.
    pub markings: bool,
    /// The layout as a plane.
    pub layout_plane: LayoutPlane,
    /// Opacity of that plane, 0 to 1.
    pub layout_opacity: f32,
    /// Boxes as wire frames.
    pub boxes: bool,
    /// A colour of its own for each box, by its number, in place of its class's.
    pub by_track: bool,
    /// How much lower than their height boxes, ego vehicle and cameras are drawn, m. The voxels' ground lies 0.6 m
    /// below the physical one ([`GROUND_TOP_M`]), so things that are lowered by that stand on the drawn road. Code that
    /// picks boxes in the view adds this to the ray's z first. 0 draws them at their height.
    pub drop_m: f64,
    /// LiDAR returns.
    pub lidar: bool,
    /// Size of a LiDAR return, pixels.
    pub point_px: f32,
    /// The ego vehicle.
    pub ego: bool,
    /// Frusta of the rig's cameras.
    pub frusta: bool,
    /// Lines on the ground every 10 m, and axes.
    pub grid_lines: bool,
    /// The background behind the scene.
    pub background: Background,
    /// Samples per pixel: 1, or 4 for smooth edges; other values mean 1.
    pub samples: u32,
    /// Physical pixels per point, for line widths.
    pub pixels_per_point: f32,
}

impl Default for ViewOptions {
    fn default() -> Self {
        Self {
            voxels: true,
            hidden_classes: 0,
            clip_above_m: None,
            voxel_edges: true,
            shadows: true,
            markings: true,
            layout_plane: LayoutPlane::WhereEmpty,
            layout_opacity: 0.9,
            boxes: true,
            by_track: false,
            drop_m: -GROUND_TOP_M,
            lidar: true,
            point_px: 2.5,
            ego: true,
            frusta: false,
            grid_lines: true,
            background: Background::DARK,
            samples: 4,
            pixels_per_point: 1.0,
        }
    }
}

/// Returns of a LiDAR with a colour each.
#[derive(Clone, Copy, Debug)]
pub struct LidarView<'a> {
    /// The returns.
    pub sweep: &'a LidarSweep,
    /// sRGB, one per return; see `lidar_colors`.
    pub colors: &'a [[u8; 4]],
}

/// Voxels under the brush or the pointer, or marked.
#[derive(Clone, Copy, Debug)]
pub struct MarkedVoxels<'a> {
    /// Voxel indices x, y, z; those outside of the grid are ignored.
    pub voxels: &'a [[usize; 3]],
    /// sRGB.
    pub color: [u8; 3],
}

/// Content of one picture, borrowed.
#[derive(Clone, Copy, Debug)]
pub struct ViewScene<'a> {
    /// Occupancy.
    pub grid: &'a VoxelGrid,
    /// Layout, one bit per layer, `[x][y]` of the grid's extent; of another size it shows nothing.
    pub bev: &'a [u32],
    /// Boxes; those with a [`SceneBox::problem`] are left out.
    pub boxes: &'a [&'a SceneBox],
    /// Selected boxes.
    pub selected: &'a [BoxId],
    /// Box under the pointer.
    pub hovered: Option<BoxId>,
    /// Voxels under the brush, or marked: one list for each colour.
    pub brush: &'a [MarkedVoxels<'a>],
    /// LiDAR returns.
    pub lidar: Option<LidarView<'a>>,
    /// Sensors and ego vehicle.
    pub rig: &'a SensorRig,
    /// Options: what is shown and how.
    pub options: &'a ViewOptions,
}

/// A usable [`ViewOptions::drop_m`].
pub(super) fn drop_m(lattice: Lattice, options: &ViewOptions) -> f64 {
    if lattice.lowered() == 0 {
        return 0.0; // the ground is drawn where it is
    }
    if options.drop_m.is_finite() {
        options.drop_m.clamp(-100.0, 100.0)
    } else {
        0.0
    }
}
