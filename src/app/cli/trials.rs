//! Edits that `eval editing` tries, and what makes each a success.

use glam::DVec3;

use crate::editor::{Edit, Shape};
use crate::generation::world::draw::Draw;
use crate::scene::raster::{box_cells, disc_cells};
use crate::scene::{BevLayer, BoxId, BoxLabel, Class, Frame, GridSpec, PolylineKind, SceneBox, VoxelGrid};

/// Kinds of edits, by name.
pub const KINDS: [&str; 6] = ["remove", "add", "move", "class", "road", "crossing"];
/// Share of a removed object's voxels that must become ground or free.
const GONE: f64 = 0.95;
/// Share of the columns of a new footprint that must hold its class.
const FILLED: f64 = 0.60;
/// Share of painted columns that must show it.
const PAINTED: f64 = 0.90;

/// An edit, and how to tell whether it worked.
pub struct Trial {
    /// What is done.
    pub edit: Edit,
    gone: Option<SceneBox>,
    filled: Option<SceneBox>,
    /// Columns that must show driveable surface, unless the edit's own box stands there.
    road: Vec<[usize; 2]>,
}

/// Shares that a trial reached; `None` where it does not ask for one.
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
    /// An edit of a kind that suits the frame; `None` if there is nothing to do it to.
    pub fn propose(kind: &str, frame: &Frame, seed: u64) -> Option<Self> {
        let nothing = |edit| Self {
            edit,
            gone: None,
            filled: None,
            road: Vec::new(),
        };
        Some(match kind {
            "remove" => {
                let car = nearest_car(frame)?;
                Self {
                    gone: Some(car),
                    ..nothing(Edit::RemoveBox { id: car.id })
                }
            }
            "add" => {
                let truck = on_free_road(frame, Class::Truck, None, seed)?;
                Self {
                    filled: Some(truck),
                    ..nothing(Edit::AddBox {
                        class: truck.class,
                        center_m: truck.center_m,
                        size_m: truck.size_m,
                        yaw_deg: truck.yaw_rad.to_degrees(),
                        velocity_mps: None,
                        id: None,
                        label: BoxLabel::default(),
                    })
                }
            }
            "move" => {
                let car = nearest_car(frame)?;
                let there = on_free_road(frame, Class::Car, Some(car), seed)?;
                Self {
                    gone: Some(car),
                    filled: Some(there),
                    ..nothing(Edit::MoveBox {
                        id: car.id,
                        center_m: Some(there.center_m),
                        yaw_deg: Some(there.yaw_rad.to_degrees()),
                        size_m: None,
                    })
                }
            }
            "class" => {
                let car = nearest_car(frame)?;
                let class = Class::ConstructionVehicle;
                Self {
                    gone: Some(car),
                    filled: Some(SceneBox { class, ..car }),
                    ..nothing(Edit::SetBoxClass { id: car.id, class })
                }
            }
            "road" => {
                let cells = verge(frame, seed)?;
                Self {
                    road: cells.clone(),
                    ..nothing(paint(BevLayer::DrivableArea, cells))
                }
            }
            _ => {
                let cells = across_the_road(frame, seed)?;
                Self {
                    road: cells.clone(),
                    ..nothing(paint(BevLayer::PedCrossing, cells))
                }
            }
        })
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

/// Share of the voxels of the box's class over its footprint that became ground, free or what replaces
/// it; `None` if there were none.
fn removed_share(
    b: &SceneBox,
    replaced: Option<Class>,
    before: &VoxelGrid,
    after: &VoxelGrid,
) -> Option<f64> {
    let (mut all, mut gone) = (0, 0);
    box_cells(b, 0.2, |x, y| {
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
    box_cells(b, 0.0, |x, y| {
        all += 1;
        hit += u32::from(after.column(x, y).contains(&b.class.id()));
    });
    f64::from(hit) / f64::from(all.max(1))
}

/// A place on road that nothing stands on, along the nearest lane: for a new box of a class, or for
/// `moved`.
fn on_free_road(frame: &Frame, class: Class, moved: Option<SceneBox>, seed: u64) -> Option<SceneBox> {
    let mut draw = Draw::new(seed, "free road");
    let objects: u32 = Class::OBJECTS
        .iter()
        .filter_map(|c| BevLayer::of_object(*c))
        .map(BevLayer::bit)
        .sum();
    let cells = frame.bev_channels();
    let lanes: Vec<_> = frame
        .layout
        .polylines
        .iter()
        .filter(|l| l.kind == PolylineKind::LaneCenter)
        .collect();
    let size_m = match moved {
        Some(b) => b.size_m,
        None => DVec3::from_array(class.typical_size_m()?),
    };
    for _ in 0..400 {
        let lane = lanes.get(draw.below(lanes.len()))?;
        let k = draw.below(lane.points_m.len().saturating_sub(1));
        let (a, b) = (*lane.points_m.get(k)?, *lane.points_m.get(k + 1)?);
        let placed = SceneBox {
            id: moved.map_or(BoxId(0), |b| b.id),
            class,
            center_m: a.extend(size_m.z / 2.0),
            size_m,
            yaw_rad: (b - a).to_angle(),
            velocity_mps: glam::DVec2::ZERO,
            label: BoxLabel::default(),
        };
        let mut free = placed.footprint().iter().all(|c| c.abs().max_element() < 38.0) && a.length() > 6.0;
        box_cells(&placed, 0.8, |x, y| {
            free &= cells[x * GridSpec::NY + y] & objects == 0
        });
        box_cells(&placed, 0.0, |x, y| {
            free &= frame.layout.has(BevLayer::DrivableArea, x, y)
        });
        if free {
            return Some(placed);
        }
    }
    None
}

/// Columns beside a road that only ground covers, two metres around a random place.
fn verge(frame: &Frame, seed: u64) -> Option<Vec<[usize; 2]>> {
    let mut draw = Draw::new(seed, "verge");
    let is_road = |x: usize, y: usize| frame.layout.has(BevLayer::DrivableArea, x, y);
    let bare = |x: usize, y: usize| {
        let column = frame.occupancy.column(x, y);
        let ground = |l: &u8| *l == Class::FREE || Class::from_id(*l).is_some_and(Class::is_ground);
        !is_road(x, y) && column.iter().all(ground)
    };
    for _ in 0..400 {
        let (x, y) = (10 + draw.below(180), 10 + draw.below(180));
        let beside = bare(x, y)
            && [(x - 3, y), (x + 3, y), (x, y - 3), (x, y + 3)]
                .iter()
                .any(|(x, y)| is_road(*x, *y));
        let mut cells = Vec::new();
        disc_cells(GridSpec::center(x, y, 0).truncate(), 2.0, |x, y| {
            if bare(x, y) {
                cells.push([x, y]);
            }
        });
        if beside && cells.len() >= 40 {
            return Some(cells);
        }
    }
    None
}

/// Columns of a crossing, three metres wide, over the road at a random place of a lane.
fn across_the_road(frame: &Frame, seed: u64) -> Option<Vec<[usize; 2]>> {
    let mut draw = Draw::new(seed, "crossing");
    let cells = frame.bev_channels();
    let road_only =
        |x: usize, y: usize| cells[x * GridSpec::NY + y] & !line_bits() == BevLayer::DrivableArea.bit();
    let lanes: Vec<_> = frame
        .layout
        .polylines
        .iter()
        .filter(|l| l.kind == PolylineKind::LaneCenter && l.points_m.len() > 1)
        .collect();
    for _ in 0..100 {
        let lane = lanes.get(draw.below(lanes.len()))?;
        let k = draw.below(lane.points_m.len() - 1);
        let (a, b) = (lane.points_m[k], lane.points_m[k + 1]);
        if a.abs().max_element() > 34.0 {
            continue;
        }
        let across = (b - a).normalize_or_zero().perp();
        let mut found = Vec::new();
        for i in -20..=20 {
            disc_cells(a + across * (f64::from(i) * 0.4), 1.5, |x, y| {
                if road_only(x, y) {
                    found.push([x, y]);
                }
            });
        }
        found.sort_unstable();
        found.dedup();
        if found.len() >= 60 {
            return Some(found);
        }
    }
    None
}

/// Lines that may run over a road.
fn line_bits() -> u32 {
    BevLayer::RoadDivider.bit() | BevLayer::LaneDivider.bit() | BevLayer::StopLine.bit()
}
