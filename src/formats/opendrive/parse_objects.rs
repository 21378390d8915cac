//! From XML to objects: crossings, parking spaces and stop lines on the road, and objects that stand beside it. All
//! other objects are counted.

use roxmltree::Node;

use super::lanes::{LaneGround, LaneKind};
use super::objects::{ObjectKind, OutlineCorners, Repeat, RoadObject};
use super::standing::RoadsideObject;
use super::xml::{
    Result, Skipped, child, count, count_others, elements, named, number, number_or, number_or_none, shown,
};
use scene::background::PostKind;

/// Sign number of the stop line in the German catalogue, which OpenDRIVE files of any country use.
const STOP_LINE_SIGN: &str = "294";

pub(super) fn objects(road: Node<'_, '_>, skipped: &mut Skipped) -> Result<Vec<RoadObject>> {
    let mut out = Vec::new();
    if let Some(list) = child(road, "objects") {
        count_others(list, &["object"], skipped);
        for node in named(list, "object") {
            match object(node, skipped) {
                Err(_) if standing(node).is_some() => count(skipped, "object with an unreadable number"),
                read => out.extend(read?),
            }
        }
    }
    if let Some(list) = child(road, "signals") {
        count_others(list, &["signal"], skipped);
        for node in named(list, "signal") {
            if node.attribute("type") == Some(STOP_LINE_SIGN) {
                out.push(stop_line(node)?);
            } else {
                match signal(node) {
                    Ok(signal) => out.push(signal),
                    Err(_) => count(skipped, "signal with an unreadable number"),
                }
            }
        }
    }
    Ok(out)
}

/// Lower-case letters only, so that `StopLine`, `stop line` and `stop_line` agree.
fn plain(text: Option<&str>) -> String {
    text.unwrap_or_default()
        .chars()
        .filter(|c| c.is_ascii_alphabetic())
        .map(|c| c.to_ascii_lowercase())
        .collect()
}

fn names(node: Node<'_, '_>) -> [String; 3] {
    ["type", "subtype", "name"].map(|f| plain(node.attribute(f)))
}

/// Kind of an object that stands beside the road; `None` if it is not known or does not stand there.
fn standing(node: Node<'_, '_>) -> Option<RoadsideObject> {
    let [kind, subtype, name] = names(node);
    RoadsideObject::from_names(&kind, &subtype, &name)
}

/// The ground that an outline says to be of a kind of lane (OpenDRIVE 1.5 and later).
fn ground(node: Node<'_, '_>) -> Option<LaneGround> {
    let mut kinds = outlines(node).filter_map(|outline| LaneKind::from_name(outline.attribute("laneType")?));
    kinds.next()?.ground_alone()
}

/// Outlines in their list and, as in OpenDRIVE 1.4, without one.
fn outlines<'a, 'i: 'a>(node: Node<'a, 'i>) -> impl Iterator<Item = Node<'a, 'i>> {
    let listed = child(node, "outlines")
        .into_iter()
        .flat_map(|list| named(list, "outline"));
    listed.chain(named(node, "outline"))
}

fn object(node: Node<'_, '_>, skipped: &mut Skipped) -> Result<Option<RoadObject>> {
    let [kind, subtype, name] = names(node);
    let kind = if kind == "crosswalk" || (kind.is_empty() && name.contains("crosswalk")) {
        ObjectKind::Crossing
    } else if kind == "parkingspace" {
        ObjectKind::Parking
    } else if [&kind, &subtype, &name].iter().any(|t| t.contains("stopline")) {
        return stop_line(node).map(Some);
    } else if let Some(standing) = standing(node) {
        ObjectKind::Standing(standing)
    } else if let Some(ground) = ground(node) {
        ObjectKind::Area(ground)
    } else {
        let label = node
            .attribute("type")
            .filter(|t| !t.is_empty())
            .unwrap_or("without type");
        count(skipped, format!("object {}", shown(label, 40)));
        return Ok(None);
    };
    let known = [
        "outlines",
        "outline",
        "repeat",
        "markings",
        "parkingSpace",
        "validity",
        "material",
    ];
    count_others(node, &known, skipped);
    let mut corners = Vec::new();
    // Heights matter only for objects that stand.
    let stands = matches!(kind, ObjectKind::Standing(_));
    let upward = |node, field| {
        if stands {
            number_or_none(node, field)
        } else {
            Ok(None)
        }
    };
    let mut height_m = upward(node, "height")?;
    for outline in outlines(node) {
        if outline.attribute("outer").is_some_and(|v| v.trim() == "false") {
            count(skipped, "hole in an object's outline");
            continue;
        }
        corners.extend(outline_corners(outline, skipped)?);
        for corner in elements(outline) {
            // As high as its highest corner.
            let corner_m = upward(corner, "height")?.filter(|m| *m > 0.0);
            height_m = height_m.into_iter().chain(corner_m).reduce(f64::max);
        }
    }
    let mut line_width_m = None;
    for marking in child(node, "markings")
        .into_iter()
        .flat_map(|m| named(m, "marking"))
    {
        line_width_m = number_or_none(marking, "width")?.or(line_width_m);
    }
    let mut repeats = Vec::new();
    for node in named(node, "repeat") {
        repeats.push(repeat(node, stands)?);
    }
    Ok(Some(RoadObject {
        kind,
        s_m: number(node, "s")?,
        t_m: number_or(node, "t", 0.0)?,
        heading_rad: number_or(node, "hdg", 0.0)?,
        size_m: [number_or(node, "length", 0.0)?, number_or(node, "width", 0.0)?],
        height_m: height_m.unwrap_or(0.0),
        radius_m: upward(node, "radius")?.unwrap_or(0.0),
        lift_m: upward(node, "zOffset")?.unwrap_or(0.0),
        line_width_m,
        outlines: corners,
        repeats,
    }))
}

