//! Makes the result follow the user's boxes and ground where the networks did not: a placed box does not vanish, a
//! removed one does not come back, painted ground stays. The corrections are counted for the report.

use glam::DVec3;

use crate::region::Region;
use crate::seen_draft::seen_voxels;
use scene::draft::{ground_bin, ground_class};
use scene::raster::box_cells;
use scene::{BoxId, Class, Extent, Frame, SceneBox, VoxelGrid, Window, draft};

/// Least share of a placed box's columns that must hold its class for the box to count as present, as a part of the
/// usual share of the frame's boxes. (Labels have holes, so their usual share is below that of complete worlds.)
const THERE: f64 = 0.5;
/// Share of non-empty columns below which a frame counts as labels, whose objects are hollow.
const SOLID: f64 = 0.8;
/// Share of a source box's columns with its class below which the box counts as never seen.
const SEEN: f64 = 0.05;
/// Largest change of size at which a moved box keeps its voxels, m.
const SAME_SIZE_M: f64 = 0.05;
/// Distance outside a removed box up to which voxels still belong to it, m.
const OVERHANG_M: f64 = 0.3;

/// Corrects `generated` inside the region: puts in placed boxes that are mostly missing (hollow, if the frame's objects
/// are), and clears the voxels of removed boxes. With `all` it examines every box, otherwise only those that differ
/// from the source. Returns the number of corrected boxes.
pub fn keep_objects(frame: &Frame, region: &Region, all: bool, generated: &mut VoxelGrid) -> usize {
    let old = &frame.source.boxes;
    let changed = |id: &BoxId, b: &SceneBox| old.get(id) != Some(b);
    let shown = if all { &*generated } else { &frame.source.occupancy };
    let (mut corrected, usual) = (0, Usual::of(frame, shown));
    for (id, b) in old {
        if frame.boxes.get(id) != Some(b) {
            corrected += usize::from(clear(frame, region, b, generated));
        }
    }
    for (id, b) in &frame.boxes {
        if all || changed(id, b) {
            corrected += usize::from(put_in(frame, region, b, &usual, generated));
        }
    }
    corrected
}

/// Usual fill and kind of the boxes of a frame.
struct Usual {
    /// Usual share of a source box's columns that its class fills: the median over boxes that were seen. Without such
    /// boxes, the share of all columns that hold something; 1 in an empty frame.
    fill: f64,
    /// True if objects are hollow, as in labels, in which many columns are empty.
    hollow: bool,
}

impl Usual {
    /// Measures the boxes of a frame's source; `shown` is the grid that a new box joins.
    fn of(frame: &Frame, shown: &VoxelGrid) -> Self {
        let source = &frame.source;
        let seen = source.boxes.values().map(|b| filled(&source.occupancy, b));
        let mut seen: Vec<f64> = seen.filter(|fill| *fill >= SEEN).collect();
        seen.sort_by(f64::total_cmp);
        let middle = seen.get(seen.len() / 2).copied();
        let fill = || Some(held_share(&source.occupancy)).filter(|share| *share > 0.0);
        let held = held_share(shown);
        Self {
            fill: middle.or_else(fill).unwrap_or(1.0),
            hollow: held > 0.0 && held < SOLID,
        }
    }
}

/// Share of the columns that hold something, 0 to 1.
fn held_share(grid: &VoxelGrid) -> f64 {
    let columns = (0..Window::COLUMNS).map(|c| grid.column(c / Window::NY, c % Window::NY));
    let held = columns.filter(|c| c.iter().any(|l| *l != Class::FREE)).count();
    held as f64 / Window::COLUMNS as f64
}

/// Share of a box's columns that hold its class, 0 to 1.
fn filled(grid: &VoxelGrid, b: &SceneBox) -> f64 {
    let columns = draft::box_columns(Extent::WINDOW, b);
    let there = columns
        .iter()
        .filter(|(x, y, _)| grid.column(*x, *y).contains(&b.class.id()));
    there.count() as f64 / columns.len().max(1) as f64
}

