//! Marks that a tool draws over a view, as plain data: lines, areas and texts, each with its role.

use glam::{DVec2, DVec3};

use crate::voxel_ops::VoxelIndex;
use scene::{BevLayer, Form, SceneBox};

/// Role of a mark; the window chooses its colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Painted into this layer.
    Paint(BevLayer),
    /// Erased.
    Erase,
    /// Selection or marking.
    Choose,
    /// Measurement.
    Measure,
    /// Drawn at the moment, or under the pointer.
    Hand,
    /// Axis x, y or z.
    Axis(usize),
}

/// A place of the ego frame, m, or of the screen, points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum At {
    /// Ego frame, m.
    Ego(DVec3),
    /// Window, points.
    Screen(DVec2),
}

impl From<DVec2> for At {
    /// A point of the ground at z = 0, m.
    fn from(p_m: DVec2) -> Self {
        Self::Ego(p_m.extend(0.0))
    }
}

impl From<DVec3> for At {
    fn from(p_m: DVec3) -> Self {
        Self::Ego(p_m)
    }
}

/// One thing to draw.
#[derive(Clone, Debug, PartialEq)]
pub enum ToolMark {
    /// A thin line; closed it ends where it began.
    Line(Vec<At>, Role),
    /// A dashed outline.
    Dashed(Vec<At>, Role),
    /// A line of that width, m.
    Ribbon(Vec<DVec2>, f64, Role),
    /// An upright rectangle between two corners.
    Rect(At, At, Role),
    /// Columns of the grid.
    Columns(Vec<[usize; 2]>, Role),
    /// A disc on the ground: middle and radius, m.
    Disc(DVec2, f64, Role),
    /// A point of an outline.
    Dot(At, Role),
    /// A square handle.
    Handle(At),
    /// Text beside a place.
    Tag(At, String),
    /// Text in the middle of a place.
    Label(At, String),
    /// A box that would come.
    Ghost(SceneBox),
    /// A thing of the ego frame that would come.
    Coming(Form),
    /// Voxels that would change, and their colour.
    Voxels(Vec<VoxelIndex>, [u8; 3]),
    /// An arrow of the gizmo; `square`: it ends in a knob.
    Arrow {
        /// Begin and tip.
        ends: [At; 2],
        /// Its axis.
        role: Role,
        /// Under the pointer, or held.
        hot: bool,
        /// Ends in a knob.
        square: bool,
    },
    /// The ring of the gizmo; true under the pointer, or held.
    Ring(Vec<At>, bool),
    /// The knob that raises things; true under the pointer.
    Knob(DVec3, bool),
}