fn outline_corners(outline: Node<'_, '_>, skipped: &mut Skipped) -> Result<Option<OutlineCorners>> {
    let mut local = Vec::new();
    let mut road = Vec::new();
    for corner in elements(outline) {
        match corner.tag_name().name() {
            "cornerLocal" => local.push([number(corner, "u")?, number(corner, "v")?]),
            "cornerRoad" => road.push([number(corner, "s")?, number(corner, "t")?]),
            _ => {}
        }
    }
    count_others(outline, &["cornerLocal", "cornerRoad"], skipped);
    Ok(match (local.len(), road.len()) {
        (0, 0) => None,
        (local_count, road_count) => {
            if local_count > 0 && road_count > 0 {
                count(skipped, "outline with corners of both kinds");
            }
            Some(if road_count > 0 {
                OutlineCorners::Road(road)
            } else {
                OutlineCorners::Local(local)
            })
        }
    })
}

fn repeat(node: Node<'_, '_>, stands: bool) -> Result<Repeat> {
    let pair = |from, to| -> Result<Option<[f64; 2]>> {
        Ok(match (number_or_none(node, from)?, number_or_none(node, to)?) {
            (None, None) => None,
            (Some(a), None) | (None, Some(a)) => Some([a, a]),
            (Some(a), Some(b)) => Some([a, b]),
        })
    };
    let upward = |from, to| if stands { pair(from, to) } else { Ok(None) };
    Ok(Repeat {
        s_m: number(node, "s")?,
        run_m: number(node, "length")?.max(0.0),
        distance_m: number_or(node, "distance", 0.0)?,
        t_m: pair("tStart", "tEnd")?,
        length_m: pair("lengthStart", "lengthEnd")?,
        width_m: pair("widthStart", "widthEnd")?,
        height_m: upward("heightStart", "heightEnd")?,
        lift_m: upward("zOffsetStart", "zOffsetEnd")?,
    })
}

/// A stop line lies across the lanes whose traffic its orientation names.
fn stop_line(node: Node<'_, '_>) -> Result<RoadObject> {
    let against_line = match node.attribute("orientation") {
        Some("+") => Some(false),
        Some("-") => Some(true),
        _ => None,
    };
    Ok(RoadObject {
        kind: ObjectKind::StopLine { against_line },
        s_m: number(node, "s")?,
        t_m: number_or(node, "t", 0.0)?,
        heading_rad: 0.0,
        size_m: [0.0; 2],
        height_m: 0.0,
        radius_m: 0.0,
        lift_m: 0.0,
        line_width_m: None,
        outlines: Vec::new(),
        repeats: Vec::new(),
    })
}

/// A sign or a light: it faces the traffic that its orientation names.
fn signal(node: Node<'_, '_>) -> Result<RoadObject> {
    let changes = node.attribute("dynamic").is_some_and(|v| v.trim() == "yes");
    let kind = if changes {
        PostKind::TrafficLight
    } else {
        PostKind::Sign
    };
    let faces_rad = match node.attribute("orientation") {
        Some("-") => 0.0,
        _ => std::f64::consts::PI,
    };
    Ok(RoadObject {
        kind: ObjectKind::Standing(RoadsideObject::Signal(kind)),
        s_m: number_or(node, "s", 0.0)?,
        t_m: number_or(node, "t", 0.0)?,
        heading_rad: faces_rad + number_or(node, "hOffset", 0.0)?,
        size_m: [0.0, number_or(node, "width", 0.0)?],
        height_m: number_or(node, "height", 0.0)?,
        radius_m: 0.0,
        lift_m: number_or(node, "zOffset", 0.0)?,
        line_width_m: None,
        outlines: Vec::new(),
        repeats: Vec::new(),
    })
}
