//! State of the window besides the document: the tool in hand, layers, options. It is never saved with a scene.

use std::ops::{Deref, DerefMut};

use glam::DVec2;

use editor::Edit;
use editor::tools::saved::SavedBrush;
use job::ChosenDensities;
use language::{t, tf};
use scene::SceneBox;

use super::camera_views::{CamerasShown, LidarShown, RadarShown};
use super::panes::comparing::CompareSettings;
use super::panes::pointed::Pointed;
use super::playback::Playback;
use super::seed_wish::SeedWish;
use super::tools::{Hand, ToolState};
use super::views_shown::ViewsShown;
use super::windows::open::OpenWindows;

/// State of the window.
#[derive(Clone, Debug, Default)]
pub struct UiState {
    /// Number of scenes that were opened.
    pub opened: u64,
    /// The tools and their state; this state dereferences to their [`Hand`].
    pub tools: ToolState,
    /// Brushes saved by the user.
    pub brushes: Vec<SavedBrush>,
    /// Settings of the two large views, and their marks.
    pub shown: ViewsShown,
    /// True if edits of boxes and map layers correct values inferred on import, without changing voxels.
    pub correcting: bool,
    /// Densities that the user set for generation.
    pub named: ChosenDensities,
    /// The seed that the user set for generation.
    pub seed: SeedWish,
    /// Settings of the camera pictures.
    pub cameras: CamerasShown,
    /// Settings of the LiDAR sweep.
    pub lidar: LidarShown,
    /// Settings of the radar scans.
    pub radar: RadarShown,
    /// How the present state is compared with another version.
    pub compare: CompareSettings,
    /// Settings and state of the playback.
    pub playback: Playback,
    /// The pane and the place under the pointer.
    pub pointed: Pointed,
    /// The windows that are open.
    pub windows: OpenWindows,
}

impl UiState {
    /// The edits, turned into corrections while the user corrects inferred values.
    pub fn as_meant(&self, edits: Vec<Edit>) -> Vec<Edit> {
        corrected(self.correcting, edits)
    }
}

/// The edits; with `correcting`, those of boxes and layers are turned into corrections of inferred values.
pub(crate) fn corrected(correcting: bool, edits: Vec<Edit>) -> Vec<Edit> {
    let authored = |edit: &Edit| {
        matches!(
            edit,
            Edit::AddBox { .. }
                | Edit::RemoveBox { .. }
                | Edit::MoveBox { .. }
                | Edit::SetBoxClass { .. }
                | Edit::PaintBev { .. }
        )
    };
    let meant = |edit: Edit| match correcting && authored(&edit) {
        true => Edit::Correct { edit: Box::new(edit) },
        false => edit,
    };
    edits.into_iter().map(meant).collect()
}

impl Deref for UiState {
    type Target = Hand;

    fn deref(&self) -> &Hand {
        &self.tools.hand
    }
}

impl DerefMut for UiState {
    fn deref_mut(&mut self) -> &mut Hand {
        &mut self.tools.hand
    }
}

/// The name of a box in the language of the interface: its paint, if any, with its name or else its class.
pub fn called(b: &SceneBox) -> String {
    let class = b.class.label();
    let name = match b.label.name.is_empty() {
        true => t(&class),
        false => b.label.name.as_str(),
    };
    match b.label.paint {
        Some(paint) => tf!("{paint} {name}", paint = t(paint.name()), name = name),
        None => name.to_owned(),
    }
}

/// A position for the user, for example `12.4, -3.0 m`.
pub fn position_text(p_m: DVec2) -> String {
    // Adding 0 turns -0 into 0.
    let tidy = |v: f64| (v * 10.0).round() / 10.0 + 0.0;
    format!("{:.1}, {:.1} m", tidy(p_m.x), tidy(p_m.y))
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::{BoxId, Class};

    #[test]
    fn while_correcting_boxes_and_layers_change_no_voxel() {
        let remove = Edit::RemoveBox { id: BoxId(3) };
        let voxels = Edit::PaintVoxels {
            cells: vec![[1, 2, 3]],
            class: Class::Car,
        };
        let mut ui = UiState::default();
        let edits = vec![remove.clone(), voxels.clone()];
        assert_eq!(ui.as_meant(edits.clone()), edits);
        ui.correcting = true;
        let corrected = Edit::Correct {
            edit: Box::new(remove),
        };
        assert_eq!(ui.as_meant(edits), [corrected, voxels]);
    }

    #[test]
    fn positions_have_no_negative_zero() {
        assert_eq!(position_text(DVec2::new(-0.01, 3.12)), "0.0, 3.1 m");
    }
}
