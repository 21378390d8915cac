//! From XML to roads: header, plan view, profiles, links, junctions.

use std::sync::Arc;

use glam::DVec2;
use roxmltree::Node;

use super::geometry::{CurveShape, Geometry, MAX_LENGTH_M, ReferenceLine};
use super::own_rows::{self, OwnLayout};
use super::xml::{
    OpenDriveError, Result, Skipped, ascending, bad, child, count, count_others, decode, elements, four,
    named, number, parse_document, shown, within_reach,
};
use super::{RoadEnd, RoadNetwork, XodrJunction, XodrRoad, parse_elevation, parse_lanes, parse_objects};

/// A higher limit is a mistake, mm/s.
const FASTEST_MM_PER_S: f64 = 150_000.0;

/// Reads the bytes of an `.xodr` file. Nothing of the file is dropped without being counted in
/// [`RoadNetwork::skipped`]; a number that is not finite, a record without length, a road without
/// geometry and a start out of order are errors.
pub fn read(bytes: &[u8]) -> Result<RoadNetwork> {
    let text = decode(bytes)?;
    let document = parse_document(&text)?;
    let root = document.root_element();
    if root.tag_name().name() != "OpenDRIVE" {
        return Err(OpenDriveError::NotOpenDrive {
            found: shown(root.tag_name().name(), 40),
        });
    }
    let mut network = RoadNetwork::default();
    let skipped = &mut network.skipped;
    for node in elements(root) {
        match node.tag_name().name() {
            "header" => {
                network.name = shown(node.attribute("name").unwrap_or_default(), 80);
                count_others(node, &[], skipped);
            }
            "road" => network.roads.push(road(node, skipped)?),
            "junction" => network.junctions.push(junction(node, skipped)),
            "userData" if node.attribute("code") == Some(own_rows::CODE) => {
                // The rows hold for the roads that stand before them.
                let roads = text
                    .find("<road ")
                    .and_then(|from| text.get(from..node.range().start));
                let roads = roads.unwrap_or_default().trim_end_matches(' ');
                match OwnLayout::read(node, roads) {
                    Ok(own) => network.own = Some(Arc::new(own)),
                    Err(problem) => count(skipped, format!("sceneloom's {problem}")),
                }
            }
            "userData" => count(skipped, "userData"),
            _ => {}
        }
    }
    count_others(root, &["header", "road", "junction", "userData"], skipped);
    if network.roads.is_empty() {
        return Err(bad(root, "road", "at least one road", "none"));
    }
    network.marks_known =
        network.roads.iter().flat_map(|r| &r.sections).any(|s| {
            !s.center_marks.is_empty() || s.lanes_left_to_right().any(|lane| !lane.marks.is_empty())
        });
    Ok(network)
}

fn road(node: Node<'_, '_>, skipped: &mut Skipped) -> Result<XodrRoad> {
    let length = number(node, "length")?;
    if !(length > 0.0 && length <= MAX_LENGTH_M) {
        let expected = format!("a length above 0 and up to {MAX_LENGTH_M:.0} m");
        return Err(bad(node, "length", expected, &length.to_string()));
    }
    let reference = plan_view(node, skipped)?;
    if (reference.end_s_m() - length).abs() > 0.1 + 1e-3 * length {
        count(skipped, "road length that differs from its geometry");
    }
    let left_hand = match node.attribute("rule") {
        None | Some("RHT") => false,
        Some("LHT") => true,
        Some(other) => {
            count(skipped, format!("road rule {}", shown(other, 20)));
            false
        }
    };
    let surface = parse_elevation::surface(node, reference.end_s_m(), skipped)?;
    let lanes = parse_lanes::lanes(node, &reference, left_hand, skipped)?;
    let marks = parse_objects::objects(node, skipped)?;
    let limits = limits(node, skipped)?;
    let known = [
        "link",
        "type",
        "planView",
        "elevationProfile",
        "lateralProfile",
        "lanes",
        "objects",
        "signals",
    ];
    count_others(node, &known, skipped);
    let end = |name| {
        let link = child(child(node, "link")?, name)?;
        let id = link.attribute("elementId")?.to_owned();
        Some(match link.attribute("elementType") {
            Some("junction") => RoadEnd::Junction(id),
            _ => RoadEnd::Road(id),
        })
    };
    Ok(XodrRoad {
        id: node.attribute("id").unwrap_or_default().to_owned(),
        junction: node
            .attribute("junction")
            .filter(|id| !matches!(*id, "-1" | ""))
            .map(str::to_owned),
        left_hand,
        predecessor: end("predecessor"),
        successor: end("successor"),
        surface,
        lane_offset: lanes.offset,
        sections: lanes.sections,
        objects: marks,
        limits,
        reference,
    })
}

