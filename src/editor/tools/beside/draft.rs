//! Common types of the scenery tools: pointer positions on the ground go in, forms come out. All in the ego frame, m.

use glam::DVec2;

use crate::kerb;
use scene::{BevLayout, Form};

/// Phase of a press of the button.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// The button went down.
    Press,
    /// The button is held, and the pointer has left the place where it went down.
    Drag,
    /// The button came up.
    Release {
        /// True if it came up where it went down.
        clicked: bool,
    },
}

/// The pointer on the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundPointer {
    /// Phase of the press.
    pub phase: Phase,
    /// Position, ego frame, m.
    pub at_m: DVec2,
    /// Nearer than this counts as the same place, m.
    pub reach_m: f64,
    /// True if it snaps to nothing.
    pub free: bool,
}

/// Surroundings that the scenery tools read.
#[derive(Clone, Copy, Debug)]
pub struct SceneryContext<'a> {
    /// Roads and walkways.
    pub layout: &'a BevLayout,
    /// Places of the trees that are there.
    pub trees_m: &'a [DVec2],
    /// Outlines of buildings.
    pub houses_m: &'a [Vec<DVec2>],
    /// Width of the brush, m.
    pub brush_m: f64,
}

/// How far the kerb catches a point, m.
pub const KERB_M: f64 = 1.0;

impl SceneryContext<'_> {
    /// The point beside the kerb if one is near, `clear_m` away from roadway or walkway; else the point itself.
    pub fn beside_kerb(&self, at_m: DVec2, clear_m: f64) -> DVec2 {
        let kerb = kerb::nearest_kerb(self.layout, at_m, KERB_M + clear_m);
        kerb.map_or(at_m, |k| k.at_m + k.away * clear_m)
    }
}

/// Result of a pointer event.
#[derive(Clone, Debug, PartialEq)]
pub enum DraftResponse {
    /// No change that shows in the scene.
    Nothing,
    /// Forms that would be added; shown while the button is held.
    Preview(Vec<Form>),
    /// Forms that are added, as one undo step.
    Add(Vec<Form>),
    /// Refused, with the reason; no form is added.
    Refused(String),
}
