//! Vehicles that do not stand on a road or a car park.

use super::geometry::{shared_area_m2, shared_height_m};
use super::lanes::nearest;
use super::{Context, Finding, Fix, Severity, name_of};
use crate::editor::Edit;
use crate::scene::raster::box_cells;
use crate::scene::{BevLayer, Class, SceneBox};

pub const NAME: &str = "off_road";
/// A vehicle is on the road if at least this share of its footprint is.
const ON_ROAD: f64 = 0.5;
/// How far away a lane may be that a vehicle is put on, m.
const REACH_M: f64 = 12.0;

pub fn check(context: &Context<'_>, out: &mut Vec<Finding>) {
    let layout = &context.frame.layout;
    let road = BevLayer::DrivableArea.bit() | BevLayer::CarparkArea.bit() | BevLayer::RoadBlock.bit();
    // Without any road the layout says nothing about where vehicles belong.
    if layout.cells().iter().all(|c| c & road == 0) {
        return;
    }
    for b in context.boxes.iter().filter(|b| drives(b.class)) {
        let (mut cells, mut on) = (0usize, 0usize);
        box_cells(b, 0.0, |x, y| {
            cells += 1;
            on += usize::from(layout.cell(x, y) & road != 0);
        });
        if cells == 0 || on as f64 >= ON_ROAD * cells as f64 {
            continue;
        }
        let text = match on {
            0 => format!("{} stands off the road", name_of(b)),
            _ => format!("{} stands with {} of {cells} columns on the road", name_of(b), on),
        };
        out.push(Finding {
            check: NAME,
            severity: Severity::Warning,
            where_m: b.center_m,
            box_id: Some(b.id),
            cells: Vec::new(),
            text,
            fixes: onto_lane(context, b).into_iter().collect(),
        });
    }
}

/// Machines at works stand where they work; two-wheelers are parked on walkways.
fn drives(class: Class) -> bool {
    class.is_vehicle() && class != Class::ConstructionVehicle
}

/// The nearest place on a lane, along it, if nothing stands there.
fn onto_lane(context: &Context<'_>, b: &SceneBox) -> Option<Fix> {
    let lane = nearest(&context.frame.layout, b.center_m.truncate(), REACH_M)?;
    let moved = SceneBox {
        center_m: lane.point_m.extend(b.center_m.z),
        yaw_rad: lane.heading_rad,
        ..*b
    };
    let mut others = context.boxes.iter().filter(|o| o.id != b.id);
    if others.any(|o| shared_area_m2(o, &moved) > 0.0 && shared_height_m(o, &moved) > 0.0) {
        return None;
    }
    Some(Fix {
        label: "Move onto the lane",
        edits: vec![Edit::MoveBox {
            id: b.id,
            center_m: Some(moved.center_m),
            yaw_deg: Some(moved.yaw_rad.to_degrees()),
            size_m: None,
        }],
    })
}
