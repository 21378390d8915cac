//! The one-line form of a reading: `move the truck to ( ahead ego 25m ) ; time night`. Its grammar is in
//! `training/words/notation.md`; the reader network outputs it, and labelled sentences are written in it.

mod parse;
#[cfg(test)]
mod tests;
mod write;

pub use parse::{LONGEST, NotationError, Prefix, parse, prefix};
pub use write::{thing, write};

use super::reading::AnchorPhrase;
use scene::Paint;
use scene::clip::Pace;
use scene::graph::{LaneRole, ObjectState, SizeHint};

const ANCHORS: [(&str, AnchorPhrase); 17] = [
    ("ego", AnchorPhrase::Ego),
    ("crossing", AnchorPhrase::Crossing),
    ("junction", AnchorPhrase::Junction),
    ("ego_lane", AnchorPhrase::Lane(LaneRole::Ego)),
    ("left_lane", AnchorPhrase::Lane(LaneRole::Left)),
    ("right_lane", AnchorPhrase::Lane(LaneRole::Right)),
    ("oncoming_lane", AnchorPhrase::Lane(LaneRole::Oncoming)),
    ("cross_street", AnchorPhrase::Lane(LaneRole::Cross)),
    ("road", AnchorPhrase::Lane(LaneRole::Road)),
    ("roadside", AnchorPhrase::Lane(LaneRole::Roadside)),
    ("left_roadside", AnchorPhrase::Lane(LaneRole::LeftRoadside)),
    ("right_roadside", AnchorPhrase::Lane(LaneRole::RightRoadside)),
    ("sidewalk", AnchorPhrase::Lane(LaneRole::Sidewalk)),
    ("left_sidewalk", AnchorPhrase::Lane(LaneRole::LeftSidewalk)),
    ("right_sidewalk", AnchorPhrase::Lane(LaneRole::RightSidewalk)),
    ("carpark", AnchorPhrase::Lane(LaneRole::Carpark)),
    ("other_side", AnchorPhrase::OtherSide),
];
const MORE_ANCHORS: [(&str, AnchorPhrase); 2] = [
    ("other_lane", AnchorPhrase::OtherLane),
    ("each_other", AnchorPhrase::EachOther),
];
const STATES: [(&str, ObjectState); 3] = [
    ("moving", ObjectState::Moving),
    ("parked", ObjectState::Parked),
    ("waiting", ObjectState::Waiting),
];
const PACES: [(&str, Pace); 2] = [("fast", Pace::Fast), ("slow", Pace::Slow)];
const SIZES: [(&str, SizeHint); 2] = [("small", SizeHint::Small), ("large", SizeHint::Large)];

fn anchors() -> impl Iterator<Item = (&'static str, AnchorPhrase)> {
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
pub(super) fn anchor_of(name: &str) -> Option<AnchorPhrase> {
    anchors().find(|a| a.0 == name).map(|a| a.1)
}
