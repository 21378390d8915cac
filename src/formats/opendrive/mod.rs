//! OpenDRIVE roads (ASAM OpenDRIVE 1.4 to 1.8, `.xodr`): read a road network, cut a layout out of it.

pub mod bounds;
mod cost;
mod decks;
pub mod elevation;
pub mod geometry;
pub mod lanes;
mod layout;
mod levels;
mod lines;
pub mod objects;
pub mod own_rows;
mod parse;
mod parse_elevation;
mod parse_lanes;
mod parse_objects;
mod pose;
mod relief;
mod sampling;
pub mod standing;
mod things;
mod tidy;
pub mod write;
pub(crate) mod xml;

pub use layout::LayoutImport;
pub use parse::read;
pub use pose::LanePose;
pub use xml::{OpenDriveError, Skipped};

use std::sync::Arc;

use elevation::SurfaceProfile;
use geometry::ReferenceLine;
use glam::DVec2;
use lanes::{Cubics, LaneGround, LaneSection};
use objects::RoadObject;
use own_rows::OwnLayout;
use scene::{Polyline, SceneBox};

/// Largest file that is read, bytes.
pub const LARGEST_FILE: u64 = 256 << 20;

/// The roads of one file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RoadNetwork {
    /// Name in the header; often empty.
    pub name: String,
    /// At least one.
    pub roads: Vec<XodrRoad>,
    /// May be empty.
    pub junctions: Vec<XodrJunction>,
    /// Parts of the file that this reader does not understand or model, counted by kind.
    pub skipped: Skipped,
    /// The layout that the roads were made of, where Sceneloom wrote the file.
    pub own: Option<Arc<OwnLayout>>,
    /// Lines and areas on the ground besides the roads; empty for OpenDRIVE.
    pub drawn: RoadlessGeometry,
    /// Boxes that stand or drive on the roads, by the file, in its frame, on ground at 0; empty for OpenDRIVE.
    pub boxes: Vec<SceneBox>,
    /// Where the file says that the ego vehicle begins: place in m and heading in rad, in the file's frame.
    pub start: Option<(DVec2, f64)>,
    marks_known: bool, // false for a file without any road mark: every lane edge is drawn then
}

/// Lines and areas that belong to no road, in the file's frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RoadlessGeometry {
    /// Dividers, stop lines, and outlines of crossings.
    pub lines: Vec<Polyline>,
    /// Outlines of ground, m.
    pub areas: Vec<(LaneGround, Vec<DVec2>)>,
}

/// A road: a reference line with lanes on both sides.
#[derive(Clone, Debug, PartialEq)]
pub struct XodrRoad {
    /// Id in the file.
    pub id: String,
    /// The junction this road connects through, if it is a connecting road.
    pub junction: Option<String>,
    /// True for left-hand traffic.
    pub left_hand: bool,
    /// Neighbour before its start.
    pub predecessor: Option<RoadEnd>,
    /// Neighbour beyond its end.
    pub successor: Option<RoadEnd>,
    /// Speed limits of all its lanes, mm/s, each from an s in m on, in order; `None` for a part without a limit.
    pub limits: Vec<(f64, Option<u32>)>,
    /// Plan view.
    pub reference: ReferenceLine,
    /// Height and tilt.
    pub surface: SurfaceProfile,
    /// Shift of the centre lane from the reference line, left positive.
    pub lane_offset: Cubics,
    /// In order, without gaps.
    pub sections: Vec<LaneSection>,
    /// Crossings, parking spaces, stop lines, and objects that stand beside the road.
    pub objects: Vec<RoadObject>,
}

/// Neighbour at an end of a road.
#[derive(Clone, Debug, PartialEq)]
pub enum RoadEnd {
    /// The road with this id.
    Road(String),
    /// The junction with this id.
    Junction(String),
}

/// A junction. Its ground is that of its connecting roads.
#[derive(Clone, Debug, PartialEq)]
pub struct XodrJunction {
    /// Id in the file.
    pub id: String,
    /// Ids of the roads that lead into it, each once.
    pub incoming: Vec<String>,
    /// Number of connections.
    pub connections: usize,
}

impl XodrRoad {
    /// Length by its geometry, m.
    pub fn length_m(&self) -> f64 {
        self.reference.end_s_m()
    }

    /// The speed limit at `s_m`, mm/s.
    pub fn limit_at(&self, s_m: f64) -> Option<u32> {
        let from = self.limits.partition_point(|(from_m, _)| *from_m <= s_m);
        self.limits.get(from.checked_sub(1)?)?.1
    }

    /// The section that holds `s_m`; the first or last outside, `None` for a road without lanes.
    pub fn section_at(&self, s_m: f64) -> Option<&LaneSection> {
        let after = self.sections.partition_point(|section| section.start_s_m <= s_m);
        self.sections.get(after.max(1) - 1)
    }
}

impl RoadNetwork {
    /// Roads that were made of lanelets.
    pub(crate) fn of_lanelets(
        name: String,
        roads: Vec<XodrRoad>,
        junctions: Vec<XodrJunction>,
        drawn: RoadlessGeometry,
        boxes: Vec<SceneBox>,
        start: Option<(DVec2, f64)>,
        skipped: Skipped,
    ) -> Self {
        Self {
            name,
            roads,
            junctions,
            skipped,
            drawn,
            boxes,
            start,
            own: None,
            marks_known: true,
        }
    }

    /// Length of all roads together, connecting roads included, m.
    pub fn length_m(&self) -> f64 {
        self.roads.iter().map(XodrRoad::length_m).sum()
    }
}
