//! Actions of the tools and of the selection.

use super::Group::{Selection, Tools};
use super::{ActionDef, action};
use crate::command::Command;
use crate::state::{Tool, VoxelVerb};
use crate::tools::things::{ThingCommand, ThingTool};
use crate::tools::{PaintShape, ToolCommand, VoxelMode};
use editor::transform::Kind;

const fn raise(steps: i32) -> Command {
    Command::Tools(ToolCommand::Thing(ThingCommand::Raise(steps)))
}

/// Tools, then the selection.
pub(super) const ACTIONS: &[ActionDef] = &[
    action(Tools, "select_tool", "Select", "V", |_| {
        Some(Command::Tools(ToolCommand::Lasso(false)))
    }),
    action(Tools, "brush_tool", "Brush", "B", |_| {
        Some(Command::Tools(ToolCommand::Shape(PaintShape::Stroke)))
    }),
    action(Tools, "voxel_brush", "Voxel brush (over the 3D view)", "B", |s| {
        let tool = if s.tool == Tool::Voxel {
            Tool::Brush
        } else {
            Tool::Voxel
        };
        Some(Command::Tool(tool))
    })
    .over_3d(),
    action(Tools, "add_box_tool", "Add box", "A", |_| {
        Some(Command::Tool(Tool::AddBox))
    }),
    action(Tools, "brush_smaller", "Smaller brush", "[ {", |_| {
        Some(Command::BrushSize(-1))
    })
    .repeats(),
    action(Tools, "brush_larger", "Larger brush", "] }", |_| {
        Some(Command::BrushSize(1))
    })
    .repeats(),
    action(
        Tools,
        "toggle_erase",
        "Paint or erase (or hold Shift)",
        "E",
        |s| {
            s.erase = !s.erase;
            None
        },
    ),
    action(Tools, "voxel_attach", "Attach voxels", "T", |_| {
        Some(Command::Verb(VoxelVerb::Attach))
    }),
    action(Tools, "voxel_remove", "Remove voxels", "R", |_| {
        Some(Command::Verb(VoxelVerb::Remove))
    }),
    action(Tools, "voxel_recolour", "Recolour voxels", "Y", |_| {
        Some(Command::Verb(VoxelVerb::Recolour))
    }),
    action(Tools, "lasso", "Select by lasso", "O", |_| {
        Some(Command::Tools(ToolCommand::Lasso(true)))
    }),
    action(
        Tools,
        "rectangle_select",
        "Select by rectangle",
        "Shift+V",
        |_| Some(Command::Tools(ToolCommand::Lasso(false))),
    ),
    action(Tools, "measure_tool", "Measure", "M", |_| {
        Some(Command::Tool(Tool::Measure))
    }),
    action(Tools, "region_tool", "Region that is drawn anew", "N", |_| {
        Some(Command::Tool(Tool::Region))
    }),
    action(Tools, "building_tool", "Building", "Shift+B", |_| {
        Some(Command::Tool(Tool::Thing(ThingTool::Building)))
    }),
    action(Tools, "tree_tool", "Trees", "Shift+T", |_| {
        Some(Command::Tool(Tool::Thing(ThingTool::Tree)))
    }),
    action(
        Tools,
        "line_tool",
        "Hedge, wall, fence, guard rail",
        "Shift+L",
        |_| Some(Command::Tool(Tool::Thing(ThingTool::Line))),
    ),
    action(Tools, "shrub_tool", "Shrubs", "Shift+S", |_| {
        Some(Command::Tool(Tool::Thing(ThingTool::Shrubs)))
    }),
    action(
        Tools,
        "post_tool",
        "Pole, sign, light, bus stop, bench, bin",
        "Shift+P",
        |_| Some(Command::Tool(Tool::Thing(ThingTool::Post))),
    ),
    action(Tools, "shape_rectangle", "Brush: rectangle", "U", |_| {
        Some(Command::Tools(ToolCommand::Shape(PaintShape::Rectangle)))
    }),
    action(Tools, "shape_line", "Brush: line", "L", |_| {
        Some(Command::Tools(ToolCommand::Shape(PaintShape::Line)))
    }),
    action(
        Tools,
        "shape_polygon",
        "Brush: polygon; again: street",
        "P",
        |s| {
            let again = s.tool == Tool::Brush && s.tools.shape == PaintShape::Polygon;
            let shape = if again {
                PaintShape::Street
            } else {
                PaintShape::Polygon
            };
            Some(Command::Tools(ToolCommand::Shape(shape)))
        },
    ),
    action(Tools, "shape_street", "Brush: street", "", |_| {
        Some(Command::Tools(ToolCommand::Shape(PaintShape::Street)))
    }),
    action(Tools, "shape_fill", "Brush: fill", "K", |_| {
        Some(Command::Tools(ToolCommand::Shape(PaintShape::Fill)))
    }),
    action(
        Tools,
        "shape_pick",
        "Brush: pick a layer (or Alt+click)",
        "I",
        |_| Some(Command::Tools(ToolCommand::Shape(PaintShape::Pick))),
    ),
    action(Tools, "voxel_block", "Voxels: block", "U", |_| {
        Some(Command::Tools(ToolCommand::Voxels(VoxelMode::Block)))
    })
    .over_3d(),
    action(Tools, "voxel_row", "Voxels: row", "L", |_| {
        Some(Command::Tools(ToolCommand::Voxels(VoxelMode::Row)))
    })
    .over_3d(),
    action(Tools, "voxel_fill", "Voxels: flood", "K", |_| {
        Some(Command::Tools(ToolCommand::Voxels(VoxelMode::Fill)))
    })
    .over_3d(),
    action(Tools, "voxel_pull", "Voxels: pull a face", "P", |_| {
        Some(Command::Tools(ToolCommand::Voxels(VoxelMode::Extrude)))
    })
    .over_3d(),
    action(Tools, "voxel_wand", "Voxels: magic wand", "Shift+O", |_| {
        Some(Command::Tools(ToolCommand::Voxels(VoxelMode::Wand)))
    }),
    action(Tools, "symmetry", "Symmetry about the ego axis", "S", |_| {
        Some(Command::Tools(ToolCommand::Symmetry))
    }),
    action(
        Tools,
        "escape",
        "Cancel the drag, drop the selection",
        "Esc",
        |_| Some(Command::Escape),
    ),
    action(Selection, "delete", "Delete", "Del Backspace", |_| {
        Some(Command::Tools(ToolCommand::Delete))
    }),
    action(Selection, "duplicate", "Duplicate", "Ctrl+D", |_| {
        Some(Command::Tools(ToolCommand::Duplicate))
    }),
    action(Selection, "turn_left", "Turn left 1°", "Z", |_| {
        Some(Command::Tools(ToolCommand::Turn(1.0)))
    })
    .chosen()
    .repeats(),
    action(Selection, "turn_right", "Turn right 1°", "X", |_| {
        Some(Command::Tools(ToolCommand::Turn(-1.0)))
    })
    .chosen()
    .repeats(),
    action(Selection, "turn_left_far", "Turn left 15°", "Shift+Z", |_| {
        Some(Command::Tools(ToolCommand::Turn(15.0)))
    })
    .chosen()
    .repeats(),
    action(Selection, "turn_right_far", "Turn right 15°", "Shift+X", |_| {
        Some(Command::Tools(ToolCommand::Turn(-15.0)))
    })
    .chosen()
    .repeats(),
    action(Selection, "turn_90", "Turn 90°", "C", |_| {
        Some(Command::Tools(ToolCommand::Turn(90.0)))
    })
    .chosen(),
    action(Selection, "turn_180", "Turn 180°", "Q", |_| {
        Some(Command::Tools(ToolCommand::Turn(180.0)))
    })
    .chosen(),
    action(Selection, "select_all", "Select all boxes", "Ctrl+A", |_| {
        Some(Command::Tools(ToolCommand::ChooseAll))
    }),
    action(Selection, "select_none", "Select no box", "Ctrl+Shift+A", |_| {
        Some(Command::Tools(ToolCommand::ChooseNone))
    }),
    action(
        Selection,
        "select_others",
        "Invert the selection",
        "Ctrl+I",
        |_| Some(Command::Tools(ToolCommand::ChooseOthers)),
    ),
    action(Selection, "copy", "Copy", "Ctrl+C", |_| {
        Some(Command::Tools(ToolCommand::Copy))
    }),
    action(Selection, "cut", "Cut", "Ctrl+X", |_| {
        Some(Command::Tools(ToolCommand::Cut))
    }),
    action(Selection, "paste", "Paste at the pointer", "Ctrl+V", |_| {
        Some(Command::Tools(ToolCommand::Paste))
    }),
    action(Selection, "row", "Row of copies", "Ctrl+Shift+D", |_| {
        Some(Command::Tools(ToolCommand::AskRow))
    }),
    action(Selection, "mirror", "Mirror about the ego axis", "Ctrl+M", |_| {
        Some(Command::Tools(ToolCommand::Mirror(false)))
    }),
    action(Selection, "mirror_copies", "Mirrored copies", "", |_| {
        Some(Command::Tools(ToolCommand::Mirror(true)))
    }),
    action(
        Selection,
        "to_lane",
        "Boxes to the lane and the ground, things to the kerb",
        "D",
        |_| Some(Command::Tools(ToolCommand::ToLane)),
    )
    .chosen(),
    action(Selection, "to_ground", "To the ground", "Shift+D", |_| {
        Some(Command::Tools(ToolCommand::DropToGround))
    })
    .chosen(),
    action(
        Selection,
        "raise",
        "Raise things: a storey, or 0.5 m",
        "] }",
        |_| Some(raise(1)),
    )
    .things()
    .repeats(),
    action(
        Selection,
        "lower",
        "Lower things: a storey, or 0.5 m",
        "[ {",
        |_| Some(raise(-1)),
    )
    .things()
    .repeats(),
    action(Selection, "gizmo_move", "Dragging moves", "W", |_| {
        Some(Command::Tools(ToolCommand::Gizmo(Kind::Move)))
    })
    .chosen(),
    action(Selection, "gizmo_turn", "Dragging turns", "E", |_| {
        Some(Command::Tools(ToolCommand::Gizmo(Kind::Turn)))
    })
    .chosen(),
    action(Selection, "gizmo_scale", "Dragging scales", "R", |_| {
        Some(Command::Tools(ToolCommand::Gizmo(Kind::Scale)))
    })
    .chosen(),
    action(Selection, "next_box", "Next box", "J", |_| {
        Some(Command::SelectNext(1))
    }),
    action(Selection, "previous_box", "Previous box", "Shift+J", |_| {
        Some(Command::SelectNext(-1))
    }),
];