/// Speed limits of `<type>` records. A record without a limit ends the one before.
fn limits(road: Node<'_, '_>, skipped: &mut Skipped) -> Result<Vec<(f64, Option<u32>)>> {
    let mut out: Vec<(f64, Option<u32>)> = Vec::new();
    for node in named(road, "type") {
        let s_m = number(node, "s")?;
        ascending(node, "s", s_m, out.last().map(|l| l.0))?;
        count_others(node, &["speed"], skipped);
        let limit = child(node, "speed").map(|speed| speed_mm_per_s(speed, skipped));
        out.push((s_m, limit.flatten()));
    }
    match out.iter().any(|(_, limit)| limit.is_some()) {
        true => Ok(out),
        false => Ok(Vec::new()),
    }
}

/// The limit of a `<speed>` element, mm/s; `None` for "no limit" and "undefined". A value that cannot be read is
/// counted.
fn speed_mm_per_s(node: Node<'_, '_>, skipped: &mut Skipped) -> Option<u32> {
    let max = node.attribute("max").unwrap_or_default().trim();
    let mps = match node.attribute("unit").map(str::trim) {
        None | Some("m/s" | "") => Some(1.0),
        Some("km/h") => Some(1.0 / 3.6),
        Some("mph") => Some(0.447_04),
        Some(_) => None,
    };
    let limit = mps.and_then(|mps| Some(max.parse::<f64>().ok()? * mps * 1000.0));
    match limit {
        Some(mm_per_s) if (1.0..=FASTEST_MM_PER_S).contains(&mm_per_s) => Some(mm_per_s.round() as u32),
        None if matches!(max, "no limit" | "undefined") => None,
        _ => {
            count(skipped, "speed limit that cannot be read");
            None
        }
    }
}

fn plan_view(road: Node<'_, '_>, skipped: &mut Skipped) -> Result<ReferenceLine> {
    let view = child(road, "planView").ok_or_else(|| bad(road, "planView", "one element", "none"))?;
    count_others(view, &["geometry"], skipped);
    let mut records: Vec<Geometry> = Vec::new();
    for node in named(view, "geometry") {
        let record = geometry(node, skipped)?;
        if let Some(before) = records.last() {
            if record.s_m <= before.s_m {
                let expected = format!("more than {}, where the record before begins", before.s_m);
                return Err(bad(node, "s", expected, &record.s_m.to_string()));
            }
            if before
                .at(before.length_m)
                .position_m
                .distance(record.at(0.0).position_m)
                > 0.1
            {
                count(skipped, "gap in the reference line");
            }
        }
        records.push(record);
    }
    ReferenceLine::new(records).ok_or_else(|| bad(view, "geometry", "at least one record", "none"))
}

