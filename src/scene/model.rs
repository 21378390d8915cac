//! An object with its voxels, independent of any scene: it is taken out of one and put into another.

use glam::{DVec2, DVec3};

use crate::clip::ObjectVoxels;
use crate::{BoxId, BoxLabel, Class, Edit, Scene, SceneBox};

/// An object and its shape.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// One of the ten object classes.
    pub class: Class,
    /// Length, width, height, m.
    pub size_m: DVec3,
    /// Its underside above the ground, m.
    pub above_ground_m: f64,
    /// Its name and paint.
    pub label: BoxLabel,
    /// Its voxels, as [`Edit::SetShape`] takes them.
    pub cells: Vec<[i32; 3]>,
}

impl Model {
    /// A box of a scene at the moment that is shown; `None` asks for the only one there is. Errors in one line if there is no
    /// such box, if several are there, and if it has no voxels.
    pub fn of(scene: &Scene, id: Option<BoxId>) -> Result<Self, String> {
        let frame = scene.frame();
        let id = match (id, frame.boxes.len()) {
            (Some(id), _) => id,
            (None, 1) => *frame.boxes.keys().next().ok_or("no box")?,
            (None, 0) => {
                return Err("holds no object of the ten classes (a car, a person, …), expected one".into());
            }
            (None, n) => {
                return Err(format!(
                    "holds {n} boxes, expected one, or the number of one of them"
                ));
            }
        };
        let Some(b) = frame.boxes.get(&id) else {
            return Err(format!("box {} does not exist in this frame", id.0));
        };
        let cells = match scene.clip().tracks.get(&id) {
            Some(track) => track.voxels.cells(&track.made),
            None => {
                let others = || {
                    frame
                        .boxes
                        .values()
                        .filter(|other| other.id != id && other.class == b.class)
                };
                let voxels = ObjectVoxels::cut(&frame.occupancy, b, |[x, y, z], label| {
                    let p = frame.extent().center(x, y, z);
                    let is_of = |of: &SceneBox| of.contains(p.with_z(of.center_m.z), 0.0);
                    label == b.class.id() && (is_of(b) || !others().any(is_of))
                });
                voxels.cells(b)
            }
        };
        if cells.is_empty() {
            return Err(format!(
                "box {} has no voxels, expected an object with a shape",
                id.0
            ));
        }
        let ground_m = frame.layout.relief.height_m(b.center_m.truncate());
        Ok(Self {
            class: b.class,
            size_m: b.size_m,
            above_ground_m: b.center_m.z - b.size_m.z / 2.0 - ground_m,
            label: b.label,
            cells,
        })
    }

    /// Puts it into a scene as a box of that number, its middle at `at_m` (world frame, m).
    pub fn placed(&self, scene: &Scene, id: BoxId, at_m: DVec2, yaw_deg: f64) -> Vec<Edit> {
        let ground_m = scene.frame().layout.relief.height_m(at_m);
        let z_m = ground_m + self.above_ground_m + self.size_m.z / 2.0;
        vec![
            Edit::AddBox {
                class: self.class,
                center_m: at_m.extend(z_m),
                size_m: self.size_m,
                yaw_deg,
                velocity_mps: None,
                id: Some(id),
                label: self.label,
            },
            Edit::SetShape {
                id,
                cells: self.cells.clone(),
            },
        ]
    }

    /// Gives a box this shape and its size; class, place and heading of the box stay.
    pub fn given_to(&self, b: &SceneBox) -> Vec<Edit> {
        let bottom_m = b.center_m.z - b.size_m.z / 2.0;
        vec![
            Edit::MoveBox {
                id: b.id,
                center_m: Some(b.center_m.with_z(bottom_m + self.size_m.z / 2.0)),
                yaw_deg: None,
                size_m: Some(self.size_m),
            },
            Edit::SetShape {
                id: b.id,
                cells: self.cells.clone(),
            },
        ]
    }
}
