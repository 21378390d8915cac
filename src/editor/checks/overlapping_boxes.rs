//! Boxes that stand in each other.

use glam::DVec2;

use super::geometry::{area_m2, shared_area_m2, shared_height_m, way_out_m};
use super::unsound::are_duplicates;
use super::{Context, Finding, Findings, Fix, Severity, name_of};
use crate::Edit;
use language::tf;
use scene::SceneBox;

pub const NAME: &str = "overlapping_boxes";
/// Boxes may share this part of the smaller footprint, and this height, without a word: labels are not exact.
const TOLERATED_SHARE: f64 = 0.05;
const TOLERATED_HEIGHT_M: f64 = 0.2;
/// From this part of the smaller footprint on one of the two cannot be right.
const WRONG_SHARE: f64 = 0.3;
/// Room that is left between boxes that are moved apart, m.
const GAP_M: f64 = 0.1;
/// A box is moved no farther out of another where there is room, m.
const FARTHEST_M: f64 = 15.0;

pub fn check(context: &Context<'_>, out: &mut Findings) {
    let across_m: Vec<f64> = context
        .boxes
        .iter()
        .map(|b| b.size_m.truncate().length())
        .collect();
    for (i, a) in context.boxes.iter().enumerate() {
        for (b, b_across_m) in context.boxes[i + 1..].iter().zip(&across_m[i + 1..]) {
            let reach = (across_m[i] + b_across_m) / 2.0;
            let (pa, pb) = (a.center_m.truncate(), b.center_m.truncate());
            if pa.distance_squared(pb) >= reach * reach
                || shared_height_m(a, b) <= TOLERATED_HEIGHT_M
                || are_duplicates(a, b)
            {
                continue;
            }
            let share = shared_area_m2(a, b) / area_m2(a).min(area_m2(b));
            if share <= TOLERATED_SHARE {
                continue;
            }
            let severity = match share > WRONG_SHARE {
                true => Severity::Error,
                false => Severity::Warning,
            };
            let where_m = (a.center_m + b.center_m) / 2.0;
            // A recorded box that something made stands in is no fault of the recording.
            let is_made = out.is_recorded(b.id) && !out.is_recorded(a.id);
            if out.is_full() {
                out.count((severity, NAME, Some(if is_made { a.id } else { b.id })), where_m);
                continue;
            }
            let remove = Fix {
                label: "Remove the later box",
                edits: vec![Edit::RemoveBox { id: b.id }],
            };
            let shift_m = clear_way_m(context, a, b).unwrap_or_else(|| shortest_m(a, b));
            let apart = Fix {
                label: "Move apart",
                edits: vec![Edit::MoveBox {
                    id: b.id,
                    center_m: Some(b.center_m + shift_m.extend(0.0)),
                    yaw_deg: None,
                    size_m: None,
                }],
            };
            let finding = Finding {
                check: NAME,
                severity,
                where_m,
                box_id: Some(b.id),
                time_s: None,
                cells: Vec::new(),
                text: tf!(
                    "{first} and {second} overlap by {percent} % of the smaller one",
                    first = name_of(a),
                    second = name_of(b),
                    percent = format!("{:.0}", 100.0 * share.min(1.0))
                ),
                // A repair that removes a box is never the first: it is done only if asked for by name.
                fixes: vec![apart, remove],
            };
            match is_made {
                true => out.push_made(finding),
                false => out.push(finding),
            }
        }
    }
}

/// The shortest way of `b` out of `a`, whatever stands there, m.
fn shortest_m(a: &SceneBox, b: &SceneBox) -> DVec2 {
    let shift = way_out_m(a, b);
    shift + shift.normalize_or(DVec2::ZERO) * GAP_M
}

/// The shortest straight way of `b`, along or across one of the two, to where it stands on the map and in no other box, m;
/// none within [`FARTHEST_M`].
fn clear_way_m(context: &Context<'_>, a: &SceneBox, b: &SceneBox) -> Option<DVec2> {
    let extent = context.frame.extent();
    let across_m = |b: &SceneBox| b.size_m.truncate().length();
    let from_m = b.center_m.truncate();
    let near: Vec<&SceneBox> = context
        .boxes
        .iter()
        .filter(|o| o.id != b.id && shared_height_m(o, b) > TOLERATED_HEIGHT_M)
        .filter(|o| {
            let reach_m = FARTHEST_M + (across_m(o) + across_m(b)) / 2.0;
            o.center_m.truncate().distance(from_m) < reach_m
        })
        .collect();
    let at = |shift_m: DVec2| SceneBox {
        center_m: b.center_m + shift_m.extend(0.0),
        ..*b
    };
    let axes = [b.heading(), b.heading().perp(), a.heading(), a.heading().perp()];
    let ways = axes.into_iter().flat_map(|axis| [axis, -axis]);
    let clear = ways.filter_map(|way| {
        let mut far_m = past_m(a, b, way) + GAP_M;
        // Past each box that it meets, until it meets none.
        for _ in 0..=near.len() {
            let moved = at(way * far_m);
            let met = near.iter().find(|o| shared_area_m2(o, &moved) > 0.0);
            let Some(met) = met else {
                let [x, y] = moved.center_m.truncate().to_array();
                return extent.column_at(x, y).map(|_| way * far_m);
            };
            far_m += past_m(met, &moved, way).max(0.0) + GAP_M;
            if far_m > FARTHEST_M {
                return None;
            }
        }
        None
    });
    clear.min_by(|a, b| a.length_squared().total_cmp(&b.length_squared()))
}

/// How far `b` has to go along a direction until all of it lies beyond `a`, m.
fn past_m(a: &SceneBox, b: &SceneBox, way: DVec2) -> f64 {
    let reach = |corners: [DVec2; 4]| corners.map(|p| p.dot(way));
    let end = reach(a.footprint()).into_iter().fold(f64::NEG_INFINITY, f64::max);
    let begin = reach(b.footprint()).into_iter().fold(f64::INFINITY, f64::min);
    end - begin
}
