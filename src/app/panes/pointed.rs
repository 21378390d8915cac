//! The pane and the place under the pointer.

use glam::DVec3;

use super::id::PaneId;

/// The pane and the place under the pointer.
#[derive(Clone, Debug, Default)]
pub struct Pointed {
    /// Pane under the pointer in the last frame.
    pub pane: Option<PaneId>,
    /// The pane's text about the place, for the status bar.
    pub readout: String,
    /// The place under the pointer (world frame, m) and the pane that reported it, as of the last frame.
    pub place: Option<(PaneId, DVec3)>,
    /// The place and its pane in the frame that is being drawn.
    pub place_now: Option<(PaneId, DVec3)>,
}
