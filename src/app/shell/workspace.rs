//! The ready-made arrangements of panes, by name; `dock.rs` defines them.

use serde::{Deserialize, Serialize};

/// An arrangement of panes for one kind of work.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Workspace {
    /// Bird's-eye view and 3D view side by side, cameras below.
    #[default]
    Edit,
    /// A large bird's-eye view.
    Paint,
    /// A large 3D view.
    Voxels,
    /// Six cameras and the unrolled LiDAR sweep.
    Sensors,
    /// The chosen box from three sides, beside bird's-eye and 3D view.
    Label,
    /// The timeline below the views, and the cameras.
    Clip,
    /// The quality slider and its measurements beside the views.
    Trade,
}

impl Workspace {
    /// Every workspace with its name.
    pub const ALL: [(Workspace, &'static str); 7] = [
        (Workspace::Edit, "Edit"),
        (Workspace::Paint, "Paint"),
        (Workspace::Voxels, "Voxels"),
        (Workspace::Sensors, "Sensors"),
        (Workspace::Label, "Label"),
        (Workspace::Clip, "Clip"),
        (Workspace::Trade, "Trade"),
    ];
}
