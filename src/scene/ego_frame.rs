//! A scene in the frame of the ego vehicle: grids along its axes, for exports that need them and for words such as "20
//! m ahead", and edits made there converted back into the world frame. Sensors do not need it: they work in the world
//! frame.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{DVec2, DVec3};

use crate::{
    BevLayout, BoxId, Edit, Extent, Frame, Inferred, Lattice, Polyline, Pose, Relief, Scene, SceneBox, Shape,
    SourceFrame, Unobserved, VoxelGrid, VoxelPaint,
};

/// Reach of its grids around the vehicle, m.
const REACH_M: f64 = 100.0;

impl Scene {
    /// The scene at the moment that is shown, in the ego frame, standing still. The scene itself if the ego vehicle is
    /// at the origin of the world frame and nothing moves. Grids are resampled (nearest voxel). The revisions stay.
    pub fn in_ego(&self) -> Cow<'_, Scene> {
        let frame = self.frame();
        let pose = frame.world_from_ego;
        if pose == Pose::IDENTITY && self.rig.vehicle == pose {
            return match self.clip().is_still() {
                true => Cow::Borrowed(self),
                false => Cow::Owned(self.still()),
            };
        }
        let extent = match frame.extent() == Extent::WINDOW {
            true => Extent::WINDOW,
            false => {
                let reach = (REACH_M * frame.extent().lattice().per_m()).round() as i32;
                let around = frame.extent().with_columns([-reach; 2], [2 * reach as usize; 2]);
                around.unwrap_or(Extent::WINDOW)
            }
        };
        let mut scene = self.still();
        if scene.rig.vehicle != Pose::IDENTITY {
            scene.rig = Arc::new(scene.rig.standing_at(&Pose::IDENTITY));
        }
        scene.background = Arc::new(self.background.in_frame(&pose.inverse()));
        scene.roads = Arc::new(self.roads.in_frame(&pose.inverse()));
        scene.change_canvas(|canvas| *canvas = in_ego(frame, extent));
        (scene.rev, scene.content) = (self.rev, self.content);
        Cow::Owned(scene)
    }

    /// The moment that is shown as a scene of its own. The revisions stay.
    pub fn still(&self) -> Scene {
        let mut scene = self.clone();
        scene.clip = Arc::default();
        scene.canvas = self.view.clone();
        if let Some(moving) = self.clip.ego_moving(self.time_s()) {
            Arc::make_mut(&mut scene.rig).ego_speed_mps = moving.velocity_mps.length();
        }
        scene
    }

    /// The scene with its sensors at the place of the ego vehicle, in the world frame. The scene itself if the sensors are at that pose already (as with a vehicle at the origin) and the
    /// vehicle does not move.
    pub fn with_rig_in_world(&self) -> Cow<'_, Scene> {
        let pose = self.frame().world_from_ego;
        let moving = self.clip().ego_moving(self.time_s());
        let rolls = self.rig.ego_speed_mps != 0.0 && self.rig.cameras.iter().any(|c| c.shutter.is_some());
        if pose == self.rig.vehicle && moving.is_none() && !rolls {
            return Cow::Borrowed(self);
        }
        let mut scene = self.clone();
        let mut rig = self.rig.standing_at(&pose);
        if let Some(moving) = moving {
            rig.ego_speed_mps = moving.velocity_mps.length();
        }
        scene.rig = Arc::new(rig.carried(self.yaw_rate_rps()));
        Cow::Owned(scene)
    }
}

impl Scene {
    /// The input for cameras, LiDARs and their networks, which know the lattice of Occ3D: the scene in its voxels, with its
    /// sensors in the world. The scene itself if it is so already.
    pub fn for_sensors(&self) -> Cow<'_, Scene> {
        match self.in_lattice(Lattice::OCC3D) {
            Cow::Borrowed(scene) => scene.with_rig_in_world(),
            Cow::Owned(scene) => Cow::Owned(scene.with_rig_in_world().into_owned()),
        }
    }
}

