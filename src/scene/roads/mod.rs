//! Roads as an editable network: lines with lanes between nodes, and their drawing into a layout.
//!
//! All other code reads the layout (cells and lines). The network stands behind it: a change of the network redraws
//! only the parts that it draws differently from before. Terms are those of OpenDRIVE: lanes are counted from a
//! reference line outward, right ones are driven along it, left ones against it.

mod area;
mod corner;
pub mod curve;
mod draw;
mod network;
mod ring;

use glam::DVec2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::SceneBox;

pub use area::Alongside;
pub use draw::{Junction, LAYERS, RoadDrawing, RoadElement};
pub use network::{Arm, RoadNetwork};

/// Number of a road in its network.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
pub struct RoadId(pub u32);

/// Number of a node in its network.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
pub struct NodeId(pub u32);

/// Purpose of a lane.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum LaneKind {
    /// Vehicles of all kinds.
    #[default]
    Drive,
    /// Buses.
    Bus,
    /// Bicycles.
    Bicycle,
    /// Paved, and not driven on.
    Shoulder,
    /// Parked cars.
    Parking,
    /// People on foot.
    Walk,
    /// Neither paved nor walked on.
    Verge,
}

impl LaneKind {
    /// Every kind with its name for a person.
    pub const ALL: [(Self, &'static str); 7] = [
        (Self::Drive, "Driving"),
        (Self::Bus, "Bus"),
        (Self::Bicycle, "Bicycle"),
        (Self::Shoulder, "Shoulder"),
        (Self::Parking, "Parking"),
        (Self::Walk, "Walkway"),
        (Self::Verge, "Verge"),
    ];

    /// Name for a person.
    pub fn title(self) -> &'static str {
        let row = Self::ALL.iter().find(|k| k.0 == self);
        row.map_or("", |k| k.1)
    }

    /// True if it is part of the carriageway between its kerbs.
    pub fn is_carriageway(self) -> bool {
        matches!(self, Self::Drive | Self::Bus | Self::Bicycle | Self::Shoulder)
    }

    /// True if cars or buses drive along its middle.
    pub fn is_driven(self) -> bool {
        matches!(self, Self::Drive | Self::Bus)
    }

    /// Usual width of a new lane of this kind, m.
    pub fn usual_m(self) -> f64 {
        match self {
            Self::Drive | Self::Bus => 3.5,
            Self::Bicycle => 1.6,
            Self::Shoulder => 1.2,
            Self::Parking => 2.3,
            Self::Walk => 2.4,
            Self::Verge => 1.6,
        }
    }
}

/// One lane of a road.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RoadLane {
    /// Purpose.
    pub kind: LaneKind,
    /// How wide it is, m.
    pub width_m: f64,
}

impl RoadLane {
    /// A lane of that kind, as wide as usual.
    pub fn usual(kind: LaneKind) -> Self {
        Self {
            kind,
            width_m: kind.usual_m(),
        }
    }
}

/// A crossing over a road.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RoadCrossing {
    /// Place of its middle, m along the reference line from its beginning.
    pub at_m: f64,
    /// How wide it is along the road, m.
    pub width_m: f64,
}

/// A line at which one side of a road halts.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RoadStop {
    /// Place, m along the reference line from its beginning.
    pub at_m: f64,
    /// True: the lanes on the right, which are driven along the line.
    pub right: bool,
}

/// A road between two nodes, world frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Road {
    /// Its number.
    pub id: RoadId,
    /// Nodes at which its reference line begins and ends.
    pub ends: [NodeId; 2],
    /// Points between, through which the line runs in a smooth curve, m.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(with = "Vec<[f64; 2]>")]
    pub via_m: Vec<DVec2>,
    /// Lanes are counted from so far to the left of that line, m.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub offset_m: f64,
    /// Lanes left of the line, from the line outward; driven against it.
    #[serde(default)]
    pub left: Vec<RoadLane>,
    /// Lanes right of the line, from the line outward; driven along it.
    pub right: Vec<RoadLane>,
    /// Speed limit, km/h.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limit_kph: Option<f64>,
    /// Crossings.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub crossings: Vec<RoadCrossing>,
    /// Lines to halt at.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub stops: Vec<RoadStop>,
}

impl Road {
    /// Lanes of one side, from the line outward.
    pub fn side(&self, right: bool) -> &[RoadLane] {
        if right { &self.right } else { &self.left }
    }

    /// Lanes of one side, from the line outward.
    pub fn side_mut(&mut self, right: bool) -> &mut Vec<RoadLane> {
        if right { &mut self.right } else { &mut self.left }
    }

    /// Width from the line to the kerb of one side, m: up to the last lane of the carriageway; with `parking`, up to
    /// the last parking lane.
    pub fn kerb_m(&self, right: bool, parking: bool) -> f64 {
        let lanes = self.side(right);
        let counts = |l: &RoadLane| l.kind.is_carriageway() || parking && l.kind == LaneKind::Parking;
        let last = lanes.iter().rposition(counts).map_or(0, |i| i + 1);
        lanes[..last].iter().map(|l| l.width_m).sum()
    }

