//! The pointer on the ground goes in, forms come out: what the tools for things share. All in the ego frame, m.

use glam::DVec2;

use crate::kerb;
use scene::{BevLayout, Form};

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