/// Corrects columns of the region whose ground the user has just painted: if the networks left the old ground, or
/// removed the ground, the layout's ground is put in. Returns the number of corrected columns.
pub fn keep_ground(frame: &Frame, region: &Region, generated: &mut VoxelGrid) -> usize {
    let layouts = frame.layout.cells().iter().zip(frame.source.layout.cells());
    let mut corrected = 0;
    for (i, (now, before)) in layouts.enumerate() {
        let wanted = ground_class(*now);
        if !region.columns[i] || wanted == ground_class(*before) {
            continue;
        }
        let (x, y) = (i / Window::NY, i % Window::NY);
        let bin = ground_bin(&frame.layout, x, y);
        let is_old = |l: &u8| *l != wanted.id() && Class::from_id(*l).is_some_and(Class::is_ground);
        let found = generated.column(x, y);
        let is_object = |l: &u8| Class::from_id(*l).is_some_and(|c| c.is_object());
        if found.iter().any(is_old) {
            let column = generated.column_mut(x, y);
            column
                .iter_mut()
                .filter(|l| is_old(l))
                .for_each(|l| *l = Class::FREE);
            if column[bin] == Class::FREE {
                column[bin] = wanted.id();
            }
            corrected += 1;
        } else if !found.contains(&wanted.id())
            && !found.iter().any(is_object)
            && held_ground(frame.source.occupancy.window_column(x, y), bin)
        {
            // A hedge or a wall is removed up to its top. A hole is closed unless it was there before, as in frames of
            // real labels. A crown above a gap may hang over the road.
            let column = generated.column_mut(x, y);
            let rooted = column[bin..].iter_mut().take_while(|l| **l != Class::FREE);
            rooted.for_each(|l| *l = Class::FREE);
            column[bin] = wanted.id();
            corrected += 1;
        }
    }
    corrected
}

/// True unless a column has a hole in its ground. A sidewalk lies a bin above the road.
fn held_ground(column: &[u8; Window::NZ], bin: usize) -> bool {
    column[bin] != Class::FREE
        || column
            .iter()
            .any(|l| Class::from_id(*l).is_some_and(Class::is_ground))
}

/// Puts a box in if its columns hold much less of it than the `usual` share: with its old voxels if it moved, else as its
/// draft (in hollow frames only the part of the draft that a sensor can see).
fn put_in(frame: &Frame, region: &Region, b: &SceneBox, usual: &Usual, generated: &mut VoxelGrid) -> bool {
    let mut columns = draft::box_columns(Extent::WINDOW, b);
    columns.retain(|(x, y, _)| region.columns[x * Window::NY + y]);
    let there = columns
        .iter()
        .filter(|(x, y, _)| generated.column(*x, *y).contains(&b.class.id()))
        .count();
    if there as f64 >= THERE * usual.fill * columns.len() as f64 {
        return false;
    }
    let moved = frame.source.boxes.get(&b.id).filter(|old| {
        let kept = old.class == b.class && old.size_m.abs_diff_eq(b.size_m, SAME_SIZE_M);
        kept && filled(&frame.source.occupancy, old) >= SEEN
    });
    if let Some(old) = moved {
        carry(frame, region, old, b, generated);
        return true;
    }
    if usual.hollow {
        let mut seen = seen_voxels(&frame.layout, b);
        seen.retain(|[x, y, _]| region.columns[x * Window::NY + y]);
        let drop = |label: &mut u8| {
            if *label == b.class.id() {
                *label = Class::FREE;
            }
        };
        columns
            .iter()
            .for_each(|(x, y, _)| generated.column_mut(*x, *y).iter_mut().for_each(drop));
        seen.iter()
            .for_each(|[x, y, z]| generated.set(*x, *y, *z, b.class.id()));
        return true;
    }
    for (x, y, layers) in columns {
        let ground = ground_bin(&frame.layout, x, y).min(layers - 1);
        generated.column_mut(x, y)[ground..layers].fill(b.class.id());
    }
    true
}

