//! Places that follow from others that were said: what is parked behind something parked stands in the same strip, what drives
//! behind an oncoming bus comes towards us, too, what is drawn hangs on what draws it.

use super::description::{Anchor, Stated};
use super::mention::Mention;
use crate::scene::Class;
use crate::scene::graph::{LaneRole, ObjectState, RelationKind as R};

/// Middle of a trailer behind the middle of what draws it, m.
fn hitch_m(class: Class) -> f64 {
    if class == Class::Car { 8.5 } else { 11.0 }
}

/// So far ahead of the ego vehicle that another stands between them, m.
fn room_m(front: Class, behind: Class) -> f64 {
    let long = |c: Class| match c {
        Class::Bus | Class::Truck | Class::Trailer | Class::ConstructionVehicle => 11.0,
        Class::Car => 5.5,
        _ => 2.5,
    };
    9.0 + long(front) / 2.0 + long(behind)
}

fn is_ahead_of_ego(r: &Stated) -> bool {
    r.relation == R::InFrontOf && r.anchor == Anchor::Ego
}

fn is_lane(a: Anchor) -> bool {
    matches!(a, Anchor::Lane(_))
}

/// Adds them.
pub fn infer(mentions: &mut [Mention]) {
    for i in 0..mentions.len() {
        blocked_at(&mut mentions[i]);
        stranded(&mut mentions[i]);
        crosses(&mut mentions[i]);
        on_its_lane(&mut mentions[i]);
        pavement_beside(mentions, i);
        comes_towards(&mut mentions[i]);
        waits_for_crossers(mentions, i);
        goes_with(mentions, i);
        let along: Vec<(Stated, usize)> = mentions[i]
            .spec
            .relations
            .iter()
            .filter_map(|r| match (r.relation, r.anchor) {
                (R::Behind | R::InFrontOf | R::Following, Anchor::Object(k)) if k != i => Some((*r, k)),
                _ => None,
            })
            .collect();
        for (r, k) in along {
            let Some(other) = mentions.get(k).cloned() else {
                continue;
            };
            if let Some(more) = same_strip(&mentions[i], &other).or_else(|| same_way(&mentions[i], &other)) {
                if more.relation == R::ParkedOn {
                    mentions[i].spec.state = Some(ObjectState::Parked);
                }
                mentions[i].spec.relations.push(Stated { span: r.span, ..more });
            }
            drawn(&mut mentions[i], &other, k);
            let ahead = mentions[i].spec.relations.iter().any(is_ahead_of_ego);
            let room = mentions[i].spec.class == Class::Trailer || ahead && mentions[i].spec.count.n == 1;
            let mut room_m = room_m(other.spec.class, mentions[i].spec.class);
            // "a lorry ahead of us is followed by two cars": both find room between it and us
            let several = mentions[i].spec.count.n == 2
                && r.relation == R::Following
                && mentions[i].spec.class == Class::Car
                && !mentions[i].spec.relations.iter().any(|r| r.anchor == Anchor::Ego);
            if several {
                room_m += 8.0;
            }
            let room = room || several;
            let far = mentions[k].spec.relations.iter_mut().find(|r| is_ahead_of_ego(r));
            if let (Some(far), true, R::Behind | R::Following) =
                (far, room && other.spec.count.n == 1, r.relation)
            {
                far.distance_m = far.distance_m.or(Some(room_m));
            }
        }
    }
}

/// "a barrier blocks our lane 25 m out": so far ahead.
fn blocked_at(m: &mut Mention) {
    let ahead = m
        .spec
        .relations
        .iter()
        .any(|r| r.anchor == Anchor::Ego && matches!(r.relation, R::InFrontOf | R::Behind));
    let far = m.spec.relations.iter_mut().find(|r| {
        matches!(r.relation, R::Blocking | R::Crossing | R::On) && is_lane(r.anchor) && r.distance_m.is_some()
    });
    if let Some(r) = far {
        let stated = Stated {
            relation: R::InFrontOf,
            anchor: Anchor::Ego,
            ..*r
        };
        r.distance_m = None;
        if !ahead {
            m.spec.relations.push(stated);
        }
    }
}

