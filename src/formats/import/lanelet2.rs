//! Lanelet2 maps (Poggenhans and others 2018; also as Autoware writes them): OpenStreetMap's XML with lanelets as relations.

use std::collections::{BTreeMap, HashMap, HashSet};

use glam::{DVec2, DVec3};
use roxmltree::Node;

use super::{Content, Importer};
use crate::lanelets::utm::Zone;
use crate::lanelets::{self, Between, Lanelet, LaneletMap, MOST_POINTS, Use};
use crate::opendrive::lanes::LaneGround;
use crate::opendrive::xml::{
    OpenDriveError, Result, bad, count, decode, elements, named, number_or_none, parse_document, shown,
    within_reach,
};
use crate::opendrive::{self, RoadNetwork, Skipped};
use crate::{FormatError, Holds};

/// Roads in metres: `local_x` and `local_y` where all nodes of ways have them, else UTM of the zone of the map's middle.
pub const IMPORTER: Importer = Importer {
    id: "lanelet2",
    title: "Lanelet2 maps",
    extensions: &["osm"],
    holds: &[Holds::Roads],
    largest: opendrive::LARGEST_FILE,
    recognises: |head| String::from_utf8_lossy(head).contains("<osm"),
    in_folder: None,
    read: |source| match read(source.bytes, source.name) {
        Ok(network) => Ok(Content::Roads(Box::new(network))),
        Err(error) => Err(error),
    },
    #[cfg(test)]
    sample: || super::lanelet2_tests::street().into_bytes(),
};

/// The roads of a map. Errors in one line.
pub fn read(bytes: &[u8], name: &str) -> std::result::Result<RoadNetwork, FormatError> {
    let map = map(bytes, name).map_err(FormatError::new)?;
    lanelets::network(map).map_err(FormatError::new)
}

/// A node: place in one of two ways.
#[derive(Clone, Copy)]
struct OsmNode {
    degrees: Option<[f64; 2]>, // latitude, longitude
    local_m: Option<[f64; 2]>,
    height_m: f64,
}

/// A way: its nodes and what it says it is.
struct OsmWay<'a> {
    nodes: Vec<i64>,
    kind: &'a str,
    is_area: bool,
}

fn map(bytes: &[u8], name: &str) -> Result<LaneletMap> {
    let text = decode(bytes)?;
    let document = parse_document(&text)?;
    let root = document.root_element();
    if root.tag_name().name() != "osm" {
        return Err(bad(
            root,
            "root element",
            "<osm>",
            &format!("<{}>", root.tag_name().name()),
        ));
    }
    let mut out = LaneletMap {
        name: name.to_owned(),
        ..LaneletMap::default()
    };
    let (places, ways) = nodes_and_ways(root)?;
    let in_metres = metres(root, &places)?;
    let mut points = 0;
    let mut line = |way: &OsmWay<'_>, skipped: &mut Skipped| -> Result<Vec<DVec3>> {
        points += way.nodes.len();
        if points > MOST_POINTS {
            return Err(OpenDriveError::TooMuch {
                place: "bounds of lanelets".into(),
                limit: MOST_POINTS,
                what: "points",
            });
        }
        let there = way.nodes.iter().filter_map(|id| in_metres.get(id).copied());
        let line: Vec<DVec3> = there.collect();
        if line.len() < way.nodes.len() {
            count(skipped, "way with a node that is not in the file");
        }
        Ok(line)
    };
    let mut used: BTreeMap<i64, Vec<(i64, usize)>> = BTreeMap::new();
    for node in named(root, "relation") {
        match tag(node, "type") {
            "lanelet" => {
                if let Some((lanelet, bounds)) = lanelet(node, &ways, &mut line, &mut out.skipped)? {
                    let is_traffic = lanelet.use_ == Use::Traffic;
                    let sides = bounds.iter().enumerate();
                    for (side, id) in sides.flat_map(|(side, ids)| ids.iter().map(move |id| (side, *id))) {
                        let uses = used.entry(id).or_default();
                        if is_traffic {
                            uses.push((lanelet.id, side));
                        }
                    }
                    out.lanelets.push(lanelet);
                }
            }
            "multipolygon" => {
                let members = members(node, "outer");
                let ring = joined(&members, &ways, &mut line, &mut out.skipped)?;
                for id in members {
                    used.entry(id).or_default();
                }
                area(tag(node, "subtype"), ring, &mut out);
            }
            kind => count(
                &mut out.skipped,
                format!("{} {}", shown(kind, 30), shown(tag(node, "subtype"), 30)),
            ),
        }
    }
    for (id, way) in &ways {
        if way.kind == "stop_line" {
            let points = line(way, &mut out.skipped)?;
            out.stop_lines.push(points.iter().map(|p| p.truncate()).collect());
        } else if way.is_area || way.kind == "parking_lot" {
            let ring = line(way, &mut out.skipped)?;
            area(way.kind, ring.iter().map(|p| p.truncate()).collect(), &mut out);
        } else if !used.contains_key(id) {
            count(&mut out.skipped, format!("way {}", shown(way.kind, 30)));
        }
    }
    for (id, uses) in used {
        if let ([(a, side), (b, other)], Some(way)) = (uses.as_slice(), ways.get(&id)) {
            out.between.push(Between {
                lanelets: [*a, *b],
                points_m: line(way, &mut out.skipped)?,
                opposite: side == other,
                painted: matches!(way.kind, "line_thin" | "line_thick"),
            });
        }
    }
    lanelets::link_by_ends(&mut out.lanelets, &mut out.skipped);
    Ok(out)
}

