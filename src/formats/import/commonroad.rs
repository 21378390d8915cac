//! CommonRoad scenarios (Althoff and others 2017), versions 2018b and 2020a: lanelets with bounds, stop lines, crossings, and
//! obstacles where they are at the start. Traffic signs and lights are counted.

use std::collections::{BTreeMap, BTreeSet};

use glam::{DVec2, DVec3};
use roxmltree::Node;

use super::commonroad_obstacles::obstacle;
use super::{Content, Importer};
use crate::lanelets::{self, Between, Lanelet, LaneletMap, MOST_POINTS, Use};
use crate::opendrive::lanes::LaneGround;
use crate::opendrive::xml::{
    OpenDriveError, Result, bad, child, count, decode, elements, named, parse_document, shown, within_reach,
};
use crate::opendrive::{self, RoadNetwork, Skipped};
use crate::{FormatError, Holds};
use scene::Frame;

/// Roads, obstacles, and the place of the planning problem as the one where a scene begins.
pub const IMPORTER: Importer = Importer {
    id: "commonroad",
    title: "CommonRoad scenarios",
    extensions: &["xml"],
    holds: &[Holds::Roads, Holds::Boxes],
    largest: opendrive::LARGEST_FILE,
    recognises: |head| String::from_utf8_lossy(head).contains("<commonRoad"),
    in_folder: None,
    read: |source| match read(source.bytes, source.name) {
        Ok(network) => Ok(Content::Roads(Box::new(network))),
        Err(error) => Err(error),
    },
    #[cfg(test)]
    sample: || super::commonroad_tests::street().into_bytes(),
};

/// The roads of a scenario. Errors in one line.
pub fn read(bytes: &[u8], name: &str) -> std::result::Result<RoadNetwork, FormatError> {
    let map = map(bytes, name).map_err(FormatError::new)?;
    lanelets::network(map).map_err(FormatError::new)
}

/// A lanelet that lies beside another one.
struct Beside {
    lanelet: i64,
    other: i64,
    is_left: bool,
    same_way: bool,
    /// Whether the bound is painted, if the file says so.
    paint: Option<bool>,
}

fn map(bytes: &[u8], name: &str) -> Result<LaneletMap> {
    let text = decode(bytes)?;
    let document = parse_document(&text)?;
    let root = document.root_element();
    if root.tag_name().name() != "commonRoad" {
        let found = format!("<{}>", root.tag_name().name());
        return Err(bad(root, "root element", "<commonRoad>", &found));
    }
    let mut out = LaneletMap {
        name: name.to_owned(),
        ..LaneletMap::default()
    };
    let (mut beside, mut points) = (Vec::new(), 0);
    for node in elements(root) {
        match node.tag_name().name() {
            "lanelet" => {
                let bounds = ["leftBound", "rightBound"].map(|side| bound(node, side, &mut points));
                let [left, right] = bounds;
                lanelet(node, [left?, right?], &mut out, &mut beside)?;
            }
            "planningProblem" if out.start.is_none() => out.start = start(node)?,
            "planningProblem" => count(&mut out.skipped, "further planning problem"),
            "staticObstacle" | "dynamicObstacle" | "obstacle" if out.boxes.len() < Frame::MAX_BOXES => {
                let id = out.boxes.len() as u32 + 1;
                out.boxes.extend(obstacle(node, id, &mut out.skipped)?);
            }
            // These hold nothing that a layout shows.
            "location" | "scenarioTags" | "intersection" => {}
            other => count(&mut out.skipped, shown(other, 40)),
        }
    }
    out.between = between(&out, beside);
    Ok(out)
}

pub(super) fn number(node: Node<'_, '_>) -> Result<f64> {
    let text = node.text().unwrap_or_default();
    match text.trim().parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(bad(node, "content", "a finite number", &format!("{text:?}"))),
    }
}

pub(super) fn point(node: Node<'_, '_>) -> Result<DVec3> {
    let coordinate = |name: &'static str| match child(node, name) {
        Some(value) => within_reach(value, "content", number(value)?),
        None if name == "z" => Ok(0.0),
        None => Err(bad(node, name, "one element", "none")),
    };
    Ok(DVec3::new(coordinate("x")?, coordinate("y")?, coordinate("z")?))
}

/// The points of a bound, and whether it is painted, if the file says so.
fn bound(node: Node<'_, '_>, side: &'static str, points: &mut usize) -> Result<(Vec<DVec3>, Option<bool>)> {
    let bound = child(node, side).ok_or_else(|| bad(node, side, "one element", "none"))?;
    let line = named(bound, "point").map(point).collect::<Result<Vec<_>>>()?;
    *points += line.len();
    if *points > MOST_POINTS {
        return Err(OpenDriveError::TooMuch {
            place: "bounds of lanelets".into(),
            limit: MOST_POINTS,
            what: "points",
        });
    }
    let marking = child(bound, "lineMarking").and_then(|n| n.text());
    let paint = marking.map(|m| !matches!(m.trim(), "no_marking" | "unknown" | "curb" | "lowered_curb"));
    Ok((line, paint))
}