impl Scene {
    /// Turn rate of the ego vehicle to the left at the moment that is shown, rad/s; 0 if it does not move.
    pub fn yaw_rate_rps(&self) -> f64 {
        const STEP_S: f64 = 0.05;
        let at = |time_s: f64| self.clip().ego_moving(time_s).map(|m| m.yaw_rad);
        let (now, length) = (self.time_s(), self.clip().length_s);
        let (from, to) = ((now - STEP_S).max(0.0), (now + STEP_S).min(length));
        let turned = at(to).zip(at(from)).map(|(b, a)| b - a);
        let turn =
            |d: f64| (d + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI;
        turned
            .filter(|_| to > from)
            .map_or(0.0, |d| turn(d) / (to - from))
    }
}

/// A frame along the axes of its ego vehicle.
fn in_ego(frame: &Frame, extent: Extent) -> Frame {
    let pose = frame.world_from_ego;
    let from_ego = ColumnLookup::new(extent, frame.extent(), &pose);
    let boxes = |boxes: &BTreeMap<BoxId, SceneBox>| -> BTreeMap<BoxId, SceneBox> {
        let to_ego = pose.inverse();
        boxes.iter().map(|(id, b)| (*id, b.in_frame(&to_ego))).collect()
    };
    let source = SourceFrame {
        layout: from_ego.layout(&frame.source.layout, &pose),
        boxes: boxes(&frame.source.boxes),
        occupancy: from_ego.grid(&frame.source.occupancy),
    };
    let mut painted = VoxelPaint::over(extent);
    if frame.painted.count_set() > 0 {
        painted = from_ego.grid(&frame.painted);
    }
    let unobserved = frame.inferred.unobserved.as_ref().and_then(|known| {
        let word = |[x, y]: [usize; 2]| from_ego.column(x, y).map_or(0, |at| known.words()[at]);
        Unobserved::from_words(extent, extent.all_columns().map(word).collect())
    });
    Frame {
        time_s: frame.time_s,
        world_from_ego: Pose::IDENTITY,
        boxes: boxes(&frame.boxes),
        layout: from_ego.layout(&frame.layout, &pose),
        occupancy: from_ego.grid(&frame.occupancy),
        painted,
        inferred: Inferred {
            unobserved,
            data_labels: None,
            ..frame.inferred.clone()
        },
        waivers: Arc::new(
            frame
                .waivers
                .iter()
                .map(|w| crate::Waiver {
                    where_m: pose.inverse().apply(w.where_m),
                    ..w.clone()
                })
                .collect(),
        ),
        source: Arc::new(source),
        absent: frame.absent.clone(),
        own_shapes: frame.own_shapes.clone(),
        covered_m: frame.covered_m.clone(),
    }
}

/// The column of another frame's map that each column of a map shows.
struct ColumnLookup {
    extent: Extent,
    /// `[x][y]`: place in the map, by column; none beyond it.
    columns: Vec<Option<u32>>,
    of: Extent,
}

impl ColumnLookup {
    fn new(extent: Extent, of: Extent, of_from_here: &Pose) -> Self {
        let column = |[x, y]: [usize; 2]| {
            let p = of_from_here.apply(extent.center(x, y, 0).with_z(0.0));
            let [x, y] = of.column_at(p.x, p.y)?;
            Some(of.index(x, y) as u32)
        };
        Self {
            extent,
            columns: extent.all_columns().map(column).collect(),
            of,
        }
    }

    fn column(&self, x: usize, y: usize) -> Option<usize> {
        self.columns[self.extent.index(x, y)].map(|at| at as usize)
    }

