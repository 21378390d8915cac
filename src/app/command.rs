//! Commands: every action that a user can ask for, as a value. Panes, canvases and keys push commands; the application
//! carries them out after the frame is drawn.

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
    NewFrom(&'static str, scene::Lattice),
    /// Makes a new scene from a description in words.
    Describe(String),
    /// Makes a new scene from a prompt that was read, with a seed.
    NewFromPrompt(Box<super::prompting::Ask>),
    /// Asks for a file and opens it.
    Open,
    /// Opens this file.
    OpenPath(PathBuf),
    /// Saves to the scene's file, or asks for one.
    Save,
    /// Asks for a file and saves there.
    SaveAs,
    /// Asks for a file and saves the picture that the dialog of pictures describes.
    AskCapture,
    /// Saves the 3D view beside the scene.
    QuickShot,
    /// Saves the picture of a camera in a view beside the scene.
    SavePicture(usize, ViewId),
    /// Shows the dialog of pictures with moving pictures chosen.
    SaveClip,
    /// Asks for a model and puts it into the scene.
    PlaceModel,
    /// Asks for a model and gives its shape to the chosen box.
    ShapeOfChosen,
    /// Asks for a folder of weights that paint camera pictures.
    PictureWeights,
    /// Asks for a file of sensors and uses them.
    ImportRig,
    /// Asks for a file and saves the sensors there.
    ExportRig,
    /// Leaves the program.
    Quit,
}

/// Commands for the views and the panes.
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
    /// Changes the 3D view between perspective and orthographic, from the same viewpoint.
    ToggleParallel,
    /// Shows the 3D view as voxels or as pictures.
    ToggleLook,
    /// Looks through that camera of the rig in the 3D view.
    LookThrough(usize),
    /// Sets the view of the cameras: classes, depth, pictures.
    Cameras(ViewId),
    /// Shows pictures in the cameras, unless their view shows light and weather already.
    ShowLight,
    /// Stops the painting of learned pictures; they stay as they are.
    StopPainting,
    /// Resumes the painting of learned pictures.
    PaintAgain,
    /// Enlarges that camera, or shows the strip again.
    Inspect(Option<usize>),
    /// Keeps the viewpoints of the large views under a number.
    KeepBookmark(u8),
    /// Goes to the viewpoints that were kept under a number.
    GoToBookmark(u8),
    /// Shows or hides the 10 m grid.
    ToggleGrid,
    /// Shows only the scene in the large views, without grid, lines, frames and marks, or shows all of that again.
    ToggleClean,
    /// Makes the window fill the screen, or a window again.
    ToggleFullScreen,
    /// Compares with the version of this state.
    CompareWith(SceneRev),
    /// Changes to the next compare mode.
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

/// Commands for repairs of findings. Repairs are planned in the background, listed, and then applied or discarded.
#[derive(Clone, Debug, PartialEq)]
pub enum RepairCommand {
    /// Plans repairs of all findings, and of the findings that remain after them.
    PlanAll,
    /// Plans repairs of these findings only.
    PlanThese(Vec<Finding>),
    /// Plans the same repairs again for the scene as it is now.
    Again,
    /// Ends the planning; repairs planned so far are listed.
    Stop,
    /// Applies the listed repairs as one undo step.
    Apply,
    /// Forgets the plan.
    Close,
}

/// Commands for the worker and its results.
#[derive(Clone, Debug, PartialEq)]
pub enum GenerationCommand {
    /// Generates the whole scene, or the edited region.
    Generate {
        /// True: the whole scene, from fresh noise.
        full: bool,
    },
    /// Regenerates the scenery beside the roads, by the choice in the list.
    DrawScenery,
    /// Accepts, declines or replaces a staged result.
    Decide(Verdict),
    /// Ends a generation of the whole scene and keeps its current state.
    StopHere,
    /// Cancels a job.
    Cancel {
        /// True: the running generation.
        running: bool,
        /// True: an edit that waits for its generation.
        waiting: bool,
    },
    /// Goes back (or forward) to the version of this state, as an undo step.
    RestoreVersion(SceneRev),
    /// Goes to the next (1) or previous (-1) version.
    StepVersion(i32),
    /// Sets the seed and the knobs with which the version of this state was made.
    UseAgain(SceneRev),
    /// Keeps the present state as a version, and asks for its name.
    KeepVersion,
    /// Switches generation after each edit on or off.
    ToggleLive,
    /// Generates with the settings of a preset of the quality slider, by index.
    Quality(usize),
    /// Times the presets on this machine.
    Calibrate,
    /// Measures the distance of the last edit from the reference.
    Refine,
    /// Stops these measurements.
    StopMeasuring,
}

