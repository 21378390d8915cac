//! Participants: the ego vehicle, every box that stands, every track.

use std::fmt::Write as _;

use glam::DVec3;

use crate::xml_text::{escaped, number};
use scene::{BoxId, Class, Scene, SceneBox};

/// From a vehicle's middle back to its rear axle, as a share of its length.
const REAR_SHARE: f64 = 0.29;
/// From its rear axle to its front axle, as a share of its length.
const BASE_SHARE: f64 = 0.6;

/// Name of the ego vehicle.
pub(super) const EGO: &str = "Ego";

/// A participant of the scenario.
pub(super) struct Actor {
    /// Unique in the file; letters, digits and `_`.
    pub name: String,
    pub who: Who,
    pub class: Class,
    /// Name for a person.
    pub called: String,
    /// Length, width, height, m.
    pub size_m: DVec3,
    /// From its reference point to the middle of its box, along its heading, to its left and up, m. The reference point
    /// of a vehicle is its rear axle on the ground; that of any other participant is the middle of its box on the
    /// ground.
    pub center_m: DVec3,
}

/// The ego vehicle or the box of the scene that a participant is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Who {
    Ego,
    Standing(BoxId),
    Moving(BoxId),
}

/// The ego vehicle first, then boxes by id.
pub(super) fn actors(scene: &Scene) -> Vec<Actor> {
    let rig = &scene.rig;
    let ego = Actor {
        name: EGO.into(),
        who: Who::Ego,
        class: Class::Car,
        called: "ego vehicle".into(),
        size_m: DVec3::from_array(rig.ego_size_m),
        center_m: DVec3::from_array(rig.ego_center_m),
    };
    let standing = scene
        .canvas()
        .boxes
        .values()
        .map(|b| actor(b, Who::Standing(b.id)));
    let moving = scene.clip().tracks.values();
    let moving = moving.map(|t| actor(&t.made, Who::Moving(t.made.id)));
    let mut boxes: Vec<Actor> = standing.chain(moving).collect();
    boxes.sort_by_key(|a| match a.who {
        Who::Ego => None,
        Who::Standing(id) | Who::Moving(id) => Some(id),
    });
    std::iter::once(ego).chain(boxes).collect()
}

fn actor(b: &SceneBox, who: Who) -> Actor {
    let ahead = if is_vehicle(b.class) {
        REAR_SHARE * b.size_m.x
    } else {
        0.0
    };
    Actor {
        name: format!("{}_{}", b.class.name(), b.id.0),
        who,
        class: b.class,
        called: b.called(),
        size_m: b.size_m,
        center_m: DVec3::new(ahead, 0.0, b.size_m.z / 2.0),
    }
}

/// True for classes that are vehicles in the standard, two-wheelers included.
fn is_vehicle(class: Class) -> bool {
    class.is_vehicle() || matches!(class, Class::Motorcycle | Class::Bicycle)
}

/// The element `<Entities>`.
pub(super) fn write(out: &mut String, actors: &[Actor]) {
    out.push_str("  <Entities>\n");
    for actor in actors {
        let _ = writeln!(out, "    <ScenarioObject name=\"{}\">", actor.name);
        let called = escaped(&actor.called);
        match actor.class {
            Class::Pedestrian => {
                let _ = writeln!(
                    out,
                    "      <Pedestrian name=\"{called}\" mass=\"75\" pedestrianCategory=\"pedestrian\">"
                );
                bounding_box(out, actor);
                out.push_str("      </Pedestrian>\n");
            }
            class if is_vehicle(class) => vehicle(out, actor, &called),
            class => {
                let category = if class == Class::Barrier {
                    "barrier"
                } else {
                    "obstacle"
                };
                let _ = writeln!(
                    out,
                    "      <MiscObject name=\"{called}\" mass=\"10\" miscObjectCategory=\"{category}\">"
                );
                bounding_box(out, actor);
                out.push_str("      </MiscObject>\n");
            }
        }
        out.push_str("    </ScenarioObject>\n");
    }
    out.push_str("  </Entities>\n");
}

fn bounding_box(out: &mut String, actor: &Actor) {
    let (center, size) = (actor.center_m, actor.size_m);
    let _ = writeln!(
        out,
        "        <BoundingBox>\n          <Center x=\"{}\" y=\"{}\" z=\"{}\"/>\n          \
         <Dimensions length=\"{}\" width=\"{}\" height=\"{}\"/>\n        </BoundingBox>",
        number(center.x),
        number(center.y),
        number(center.z),
        number(size.x),
        number(size.y),
        number(size.z),
    );
}

fn vehicle(out: &mut String, actor: &Actor, called: &str) {
    // Category, highest speed (m/s), acceleration and deceleration (m/s²), diameter of the wheels (m): usual values, which the
    // standard wants and a scene does not know.
    let (category, speed, faster, slower, wheel) = match actor.class {
        Class::Bus => ("bus", 28.0, 2.5, 8.0, 1.0),
        Class::Truck => ("truck", 28.0, 2.5, 8.0, 1.0),
        Class::ConstructionVehicle => ("truck", 14.0, 1.5, 5.0, 1.0),
        Class::Trailer => ("trailer", 28.0, 2.5, 8.0, 1.0),
        Class::Motorcycle => ("motorbike", 60.0, 8.0, 10.0, 0.6),
        Class::Bicycle => ("bicycle", 14.0, 3.0, 6.0, 0.7),
        _ => ("car", 60.0, 5.0, 10.0, 0.65),
    };
    let size = actor.size_m;
    let track = number(match category {
        "motorbike" | "bicycle" => 0.0,
        _ => 0.85 * size.y,
    });
    let [wheel_m, axle_z_m] = [wheel, wheel / 2.0].map(number);
    let _ = writeln!(
        out,
        "      <Vehicle name=\"{called}\" vehicleCategory=\"{category}\">"
    );
    bounding_box(out, actor);
    let _ = writeln!(
        out,
        "        <Performance maxSpeed=\"{}\" maxAcceleration=\"{}\" maxDeceleration=\"{}\"/>\n        <Axles>",
        number(speed),
        number(faster),
        number(slower)
    );
    for (name, steering, position_m) in [("FrontAxle", "0.6", BASE_SHARE * size.x), ("RearAxle", "0", 0.0)] {
        let _ = writeln!(
            out,
            "          <{name} maxSteering=\"{steering}\" wheelDiameter=\"{wheel_m}\" trackWidth=\"{track}\" \
             positionX=\"{}\" positionZ=\"{axle_z_m}\"/>",
            number(position_m)
        );
    }
    out.push_str("        </Axles>\n      </Vehicle>\n");
}
