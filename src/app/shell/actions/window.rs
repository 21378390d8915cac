//! Actions of views, generation, versions and files.

use super::ActionGroup::{File, Generation, Time, Views};
use super::{ActionDef, action};
use crate::command::{Command, FileCommand, GenerationCommand, TimeCommand, Verdict, ViewCommand, Window};
use crate::panes::id::PaneId;
use crate::shell::workspace::Workspace;
use crate::tools::ToolCommand;
use crate::tools::things::ThingCommand;
use viewport::ViewPreset;

macro_rules! bookmarks {
    ($($slot:literal),*) => {
        /// Action that goes to a kept view.
        const fn go(slot: u8) -> ActionDef {
            match slot {
                $($slot => action(
                    Views,
                    concat!("bookmark_go_", $slot),
                    concat!("Go to kept view ", $slot),
                    concat!("F", $slot),
                    || Command::View(ViewCommand::GoToBookmark($slot)),
                ),)*
                _ => panic!("there are nine"),
            }
        }

        /// Action that keeps a view.
        const fn keep(slot: u8) -> ActionDef {
            match slot {
                $($slot => action(
                    Views,
                    concat!("bookmark_keep_", $slot),
                    concat!("Keep this view as ", $slot),
                    concat!("Ctrl+F", $slot),
                    || Command::View(ViewCommand::KeepBookmark($slot)),
                ),)*
                _ => panic!("there are nine"),
            }
        }
    };
}

bookmarks!(1, 2, 3, 4, 5, 6, 7, 8, 9);

