//! Actions that many tools share, and actions of the selection.

use glam::DVec2;

use scene::Arrangement;

use super::ActionGroup::{Selection, Tools};
use super::{ActionDef, action};
use crate::command::Command;
use crate::map_edges::extend;
use crate::tools::ToolCommand;
use crate::tools::things::ThingCommand;

const fn arrange(how: Arrangement) -> Command {
    Command::Tools(ToolCommand::Arrange(how))
}

const fn raise(steps: i32) -> Command {
    Command::Tools(ToolCommand::Thing(ThingCommand::Raise(steps)))
}

/// Actions that belong to no single tool: of tools, then of the selection.
pub(super) const ACTIONS: &[ActionDef] = &[
    action(Tools, "brush_smaller", "Smaller brush", "[", || {
        Command::BrushSize(-1)
    })
    .repeats(),
    action(Tools, "brush_larger", "Larger brush", "]", || {
        Command::BrushSize(1)
    })
    .repeats(),
    action(Tools, "paint_1", "Paint with layer or class 1", "1", || {
        Command::PaintWith(0)
    })
    .painting(),
    action(Tools, "paint_2", "Paint with layer or class 2", "2", || {
        Command::PaintWith(1)
    })
    .painting(),
    action(Tools, "paint_3", "Paint with layer or class 3", "3", || {
        Command::PaintWith(2)
    })
    .painting(),
    action(Tools, "paint_4", "Paint with layer or class 4", "4", || {
        Command::PaintWith(3)
    })
    .painting(),
    action(Tools, "paint_5", "Paint with layer or class 5", "5", || {
        Command::PaintWith(4)
    })
    .painting(),
    action(Tools, "paint_6", "Paint with layer or class 6", "6", || {
        Command::PaintWith(5)
    })
    .painting(),
    action(Tools, "paint_7", "Paint with layer or class 7", "7", || {
        Command::PaintWith(6)
    })
    .painting(),
    action(Tools, "paint_8", "Paint with layer or class 8", "8", || {
        Command::PaintWith(7)
    })
    .painting(),
    action(Tools, "paint_9", "Paint with layer or class 9", "9", || {
        Command::PaintWith(8)
    })
    .painting(),
    action(Tools, "paint_0", "Paint with layer or class 10", "0", || {
        Command::PaintWith(9)
    })
    .painting(),
    action(
        Tools,
        "paint_last",
        "Paint with the layer or class before this one",
        "X",
        || Command::PaintWithLast,
    )
    .painting(),
    action(Tools, "brush_lower", "Lower voxel brush", "Shift+[ {", || {
        Command::BrushHeight(-1)
    })
    .repeats(),
    action(Tools, "brush_higher", "Higher voxel brush", "Shift+] }", || {
        Command::BrushHeight(1)
    })
    .repeats(),
    action(
        Tools,
        "escape",
        "Cancel the drag, drop the selection",
        "Esc",
        || Command::Escape,
    ),
    action(Tools, "extend_ahead", "Extend the map ahead by 40 m", "", || {
        Command::Apply("Extend the map", vec![extend(DVec2::X, 40.0)])
    }),
    action(
        Tools,
        "extend_behind",
        "Extend the map behind by 40 m",
        "",
        || Command::Apply("Extend the map", vec![extend(DVec2::NEG_X, 40.0)]),
    ),
    action(
        Tools,
        "extend_left",
        "Extend the map to the left by 40 m",
        "",
        || Command::Apply("Extend the map", vec![extend(DVec2::Y, 40.0)]),
    ),
    action(
        Tools,
        "extend_right",
        "Extend the map to the right by 40 m",
        "",
        || Command::Apply("Extend the map", vec![extend(DVec2::NEG_Y, 40.0)]),
    ),
    action(Selection, "delete", "Delete", "Del Backspace", || {
        Command::Tools(ToolCommand::Delete)
    }),
    action(Selection, "duplicate", "Duplicate", "Ctrl+D", || {
        Command::Tools(ToolCommand::Duplicate)
    }),
    action(Selection, "turn_left", "Turn left 1°", "Z", || {
        Command::Tools(ToolCommand::Turn(1.0))
    })
    .chosen()
    .repeats(),
    action(Selection, "turn_right", "Turn right 1°", "X", || {
        Command::Tools(ToolCommand::Turn(-1.0))
    })
    .chosen()
    .repeats(),
    action(Selection, "turn_left_far", "Turn left 15°", "Shift+Z", || {
        Command::Tools(ToolCommand::Turn(15.0))
    })
    .chosen()
    .repeats(),
    action(Selection, "turn_right_far", "Turn right 15°", "Shift+X", || {
        Command::Tools(ToolCommand::Turn(-15.0))
    })
    .chosen()
    .repeats(),
    action(Selection, "turn_90", "Turn 90°", "C", || {
        Command::Tools(ToolCommand::Turn(90.0))
    })
    .chosen(),
    action(Selection, "turn_180", "Turn 180°", "Q", || {
        Command::Tools(ToolCommand::Turn(180.0))
    })
    .chosen(),
    action(Selection, "select_all", "Select all boxes", "Ctrl+A", || {
        Command::Tools(ToolCommand::ChooseAll)
    }),
    action(Selection, "select_none", "Select no box", "Ctrl+Shift+A", || {
        Command::Tools(ToolCommand::ChooseNone)
    }),
    action(
        Selection,
        "select_others",
        "Invert the selection",
        "Ctrl+I",
        || Command::Tools(ToolCommand::ChooseOthers),
    ),
    action(Selection, "copy", "Copy", "Ctrl+C", || {
        Command::Tools(ToolCommand::Copy)
    }),
    action(Selection, "cut", "Cut", "Ctrl+X", || {
        Command::Tools(ToolCommand::Cut)
    }),
    action(Selection, "paste", "Paste at the pointer", "Ctrl+V", || {
        Command::Tools(ToolCommand::Paste)
    }),
    action(Selection, "group", "Group", "Ctrl+G", || {
        arrange(Arrangement::Group {
            name: Default::default(),
        })
    }),
    action(Selection, "ungroup", "Ungroup", "Ctrl+Shift+G", || {
        arrange(Arrangement::Ungroup)
    }),
    action(Selection, "hide", "Hide what is chosen", "Ctrl+H", || {
        arrange(Arrangement::Hide)
    }),
    action(
        Selection,
        "hide_others",
        "Hide all other boxes",
        "Ctrl+Alt+H",
        || Command::Tools(ToolCommand::HideOthers),
    ),
    action(
        Selection,
        "show_all",
        "Show all that is hidden",
        "Ctrl+Shift+H",
        || Command::Tools(ToolCommand::ShowAll),
    ),
    action(Selection, "lock", "Lock what is chosen", "Ctrl+L", || {
        arrange(Arrangement::Lock)
    }),
    action(
        Selection,
        "unlock_all",
        "Unlock everything",
        "Ctrl+Shift+L",
        || Command::Tools(ToolCommand::UnlockAll),
    ),
    action(Selection, "row", "Row of copies", "Ctrl+Shift+D", || {
        Command::Tools(ToolCommand::AskRow)
    }),
    action(Selection, "mirror", "Mirror about the ego axis", "Ctrl+M", || {
        Command::Tools(ToolCommand::Mirror(false))
    }),
    action(Selection, "mirror_copies", "Mirrored copies", "", || {
        Command::Tools(ToolCommand::Mirror(true))
    }),
    action(
        Selection,
        "to_lane",
        "Boxes to the lane and the ground, things to the kerb",
        "D",
        || Command::Tools(ToolCommand::ToLane),
    )
    .chosen(),
    action(Selection, "to_ground", "To the ground", "Shift+D", || {
        Command::Tools(ToolCommand::DropToGround)
    })
    .chosen(),
    action(
        Selection,
        "fit",
        "Fit to its voxels, which stay",
        "Shift+F",
        || Command::Tools(ToolCommand::Fit),
    )
    .chosen(),
    action(
        Selection,
        "raise",
        "Raise things: a storey, or 0.5 m",
        "] }",
        || raise(1),
    )
    .things()
    .repeats(),
    action(
        Selection,
        "lower",
        "Lower things: a storey, or 0.5 m",
        "[ {",
        || raise(-1),
    )
    .things()
    .repeats(),
    action(Selection, "next_box", "Next box", "J", || Command::SelectNext(1)),
    action(Selection, "previous_box", "Previous box", "Shift+J", || {
        Command::SelectNext(-1)
    }),
];