/// Moves the voxels of a source box to the box's present place: each voxel of the new box takes the label at the same
/// place of the old one. The networks' voxels of it are removed.
fn carry(frame: &Frame, region: &Region, old: &SceneBox, new: &SceneBox, generated: &mut VoxelGrid) {
    let (source, class) = (&frame.source.occupancy, new.class.id());
    // Labels reach down to the ground below the box.
    let rise_m = new.center_m.z - old.center_m.z;
    box_cells(Extent::WINDOW, new, 0.0, |x, y| {
        if !region.columns[x * Window::NY + y] {
            return;
        }
        let center = Window::center(x, y, 0);
        let there = old.to_ego(new.to_local(center.truncate().extend(new.center_m.z)));
        let from = Window::column_at(there.x, there.y).map(|[x, y]| *source.window_column(x, y));
        let column = generated.column_mut(x, y);
        column
            .iter_mut()
            .filter(|l| **l == class)
            .for_each(|l| *l = Class::FREE);
        for (z, cell) in column.iter_mut().enumerate() {
            let level = Window::to_voxel_units(Window::center(x, y, z) - DVec3::Z * rise_m).z;
            let is_own =
                |column: &[u8; Window::NZ]| level >= 0.0 && column.get(level as usize) == Some(&class);
            if from.as_ref().is_some_and(is_own) {
                *cell = class;
            }
        }
        let bin = ground_bin(&frame.layout, x, y);
        if column[bin] == Class::FREE {
            column[bin] = ground_class(frame.layout.cell(x, y)).id();
        }
    });
}

fn clear(frame: &Frame, region: &Region, removed: &SceneBox, generated: &mut VoxelGrid) -> bool {
    let mut owned = vec![false; Window::COLUMNS]; // by boxes of the class that are there now
    for b in frame.boxes.values().filter(|b| b.class == removed.class) {
        box_cells(Extent::WINDOW, b, OVERHANG_M, |x, y| {
            owned[x * Window::NY + y] = true
        });
    }
    let mut cleared = false;
    box_cells(Extent::WINDOW, removed, OVERHANG_M, |x, y| {
        let i = x * Window::NY + y;
        if owned[i] || !region.columns[i] || !generated.column(x, y).contains(&removed.class.id()) {
            return;
        }
        let column = generated.column_mut(x, y);
        column
            .iter_mut()
            .filter(|v| **v == removed.class.id())
            .for_each(|v| *v = Class::FREE);
        let bin = ground_bin(&frame.layout, x, y);
        if column[bin] == Class::FREE {
            column[bin] = ground_class(frame.layout.cell(x, y)).id();
        }
        cleared = true;
    });
    cleared
}

#[cfg(test)]
mod tests {
    use glam::{DVec2, DVec3};

    use super::*;
    use scene::{BevLayer, BevLayout};

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
        let [x, y] = Window::column_at(x_m, 0.1).expect("inside");
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

