//! Makes an edit visible in the voxels at once: clears or stamps boxes, lays ground. Generation soon replaces this rough
//! version. Painted voxels are locked and never touched.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{DVec2, DVec3};

use scene::clip::{MARGIN_M, ObjectVoxels};
use scene::draft::{box_bins, box_columns, ground_bin, ground_class};
use scene::grid::NOT_PAINTED;
use scene::raster::box_cells;
use scene::{BevLayer, BevLayout, Class, Extent, Frame, Lattice, SceneBox, VoxelGrid};

/// Bins above the ground's own in which ground classes may lie in Occ3D labels: a kerb's second bin, a bumpy verge.
const GROUND_BINS: usize = 2;
/// How far around a column without layout ground is searched for, columns.
const MAX_REACH: usize = 24;

/// Clears the voxels of a box that has just left `frame.boxes`, and lays ground where they stood.
/// Voxels that lie nearer to another box of the same class stay.
pub(super) fn clear_box(frame: &mut Frame, old: &SceneBox) {
    let extent = frame.extent();
    let voxels = OwnVoxels::of(frame, old);
    let mut emptied = Vec::new();
    box_cells(extent, old, MARGIN_M, |x, y| {
        if !voxels.has_column(x, y) {
            return;
        }
        let painted = frame.painted.column(x, y);
        let mut column = frame.occupancy.column(x, y).to_vec();
        let ground = ground_bin(&frame.layout, x, y);
        let foot = extent.lattice().foot_bin(ground);
        let mut stood = false;
        for z in 0..column.len() {
            if voxels.has([x, y, z], column[z]) && painted[z] == NOT_PAINTED {
                column[z] = background(frame.source.occupancy.get(x, y, z));
                stood |= (ground..=foot).contains(&z);
            }
        }
        // Ground that a box stands on may lie a bin beside that of the layout's height; data leave out what was not seen.
        let is_named = ground_class(frame.layout.cell(x, y)) != Class::Terrain;
        let may_lack = foot > ground && (!is_named || column.iter().any(|l| is_ground(*l)));
        if stood && column[ground] == Class::FREE && !may_lack {
            emptied.push([x, y]);
        }
        if column != frame.occupancy.column(x, y) {
            frame.occupancy.column_mut(x, y).copy_from_slice(&column);
        }
    });
    refill_ground(&mut frame.occupancy, &frame.layout, &emptied);
}

/// Voxels of a box that is moved, and what the data set calls most of them.
pub(super) struct CarriedVoxels {
    voxels: Arc<ObjectVoxels>,
    /// The box, its middle on a corner of voxels: moves add up without a rest.
    from: SceneBox,
    label: Option<u16>,
}

impl CarriedVoxels {
    /// The voxels of a box that is about to be moved to `new`, which then stand there as they are. `None` where it is drawn anew:
    /// one of another class or size, one without voxels, one that another box of its class overlaps or that is or goes off the
    /// map, as these would lose voxels for good, and all in the voxels of Occ3D, in which the networks draw boxes.
    pub(super) fn cut(frame: &Frame, old: &SceneBox, new: &SceneBox) -> Option<Self> {
        let extent = frame.extent();
        if extent.lattice() == Lattice::OCC3D || (old.class, old.size_m) != (new.class, new.size_m) {
            return None;
        }
        let own = OwnVoxels::of(frame, old);
        let mut shares = false;
        box_cells(extent, old, 0.0, |x, y| shares |= !own.has_column(x, y));
        if shares || !is_within(extent, old) || !is_within(extent, new) {
            return None;
        }
        let voxels = ObjectVoxels::cut(&frame.occupancy, old, |at, label| {
            let [x, y, z] = at;
            own.has(at, label) && own.has_column(x, y) && frame.painted.get(x, y, z) == NOT_PAINTED
        });
        if voxels.labels.is_empty() {
            return None;
        }
        let labels = frame.inferred.data_labels.as_ref();
        let mut counts: BTreeMap<u16, usize> = BTreeMap::new();
        let from = on_corner(extent, old);
        voxels.visit(extent, &from, &from, |at, _| {
            if let Some(labels) = labels {
                *counts.entry(labels.label(at, old.class)).or_default() += 1;
            }
        });
        Some(Self {
            voxels,
            from,
            label: counts
                .into_iter()
                .max_by_key(|(_, count)| *count)
                .map(|(label, _)| label),
        })
    }