    fn grid<const FILL: u8>(&self, grid: &crate::grid::BrickGrid<FILL>) -> crate::grid::BrickGrid<FILL> {
        let mut out = crate::grid::BrickGrid::over(self.extent);
        for [x, y] in self.extent.all_columns() {
            if let Some(at) = self.column(x, y) {
                let [i, j] = self.of.column(at);
                let column = grid.column(i, j);
                if column.iter().any(|label| *label != FILL) {
                    out.column_mut(x, y).copy_from_slice(column);
                }
            }
        }
        out
    }

    fn layout(&self, layout: &BevLayout, world_from_ego: &Pose) -> BevLayout {
        let cell = |[x, y]: [usize; 2]| self.column(x, y).map_or(0, |at| layout.cells()[at]);
        let cells = self.extent.all_columns().map(cell).collect();
        let to_ego = world_from_ego.inverse();
        let lines = layout.polylines.iter().map(|line| Polyline {
            points_m: line.points_m.iter().map(|p| on_ground(&to_ego, *p)).collect(),
            ..line.clone()
        });
        let mut out = BevLayout::from_cells_over(self.extent, cells, lines.collect())
            .unwrap_or_else(|_| BevLayout::over(self.extent));
        if !layout.relief.is_flat() {
            // Heights count from the ground under the vehicle.
            let under_m = world_from_ego.translation_m.z;
            out.relief = Relief::from_fn(self.extent, |p| {
                layout.relief.height_m(on_ground(world_from_ego, p)) - under_m
            });
        }
        out
    }
}

fn on_ground(pose: &Pose, p: DVec2) -> DVec2 {
    pose.apply(p.extend(0.0)).truncate()
}

/// Heading of a pose on the ground, rad.
fn heading_rad(pose: &Pose) -> f64 {
    (pose.rotation * DVec3::X).truncate().to_angle()
}

impl SceneBox {
    /// The box in another frame.
    pub fn in_frame(&self, to_from_here: &Pose) -> SceneBox {
        let turn_rad = heading_rad(to_from_here);
        SceneBox {
            center_m: to_from_here.apply(self.center_m),
            yaw_rad: self.yaw_rad + turn_rad,
            velocity_mps: DVec2::from_angle(turn_rad).rotate(self.velocity_mps),
            ..*self
        }
    }
}

impl Edit {
    /// An edit of a scene's [`in_ego`](Scene::in_ego) as one of the scene itself, which has `map` as its extent.
    pub fn into_world(self, world_from_ego: &Pose, ego: Extent, map: Extent) -> Edit {
        if *world_from_ego == Pose::IDENTITY {
            return self;
        }
        let pose = world_from_ego;
        let turn_rad = heading_rad(pose);
        let turn_deg = turn_rad.to_degrees();
        let point = |p: DVec2| on_ground(pose, p);
        let way = |v: DVec2| DVec2::from_angle(turn_rad).rotate(v);
        let shape = |shape: Shape| shape.in_frame(pose, ego, map);
        match self {
            Self::AddBox {
                class,
                center_m,
                size_m,
                yaw_deg,
                velocity_mps,
                id,
                label,
            } => Self::AddBox {
                class,
                center_m: pose.apply(center_m),
                size_m,
                yaw_deg: yaw_deg + turn_deg,
                velocity_mps: velocity_mps.map(way),
                id,
                label,
            },
            Self::MoveBox {
                id,
                center_m,
                yaw_deg,
                size_m,
            } => Self::MoveBox {
                id,
                center_m: center_m.map(|c| pose.apply(c)),
                yaw_deg: yaw_deg.map(|yaw| yaw + turn_deg),
                size_m,
            },
            Self::PaintBev {
                layer,
                shape: area,
                value,
            } => Self::PaintBev {
                layer,
                shape: shape(area),
                value,
            },
            Self::ChangeRoads { change } => Self::ChangeRoads {
                change: change.in_frame(pose, turn_deg),
            },
            Self::AddThings { forms } => Self::AddThings {
                forms: forms.iter().map(|f| f.in_frame(pose)).collect(),
            },
            Self::DrawScenery { forms } => Self::DrawScenery {
                forms: forms.iter().map(|f| f.in_frame(pose)).collect(),
            },
            Self::ChangeThing { id, form } => Self::ChangeThing {
                id,
                form: form.in_frame(pose),
            },
            Self::MoveThings { ids, by_m, turn_deg } => Self::MoveThings {
                ids,
                by_m: way(by_m),
                turn_deg,
            },
            Self::ClearScenery { shape: area } => Self::ClearScenery {
                shape: area.map(shape),
            },
            Self::AddPolylines { lines } => Self::AddPolylines {
                lines: lines
                    .into_iter()
                    .map(|line| Polyline {
                        points_m: line.points_m.iter().map(|p| point(*p)).collect(),
                        ..line
                    })
                    .collect(),
            },
            Self::Correct { edit } => Self::Correct {
                edit: Box::new(edit.into_world(pose, ego, map)),
            },
            Self::At {
                frame,
                time_s,
                track,
                scope,
                edit,
            } => Self::At {
                frame,
                time_s,
                track,
                scope,
                edit: Box::new(edit.into_world(pose, ego, map)),
            },
            other => other,
        }
    }
}

impl Shape {
    /// The shape in another frame; cells become those of `to` under their centres.
    fn in_frame(self, to_from_here: &Pose, here: Extent, to: Extent) -> Shape {
        let point = |p: DVec2| on_ground(to_from_here, p);
        let points = |list: Vec<DVec2>| list.into_iter().map(point).collect();
        match self {
            Self::Disc { center_m, radius_m } => Self::Disc {
                center_m: point(center_m),
                radius_m,
            },
            Self::Rect { min_m, max_m } => Self::Polygon {
                points_m: points(vec![
                    min_m,
                    DVec2::new(max_m.x, min_m.y),
                    max_m,
                    DVec2::new(min_m.x, max_m.y),
                ]),
            },
            Self::Polygon { points_m } => Self::Polygon {
                points_m: points(points_m),
            },
            Self::Line { points_m, width_m } => Self::Line {
                points_m: points(points_m),
                width_m,
            },
            Self::Cells(cells) => {
                // Looked up in the other direction, so that no cell between is left out.
                let held: std::collections::BTreeSet<[usize; 2]> = cells.into_iter().collect();
                let back = to_from_here.inverse();
                let inside = |[x, y]: &[usize; 2]| {
                    let p = back.apply(to.center(*x, *y, 0).with_z(0.0));
                    here.column_at(p.x, p.y).is_some_and(|cell| held.contains(&cell))
                };
                Self::Cells(to.all_columns().filter(inside).collect())
            }
        }
    }
}

impl VoxelGrid {
    /// These voxels with the map's lower corner at column `from`.
    pub fn moved_to(&self, from: [i32; 2]) -> Result<VoxelGrid, String> {
        let size = [self.extent().nx(), self.extent().ny()];
        Ok(self.relabelled(self.extent().with_columns(from, size)?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BevLayer, Class, SensorRig};

    fn world() -> Scene {
        let extent = Extent::new([-60, -200], [400, 400]).expect("sound");
        let mut layout = BevLayout::over(extent);
        let mut occupancy = VoxelGrid::over(extent);
        for x in 0..400 {
            layout.set(BevLayer::DrivableArea, x, 210, true);
            occupancy.set(x, 210, 0, Class::DriveableSurface.id());
        }
        let car = SceneBox {
            id: BoxId(4),
            class: Class::Car,
            center_m: DVec3::new(50.0, 10.0, 0.8),
            size_m: DVec3::new(4.0, 2.0, 1.6),
            yaw_rad: 0.3,
            velocity_mps: DVec2::new(2.0, 0.0),
            label: Default::default(),
        };
        let mut frame = Frame::new(layout, [(car.id, car)].into(), occupancy);
        frame.world_from_ego = Pose::planar(40.0, 10.0, std::f64::consts::FRAC_PI_2);
        Scene::single("map", frame, Arc::new(SensorRig::default()), 1)
    }

    #[test]
    fn what_is_beside_the_vehicle_in_the_world_is_beside_it_in_its_frame() {
        let scene = world();
        let ego = scene.in_ego();
        let b = ego.frame().boxes[&BoxId(4)];
        // 10 m along the world's x is to the right of a vehicle that looks along y.
        assert!(
            (b.center_m - DVec3::new(0.0, -10.0, 0.8)).length() < 1e-9,
            "{b:?}"
        );
        assert!((b.velocity_mps - DVec2::new(0.0, -2.0)).length() < 1e-9);
        // The road, along the world's x at y = 4.2 m, crosses 5.8 m behind.
        let frame = ego.frame();
        let [x, y] = frame.extent().column_at(-5.8, 3.0).expect("inside");
        assert!(frame.layout.has(BevLayer::DrivableArea, x, y));
        assert_eq!(frame.occupancy.get(x, y, 0), Class::DriveableSurface.id());
        assert_eq!(frame.world_from_ego, Pose::IDENTITY);
        assert_eq!(ego.content(), scene.content());
    }

    #[test]
    fn edits_made_in_the_ego_frame_are_edits_of_the_world() {
        let scene = world();
        let ego = scene.in_ego().into_owned();
        let (pose, here, map) = (
            scene.frame().world_from_ego,
            ego.frame().extent(),
            scene.frame().extent(),
        );
        let b = ego.frame().boxes[&BoxId(4)];
        let Edit::AddBox {
            center_m, yaw_deg, ..
        } = Edit::from(b).into_world(&pose, here, map)
        else {
            panic!("of another kind");
        };
        let there = scene.frame().boxes[&BoxId(4)];
        assert!((center_m - there.center_m).length() < 1e-9);
        assert!((yaw_deg.to_radians() - there.yaw_rad).abs() < 1e-9);
        // The cells of a square stay the cells of that square.
        let square = Shape::Rect {
            min_m: DVec2::new(2.0, -4.0),
            max_m: DVec2::new(8.0, 4.0),
        };
        let cells = square.cells(here).expect("some");
        let moved = Shape::Cells(cells.clone()).in_frame(&pose, here, map);
        let outline = square.in_frame(&pose, here, map);
        assert_eq!(moved.cells(map), outline.cells(map));
        assert_eq!(moved.cells(map).expect("some").len(), cells.len());
    }

    #[test]
    fn a_rig_is_put_where_the_vehicle_is_once() {
        let scene = world();
        let once = scene.with_rig_in_world().into_owned();
        let twice = once.with_rig_in_world();
        assert_ne!(once.rig, scene.rig);
        assert_eq!(twice.rig, once.rig);
        assert_eq!(once.rig.vehicle, scene.frame().world_from_ego);
        // From there to another moment's place, and home again.
        let there = Pose::planar(-3.0, 8.0, 0.4);
        let [direct, over] = [&scene.rig, &once.rig].map(|rig| rig.standing_at(&there));
        let home = over.standing_at(&Pose::IDENTITY);
        for (a, b) in [(&direct, &over), (&*scene.rig, &home)] {
            for (a, b) in a.cameras.iter().zip(&b.cameras) {
                let [a, b] = [a, b].map(crate::Camera::ego_from_camera);
                assert!(a.translation_m.distance(b.translation_m) < 1e-9);
                assert!(a.rotation.angle_between(b.rotation) < 1e-6);
            }
        }
        // In the ego frame the sensors are on the vehicle again.
        assert_eq!(once.in_ego().rig.vehicle, Pose::IDENTITY);
        let [a, b] = [&once, &scene].map(|s| s.in_ego().rig.lidars[0].ego_from_sensor());
        assert!(a.translation_m.distance(b.translation_m) < 1e-9);
    }
}
