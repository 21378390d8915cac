//! The road for a description: a template and the seed whose variation has what is asked for.

use super::description::{Anchor, Description, Environment, Road};
use super::lanes::LaneMap;
use super::to_graph::roles;
use scene::graph::{LaneRole, NodeKind, ObjectState, RelationKind, SceneGraph};
use scene::{BevLayer, BevLayout, PolylineKind};
use world::draw::hash;
use world::template;

/// A chosen road.
#[derive(Clone, Debug)]
pub struct Chosen {
    /// Template.
    pub template: &'static str,
    /// The layout.
    pub layout: BevLayout,
    /// Requirements that no road could meet, in words.
    pub missing: Vec<String>,
}

/// Number of variations of a template that are tried.
const TRIES: u64 = 24;

/// A road for a description and its graph.
pub fn choose(d: &Description, graph: &SceneGraph, seed: u64) -> Chosen {
    let needs = roles(graph);
    let junction = graph.nodes.iter().any(|n| n.kind == NodeKind::Junction);
    let kind = d.road.kind.unwrap_or(match d.environment {
        _ if junction => Road::Intersection,
        _ if needs.contains(&LaneRole::Carpark) => Road::Parking,
        _ if needs.contains(&LaneRole::Cross) => Road::Intersection,
        Some(Environment::Highway) => Road::Highway,
        // only a motorway has lanes in our direction on both sides of ours
        _ if needs.contains(&LaneRole::Left) && needs.contains(&LaneRole::Right) => Road::Highway,
        Some(Environment::Suburban | Environment::Residential | Environment::Rural) => Road::Suburb,
        _ => Road::Straight,
    });
    // A crossing, a car park, a sidewalk: some templates never have them.
    let kind = match kind {
        Road::Highway | Road::Curve | Road::Roundabout if d.road.crossing => {
            if d.road.kind == Some(Road::Highway) {
                Road::Highway
            } else {
                kind
            }
        }
        Road::Suburb if needs.contains(&LaneRole::Left) || needs.contains(&LaneRole::Right) => Road::Straight,
        k => k,
    };
    let name = template::TEMPLATES
        .iter()
        .copied()
        .find(|t| *t == kind.name())
        .unwrap_or("straight");
    let parked = graph.objects().any(|(_, o)| o.state == Some(ObjectState::Parked))
        || graph.edges.iter().any(|e| e.relation == RelationKind::ParkedOn);
    let room_m = room_ahead_m(d);
    let mut best: Option<(usize, Chosen)> = None;
    for k in 0..TRIES {
        let seed = hash(seed ^ (k << 40)).wrapping_add(seed);
        let Some(layout) = template::layout_with_room(name, seed, room_m) else {
            continue;
        };
        let layout = if d.road.no_crossing {
            without_crossings(&layout)
        } else {
            layout
        };
        let (missing, wishes) = judge(d, &needs, junction, parked, graph.nodes.len(), &layout);
        let cost = missing.len() * 10 + wishes;
        if best.as_ref().is_none_or(|(c, _)| cost < *c) {
            let done = cost == 0;
            best = Some((
                cost,
                Chosen {
                    template: name,
                    layout,
                    missing,
                },
            ));
            if done {
                break;
            }
        }
    }
    best.map_or_else(
        || Chosen {
            template: name,
            layout: BevLayout::default(),
            missing: vec!["no template".into()],
        },
        |b| b.1,
    )
}

/// Length of our street before a roundabout, m: it has room for objects that shall stand ahead of us in our lane.
fn room_ahead_m(d: &Description) -> f64 {
    const LEAST_M: f64 = 14.0;
    const MOST_M: f64 = 24.0;
    let ahead = d
        .foreground
        .iter()
        .flat_map(|o| &o.relations)
        .filter(|r| r.relation == RelationKind::InFrontOf && r.anchor == super::description::Anchor::Ego);
    let farthest_m = ahead.filter_map(|r| r.distance_m).fold(0.0, f64::max);
    (farthest_m + 4.0).clamp(LEAST_M, MOST_M)
}

