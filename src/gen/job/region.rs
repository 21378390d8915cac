//! The region that an edit touches: the columns to be inpainted, and the latent cells that the networks generate for
//! them.

use scene::raster::box_cells;
use scene::{Class, Extent, Frame, SceneBox, Window};

/// Latent cells along x and along y.
pub const CELLS_PER_SIDE: usize = 50;
/// Latent cells in all.
pub const CELLS: usize = CELLS_PER_SIDE * CELLS_PER_SIDE;
/// Columns along one side of a latent cell.
pub const COLUMNS_PER_CELL: usize = Window::NX / CELLS_PER_SIDE;
/// Largest distance of an object's voxels outside its box: one voxel.
const OVERHANG_M: f64 = Window::VOXEL_M;

/// Columns of the grid to be inpainted, and the latent cells to be generated for them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Region {
    /// `[x][y]`, 40,000: columns whose labels come from the generated grid.
    pub columns: Vec<bool>,
    /// `[i][j]`, 2,500: latent cells that hold such a column. Neighbouring latent cells are not added: their columns
    /// keep their old labels, so the new content must fit those.
    pub latent_cells: Vec<bool>,
    /// Lowest and highest x and y of the columns, both included; `None` if there are none.
    pub bounds: Option<([usize; 2], [usize; 2])>,
}

impl Region {
    /// The empty region.
    pub fn empty() -> Self {
        Self::of_columns(vec![false; Window::COLUMNS])
    }

    /// The region of all columns.
    pub fn full() -> Self {
        Self::of_columns(vec![true; Window::COLUMNS])
    }

    /// Exactly these columns, `[x][y]`. Panics unless there are 40,000.
    pub fn of_columns(columns: Vec<bool>) -> Self {
        assert_eq!(columns.len(), Window::COLUMNS, "one flag per column");
        let mut latent_cells = vec![false; CELLS];
        let mut bounds: Option<([usize; 2], [usize; 2])> = None;
        for (i, _) in columns.iter().enumerate().filter(|(_, c)| **c) {
            let (x, y) = (i / Window::NY, i % Window::NY);
            latent_cells[x / COLUMNS_PER_CELL * CELLS_PER_SIDE + y / COLUMNS_PER_CELL] = true;
            let (lo, hi) = bounds.get_or_insert(([x, y], [x, y]));
            *lo = [lo[0].min(x), lo[1].min(y)];
            *hi = [hi[0].max(x), hi[1].max(y)];
        }
        Self {
            latent_cells,
            columns,
            bounds,
        }
    }

    /// The region of an edit: the differences between a frame and the state in which its occupancy was last generated,
    /// imported or accepted ([`scene::SourceFrame`]). It holds the columns whose layout channels changed, and the old
    /// and the new footprint of every box that was added, removed, moved, resized or given another class; all grown by
    /// `halo_columns`, which are inpainted too. Painted voxels do not count: they are put over the result.
    ///
    /// Columns of boxes that did not change are left out, so that no untouched object is cut.
    pub fn of_edit(frame: &Frame, halo_columns: usize) -> Self {
        match frame.extent() == Extent::WINDOW {
            true => Self::of_columns(edited_columns(frame, halo_columns)),
            false => Self::of_edit(&frame.crop(Extent::WINDOW), halo_columns),
        }
    }

    /// True if it holds no column.
    pub fn is_empty(&self) -> bool {
        self.bounds.is_none()
    }

    /// Number of columns.
    pub fn column_count(&self) -> usize {
        self.columns.iter().filter(|c| **c).count()
    }

    /// Share of all columns, 0 to 1.
    pub fn share(&self) -> f64 {
        self.column_count() as f64 / Window::COLUMNS as f64
    }

    /// Number of latent cells.
    pub fn cell_count(&self) -> usize {
        self.latent_cells.iter().filter(|c| **c).count()
    }

