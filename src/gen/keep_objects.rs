//! The user's word on objects and ground: a box that was placed does not vanish, one that was taken away does not
//! come back, painted ground stays, whatever the networks made of it. Counted, so that reports show when it was needed.

use crate::scene::raster::box_cells;
use crate::scene::{BoxId, Class, Frame, GridSpec, SceneBox, VoxelGrid, draft};

use super::region::Region;

/// A placed box counts as there if at least this share of its columns holds its class.
const THERE: f64 = 0.5;
/// Voxels this far outside a removed box still belong to it, m.
const OVERHANG_M: f64 = 0.3;

/// Corrects `generated` inside the region: drafts of placed boxes that are mostly missing are put in,
/// voxels of removed boxes are cleared. Returns how many boxes needed it. Of the boxes that are there,
/// `all` looks at every one, else only at those that differ from the source.
pub fn keep_objects(frame: &Frame, region: &Region, all: bool, generated: &mut VoxelGrid) -> usize {
    let old = &frame.source.boxes;
    let changed = |id: &BoxId, b: &SceneBox| old.get(id) != Some(b);
    let mut corrected = 0;
    for (id, b) in old {
        if frame.boxes.get(id) != Some(b) {
            corrected += usize::from(clear(frame, region, b, generated));
        }
    }
    for (id, b) in &frame.boxes {
        if all || changed(id, b) {
            corrected += usize::from(put_in(region, b, generated));
        }
    }
    corrected
}

/// Columns of the region whose ground the user has just painted: where the networks left the old ground, or none where
/// there was some, the layout's is laid. Returns how many columns needed it.
pub fn keep_ground(frame: &Frame, region: &Region, generated: &mut VoxelGrid) -> usize {
    let layouts = frame.layout.cells().iter().zip(frame.source.layout.cells());
    let mut corrected = 0;
    for (i, (now, before)) in layouts.enumerate() {
        let wanted = draft::ground_class(*now);
        if !region.columns[i] || wanted == draft::ground_class(*before) {
            continue;
        }
        let (x, y) = (i / GridSpec::NY, i % GridSpec::NY);
        let is_old = |l: &u8| *l != wanted.id() && Class::from_id(*l).is_some_and(Class::is_ground);
        let found = generated.column(x, y);
        let is_object = |l: &u8| Class::from_id(*l).is_some_and(|c| c.is_object());
        if found.iter().any(is_old) {
            let column = generated.column_mut(x, y);
            column
                .iter_mut()
                .filter(|l| is_old(l))
                .for_each(|l| *l = Class::FREE);
            if column[0] == Class::FREE {
                column[0] = wanted.id();
            }
            corrected += 1;
        } else if !found.contains(&wanted.id())
            && !found.iter().any(is_object)
            && held_ground(frame.source.occupancy.column(x, y))
        {
            // A hedge or a wall goes to its top, a hole is closed unless it was there before, as in frames of real labels;
            // a crown above a gap may hang over the road.
            let column = generated.column_mut(x, y);
            let rooted = column.iter_mut().take_while(|l| **l != Class::FREE);
            rooted.for_each(|l| *l = Class::FREE);
            column[0] = wanted.id();
            corrected += 1;
        }
    }
    corrected
}

/// True unless a column has a hole in its ground: a sidewalk lies a bin above the road.
fn held_ground(column: &[u8; GridSpec::NZ]) -> bool {
    column[0] != Class::FREE
        || column
            .iter()
            .any(|l| Class::from_id(*l).is_some_and(Class::is_ground))
}

fn put_in(region: &Region, b: &SceneBox, generated: &mut VoxelGrid) -> bool {
    let mut columns = draft::box_columns(b);
    columns.retain(|(x, y, _)| region.columns[x * GridSpec::NY + y]);
    let there = columns
        .iter()
        .filter(|(x, y, _)| generated.column(*x, *y).contains(&b.class.id()))
        .count();
    if there as f64 >= THERE * columns.len() as f64 {
        return false;
    }
    for (x, y, layers) in columns {
        generated.column_mut(x, y)[..layers].fill(b.class.id());
    }
    true
}

fn clear(frame: &Frame, region: &Region, removed: &SceneBox, generated: &mut VoxelGrid) -> bool {
    let mut owned = vec![false; GridSpec::COLUMNS]; // by boxes of the class that are there now
    for b in frame.boxes.values().filter(|b| b.class == removed.class) {
        box_cells(b, OVERHANG_M, |x, y| owned[x * GridSpec::NY + y] = true);
    }
    let mut cleared = false;
    box_cells(removed, OVERHANG_M, |x, y| {
        let i = x * GridSpec::NY + y;
        if owned[i] || !region.columns[i] || !generated.column(x, y).contains(&removed.class.id()) {
            return;
        }
        let column = generated.column_mut(x, y);
        column
            .iter_mut()
            .filter(|v| **v == removed.class.id())
            .for_each(|v| *v = Class::FREE);
        if column[0] == Class::FREE {
            column[0] = draft::ground_class(frame.layout.cell(x, y)).id();
        }
        cleared = true;
    });
    cleared
}

