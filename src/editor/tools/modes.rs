//! Modes of the brushes and of the voxel tool: shapes, verbs, modes, each with its name and hint.

use serde::{Deserialize, Serialize};

/// Verb of the voxel brush.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum VoxelVerb {
    /// Puts voxels on the face under the pointer.
    #[default]
    Attach,
    /// Takes voxels away.
    Remove,
    /// Gives voxels another class.
    Recolour,
}

impl VoxelVerb {
    /// Every verb with its name and key.
    pub const ALL: [(VoxelVerb, &'static str, &'static str); 3] = [
        (VoxelVerb::Attach, "Attach", "T"),
        (VoxelVerb::Remove, "Remove", "R"),
        (VoxelVerb::Recolour, "Recolour", "Y"),
    ];
}

/// How the select tool chooses several things at once.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ChooseBy {
    /// A rectangle from corner to corner.
    #[default]
    Rectangle,
    /// An outline that is drawn.
    Lasso,
    /// An outline that is set corner by corner.
    Polygon,
}

/// Shape of the voxel brush.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum VoxelTip {
    /// A block.
    #[default]
    Block,
    /// A ball; an egg where it is higher than wide.
    Round,
}

impl VoxelTip {
    /// Every tip with its name and hint.
    pub const ALL: [(VoxelTip, &'static str, &'static str); 2] = [
        (VoxelTip::Block, "Block tip", "the brush is a block of voxels"),
        (
            VoxelTip::Round,
            "Round tip",
            "the brush is a ball, from 3 voxels on",
        ),
    ];

    /// The other one.
    pub fn other(self) -> Self {
        match self {
            Self::Block => Self::Round,
            Self::Round => Self::Block,
        }
    }
}

/// Shape that a drag of the brush draws.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PaintShape {
    /// A stroke along the pointer's way; straight with Ctrl.
    #[default]
    Stroke,
    /// An upright rectangle from corner to corner.
    Rectangle,
    /// A straight stroke.
    Line,
    /// An outline, point by point.
    Polygon,
    /// A street along points.
    Street,
    /// Fills connected cells that are alike.
    Fill,
    /// Takes over the layer under the pointer.
    Pick,
}

/// How a region is marked.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum RegionShape {
    /// From corner to corner.
    #[default]
    Rectangle,
    /// Inside of a drawn outline.
    Lasso,
    /// Inside of an outline that is set corner by corner.
    Polygon,
    /// Brush stroke along the pointer's way.
    Brush,
}

impl PaintShape {
    /// True for strokes, whose width the brush has.
    pub fn has_width(self) -> bool {
        matches!(self, PaintShape::Stroke | PaintShape::Line)
    }

    /// Every shape with its name and key.
    pub const ALL: [(PaintShape, &'static str, &'static str); 7] = [
        (PaintShape::Stroke, "Freehand", "B; straight with Ctrl held"),
        (PaintShape::Rectangle, "Rectangle", "U"),
        (PaintShape::Line, "Line", "L"),
        (PaintShape::Polygon, "Polygon", "P"),
        (PaintShape::Street, "Street", "P again"),
        (PaintShape::Fill, "Fill", "K"),
        (PaintShape::Pick, "Pick", "I, or Alt+click"),
    ];
}

/// Mode of the voxel tool.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum VoxelMode {
    /// Follows the pointer.
    #[default]
    Brush,
    /// A box from corner to corner, its height by the wheel.
    Block,
    /// A straight line.
    Row,
    /// Fills connected voxels of one class.
    Fill,
    /// Chooses connected voxels of one class.
    Wand,
    /// Chooses in a box on the ground; the wheel sets its height.
    ChooseBlock,
    /// Chooses in a sphere.
    ChooseSphere,
    /// Chooses in an outline on the screen.
    ChooseLasso,
    /// Chooses in an outline on the screen that is set corner by corner.
    ChoosePolygon,
    /// Pulls a face out or pushes it in.
    Extrude,
    /// Sets down voxels that were kept.
    Stamp,
}

impl VoxelMode {
    /// Every mode with its name and hint.
    pub const ALL: [(VoxelMode, &'static str, &'static str); 11] = [
        (VoxelMode::Brush, "Dab", "B"),
        (VoxelMode::Block, "Block", "U; wheel sets the height"),
        (VoxelMode::Row, "Row", "L"),
        (VoxelMode::Fill, "Flood", "K; connected voxels of one class"),
        (VoxelMode::Extrude, "Pull", "P; drags a face out or in"),
        (VoxelMode::Stamp, "Stamp", "sets down voxels that were kept"),
        (VoxelMode::Wand, "Wand", "Shift+O; chooses connected voxels"),
        (
            VoxelMode::ChooseLasso,
            "Lasso",
            "chooses voxels in an outline on the screen",
        ),
        (
            VoxelMode::ChoosePolygon,
            "Polygon",
            "chooses voxels in an outline that is set corner by corner",
        ),
        (
            VoxelMode::ChooseBlock,
            "In box",
            "chooses voxels in a box; wheel sets the height",
        ),
        (VoxelMode::ChooseSphere, "In sphere", "chooses voxels in a sphere"),
    ];

    /// True if it chooses voxels and changes none.
    pub fn chooses(self) -> bool {
        matches!(
            self,
            Self::Wand | Self::ChooseBlock | Self::ChooseSphere | Self::ChooseLasso | Self::ChoosePolygon
        )
    }
}
