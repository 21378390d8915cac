//! Marks that the road tool draws over the map.

use std::f64::consts::TAU;

use glam::DVec2;

use language::t;
use scene::roads::{NodeKind, RoadNode, curve};
use scene::{Road, RoadId};

use super::options::summary;
use super::part::{RoadGeometry, RoadPart};
use crate::tools::{At, ReadonlyContext, Role, ToolMark};

/// Spacing of the direction arrows, m.
const ARROW_M: f64 = 16.0;
/// More roads are drawn as plain lines.
const MOST_DASHED: usize = 40;
/// Size of an arrow, points.
const ARROW: f64 = 5.0;

pub(super) fn over_map(seen: &RoadGeometry, sight: &ReadonlyContext<'_>) -> Vec<ToolMark> {
    let (net, lines) = (&*seen.net, &*seen.lines);
    let mut out = Vec::new();
    let chosen = sight.hand.road.chosen;
    let point_m = 1.0 / sight.view.scale();
    for road in &net.roads {
        let line = &lines[&road.id];
        let is_chosen = chosen.and_then(RoadPart::road) == Some(road.id);
        if is_chosen {
            chosen_road(road, line, sight, &mut out);
            continue;
        }
        // Dashes of many roads are too much to draw in every frame.
        out.push(match net.roads.len() > MOST_DASHED {
            true => ToolMark::Line(at(line), Role::Measure),
            false => ToolMark::Dashed(at(line), Role::Measure),
        });
        arrows(road, line, point_m, &mut out);
    }
    for node in &net.nodes {
        let is_chosen = chosen == Some(RoadPart::Node(node.id));
        out.push(match is_chosen {
            true => ToolMark::Handle(node.at_m.into()),
            false => ToolMark::Dot(node.at_m.into(), Role::Measure),
        });
        if is_chosen {
            out.extend(ring(node));
        }
    }
    if let Some(id) = under(seen, sight).filter(|id| chosen.and_then(RoadPart::road) != Some(*id))
        && let Some(road) = net.road(id)
    {
        out.extend(outline(road, &lines[&id]).map(|points| ToolMark::Line(at(&points), Role::Hand)));
        if let Some(pointer) = sight.pointer {
            out.push(ToolMark::Tag(At::Screen(pointer.at), summary(road)));
        }
    }
    out
}

fn under(seen: &RoadGeometry, sight: &ReadonlyContext<'_>) -> Option<RoadId> {
    seen.net.road_among(&seen.lines, sight.ground_m()?, 0.0)
}

fn at(points: &[DVec2]) -> Vec<At> {
    points.iter().map(|p| (*p).into()).collect()
}

/// The two edges of a road.
fn outline(road: &Road, line: &[DVec2]) -> [Vec<DVec2>; 2] {
    [
        curve::beside(line, road.reach_m(false)),
        curve::beside(line, -road.reach_m(true)),
    ]
}

fn chosen_road(road: &Road, line: &[DVec2], sight: &ReadonlyContext<'_>, out: &mut Vec<ToolMark>) {
    out.extend(outline(road, line).map(|points| ToolMark::Line(at(&points), Role::Choose)));
    out.push(ToolMark::Line(at(line), Role::Choose));
    if let Some((right, i)) = sight.hand.road.lane
        && let Some(lane) = road.side(right).get(i)
    {
        let inner: f64 = road.side(right)[..i].iter().map(|l| l.width_m).sum();
        let sign = if right { -1.0 } else { 1.0 };
        let edges = [inner, inner + lane.width_m].map(|off| curve::beside(line, sign * off));
        out.extend(edges.map(|points| ToolMark::Dashed(at(&points), Role::Hand)));
        let middle = curve::beside(line, sign * (inner + lane.width_m / 2.0));
        let (p, _) = curve::at(&middle, curve::length_m(&middle) / 2.0);
        out.push(ToolMark::Label(
            p.into(),
            format!("{} {:.1} m", t(lane.kind.title()), lane.width_m),
        ));
    }
    arrows(road, line, 1.0 / sight.view.scale(), out);
    out.extend(
        road.via_m
            .iter()
            .map(|p| ToolMark::Dot((*p).into(), Role::Choose)),
    );
    for crossing in &road.crossings {
        let (p, way) = curve::at(line, crossing.at_m);
        let ends =
            [road.kerb_m(false, false), -road.kerb_m(true, false)].map(|off| (p + way.perp() * off).into());
        out.push(ToolMark::Line(ends.to_vec(), Role::Hand));
    }
}

/// Arrows in the driving direction of its lanes.
fn arrows(road: &Road, line: &[DVec2], point_m: f64, out: &mut Vec<ToolMark>) {
    let length_m = curve::length_m(line);
    let count = (length_m / ARROW_M).round().clamp(1.0, 50.0) as usize;
    for right in [true, false] {
        if road.driven(right) == 0 {
            continue;
        }
        let off = road.kerb_m(right, false) / 2.0;
        for k in 0..count {
            let (p, way) = curve::at(line, length_m * (k as f64 + 0.5) / count as f64);
            let (sign, way) = if right { (-1.0, way) } else { (1.0, -way) };
            let tip = p + curve_left(way, right) * (off * sign) + way * ARROW * point_m;
            let back =
                |side: f64| tip - way * (ARROW * 1.6 * point_m) + way.perp() * (side * ARROW * point_m);
            out.push(ToolMark::Line(
                vec![back(1.0).into(), tip.into(), back(-1.0).into()],
                Role::Measure,
            ));
        }
    }
}

/// The direction to the left of the road's line, from the direction in which one side is driven.
fn curve_left(way: DVec2, right: bool) -> DVec2 {
    if right { way.perp() } else { -way.perp() }
}

/// The kerb of a roundabout.
fn ring(node: &RoadNode) -> Option<ToolMark> {
    let NodeKind::Roundabout { island_m, ring_m } = node.kind else {
        return None;
    };
    let point = |k: u32| node.at_m + DVec2::from_angle(f64::from(k) / 64.0 * TAU) * (island_m + ring_m);
    Some(ToolMark::Line(
        (0..=64).map(|k| point(k).into()).collect(),
        Role::Choose,
    ))
}
