//! State of the window beside the document: the tool in hand, layers, options. Nothing here is saved with a scene.

use std::ops::{Deref, DerefMut};

use glam::DVec2;

use editor::Edit;
use editor::tools::saved::SavedBrush;
use job::Named;
use language::{t, tf};
use scene::SceneBox;

use super::camera_views::{CamerasShown, LidarShown};
use super::panes::comparing::Comparing;
use super::panes::pointed::Pointed;
use super::playback::Playback;
use super::seed_wish::SeedWish;
use super::tools::{Hand, ToolState};
use super::views_shown::ViewsShown;
use super::windows::open::OpenWindows;

/// State of the window.
#[derive(Clone, Debug, Default)]
pub struct UiState {
    /// Counts the scenes that were opened.
    pub opened: u64,
    /// The tools and what they hold: the state is a [`Hand`] with more.
    pub tools: ToolState,
    /// Brushes that the user keeps.
    pub brushes: Vec<SavedBrush>,
    /// What the two large views show of a scene.
    pub shown: ViewsShown,
    /// Edits of boxes and map layers correct what was inferred on import: no voxel changes.
    pub correcting: bool,
    /// Densities that generation is asked for.
    pub named: Named,
    /// The seed that it is asked for.
    pub seed: SeedWish,
    /// What the pictures of the cameras show.
    pub cameras: CamerasShown,
    /// What the LiDAR sweep shows.
    pub lidar: LidarShown,
    /// How the present state is compared with the version before.
    pub compare: Comparing,
    /// How a clip is played.
    pub playback: Playback,
    /// What the pointer is over.
    pub pointed: Pointed,
    /// Which windows are open.
    pub windows: OpenWindows,
}

impl UiState {
    /// The edits as they are; or as corrections while the user corrects what was inferred.
    pub fn as_meant(&self, edits: Vec<Edit>) -> Vec<Edit> {
        corrected(self.correcting, edits)
    }
}

/// The edits as they are; or, if that is asked for, those of boxes and layers as corrections of what was inferred.
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

/// What a box is called in the language that is shown: its name and paint, or its class.
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

/// Position for a person: `12.4, -3.0 m`.
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