fn id(node: Node<'_, '_>, field: &str) -> Result<i64> {
    let text = node.attribute(field).unwrap_or_default();
    text.trim()
        .parse()
        .map_err(|_| bad(node, field, "a whole number", &format!("{text:?}")))
}

fn lanelet(
    node: Node<'_, '_>,
    [left, right]: [(Vec<DVec3>, Option<bool>); 2],
    out: &mut LaneletMap,
    beside: &mut Vec<Beside>,
) -> Result<()> {
    let own = id(node, "id")?;
    let use_ = use_of(node, &mut out.skipped);
    let Some(mut lanelet) = Lanelet::new(own, left.0, right.0, use_) else {
        count(&mut out.skipped, "lanelet with a bound of fewer than two points");
        return Ok(());
    };
    lanelet.two_way = child(node, "userBidirectional").is_some();
    lanelet.successors = named(node, "successor")
        .map(|n| id(n, "ref"))
        .collect::<Result<_>>()?;
    for (name, is_left, paint) in [("adjacentLeft", true, left.1), ("adjacentRight", false, right.1)] {
        if let Some(next) = child(node, name) {
            beside.push(Beside {
                lanelet: own,
                other: id(next, "ref")?,
                is_left,
                same_way: next.attribute("drivingDir") != Some("opposite"),
                paint,
            });
        }
    }
    if let Some(stop) = child(node, "stopLine") {
        let given = named(stop, "point").map(point).collect::<Result<Vec<_>>>()?;
        let ends = lanelet.bounds.each_ref().map(|b| b[b.len() - 1]);
        let line = if given.len() == 2 { given } else { ends.to_vec() };
        out.stop_lines.push(line.iter().map(|p| p.truncate()).collect());
    }
    out.lanelets.push(lanelet);
    Ok(())
}

/// The use of a lanelet, by its types.
fn use_of(node: Node<'_, '_>, skipped: &mut Skipped) -> Use {
    let kinds = named(node, "laneletType").filter_map(|n| n.text());
    let kinds: BTreeSet<&str> = kinds.map(str::trim).collect();
    let has = |names: &[&str]| names.iter().any(|n| kinds.contains(n));
    if has(&["crosswalk"]) {
        return Use::Crossing;
    }
    if has(&["sidewalk"]) {
        return Use::Walking;
    }
    if has(&["parkingLot", "parking"]) {
        return Use::Ground(LaneGround::Carpark);
    }
    if has(&[
        "shoulder",
        "bicycleLane",
        "border",
        "restrictedArea",
        "restricted",
    ]) {
        return Use::Ground(LaneGround::Road);
    }
    let known = [
        "urban",
        "interstate",
        "country",
        "highway",
        "mainCarriageWay",
        "accessRamp",
        "exitRamp",
        "driveWay",
        "busLane",
        "busStop",
        "intersection",
        "unknown",
    ];
    for kind in kinds.iter().filter(|k| !known.contains(k)) {
        count(skipped, format!("lanelet type {}", shown(kind, 30)));
    }
    Use::Traffic
}

/// The bounds between lanelets with traffic, each once. Where no bound of the file says anything of paint, all are painted.
fn between(map: &LaneletMap, beside: Vec<Beside>) -> Vec<Between> {
    let nothing_known = beside.iter().all(|b| b.paint.is_none());
    let lanelets = map.lanelets.iter().enumerate();
    let traffic = lanelets.filter(|(_, l)| l.use_ == Use::Traffic);
    let index: BTreeMap<i64, usize> = traffic.map(|(i, l)| (l.id, i)).collect();
    let mut seen = BTreeSet::new();
    let mut out = Vec::new();
    for b in beside {
        let (Some(own), true) = (index.get(&b.lanelet), index.contains_key(&b.other)) else {
            continue;
        };
        if seen.insert([b.lanelet.min(b.other), b.lanelet.max(b.other)]) {
            out.push(Between {
                lanelets: [b.lanelet, b.other],
                points_m: map.lanelets[*own].bounds[usize::from(!b.is_left)].clone(),
                opposite: !b.same_way,
                painted: b.paint.unwrap_or(nothing_known),
            });
        }
    }
    out
}

/// Where the ego vehicle begins.
fn start(problem: Node<'_, '_>) -> Result<Option<(DVec2, f64)>> {
    let exact = |state: Node<'_, '_>, name: &'static str| -> Result<Option<f64>> {
        let value = child(state, name).and_then(|n| child(n, "exact"));
        value.map(number).transpose()
    };
    let Some(state) = child(problem, "initialState") else {
        return Ok(None);
    };
    let place = child(state, "position").and_then(|n| child(n, "point"));
    let at = place.map(point).transpose()?;
    Ok(at
        .zip(exact(state, "orientation")?)
        .map(|(at, heading)| (at.truncate(), heading)))
}