/// This road without painted crossings.
fn without_crossings(layout: &BevLayout) -> BevLayout {
    let stripes = BevLayer::PedCrossing.bit();
    let cells = layout.cells().iter().map(|c| c & !stripes).collect();
    let lines = layout
        .polylines
        .iter()
        .filter(|l| l.kind != PolylineKind::PedCrossing)
        .cloned()
        .collect();
    BevLayout::from_cells(cells, lines).unwrap_or_else(|_| layout.clone())
}

/// Requirements of a description that a layout does not meet, in words.
pub fn lacks(d: &Description, graph: &SceneGraph, layout: &BevLayout) -> Vec<String> {
    let junction = graph.nodes.iter().any(|n| n.kind == NodeKind::Junction);
    judge(d, &roles(graph), junction, false, graph.nodes.len(), layout).0
}

/// Number of given vehicles that do not stand on the road of a layout, or head across their lane.
pub fn misplaced(layout: &BevLayout, boxes: &[scene::SceneBox]) -> usize {
    let map = LaneMap::new(layout);
    let road = BevLayer::DrivableArea.bit() | BevLayer::CarparkArea.bit();
    let wrong = |b: &&scene::SceneBox| {
        let p = b.center_m.truncate();
        let off = !b.footprint().iter().all(|c| map.has(road, *c));
        let against =
            b.velocity_mps.length() > 0.5 && map.nearest(p).is_some_and(|l| l.dir.dot(b.heading()) < 0.9);
        off || against
    };
    boxes
        .iter()
        .filter(|b| b.class.is_vehicle() || b.class == scene::Class::Motorcycle)
        .filter(wrong)
        .count()
}

/// A road under given objects: of the templates (or the one that was asked for), the variation that misplaces the
/// fewest.
pub fn under(d: &Description, graph: &SceneGraph, boxes: &[scene::SceneBox], seed: u64) -> Chosen {
    let mut best: Option<(usize, Chosen)> = None;
    let names: Vec<&'static str> = template::TEMPLATES
        .iter()
        .copied()
        .filter(|t| d.road.kind.is_none_or(|k| k.name() == *t))
        .collect();
    'all: for k in 0..TRIES {
        for name in &names {
            let Some(layout) = template::layout(name, hash(seed ^ (k << 40)).wrapping_add(seed)) else {
                continue;
            };
            let missing = lacks(d, graph, &layout);
            let cost = misplaced(&layout, boxes) * 3 + missing.len() * 10;
            if best.as_ref().is_none_or(|(c, _)| cost < *c) {
                best = Some((
                    cost,
                    Chosen {
                        template: name,
                        layout,
                        missing,
                    },
                ));
                if cost == 0 {
                    break 'all;
                }
            }
        }
    }
    best.map_or_else(|| choose(d, graph, seed), |b| b.1)
}

/// Requirements that a layout does not meet, in words, and number of its unmet softer wishes.
fn judge(
    d: &Description,
    needs: &[LaneRole],
    junction: bool,
    parked: bool,
    nodes: usize,
    layout: &BevLayout,
) -> (Vec<String>, usize) {
    let map = LaneMap::new(layout);
    let missing = missing(d, needs, junction, layout, &map);
    (missing, wishes(d, parked, nodes, layout, &map))
}

/// Number of points of the lanes of a role near the ego vehicle.
fn points_of(map: &LaneMap<'_>, role: LaneRole) -> usize {
    let near = map
        .points
        .iter()
        .filter(|p| p.role == role && p.p.length() < 35.0);
    near.count()
}

