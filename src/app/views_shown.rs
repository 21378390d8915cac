//! What the two large views show of a scene, and what they mark in it.

use std::sync::Arc;

use super::detection_marks::DetectionMarks;
use super::finding_marks::FindingMarks;

/// What lies under the layers of the bird's-eye view.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Underlay {
    /// Layers only.
    Layout,
    /// The occupancy from above, layers off.
    Occupancy,
    /// Both, the layers translucent.
    #[default]
    Both,
}

/// What is shown.
#[derive(Clone, Debug)]
pub struct ViewsShown {
    /// What lies under the layers.
    pub underlay: Underlay,
    /// Boxes.
    pub boxes: bool,
    /// A colour of its own for each box, in place of its class's.
    pub by_track: bool,
    /// Lane centres and dividers as lines.
    pub lines: bool,
    /// The 10 m grid, in both views.
    pub grid: bool,
    /// The LiDAR returns in the bird's-eye view too.
    pub lidar_from_above: bool,
    /// A tint where no sensor of the data set observed anything, in the bird's-eye view.
    pub unobserved: bool,
    /// Marks of the finding that is pointed at or chosen in the list of checks; drawn in both views.
    pub finding_marks: Option<Arc<FindingMarks>>,
    /// What the LiDAR's network sees, while its list is shown; drawn in both views.
    pub detection_marks: Option<Arc<DetectionMarks>>,
}

impl Default for ViewsShown {
    fn default() -> Self {
        Self {
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