/// The value of a tag; empty if there is none.
fn tag<'a>(node: Node<'a, '_>, key: &str) -> &'a str {
    let mut tags = elements(node).filter(|n| n.tag_name().name() == "tag");
    let found = tags.find(|n| n.attribute("k") == Some(key));
    found.and_then(|n| n.attribute("v")).unwrap_or_default()
}

fn whole(node: Node<'_, '_>, field: &str) -> Result<i64> {
    let text = node.attribute(field).unwrap_or_default();
    text.trim()
        .parse()
        .map_err(|_| bad(node, field, "a whole number", &format!("{text:?}")))
}

type NodesAndWays<'a> = (HashMap<i64, OsmNode>, BTreeMap<i64, OsmWay<'a>>);

fn nodes_and_ways<'a>(root: Node<'a, 'a>) -> Result<NodesAndWays<'a>> {
    let (mut places, mut ways) = (HashMap::new(), BTreeMap::new());
    for node in elements(root) {
        match node.tag_name().name() {
            "node" => {
                let pair = |a: Option<f64>, b: Option<f64>| Some([a?, b?]);
                let tagged = |key: &str| -> Result<Option<f64>> {
                    match tag(node, key) {
                        "" => Ok(None),
                        text => match text.trim().parse::<f64>() {
                            Ok(value) if value.is_finite() => within_reach(node, key, value).map(Some),
                            _ => Err(bad(node, key, "a finite number", &format!("{text:?}"))),
                        },
                    }
                };
                // Empty where a map has tags alone, as Autoware writes it.
                let degrees = |key: &str| match node.attribute(key).is_some_and(|text| text.trim().is_empty())
                {
                    true => Ok(None),
                    false => number_or_none(node, key),
                };
                let place = OsmNode {
                    degrees: pair(degrees("lat")?, degrees("lon")?),
                    local_m: pair(tagged("local_x")?, tagged("local_y")?),
                    height_m: tagged("ele")?.unwrap_or(0.0),
                };
                places.insert(whole(node, "id")?, place);
            }
            "way" => {
                let nodes = named(node, "nd")
                    .map(|nd| whole(nd, "ref"))
                    .collect::<Result<_>>()?;
                let way = OsmWay {
                    nodes,
                    kind: tag(node, "type"),
                    is_area: tag(node, "area") == "yes",
                };
                ways.insert(whole(node, "id")?, way);
            }
            _ => {}
        }
    }
    // Points that no line goes through need no place.
    let used: HashSet<i64> = ways
        .values()
        .flat_map(|way: &OsmWay<'_>| way.nodes.iter().copied())
        .collect();
    places.retain(|id, _| used.contains(id));
    Ok((places, ways))
}

/// All nodes of ways in metres.
fn metres(root: Node<'_, '_>, places: &HashMap<i64, OsmNode>) -> Result<HashMap<i64, DVec3>> {
    let local = |p: &OsmNode| p.local_m.map(|[x, y]| DVec3::new(x, y, p.height_m));
    if places.values().all(|p| p.local_m.is_some()) {
        return Ok(places
            .iter()
            .filter_map(|(id, p)| Some((*id, local(p)?)))
            .collect());
    }
    let degrees: Vec<[f64; 2]> = places.values().filter_map(|p| p.degrees).collect();
    let bounds = |axis: usize| {
        let all = degrees.iter().map(|d| d[axis]);
        let low = all.clone().fold(f64::INFINITY, f64::min);
        (low + all.fold(f64::NEG_INFINITY, f64::max)) / 2.0
    };
    let zone = Zone::from_degrees(bounds(0), bounds(1)).filter(|_| degrees.len() == places.len());
    let zone = zone.ok_or_else(|| {
        let without = |has: &dyn Fn(&OsmNode) -> bool| places.values().filter(|p| !has(p)).count();
        bad(
            root,
            "node",
            "lat and lon, or tags local_x and local_y, in every node of a way",
            &format!(
                "{} of {} without lat and lon, {} without the tags",
                without(&|p| p.degrees.is_some()),
                places.len(),
                without(&|p| p.local_m.is_some())
            ),
        )
    })?;
    let of = |(id, place): (&i64, &OsmNode)| {
        let [latitude, longitude] = place.degrees?;
        let sound = Zone::from_degrees(latitude, longitude).is_some();
        let p = zone.project(latitude, longitude);
        (sound && p.is_finite()).then(|| (*id, p.extend(place.height_m)))
    };
    Ok(places.iter().filter_map(of).collect())
}

/// Ids of the ways with a role, in order.
fn members(node: Node<'_, '_>, role: &str) -> Vec<i64> {
    let members = named(node, "member").filter(|m| m.attribute("role") == Some(role));
    let ways = members.filter(|m| m.attribute("type") == Some("way"));
    ways.filter_map(|m| whole(m, "ref").ok()).collect()
}

type WayResolver<'f> = dyn FnMut(&OsmWay<'_>, &mut Skipped) -> Result<Vec<DVec3>> + 'f;

