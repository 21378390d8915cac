//! Changes of the road of an open scene: lanes, width, course, walkways, a roundabout.

use scene::roads::{LaneKind, RoadWish};

use super::super::reading::{Feature, What};
use super::super::remark::Remark;
use super::super::stage::Stage;
use place::description::Road;

/// Factors of the lane width of a narrow and of a wide road.
const NARROW: f64 = 0.85;
const WIDE: f64 = 1.2;

/// The change of the road that an act asks for; `None` if only a new scene can have it.
fn wish(what: &What) -> Option<RoadWish> {
    let walk = LaneKind::Walk;
    Some(match what {
        What::Lanes { n } => RoadWish::Lanes { count: *n },
        What::OneWay => RoadWish::OneWay {},
        What::Narrow => RoadWish::Widths { times: NARROW },
        What::Wide => RoadWish::Widths { times: WIDE },
        What::Has {
            what: Feature::Sidewalk,
            ..
        } => RoadWish::Beside {
            kind: walk,
            right: None,
        },
        What::Lacks {
            what: Feature::Sidewalk,
        } => RoadWish::Without { kind: walk },
        What::Road { what: Road::Straight } => RoadWish::Straight {},
        What::Road {
            what: Road::Roundabout,
        } => RoadWish::Roundabout {},
        What::Road {
            what: Road::Intersection,
        } => RoadWish::Junction {},
        _ => return None,
    })
}

impl Stage<'_> {
    /// Changes the road as an act asks.
    pub(super) fn change_road(&mut self, what: &What) {
        match wish(what) {
            Some(wish) => self.wish_of_road(wish),
            None => self.remark(Remark::NotInEdits { what: "the road" }),
        }
    }
}