/// Requirements that a layout does not meet, in words.
fn missing(
    d: &Description,
    needs: &[LaneRole],
    junction: bool,
    layout: &BevLayout,
    map: &LaneMap<'_>,
) -> Vec<String> {
    let mut missing = Vec::new();
    let role = |r: LaneRole| points_of(map, r);
    let mut lack = |there: bool, what: &str| {
        if !there {
            missing.push(format!("no {what} on this kind of road"));
        }
    };
    let walkway = layout.count(BevLayer::Walkway);
    for need in needs {
        match need {
            LaneRole::Left => lack(role(LaneRole::Left) > 8, "lane to the left"),
            LaneRole::Right => lack(role(LaneRole::Right) > 8, "lane to the right"),
            LaneRole::Oncoming => lack(role(LaneRole::Oncoming) > 8, "oncoming lane"),
            LaneRole::Cross => lack(role(LaneRole::Cross) > 4, "cross street"),
            LaneRole::Carpark => lack(layout.count(BevLayer::CarparkArea) > 200, "car park"),
            LaneRole::Sidewalk | LaneRole::LeftSidewalk | LaneRole::RightSidewalk => {
                lack(walkway > 500, "sidewalk")
            }
            _ => {}
        }
    }
    if d.road.sidewalk {
        lack(walkway > 500, "sidewalk");
    }
    if d.road.crossing {
        let ahead = map
            .crossing()
            .is_some_and(|c| c.iter().all(|p| p.x > 4.0 && p.abs().max_element() < 38.0));
        lack(ahead, "crossing ahead");
        if let Some(m) = d.road.crossing_m {
            let near = map.crossings.iter().any(|c| {
                let middle = c.iter().sum::<glam::DVec2>() / c.len().max(1) as f64;
                map.course(middle).is_some_and(|at| (at.0 - m).abs() < 4.0)
            });
            lack(near, &format!("crossing {m:.0} m ahead"));
        }
    }
    if junction {
        lack(map.junction.is_some(), "junction");
    }
    if d.road.no_crossing {
        lack(map.crossings.is_empty(), "way to leave crossings out");
    }
    if d.road.no_sidewalk {
        lack(walkway == 0, "way to leave sidewalks out");
    }
    if d.road.one_way && d.road.kind != Some(Road::Roundabout) {
        lack(role(LaneRole::Oncoming) == 0, "one-way variation");
    }
    if let Some(lanes) = d.road.lanes {
        let forward = 1 + usize::from(role(LaneRole::Left) > 8) + usize::from(role(LaneRole::Right) > 8);
        // ("a three-lane motorway" has three each way; for other roads all lanes are counted)
        let each_way = d.road.one_way || d.road.kind == Some(Road::Highway) && lanes <= 3;
        let wanted = if each_way {
            lanes as usize
        } else {
            (lanes as usize).div_ceil(2)
        };
        // (of more than three, only three count: our own and one on either side)
        if forward != wanted.min(3) {
            missing.push(format!(
                "{lanes} lanes were asked for, and {forward} of this road go our way"
            ));
        }
    }
    missing
}

