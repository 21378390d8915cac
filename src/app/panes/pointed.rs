//! What the pointer is over.

use super::id::PaneId;

/// What the pointer is over.
#[derive(Clone, Debug, Default)]
pub struct Pointed {
    /// Pane under the pointer in the last frame.
    pub pane: Option<PaneId>,
    /// What that pane says about the place; shown in the status bar.
    pub readout: String,
}
