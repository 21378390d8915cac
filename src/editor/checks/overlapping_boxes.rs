//! Boxes that stand in each other.

use glam::DVec2;

use super::geometry::{area_m2, shared_area_m2, shared_height_m, way_out_m};
use super::unsound::are_duplicates;
use super::{Context, Finding, Findings, Fix, Severity, name_of};
use crate::Edit;
use language::tf;

pub const NAME: &str = "overlapping_boxes";
/// Boxes may share this part of the smaller footprint, and this height, without a word: labels are not exact.
const TOLERATED_SHARE: f64 = 0.05;
const TOLERATED_HEIGHT_M: f64 = 0.2;
/// From this part of the smaller footprint on one of the two cannot be right.
const WRONG_SHARE: f64 = 0.3;
/// Room that is left between boxes that are moved apart, m.
const GAP_M: f64 = 0.1;

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
            if out.is_full() {
                out.count(severity, where_m);
                continue;
            }
            let remove = Fix {
                label: "Remove the later box",
                edits: vec![Edit::RemoveBox { id: b.id }],
            };
            let shift = way_out_m(a, b);
            let shift = shift + shift.normalize_or(DVec2::ZERO) * GAP_M;
            let apart = Fix {
                label: "Move apart",
                edits: vec![Edit::MoveBox {
                    id: b.id,
                    center_m: Some(b.center_m + shift.extend(0.0)),
                    yaw_deg: None,
                    size_m: None,
                }],
            };
            out.push(Finding {
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
                // What takes a box away is never what is done without asking for it by name.
                fixes: vec![apart, remove],
            });
        }
    }
}
