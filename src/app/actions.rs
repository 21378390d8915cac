//! Everything that a key can call for: the one list behind keys, the sheet of keys and the command palette.

use std::sync::LazyLock;

use glam::DVec3;

use viewport::ViewPreset;

use super::command::Command;
use super::dock::Workspace;
use super::staged::Verdict;
use super::state::UiState;
use super::tools::ToolCommand;
use super::tools::things::ThingCommand;
use editor::tools::{self, Shortcut};

/// Where a chord counts; what stands later wins over what stands before.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum When {
    /// Everywhere.
    Always,
    /// With the pointer over the 3D view.
    Over3d,
    /// While a box or a thing is chosen and the tool in hand is one for them.
    Chosen,
    /// While a thing beside the road is chosen and no brush is in hand.
    Things,
}

impl When {
    /// True if a chord cannot mean two things in these two places: only `Always` gives way to the others.
    pub fn meets(self, other: Self) -> bool {
        self == other
    }
}

/// Sections of the sheet of keys.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Group {
    /// Tools.
    Tools,
    /// The chosen box.
    Selection,
    /// Views and panes.
    Views,
    /// Generation and versions.
    Generation,
    /// Files and history.
    File,
}

impl Group {
    /// Every group with its title.
    pub const ALL: [(Group, &'static str); 5] = [
        (Group::Tools, "Tools"),
        (Group::Selection, "Selection"),
        (Group::Views, "Views"),
        (Group::Generation, "Generation"),
        (Group::File, "File and edit"),
    ];
}

/// One action.
#[derive(Clone, Copy)]
pub struct ActionDef {
    /// Its name in key files.
    pub id: &'static str,
    /// Section of the sheet.
    pub group: Group,
    /// What it does, for a person.
    pub title: &'static str,
    /// Where its chords count.
    pub when: When,
    /// Default chords, separated by blanks.
    pub keys: &'static str,
    /// Goes on while the key is held.
    pub repeats: bool,
    does: Does,
}

/// What an action does.
#[derive(Clone, Copy)]
enum Does {
    /// Asks for something; nothing if only the window's state changes.
    Command(fn(&mut UiState) -> Option<Command>),
    /// The shortcut of a tool of that name.
    Shortcut,
}

const fn action(
    group: Group,
    id: &'static str,
    title: &'static str,
    keys: &'static str,
    command: fn(&mut UiState) -> Option<Command>,
) -> ActionDef {
    ActionDef {
        id,
        group,
        title,
        when: When::Always,
        keys,
        repeats: false,
        does: Does::Command(command),
    }
}

impl ActionDef {
    /// What the action asks for now.
    pub fn run(&self, state: &mut UiState) -> Option<Command> {
        match self.does {
            Does::Command(command) => command(state),
            Does::Shortcut => Some(Command::Tools(ToolCommand::Shortcut(self.id))),
        }
    }

    const fn over_3d(mut self) -> Self {
        self.when = When::Over3d;
        self
    }

    const fn chosen(mut self) -> Self {
        self.when = When::Chosen;
        self
    }

    const fn things(mut self) -> Self {
        self.when = When::Things;
        self
    }