    /// Width from the line to the outermost edge of one side, m.
    pub fn reach_m(&self, right: bool) -> f64 {
        self.side(right).iter().map(|l| l.width_m).sum()
    }

    /// Number of lanes driven by cars and buses on one side.
    pub fn driven(&self, right: bool) -> usize {
        self.side(right).iter().filter(|l| l.kind.is_driven()).count()
    }

    /// This road as seen from its other end.
    pub fn reversed(&self, length_m: f64) -> Self {
        let [from, to] = self.ends;
        let turned = |s: &RoadStop| RoadStop {
            at_m: length_m - s.at_m,
            right: !s.right,
        };
        let crossing = |c: &RoadCrossing| RoadCrossing {
            at_m: length_m - c.at_m,
            ..*c
        };
        Self {
            ends: [to, from],
            via_m: self.via_m.iter().rev().copied().collect(),
            offset_m: -self.offset_m,
            left: self.right.clone(),
            right: self.left.clone(),
            crossings: self.crossings.iter().map(crossing).collect(),
            stops: self.stops.iter().map(turned).collect(),
            ..self.clone()
        }
    }

    /// This carriageway driven in the opposite direction.
    pub fn turned(&self) -> Self {
        let turned = |s: &RoadStop| RoadStop {
            right: !s.right,
            ..*s
        };
        Self {
            offset_m: self.offset_m + self.reach_m(false) - self.reach_m(true),
            left: self.right.clone(),
            right: self.left.clone(),
            stops: self.stops.iter().map(turned).collect(),
            ..self.clone()
        }
    }
}

/// Kind of a place where roads meet.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum NodeKind {
    /// An end, a joint, or a junction with rounded corners.
    Plain {
        /// Radius of the kerb at its corners, m.
        corner_m: f64,
    },
    /// A ring around an island, driven counter-clockwise.
    Roundabout {
        /// Radius of the island, m.
        island_m: f64,
        /// Width of the ring, m.
        ring_m: f64,
    },
}

impl Default for NodeKind {
    fn default() -> Self {
        Self::Plain { corner_m: 5.0 }
    }
}

/// Where roads end or meet, world frame.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RoadNode {
    /// Its number.
    pub id: NodeId,
    /// Its place, m.
    #[schemars(with = "[f64; 2]")]
    pub at_m: DVec2,
    /// Its kind.
    #[serde(default)]
    pub kind: NodeKind,
}

/// A change of a street as a whole, that is of all roads that continue each other.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum RoadWish {
    /// So many lanes for cars in both directions together; as many on the right as on the left, or one more.
    Lanes {
        /// How many, 1 to 12.
        count: u32,
    },
    /// Traffic in the direction in which one looks alone; its lanes stay as many as they are in all.
    OneWay {},
    /// Lanes for cars so many times as wide, 2.4 to 5 m.
    Widths {
        /// How many times.
        times: f64,
    },
    /// A lane of a kind beside those for cars.
    Beside {
        /// Its kind.
        kind: LaneKind,
        /// True: on the right, as one looks; both sides if left out.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        right: Option<bool>,
    },
    /// No lane of a kind on either side.
    Without {
        /// Its kind.
        kind: LaneKind,
    },
    /// No bends.
    Straight {},
    /// A roundabout at the next junction ahead, or on the street where there is none.
    Roundabout {},
    /// A plain junction in place of the next roundabout.
    Junction {},
}

/// A change of the network. Numbers are those of the network as it is; of a scene without one, those of what is recognised.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum RoadChange {
    /// Takes what is painted and not in the network yet for roads. No cell changes.
    Recognise {},
    /// Lays a road along points; where it meets or crosses others there are junctions.
    Add {
        /// Its reference line, m; at least two points.
        #[schemars(with = "Vec<[f64; 2]>")]
        points_m: Vec<DVec2>,
        /// Lanes left of the line, from the line outward; driven against it.
        #[serde(default)]
        left: Vec<RoadLane>,
        /// Lanes right of the line, from the line outward; driven along it.
        right: Vec<RoadLane>,
        /// Speed limit, km/h.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        limit_kph: Option<f64>,
    },
    /// Gives a road another course, other lanes, marks or limit.
    Put {
        /// The road of that number from now on; its ends stay.
        road: Road,
    },
    /// Moves a node, or makes it a roundabout or a plain junction.
    PutNode {
        /// The node of that number from now on.
        node: RoadNode,
    },
    /// Makes two roads of one.
    Split {
        /// The road.
        id: RoadId,
        /// Near which point of it, m.
        #[schemars(with = "[f64; 2]")]
        at_m: DVec2,
    },
    /// Makes one road of the two that meet at a node; the lanes are those of the longer one.
    Join {
        /// The node.
        node: NodeId,
    },
    /// Makes two nodes one: their roads meet.
    Connect {
        /// The node that goes.
        node: NodeId,
        /// The node that stays.
        to: NodeId,
    },
    /// Lets a road run straight from end to end.
    Straighten {
        /// The road.
        id: RoadId,
    },
    /// Takes a road away.
    Remove {
        /// The road.
        id: RoadId,
    },
    /// A change of the street at a place, independent of the numbers of its roads.
    Wish {
        /// Place, m: the nearest road is meant.
        #[schemars(with = "[f64; 2]")]
        at_m: DVec2,
        /// Which way one looks there, degrees counter-clockwise from x: right and ahead are meant so.
        #[serde(default)]
        heading_deg: f64,
        /// The change.
        wish: RoadWish,
    },
    /// Draws a road anew: what was painted on it goes.
    Redraw {
        /// The road.
        id: RoadId,
    },
}

