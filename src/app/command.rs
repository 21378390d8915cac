//! Commands: all that a user can ask for, as values. Panes, canvases and keys push them; the application carries them out
//! after the frame is drawn.

use std::path::PathBuf;

use editor::Edit;
use editor::checks::Finding;
use scene::{BoxId, Class, SceneRev};
use sensors::cameras::ViewId;
use viewport::ViewPreset;

use super::tools::ToolId;
use crate::panes::id::PaneId;
use crate::shell::workspace::Workspace;

/// A window or dialog that a command shows or hides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Window {
    /// The settings.
    Settings,
    /// The start screen.
    Start,
    /// The sheet of keys.
    Keys,
    /// The log.
    Log,
    /// The vehicle's sensors.
    Sensors,
    /// The performance overlay.
    Performance,
    /// The command palette.
    Palette,
    /// The dialog that exports files for other programs.
    Export,
    /// The queue of batches.
    Batches,
    /// The dialog of pictures.
    Capture,
}

/// Commands for files and scenes.
#[derive(Clone, Debug, PartialEq)]
pub enum FileCommand {
    /// Starts a new scene.
    New,
    /// Starts from a ready-made road.
    NewFrom(&'static str),
    /// A new scene of these words.
    Describe(String),
    /// Starts from what words describe, drawn from a seed.
    NewFromPrompt(Box<super::prompting::Ask>),
    /// Asks for a file and opens it.
    Open,
    /// Opens this file.
    OpenPath(PathBuf),
    /// Saves to the scene's file, or asks for one.
    Save,
    /// Asks for a file and saves there.
    SaveAs,
    /// Asks for a file and saves there what the dialog of pictures describes.
    AskCapture,
    /// Saves the 3D view beside the scene.
    QuickShot,
    /// Saves what a camera shows in a view beside the scene.
    SavePicture(usize, ViewId),
    /// Shows the dialog of pictures with moving ones chosen.
    SaveClip,
    /// Asks for a model and puts it into the scene.
    PlaceModel,
    /// Asks for a model and gives its shape to the chosen box.
    ShapeOfChosen,
    /// Asks for a folder of weights that paint camera pictures.
    PictureWeights,
    /// Asks for a file of sensors and takes them.
    ImportRig,
    /// Asks for a file and saves the sensors there.
    ExportRig,
    /// Leaves the program.
    Quit,
}

/// What the views show, and where the panes stand.
#[derive(Clone, Debug, PartialEq)]
pub enum ViewCommand {
    /// Brings the chosen box into the middle of the view under the pointer.
    FrameSelection,
    /// Brings everything into the view under the pointer.
    FrameAll,
    /// Brings a place of the ego frame, m, into the middle of both large views.
    FrameAt(glam::DVec3),
    /// Takes a standard viewpoint in the 3D view.
    Preset(ViewPreset),
    /// Changes the 3D view between perspective and orthographic, from where it is looked.
    ToggleParallel,
    /// Looks through that camera of the rig in the 3D view.
    LookThrough(usize),
    /// Shows that in the cameras: classes, depth, pictures.
    Cameras(ViewId),
    /// Shows pictures in the cameras, unless they show light and weather already.
    ShowLight,
    /// Ends the painting of learned pictures; they stay as they are by then.
    StopPainting,
    /// Paints them after all.
    PaintAgain,
    /// Enlarges that camera, or shows the strip again.
    Inspect(Option<usize>),
    /// Keeps where the large views stand under a number.
    KeepBookmark(u8),
    /// Goes where the views stood when that number was kept.
    GoToBookmark(u8),
    /// Shows or hides the 10 m grid.
    ToggleGrid,
    /// Shows the scene alone in the large views, without grid, lines, frames and marks, or all of that again.
    ToggleClean,
    /// The window fills the screen, or is a window again.
    ToggleFullScreen,
    /// Compares with the version of that state.
    CompareWith(SceneRev),
    /// The next way to compare.
    CycleCompare,
    /// Swaps the bird's-eye view and the 3D view.
    SwapPanes,
    /// Brings a pane to the front, or opens it.
    ShowPane(PaneId),
    /// Brings a pane into sight, or takes it off the screen.
    TogglePane(PaneId),
    /// Shows the pane under the pointer alone, or all of them again.
    MaximizePane,
    /// Arranges the panes for one kind of work.
    Workspace(Workspace),
    /// Goes to the field of the prompt.
    FocusPrompt,
}

/// Repairs of what the checks found: they are planned in the background, listed, and then done or not.
#[derive(Clone, Debug, PartialEq)]
pub enum RepairCommand {
    /// Plans repairs of all findings, and of what these leave.
    PlanAll,
    /// Plans repairs of these findings alone.
    PlanThese(Vec<Finding>),
    /// Plans what was planned before, for the scene as it is now.
    Again,
    /// Ends the planning; what is planned by then is listed.
    Stop,
    /// Does what is listed, as one undo step.
    Apply,
    /// Forgets the plan.
    Close,
}

/// What the worker does, and what becomes of its results.
#[derive(Clone, Debug, PartialEq)]
pub enum GenerationCommand {
    /// Generates: all of it, or what was edited.
    Generate {
        /// True: everything, from fresh noise.
        full: bool,
    },
    /// Regenerates what stands beside the roads, by what is chosen in the list.
    DrawScenery,
    /// What becomes of a result that waits.
    Decide(Verdict),
    /// Ends a whole generation with what it shows now.
    StopHere,
    /// Cancels a job.
    Cancel {
        /// The generation that runs.
        running: bool,
        /// An edit that waits for its generation.
        waiting: bool,
    },
    /// Goes back (or forward) to the version of that state, as an undo step.
    RestoreVersion(SceneRev),
    /// Goes to the next (1) or previous (-1) version.
    StepVersion(i32),
    /// Sets seed and knobs to those that the version of that state was made with.
    UseAgain(SceneRev),
    /// Keeps the present state as a version, and asks for its name.
    KeepVersion,
    /// Switches generation after each edit on or off.
    ToggleLive,
    /// Generates with the settings of a preset of the quality slider, by index.
    Quality(usize),
    /// Times the presets on this machine.
    Calibrate,
    /// Measures how far the last edit lies from the reference.
    Refine,
    /// Stops these measurements.
    StopMeasuring,
}

/// What moment is shown, and how things move.
#[derive(Clone, Debug, PartialEq)]
pub enum TimeCommand {
    /// Shows a moment, s.
    Show(f64),
    /// Shows the frame nearest to a moment, s.
    Scrub(f64),
    /// Lets everything drive that only says how fast.
    Traffic,
    /// So many seconds more: what moves goes on, s.
    Forecast(f64),
    /// Plays, or pauses.
    Play,
    /// So many frames forward, or back.
    Step(i32),
    /// The first moment that is played.
    ToStart,
    /// The last one.
    ToEnd,
    /// The next (1) or previous (-1) keyframe of what is chosen.
    Key(i32),
    /// Makes a keyframe of what is chosen at the moment that is shown.
    KeyHere,
    /// Takes the keyframe of what is chosen that is nearest to the moment that is shown away.
    DropKey,
    /// Puts what is chosen where it is now so many frames later, or earlier, and goes there.
    CopyToFrame(i32),
    /// What is played begins here.
    In,
    /// What is played ends here.
    Out,
    /// Lets a box, or (`None`) the ego vehicle, move by a template.
    Motion(Option<BoxId>, editor::traffic::Wish),
}

/// One command.
#[derive(Clone, Debug, PartialEq)]
pub enum Command {
    /// Applies edits as one undo step of this name.
    Apply(&'static str, Vec<Edit>),
    /// Applies what a sentence asked for as one undo step, chooses what came or changed, and shows what became of the weather.
    ApplyWords(String, Vec<Edit>),
    /// Shows edits on top of the state in which the drag began.
    Preview(Vec<Edit>),
    /// Ends the drag as one undo step.
    Commit(&'static str),
    /// Ends the drag without a change.
    CancelDrag,
    /// One step back.
    Undo,
    /// One step forward.
    Redo,
    /// Shows that state of the history.
    JumpTo(usize),
    /// What was inferred on import is marked as a guess no more.
    ConfirmInferred,
    /// Gives all painted voxels back to generation.
    ClearPaint,
    /// Repairs all findings of the checks that can be repaired.
    Repair(RepairCommand),
    /// What the tools are asked for.
    Tools(super::tools::ToolCommand),
    /// Chooses a box, or none.
    Select(Option<BoxId>),
    /// Chooses the next (1) or previous (-1) box by id.
    SelectNext(i32),
    /// Ends one thing, the first of these that there is: a drag, an enlarged camera, chosen voxels, the tool, the selection.
    Escape,
    /// Takes another tool.
    Tool(ToolId),
    /// Takes the tool that places boxes, with this class.
    PlaceClass(Class),
    /// Paints with the layer or class of that place in the list of the tool in hand.
    PaintWith(usize),
    /// Paints with the layer or class before this one again.
    PaintWithLast,
    /// Makes the brush in hand larger (1) or smaller (-1).
    BrushSize(i32),
    /// Makes the voxel brush higher (1) or lower (-1).
    BrushHeight(i32),
    /// What is read, written or begun.
    File(FileCommand),
    /// What the views show, and where the panes stand.
    View(ViewCommand),
    /// What the worker does, and what becomes of its results.
    Generation(GenerationCommand),
    /// What moment is shown, and how things move.
    Time(TimeCommand),
    /// Shows the settings.
    OpenSettings,
    /// Begins the tour of the first minutes.
    BeginTour,
    /// Shows or hides a window.
    Toggle(Window),
}

/// What is taken of a staged result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Taken {
    /// What lies in the marked region.
    Region,
    /// The places of chosen boxes and things.
    Chosen,
    /// What comes or goes of a class.
    Class(Class),
}

/// What the user decides about a staged result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// It stays.
    Accept,
    /// The state before comes back.
    Decline,
    /// The same again from other noise, in its place.
    NextSeed,
    /// Only this part of it stays.
    Take(Taken),
}

/// What the history calls an edit by words: the words.
pub(crate) fn step_name(words: &str) -> String {
    const LONGEST: usize = 60;
    let words = words.split_whitespace().collect::<Vec<_>>().join(" ");
    let mut name: String = words.chars().take(LONGEST).collect();
    if name.len() < words.len() {
        name.push('…');
    }
    format!("“{name}”")
}