    /// Puts them where the box is now.
    pub(super) fn stamp(&self, frame: &mut Frame, new: &SceneBox) {
        let extent = frame.extent();
        let now = on_corner(extent, new);
        self.voxels
            .stamp(&mut frame.occupancy, &frame.painted, &self.from, &now);
        let (Some(label), Some(labels)) = (self.label, &frame.inferred.data_labels) else {
            return;
        };
        let mut moved = Vec::new();
        self.voxels.visit(extent, &self.from, &self.from, |at, _| {
            moved.push((at, labels.usual(new.class)));
        });
        self.voxels
            .visit(extent, &self.from, &now, |at, _| moved.push((at, label)));
        frame.inferred.data_labels = Some(labels.with(moved));
    }
}

/// A box whose middle is moved, by less than a voxel, to the nearest corner of voxels.
fn on_corner(extent: Extent, b: &SceneBox) -> SceneBox {
    let per_m = extent.lattice().per_m();
    SceneBox {
        center_m: (b.center_m * per_m).round() / per_m,
        ..*b
    }
}

/// True if a box is on the map and below its top, with all of its corners.
fn is_within(extent: Extent, b: &SceneBox) -> bool {
    let half = b.size_m / 2.0;
    let on_map = |x: f64, y: f64| {
        let corner = b.to_ego(DVec3::new(x * half.x, y * half.y, half.z));
        extent.column_at(corner.x, corner.y).is_some() && corner.z <= extent.lattice().top_m()
    };
    [-1.0, 1.0].into_iter().all(|x| on_map(x, -1.0) && on_map(x, 1.0))
}

/// Tells which voxels are those of a box, and not of another box of its class beside it.
struct OwnVoxels {
    extent: Extent,
    of: SceneBox,
    others: Vec<SceneBox>,
}

impl OwnVoxels {
    fn of(frame: &Frame, of: &SceneBox) -> Self {
        let others = frame.boxes.values();
        let others = others.filter(|b| b.class == of.class && b.id != of.id && near(b, of));
        Self {
            extent: frame.extent(),
            of: *of,
            others: others.copied().collect(),
        }
    }

    fn has_column(&self, x: usize, y: usize) -> bool {
        let out_m = |b| outside_m(self.extent, b, x, y);
        !self.others.iter().any(|b| out_m(b) <= out_m(&self.of))
    }

    fn has(&self, [x, y, z]: [usize; 3], label: u8) -> bool {
        let top_m = self.of.center_m.z + self.of.size_m.z / 2.0 + MARGIN_M;
        label == self.of.class.id() && self.extent.center(x, y, z).z <= top_m
    }
}

/// The label that comes back where an object is removed: walls and plants of the source stay. Objects do not come back,
/// because their boxes may be gone by now, nor does ground, which follows the present layout.
fn background(source_label: u8) -> u8 {
    match Class::from_id(source_label) {
        Some(Class::Others | Class::Manmade | Class::Vegetation) => source_label,
        _ => Class::FREE,
    }
}

/// Stamps the voxels of a box in the rough profile of its class, over the voxels that were there.
pub(super) fn stamp_box(frame: &mut Frame, b: &SceneBox) {
    for (x, y, layers) in box_columns(frame.extent(), b) {
        let ground = ground_bin(&frame.layout, x, y);
        for z in box_bins(frame.extent().lattice(), ground, layers) {
            if frame.painted.get(x, y, z) == NOT_PAINTED {
                frame.occupancy.set(x, y, z, b.class.id());
            }
        }
    }
}

/// True for the layers that decide the class of the ground; lines and crossings lie on it.
pub(super) fn shapes_ground(layer: BevLayer) -> bool {
    BevLayer::GROUND.contains(&layer)
}

