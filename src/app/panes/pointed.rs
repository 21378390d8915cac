//! What the pointer is over.

use glam::DVec3;

use super::id::PaneId;

/// What the pointer is over.
#[derive(Clone, Debug, Default)]
pub struct Pointed {
    /// Pane under the pointer in the last frame.
    pub pane: Option<PaneId>,
    /// What that pane says about the place; shown in the status bar.
    pub readout: String,
    /// The place under the pointer (world frame, m) and the pane that has it there, as of the last frame.
    pub place: Option<(PaneId, DVec3)>,
    /// The same, of the frame that is being drawn.
    pub place_now: Option<(PaneId, DVec3)>,
}