/// What broke down where the traffic goes is not parked: it stands there.
fn stranded(m: &mut Mention) {
    let there = m.spec.relations.iter().any(|r| {
        r.relation == R::On
            && matches!(
                r.anchor,
                Anchor::Junction
                    | Anchor::Crossing
                    | Anchor::Lane(LaneRole::Ego | LaneRole::Left | LaneRole::Right | LaneRole::Oncoming)
            )
    });
    if there && m.spec.state == Some(ObjectState::Parked) {
        m.spec.state = Some(ObjectState::Waiting);
    }
}

/// Who crosses the road is no longer on the pavement where the others of the group are.
fn crosses(m: &mut Mention) {
    let over = m
        .spec
        .relations
        .iter()
        .any(|r| r.relation == R::Crossing && matches!(r.anchor, Anchor::Lane(LaneRole::Road)));
    let left = m.spec.relations.len();
    if over && m.spec.class == Class::Pedestrian {
        m.spec.relations.retain(|r| {
            !(r.relation == R::On
                && matches!(
                    r.anchor,
                    Anchor::Lane(LaneRole::Sidewalk | LaneRole::LeftSidewalk | LaneRole::RightSidewalk)
                ))
        });
    }
    // (the side of the road was that of the pavement)
    if m.spec.relations.len() < left {
        m.spec
            .relations
            .retain(|r| !(matches!(r.relation, R::LeftOf | R::RightOf) && r.anchor == Anchor::Ego));
    }
}

/// "the street is full of people: eight on the left pavement": who is on a strip of the road is not just on the road.
fn on_its_lane(m: &mut Mention) {
    let strip = m.spec.relations.iter().any(|r| {
        matches!(r.relation, R::On | R::ParkedOn)
            && matches!(r.anchor, Anchor::Lane(role) if role != LaneRole::Road)
    });
    if strip {
        m.spec
            .relations
            .retain(|r| !(r.relation == R::On && r.anchor == Anchor::Lane(LaneRole::Road)));
    }
}

/// "a van stands at the right kerb, and its driver walks to it along the pavement": along the right one.
fn pavement_beside(mentions: &mut [Mention], i: usize) {
    let m = &mentions[i];
    let side = m.spec.relations.iter().find_map(|r| {
        let near = matches!(r.relation, R::NextTo | R::Near | R::Facing);
        let Anchor::Object(k) = r.anchor else {
            return None;
        };
        let other = mentions.get(k).filter(|_| near)?;
        other.spec.relations.iter().find_map(|o| match o.anchor {
            Anchor::Lane(LaneRole::RightRoadside | LaneRole::RightSidewalk) => Some(LaneRole::RightSidewalk),
            Anchor::Lane(LaneRole::LeftRoadside | LaneRole::LeftSidewalk) => Some(LaneRole::LeftSidewalk),
            _ => None,
        })
    });
    let Some(side) = side else {
        return;
    };
    for r in &mut mentions[i].spec.relations {
        if r.relation == R::On && r.anchor == Anchor::Lane(LaneRole::Sidewalk) {
            r.anchor = Anchor::Lane(side);
        }
    }
}

/// Who drives towards the ego vehicle comes from ahead, the other way, if nothing else was said.
fn comes_towards(m: &mut Mention) {
    let drives = m.spec.class.is_vehicle() || matches!(m.spec.class, Class::Motorcycle | Class::Bicycle);
    let told = m.spec.relations.iter().any(|r| {
        r.anchor == Anchor::Ego
            && matches!(
                r.relation,
                R::Behind | R::LeftOf | R::RightOf | R::SameDirection | R::OppositeDirection
            )
            || matches!(r.anchor, Anchor::Lane(role) if !matches!(role, LaneRole::Road | LaneRole::Oncoming))
            || r.relation == R::Crossing
    });
    let still = matches!(m.spec.state, Some(ObjectState::Parked | ObjectState::Waiting));
    if !drives || told || still {
        return;
    }
    for r in &mut m.spec.relations {
        if r.relation == R::Facing && r.anchor == Anchor::Ego {
            r.relation = R::OppositeDirection;
        }
    }
}