/// Ways one behind the other, each turned so that it goes on where the one before ends.
fn chained(
    ids: &[i64],
    ways: &BTreeMap<i64, OsmWay<'_>>,
    line: &mut WayResolver<'_>,
    skipped: &mut Skipped,
) -> Result<Vec<DVec3>> {
    let mut out: Vec<DVec3> = Vec::new();
    for (n, way) in ids.iter().filter_map(|id| ways.get(id)).enumerate() {
        let mut next = line(way, skipped)?;
        if let (Some(&first), Some(&last), Some(&end)) = (next.first(), next.last(), out.last()) {
            let begin = out[0];
            let near = |p: DVec3| p.distance(first).min(p.distance(last));
            if n == 1 && near(begin) < near(end) {
                out.reverse();
            }
            let end = out[out.len() - 1];
            if end.distance(last) < end.distance(first) {
                next.reverse();
            }
        }
        out.extend(next);
    }
    Ok(out)
}

fn joined(
    ids: &[i64],
    ways: &BTreeMap<i64, OsmWay<'_>>,
    line: &mut WayResolver<'_>,
    skipped: &mut Skipped,
) -> Result<Vec<DVec2>> {
    let ring = chained(ids, ways, line, skipped)?;
    Ok(ring.iter().map(|p| p.truncate()).collect())
}

/// A lanelet and the ids of the ways of its bounds.
fn lanelet(
    node: Node<'_, '_>,
    ways: &BTreeMap<i64, OsmWay<'_>>,
    line: &mut WayResolver<'_>,
    skipped: &mut Skipped,
) -> Result<Option<(Lanelet, [Vec<i64>; 2])>> {
    let ids = ["left", "right"].map(|role| members(node, role));
    let left = chained(&ids[0], ways, line, skipped)?;
    let right = chained(&ids[1], ways, line, skipped)?;
    // A bicycle lane behind a kerb belongs to the walkway.
    let kerb = |ids: &Vec<i64>| {
        ids.iter()
            .filter_map(|id| ways.get(id))
            .any(|w| w.kind == "curbstone")
    };
    let subtype = tag(node, "subtype");
    let use_ = match subtype {
        "" | "road" | "highway" | "play_street" | "bus_lane" | "exit" => Use::Traffic,
        "emergency_lane" | "road_shoulder" => Use::Ground(LaneGround::Road),
        "bicycle_lane" if !ids.iter().any(kerb) => Use::Ground(LaneGround::Road),
        "bicycle_lane" | "walkway" | "shared_walkway" | "stairs" | "pedestrian_lane" => Use::Walking,
        "crosswalk" => Use::Crossing,
        other => {
            count(skipped, format!("lanelet {}", shown(other, 30)));
            Use::Nothing
        }
    };
    let Some(mut lanelet) = Lanelet::new(whole(node, "id")?, left, right, use_) else {
        count(skipped, "lanelet without two bounds");
        return Ok(None);
    };
    lanelet.two_way = matches!(tag(node, "one_way"), "no" | "false");
    Ok(Some((lanelet, ids)))
}

/// An area of a kind.
fn area(kind: &str, ring: Vec<DVec2>, out: &mut LaneletMap) {
    let ground = match kind {
        "parking" | "parking_lot" | "parking_space" => LaneGround::Carpark,
        "freespace" | "exit" => LaneGround::Road,
        "walkway" => LaneGround::Walkway,
        other => return count(&mut out.skipped, format!("area {}", shown(other, 30))),
    };
    match ring.len() {
        0..=2 => count(&mut out.skipped, "area without an outline"),
        _ => out.areas.push((ground, ring)),
    }
}
