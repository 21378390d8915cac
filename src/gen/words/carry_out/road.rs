//! Changes of the road of an open scene: lanes, width, course, walkways, a roundabout.

use scene::roads::{LaneKind, RoadWish};

use super::super::reading::{ActKind, Feature};
use super::super::remark::Remark;
use super::super::stage::Stage;
use place::description::Road;

/// Factors of the lane width of a narrow and of a wide road.
const NARROW: f64 = 0.85;
const WIDE: f64 = 1.2;

/// The change of the road that an act asks for; `None` if only a new scene can have it.
fn wish(what: &ActKind) -> Option<RoadWish> {
    let walk = LaneKind::Walk;
    Some(match what {
        ActKind::Lanes { n } => RoadWish::Lanes { count: *n },
        ActKind::OneWay => RoadWish::OneWay {},
        ActKind::Narrow => RoadWish::Widths { times: NARROW },
        ActKind::Wide => RoadWish::Widths { times: WIDE },
        ActKind::Has {
            what: Feature::Sidewalk,
            ..
        } => RoadWish::Beside {
            kind: walk,
            right: None,
        },
        ActKind::Lacks {
            what: Feature::Sidewalk,
        } => RoadWish::Without { kind: walk },
        ActKind::Road { what: Road::Straight } => RoadWish::Straight {},
        ActKind::Road {
            what: Road::Roundabout,
        } => RoadWish::Roundabout {},
        ActKind::Road {
            what: Road::Intersection,
        } => RoadWish::Junction {},
        _ => return None,
    })
}

impl Stage<'_> {
    /// Changes the road as an act asks.
    pub(super) fn change_road(&mut self, what: &ActKind) {
        match wish(what) {
            Some(wish) => self.wish_of_road(wish),
            None => self.remark(Remark::NotInEdits { what: "the road" }),
        }
    }
}
