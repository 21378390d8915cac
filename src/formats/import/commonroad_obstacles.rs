//! The obstacles of a CommonRoad scenario as boxes, where they are at its start.

use glam::{DVec2, DVec3};
use roxmltree::Node;

use super::commonroad::{number, point};
use crate::opendrive::Skipped;
use crate::opendrive::xml::{Result, child, count, shown};
use scene::{BoxId, Class, SceneBox};

/// The box of an obstacle, on the ground at 0. An obstacle that a scene cannot have is counted in `skipped`.
pub(super) fn obstacle(node: Node<'_, '_>, id: u32, skipped: &mut Skipped) -> Result<Option<SceneBox>> {
    let kind = child(node, "type")
        .and_then(|n| n.text())
        .unwrap_or("unknown")
        .trim();
    let class = match kind {
        "car" | "parkedVehicle" | "priorityVehicle" | "taxi" | "unknown" => Class::Car,
        "truck" => Class::Truck,
        "bus" => Class::Bus,
        "motorcycle" => Class::Motorcycle,
        "bicycle" => Class::Bicycle,
        "pedestrian" => Class::Pedestrian,
        "roadBoundary" | "constructionZone" | "median_strip" | "pillar" => Class::Barrier,
        other => {
            count(skipped, format!("obstacle {}", shown(other, 30)));
            return Ok(None);
        }
    };
    let shape = child(node, "shape");
    let rectangle = shape.and_then(|s| child(s, "rectangle"));
    let circle = shape.and_then(|s| child(s, "circle"));
    let part = |of: Option<Node<'_, '_>>, name: &'static str| -> Result<Option<f64>> {
        of.and_then(|n| child(n, name)).map(number).transpose()
    };
    let diameter_m = part(circle, "radius")?.map(|r| 2.0 * r);
    let length_m = part(rectangle, "length")?.or(diameter_m);
    let width_m = part(rectangle, "width")?.or(diameter_m);
    let state = child(node, "initialState");
    // A place is a point, or the middle of where the obstacle may be.
    let position = state.and_then(|s| child(s, "position"));
    let middle = |area: &'static str| position.and_then(|p| child(child(p, area)?, "center"));
    let place = position
        .and_then(|p| child(p, "point"))
        .or_else(|| middle("rectangle"))
        .or_else(|| middle("circle"));
    let place = place.map(point).transpose()?;
    let exact = |name: &'static str| -> Result<Option<f64>> {
        let Some(value) = state.and_then(|s| child(s, name)) else {
            return Ok(None);
        };
        let of = |name: &'static str| child(value, name).map(number).transpose();
        let (from, to) = (of("intervalStart")?, of("intervalEnd")?);
        Ok(of("exact")?.or(from.zip(to).map(|(from, to)| (from + to) / 2.0)))
    };
    let (Some(at), Some(length_m), Some(width_m)) = (place, length_m, width_m) else {
        count(skipped, format!("obstacle {kind} without a place or a size"));
        return Ok(None);
    };
    if child(node, "trajectory").is_some() || child(node, "occupancySet").is_some() {
        count(skipped, "motion of an obstacle (it stands where it begins)");
    }
    let height_m = class.typical_size_m().map_or(1.0, |size| size[2]);
    let yaw_rad = exact("orientation")?.unwrap_or(0.0);
    let speed_mps = exact("velocity")?.unwrap_or(0.0);
    let b = SceneBox {
        id: BoxId(id),
        class,
        center_m: DVec3::new(at.x, at.y, height_m / 2.0),
        size_m: DVec3::new(length_m, width_m, height_m),
        yaw_rad,
        velocity_mps: DVec2::from_angle(yaw_rad) * speed_mps,
        label: Default::default(),
    };
    let size_sound = b.size_m.min_element() > 0.0 && b.size_m.max_element() <= SceneBox::MAX_SIZE_M;
    if !size_sound {
        count(skipped, format!("obstacle {kind} without a usable size"));
    }
    Ok(size_sound.then_some(b))
}