    #[test]
    fn a_moved_box_of_sparse_labels_keeps_its_own_voxels() {
        let (before, mut after) = (car(1, -15.0), car(1, -15.0));
        let layout = BevLayout::default();
        let mut labels = draft::draft(&layout, [].into_iter());
        // One side of the car was seen.
        for (x, y, layers) in draft::box_columns(Extent::WINDOW, &before) {
            if Window::center(x, y, 0).y > 0.0 {
                (0..layers).for_each(|z| labels.set(x, y, z, Class::Car.id()));
            }
        }
        let count = |g: &VoxelGrid| g.class_counts()[Class::Car as usize];
        let own = count(&labels);
        let mut frame = Frame::new(
            layout,
            [(before.id, before)].into_iter().collect(),
            labels.clone(),
        );
        after.center_m.x += 18.0;
        after.yaw_rad = std::f64::consts::PI;
        frame.boxes.insert(after.id, after);
        let region = Region::of_edit(&frame, 2);
        let mut generated = labels.clone();
        assert_eq!(keep_objects(&frame, &region, false, &mut generated), 1 + 1);
        assert!(
            count(&generated).abs_diff(own) * 8 <= own,
            "{} {own}",
            count(&generated)
        );
        // It turned round, and the side that was seen with it.
        let cars = generated.iter_set().filter(|v| v.3 == Class::Car.id());
        let ys: Vec<f64> = cars.map(|v| Window::center(v.0, v.1, 0).y).collect();
        assert!(!ys.is_empty() && ys.iter().all(|y| *y <= 0.3));
        // A third of the columns is what labels usually hold, and enough.
        let mut sparse = draft::draft(&frame.layout, [].into_iter());
        for (x, y, _) in draft::box_columns(Extent::WINDOW, &after).into_iter().step_by(3) {
            sparse.set(x, y, 2, Class::Car.id());
        }
        let same = sparse.clone();
        assert_eq!(keep_objects(&frame, &region, false, &mut sparse), 0);
        assert_eq!(sparse, same);
    }

    #[test]
    fn a_new_box_is_hollow_among_labels_and_solid_in_a_complete_world() {
        let new = car(1, 10.0);
        let solid: usize = draft::box_columns(Extent::WINDOW, &new).iter().map(|c| c.2).sum();
        let complete = draft::draft(&BevLayout::default(), [].into_iter());
        let mut labels = VoxelGrid::new();
        for (x, y, z, label) in complete.iter_set().filter(|v| (v.0 + v.1) % 3 == 0) {
            labels.set(x, y, z, label);
        }
        for (source, hollow) in [(complete, false), (labels, true), (VoxelGrid::new(), false)] {
            let mut frame = Frame::new(BevLayout::default(), Default::default(), source.clone());
            frame.boxes.insert(new.id, new);
            let mut generated = source;
            let region = Region::of_edit(&frame, 2);
            assert_eq!(keep_objects(&frame, &region, false, &mut generated), 1);
            let found = generated.class_counts()[Class::Car as usize];
            match hollow {
                true => assert!((solid / 5..solid * 2 / 3).contains(&found), "{found} of {solid}"),
                false => assert_eq!(found, solid),
            }
        }
    }

    #[test]
    fn on_a_slope_nothing_is_put_below_the_ground() {
        let mut layout = BevLayout::default();
        layout.relief = scene::Relief::from_fn(Extent::WINDOW, |p| 2.0 + 0.04 * p.x);
        let mut new = car(1, 10.0);
        new.center_m.z += 2.4;
        let empty = draft::draft(&layout, [].into_iter());
        let mut frame = Frame::new(layout, std::collections::BTreeMap::new(), empty.clone());
        frame.boxes.insert(new.id, new);
        frame.layout.set(BevLayer::DrivableArea, 50, 80, true);
        let region = Region::of_edit(&frame, 2);
        let mut generated = empty.clone();
        assert_eq!(keep_objects(&frame, &region, false, &mut generated), 1);
        assert_eq!(keep_ground(&frame, &region, &mut generated), 1);
        for (x, y, z, label) in generated.iter_set() {
            assert!(z >= ground_bin(&frame.layout, x, y), "{x} {y} {z} {label}");
        }
        assert!(generated.class_counts()[Class::Car as usize] > 200);
        // Taken away again, the ground is where it was.
        let mut source = (*frame.source).clone();
        source.boxes.insert(new.id, new);
        frame.boxes.clear();
        frame.source = std::sync::Arc::new(source);
        frame.layout = frame.source.layout.clone();
        assert_eq!(keep_objects(&frame, &region, false, &mut generated), 1);
        generated.set(50, 80, ground_bin(&frame.layout, 50, 80), Class::Terrain.id());
        assert_eq!(generated, empty);
    }
}