fn geometry(node: Node<'_, '_>, skipped: &mut Skipped) -> Result<Geometry> {
    const KINDS: &str = "one of line, arc, spiral, poly3, paramPoly3";
    let s = number(node, "s")?;
    if !(-1e-6..=MAX_LENGTH_M).contains(&s) {
        return Err(bad(
            node,
            "s",
            format!("0 to {MAX_LENGTH_M:.0} m"),
            &s.to_string(),
        ));
    }
    let start = DVec2::new(coordinate(node, "x")?, coordinate(node, "y")?);
    let heading = coordinate(node, "hdg")?;
    let length = number(node, "length")?;
    let is_shape = |n: &Node<'_, '_>| n.tag_name().name() != "userData";
    let kind = elements(node)
        .find(is_shape)
        .ok_or_else(|| bad(node, "shape", KINDS, "none"))?;
    let make = |shape| {
        Geometry::new(s, start, heading, length, shape).map_err(|(expected, found)| {
            let field = if found == length.to_string() {
                "length"
            } else {
                kind.tag_name().name()
            };
            bad(node, field, expected, &found)
        })
    };
    let shape = match kind.tag_name().name() {
        "line" => CurveShape::Line,
        "arc" => CurveShape::Arc {
            curvature_per_m: number(kind, "curvature")?,
        },
        "spiral" => CurveShape::Spiral {
            start_per_m: number(kind, "curvStart")?,
            end_per_m: number(kind, "curvEnd")?,
        },
        "poly3" => CurveShape::Poly3 {
            v: four(kind, ["a", "b", "c", "d"])?,
        },
        "paramPoly3" => {
            let u = four(kind, ["aU", "bU", "cU", "dU"])?;
            let v = four(kind, ["aV", "bV", "cV", "dV"])?;
            let normalized = match kind.attribute("pRange") {
                Some("normalized") => true,
                Some("arcLength") => false,
                None => {
                    count(skipped, "paramPoly3 without pRange (guessed)");
                    looks_normalized(u[1].hypot(v[1]), length)
                }
                Some(other) => {
                    return Err(bad(
                        kind,
                        "pRange",
                        "arcLength or normalized",
                        &format!("{other:?}"),
                    ));
                }
            };
            CurveShape::ParamPoly3 { u, v, normalized }
        }
        other => return Err(bad(node, "shape", KINDS, &format!("<{other}>"))),
    };
    count_others(node, &[kind.tag_name().name()], skipped);
    make(shape)
}

/// True if p runs from 0 to 1. Readers disagree on the range of p where none is given, but the speed at the start tells
/// it: about 1 if p is an arc length, about the length of the record if p runs from 0 to 1.
fn looks_normalized(speed: f64, length: f64) -> bool {
    (speed / length).ln().abs() < speed.ln().abs()
}

fn coordinate(node: Node<'_, '_>, field: &str) -> Result<f64> {
    within_reach(node, field, number(node, field)?)
}

fn junction(node: Node<'_, '_>, skipped: &mut Skipped) -> XodrJunction {
    let mut incoming: Vec<String> = Vec::new();
    let mut connections = 0;
    for connection in named(node, "connection") {
        connections += 1;
        if let Some(id) = connection.attribute("incomingRoad")
            && incoming.last().is_none_or(|last| last != id)
        {
            incoming.push(id.to_owned());
        }
        count_others(connection, &["laneLink"], skipped);
    }
    incoming.sort();
    incoming.dedup();
    count_others(node, &["connection"], skipped);
    if let Some(kind) = node.attribute("type")
        && !matches!(kind, "default" | "direct")
    {
        count(skipped, format!("junction of type {}", shown(kind, 40)));
    }
    XodrJunction {
        id: node.attribute("id").unwrap_or_default().to_owned(),
        incoming,
        connections,
    }
}

/// Cubic records of one element name, `s` in the attribute `start`.
pub(super) fn cubics(parent: Node<'_, '_>, name: &'static str, start: &str) -> Result<super::lanes::Cubics> {
    let mut out: Vec<super::lanes::CubicPiece> = Vec::new();
    for node in named(parent, name) {
        let s_m = number(node, start)?;
        ascending(node, start, s_m, out.last().map(|p| p.s_m))?;
        out.push(super::lanes::CubicPiece {
            s_m,
            k: four(node, ["a", "b", "c", "d"])?,
        });
    }
    Ok(super::lanes::Cubics(out))
}
