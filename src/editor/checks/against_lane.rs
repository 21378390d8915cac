//! Vehicles on a lane that face or drive against it, or stand across it.

use glam::DVec2;

use super::lanes::{gap_deg, near};
use super::locomotion::{Locomotion, locomotion_of};
use super::{Context, Finding, Findings, Fix, Severity, name_of};
use crate::Edit;
use language::{filled, t};
use scene::{BevLayer, Class, SceneBox};

pub const NAME: &str = "against_lane";
/// A vehicle is on a lane if its centre is this near to the lane's middle, m: half a lane.
const HALF_LANE_M: f64 = 1.7;
/// Headings up to this far from the lane's are turns and changes of lane, degrees.
const TOLERATED_DEG: f64 = 60.0;
/// From here on it is against the lane and not across it, degrees.
const AGAINST_DEG: f64 = 120.0;

pub fn check(context: &Context<'_>, out: &mut Findings) {
    let layout = &context.frame.layout;
    let on_wheels = |c: Class| c.is_vehicle() || c == Class::Motorcycle;
    for b in context.boxes.iter().filter(|b| on_wheels(b.class)) {
        let p = b.center_m.truncate();
        // In a car park vehicles stand as the places do, and where works block the road machines as they need.
        let Some([x, y]) = layout.extent().column_at(p.x, p.y) else {
            continue;
        };
        let cell = layout.cell(x, y);
        let works = b.class == Class::ConstructionVehicle && b.velocity_mps == DVec2::ZERO;
        if cell & BevLayer::DrivableArea.bit() == 0 || cell & BevLayer::CarparkArea.bit() != 0 || works {
            continue;
        }
        // On a junction several lanes cross: the best one counts.
        let pieces = near(layout, p, HALF_LANE_M);
        let gap = |heading_rad: f64| gap_deg(heading_rad, b.yaw_rad);
        let best = pieces
            .iter()
            .min_by(|a, b| gap(a.heading_rad).total_cmp(&gap(b.heading_rad)));
        let Some(best) = best.filter(|l| gap(l.heading_rad) > TOLERATED_DEG) else {
            continue;
        };
        let nearest = pieces
            .iter()
            .min_by(|a, b| a.distance_m.total_cmp(&b.distance_m))
            .unwrap_or(best);
        let angle = gap(best.heading_rad);
        let how = match (angle > AGAINST_DEG, b.velocity_mps != DVec2::ZERO) {
            (true, true) if locomotion_of(b.class) != Locomotion::Drives => {
                "{thing} moves against its lane, {angle} degrees from it"
            }
            (true, true) => "{thing} drives against its lane, {angle} degrees from it",
            (true, false) => "{thing} faces against its lane, {angle} degrees from it",
            (false, _) => "{thing} stands across its lane, {angle} degrees from it",
        };
        let angle = format!("{angle:.0}");
        out.push(Finding {
            check: NAME,
            severity: Severity::Warning,
            where_m: b.center_m,
            box_id: Some(b.id),
            time_s: None,
            cells: Vec::new(),
            text: filled(t(how), &[("thing", &name_of(b)), ("angle", &angle)]),
            fixes: vec![Fix {
                label: "Turn to the lane's heading",
                edits: turned(b, nearest.heading_rad),
            }],
        });
    }
}

/// A moving box is entered anew: its velocity turns with it, which a move alone does not do.
fn turned(b: &SceneBox, yaw_rad: f64) -> Vec<Edit> {
    let yaw_deg = yaw_rad.to_degrees();
    if b.velocity_mps == DVec2::ZERO {
        return vec![Edit::MoveBox {
            id: b.id,
            center_m: None,
            yaw_deg: Some(yaw_deg),
            size_m: None,
        }];
    }
    let turn = DVec2::from_angle(yaw_rad - b.yaw_rad);
    vec![
        Edit::RemoveBox { id: b.id },
        Edit::AddBox {
            class: b.class,
            center_m: b.center_m,
            size_m: b.size_m,
            yaw_deg,
            velocity_mps: Some(turn.rotate(b.velocity_mps)),
            id: Some(b.id),
            label: b.label,
        },
    ]
}
