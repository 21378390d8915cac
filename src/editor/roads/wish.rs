//! Road wishes: requests of a user about a street, carried out on the roads it is made of.

use glam::DVec2;

use scene::roads::{LaneKind, NodeId, NodeKind, RoadLane, RoadWish, curve};
use scene::{Road, RoadId, RoadNetwork};

use super::change::split_at;

/// Roads farther away than this are not meant, m.
const REACH_M: f64 = 60.0;
/// Distance ahead within which the next junction is looked for, m.
const AHEAD_M: f64 = 120.0;
/// Distance ahead at which a roundabout is made where there is no junction, m.
const NEW_M: f64 = 25.0;
/// Limits of the width of a lane for cars, m.
const DRIVE_M: [f64; 2] = [2.4, 5.0];
/// Most lanes for cars of one direction.
const MOST: u32 = 6;
/// A new roundabout, m.
const ROUND: NodeKind = NodeKind::Roundabout {
    island_m: 7.0,
    ring_m: 6.5,
};

/// Changes the street nearest to a place; errors say why a wish cannot be granted.
pub(super) fn grant(
    net: &mut RoadNetwork,
    at_m: DVec2,
    heading_deg: f64,
    wish: RoadWish,
) -> Result<(), String> {
    let ahead = DVec2::from_angle(heading_deg.to_radians());
    if !(at_m.is_finite() && ahead.is_finite()) {
        return Err("the place of a wish is not finite".into());
    }
    let (first, along) = nearest(net, at_m, ahead).ok_or("no road is near")?;
    match wish {
        RoadWish::Roundabout {} => return roundabout(net, first, at_m, ahead),
        RoadWish::Junction {} => {
            let round = |n: NodeId| {
                net.node(n)
                    .is_some_and(|n| n.kind != NodeKind::default() && is_round(n.kind))
            };
            let node = next(net, at_m, ahead, round).ok_or("no roundabout is ahead")?;
            if let Some(node) = net.node_mut(node) {
                node.kind = NodeKind::default();
            }
            return Ok(());
        }
        RoadWish::Straight {} => return straighten(net, first),
        _ => {}
    }
    for (id, turned) in net.street(first) {
        // True if its line runs as one looks.
        let with_us = along != turned;
        let Some(road) = net.road_mut(id) else { continue };
        match wish {
            RoadWish::Lanes { count } => lanes(road, count, with_us)?,
            RoadWish::OneWay {} => one_way(road, with_us),
            RoadWish::Widths { times } => widths(road, times)?,
            RoadWish::Beside { kind, right } => {
                for side in [true, false] {
                    if right.is_none_or(|right| right == (side == with_us)) {
                        beside(road.side_mut(side), kind);
                    }
                }
            }
            RoadWish::Without { kind } => {
                road.left.retain(|l| l.kind != kind);
                road.right.retain(|l| l.kind != kind);
            }
            RoadWish::Straight {} | RoadWish::Roundabout {} | RoadWish::Junction {} => {}
        }
    }
    Ok(())
}

fn is_round(kind: NodeKind) -> bool {
    matches!(kind, NodeKind::Roundabout { .. })
}

/// The road that is meant at a place: the nearest of those that run as one looks, else the nearest; true if its line does.
fn nearest(net: &RoadNetwork, at_m: DVec2, ahead: DVec2) -> Option<(RoadId, bool)> {
    let lines = net.lines();
    let all = net.roads.iter().filter_map(|r| {
        let line = lines.get(&r.id)?;
        let (along, left) = curve::project(line, at_m)?;
        let way = curve::at(line, along).1.dot(ahead);
        // Beside the carriageway, and a street across counts as farther.
        let off = left.abs() - r.kerb_m(left < 0.0, true);
        let cost = off.max(0.0) + if way.abs() < 0.6 { 10.0 } else { 0.0 };
        (off < REACH_M).then_some((cost, left.abs(), r.id, way >= 0.0))
    });
    let best = all.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    best.map(|b| (b.2, b.3))
}

/// The nearest node ahead that fits.
fn next(net: &RoadNetwork, at_m: DVec2, ahead: DVec2, fits: impl Fn(NodeId) -> bool) -> Option<NodeId> {
    let near = net.nodes.iter().filter(|n| fits(n.id)).filter_map(|n| {
        let d = n.at_m - at_m;
        let is_ahead = d.dot(ahead) > -5.0 && d.length() < AHEAD_M;
        is_ahead.then_some((d.length(), n.id))
    });
    near.min_by(|a, b| a.0.total_cmp(&b.0)).map(|n| n.1)
}

fn roundabout(net: &mut RoadNetwork, first: RoadId, at_m: DVec2, ahead: DVec2) -> Result<(), String> {
    let junction = |n: NodeId| net.arms(n).len() > 2 && net.node(n).is_some_and(|n| !is_round(n.kind));
    let node = match next(net, at_m, ahead, junction) {
        Some(node) => node,
        None => split_at(net, first, at_m + ahead * NEW_M)?,
    };
    if let Some(node) = net.node_mut(node) {
        node.kind = ROUND;
    }
    Ok(())
}