/// Who has stopped for people on the stripes, or simply waits where people cross them, waits at the crossing.
fn waits_for_crossers(mentions: &mut [Mention], i: usize) {
    let crossing = |m: &Mention| {
        m.spec.class == Class::Pedestrian
            && !m.gone
            && m.spec
                .relations
                .iter()
                .any(|r| matches!(r.relation, R::On | R::WaitingAt) && r.anchor == Anchor::Crossing)
    };
    let m = &mentions[i];
    let drives = m.spec.class.is_vehicle() || matches!(m.spec.class, Class::Motorcycle | Class::Bicycle);
    let waits = m.spec.state == Some(ObjectState::Waiting);
    let at_crossing = m
        .spec
        .relations
        .iter()
        .any(|r| r.anchor == Anchor::Crossing && matches!(r.relation, R::Near | R::NextTo));
    let on_it =
        m.spec.relations.iter().any(|r| {
            r.anchor == Anchor::Crossing && matches!(r.relation, R::On | R::WaitingAt | R::Blocking)
        });
    let placed = m.spec.relations.iter().any(|r| {
        matches!(r.anchor, Anchor::Lane(role) if !matches!(role, LaneRole::Ego | LaneRole::Oncoming | LaneRole::Left | LaneRole::Right))
            || r.distance_m.is_some()
            || matches!(r.anchor, Anchor::Junction)
            || matches!(r.anchor, Anchor::Object(k) if !mentions.get(k).is_some_and(crossing))
    });
    let for_them = m.spec.relations.iter().any(|r| {
        r.relation == R::NextTo
            && matches!(r.anchor, Anchor::Object(k) if mentions.get(k).is_some_and(crossing))
    });
    let someone = mentions.iter().any(crossing);
    // told no more than where it comes from
    let open = m.spec.relations.iter().all(|r| {
        matches!(r.relation, R::OppositeDirection | R::Facing | R::SameDirection)
            || r.anchor == Anchor::Lane(LaneRole::Oncoming)
    });
    if !drives || on_it || placed || !(for_them || waits && (at_crossing || someone && open)) {
        return;
    }
    let span = m.spec.span;
    let m = &mut mentions[i];
    m.spec.relations.retain(|r| {
        !(matches!(r.relation, R::NextTo | R::Near)
            && matches!(r.anchor, Anchor::Object(_) | Anchor::Crossing))
    });
    m.spec.state = Some(ObjectState::Waiting);
    m.spec.relations.push(Stated {
        relation: R::WaitingAt,
        anchor: Anchor::Crossing,
        and: None,
        distance_m: None,
        span,
    });
}

/// Who is with others is where they are; where the companions were said to be, the others are, too.
fn goes_with(mentions: &mut [Mention], i: usize) {
    let Some(host) = mentions[i].host.filter(|h| *h < mentions.len() && *h != i) else {
        return;
    };
    // "a van with a trailer drives in front of us": the trailer hangs on the van
    let hangs = mentions[i].spec.class == Class::Trailer
        && mentions[host].spec.class.is_vehicle()
        && !mentions[i]
            .spec
            .relations
            .iter()
            .any(|r| matches!(r.anchor, Anchor::Object(_)));
    if hangs {
        let span = mentions[i].spec.span;
        let theirs = mentions[host].spec.relations.clone();
        let m = &mut mentions[i].spec;
        m.relations.retain(|r| {
            !theirs
                .iter()
                .any(|t| (t.relation, t.anchor) == (r.relation, r.anchor))
        });
        m.relations.push(Stated {
            relation: R::Following,
            anchor: Anchor::Object(host),
            and: None,
            distance_m: None,
            span,
        });
        return;
    }
    let person = |m: &Mention| m.spec.class == Class::Pedestrian && !m.gone;
    if !person(&mentions[i]) || !person(&mentions[host]) {
        return;
    }
    let span = mentions[i].spec.span;
    let placed = |m: &Mention| {
        m.spec
            .relations
            .iter()
            .any(|r| !matches!(r.anchor, Anchor::Object(_)))
    };
    if placed(&mentions[i]) && !placed(&mentions[host]) {
        let theirs: Vec<Stated> = mentions[i].spec.relations.clone();
        mentions[host].spec.relations.extend(
            theirs
                .into_iter()
                .filter(|r| !matches!(r.anchor, Anchor::Object(k) if k == host)),
        );
    } else if !mentions[i]
        .spec
        .relations
        .iter()
        .any(|r| is_lane(r.anchor) || matches!(r.anchor, Anchor::Crossing | Anchor::Junction))
        && placed(&mentions[host])
    {
        // (a strip is where all of them are; the rest holds for who was named)
        let strips: Vec<Stated> = mentions[host]
            .spec
            .relations
            .iter()
            .filter(|r| is_lane(r.anchor) || matches!(r.anchor, Anchor::Crossing))
            .copied()
            .collect();
        mentions[i].spec.relations.extend(strips);
    }
    let near = mentions[i]
        .spec
        .relations
        .iter()
        .chain(&mentions[host].spec.relations)
        .any(|r| matches!(r.anchor, Anchor::Object(k) if k == host || k == i));
    if !near {
        mentions[i].spec.relations.push(Stated {
            relation: R::NextTo,
            anchor: Anchor::Object(host),
            and: None,
            distance_m: None,
            span,
        });
    }
}