/// Gives columns whose layout has changed the ground class it now asks for. Columns in which
/// something stands in the ground's bin keep it.
pub(super) fn lay_ground(frame: &mut Frame, cells: &[[usize; 2]]) {
    for &[x, y] in cells {
        let ground = ground_class(frame.layout.cell(x, y)).id();
        let painted = frame.painted.column(x, y);
        let mut column = frame.occupancy.column(x, y).to_vec();
        let bin = ground_bin(&frame.layout, x, y);
        if column[bin] != Class::FREE && !is_ground(column[bin]) {
            continue;
        }
        // The second bin of a kerb is cleared too: a road painted over a sidewalk would keep its rim otherwise.
        for z in bin + 1..(bin + 1 + GROUND_BINS).min(column.len()) {
            if is_ground(column[z]) && painted[z] == NOT_PAINTED {
                column[z] = Class::FREE;
            }
        }
        if painted[bin] == NOT_PAINTED {
            column[bin] = ground;
        }
        if column != frame.occupancy.column(x, y) {
            frame.occupancy.column_mut(x, y).copy_from_slice(&column);
        }
    }
}

/// Lays ground in columns that were emptied: the class of the layout, else the class of most of the nearest ground
/// columns around, else terrain.
pub(super) fn refill_ground(grid: &mut VoxelGrid, layout: &BevLayout, emptied: &[[usize; 2]]) {
    if emptied.is_empty() {
        return;
    }
    // First all classes are found, then the ground is laid, so that the order of the columns does not matter.
    let around = NearbyGround::from_columns(grid, layout, emptied);
    let filled: Vec<u8> = emptied
        .iter()
        .map(|&at| match ground_class(layout.cell(at[0], at[1])) {
            Class::Terrain => around.ground(at),
            named => named.id(),
        })
        .collect();
    for (&[x, y], ground) in emptied.iter().zip(filled) {
        grid.set(x, y, ground_bin(layout, x, y), ground);
    }
}

/// The ground around columns.
struct NearbyGround {
    /// First column of the area that is looked at.
    from: [usize; 2],
    /// Its columns.
    shape: [usize; 2],
    /// Label of each column's ground bin, `[x][y]`.
    labels: Vec<u8>,
    /// How far, on a square ring, the nearest ground is; 0 on ground.
    reach: Vec<usize>,
}

impl NearbyGround {
    /// Reads the ground around columns of a map, as far out as ground is searched for.
    fn from_columns(grid: &VoxelGrid, layout: &BevLayout, columns: &[[usize; 2]]) -> Self {
        let extent = layout.extent();
        let map = [extent.nx(), extent.ny()];
        let span = |axis: usize| {
            let (low, high) = columns.iter().fold((usize::MAX, 0), |(low, high), c| {
                (low.min(c[axis]), high.max(c[axis] + 1))
            });
            let from = low.min(high).saturating_sub(MAX_REACH);
            (from, (high + MAX_REACH).min(map[axis]))
        };
        let ([x0, y0], [x1, y1]) = {
            let (x, y) = (span(0), span(1));
            ([x.0, y.0], [x.1, y.1])
        };
        let shape = [x1 - x0, y1 - y0];
        let label = |x, y| grid.get(x, y, ground_bin(layout, x, y));
        let labels: Vec<u8> = (x0..x1)
            .flat_map(|x| (y0..y1).map(move |y| label(x, y)))
            .collect();
        let mut reach: Vec<usize> = labels
            .iter()
            .map(|l| if is_ground(*l) { 0 } else { usize::MAX })
            .collect();
        // Two sweeps give the distance on square rings, by the neighbours that were swept before.
        let mut sweep = |x: usize, y: usize, ahead: bool| {
            let (xs, ys) = (x.saturating_sub(1)..=(x + 1).min(shape[0] - 1), y);
            let near = xs.flat_map(|i| {
                let js = ys.saturating_sub(1)..=(ys + 1).min(shape[1] - 1);
                js.map(move |j| [i, j])
            });
            let before = near.filter(|at| match ahead {
                true => *at < [x, y],
                false => *at > [x, y],
            });
            let nearest = before.map(|[i, j]| reach[i * shape[1] + j]).min();
            let own = &mut reach[x * shape[1] + y];
            *own = (*own).min(nearest.unwrap_or(usize::MAX).saturating_add(1));
        };
        for x in 0..shape[0] {
            (0..shape[1]).for_each(|y| sweep(x, y, true));
        }
        for x in (0..shape[0]).rev() {
            (0..shape[1]).rev().for_each(|y| sweep(x, y, false));
        }
        Self {
            from: [x0, y0],
            shape,
            labels,
            reach,
        }
    }