    const fn repeats(mut self) -> Self {
        self.repeats = true;
        self
    }
}

use Group::{File, Generation, Selection, Tools, Views};

macro_rules! bookmarks {
    ($($slot:literal),*) => {
        /// Goes to a kept view.
        const fn go(slot: u8) -> ActionDef {
            match slot {
                $($slot => action(
                    Views,
                    concat!("bookmark_go_", $slot),
                    concat!("Go to kept view ", $slot),
                    concat!("F", $slot),
                    |_| Some(Command::GoToBookmark($slot)),
                ),)*
                _ => panic!("there are nine"),
            }
        }

        /// Keeps a view.
        const fn keep(slot: u8) -> ActionDef {
            match slot {
                $($slot => action(
                    Views,
                    concat!("bookmark_keep_", $slot),
                    concat!("Keep this view as ", $slot),
                    concat!("Ctrl+F", $slot),
                    |_| Some(Command::KeepBookmark($slot)),
                ),)*
                _ => panic!("there are nine"),
            }
        }
    };
}

bookmarks!(1, 2, 3, 4, 5, 6, 7, 8, 9);

const fn raise(steps: i32) -> Command {
    Command::Tools(ToolCommand::Thing(ThingCommand::Raise(steps)))
}

/// Every action: those of the tools, and all others.
pub static ACTIONS: LazyLock<Vec<ActionDef>> = LazyLock::new(|| {
    let of_tools = tools::all().iter().flat_map(|tool| tool.shortcuts).map(of_tool);
    of_tools.chain(OTHERS.iter().copied()).collect()
});

/// The action that a tool has.
fn of_tool(shortcut: &'static Shortcut) -> ActionDef {
    ActionDef {
        id: shortcut.id,
        group: match shortcut.when {
            tools::When::Chosen => Selection,
            _ => Tools,
        },
        title: shortcut.title,
        when: match shortcut.when {
            tools::When::Always => When::Always,
            tools::When::OverSpace => When::Over3d,
            tools::When::Chosen => When::Chosen,
        },
        keys: shortcut.keys,
        repeats: false,
        does: Does::Shortcut,
    }
}

/// Actions that belong to no tool.
const OTHERS: &[ActionDef] = &[
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
        "escape",
        "Cancel the drag, drop the selection",
        "Esc",
        |_| Some(Command::Escape),
    ),
    action(Selection, "delete", "Delete", "Del Backspace", |_| {
        Some(Command::DeleteSelected)
    }),
    action(Selection, "duplicate", "Duplicate", "Ctrl+D", |_| {
        Some(Command::DuplicateSelected)
    }),
    action(Selection, "turn_left", "Turn left 1°", "Z", |_| {
        Some(Command::Turn(1.0))
    })
    .chosen()
    .repeats(),
    action(Selection, "turn_right", "Turn right 1°", "X", |_| {
        Some(Command::Turn(-1.0))
    })
    .chosen()
    .repeats(),
    action(Selection, "turn_left_far", "Turn left 15°", "Shift+Z", |_| {
        Some(Command::Turn(15.0))
    })
    .chosen()
    .repeats(),
    action(Selection, "turn_right_far", "Turn right 15°", "Shift+X", |_| {
        Some(Command::Turn(-15.0))
    })
    .chosen()
    .repeats(),
    action(Selection, "turn_90", "Turn 90°", "C", |_| {
        Some(Command::Turn(90.0))
    })
    .chosen(),
    action(Selection, "turn_180", "Turn 180°", "Q", |_| {
        Some(Command::Turn(180.0))
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
    action(Selection, "next_box", "Next box", "J", |_| {
        Some(Command::SelectNext(1))
    }),
    action(Selection, "previous_box", "Previous box", "Shift+J", |_| {
        Some(Command::SelectNext(-1))
    }),
    action(Views, "frame_selection", "Frame the selection", "F", |_| {
        Some(Command::FrameSelection)
    }),
    action(Views, "frame_all", "Frame everything", "Home", |_| {
        Some(Command::FrameAll)
    }),
    action(Views, "view_top", "3D view from above", "7", |_| {
        Some(Command::View(ViewPreset::Top))
    })
    .over_3d(),
    action(Views, "view_front", "3D view from the front", "1", |_| {
        Some(Command::View(ViewPreset::Front))
    })
    .over_3d(),
    action(Views, "view_side", "3D view from the side", "3", |_| {
        Some(Command::View(ViewPreset::Side))
    })
    .over_3d(),
    action(Views, "view_perspective", "3D view in perspective", "5", |_| {
        Some(Command::View(ViewPreset::Perspective))
    })
    .over_3d(),
    action(Views, "view_ego", "3D view from the ego vehicle", "0", |_| {
        Some(Command::View(ViewPreset::Ego))
    })
    .over_3d(),
    action(Views, "look_1", "Look through camera 1", "Ctrl+Alt+1", |_| {
        Some(Command::LookThrough(0))
    }),
    action(Views, "look_2", "Look through camera 2", "Ctrl+Alt+2", |_| {
        Some(Command::LookThrough(1))
    }),
    action(Views, "look_3", "Look through camera 3", "Ctrl+Alt+3", |_| {
        Some(Command::LookThrough(2))
    }),
    action(Views, "look_4", "Look through camera 4", "Ctrl+Alt+4", |_| {
        Some(Command::LookThrough(3))
    }),
    action(Views, "look_5", "Look through camera 5", "Ctrl+Alt+5", |_| {
        Some(Command::LookThrough(4))
    }),
    action(Views, "look_6", "Look through camera 6", "Ctrl+Alt+6", |_| {
        Some(Command::LookThrough(5))
    }),
    action(Views, "swap_views", "Swap bird's-eye and 3D view", "Tab", |_| {
        Some(Command::SwapPanes)
    }),
    action(
        Views,
        "maximize",
        "Maximize the pane under the pointer",
        "Shift+Space",
        |_| Some(Command::MaximizePane),
    ),
    go(1),
    go(2),
    go(3),
    go(4),
    go(5),
    go(6),
    go(7),
    go(8),
    go(9),
    keep(1),
    keep(2),
    keep(3),
    keep(4),
    keep(5),
    keep(6),
    keep(7),
    keep(8),
    keep(9),
    action(Views, "show_things", "Show or hide background things", "", |_| {
        Some(Command::Tools(ToolCommand::Thing(ThingCommand::ToggleShown)))
    }),
    action(
        Views,
        "lock_things",
        "Lock or unlock background things",
        "",
        |_| Some(Command::Tools(ToolCommand::Thing(ThingCommand::ToggleLocked))),
    ),
    action(Views, "grid", "Grid", "G", |_| Some(Command::ToggleGrid)),
    action(Views, "workspace_edit", "Workspace: Edit", "Alt+1", |_| {
        Some(Command::Workspace(Workspace::Edit))
    }),
    action(Views, "workspace_paint", "Workspace: Paint", "Alt+2", |_| {
        Some(Command::Workspace(Workspace::Paint))
    }),
    action(Views, "workspace_voxels", "Workspace: Voxels", "Alt+3", |_| {
        Some(Command::Workspace(Workspace::Voxels))
    }),
    action(Views, "workspace_sensors", "Workspace: Sensors", "Alt+4", |_| {
        Some(Command::Workspace(Workspace::Sensors))
    }),
    action(Views, "workspace_label", "Workspace: Label", "Alt+5", |_| {
        Some(Command::Workspace(Workspace::Label))
    }),
    action(Views, "workspace_trade", "Workspace: Trade", "Alt+6", |_| {
        Some(Command::Workspace(Workspace::Trade))
    }),
    action(
        Generation,
        "calibrate",
        "Calibrate the quality slider",
        "",
        |_| Some(Command::Calibrate),
    ),
    action(Generation, "refine", "Measure the last edit's error", "", |_| {
        Some(Command::Refine)
    }),
    action(Views, "sensors", "Sensors of the vehicle", "", |_| {
        Some(Command::ToggleSensors)
    }),
    action(Views, "performance", "Performance overlay", "F10", |_| {
        Some(Command::TogglePerformance)
    }),
    action(Views, "log", "Log", "", |_| Some(Command::ToggleLog)),
    action(
        Generation,
        "generate",
        "Generate everything",
        "Ctrl+Enter",
        |_| Some(Command::Generate { full: true }),
    ),
    action(
        Generation,
        "generate_edited",
        "Generate what was edited",
        "Ctrl+Shift+Enter",
        |_| Some(Command::Generate { full: false }),
    ),
    action(Generation, "live", "Live on or off", "Ctrl+Space", |_| {
        Some(Command::ToggleLive)
    }),
    action(Generation, "cancel", "Cancel", "Ctrl+Backspace", |_| {
        Some(Command::CancelGeneration)
    }),
    action(Generation, "scenery", "Draw scenery anew", "", |_| {
        Some(Command::DrawScenery)
    }),
    action(Generation, "accept", "Accept the new result", "", |_| {
        Some(Command::Decide(Verdict::Accept))
    }),
    action(Generation, "decline", "Decline the new result", "", |_| {
        Some(Command::Decide(Verdict::Decline))
    }),
    action(Generation, "next_seed", "Another result: next seed", "", |_| {
        Some(Command::Decide(Verdict::NextSeed))
    }),
    action(
        Generation,
        "stop_here",
        "Stop generating, keep what is shown",
        "",
        |_| Some(Command::StopHere),
    ),
    action(
        Generation,
        "cancel_waiting",
        "Drop the edit that waits",
        "",
        |_| Some(Command::CancelWaiting),
    ),
    action(
        Generation,
        "cancel_all",
        "Cancel what runs and what waits",
        "Ctrl+Shift+Backspace",
        |_| Some(Command::CancelAll),
    ),
    action(
        Generation,
        "compare",
        "Compare: off, wipe, side, difference",
        "Shift+Backslash",
        |_| Some(Command::CycleCompare),
    ),
    action(
        Generation,
        "previous_version",
        "Previous version",
        "Ctrl+[",
        |_| Some(Command::StepVersion(-1)),
    ),
    action(Generation, "next_version", "Next version", "Ctrl+]", |_| {
        Some(Command::StepVersion(1))
    }),
    action(
        Generation,
        "confirm_inferred",
        "Confirm what was inferred",
        "",
        |_| Some(Command::ConfirmInferred),
    ),
    action(Generation, "clear_paint", "Unlock painted voxels", "", |_| {
        Some(Command::ClearPaint)
    }),
    action(File, "undo", "Undo", "Ctrl+Z", |_| Some(Command::Undo)).repeats(),
    action(File, "redo", "Redo", "Ctrl+Shift+Z Ctrl+Y", |_| {
        Some(Command::Redo)
    })
    .repeats(),
    action(File, "new", "New scene", "Ctrl+N", |_| Some(Command::New)),
    action(File, "open", "Open", "Ctrl+O", |_| Some(Command::Open)),
    action(File, "save", "Save", "Ctrl+S", |_| Some(Command::Save)),
    action(File, "save_as", "Save as", "Ctrl+Shift+S", |_| {
        Some(Command::SaveAs)
    }),
    action(File, "screenshot", "Screenshot of the 3D view", "F12", |_| {
        Some(Command::QuickShot)
    }),
    action(File, "export_screenshot", "Export a screenshot", "", |_| {
        Some(Command::ExportScreenshot)
    }),
    action(File, "import_rig", "Import sensors", "", |_| {
        Some(Command::ImportRig)
    }),
    action(File, "export_rig", "Export sensors", "", |_| {
        Some(Command::ExportRig)
    }),
    action(File, "export", "Export", "Ctrl+E", |_| {
        Some(Command::ToggleExport)
    }),
    action(File, "checks", "Checks of the scene", "", |_| {
        Some(Command::ToggleChecks)
    }),
    action(File, "prompt", "Prompt", "/", |_| Some(Command::FocusPrompt)),
    action(File, "palette", "Command palette", "Ctrl+K Ctrl+P", |_| {
        Some(Command::TogglePalette)
    }),
    action(File, "keys", "Sheet of keys", "?", |_| Some(Command::ToggleKeys)),
    action(File, "settings", "Settings", "Ctrl+,", |_| {
        Some(Command::ToggleSettings)
    }),
    action(File, "start_screen", "Start screen", "", |_| {
        Some(Command::ToggleStart)
    }),
    action(File, "quit", "Quit", "Ctrl+Q", |_| Some(Command::Quit)),
];

/// Nudges of the chosen box by the arrows, which no preset changes: direction in the ego frame, as the bird's-eye view
/// shows it (forward is up).
pub fn nudge_direction(key: egui::Key) -> Option<DVec3> {
    use egui::Key;
    Some(match key {
        Key::ArrowUp => DVec3::X,
        Key::ArrowDown => -DVec3::X,
        Key::ArrowLeft => DVec3::Y,
        Key::ArrowRight => -DVec3::Y,
        Key::PageUp => DVec3::Z,
        Key::PageDown => -DVec3::Z,
        _ => return None,
    })
}
