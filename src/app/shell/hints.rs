//! What the pointer does with the tool in hand, for the status bar.

use crate::panes::id::PaneId;
use crate::state::{Tool, UiState, VoxelVerb};
use crate::tools::things::ThingTool;
use crate::tools::{PaintShape, RegionShape, VoxelMode};
use editor::transform::Kind;

/// One line: buttons and held keys, as they count in the view under the pointer.
pub fn hint(state: &UiState) -> String {
    if state.holding_before {
        return "The state before; nothing can be changed while the key is held".into();
    }
    let over_3d = state.hovered_pane == Some(PaneId::VIEW3D);
    let mut parts: Vec<&str> = match state.tool {
        Tool::Select => select(state, over_3d),
        Tool::Brush => brush(state),
        Tool::AddBox => vec!["Click places a box", "drag sets its heading"],
        Tool::Voxel if over_3d => voxels(state),
        Tool::Voxel => vec!["The voxel tool works in the 3D view"],
        Tool::Measure if over_3d => vec!["Measures in the bird's-eye view"],
        Tool::Measure => vec!["Click sets a point", "Esc clears"],
        Tool::Thing(tool) => thing(state, tool, over_3d),
        Tool::Region if over_3d => vec!["The region is marked in the bird's-eye view"],
        Tool::Region => vec![
            match state.tools.region_shape {
                RegionShape::Brush => "Drag paints the mark",
                RegionShape::Lasso => "Drag marks what it goes around",
                RegionShape::Rectangle => "Drag marks a rectangle",
            },
            "Shift takes away",
        ],
    };
    parts.extend(match state.hovered_pane {
        Some(PaneId::VIEW3D) => &["Middle orbits", "Right flies", "Wheel zooms"][..],
        Some(PaneId::BEV) => &["Middle pans", "Wheel zooms"],
        _ => &[],
    });
    parts.join("  ·  ")
}

fn select(state: &UiState, over_3d: bool) -> Vec<&'static str> {
    let mut parts = match state.tools.lasso {
        true => vec!["Drag draws around boxes", "Shift adds"],
        false => vec!["Click chooses", "Shift adds", "drag over ground marks"],
    };
    if state.selected.is_none() && !state.tools.things.chosen.is_empty() {
        parts.push("Drag moves");
        parts.push(if over_3d { "the knob raises" } else { "[ ] raise" });
        parts.push("D to the kerb");
    }
    if state.selected.is_some() {
        parts.push(match state.tools.gizmo {
            Kind::Move => "Drag moves, X Y Z keep an axis, digits type",
            Kind::Turn => "Drag turns, Shift in steps",
            Kind::Scale => "Drag scales",
        });
        if !over_3d {
            parts.push("Ctrl snaps to the grid");
        }
    }
    parts
}

fn thing(state: &UiState, tool: ThingTool, over_3d: bool) -> Vec<&'static str> {
    let things = &state.tools.things;
    if !things.is_open() {
        return vec!["Background things are locked or hidden: see the list of layers"];
    }
    let drawn = !things.draft.points_m().is_empty();
    let mut parts = match tool {
        ThingTool::Building if drawn => vec!["Click sets a corner", "Enter closes", "Backspace takes back"],
        ThingTool::Building => vec!["Drag draws a rectangle", "click begins an outline"],
        ThingTool::Tree => vec!["Click stamps a tree", "drag scatters"],
        ThingTool::Line => vec!["Click sets a point", "Enter ends", "Backspace takes back"],
        ThingTool::Shrubs => vec!["Drag paints an area of shrubs", "[ ] size"],
        ThingTool::Post => vec!["Click puts it down facing the road", "drag turns it"],
    };
    parts.extend(match (tool, over_3d) {
        (ThingTool::Building, false) => Some("Alt ignores the road"),
        (ThingTool::Line | ThingTool::Post, false) => Some("Alt ignores the kerb"),
        _ => None,
    });
    parts
}

fn brush(state: &UiState) -> Vec<&'static str> {
    let erase = if state.erase { "Drag erases" } else { "Drag paints" };
    match state.tools.shape {
        PaintShape::Stroke => vec![erase, "Shift erases", "Ctrl straight", "Alt picks", "[ ] size"],
        PaintShape::Line => vec![erase, "Shift in steps of 15°", "[ ] size"],
        PaintShape::Rectangle => vec![erase, "Shift erases", "Alt picks"],
        PaintShape::Polygon => vec!["Click sets corners", "Enter closes", "Backspace takes back"],
        PaintShape::Street => vec!["Click sets points", "Enter builds", "Backspace takes back"],
        PaintShape::Fill => vec!["Click fills what is alike", "Shift erases", "Alt picks"],
        PaintShape::Pick => vec!["Click takes the layer"],
    }
}

fn voxels(state: &UiState) -> Vec<&'static str> {
    let verb = match state.verb {
        VoxelVerb::Attach => "Drag attaches",
        VoxelVerb::Remove => "Drag removes",
        VoxelVerb::Recolour => "Drag recolours",
    };
    match state.tools.voxel_mode {
        VoxelMode::Brush => vec![verb, "Shift removes", "Alt picks", "[ ] size"],
        VoxelMode::Block => vec![verb, "wheel sets the height"],
        VoxelMode::Row => vec![verb, "Shift removes"],
        VoxelMode::Fill => vec!["Click floods one class", "Shift removes"],
        VoxelMode::Wand => vec!["Click chooses what is connected", "Shift adds", "Del removes"],
        VoxelMode::Extrude => vec!["Drag pulls a face out or in"],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_tool_says_what_the_buttons_do() {
        let mut state = UiState::default();
        let mut seen = std::collections::BTreeSet::new();
        for pane in [PaneId::BEV, PaneId::VIEW3D] {
            state.hovered_pane = Some(pane);
            for (tool, ..) in Tool::ALL {
                state.tool = tool;
                let text = hint(&state);
                assert!((20..140).contains(&text.chars().count()), "{text}");
                assert!(seen.insert(text), "two tools say the same");
            }
        }
        state.tool = Tool::Brush;
        for (shape, ..) in PaintShape::ALL {
            state.tools.shape = shape;
            assert!(seen.insert(hint(&state)) || shape == PaintShape::Stroke);
        }
        state.tool = Tool::Voxel;
        for (mode, ..) in VoxelMode::ALL {
            state.tools.voxel_mode = mode;
            assert!(seen.insert(hint(&state)) || mode == VoxelMode::Brush);
        }
    }
}
