//! Vehicles that do not stand on a road or a car park; cones, barriers and machines of works that stand far from any.

use glam::DVec2;

use super::geometry::{shared_area_m2, shared_height_m};
use super::lanes::nearest;
use super::{Context, Finding, Findings, Fix, Severity, name_of};
use crate::Edit;
use language::tf;
use scene::raster::box_cells;
use scene::{BevLayer, BevLayout, Class, SceneBox};

pub const NAME: &str = "off_road";
/// A vehicle is on the road if at least this share of its footprint is.
const ON_ROAD: f64 = 0.5;
/// How far away a lane may be that a vehicle is put on, m.
const REACH_M: f64 = 12.0;
/// Bits of the layers that vehicles stand on.
const ROAD: u32 =
    1 << BevLayer::DrivableArea as u32 | 1 << BevLayer::CarparkArea as u32 | 1 << BevLayer::RoadBlock as u32;

pub fn check(context: &Context<'_>, out: &mut Findings) {
    let layout = &context.frame.layout;
    // Without any road the layout says nothing about where vehicles belong.
    if layout.cells().iter().all(|c| c & ROAD == 0) {
        return;
    }
    for b in &context.boxes {
        let (text, fix) = match b.class {
            c if c.is_vehicle() && c != Class::ConstructionVehicle => {
                let Some(text) = vehicle(layout, b) else { continue };
                (text, onto_lane(context, b))
            }
            Class::ConstructionVehicle | Class::Barrier | Class::TrafficCone => {
                // Boxes that were fitted to voxels stand where the data set saw them.
                if context.frame.inferred.boxes.contains(&b.id) || !is_off_paved(layout, b) {
                    continue;
                }
                (
                    tf!("{thing} stands off the road", thing = name_of(b)),
                    onto_road(context, b),
                )
            }
            // People go anywhere; two-wheelers are parked on walkways.
            _ => continue,
        };
        out.push(Finding {
            check: NAME,
            severity: Severity::Warning,
            where_m: b.center_m,
            box_id: Some(b.id),
            time_s: None,
            cells: Vec::new(),
            text,
            fixes: fix.into_iter().collect(),
        });
    }
}

/// The problem with a vehicle's place; `None` if there is none.
fn vehicle(layout: &BevLayout, b: &SceneBox) -> Option<String> {
    let (mut cells, mut on) = (0usize, 0usize);
    box_cells(layout.extent(), b, 0.0, |x, y| {
        cells += 1;
        on += usize::from(layout.cell(x, y) & ROAD != 0);
    });
    if cells == 0 || on as f64 >= ON_ROAD * cells as f64 {
        return None;
    }
    Some(match on {
        0 => tf!("{thing} stands off the road", thing = name_of(b)),
        _ => tf!(
            "{thing} stands with {on} of {cells} columns on the road",
            thing = name_of(b),
            on = on,
            cells = cells
        ),
    })
}

/// True if no road, car park, walkway or crossing lies under a box that is on the map. One column is enough: a row of
/// barriers follows the edge of the road.
fn is_off_paved(layout: &BevLayout, b: &SceneBox) -> bool {
    let paved = ROAD | BevLayer::Walkway.bit() | BevLayer::PedCrossing.bit();
    let (mut cells, mut on) = (0usize, false);
    box_cells(layout.extent(), b, 0.0, |x, y| {
        cells += 1;
        on |= layout.cell(x, y) & paved != 0;
    });
    cells > 0 && !on
}

/// The nearest place on a lane, along it, if nothing stands there.
fn onto_lane(context: &Context<'_>, b: &SceneBox) -> Option<Fix> {
    let lane = nearest(&context.frame.layout, b.center_m.truncate(), REACH_M)?;
    let moved = SceneBox {
        center_m: lane.point_m.extend(b.center_m.z),
        yaw_rad: lane.heading_rad,
        ..*b
    };
    moved_to(context, &moved, "Move onto the lane")
}

/// The nearest road cell, heading as it is, if nothing stands there.
fn onto_road(context: &Context<'_>, b: &SceneBox) -> Option<Fix> {
    let layout = &context.frame.layout;
    let extent = layout.extent();
    let off = |p: &DVec2| p.distance_squared(b.center_m.truncate());
    let cells = extent.all_columns().zip(layout.cells());
    let road = cells.filter(|(_, bits)| **bits & ROAD != 0);
    let places = road.map(|([x, y], _)| extent.center(x, y, 0).truncate());
    let nearest = places.min_by(|a, b| off(a).total_cmp(&off(b)))?;
    let moved = SceneBox {
        center_m: nearest.extend(b.center_m.z),
        ..*b
    };
    moved_to(context, &moved, "Move to the road")
}

fn moved_to(context: &Context<'_>, moved: &SceneBox, label: &'static str) -> Option<Fix> {
    let mut others = context.boxes.iter().filter(|o| o.id != moved.id);
    if others.any(|o| shared_area_m2(o, moved) > 0.0 && shared_height_m(o, moved) > 0.0) {
        return None;
    }
    Some(Fix {
        label,
        edits: vec![Edit::MoveBox {
            id: moved.id,
            center_m: Some(moved.center_m),
            yaw_deg: Some(moved.yaw_rad.to_degrees()),
            size_m: None,
        }],
    })
}