/// The street from its first to its last node without bends: nodes between move onto the line.
fn straighten(net: &mut RoadNetwork, first: RoadId) -> Result<(), String> {
    let street = net.street(first);
    let end =
        |(id, turned): (RoadId, bool), far: bool| net.road(id).map(|r| r.ends[usize::from(far != turned)]);
    let (Some(from), Some(to)) = (
        street.first().and_then(|s| end(*s, false)),
        street.last().and_then(|s| end(*s, true)),
    ) else {
        return Err("no road is near".into());
    };
    let place = |n: NodeId| net.node(n).map(|n| n.at_m);
    let (Some(a), Some(b)) = (place(from), place(to)) else {
        return Err("no road is near".into());
    };
    if a.distance(b) < 1.0 {
        return Err("a street that ends where it begins cannot be straight".into());
    }
    let between: Vec<NodeId> = street
        .iter()
        .filter_map(|s| end(*s, true))
        .filter(|n| *n != to)
        .collect();
    for (id, _) in street {
        if let Some(road) = net.road_mut(id) {
            road.via_m.clear();
        }
    }
    let line = [a, b];
    for id in between {
        if let Some(node) = net.node_mut(id)
            && let Some((along, _)) = curve::project(&line, node.at_m)
        {
            node.at_m = curve::at(&line, along).0;
        }
    }
    Ok(())
}

/// The width of the lanes for cars of a road.
fn drive_m(road: &Road) -> f64 {
    let all = road
        .right
        .iter()
        .chain(&road.left)
        .filter(|l| l.kind == LaneKind::Drive);
    all.map(|l| l.width_m).next().unwrap_or(LaneKind::Drive.usual_m())
}

/// Gives a side so many lanes for cars, innermost.
fn set_count(side: &mut Vec<RoadLane>, count: usize, width_m: f64) {
    side.retain(|l| l.kind != LaneKind::Drive);
    let lane = RoadLane {
        kind: LaneKind::Drive,
        width_m,
    };
    side.splice(0..0, vec![lane; count]);
}

fn lanes(road: &mut Road, count: u32, with_us: bool) -> Result<(), String> {
    let one_way = road.driven(true) == 0 || road.driven(false) == 0;
    let most = if one_way { MOST } else { 2 * MOST };
    if count == 0 || count > most {
        return Err(format!("{count} lanes, expected 1 to {most}"));
    }
    let width_m = drive_m(road);
    let both = !one_way && count > 1;
    let ours = if both { count.div_ceil(2) } else { count } as usize;
    let theirs = if both { count as usize - ours } else { 0 };
    // A one-way road keeps its direction.
    let our_side = match one_way {
        true => road.driven(true) > 0,
        false => with_us,
    };
    set_count(road.side_mut(our_side), ours, width_m);
    set_count(road.side_mut(!our_side), theirs, width_m);
    Ok(())
}

/// All lanes of the carriageway are driven one way; it stays where it is.
fn one_way(road: &mut Road, with_us: bool) {
    let width_m = drive_m(road);
    let driven_m = |side: &[RoadLane]| -> f64 {
        let driven = side.iter().filter(|l| l.kind.is_driven());
        driven.map(|l| l.width_m).sum()
    };
    let (theirs_m, count) = (
        driven_m(road.side(!with_us)),
        road.driven(true) + road.driven(false),
    );
    // The line goes where the other side's lanes ended.
    road.offset_m += if with_us { theirs_m } else { -theirs_m };
    for right in [true, false] {
        road.side_mut(right).retain(|l| !l.kind.is_driven());
    }
    set_count(road.side_mut(with_us), count.clamp(1, MOST as usize), width_m);
    road.stops.retain(|s| s.right == with_us);
}

fn widths(road: &mut Road, times: f64) -> Result<(), String> {
    if !(times > 0.0 && times.is_finite()) {
        return Err(format!("lanes {times} times as wide, expected a number above 0"));
    }
    for lane in road.left.iter_mut().chain(&mut road.right) {
        if lane.kind.is_driven() {
            lane.width_m = (lane.width_m * times).clamp(DRIVE_M[0], DRIVE_M[1]);
        }
    }
    Ok(())
}

/// A lane of a kind outside of those driven; one that is there stays.
fn beside(side: &mut Vec<RoadLane>, kind: LaneKind) {
    if side.iter().any(|l| l.kind == kind) && kind != LaneKind::Drive {
        return;
    }
    let at = match kind {
        LaneKind::Walk => side.len(),
        LaneKind::Verge => side
            .iter()
            .position(|l| l.kind == LaneKind::Walk)
            .unwrap_or(side.len()),
        _ => side.iter().rposition(|l| l.kind.is_driven()).map_or(0, |i| i + 1),
    };
    side.insert(at, RoadLane::usual(kind));
}
