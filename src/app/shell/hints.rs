//! Hint in the status bar: the effect of the pointer with the tool in hand.

use editor::tools::{ViewKind, hint_of, select};
use language::t;

use crate::panes::id::PaneId;
use crate::state::UiState;

/// The hint as one line: buttons and held keys for the view under the pointer.
pub fn hint(state: &UiState) -> String {
    if state.compare.holding_reference {
        return t("The state before; nothing can be changed while the key is held").into();
    }
    let told = state
        .shown
        .detection_marks
        .as_ref()
        .is_some_and(|m| m.told.is_some());
    if told && state.pointed.pane == Some(PaneId::VIEW3D) && state.tool != select::ID {
        return t("These voxels are what the network tells: no tool changes them. The pane Perception shows the scene's again").into();
    }
    let view = match state.pointed.pane {
        Some(PaneId::VIEW3D) => Some(ViewKind::Space),
        Some(PaneId::BEV) => Some(ViewKind::Bev),
        _ => None,
    };
    let mut parts = state.tools.toolbox.tool(state.tool).hint(state, view);
    parts.extend(hint_of(match view {
        Some(ViewKind::Space) => &["Middle orbits", "Right flies", "Wheel zooms"],
        Some(ViewKind::Bev) => &["Middle pans", "Wheel zooms"],
        None => &[],
    }));
    let parts: Vec<&str> = parts.iter().map(|part| t(part)).collect();
    parts.join("  ·  ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use editor::tools::{PaintShape, VoxelMode, all, brush, voxel};

    #[test]
    fn every_tool_says_what_the_buttons_do() {
        let mut state = UiState::default();
        let mut seen = std::collections::BTreeSet::new();
        for pane in [PaneId::BEV, PaneId::VIEW3D] {
            state.pointed.pane = Some(pane);
            for tool in all() {
                state.tool = tool.id;
                let text = hint(&state);
                assert!((20..140).contains(&text.chars().count()), "{text}");
                assert!(seen.insert((pane, text)), "two tools say the same");
            }
        }
        state.tool = brush::ID;
        for (shape, ..) in PaintShape::ALL {
            state.tools.shape = shape;
            let text = (PaneId::VIEW3D, hint(&state));
            assert!(seen.insert(text) || shape == PaintShape::Stroke);
        }
        state.tool = voxel::ID;
        for (mode, ..) in VoxelMode::ALL {
            state.tools.voxel_mode = mode;
            let text = (PaneId::VIEW3D, hint(&state));
            assert!(seen.insert(text) || mode == VoxelMode::Brush);
        }
    }
}
