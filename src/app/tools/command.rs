//! What a user can ask of the tools, as values; carried out in `boxes.rs`.

use glam::{DVec2, DVec3};

use editor::arrange::Row;
use editor::transform::Kind;
use editor::voxel_ops::Cell;
use scene::{BevLayer, BoxId, Class};

use super::options::{PaintShape, VoxelMode};

/// How boxes join the selection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Choose {
    /// They alone.
    Only,
    /// They too.
    Add,
    /// Each changes sides.
    Toggle,
}

/// One wish of the user.
#[derive(Clone, Debug, PartialEq)]
pub enum ToolCommand {
    /// Chooses these boxes.
    Choose(Vec<BoxId>, Choose),
    /// Chooses every box.
    ChooseAll,
    /// Chooses none.
    ChooseNone,
    /// Chooses the boxes that are not chosen.
    ChooseOthers,
    /// Deletes the chosen boxes, or the chosen voxels.
    Delete,
    /// Copies the chosen boxes beside themselves.
    Duplicate,
    /// Takes the chosen boxes along.
    Copy,
    /// The same, and deletes them.
    Cut,
    /// Puts down what was taken along: at the pointer over the bird's-eye view, else beside where it was.
    Paste,
    /// Shifts the chosen boxes in the ego frame, m.
    Nudge(DVec3),
    /// Turns the chosen boxes counter-clockwise, degrees.
    Turn(f64),
    /// Opens the dialog of rows.
    AskRow,
    /// Adds rows of copies of the chosen boxes.
    Row(Row),
    /// Mirrors the chosen boxes about the ego x axis; true adds mirrored copies instead.
    Mirror(bool),
    /// Lets the chosen boxes stand on the ground.
    DropToGround,
    /// Puts the chosen boxes on the middle of their lane, in its direction.
    ToLane,
    /// Takes the select tool; true draws lassos, false rectangles.
    Lasso(bool),
    /// What dragging a chosen box changes.
    Gizmo(Kind),
    /// Takes the brush with that shape.
    Shape(PaintShape),
    /// Takes over a map layer for the brush.
    PickLayer(BevLayer),
    /// Takes the voxel tool with that mode.
    Voxels(VoxelMode),
    /// Chooses voxels; true adds to those chosen.
    ChooseVoxels(Vec<Cell>, bool),
    /// Gives the chosen voxels a class; `free` removes them.
    PaintChosenVoxels(Class),
    /// Locks the chosen voxels as they are, or gives them back to generation.
    LockChosenVoxels(bool),
    /// Takes over a class for the voxel tools.
    PickClass(Class),
    /// Switches symmetry about the ego x axis on or off.
    Symmetry,
    /// Takes another point of what is being drawn or measured.
    Point(DVec2),
    /// Ends the outline that is being drawn.
    ClosePoints,
    /// Takes the last point back.
    DropPoint,
    /// Drops all points of what is being drawn or measured.
    ClearPoints,
    /// Marks a rectangle of the ego frame (m) to be drawn anew, or takes the mark away.
    Region(DVec2, DVec2, bool),
    /// Marks what an outline of the ego frame (m) goes around to be drawn anew, or takes the mark away.
    RegionOutline(Vec<DVec2>, bool),
    /// Marks what a brush of that width (m) passes from one point to another (ego frame, m), or takes the mark away.
    RegionStroke(DVec2, DVec2, f64, bool),
    /// Of the tools for things.
    Thing(super::things::ThingCommand),
    /// Says something to the user.
    Note(String),
}

impl ToolCommand {
    /// Commands without an argument, for menus and the command palette: name, chord of the Default preset, command.
    pub fn named() -> Vec<(&'static str, &'static str, ToolCommand)> {
        vec![
            ("Select all boxes", "Ctrl+A", Self::ChooseAll),
            ("Select no box", "Ctrl+Shift+A", Self::ChooseNone),
            ("Invert the selection", "Ctrl+I", Self::ChooseOthers),
            ("Copy boxes", "Ctrl+C", Self::Copy),
            ("Cut boxes", "Ctrl+X", Self::Cut),
            ("Paste boxes", "Ctrl+V", Self::Paste),
            ("Row of copies…", "Ctrl+Shift+D", Self::AskRow),
            ("Mirror boxes about the ego axis", "Ctrl+M", Self::Mirror(false)),
            ("Mirrored copies of boxes", "", Self::Mirror(true)),
            ("Boxes to lane and ground", "D", Self::ToLane),
            ("Boxes to the ground", "Shift+D", Self::DropToGround),
            ("Select by rectangle", "V", Self::Lasso(false)),
            ("Select by lasso", "O", Self::Lasso(true)),
            ("Drag moves", "W", Self::Gizmo(Kind::Move)),
            ("Drag turns", "E with the select tool", Self::Gizmo(Kind::Turn)),
            ("Drag scales", "R with the select tool", Self::Gizmo(Kind::Scale)),
            ("Brush: freehand", "B", Self::Shape(PaintShape::Stroke)),
            ("Brush: rectangle", "U", Self::Shape(PaintShape::Rectangle)),
            ("Brush: line", "L", Self::Shape(PaintShape::Line)),
            ("Brush: polygon", "P", Self::Shape(PaintShape::Polygon)),
            ("Brush: street", "P again", Self::Shape(PaintShape::Street)),
            ("Brush: fill", "K", Self::Shape(PaintShape::Fill)),
            ("Brush: pick a layer", "I", Self::Shape(PaintShape::Pick)),
            (
                "Voxels: brush",
                "B over the 3D view",
                Self::Voxels(VoxelMode::Brush),
            ),
            (
                "Voxels: box",
                "U over the 3D view",
                Self::Voxels(VoxelMode::Block),
            ),
            ("Voxels: line", "L over the 3D view", Self::Voxels(VoxelMode::Row)),
            (
                "Voxels: fill",
                "K over the 3D view",
                Self::Voxels(VoxelMode::Fill),
            ),
            ("Voxels: magic wand", "Shift+O", Self::Voxels(VoxelMode::Wand)),
            (
                "Voxels: pull a face",
                "P over the 3D view",
                Self::Voxels(VoxelMode::Extrude),
            ),
            ("Symmetry about the ego axis", "S", Self::Symmetry),
        ]
    }
}
