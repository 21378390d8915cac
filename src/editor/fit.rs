//! Fits a box to the voxels of its class that it stands among: place, heading, length and width. Its height and its level stay.

use std::collections::BTreeSet;
use std::f64::consts::FRAC_PI_2;

use glam::{DVec2, Vec2Swizzles};

use scene::raster::box_cells;
use scene::{BoxId, Edit, Frame, SceneBox};

/// Voxels this far beyond the box still count as its own, m.
const AROUND_M: f64 = 1.2;
/// Headings are tried in steps of this, degrees.
const STEP_DEG: f64 = 1.0;
/// A heading other than the box's must make the rectangle smaller than this share of its area.
const SMALLER: f64 = 0.97;
/// Fewer columns say nothing of a shape.
const FEWEST: usize = 4;

/// The correction that fits a box to its voxels, which stay; `None` if it has too few of them, or fits already.
pub fn fit(frame: &Frame, id: BoxId) -> Option<Edit> {
    let b = frame.boxes.get(&id)?;
    let points_m = own_columns(frame, b);
    if points_m.len() < FEWEST {
        return None;
    }
    let cell_m = frame.extent().voxel_m();
    let own = FittedRectangle::around(&points_m, cell_m, b.yaw_rad);
    let steps = (90.0 / STEP_DEG) as usize;
    let turned =
        (0..steps).map(|k| FittedRectangle::around(&points_m, cell_m, (k as f64 * STEP_DEG).to_radians()));
    let best = turned.min_by(|a, b| a.area().total_cmp(&b.area()))?;
    let found = if best.area() < SMALLER * own.area() {
        best.like(own.yaw_rad)
    } else {
        own
    };
    let edit = Edit::MoveBox {
        id,
        center_m: Some(found.middle_m.extend(b.center_m.z)),
        yaw_deg: Some(found.yaw_rad.to_degrees()),
        size_m: Some(found.size_m.extend(b.size_m.z)),
    };
    let same = found.middle_m.distance(b.center_m.truncate()) < 1e-3
        && (found.size_m - b.size_m.truncate()).length() < 1e-3
        && (found.yaw_rad - b.yaw_rad).abs() < 1e-6;
    // The box is fitted to its voxels, so they stay.
    (!same).then(|| Edit::Correct { edit: edit.into() })
}

/// Middles of the columns with voxels of the box's class that touch those under it, m.
fn own_columns(frame: &Frame, b: &SceneBox) -> Vec<DVec2> {
    let extent = frame.extent();
    let class = b.class.id();
    let has = |[x, y]: [usize; 2]| frame.occupancy.column(x, y).contains(&class);
    let (mut open, mut near) = (Vec::new(), BTreeSet::new());
    box_cells(extent, b, AROUND_M, |x, y| {
        near.insert([x, y]);
    });
    // Voxels in another box belong to that box.
    for other in frame
        .boxes
        .values()
        .filter(|o| o.id != b.id && o.class == b.class)
    {
        box_cells(extent, other, 0.0, |x, y| {
            near.remove(&[x, y]);
        });
    }
    let mut found = BTreeSet::new();
    box_cells(extent, b, 0.0, |x, y| {
        if near.contains(&[x, y]) && has([x, y]) && found.insert([x, y]) {
            open.push([x, y]);
        }
    });
    while let Some([x, y]) = open.pop() {
        for i in x.saturating_sub(1)..=x + 1 {
            for j in y.saturating_sub(1)..=y + 1 {
                if near.contains(&[i, j]) && has([i, j]) && found.insert([i, j]) {
                    open.push([i, j]);
                }
            }
        }
    }
    found
        .iter()
        .map(|[x, y]| extent.center(*x, *y, 0).truncate())
        .collect()
}

/// A rectangle on the ground.
#[derive(Clone, Copy, Debug)]
struct FittedRectangle {
    middle_m: DVec2,
    size_m: DVec2,
    yaw_rad: f64,
}

impl FittedRectangle {
    /// The smallest rectangle of a heading around columns with these centres, with half of a column, `cell_m` wide, beyond
    /// them.
    fn around(points_m: &[DVec2], cell_m: f64, yaw_rad: f64) -> Self {
        let turn = DVec2::from_angle(-yaw_rad);
        let (low, high) = points_m
            .iter()
            .map(|p| turn.rotate(*p))
            .fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), p| {
                (low.min(p), high.max(p))
            });
        Self {
            middle_m: DVec2::from_angle(yaw_rad).rotate((low + high) / 2.0),
            size_m: high - low + DVec2::splat(cell_m),
            yaw_rad,
        }
    }

    fn area(&self) -> f64 {
        self.size_m.x * self.size_m.y
    }

    /// This rectangle under its heading nearest to `yaw_rad`: quarter turns swap length and width.
    fn like(self, yaw_rad: f64) -> Self {
        let quarters = ((yaw_rad - self.yaw_rad) / FRAC_PI_2).round();
        let size_m = if quarters.rem_euclid(2.0) == 1.0 {
            self.size_m.yx()
        } else {
            self.size_m
        };
        Self {
            yaw_rad: self.yaw_rad + quarters * FRAC_PI_2,
            size_m,
            ..self
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::Apply;
    use scene::{BevLayout, Class, Extent, Scene, VoxelGrid};

    /// A car's voxels, and a box that stands beside them, turned.
    fn scene(off_m: DVec2, off_deg: f64) -> (Scene, SceneBox) {
        let car = SceneBox {
            id: BoxId(3),
            class: Class::Car,
            center_m: DVec3::new(10.0, 4.0, 0.85),
            size_m: DVec3::new(4.6, 2.0, 1.7),
            yaw_rad: 0.5,
            velocity_mps: DVec2::ZERO,
            label: Default::default(),
        };
        let mut grid = VoxelGrid::new();
        box_cells(Extent::WINDOW, &car, 0.0, |x, y| {
            grid.set(x, y, 3, Class::Car.id())
        });
        let moved = SceneBox {
            center_m: car.center_m + off_m.extend(0.0),
            yaw_rad: car.yaw_rad + off_deg.to_radians(),
            ..car
        };
        let frame = Frame::new(BevLayout::default(), [(car.id, moved)].into(), grid);
        (Scene::single("test", frame, Default::default(), 0), car)
    }

    #[test]
    fn a_box_finds_its_voxels() {
        for (off_m, off_deg) in [
            (DVec2::new(0.8, -0.5), 12.0),
            (DVec2::ZERO, -20.0),
            (DVec2::new(-0.6, 0.4), 0.0),
        ] {
            let (mut scene, car) = scene(off_m, off_deg);
            let before = scene.frame().occupancy.clone();
            let edit = fit(scene.frame(), car.id).expect("it is off");
            edit.apply(&mut scene).expect("sound");
            let found = scene.frame().boxes[&car.id];
            assert!(found.center_m.distance(car.center_m) < 0.25, "{found:?}");
            assert!((found.size_m - car.size_m).abs().max_element() < 0.7, "{found:?}");
            let gap_deg = (found.yaw_rad - car.yaw_rad).to_degrees().abs();
            assert!(gap_deg < 8.0, "{gap_deg} from {off_deg}");
            assert_eq!(found.size_m.z, car.size_m.z);
            assert_eq!(scene.frame().occupancy, before, "a correction moves no voxel");
        }
    }

    #[test]
    fn where_no_voxels_are_nothing_is_fitted() {
        let (scene, car) = scene(DVec2::new(30.0, 0.0), 0.0);
        assert_eq!(fit(scene.frame(), car.id), None);
        assert_eq!(fit(scene.frame(), BoxId(99)), None);
    }
}
