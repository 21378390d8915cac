//! Cross-sections of surfaces at 76 to 77 GHz, by class and, of vehicles, by the side that is seen.

use glam::{DVec2, DVec3};

use scene::{Class, Scene, SceneBox};

/// Distance by which a return may lie outside the box that it belongs to, m.
const AROUND_M: f64 = scene::Lattice::OCC3D.voxel_m();
/// Half the difference between a vehicle seen along or across its sides and one seen at a slant, dB.
const ASPECT_DB: f64 = 4.0;

/// What surfaces of a scene send back.
pub struct Echo<'a> {
    boxes: Vec<&'a SceneBox>,
    /// The box of the last return: rays come in order, and most neighbours meet the same.
    last: usize,
}

impl<'a> Echo<'a> {
    /// The surfaces of a scene.
    pub fn new(scene: &'a Scene) -> Self {
        Self {
            boxes: scene.frame().boxes.values().collect(),
            last: 0,
        }
    }

    /// Cross-section of a square metre of a class's surface as the radar sees it, m², where a ray of this direction ends.
    pub fn per_m2(&mut self, class: Class, at: DVec3, direction: DVec3) -> f64 {
        let mut db = db_per_m2(class);
        if is_vehicle(class)
            && let Some(b) = self.box_at(class, at.truncate())
        {
            let seen_from = direction.truncate().to_angle() - b.yaw_rad;
            db += ASPECT_DB * (4.0 * seen_from).cos();
        }
        10f64.powf(db / 10.0)
    }

    fn box_at(&mut self, class: Class, at: DVec2) -> Option<&'a SceneBox> {
        let holds = |b: &&SceneBox| {
            let local = DVec2::from_angle(-b.yaw_rad).rotate(at - b.center_m.truncate());
            let reach = b.size_m.truncate() / 2.0 + AROUND_M;
            b.class == class && local.abs().cmple(reach).all()
        };
        if !self.boxes.get(self.last).is_some_and(holds) {
            self.last = self.boxes.iter().position(holds)?;
        }
        self.boxes.get(self.last).copied()
    }
}

fn is_vehicle(class: Class) -> bool {
    matches!(
        class,
        Class::Car | Class::Truck | Class::Bus | Class::Trailer | Class::ConstructionVehicle
    )
}

/// Cross-section of a square metre seen by the radar, dB. With usual sizes: a car 10 dBsm, a truck, bus or trailer 20, a machine
/// 17, a motorcycle 3, a bicycle with its rider 0, a person -6, a cone -12: the middle of published measurements.
fn db_per_m2(class: Class) -> f64 {
    match class {
        Class::Car => 5.5,
        Class::Truck | Class::Bus | Class::Trailer => 11.0,
        Class::ConstructionVehicle => 8.0,
        Class::Motorcycle => 2.5,
        Class::Bicycle => 0.5,
        Class::Pedestrian => -4.5,
        Class::TrafficCone => -5.0,
        Class::Barrier => 2.0,
        Class::Manmade => -3.0,
        Class::Vegetation => -12.0,
        Class::Others | Class::Free => -3.0,
        // Smooth at this wavelength: little of a slanting beam comes back.
        Class::DriveableSurface | Class::Sidewalk => -40.0,
        Class::OtherFlat | Class::Terrain => -30.0,
    }
}