    /// Ground class that most columns have on the smallest square ring around a column with any ground.
    fn ground(&self, [x, y]: [usize; 2]) -> u8 {
        let [x, y] = [x - self.from[0], y - self.from[1]];
        let [nx, ny] = self.shape;
        // A column is not on its own ring.
        let mut reach = self.reach[x * ny + y];
        if reach == 0 {
            reach = 1;
        }
        let mut votes = [0usize; Class::COUNT];
        while reach <= MAX_REACH {
            let (low, high) = (y.saturating_sub(reach), (y + reach).min(ny - 1));
            for i in x.saturating_sub(reach)..=(x + reach).min(nx - 1) {
                let mut vote = |j: usize| {
                    let label = self.labels[i * ny + j];
                    if is_ground(label) {
                        votes[label as usize] += 1;
                    }
                };
                // All of it at both ends of the ring, two cells in between.
                if i.abs_diff(x) == reach {
                    (low..=high).for_each(&mut vote);
                } else {
                    let ends = [y.checked_sub(reach), (y + reach < ny).then_some(y + reach)];
                    ends.into_iter().flatten().for_each(&mut vote);
                }
            }
            // First of the highest: a tie goes to the lower id.
            let most = votes.iter().copied().max().unwrap_or(0);
            if most > 0 {
                return votes.iter().position(|v| *v == most).unwrap_or(0) as u8;
            }
            reach += 1;
        }
        Class::Terrain.id()
    }
}

fn is_ground(label: u8) -> bool {
    Class::from_id(label).is_some_and(Class::is_ground)
}

fn near(a: &SceneBox, b: &SceneBox) -> bool {
    let reach = (a.size_m.truncate().length() + b.size_m.truncate().length()) / 2.0;
    a.center_m.truncate().distance(b.center_m.truncate()) <= reach + 2.0 * MARGIN_M
}

