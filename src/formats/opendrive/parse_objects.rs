//! From XML to what lies on the road: crossings, parking spaces, stop lines. Everything else is counted.

use roxmltree::Node;

use super::objects::{Corners, ObjectKind, Repeat, RoadObject};
use super::xml::{
    Result, Skipped, child, count, count_others, elements, named, number, number_or, number_or_none, shown,
};

/// Sign number of the stop line in the German catalogue, which OpenDRIVE files of any country use.
const STOP_LINE_SIGN: &str = "294";

pub(super) fn objects(road: Node<'_, '_>, skipped: &mut Skipped) -> Result<Vec<RoadObject>> {
    let mut out = Vec::new();
    if let Some(list) = child(road, "objects") {
        count_others(list, &["object"], skipped);
        for node in named(list, "object") {
            out.extend(object(node, skipped)?);
        }
    }
    if let Some(list) = child(road, "signals") {
        count_others(list, &["signal"], skipped);
        for node in named(list, "signal") {
            if node.attribute("type") == Some(STOP_LINE_SIGN) {
                out.push(stop_line(node)?);
            } else {
                count(skipped, "signal");
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

fn object(node: Node<'_, '_>, skipped: &mut Skipped) -> Result<Option<RoadObject>> {
    let [kind, subtype, name] = ["type", "subtype", "name"].map(|f| plain(node.attribute(f)));
    let kind = if kind == "crosswalk" || (kind.is_empty() && name.contains("crosswalk")) {
        ObjectKind::Crossing
    } else if kind == "parkingspace" {
        ObjectKind::Parking
    } else if [&kind, &subtype, &name].iter().any(|t| t.contains("stopline")) {
        return stop_line(node).map(Some);
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
    let outlines: Vec<Node<'_, '_>> = child(node, "outlines")
        .into_iter()
        .flat_map(|list| named(list, "outline"))
        .chain(named(node, "outline"))
        .collect();
    let mut corners = Vec::new();
    for outline in outlines {
        if outline.attribute("outer").is_some_and(|v| v.trim() == "false") {
            count(skipped, "hole in an object's outline");
            continue;
        }
        corners.extend(outline_corners(outline, skipped)?);
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
        repeats.push(repeat(node)?);
    }
    Ok(Some(RoadObject {
        kind,
        s_m: number(node, "s")?,
        t_m: number_or(node, "t", 0.0)?,
        heading_rad: number_or(node, "hdg", 0.0)?,
        size_m: [number_or(node, "length", 0.0)?, number_or(node, "width", 0.0)?],
        line_width_m,
        outlines: corners,
        repeats,
    }))
}

fn outline_corners(outline: Node<'_, '_>, skipped: &mut Skipped) -> Result<Option<Corners>> {
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
                Corners::Road(road)
            } else {
                Corners::Local(local)
            })
        }
    })
}

fn repeat(node: Node<'_, '_>) -> Result<Repeat> {
    let pair = |from, to| -> Result<Option<[f64; 2]>> {
        Ok(match (number_or_none(node, from)?, number_or_none(node, to)?) {
            (None, None) => None,
            (Some(a), None) | (None, Some(a)) => Some([a, a]),
            (Some(a), Some(b)) => Some([a, b]),
        })
    };
    Ok(Repeat {
        s_m: number(node, "s")?,
        run_m: number(node, "length")?.max(0.0),
        distance_m: number_or(node, "distance", 0.0)?,
        t_m: pair("tStart", "tEnd")?,
        length_m: pair("lengthStart", "lengthEnd")?,
        width_m: pair("widthStart", "widthEnd")?,
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
        line_width_m: None,
        outlines: Vec::new(),
        repeats: Vec::new(),
    })
}