    /// Extent along x and y, m; zero if empty.
    pub fn extent_m(&self) -> [f64; 2] {
        self.bounds.map_or([0.0; 2], |(lo, hi)| {
            [0, 1].map(|a| (hi[a] - lo[a] + 1) as f64 * Window::VOXEL_M)
        })
    }

    /// Columns of the region within `width` columns of its border. The edge of the grid is no border.
    pub fn inner_border(&self, width: usize) -> Vec<bool> {
        let outside: Vec<bool> = self.columns.iter().map(|c| !c).collect();
        let near_outside = dilate(&outside, Window::NY, width);
        let pairs = self.columns.iter().zip(near_outside);
        pairs.map(|(inside, near)| *inside && near).collect()
    }
}

/// Columns with ground now that were all free in the source, as where a map was made larger.
fn newly_ground(frame: &Frame) -> Vec<[usize; 2]> {
    let (now, source) = (&frame.occupancy, &frame.source.occupancy);
    let is_ground = |label: &u8| Class::from_id(*label).is_some_and(Class::is_ground);
    let mut out = Vec::new();
    for brick in now.changed_bricks(source) {
        let (from, size) = now.brick_columns(brick);
        for x in from[0]..from[0] + size[0] {
            for y in from[1]..from[1] + size[1] {
                let was_empty = || source.column(x, y).iter().all(|label| *label == Class::FREE);
                if now.column(x, y).iter().any(is_ground) && was_empty() {
                    out.push([x, y]);
                }
            }
        }
    }
    out
}

/// The columns `[x][y]` of a frame's map that an edit touches, on a map of any extent; see [`Region::of_edit`].
pub fn edited_columns(frame: &Frame, halo_columns: usize) -> Vec<bool> {
    let extent = frame.extent();
    let source = &*frame.source;
    let mut changed: Vec<bool> = frame
        .layout
        .cells()
        .iter()
        .zip(source.layout.cells())
        .map(|(now, before)| now != before)
        .collect();
    for [x, y] in newly_ground(frame) {
        changed[extent.index(x, y)] = true;
    }
    let mut footprints = vec![false; extent.columns()]; // of changed boxes, without overhang
    let mut unchanged = Vec::new();
    let mut add_box = |b: &SceneBox| {
        box_cells(extent, b, OVERHANG_M, |x, y| changed[extent.index(x, y)] = true);
        box_cells(extent, b, 0.0, |x, y| footprints[extent.index(x, y)] = true);
    };
    for (id, now) in &frame.boxes {
        match source.boxes.get(id) {
            Some(before) if same_solid(now, before) => unchanged.push(now),
            _ => add_box(now),
        }
    }
    // Columns where the source has voxels of the class of a removed or changed box. Boxes inferred from labels may
    // overlap others, so they may also lie in the footprint of an unchanged box.
    let mut shown_before = vec![false; extent.columns()];
    for (id, before) in &source.boxes {
        if !frame.boxes.get(id).is_some_and(|now| same_solid(now, before)) {
            add_box(before);
            box_cells(extent, before, 0.0, |x, y| {
                shown_before[extent.index(x, y)] |=
                    source.occupancy.column(x, y).contains(&before.class.id());
            });
        }
    }
    if !changed.contains(&true) {
        return changed;
    }
    let mut columns = dilate(&changed, extent.ny(), halo_columns);
    for b in unchanged {
        // Under an unchanged box a column stays in the region only if a removed or changed box showed there and this
        // box does not.
        box_cells(extent, b, 0.0, |x, y| {
            let i = extent.index(x, y);
            let own = || source.occupancy.column(x, y).contains(&b.class.id());
            columns[i] &= shown_before[i] && !own();
        });
        // Overhanging voxels of its class belong to it as well, except under a changed box.
        box_cells(extent, b, OVERHANG_M, |x, y| {
            let i = extent.index(x, y);
            if !footprints[i] && source.occupancy.column(x, y).contains(&b.class.id()) {
                columns[i] = false;
            }
        });
    }
    columns
}

