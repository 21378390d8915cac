//! What a tool is drawing, whichever it is: the pointer goes in, forms come out. All in the ego frame, m.

use glam::DVec2;

use editor::kerb;
use scene::{BevLayout, Form};

use super::building::BuildingDraft;
use super::line::LineDraft;
use super::post::PostDraft;
use super::shrubs::ShrubStroke;
use super::trees::TreeStroke;
use super::{ThingState, ThingTool};

/// What the pointer did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// The button went down.
    Press,
    /// It is held, and the pointer has left the place where it went down.
    Drag,
    /// It came up.
    Release {
        /// Where it went down.
        clicked: bool,
    },
}

/// The pointer on the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pointer {
    /// What it did.
    pub phase: Phase,
    /// Where, ego frame, m.
    pub at_m: DVec2,
    /// Nearer than this counts as the same place, m.
    pub reach_m: f64,
    /// Snaps to nothing.
    pub free: bool,
}

/// What the tools know of the ground.
#[derive(Clone, Copy, Debug)]
pub struct Site<'a> {
    /// Roads and walkways.
    pub layout: &'a BevLayout,
    /// Where trees stand already.
    pub trees_m: &'a [DVec2],
    /// Outlines of buildings.
    pub houses_m: &'a [Vec<DVec2>],
    /// Width of the brush, m.
    pub brush_m: f64,
}

/// How far the kerb catches a point, m.
pub const KERB_M: f64 = 1.0;

impl Site<'_> {
    /// The point beside the kerb if one is near, `clear_m` away from roadway or walkway; else the point itself.
    pub fn beside_kerb(&self, at_m: DVec2, clear_m: f64) -> DVec2 {
        let kerb = kerb::nearest_kerb(self.layout, at_m, KERB_M + clear_m);
        kerb.map_or(at_m, |k| k.at_m + k.away * clear_m)
    }
}

/// What comes of a move of the pointer.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// Nothing that shows in the scene.
    Nothing,
    /// These would come; shown while the button is held.
    Preview(Vec<Form>),
    /// These come, as one undo step.
    Add(Vec<Form>),
    /// Nothing comes, for that reason.
    Refused(String),
}

/// What is being drawn.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Draft {
    /// Nothing.
    #[default]
    None,
    /// A building.
    Building(BuildingDraft),
    /// Trees.
    Trees(TreeStroke),
    /// A line.
    Line(LineDraft),
    /// Shrubs.
    Shrubs(ShrubStroke),
    /// A post.
    Post(PostDraft),
}

impl Draft {
    /// Begins with a tool what is not begun yet, and takes the pointer.
    pub fn pointer(
        &mut self,
        tool: ThingTool,
        pointer: &Pointer,
        site: &Site<'_>,
        options: &ThingState,
    ) -> Outcome {
        let fits = matches!(
            (&*self, tool),
            (Self::Building(_), ThingTool::Building)
                | (Self::Trees(_), ThingTool::Tree)
                | (Self::Line(_), ThingTool::Line)
                | (Self::Shrubs(_), ThingTool::Shrubs)
                | (Self::Post(_), ThingTool::Post)
        );
        if !fits {
            // What was let go of elsewhere is not for this tool.
            if pointer.phase != Phase::Press {
                return Outcome::Nothing;
            }
            *self = match tool {
                ThingTool::Building => Self::Building(BuildingDraft::default()),
                ThingTool::Tree => Self::Trees(TreeStroke::default()),
                ThingTool::Line => Self::Line(LineDraft::default()),
                ThingTool::Shrubs => Self::Shrubs(ShrubStroke::default()),
                ThingTool::Post => Self::Post(PostDraft::default()),
            };
        }
        let outcome = match self {
            Self::None => Outcome::Nothing,
            Self::Building(draft) => draft.pointer(pointer, site, options),
            Self::Trees(draft) => draft.pointer(pointer, site, options),
            Self::Line(draft) => draft.pointer(pointer, site, options),
            Self::Shrubs(draft) => draft.pointer(pointer, site, options),
            Self::Post(draft) => draft.pointer(pointer, site, options),
        };
        if matches!(outcome, Outcome::Add(_)) {
            *self = Self::None;
        }
        outcome
    }

    /// Ends what is drawn point by point.
    pub fn finish(&mut self, options: &ThingState) -> Outcome {
        let outcome = match self {
            Self::Building(draft) => draft.finish(options),
            Self::Line(draft) => draft.finish(options),
            _ => Outcome::Nothing,
        };
        if matches!(outcome, Outcome::Add(_)) {
            *self = Self::None;
        }
        outcome
    }

    /// Points set so far of what waits for more of them.
    pub fn points_m(&self) -> &[DVec2] {
        match self {
            Self::Building(draft) => &draft.corners_m,
            Self::Line(draft) => &draft.points_m,
            _ => &[],
        }
    }

    /// Takes the last point back.
    pub fn drop_point(&mut self) {
        match self {
            Self::Building(draft) => drop(draft.corners_m.pop()),
            Self::Line(draft) => drop(draft.points_m.pop()),
            _ => {}
        }
    }
}