/// Actions of views, generation and files.
pub(super) const ACTIONS: &[ActionDef] = &[
    action(Views, "frame_selection", "Frame the selection", "F", || {
        Command::View(ViewCommand::FrameSelection)
    }),
    action(Views, "frame_all", "Frame everything", "Home", || {
        Command::View(ViewCommand::FrameAll)
    }),
    action(Views, "view_top", "3D view from above", "7", || {
        Command::View(ViewCommand::Preset(ViewPreset::Top))
    })
    .over_3d(),
    action(Views, "view_front", "3D view from the front", "1", || {
        Command::View(ViewCommand::Preset(ViewPreset::Front))
    })
    .over_3d(),
    action(Views, "view_side", "3D view from the side", "3", || {
        Command::View(ViewCommand::Preset(ViewPreset::Side))
    })
    .over_3d(),
    action(Views, "view_back", "3D view from the back", "", || {
        Command::View(ViewCommand::Preset(ViewPreset::Back))
    }),
    action(Views, "view_left", "3D view from the left", "", || {
        Command::View(ViewCommand::Preset(ViewPreset::Left))
    }),
    action(Views, "view_perspective", "3D view in perspective", "5", || {
        Command::View(ViewCommand::Preset(ViewPreset::Perspective))
    })
    .over_3d(),
    action(
        Views,
        "view_parallel",
        "3D view orthographic from here, or in perspective again",
        "9",
        || Command::View(ViewCommand::ToggleParallel),
    )
    .over_3d(),
    action(
        Views,
        "view_look",
        "3D view as voxels or as pictures",
        "8",
        || Command::View(ViewCommand::ToggleLook),
    )
    .over_3d(),
    action(Views, "view_ego", "3D view from the ego vehicle", "0", || {
        Command::View(ViewCommand::Preset(ViewPreset::Ego))
    })
    .over_3d(),
    action(Views, "look_1", "Look through camera 1", "Ctrl+Alt+1", || {
        Command::View(ViewCommand::LookThrough(0))
    }),
    action(Views, "look_2", "Look through camera 2", "Ctrl+Alt+2", || {
        Command::View(ViewCommand::LookThrough(1))
    }),
    action(Views, "look_3", "Look through camera 3", "Ctrl+Alt+3", || {
        Command::View(ViewCommand::LookThrough(2))
    }),
    action(Views, "look_4", "Look through camera 4", "Ctrl+Alt+4", || {
        Command::View(ViewCommand::LookThrough(3))
    }),
    action(Views, "look_5", "Look through camera 5", "Ctrl+Alt+5", || {
        Command::View(ViewCommand::LookThrough(4))
    }),
    action(Views, "look_6", "Look through camera 6", "Ctrl+Alt+6", || {
        Command::View(ViewCommand::LookThrough(5))
    }),
    action(Time, "play", "Play or pause", "Ctrl+Alt+Space", || {
        Command::Time(TimeCommand::Play)
    }),
    action(Time, "frame_back", "A frame back", "Comma", || {
        Command::Time(TimeCommand::Step(-1))
    })
    .repeats(),
    action(Time, "frame_forward", "A frame forward", "Period", || {
        Command::Time(TimeCommand::Step(1))
    })
    .repeats(),
    action(Time, "key_back", "To the keyframe before", "Shift+Comma", || {
        Command::Time(TimeCommand::Key(-1))
    }),
    action(
        Time,
        "key_forward",
        "To the next keyframe",
        "Shift+Period",
        || Command::Time(TimeCommand::Key(1)),
    ),
    action(
        Time,
        "key_here",
        "Keyframe of what is chosen here",
        "Shift+K",
        || Command::Time(TimeCommand::KeyHere),
    ),
    action(Time, "drop_key", "Take this keyframe away", "", || {
        Command::Time(TimeCommand::DropKey)
    }),
    action(
        Time,
        "copy_to_next",
        "Copy the place of what is chosen to the next frame",
        "Alt+Right",
        || Command::Time(TimeCommand::CopyToFrame(1)),
    ),
    action(
        Time,
        "copy_to_previous",
        "Copy the place of what is chosen to the frame before",
        "Alt+Left",
        || Command::Time(TimeCommand::CopyToFrame(-1)),
    ),
    action(Time, "time_start", "To the start", "", || {
        Command::Time(TimeCommand::ToStart)
    }),
    action(Time, "time_end", "To the end", "", || {
        Command::Time(TimeCommand::ToEnd)
    }),
    action(Time, "time_in", "Play from here on", "", || {
        Command::Time(TimeCommand::In)
    }),
    action(Time, "time_out", "Play up to here", "", || {
        Command::Time(TimeCommand::Out)
    }),
    action(Time, "save_clip", "Save clip as moving pictures…", "", || {
        Command::File(FileCommand::SaveClip)
    }),
    action(Time, "forecast", "Forecast 3 s more", "", || {
        Command::Time(TimeCommand::Forecast(3.0))
    }),
    action(Time, "timeline", "Timeline", "", || {
        Command::View(ViewCommand::TogglePane(PaneId::TIMELINE))
    }),
    action(
        Views,
        "swap_views",
        "Swap bird's-eye and 3D view",
        "Ctrl+Tab",
        || Command::View(ViewCommand::SwapPanes),
    ),
    action(
        Views,
        "maximize",
        "Maximize the pane under the pointer",
        "Shift+Space",
        || Command::View(ViewCommand::MaximizePane),
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
    action(Views, "show_things", "Show or hide scenery", "", || {
        Command::Tools(ToolCommand::Thing(ThingCommand::ToggleShown))
    }),
    action(Views, "lock_things", "Lock or unlock scenery", "", || {
        Command::Tools(ToolCommand::Thing(ThingCommand::ToggleLocked))
    }),
    action(Views, "grid", "Grid", "G", || {
        Command::View(ViewCommand::ToggleGrid)
    }),
    action(Views, "workspace_edit", "Workspace: Edit", "Alt+1", || {
        Command::View(ViewCommand::Workspace(Workspace::Edit))
    }),
    action(Views, "workspace_paint", "Workspace: Paint", "Alt+2", || {
        Command::View(ViewCommand::Workspace(Workspace::Paint))
    }),
    action(Views, "workspace_voxels", "Workspace: Voxels", "Alt+3", || {
        Command::View(ViewCommand::Workspace(Workspace::Voxels))
    }),
    action(Views, "workspace_sensors", "Workspace: Sensors", "Alt+4", || {
        Command::View(ViewCommand::Workspace(Workspace::Sensors))
    }),
    action(Views, "workspace_label", "Workspace: Label", "Alt+5", || {
        Command::View(ViewCommand::Workspace(Workspace::Label))
    }),
    action(Views, "workspace_trade", "Workspace: Trade", "Alt+6", || {
        Command::View(ViewCommand::Workspace(Workspace::Trade))
    }),
    action(Views, "workspace_clip", "Workspace: Clip", "Alt+7", || {
        Command::View(ViewCommand::Workspace(Workspace::Clip))
    }),
    action(
        Views,
        "clean",
        "Nothing but the scene in the views",
        "Backtick",
        || Command::View(ViewCommand::ToggleClean),
    ),
    action(Views, "full_screen", "Full screen", "F11", || {
        Command::View(ViewCommand::ToggleFullScreen)
    }),
    action(
        Generation,
        "calibrate",
        "Calibrate the quality slider",
        "",
        || Command::Generation(GenerationCommand::Calibrate),
    ),
    action(Generation, "refine", "Measure the last edit's error", "", || {
        Command::Generation(GenerationCommand::Refine)
    }),
    action(Views, "sensors", "Sensors of the vehicle", "", || {
        Command::Toggle(Window::Sensors)
    }),
    action(Views, "performance", "Performance overlay", "F10", || {
        Command::Toggle(Window::Performance)
    }),
    action(Views, "log", "Log", "", || Command::Toggle(Window::Log)),
    action(
        Generation,
        "generate",
        "Generate everything",
        "Ctrl+Enter",
        || Command::Generation(GenerationCommand::Generate { full: true }),
    ),
    action(
        Generation,
        "generate_edited",
        "Generate what was edited",
        "Ctrl+Shift+Enter",
        || Command::Generation(GenerationCommand::Generate { full: false }),
    ),
    action(Generation, "live", "Live on or off", "Ctrl+Space", || {
        Command::Generation(GenerationCommand::ToggleLive)
    }),
    action(Generation, "cancel", "Cancel", "Ctrl+Backspace", || {
        Command::Generation(GenerationCommand::Cancel {
            running: true,
            waiting: false,
        })
    }),
    action(Generation, "scenery", "Regenerate scenery", "", || {
        Command::Generation(GenerationCommand::DrawScenery)
    }),
    action(Generation, "accept", "Accept the new result", "Enter", || {
        Command::Generation(GenerationCommand::Decide(Verdict::Accept))
    })
    .staged(),
    action(Generation, "decline", "Decline the new result", "", || {
        Command::Generation(GenerationCommand::Decide(Verdict::Decline))
    }),
    action(Generation, "next_seed", "Another result: next seed", "", || {
        Command::Generation(GenerationCommand::Decide(Verdict::NextSeed))
    }),
    action(
        Generation,
        "stop_here",
        "Stop generating, keep what is shown",
        "",
        || Command::Generation(GenerationCommand::StopHere),
    ),
    action(
        Generation,
        "cancel_waiting",
        "Drop the edit that waits",
        "",
        || {
            Command::Generation(GenerationCommand::Cancel {
                running: false,
                waiting: true,
            })
        },
    ),
    action(
        Generation,
        "cancel_all",
        "Cancel what runs and what waits",
        "Ctrl+Shift+Backspace",
        || {
            Command::Generation(GenerationCommand::Cancel {
                running: true,
                waiting: true,
            })
        },
    ),
    action(
        Generation,
        "compare",
        "Compare: off, wipe, side, difference",
        "Shift+Backslash",
        || Command::View(ViewCommand::CycleCompare),
    ),
    action(
        Generation,
        "previous_version",
        "Previous version",
        "Ctrl+[",
        || Command::Generation(GenerationCommand::StepVersion(-1)),
    ),
    action(Generation, "next_version", "Next version", "Ctrl+]", || {
        Command::Generation(GenerationCommand::StepVersion(1))
    }),
    action(
        Generation,
        "keep_version",
        "Keep this state as a version",
        "",
        || Command::Generation(GenerationCommand::KeepVersion),
    ),
    action(
        Generation,
        "confirm_inferred",
        "Confirm what was inferred",
        "",
        || Command::ConfirmInferred,
    ),
    action(Generation, "clear_paint", "Unlock painted voxels", "", || {
        Command::ClearPaint
    }),
    action(File, "undo", "Undo", "Ctrl+Z", || Command::Undo).repeats(),
    action(File, "redo", "Redo", "Ctrl+Shift+Z Ctrl+Y", || Command::Redo).repeats(),
    action(File, "new", "New scene", "Ctrl+N", || {
        Command::File(FileCommand::New)
    }),
    action(File, "open", "Open", "Ctrl+O", || {
        Command::File(FileCommand::Open)
    }),
    action(File, "save", "Save", "Ctrl+S", || {
        Command::File(FileCommand::Save)
    }),
    action(File, "save_as", "Save as", "Ctrl+Shift+S", || {
        Command::File(FileCommand::SaveAs)
    }),
    action(File, "screenshot", "Screenshot of the 3D view", "F12", || {
        Command::File(FileCommand::QuickShot)
    }),
    action(
        File,
        "pictures",
        "Pictures: any size, contact sheet, turntable",
        "Ctrl+Shift+P",
        || Command::Toggle(Window::Capture),
    ),
    action(File, "place_model", "Place a model", "", || {
        Command::File(FileCommand::PlaceModel)
    }),
    action(
        File,
        "shape_of_chosen",
        "Shape of the chosen box from a model",
        "",
        || Command::File(FileCommand::ShapeOfChosen),
    ),
    action(File, "import_rig", "Import sensors", "", || {
        Command::File(FileCommand::ImportRig)
    }),
    action(File, "export_rig", "Export sensors", "", || {
        Command::File(FileCommand::ExportRig)
    }),
    action(File, "export", "Export", "Ctrl+E", || {
        Command::Toggle(Window::Export)
    }),
    action(
        File,
        "batches",
        "Batches: many variants of a scene",
        "Ctrl+B",
        || Command::Toggle(Window::Batches),
    ),
    action(File, "checks", "Checks of the scene", "", || {
        Command::View(ViewCommand::TogglePane(PaneId::CHECKS))
    }),
    action(File, "prompt", "Prompt", "/", || {
        Command::View(ViewCommand::FocusPrompt)
    }),
    action(File, "tour", "Tour in three steps", "", || Command::BeginTour),
    action(File, "palette", "Command palette", "Ctrl+K Ctrl+P", || {
        Command::Toggle(Window::Palette)
    }),
    action(File, "keys", "Sheet of keys", "?", || {
        Command::Toggle(Window::Keys)
    }),
    action(File, "settings", "Settings", "Ctrl+,", || {
        Command::Toggle(Window::Settings)
    }),
    action(File, "start_screen", "Start screen", "", || {
        Command::Toggle(Window::Start)
    }),
    action(File, "quit", "Quit", "Ctrl+Q", || {
        Command::File(FileCommand::Quit)
    }),
];