/// True if two boxes are equal in everything that occupancy shows (velocity, for example, is not shown).
fn same_solid(a: &SceneBox, b: &SceneBox) -> bool {
    a.class == b.class && a.center_m == b.center_m && a.size_m == b.size_m && a.yaw_rad == b.yaw_rad
}

/// Sets every flag within `reach` of a set one, diagonals included; flags `[x][y]` with `ny` along y; first along y,
/// then along x.
pub(super) fn dilate(flags: &[bool], ny: usize, reach: usize) -> Vec<bool> {
    if reach == 0 {
        return flags.to_vec();
    }
    let mut along_y = vec![false; flags.len()];
    let mut out = vec![false; flags.len()];
    for i in (0..flags.len()).filter(|i| flags[*i]) {
        let (row, y) = (i / ny * ny, i % ny);
        along_y[row + y.saturating_sub(reach)..=row + (y + reach).min(ny - 1)].fill(true);
    }
    let nx = flags.len() / ny;
    for x in 0..nx {
        for from in x.saturating_sub(reach)..=(x + reach).min(nx - 1) {
            let source = &along_y[from * ny..(from + 1) * ny];
            for (o, s) in out[x * ny..(x + 1) * ny].iter_mut().zip(source) {
                *o |= s;
            }
        }
    }
    out
}

#[cfg(test)]
pub(super) mod tests {
    use glam::{DVec2, DVec3};

    use super::*;
    use crate::composite::composite;
    use nets::pieces::pieces;
    use numeric::philox::philox4x32;
    use scene::{BevLayer, BevLayout, BoxId, Class, VoxelGrid};

    /// Numbers for tests, one after another.
    pub struct Dice(pub u64, pub u32);

    impl Dice {
        pub fn below(&mut self, n: usize) -> usize {
            self.1 += 1;
            let bits = philox4x32([self.1, 0, 0, 99], [self.0 as u32, 7])[0];
            (bits as usize * n) >> 32
        }
        pub fn within(&mut self, lo: f64, hi: f64) -> f64 {
            lo + (hi - lo) * self.below(1 << 20) as f64 / f64::from(1 << 20)
        }
    }

    #[test]
    fn edits_far_apart_are_worked_on_apart() {
        let square = |cells: &mut Vec<bool>, x: usize, y: usize| {
            for i in 0..16 {
                cells[(x + i / 4) * CELLS_PER_SIDE + y + i % 4] = true;
            }
        };
        let mut cells = vec![false; CELLS];
        square(&mut cells, 2, 3);
        square(&mut cells, 40, 41);
        let apart = pieces(&cells, 3);
        assert_eq!(apart.len(), 2);
        assert!(
            (0..CELLS).all(|c| cells[c] == (apart[0][c] ^ apart[1][c])),
            "each cell once"
        );
        // Those whose surroundings overlap are cheaper together.
        square(&mut cells, 42, 46);
        assert_eq!(pieces(&cells, 3).len(), 2);
        assert!(pieces(&vec![false; CELLS], 3).is_empty());
        assert_eq!(pieces(&vec![true; 100 * 100], 3).len(), 1, "of the fine latent");
    }

    pub fn car(id: u32, x_m: f64, y_m: f64, yaw_rad: f64) -> SceneBox {
        SceneBox {
            id: BoxId(id),
            class: Class::Car,
            center_m: DVec3::new(x_m, y_m, 0.8),
            size_m: DVec3::new(4.6, 1.95, 1.7),
            yaw_rad,
            velocity_mps: DVec2::ZERO,
            label: Default::default(),
        }
    }

    pub fn random_grid(dice: &mut Dice) -> VoxelGrid {
        let mut dense = vec![Class::FREE; Window::VOXELS];
        for column in dense.chunks_exact_mut(Window::NZ) {
            column[0] = 11 + dice.below(4) as u8;
            let height = dice.below(24).saturating_sub(8);
            let label = dice.below(17) as u8;
            column[1..=height.min(15)].fill(label);
        }
        VoxelGrid::from_dense(&dense).expect("640,000")
    }

