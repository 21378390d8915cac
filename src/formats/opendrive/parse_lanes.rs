//! From XML to lane sections.

use std::sync::Arc;

use roxmltree::Node;

use super::geometry::ReferenceLine;
use super::lanes::{Cubics, Extent, Lane, LaneKind, LaneSection, MarkStyle, RoadMark, SideLanes, Travel};
use super::parse::cubics;
use super::parse_elevation;
use super::xml::{
    Result, Skipped, ascending, bad, child, count, count_others, named, number, number_or, shown,
};

/// The lanes of a road.
pub(super) struct Lanes {
    pub offset: Cubics,
    pub sections: Vec<LaneSection>,
}

pub(super) fn lanes(
    road: Node<'_, '_>,
    reference: &ReferenceLine,
    left_hand: bool,
    skipped: &mut Skipped,
) -> Result<Lanes> {
    let mut out = Lanes {
        offset: Cubics::default(),
        sections: Vec::new(),
    };
    let Some(node) = child(road, "lanes") else {
        count(skipped, "road without lanes");
        return Ok(out);
    };
    count_others(node, &["laneOffset", "laneSection"], skipped);
    out.offset = cubics(node, "laneOffset", "s")?;
    let road_end = reference.end_s_m();
    let mut before: Option<LaneSection> = None;
    for section in named(node, "laneSection") {
        let start = number(section, "s")?;
        ascending(section, "s", start, before.as_ref().map(|b| b.start_s_m))?;
        let next = lane_section(section, start, left_hand, before.as_ref(), skipped)?;
        if let Some(mut done) = before.replace(next) {
            done.end_s_m = start.min(road_end);
            keep(done, &mut out.sections);
        }
    }
    match before {
        Some(mut last) => {
            last.end_s_m = road_end;
            keep(last, &mut out.sections);
        }
        None => count(skipped, "road without lanes"),
    }
    Ok(out)
}

/// Two sections that begin at one place, or one beyond the road's end: the empty one covers no ground.
fn keep(section: LaneSection, sections: &mut Vec<LaneSection>) {
    if section.end_s_m > section.start_s_m {
        sections.push(section);
    }
}

fn lane_section(
    node: Node<'_, '_>,
    start_s_m: f64,
    left_hand: bool,
    before: Option<&LaneSection>,
    skipped: &mut Skipped,
) -> Result<LaneSection> {
    count_others(node, &["left", "center", "right"], skipped);
    // A section of one side leaves the other side as it was.
    let single = node
        .attribute("singleSide")
        .is_some_and(|v| matches!(v.trim(), "true" | "1"));
    let mut side = |name: &'static str, old: Option<&Arc<SideLanes>>| -> Result<Arc<SideLanes>> {
        match (child(node, name), old) {
            (None, Some(old)) if single => Ok(old.clone()),
            (None, _) => Ok(Arc::default()),
            (Some(side), _) => {
                let mut lanes = Vec::new();
                count_others(side, &["lane"], skipped);
                for lane_node in named(side, "lane") {
                    lanes.push(lane(lane_node, name == "left", left_hand, skipped)?);
                }
                lanes.sort_by_key(|l| l.id.unsigned_abs());
                Ok(Arc::new(SideLanes {
                    origin_s_m: start_s_m,
                    lanes,
                }))
            }
        }
    };
    let left = side("left", before.map(|b| &b.left))?;
    let right = side("right", before.map(|b| &b.right))?;
    let center_lane = child(node, "center").and_then(|c| child(c, "lane"));
    let center_marks = match center_lane {
        Some(lane) => {
            count_others(lane, &["roadMark", "link"], skipped);
            road_marks(lane, skipped)?
        }
        None => Vec::new(),
    };
    Ok(LaneSection {
        start_s_m,
        end_s_m: start_s_m,
        left,
        right,
        center_marks,
    })
}

fn lane(node: Node<'_, '_>, is_left: bool, left_hand: bool, skipped: &mut Skipped) -> Result<Lane> {
    let text = node.attribute("id").unwrap_or_default();
    let expected = if is_left {
        "a positive whole number"
    } else {
        "a negative whole number"
    };
    let id = match text.trim().parse::<i32>() {
        Ok(id) if id != 0 && (id > 0) == is_left => id,
        _ => return Err(bad(node, "id", expected, &format!("{text:?}"))),
    };
    let kind_name = node.attribute("type").unwrap_or("none");
    let kind = LaneKind::from_name(kind_name).unwrap_or_else(|| {
        count(skipped, format!("lane type {}", shown(kind_name, 40)));
        LaneKind::None
    });
    let with_line = is_left == left_hand;
    let travel = match node.attribute("direction") {
        _ if kind == LaneKind::Bidirectional => Travel::Both,
        Some("both") => Travel::Both,
        Some("reversed") if with_line => Travel::Backward,
        Some("reversed") => Travel::Forward,
        _ if with_line => Travel::Forward,
        _ => Travel::Backward,
    };
    let widths = cubics(node, "width", "sOffset")?;
    let borders = cubics(node, "border", "sOffset")?;
    if widths.0.is_empty() && borders.0.is_empty() {
        count(skipped, "lane without width");
    }
    if !widths.0.is_empty() && !borders.0.is_empty() {
        count(skipped, "lane/border beside lane/width");
    }
    let extent = if widths.0.is_empty() && !borders.0.is_empty() {
        Extent::Border(borders)
    } else {
        Extent::Width(widths)
    };
    count_others(node, &["width", "border", "height", "roadMark", "link"], skipped);
    Ok(Lane {
        id,
        kind,
        travel,
        extent,
        heights: parse_elevation::lane_heights(node)?,
        marks: road_marks(node, skipped)?,
    })
}

fn road_marks(lane: Node<'_, '_>, skipped: &mut Skipped) -> Result<Vec<RoadMark>> {
    let mut marks: Vec<RoadMark> = Vec::new();
    for node in named(lane, "roadMark") {
        let s_m = number_or(node, "sOffset", 0.0)?;
        ascending(node, "sOffset", s_m, marks.last().map(|m| m.s_m))?;
        let style = match node.attribute("type").unwrap_or("none").trim() {
            "none" | "curb" | "grass" => MarkStyle::None,
            "solid" | "solid solid" | "edge" | "custom" => MarkStyle::Solid,
            "broken" | "broken broken" | "botts dots" => MarkStyle::Broken,
            "solid broken" | "broken solid" => MarkStyle::SolidAndBroken,
            other => {
                count(skipped, format!("road mark type {}", shown(other, 40)));
                MarkStyle::Solid
            }
        };
        count_others(node, &[], skipped);
        marks.push(RoadMark {
            s_m,
            style,
            yellow: node.attribute("color") == Some("yellow"),
        });
    }
    Ok(marks)
}
