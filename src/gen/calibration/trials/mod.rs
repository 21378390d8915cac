//! Edits that `eval editing` tries, and the conditions of their success.

mod places;

use editor::{Edit, Shape};
use job::request::voxels_of;
use places::{across_the_road, on_free_road, verge};
use scene::raster::box_cells;
use scene::{BevLayer, BoxLabel, Class, Extent, Frame, SceneBox, VoxelGrid};

/// Kinds of edits, by name.
pub const KINDS: [&str; 6] = ["remove", "add", "move", "class", "road", "crossing"];
/// Share of a removed object's voxels that must become ground or free.
const GONE: f64 = 0.95;
/// Share of the columns of a new footprint that must hold its class.
const FILLED: f64 = 0.60;
/// Share of painted columns that must show the paint.
const PAINTED: f64 = 0.90;
/// Fewest voxels of a vehicle that counts as visible.
const LEAST_VOXELS: usize = 10;

/// An edit, and how to tell whether it worked.
pub struct Trial {
    /// The edit.
    pub edit: Edit,
    gone: Option<SceneBox>,
    filled: Option<SceneBox>,
    /// Columns that must show driveable surface, unless the edit's own box stands there.
    road: Vec<[usize; 2]>,
}

/// Shares that a trial reached; `None` for those that do not apply.
#[derive(Clone, Copy, Debug, Default)]
pub struct Reached {
    /// Voxels of the removed object that became ground or free.
    pub gone: Option<f64>,
    /// Columns of the new footprint that hold its class.
    pub filled: Option<f64>,
    /// Painted columns that are road.
    pub road: Option<f64>,
}

impl Reached {
    /// True if every share is high enough.
    pub fn success(&self) -> bool {
        let enough = |share: Option<f64>, least: f64| share.is_none_or(|s| s >= least);
        enough(self.gone, GONE) && enough(self.filled, FILLED) && enough(self.road, PAINTED)
    }
}

impl Trial {
    /// An edit of a kind that suits the frame; an edit of a vehicle takes the nearest car. `None` if the frame holds no
    /// fitting object or place.
    pub fn propose(kind: &str, frame: &Frame, seed: u64) -> Option<Self> {
        Some(match kind {
            "remove" | "move" | "class" => Self::of_vehicle(kind, frame, nearest_car(frame)?, seed)?,
            "add" => Self::adding(frame, Class::Truck, seed)?,
            "road" => Self::painting(BevLayer::DrivableArea, verge(frame, seed)?),
            _ => Self::painting(BevLayer::PedCrossing, across_the_road(frame, seed)?),
        })
    }

    /// An edit of a vehicle: `remove`, `move` (to a free place on the road), else a change of class. `None` if there is
    /// no place to move it to.
    pub fn of_vehicle(kind: &str, frame: &Frame, vehicle: SceneBox, seed: u64) -> Option<Self> {
        let (id, gone) = (vehicle.id, Some(vehicle));
        Some(match kind {
            "remove" => Self {
                gone,
                ..Self::only(Edit::RemoveBox { id })
            },
            "move" => {
                let there = on_free_road(frame, vehicle.class, Some(vehicle), seed)?;
                Self {
                    gone,
                    filled: Some(there),
                    ..Self::only(Edit::MoveBox {
                        id,
                        center_m: Some(there.center_m),
                        yaw_deg: Some(there.yaw_rad.to_degrees()),
                        size_m: None,
                    })
                }
            }
            _ => {
                let class = match vehicle.class {
                    Class::ConstructionVehicle => Class::Car,
                    _ => Class::ConstructionVehicle,
                };
                Self {
                    gone,
                    filled: Some(SceneBox { class, ..vehicle }),
                    ..Self::only(Edit::SetBoxClass { id, class })
                }
            }
        })
    }

    /// A new object of a class on a free place of the road; `None` if there is none.
    pub fn adding(frame: &Frame, class: Class, seed: u64) -> Option<Self> {
        let new = on_free_road(frame, class, None, seed)?;
        Some(Self {
            filled: Some(new),
            ..Self::only(Edit::AddBox {
                class: new.class,
                center_m: new.center_m,
                size_m: new.size_m,
                yaw_deg: new.yaw_rad.to_degrees(),
                velocity_mps: None,
                id: None,
                label: BoxLabel::default(),
            })
        })
    }