    /// Ground, and each box filled with its class from the lowest voxel up, standing out by one voxel.
    pub fn frame_with(boxes: &[SceneBox]) -> Frame {
        let mut grid = VoxelGrid::new();
        let mut layout = BevLayout::default();
        for x in 0..Window::NX {
            for y in 0..Window::NY {
                grid.set(x, y, 0, Class::DriveableSurface.id());
                layout.set(BevLayer::DrivableArea, x, y, (60..140).contains(&y));
            }
        }
        for b in boxes {
            box_cells(Extent::WINDOW, b, OVERHANG_M, |x, y| {
                (0..5).for_each(|z| grid.set(x, y, z, b.class.id()));
            });
        }
        Frame::new(layout, boxes.iter().map(|b| (b.id, *b)).collect(), grid)
    }

    pub fn columns_of(b: &SceneBox, margin_m: f64) -> Vec<usize> {
        let mut out = Vec::new();
        box_cells(Extent::WINDOW, b, margin_m, |x, y| out.push(x * Window::NY + y));
        out
    }

    #[test]
    fn nothing_changed_is_an_empty_region() {
        let mut frame = frame_with(&[car(1, 5.0, 2.0, 0.1)]);
        assert!(Region::of_edit(&frame, 2).is_empty());
        // Velocity and paint are not for generation to touch.
        frame.boxes.get_mut(&BoxId(1)).expect("there").velocity_mps.x = 3.0;
        frame.painted.set(3, 3, 3, 4);
        let region = Region::of_edit(&frame, 2);
        assert_eq!(region, Region::empty());
        assert_eq!(
            (region.share(), region.cell_count(), region.extent_m()),
            (0.0, 0, [0.0; 2])
        );
        let full = Region::full();
        assert_eq!(
            (full.share(), full.cell_count(), full.extent_m()),
            (1.0, CELLS, [80.0; 2])
        );
        assert!(!full.inner_border(2).contains(&true));
    }

    #[test]
    fn every_kind_of_edit_is_seen() {
        let start = frame_with(&[car(1, 5.0, 2.0, 0.1)]);
        let covers = |frame: &Frame, b: &SceneBox| {
            let region = Region::of_edit(frame, 2);
            let all = columns_of(b, OVERHANG_M).into_iter().all(|c| region.columns[c]);
            let cells_match = region.columns.iter().enumerate().all(|(c, on)| {
                let cell = c / Window::NY / 4 * CELLS_PER_SIDE + c % Window::NY / 4;
                !on || region.latent_cells[cell]
            });
            all && cells_match && region.share() < 0.02
        };
        let old = car(1, 5.0, 2.0, 0.1);
        let mut removed = start.clone();
        removed.boxes.clear();
        assert!(covers(&removed, &old));
        let region = Region::of_edit(&removed, 2);
        // 4.6 m along, 1.95 m across, 0.4 m overhang and 2 columns of halo on each side.
        let [along, across] = region.extent_m();
        assert!(
            (6.8..=8.0).contains(&along) && (4.2..=5.6).contains(&across),
            "{along} {across}"
        );
        let mut added = start.clone();
        added.boxes.insert(BoxId(2), car(2, -12.0, -4.0, 1.0));
        assert!(covers(&added, &car(2, -12.0, -4.0, 1.0)) && !covers(&added, &old));
        let mut moved = start.clone();
        moved.boxes.insert(BoxId(1), car(1, 9.0, 2.0, 0.1));
        assert!(covers(&moved, &old) && covers(&moved, &car(1, 9.0, 2.0, 0.1)));
        for change in [
            |b: &mut SceneBox| b.class = Class::Truck,
            |b: &mut SceneBox| b.size_m.z = 3.0,
            |b: &mut SceneBox| b.yaw_rad = 0.2,
        ] {
            let mut other = start.clone();
            change(other.boxes.get_mut(&BoxId(1)).expect("there"));
            assert!(covers(&other, &old));
        }
        let mut with_stop_line = start.clone();
        with_stop_line.layout.set(BevLayer::StopLine, 0, 199, true);
        let region = Region::of_edit(&with_stop_line, 2);
        assert_eq!(region.bounds, Some(([0, 197], [2, 199])));
        assert_eq!(region.column_count(), 9);
        assert_eq!(region.cell_count(), 1);
    }

