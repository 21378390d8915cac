//! Settings of the two large views, and the marks in them.

use std::sync::Arc;

use super::detection_marks::DetectionMarks;
use super::finding_marks::FindingMarks;
use super::look::Look;

/// Picture below the layers of the bird's-eye view.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Underlay {
    /// Layers only.
    Layout,
    /// The occupancy from above, layers off.
    Occupancy,
    /// The occupancy from above, under translucent layers.
    #[default]
    Both,
}

/// Settings and marks of the two large views.
#[derive(Clone, Debug)]
pub struct ViewsShown {
    /// What the 3D view shows the scene as.
    pub look: Look,
    /// Picture below the layers.
    pub underlay: Underlay,
    /// True: with boxes.
    pub boxes: bool,
    /// True: each box has a colour of its own instead of its class's.
    pub by_track: bool,
    /// True: with lane centres and dividers as lines.
    pub lines: bool,
    /// True: with the 10 m grid, in both views.
    pub grid: bool,
    /// True: with the LiDAR returns, in the bird's-eye view too.
    pub lidar_from_above: bool,
    /// True: with a tint over places that no sensor of the data set observed, in the bird's-eye view.
    pub unobserved: bool,
    /// Marks of the finding that is hovered or chosen in the list of checks; drawn in both views.
    pub finding_marks: Option<Arc<FindingMarks>>,
    /// Marks of a network's predictions, while their list is shown; drawn in both views.
    pub detection_marks: Option<Arc<DetectionMarks>>,
}

impl ViewsShown {
    /// What the 3D view shows from a viewpoint: orthographic views have no pictures.
    pub fn look_of(&self, camera: &viewport::ViewCamera) -> Look {
        match camera.ortho {
            true => Look::Voxels,
            false => self.look,
        }
    }
}

impl Default for ViewsShown {
    fn default() -> Self {
        Self {
            look: Look::Voxels,
            underlay: Underlay::Both,
            boxes: true,
            by_track: false,
            lines: true,
            grid: true,
            lidar_from_above: false,
            unobserved: false,
            finding_marks: None,
            detection_marks: None,
        }
    }
}