/// The strip in which something parked before or behind this stands.
fn same_strip(m: &Mention, other: &Mention) -> Option<Stated> {
    // ("behind that a second one": alike in this, too)
    let alike = m.spec.state.is_none() && m.spec.class == other.spec.class && m.spec.relations.len() == 1;
    let parked =
        (alike || m.spec.state == Some(ObjectState::Parked)) && other.spec.state == Some(ObjectState::Parked);
    let placed = m
        .spec
        .relations
        .iter()
        .any(|r| matches!(r.relation, R::On | R::ParkedOn) && is_lane(r.anchor));
    let strip = other.spec.relations.iter().find(|r| {
        matches!(r.relation, R::On | R::ParkedOn)
            && matches!(
                r.anchor,
                Anchor::Lane(
                    LaneRole::LeftRoadside | LaneRole::RightRoadside | LaneRole::Roadside | LaneRole::Carpark
                )
            )
    })?;
    (parked && !placed && m.spec.class.is_vehicle()).then_some(Stated {
        relation: R::ParkedOn,
        distance_m: None,
        ..*strip
    })
}

/// The way that something oncoming before or behind this goes.
fn same_way(m: &Mention, other: &Mention) -> Option<Stated> {
    let drives =
        |m: &Mention| m.spec.class.is_vehicle() || matches!(m.spec.class, Class::Motorcycle | Class::Bicycle);
    let ways = |r: &&Stated| {
        matches!(r.relation, R::OppositeDirection | R::SameDirection) && r.anchor == Anchor::Ego
    };
    let told = m.spec.relations.iter().any(|r| {
        ways(&r)
            || r.anchor == Anchor::Ego
                && matches!(r.relation, R::Facing | R::FacingAway | R::InFrontOf | R::Behind)
            || is_lane(r.anchor)
    });
    let still = matches!(m.spec.state, Some(ObjectState::Parked | ObjectState::Waiting));
    // "in the oncoming lane a bus, and after it two cars": in that lane
    let lane = |r: &&Stated| {
        r.relation == R::On
            && matches!(
                r.anchor,
                Anchor::Lane(LaneRole::Left | LaneRole::Right | LaneRole::Oncoming)
            )
    };
    let mut theirs = other.spec.relations.iter();
    let way = theirs.clone().find(ways).or_else(|| theirs.find(lane))?;
    (drives(m) && drives(other) && !told && !still).then_some(Stated {
        distance_m: None,
        ..*way
    })
}

/// A trailer hangs close behind what draws it; how far that is says nothing of the trailer.
fn drawn(m: &mut Mention, other: &Mention, by: usize) {
    if m.spec.class != Class::Trailer || !other.spec.class.is_vehicle() {
        return;
    }
    let theirs: Vec<Option<f64>> = other.spec.relations.iter().map(|r| r.distance_m).collect();
    for r in &mut m.spec.relations {
        if r.relation == R::Following && r.anchor == Anchor::Object(by) {
            r.distance_m = r.distance_m.or(Some(hitch_m(other.spec.class)));
        } else if r.anchor == Anchor::Ego && r.distance_m.is_some() && theirs.contains(&r.distance_m) {
            r.distance_m = None;
        }
    }
}