    /// Boxes inferred from labels are as wide as they may be: the voxels decide whose a column is.
    #[test]
    fn what_a_removed_box_showed_goes_below_another_box_too() {
        let (gone, mut wide) = (car(1, 5.0, 0.0, 0.0), car(2, 5.0, 2.8, 0.0));
        wide.class = Class::Trailer;
        wide.size_m.y = 5.0; // over y of 0.3 to 5.3: a third of the car
        let mut frame = frame_with(&[gone]);
        let [x, y] = Window::column_at(5.0, 0.6).expect("inside");
        frame.occupancy.set(x, y, 4, Class::Trailer.id());
        let boxes = [gone, wide].map(|b| (b.id, b));
        let mut frame = Frame::new(frame.layout.clone(), boxes.into(), frame.occupancy.clone());
        frame.boxes.remove(&gone.id);
        let region = Region::of_edit(&frame, 2);
        let outside: Vec<usize> = columns_of(&gone, 0.0)
            .into_iter()
            .filter(|c| !region.columns[*c])
            .collect();
        assert_eq!(
            outside,
            [x * Window::NY + y],
            "only where the trailer shows itself"
        );
        let ground_of_the_other = Window::column_at(5.0, 4.0).expect("inside");
        assert!(!region.columns[ground_of_the_other[0] * Window::NY + ground_of_the_other[1]]);
    }

    #[test]
    fn objects_that_were_not_edited_are_not_cut() {
        // Bumper to bumper 0.3 m apart, another beside, and one far away.
        let (a, b, c) = (
            car(1, 0.0, 0.0, 0.0),
            car(2, 4.9, 0.0, 0.0),
            car(3, 0.0, 2.6, 0.05),
        );
        let mut frame = frame_with(&[a, b, c]);
        frame.boxes.remove(&BoxId(1));
        let region = Region::of_edit(&frame, 2);
        for kept in [&b, &c] {
            assert!(columns_of(kept, 0.0).iter().all(|i| !region.columns[*i]));
        }
        // The removed car's own ground is inpainted down to the last column, and no voxel of the others changes.
        assert!(columns_of(&a, 0.0).iter().all(|i| region.columns[*i]));
        let bare = frame_with(&[]).occupancy;
        let result = composite(&frame.source.occupancy, &bare, &region, &frame.painted);
        for kept in [&b, &c] {
            for i in columns_of(kept, 0.0) {
                let (x, y) = (i / Window::NY, i % Window::NY);
                assert_eq!(result.column(x, y), frame.source.occupancy.column(x, y));
            }
        }
        for i in columns_of(&a, 0.0) {
            assert!(
                !result
                    .column(i / Window::NY, i % Window::NY)
                    .contains(&Class::Car.id())
            );
        }
    }

    #[test]
    fn dilation_is_a_square_neighbourhood() {
        let mut dice = Dice(3, 0);
        for reach in 0..4 {
            let flags: Vec<bool> = (0..400).map(|_| dice.below(40) == 0).collect();
            let slow: Vec<bool> = (0..400usize)
                .map(|i| {
                    flags.iter().enumerate().any(|(j, f)| {
                        *f && (i / 20).abs_diff(j / 20) <= reach && (i % 20).abs_diff(j % 20) <= reach
                    })
                })
                .collect();
            assert_eq!(dilate(&flags, 20, reach), slow);
        }
    }
}