/// Number of softer wishes that a layout does not meet.
fn wishes(d: &Description, parked: bool, nodes: usize, layout: &BevLayout, map: &LaneMap<'_>) -> usize {
    let mut wishes = 0;
    let role = |r: LaneRole| points_of(map, r);
    let walkway = layout.count(BevLayer::Walkway);
    // "I drive in the middle lane of three"
    if let Some(own) = d.road.own_lane {
        let (left, right) = (role(LaneRole::Left) > 8, role(LaneRole::Right) > 8);
        wishes += match own {
            LaneRole::Left => usize::from(left) + 2 * usize::from(!right),
            LaneRole::Right => usize::from(right) + 2 * usize::from(!left),
            _ => 2 * (usize::from(!left) + usize::from(!right)),
        };
    }
    // a motorway has lanes to change to: to the left, and also to the right unless it has only two
    if d.road.kind == Some(Road::Highway) && d.road.own_lane.is_none() {
        let two = d
            .road
            .lanes
            .is_some_and(|n| if d.road.one_way { n < 3 } else { n < 5 });
        wishes += usize::from(role(LaneRole::Left) <= 8) + usize::from(!two && role(LaneRole::Right) <= 8);
    }
    // an object on the crossing at a stated distance needs the crossing there
    for o in &d.foreground {
        let on = o
            .relations
            .iter()
            .any(|r| r.relation == RelationKind::On && r.anchor == Anchor::Crossing);
        let far = o.relations.iter().find_map(|r| {
            (r.anchor == Anchor::Ego && r.relation == RelationKind::InFrontOf)
                .then_some(r.distance_m)
                .flatten()
        });
        let Some(far) = far.filter(|_| on) else {
            continue;
        };
        let there = map.crossing().is_some_and(|c| {
            let x = c.iter().map(|p| p.x).sum::<f64>() / c.len() as f64;
            (x - far).abs() < (0.12 * far).max(1.2)
        });
        wishes += 3 * usize::from(!there);
        break;
    }
    let people = d.foreground.iter().any(|o| o.class == scene::Class::Pedestrian);
    wishes += usize::from(people && walkway < 500);
    // a street has sidewalks, unless the words exclude them
    let street = d.road.kind != Some(Road::Highway) && !d.road.no_sidewalk;
    wishes += usize::from(street && walkway < 500);
    // Many objects need room.
    wishes += usize::from(nodes > 10 && role(LaneRole::Left) + role(LaneRole::Right) < 8);
    let strip = layout.count(BevLayer::CarparkArea);
    // Right of the ego vehicle there must be room for objects that drive or park there.
    let right = d.foreground.iter().any(|o| {
        o.class != scene::Class::Pedestrian
            && o.relations
                .iter()
                .any(|r| r.relation == RelationKind::RightOf && r.anchor == Anchor::Ego)
    });
    // Objects that drive in our direction on a side need a lane there.
    for o in &d.foreground {
        let said = |kind: RelationKind| {
            o.relations
                .iter()
                .any(|r| r.relation == kind && r.anchor == Anchor::Ego)
        };
        if said(RelationKind::SameDirection) {
            wishes += usize::from(said(RelationKind::LeftOf) && role(LaneRole::Left) < 8);
            wishes += usize::from(said(RelationKind::RightOf) && role(LaneRole::Right) < 8);
        }
    }
    wishes += usize::from(right && role(LaneRole::Right) < 8 && strip < 300);
    wishes += usize::from(parked && strip < 300);
    wishes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::to_graph::to_graph;

    /// A motorway has three lanes each way, or a missing one is reported. Numbers of lanes that nobody can see are not
    /// reported as missing.
    #[test]
    fn lanes_that_a_road_lacks_are_said() {
        let of = |kind, lanes, seed| {
            let mut d = Description::default();
            (d.road.kind, d.road.lanes) = (Some(kind), Some(lanes));
            let chosen = choose(&d, &to_graph(&d, seed).graph, seed);
            let map = LaneMap::new(&chosen.layout);
            let beside = |r| {
                map.points
                    .iter()
                    .filter(|p| p.role == r && p.p.length() < 35.0)
                    .count()
                    > 8
            };
            let ours = 1 + usize::from(beside(LaneRole::Left)) + usize::from(beside(LaneRole::Right));
            (
                ours,
                chosen.missing.iter().any(|m| m.contains("lanes were asked for")),
            )
        };
        for seed in 0..6 {
            for (kind, lanes, wanted) in [
                (Road::Highway, 3, 3),
                (Road::Straight, 2, 1),
                (Road::Suburb, 6, 3),
            ] {
                let (ours, said) = of(kind, lanes, seed);
                assert_eq!(said, ours != wanted, "{kind:?} {lanes}: {ours}");
            }
            assert_eq!(of(Road::Highway, 8, seed), of(Road::Highway, 6, seed));
        }
        assert!((0..6).any(|seed| of(Road::Suburb, 6, seed).1));
    }
}