#[cfg(test)]
mod tests {
    use glam::{DVec2, DVec3};

    use super::*;
    use crate::scene::{BevLayer, BevLayout};

    fn car(id: u32, x: f64) -> SceneBox {
        SceneBox {
            id: BoxId(id),
            class: Class::Car,
            center_m: DVec3::new(x, 0.0, 0.85),
            size_m: DVec3::new(4.6, 1.95, 1.7),
            yaw_rad: 0.0,
            velocity_mps: DVec2::ZERO,
            label: Default::default(),
        }
    }

    #[test]
    fn painted_ground_stays() {
        let layout = BevLayout::default();
        let before = draft::draft(&layout, std::iter::empty());
        let mut frame = Frame::new(layout, std::collections::BTreeMap::new(), before.clone());
        for x in 50..60 {
            frame.layout.set(BevLayer::DrivableArea, x, 80, true);
            frame.layout.set(BevLayer::RoadBlock, x, 90, true); // changes no ground
        }
        // Networks that followed half of it, left a hedge, a crown above the road, and a car.
        let mut generated = before;
        let road = Class::DriveableSurface.id();
        (50..55).for_each(|x| generated.set(x, 80, 0, road));
        (0..3).for_each(|z| generated.set(57, 80, z, Class::Vegetation.id()));
        generated.set(57, 80, 9, Class::Vegetation.id());
        generated.set(58, 80, 0, Class::Car.id());
        generated.set(59, 80, 0, Class::FREE);
        let region = Region::of_edit(&frame, 2);
        assert_eq!(keep_ground(&frame, &region, &mut generated), 4);
        assert!((50..60).all(|x| x == 58 || generated.get(x, 80, 0) == road));
        assert_eq!(generated.get(57, 80, 1), Class::FREE);
        assert_eq!(generated.get(57, 80, 9), Class::Vegetation.id());
        assert_eq!(generated.get(58, 80, 0), Class::Car.id());
        assert_eq!(keep_ground(&frame, &region, &mut generated), 0);
        // A sidewalk in the second bin that the networks took away and put nothing in its place; where there was a hole
        // it stays one.
        let mut source = (*frame.source).clone();
        source.occupancy.set(50, 80, 0, Class::FREE);
        source.occupancy.set(50, 80, 1, Class::Sidewalk.id());
        source.occupancy.set(51, 80, 0, Class::FREE);
        frame.source = std::sync::Arc::new(source);
        generated.set(50, 80, 0, Class::FREE);
        generated.set(51, 80, 0, Class::FREE);
        assert_eq!(keep_ground(&frame, &region, &mut generated), 1);
        assert_eq!(
            (generated.get(50, 80, 0), generated.get(51, 80, 0)),
            (road, Class::FREE)
        );
        let mut outside = frame.source.occupancy.clone();
        assert_eq!(keep_ground(&frame, &Region::empty(), &mut outside), 0);
    }

    fn holds_car(grid: &VoxelGrid, x_m: f64) -> bool {
        let [x, y] = GridSpec::column_at(x_m, 0.1).expect("inside");
        grid.column(x, y).contains(&Class::Car.id())
    }

    #[test]
    fn placed_boxes_stay_and_removed_ones_stay_away() {
        let (stays, goes, comes) = (car(1, -15.0), car(2, 0.0), car(3, 15.0));
        let layout = BevLayout::default();
        let before = draft::draft(&layout, [stays, goes].iter());
        let boxes = [stays, goes].map(|b| (b.id, b)).into_iter().collect();
        let mut frame = Frame::new(layout, boxes, before.clone());
        frame.boxes.remove(&goes.id);
        frame.boxes.insert(comes.id, comes);
        // Networks that ignored both edits.
        let mut generated = before.clone();
        assert_eq!(
            keep_objects(&frame, &Region::of_edit(&frame, 2), false, &mut generated),
            2
        );
        assert!(holds_car(&generated, -15.0) && !holds_car(&generated, 0.0) && holds_car(&generated, 15.0));
        // Networks that followed them need no correction.
        let mut good = draft::draft(&frame.layout, frame.boxes.values());
        let same = good.clone();
        assert_eq!(
            keep_objects(&frame, &Region::of_edit(&frame, 2), false, &mut good),
            0
        );
        assert_eq!(good, same);
        // Outside the region nothing is corrected.
        let mut outside = before.clone();
        assert_eq!(keep_objects(&frame, &Region::empty(), false, &mut outside), 0);
        assert_eq!(outside, before);
    }
}