impl Road {
    /// Most lanes of one side.
    pub const MAX_LANES: usize = 12;
    /// Limits of the width of a lane, m.
    pub const LANE_M: std::ops::RangeInclusive<f64> = 0.4..=30.0;
    /// Limits of a speed limit, km/h.
    pub const LIMIT_KPH: std::ops::RangeInclusive<f64> = 1.0..=300.0;
    /// Most points between its ends.
    pub const MAX_VIA: usize = 10_000;
    /// Greatest length, m.
    pub const MAX_M: f64 = 50_000.0;
    /// Farthest that lanes may lie off the line, m.
    pub const OFFSET_M: std::ops::RangeInclusive<f64> = -100.0..=100.0;

    /// The reason why it cannot be used, in one line; `None` if it is sound.
    pub fn problem(&self) -> Option<String> {
        let name = format!("road {}", self.id.0);
        if self.ends[0] == self.ends[1] && self.via_m.len() < 2 {
            return Some(format!("{name} begins and ends at node {}", self.ends[0].0));
        }
        for lanes in [&self.left, &self.right] {
            if lanes.len() > Self::MAX_LANES {
                let (found, most) = (lanes.len(), Self::MAX_LANES);
                return Some(format!(
                    "{name} has {found} lanes on a side, expected at most {most}"
                ));
            }
            if let Some(lane) = lanes.iter().find(|l| !Self::LANE_M.contains(&l.width_m)) {
                return Some(format!(
                    "{name} has a lane of {} m, expected {} to {} m",
                    lane.width_m,
                    Self::LANE_M.start(),
                    Self::LANE_M.end()
                ));
            }
        }
        if self.left.is_empty() && self.right.is_empty() {
            return Some(format!("{name} has no lane"));
        }
        if self.via_m.len() > Self::MAX_VIA {
            return Some(format!(
                "{name} has {} points, expected at most {}",
                self.via_m.len(),
                Self::MAX_VIA
            ));
        }
        if let Some(p) = self.via_m.iter().find(|p| !is_within(**p)) {
            return Some(format!(
                "{name} runs through {p}, expected numbers within 10000 m"
            ));
        }
        if !Self::OFFSET_M.contains(&self.offset_m) {
            return Some(format!(
                "{name} has an offset of {} m, expected -100 to 100 m",
                self.offset_m
            ));
        }
        if let Some(v) = self.limit_kph.filter(|v| !Self::LIMIT_KPH.contains(v)) {
            return Some(format!("{name} has a limit of {v} km/h, expected 1 to 300"));
        }
        let places = self
            .crossings
            .iter()
            .map(|c| c.at_m)
            .chain(self.stops.iter().map(|s| s.at_m));
        let widths = self.crossings.iter().map(|c| c.width_m);
        if let Some(v) = places
            .chain(widths)
            .find(|v| !(-SceneBox::LIMIT_M..=SceneBox::LIMIT_M).contains(v))
        {
            return Some(format!(
                "{name} has a crossing or stop line at {v} m, expected a number within 10000 m"
            ));
        }
        None
    }
}

impl RoadNode {
    /// Limits of the radius of a corner, m.
    pub const CORNER_M: std::ops::RangeInclusive<f64> = 0.0..=60.0;
    /// Limits of the radius of an island, m.
    pub const ISLAND_M: std::ops::RangeInclusive<f64> = 1.0..=100.0;
    /// Limits of the width of a ring, m.
    pub const RING_M: std::ops::RangeInclusive<f64> = 3.0..=30.0;

    /// The reason why it cannot be used, in one line; `None` if it is sound.
    pub fn problem(&self) -> Option<String> {
        let name = format!("node {}", self.id.0);
        if !is_within(self.at_m) {
            return Some(format!(
                "{name} is at {}, expected numbers within 10000 m",
                self.at_m
            ));
        }
        let bad = |what: &str, v: f64, range: &std::ops::RangeInclusive<f64>| {
            let (low, high) = (range.start(), range.end());
            (!range.contains(&v)).then(|| format!("{name} has {what} of {v} m, expected {low} to {high} m"))
        };
        match self.kind {
            NodeKind::Plain { corner_m } => bad("corners", corner_m, &Self::CORNER_M),
            NodeKind::Roundabout { island_m, ring_m } => {
                bad("an island", island_m, &Self::ISLAND_M).or_else(|| bad("a ring", ring_m, &Self::RING_M))
            }
        }
    }
}

fn is_zero(number: &f64) -> bool {
    *number == 0.0
}

/// True for finite points near enough to the origin.
fn is_within(p: DVec2) -> bool {
    p.abs().cmple(DVec2::splat(SceneBox::LIMIT_M)).all()
}
