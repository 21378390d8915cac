//! Lists that are ordered by distance: "nearest first: a cyclist, then a bus, then a tanker".

use super::description::{Anchor, Stated};
use super::parse::Parser;
use crate::scene::graph::{LaneRole as L, RelationKind as R};

/// What says that a list goes from near to far.
pub const NEAR_FIRST: &str = "nearest first|closest first|the nearest first|the closest first|from near to far|from nearest to farthest|from nearest to furthest|from the nearest to the farthest|from the nearest to the furthest|from closest to farthest|from closest to furthest|in order of distance|in order of increasing distance|starting with the nearest|starting with the closest|starting from the nearest|starting nearest|near to far|from close to far|one after the other from near to far";
/// The other way round.
pub const FAR_FIRST: &str = "farthest first|furthest first|the farthest first|the furthest first|from far to near|from farthest to nearest|from furthest to nearest|in order of decreasing distance|starting with the farthest|starting with the furthest|far to near";

impl Parser<'_> {
    /// A list ordered by distance begins, or goes on, here.
    pub(super) fn ordered_by(&mut self, words: &str) {
        self.order = Some((words == "nearfirst", None));
    }

    /// The next of such a list: farther on than the one before, or nearer.
    pub(super) fn next_in_order(&mut self, index: usize) {
        let Some((near_first, before)) = self.order else {
            return;
        };
        self.order = Some((near_first, Some(index)));
        let m = &mut self.mentions[index];
        let Some(before) = before.filter(|b| *b != index) else {
            // what is told by distance is seen ahead, if nothing else was said
            let told = m.spec.relations.iter().any(|r| {
                r.anchor == Anchor::Ego
                    && matches!(r.relation, R::InFrontOf | R::Behind | R::OppositeDirection)
            });
            if !told {
                m.spec.relations.push(Stated {
                    relation: R::InFrontOf,
                    anchor: Anchor::Ego,
                    and: None,
                    distance_m: None,
                    span: m.spec.span,
                });
            }
            return;
        };
        // seen from something that faces us, what is farther on is behind it
        let faces_us = m.spec.relations.iter().any(|r| {
            matches!(r.anchor, Anchor::Lane(L::LeftRoadside | L::Oncoming))
                || r.relation == R::OppositeDirection
        });
        let behind_us = m
            .spec
            .relations
            .iter()
            .any(|r| r.relation == R::Behind && r.anchor == Anchor::Ego);
        let relation = if near_first ^ faces_us ^ behind_us {
            R::InFrontOf
        } else {
            R::Behind
        };
        m.spec.relations.push(Stated {
            relation,
            anchor: Anchor::Object(before),
            and: None,
            distance_m: None,
            span: m.spec.span,
        });
    }
}
