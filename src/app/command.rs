//! What a user can ask for, as values: panels, canvases and keys push commands, the application
//! carries them out after the frame was drawn.

use std::path::PathBuf;

use editor::Edit;
use scene::{BoxId, Class, SceneRev};
use viewport::ViewPreset;

use super::dock::Workspace;
use super::state::Pane;
use super::tools::ToolId;

/// One wish of the user.
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
    /// What the tools are asked for.
    Tools(super::tools::ToolCommand),
    /// Chooses a box, or none.
    Select(Option<BoxId>),
    /// Chooses the next (1) or previous (-1) box by id.
    SelectNext(i32),
    /// Ends what is in hand: a drag, an enlarged camera, the selection, the tool.
    Escape,
    /// Deletes the chosen box.
    DeleteSelected,
    /// Copies the chosen box beside itself, and chooses the copy.
    DuplicateSelected,
    /// Shifts the chosen box in the ego frame, m.
    Nudge(glam::DVec3),
    /// Turns the chosen box counter-clockwise, degrees.
    Turn(f64),
    /// Takes another tool.
    Tool(ToolId),
    /// Makes the brush in hand larger (1) or smaller (-1).
    BrushSize(i32),
    /// Generates: all of it, or what was edited.
    Generate {
        /// True: everything, from fresh noise.
        full: bool,
    },
    /// Draws what stands beside the roads anew, by what is chosen in the list.
    DrawScenery,
    /// What becomes of a result that waits.
    Decide(super::staged::Verdict),
    /// Ends a whole generation with what it shows now.
    StopHere,
    /// Stops the generation that runs.
    CancelGeneration,
    /// Lets an edit that waits for its generation go.
    CancelWaiting,
    /// Both.
    CancelAll,
    /// Keeps where the large views stand under a number.
    KeepBookmark(u8),
    /// Goes where the views stood when that number was kept.
    GoToBookmark(u8),
    /// Compares with the version of that state.
    CompareWith(SceneRev),
    /// Goes back (or forward) to the version of that state, as an undo step.
    RestoreVersion(SceneRev),
    /// Goes to the next (1) or previous (-1) version.
    StepVersion(i32),
    /// The next way to compare.
    CycleCompare,
    /// Switches generation after each edit on or off.
    ToggleLive,
    /// What was inferred on import is marked as a guess no more.
    ConfirmInferred,
    /// Gives all painted voxels back to generation.
    ClearPaint,
    /// Starts a new scene.
    New,
    /// Asks for a file and opens it.
    Open,
    /// Opens this file.
    OpenPath(PathBuf),
    /// Saves to the scene's file, or asks for one.
    Save,
    /// Asks for a file and saves there.
    SaveAs,
    /// Opens or closes the dialog that exports files for other programs.
    ToggleExport,
    /// Asks for a file and saves the 3D view there.
    ExportScreenshot,
    /// Saves the 3D view beside the scene.
    QuickShot,
    /// Asks for a file of sensors and takes them.
    ImportRig,
    /// Asks for a file and saves the sensors there.
    ExportRig,
    /// Shows or hides the sensors' window.
    ToggleSensors,
    /// Leaves the program.
    Quit,
    /// Brings the chosen box into the middle of the view under the pointer.
    FrameSelection,
    /// Brings everything into the view under the pointer.
    FrameAll,
    /// Brings a place of the ego frame, m, into the middle of both large views.
    FrameAt(glam::DVec3),
    /// Repairs all findings of the checks that can be repaired.
    FixAll,
    /// Shows or hides the findings of the checks.
    ToggleChecks,
    /// Takes a standard viewpoint in the 3D view.
    View(ViewPreset),
    /// Looks through that camera of the rig in the 3D view.
    LookThrough(usize),
    /// Enlarges that camera, or shows the strip again.
    Inspect(Option<usize>),
    /// Swaps the bird's-eye view and the 3D view.
    SwapPanes,
    /// Brings a pane to the front, or opens it.
    ShowPane(Pane),
    /// Brings a pane into sight, or takes it off the screen.
    TogglePane(Pane),
    /// Shows the pane under the pointer alone, or all of them again.
    MaximizePane,
    /// Arranges the panes for one kind of work.
    Workspace(Workspace),
    /// Generates with the settings of a stop of the quality slider, by index.
    Quality(usize),
    /// Times the stops on this machine.
    Calibrate,
    /// Measures how far the last edit lies from the reference.
    Refine,
    /// Stops either.
    StopMeasuring,
    /// Shows or hides the 10 m grid.
    ToggleGrid,
    /// Shows or hides the log.
    ToggleLog,
    /// Shows or hides the performance overlay.
    TogglePerformance,
    /// Takes the tool that places boxes, with this class.
    PlaceClass(Class),
    /// Starts from what words describe, drawn from a seed.
    NewFromPrompt(Box<super::prompting::Ask>),
    /// Goes to the field of the prompt.
    FocusPrompt,
    /// Starts from a ready-made road.
    NewFrom(&'static str),
    /// Shows or hides the command palette.
    TogglePalette,
    /// Shows or hides the settings.
    ToggleSettings,
    /// Shows or hides the start screen.
    ToggleStart,
    /// Shows or hides the sheet of keys.
    ToggleKeys,
}
