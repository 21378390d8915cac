//! Scenes moved to another origin. Nothing is resampled, because they move by whole columns. The networks read a window
//! around the origin; with such a move any part of a map can be brought into it.

use std::sync::Arc;

use glam::{DQuat, DVec2, DVec3};

use crate::{
    BevLayout, Extent, Frame, Inferred, Lattice, Polyline, Pose, Scene, SceneBox, SourceFrame, Unobserved,
    VoxelGrid, VoxelPaint, Waiver,
};

/// A move by whole columns of the networks' lattice.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct ColumnShift(pub [i32; 2]);

impl ColumnShift {
    /// The move in the opposite direction.
    pub fn back(self) -> Self {
        Self(self.0.map(|c| -c))
    }

    /// The move in metres.
    pub fn way_m(self) -> DVec2 {
        let per_m = Lattice::OCC3D.per_m();
        DVec2::new(f64::from(self.0[0]) / per_m, f64::from(self.0[1]) / per_m)
    }

    /// An extent, moved. Panics beyond the farthest column.
    pub fn extent(self, extent: Extent) -> Extent {
        let [x, y] = extent.from();
        let from = [x.saturating_add(self.0[0]), y.saturating_add(self.0[1])];
        match extent.with_columns(from, [extent.nx(), extent.ny()]) {
            Ok(moved) => moved,
            Err(problem) => panic!("{problem}"),
        }
    }

    /// A grid, moved.
    pub fn grid(self, grid: &VoxelGrid) -> VoxelGrid {
        grid.relabelled(self.extent(grid.extent()))
    }

    fn paint(self, paint: &VoxelPaint) -> VoxelPaint {
        paint.relabelled(self.extent(paint.extent()))
    }

    /// A layout, moved.
    pub fn layout(self, layout: &BevLayout) -> BevLayout {
        if self == Self::default() {
            return layout.clone();
        }
        let way_m = self.way_m();
        let lines = layout.polylines.iter().map(|line| Polyline {
            points_m: line.points_m.iter().map(|p| *p + way_m).collect(),
            ..line.clone()
        });
        let mut out = layout.relabelled(self.extent(layout.extent()));
        out.polylines = Arc::new(lines.collect());
        out
    }

    /// A box, moved.
    pub fn scene_box(self, b: &SceneBox) -> SceneBox {
        SceneBox {
            center_m: b.center_m + self.way_m().extend(0.0),
            ..*b
        }
    }

    fn frame(self, frame: &Frame) -> Frame {
        let way_m: DVec3 = self.way_m().extend(0.0);
        let boxes = |list: &std::collections::BTreeMap<_, SceneBox>| {
            list.iter().map(|(id, b)| (*id, self.scene_box(b))).collect()
        };
        let layout = self.layout(&frame.layout);
        let source = SourceFrame {
            layout: match frame.source.layout == frame.layout {
                true => layout.clone(),
                false => self.layout(&frame.source.layout),
            },
            boxes: boxes(&frame.source.boxes),
            occupancy: self.grid(&frame.source.occupancy),
        };
        let unobserved = frame.inferred.unobserved.as_ref();
        let data_labels = frame.inferred.data_labels.as_ref();
        Frame {
            time_s: frame.time_s,
            world_from_ego: Pose {
                translation_m: frame.world_from_ego.translation_m + way_m,
                rotation: frame.world_from_ego.rotation,
            },
            boxes: boxes(&frame.boxes),
            layout,
            occupancy: self.grid(&frame.occupancy),
            painted: self.paint(&frame.painted),
            inferred: Inferred {
                unobserved: unobserved
                    .and_then(|u| Unobserved::from_words(self.extent(u.extent()), u.words().to_vec())),
                data_labels: data_labels.and_then(|labels| labels.on(self.extent(labels.extent()))),
                ..frame.inferred.clone()
            },
            waivers: Arc::new(
                frame
                    .waivers
                    .iter()
                    .map(|w| Waiver {
                        where_m: w.where_m + way_m,
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
}

impl Scene {
    /// A scene that stands still, with everything in it moved by whole columns. The revisions stay.
    pub fn moved(&self, by: ColumnShift) -> Scene {
        if by == ColumnShift::default() {
            return self.clone();
        }
        let mut scene = self.still();
        let pose = Pose {
            rotation: DQuat::IDENTITY,
            translation_m: by.way_m().extend(0.0),
        };
        scene.background = Arc::new(self.background.in_frame(&pose));
        scene.roads = Arc::new(self.roads.in_frame(&pose));
        let frame = Arc::new(by.frame(self.frame()));
        (scene.canvas, scene.view) = (frame.clone(), frame);
        scene
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BevLayer, BoxId, Class, Relief, SensorRig};

    #[test]
    fn what_is_moved_there_and_back_is_the_same() {
        let extent = Extent::new([-120, 40], [300, 128]).expect("sound");
        let mut layout = BevLayout::over(extent);
        layout.set(BevLayer::DrivableArea, 7, 9, true);
        layout.relief = Relief::from_fn(extent, |p| 0.01 * p.x);
        let mut grid = VoxelGrid::over(extent);
        grid.set(200, 100, 3, Class::Car.id());
        let b = SceneBox {
            id: BoxId(1),
            class: Class::Car,
            center_m: DVec3::new(10.0, 30.0, 1.0),
            size_m: DVec3::ONE,
            yaw_rad: 0.2,
            velocity_mps: DVec2::ZERO,
            label: Default::default(),
        };
        let frame = Frame::new(layout, [(b.id, b)].into(), grid);
        let scene = Scene::single("map", frame, Arc::new(SensorRig::default()), 1);
        let by = ColumnShift([-160, 48]);
        let there = scene.moved(by);
        assert_eq!(there.frame().extent().from(), [-280, 88]);
        assert_eq!(there.frame().occupancy.get(200, 100, 3), Class::Car.id());
        assert!((there.frame().boxes[&b.id].center_m.x - (10.0 - 64.0)).abs() < 1e-12);
        assert!((there.frame().layout.relief.height_m(DVec2::new(-54.0, 60.0)) - 0.1).abs() < 1e-6);
        assert_eq!(there.content(), scene.content());
        let back = there.moved(by.back());
        assert_eq!(
            back.frame().occupancy.changed_bricks(&scene.frame().occupancy),
            [0; 0]
        );
        assert_eq!(back.frame().layout.cells(), scene.frame().layout.cells());
    }
}