/// Distance of a column's centre from a box's footprint, m; 0 inside.
fn outside_m(extent: Extent, b: &SceneBox, x: usize, y: usize) -> f64 {
    let p = extent.center(x, y, 0);
    let local = b.to_local(DVec3::new(p.x, p.y, b.center_m.z)).truncate();
    let beyond = local.abs() - b.size_m.truncate() / 2.0;
    beyond.max(DVec2::ZERO).length()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ring by ring, cell by cell.
    fn plainly(grid: &VoxelGrid, layout: &BevLayout, [x, y]: [usize; 2]) -> u8 {
        let extent = layout.extent();
        for reach in 1..=MAX_REACH {
            let mut votes = [0usize; Class::COUNT];
            let on_ring = |[i, j]: &[usize; 2]| i.abs_diff(x).max(j.abs_diff(y)) == reach;
            for [i, j] in extent.all_columns().filter(on_ring) {
                let label = grid.get(i, j, ground_bin(layout, i, j));
                votes[usize::from(label)] += usize::from(is_ground(label));
            }
            let most = votes.iter().copied().max().unwrap_or(0);
            if most > 0 {
                return votes.iter().position(|v| *v == most).unwrap_or(0) as u8;
            }
        }
        Class::Terrain.id()
    }

    /// Large holes at edges and corners, ground of several classes around them, and one column farther off than is looked.
    #[test]
    fn emptied_columns_get_the_ground_of_the_nearest_ring() {
        let layout = BevLayout::default();
        let extent = layout.extent();
        let mut grid = VoxelGrid::new();
        let classes = [Class::Sidewalk, Class::Terrain, Class::DriveableSurface];
        for [x, y] in extent.all_columns() {
            let class = classes[(x * 7 + y * 13 + x * y / 5) % 3];
            grid.set(x, y, ground_bin(&layout, x, y), class.id());
        }
        let holes = [
            [0, 9, 0, 30],
            [60, 101, 40, 71],
            [150, 200, 150, 200],
            [20, 21, 120, 121],
        ];
        let emptied: Vec<[usize; 2]> = holes
            .iter()
            .flat_map(|[x0, x1, y0, y1]| (*x0..*x1).flat_map(move |x| (*y0..*y1).map(move |y| [x, y])))
            .collect();
        for [x, y] in &emptied {
            grid.set(*x, *y, ground_bin(&layout, *x, *y), Class::FREE);
        }
        let around = NearbyGround::from_columns(&grid, &layout, &emptied);
        for at in emptied.iter().step_by(7) {
            assert_eq!(around.ground(*at), plainly(&grid, &layout, *at), "{at:?}");
        }
        assert_eq!(around.ground([199, 199]), Class::Terrain.id(), "too far from any");
    }

    /// A road of 0.2 m voxels with two cars: one has a lamp on its roof that no draft has.
    fn fine() -> Frame {
        let lattice = Lattice::new(0.2, 40, -3.2).expect("sound");
        let extent = Extent::over(lattice, [-100, -100], [200, 200]).expect("sound");
        let mut layout = BevLayout::over(extent);
        for [x, y] in extent.all_columns() {
            layout.set(BevLayer::DrivableArea, x, y, true);
        }
        let car = |id, x| SceneBox {
            id: scene::BoxId(id),
            class: Class::Car,
            center_m: DVec3::new(x, 0.0, 0.8),
            size_m: DVec3::new(4.4, 1.8, 1.6),
            yaw_rad: 0.0,
            velocity_mps: DVec2::ZERO,
            label: Default::default(),
        };
        let boxes = [car(1, 3.0), car(2, 10.0)].map(|b| (b.id, b));
        let mut grid = scene::draft::draft(&layout, boxes.iter().map(|(_, b)| b));
        let [x, y] = extent.column_at(3.1, 0.1).expect("on the map");
        grid.set(x, y, 24, Class::Car.id());
        Frame::new(layout, boxes.into(), grid)
    }

    fn moved(frame: &mut Frame, id: u32, x: f64) {
        let old = frame.boxes[&scene::BoxId(id)];
        let new = SceneBox {
            center_m: DVec3::new(x, 0.0, 0.8),
            ..old
        };
        let carried = CarriedVoxels::cut(frame, &old, &new);
        frame.boxes.remove(&old.id);
        clear_box(frame, &old);
        frame.boxes.insert(new.id, new);
        match carried {
            Some(voxels) => voxels.stamp(frame, &new),
            None => stamp_box(frame, &new),
        }
    }

    #[test]
    fn a_moved_box_takes_its_voxels_along_and_leaves_the_ground() {
        let before = fine();
        let mut frame = before.clone();
        moved(&mut frame, 1, -6.0);
        let lamp = |frame: &Frame, x: f64| {
            let [x, y] = frame.extent().column_at(x, 0.1).expect("on the map");
            frame.occupancy.get(x, y, 24)
        };
        assert_eq!(
            (lamp(&frame, -5.9), lamp(&frame, 3.1)),
            (Class::Car.id(), Class::FREE)
        );
        let counts = |f: &Frame| f.occupancy.class_counts();
        assert_eq!(counts(&frame), counts(&before));
        // Back again: every voxel as it was.
        moved(&mut frame, 1, 3.0);
        assert_eq!(frame.occupancy, before.occupancy);
        // What would be cut off, by another car or the end of the map, is drawn anew and whole.
        moved(&mut frame, 1, 9.0);
        moved(&mut frame, 1, 3.0);
        let old = frame.boxes[&scene::BoxId(1)];
        let drawn = scene::draft::draft(&frame.layout, [&old].into_iter());
        let of_car = drawn.iter_set().filter(|v| v.3 == Class::Car.id());
        assert!(
            of_car
                .into_iter()
                .all(|(x, y, z, label)| frame.occupancy.get(x, y, z) == label)
        );
        let out = SceneBox {
            center_m: DVec3::new(19.0, 0.0, 0.8),
            ..old
        };
        assert!(CarriedVoxels::cut(&frame, &old, &out).is_none());
    }

    #[test]
    fn many_small_moves_add_up_and_lose_nothing() {
        let before = fine();
        let mut frame = before.clone();
        for step in 1..=40 {
            moved(&mut frame, 1, 3.0 - 0.13 * f64::from(step));
        }
        assert_eq!(frame.occupancy.class_counts(), before.occupancy.class_counts());
        moved(&mut frame, 1, 3.0);
        assert_eq!(frame.occupancy, before.occupancy);
    }
}
