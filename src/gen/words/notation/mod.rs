//! The one-line form of a reading: `move the truck to ( ahead ego 25m ) ; time night`. Its grammar is in
//! `training/words/notation.md`; the reader network outputs it, and labelled sentences are written in it.

mod parse;
#[cfg(test)]
mod tests;
mod write;

pub use parse::{LONGEST, NotationError, Prefix, parse, prefix};
pub use write::{thing, write};

use super::reading::Anchor;
use scene::Paint;
use scene::clip::Pace;
use scene::graph::{LaneRole, ObjectState, SizeHint};

const ANCHORS: [(&str, Anchor); 17] = [
    ("ego", Anchor::Ego),
    ("crossing", Anchor::Crossing),
    ("junction", Anchor::Junction),
    ("ego_lane", Anchor::Lane(LaneRole::Ego)),
    ("left_lane", Anchor::Lane(LaneRole::Left)),
    ("right_lane", Anchor::Lane(LaneRole::Right)),
    ("oncoming_lane", Anchor::Lane(LaneRole::Oncoming)),
    ("cross_street", Anchor::Lane(LaneRole::Cross)),
    ("road", Anchor::Lane(LaneRole::Road)),
    ("roadside", Anchor::Lane(LaneRole::Roadside)),
    ("left_roadside", Anchor::Lane(LaneRole::LeftRoadside)),
    ("right_roadside", Anchor::Lane(LaneRole::RightRoadside)),
    ("sidewalk", Anchor::Lane(LaneRole::Sidewalk)),
    ("left_sidewalk", Anchor::Lane(LaneRole::LeftSidewalk)),
    ("right_sidewalk", Anchor::Lane(LaneRole::RightSidewalk)),
    ("carpark", Anchor::Lane(LaneRole::Carpark)),
    ("other_side", Anchor::OtherSide),
];
const MORE_ANCHORS: [(&str, Anchor); 2] = [
    ("other_lane", Anchor::OtherLane),
    ("each_other", Anchor::EachOther),
];
const STATES: [(&str, ObjectState); 3] = [
    ("moving", ObjectState::Moving),
    ("parked", ObjectState::Parked),
    ("waiting", ObjectState::Waiting),
];
const PACES: [(&str, Pace); 2] = [("fast", Pace::Fast), ("slow", Pace::Slow)];
const SIZES: [(&str, SizeHint); 2] = [("small", SizeHint::Small), ("large", SizeHint::Large)];

fn anchors() -> impl Iterator<Item = (&'static str, Anchor)> {
    ANCHORS.into_iter().chain(MORE_ANCHORS)
}

fn paint(name: &str) -> Option<Paint> {
    Paint::ALL.into_iter().find(|p| p.name() == name)
}

/// Names of roads as the notation has them: no hyphens.
fn plain(name: &str) -> String {
    name.replace('-', "_")
}

/// The anchor of a name.
pub(super) fn anchor_of(name: &str) -> Option<Anchor> {
    anchors().find(|a| a.0 == name).map(|a| a.1)
}