    fn painting(layer: BevLayer, cells: Vec<[usize; 2]>) -> Self {
        Self {
            road: cells.clone(),
            ..Self::only(paint(layer, cells))
        }
    }

    fn only(edit: Edit) -> Self {
        Self {
            edit,
            gone: None,
            filled: None,
            road: Vec::new(),
        }
    }

    /// The box before the edit, if it goes, moves or changes its class.
    pub fn gone(&self) -> Option<&SceneBox> {
        self.gone.as_ref()
    }

    /// The box after the edit, if it comes, moves or changes its class.
    pub fn filled(&self) -> Option<&SceneBox> {
        self.filled.as_ref()
    }

    /// Compares occupancy before and after.
    pub fn judge(&self, before: &VoxelGrid, after: &VoxelGrid) -> Reached {
        let replaced = self.filled.map(|b| b.class);
        Reached {
            gone: self.gone.and_then(|b| removed_share(&b, replaced, before, after)),
            filled: self.filled.map(|b| filled_share(&b, after)),
            road: (!self.road.is_empty()).then(|| {
                let is_road =
                    |[x, y]: &&[usize; 2]| after.column(*x, *y).contains(&Class::DriveableSurface.id());
                self.road.iter().filter(is_road).count() as f64 / self.road.len() as f64
            }),
        }
    }
}

fn paint(layer: BevLayer, cells: Vec<[usize; 2]>) -> Edit {
    Edit::PaintBev {
        layer,
        shape: Shape::Cells(cells),
        value: true,
    }
}

fn nearest_car(frame: &Frame) -> Option<SceneBox> {
    let cars = frame.boxes.values().filter(|b| b.class == Class::Car);
    cars.min_by(|a, b| a.center_m.length().total_cmp(&b.center_m.length()))
        .copied()
}

/// Vehicles that the occupancy shows, from the nearest to the farthest. If there are more than `most`, as many are
/// taken evenly over that order.
pub fn vehicles(frame: &Frame, most: usize) -> Vec<SceneBox> {
    let shown = |b: &&SceneBox| b.class.is_vehicle() && voxels_of(&frame.occupancy, b) >= LEAST_VOXELS;
    let mut found: Vec<SceneBox> = frame.boxes.values().filter(shown).copied().collect();
    found.sort_by(|a, b| a.center_m.length().total_cmp(&b.center_m.length()));
    let most = most.min(found.len());
    (0..most).map(|i| found[i * found.len() / most]).collect()
}

/// Share of the voxels of the box's class over its footprint that became ground, free or the class that replaces it;
/// `None` if there were none.
fn removed_share(
    b: &SceneBox,
    replaced: Option<Class>,
    before: &VoxelGrid,
    after: &VoxelGrid,
) -> Option<f64> {
    let (mut all, mut gone) = (0, 0);
    box_cells(Extent::WINDOW, b, 0.2, |x, y| {
        for (old, new) in before.column(x, y).iter().zip(after.column(x, y)) {
            if *old == b.class.id() {
                all += 1;
                let new_class = Class::from_id(*new);
                let other = replaced.is_some_and(|c| c != b.class && new_class == Some(c));
                let ground = new_class.is_some_and(Class::is_ground);
                gone += usize::from(ground || other || *new == Class::FREE);
            }
        }
    });
    (all > 0).then(|| gone as f64 / all as f64)
}

/// Share of the box's footprint columns that hold its class.
fn filled_share(b: &SceneBox, after: &VoxelGrid) -> f64 {
    let (mut all, mut hit) = (0u32, 0u32);
    box_cells(Extent::WINDOW, b, 0.0, |x, y| {
        all += 1;
        hit += u32::from(after.column(x, y).contains(&b.class.id()));
    });
    f64::from(hit) / f64::from(all.max(1))
}