/// Commands for time and motion.
#[derive(Clone, Debug, PartialEq)]
pub enum TimeCommand {
    /// Shows a moment, s.
    Show(f64),
    /// Shows the frame nearest to a moment, s.
    Scrub(f64),
    /// Gives a path to every object that has only a speed.
    Traffic,
    /// Lengthens the scene by so many seconds, s; what moves goes on.
    Forecast(f64),
    /// Plays, or pauses.
    Play,
    /// Steps by a number of frames, forward or back.
    Step(i32),
    /// Goes to the first moment that is played.
    ToStart,
    /// Goes to the last moment that is played.
    ToEnd,
    /// Goes to the next (1) or previous (-1) keyframe of the selection.
    Key(i32),
    /// Makes a keyframe of the selection at the moment shown.
    KeyHere,
    /// Deletes the keyframe of the selection that is nearest to the moment shown.
    DropKey,
    /// Puts the selection at its present place a number of frames later, or earlier, and goes there.
    CopyToFrame(i32),
    /// Sets the moment shown as the beginning of the played span.
    In,
    /// Sets the moment shown as the end of the played span.
    Out,
    /// Makes a box, or the ego vehicle (`None`), move by a template.
    Motion(Option<BoxId>, editor::traffic::Wish),
}

/// One command.
#[derive(Clone, Debug, PartialEq)]
pub enum Command {
    /// Applies edits as one undo step of this name.
    Apply(&'static str, Vec<Edit>),
    /// Applies the edits of a sentence as one undo step, chooses the boxes that it added or changed, and shows a change
    /// of weather.
    ApplyWords(String, Vec<Edit>),
    /// Previews edits on top of the state in which the drag began.
    Preview(Vec<Edit>),
    /// Ends the drag as one undo step.
    Commit(&'static str),
    /// Ends the drag without a change.
    CancelDrag,
    /// Undoes one step.
    Undo,
    /// Redoes one step.
    Redo,
    /// Goes to a state of the history, by index.
    JumpTo(usize),
    /// Leaves a step out of the history, by index.
    LeaveOut(usize),
    /// Replays the history from its origin and compares.
    ReplayHistory,
    /// Confirms everything that was inferred on import: it is no longer marked as a guess.
    ConfirmInferred,
    /// Gives all painted voxels back to generation.
    ClearPaint,
    /// Plans or applies repairs of findings.
    Repair(RepairCommand),
    /// A command for the tools.
    Tools(super::tools::ToolCommand),
    /// Chooses a box, or none.
    Select(Option<BoxId>),
    /// Chooses the next (1) or previous (-1) box by id.
    SelectNext(i32),
    /// Ends the first of these that there is: a drag, an enlarged camera, chosen voxels, the tool, the selection.
    Escape,
    /// Takes another tool.
    Tool(ToolId),
    /// Takes the tool that places boxes, with this class.
    PlaceClass(Class),
    /// Paints with the layer or class at this place in the list of the tool in hand.
    PaintWith(usize),
    /// Paints again with the layer or class used before this one.
    PaintWithLast,
    /// Makes the brush in hand larger (1) or smaller (-1).
    BrushSize(i32),
    /// Makes the voxel brush higher (1) or lower (-1).
    BrushHeight(i32),
    /// A command for files and scenes.
    File(FileCommand),
    /// A command for the views and the panes.
    View(ViewCommand),
    /// A command for the worker and its results.
    Generation(GenerationCommand),
    /// A command for time and motion.
    Time(TimeCommand),
    /// Shows the settings.
    OpenSettings,
    /// Begins the tour of the first minutes.
    BeginTour,
    /// Shows or hides a window.
    Toggle(Window),
}

/// Part of a staged result to accept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StagedPart {
    /// The marked region.
    Region,
    /// The places of chosen boxes and things.
    Chosen,
    /// Voxels of a class that come or go.
    Class(Class),
}

/// Decision of the user about a staged result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The result is kept.
    Accept,
    /// The state before it is restored.
    Decline,
    /// The result is replaced: the state before it is generated again with the next seed.
    NextSeed,
    /// Only this part of the result is kept.
    Take(StagedPart),
}

/// The name of the undo step for an edit by words: the words in quotation marks, cut to 60 characters.
pub(crate) fn step_name(words: &str) -> String {
    const LONGEST: usize = 60;
    let words = words.split_whitespace().collect::<Vec<_>>().join(" ");
    let mut name: String = words.chars().take(LONGEST).collect();
    if name.len() < words.len() {
        name.push('…');
    }
    format!("“{name}”")
}
