//! Which part of a scene an edit touches, and the composite that leaves all else bit-identical.
//!
//! The composite is made in label space, after decoding: blending latents leaks through the decoder,
//! choosing between labels cannot.

use crate::scene::grid::NOT_PAINTED;
use crate::scene::raster::box_cells;
use crate::scene::{Frame, GridSpec, SceneBox, VoxelGrid, VoxelPaint};

/// Latent cells along x and along y.
pub const CELLS_PER_SIDE: usize = 50;
/// Latent cells in all.
pub const CELLS: usize = CELLS_PER_SIDE * CELLS_PER_SIDE;
/// Columns along one side of a latent cell.
pub const COLUMNS_PER_CELL: usize = GridSpec::NX / CELLS_PER_SIDE;
/// Latent cells around a touched one that the decoder reads, too.
const DECODER_HALO_CELLS: usize = 1;
/// How far the voxels of an object may stand out of its box: one voxel.
const OVERHANG_M: f64 = GridSpec::VOXEL_M;

/// Columns of the grid to be redrawn, and latent cells to be regenerated for them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Region {
    /// `[x][y]`, 40,000: columns whose labels come from the generated grid.
    pub columns: Vec<bool>,
    /// `[i][j]`, 2,500: latent cells that hold such a column, and their neighbours.
    pub cells: Vec<bool>,
    /// Lowest and highest x and y of the columns, both included; `None` if there are none.
    pub bounds: Option<([usize; 2], [usize; 2])>,
}

impl Region {
    /// Nothing.
    pub fn empty() -> Self {
        Self::of_columns(vec![false; GridSpec::COLUMNS])
    }

    /// Everything.
    pub fn full() -> Self {
        Self::of_columns(vec![true; GridSpec::COLUMNS])
    }

    /// Exactly these columns, `[x][y]`. Panics unless there are 40,000.
    pub fn of_columns(columns: Vec<bool>) -> Self {
        assert_eq!(columns.len(), GridSpec::COLUMNS, "one flag per column");
        let mut touched = vec![false; CELLS];
        let mut bounds: Option<([usize; 2], [usize; 2])> = None;
        for (i, _) in columns.iter().enumerate().filter(|(_, c)| **c) {
            let (x, y) = (i / GridSpec::NY, i % GridSpec::NY);
            touched[x / COLUMNS_PER_CELL * CELLS_PER_SIDE + y / COLUMNS_PER_CELL] = true;
            let (lo, hi) = bounds.get_or_insert(([x, y], [x, y]));
            *lo = [lo[0].min(x), lo[1].min(y)];
            *hi = [hi[0].max(x), hi[1].max(y)];
        }
        Self {
            cells: dilate(&touched, CELLS_PER_SIDE, DECODER_HALO_CELLS),
            columns,
            bounds,
        }
    }

    /// What differs between a frame and the source of its occupancy: columns whose map layers changed,
    /// and both footprints of every box that was added, removed, moved, resized or given another class;
    /// all grown by `halo_columns`. Painted voxels do not count: they are laid over the composite.
    ///
    /// Columns of boxes that did not change stay out, so that no untouched object is cut.
    pub fn of_edit(frame: &Frame, halo_columns: usize) -> Self {
        let source = &*frame.source;
        let mut changed: Vec<bool> = frame
            .layout
            .cells()
            .iter()
            .zip(source.layout.cells())
            .map(|(now, before)| now != before)
            .collect();
        let mut footprints = vec![false; GridSpec::COLUMNS]; // of changed boxes, without overhang
        let mut unchanged = Vec::new();
        let mut mark = |b: &SceneBox| {
            box_cells(b, OVERHANG_M, |x, y| changed[x * GridSpec::NY + y] = true);
            box_cells(b, 0.0, |x, y| footprints[x * GridSpec::NY + y] = true);
        };
        for (id, now) in &frame.boxes {
            match source.boxes.get(id) {
                Some(before) if same_solid(now, before) => unchanged.push(now),
                before => before.into_iter().chain([now]).for_each(&mut mark),
            }
        }
        let removed = source
            .boxes
            .iter()
            .filter(|(id, _)| !frame.boxes.contains_key(id));
        removed.for_each(|(_, b)| mark(b));
        if !changed.contains(&true) {
            return Self::empty();
        }
        let mut columns = dilate(&changed, GridSpec::NX, halo_columns);
        for b in unchanged {
            box_cells(b, 0.0, |x, y| columns[x * GridSpec::NY + y] = false);
            // Around it only what is visibly part of it, and not against a changed box's own ground.
            box_cells(b, OVERHANG_M, |x, y| {
                let i = x * GridSpec::NY + y;
                if !footprints[i] && source.occupancy.column(x, y).contains(&b.class.id()) {
                    columns[i] = false;
                }
            });
        }
        Self::of_columns(columns)
    }

    /// True if nothing is to be done.
    pub fn is_empty(&self) -> bool {
        self.bounds.is_none()
    }

    /// Number of columns.
    pub fn column_count(&self) -> usize {
        self.columns.iter().filter(|c| **c).count()
    }

    /// Share of all columns, 0 to 1.
    pub fn share(&self) -> f64 {
        self.column_count() as f64 / GridSpec::COLUMNS as f64
    }

    /// Number of latent cells, halo included.
    pub fn cell_count(&self) -> usize {
        self.cells.iter().filter(|c| **c).count()
    }

    /// Extent along x and y, m; zero if empty.
    pub fn extent_m(&self) -> [f64; 2] {
        self.bounds.map_or([0.0; 2], |(lo, hi)| {
            [0, 1].map(|a| (hi[a] - lo[a] + 1) as f64 * GridSpec::VOXEL_M)
        })
    }

    /// Columns of the region within `width` columns of its border. The edge of the grid is no border.
    pub fn seam(&self, width: usize) -> Vec<bool> {
        let outside: Vec<bool> = self.columns.iter().map(|c| !c).collect();
        let near_outside = dilate(&outside, GridSpec::NX, width);
        let pairs = self.columns.iter().zip(near_outside);
        pairs.map(|(inside, near)| *inside && near).collect()
    }
}

/// Equal in everything that occupancy shows; velocity is not.
fn same_solid(a: &SceneBox, b: &SceneBox) -> bool {
    a.class == b.class && a.center_m == b.center_m && a.size_m == b.size_m && a.yaw_rad == b.yaw_rad
}

/// Sets every flag within `reach` of a set one, diagonals included, on a square of `side`; first
/// along rows, then along columns.
fn dilate(flags: &[bool], side: usize, reach: usize) -> Vec<bool> {
    if reach == 0 {
        return flags.to_vec();
    }
    let mut along_y = vec![false; flags.len()];
    let mut out = vec![false; flags.len()];
    for i in (0..flags.len()).filter(|i| flags[*i]) {
        let (row, y) = (i / side * side, i % side);
        along_y[row + y.saturating_sub(reach)..=row + (y + reach).min(side - 1)].fill(true);
    }
    for x in 0..side {
        for from in x.saturating_sub(reach)..=(x + reach).min(side - 1) {
            let source = &along_y[from * side..(from + 1) * side];
            for (o, s) in out[x * side..(x + 1) * side].iter_mut().zip(source) {
                *o |= s;
            }
        }
    }
    out
}

/// The source, with the region's columns from `generated`, with the user's painted voxels over all.
/// Bricks in which nothing differs keep the source's memory.
pub fn composite(
    source: &VoxelGrid,
    generated: &VoxelGrid,
    region: &Region,
    painted: &VoxelPaint,
) -> VoxelGrid {
    let mut out = source.clone();
    for (i, _) in region.columns.iter().enumerate().filter(|(_, c)| **c) {
        let (x, y) = (i / GridSpec::NY, i % GridSpec::NY);
        // Paint first, so that a brick is not copied for labels that paint takes back.
        let mut column = *generated.column(x, y);
        for (label, paint) in column.iter_mut().zip(painted.column(x, y)) {
            if *paint != NOT_PAINTED {
                *label = *paint;
            }
        }
        if column != *source.column(x, y) {
            *out.column_mut(x, y) = column;
        }
    }
    for (x, y, z, label) in painted.iter_set() {
        out.set(x, y, z, label);
    }
    out
}

/// Voxels outside the region, not painted, in which `result` differs from `source`. 0 is the promise.
pub fn untouched_voxels_changed(
    source: &VoxelGrid,
    result: &VoxelGrid,
    region: &Region,
    painted: &VoxelPaint,
) -> usize {
    if source.changed_bricks(result).is_empty() {
        return 0;
    }
    let mut count = 0;
    for (i, _) in region.columns.iter().enumerate().filter(|(_, c)| !**c) {
        let (x, y) = (i / GridSpec::NY, i % GridSpec::NY);
        let (before, after) = (source.column(x, y), result.column(x, y));
        if before != after {
            let paint = painted.column(x, y);
            count += (0..GridSpec::NZ)
                .filter(|z| before[*z] != after[*z] && paint[*z] == NOT_PAINTED)
                .count();
        }
    }
    count
}

/// Share of the voxels along the inner border of the region, `width` columns wide, in which `result`
/// differs from `source`; 0 without a border. High where the new content does not join the old.
pub fn seam_change_share(source: &VoxelGrid, result: &VoxelGrid, region: &Region, width: usize) -> f64 {
    let (mut changed, mut all) = (0usize, 0usize);
    for (i, _) in region.seam(width).iter().enumerate().filter(|(_, c)| **c) {
        let (x, y) = (i / GridSpec::NY, i % GridSpec::NY);
        let pairs = source.column(x, y).iter().zip(result.column(x, y));
        changed += pairs.filter(|(a, b)| a != b).count();
        all += GridSpec::NZ;
    }
    if all == 0 {
        0.0
    } else {
        changed as f64 / all as f64
    }
}

/// FNV-1a (64 bit) over the labels outside the region that are not painted, with their positions
/// implied by order: the same before and after an edit.
pub fn untouched_hash(grid: &VoxelGrid, region: &Region, painted: &VoxelPaint) -> u64 {
    let mut hash = Fnv::new();
    for (i, _) in region.columns.iter().enumerate().filter(|(_, c)| !**c) {
        let (x, y) = (i / GridSpec::NY, i % GridSpec::NY);
        let pairs = grid.column(x, y).iter().zip(painted.column(x, y));
        pairs.for_each(|(label, paint)| {
            hash.add(if *paint == NOT_PAINTED {
                *label
            } else {
                NOT_PAINTED
            })
        });
    }
    hash.0
}

/// FNV-1a (64 bit) over all labels in C order: names the content of a grid.
pub fn label_hash(grid: &VoxelGrid) -> u64 {
    untouched_hash(grid, &Region::empty(), &VoxelPaint::new())
}

struct Fnv(u64);

impl Fnv {
    fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
    fn add(&mut self, byte: u8) {
        self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;
    use std::sync::Arc;
    use std::time::Instant;

    use glam::{DVec2, DVec3};

    use super::*;
    use crate::generation::rng::philox4x32;
    use crate::scene::{BevLayer, BevLayout, BoxId, Class};

    /// Numbers for tests, one after another.
    struct Dice(u64, u32);

    impl Dice {
        fn below(&mut self, n: usize) -> usize {
            self.1 += 1;
            let bits = philox4x32([self.1, 0, 0, 99], [self.0 as u32, 7])[0];
            (bits as usize * n) >> 32
        }
        fn within(&mut self, lo: f64, hi: f64) -> f64 {
            lo + (hi - lo) * self.below(1 << 20) as f64 / f64::from(1 << 20)
        }
    }

    fn car(id: u32, x_m: f64, y_m: f64, yaw_rad: f64) -> SceneBox {
        SceneBox {
            id: BoxId(id),
            class: Class::Car,
            center_m: DVec3::new(x_m, y_m, 0.8),
            size_m: DVec3::new(4.6, 1.95, 1.7),
            yaw_rad,
            velocity_mps: DVec2::ZERO,
        }
    }

    fn random_grid(dice: &mut Dice) -> VoxelGrid {
        let mut dense = vec![Class::FREE; GridSpec::VOXELS];
        for column in dense.chunks_exact_mut(GridSpec::NZ) {
            column[0] = 11 + dice.below(4) as u8;
            let height = dice.below(24).saturating_sub(8);
            let label = dice.below(17) as u8;
            column[1..=height.min(15)].fill(label);
        }
        VoxelGrid::from_dense(&dense).expect("640,000")
    }

    /// Ground, and each box filled with its class from bin 0 up, standing out by one voxel.
    fn frame_with(boxes: &[SceneBox]) -> Frame {
        let mut grid = VoxelGrid::new();
        let mut layout = BevLayout::default();
        for x in 0..GridSpec::NX {
            for y in 0..GridSpec::NY {
                grid.set(x, y, 0, Class::DriveableSurface.id());
                layout.set(BevLayer::DrivableArea, x, y, (60..140).contains(&y));
            }
        }
        for b in boxes {
            box_cells(b, OVERHANG_M, |x, y| {
                (0..5).for_each(|z| grid.set(x, y, z, b.class.id()));
            });
        }
        Frame::new(layout, boxes.iter().map(|b| (b.id, *b)).collect(), grid)
    }

    fn cells_of(b: &SceneBox, margin_m: f64) -> Vec<usize> {
        let mut out = Vec::new();
        box_cells(b, margin_m, |x, y| out.push(x * GridSpec::NY + y));
        out
    }

    #[test]
    fn nothing_changed_is_an_empty_region() {
        let mut frame = frame_with(&[car(1, 5.0, 2.0, 0.1)]);
        assert!(Region::of_edit(&frame, 2).is_empty());
        // Velocity and paint are not for generation to redraw.
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
        assert!(!full.seam(2).contains(&true));
    }

    #[test]
    fn every_kind_of_edit_is_seen() {
        let start = frame_with(&[car(1, 5.0, 2.0, 0.1)]);
        let covers = |frame: &Frame, b: &SceneBox| {
            let region = Region::of_edit(frame, 2);
            let all = cells_of(b, OVERHANG_M).into_iter().all(|c| region.columns[c]);
            let expected = region.columns.iter().enumerate().all(|(c, on)| {
                let cell = c / GridSpec::NY / 4 * CELLS_PER_SIDE + c % GridSpec::NY / 4;
                !on || region.cells[cell]
            });
            all && expected && region.share() < 0.02
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
        let mut painted = start.clone();
        painted.layout.set(BevLayer::StopLine, 0, 199, true);
        let region = Region::of_edit(&painted, 2);
        assert_eq!(region.bounds, Some(([0, 197], [2, 199])));
        assert_eq!(region.column_count(), 9);
        assert_eq!(region.cell_count(), 4);
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
            assert!(cells_of(kept, 0.0).iter().all(|i| !region.columns[*i]));
        }
        // The removed car's own ground is redrawn down to the last column, and no voxel of the others changes.
        assert!(cells_of(&a, 0.0).iter().all(|i| region.columns[*i]));
        let bare = frame_with(&[]).occupancy;
        let result = composite(&frame.source.occupancy, &bare, &region, &frame.painted);
        for kept in [&b, &c] {
            for i in cells_of(kept, 0.0) {
                let (x, y) = (i / GridSpec::NY, i % GridSpec::NY);
                assert_eq!(result.column(x, y), frame.source.occupancy.column(x, y));
            }
        }
        for i in cells_of(&a, 0.0) {
            assert!(
                !result
                    .column(i / GridSpec::NY, i % GridSpec::NY)
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

    fn random_edit(frame: &mut Frame, dice: &mut Dice) {
        for _ in 0..=dice.below(2) {
            let (x, y) = (dice.within(-42.0, 42.0), dice.within(-42.0, 42.0));
            let id = BoxId(dice.below(12) as u32);
            match dice.below(4) {
                0 => drop(frame.boxes.remove(&id)),
                1 => drop(frame.boxes.insert(id, car(id.0, x, y, dice.within(-3.0, 3.0)))),
                2 => {
                    let layer = BevLayer::MAP[dice.below(8)];
                    let on = dice.below(2) == 0;
                    let mut cells = Vec::new();
                    crate::scene::raster::disc_cells(DVec2::new(x, y), dice.within(0.1, 4.0), |x, y| {
                        cells.push((x, y));
                    });
                    cells
                        .iter()
                        .for_each(|(x, y)| frame.layout.set(layer, *x, *y, on));
                }
                _ => {
                    for _ in 0..dice.below(30) {
                        let (x, y, z) = (dice.below(200), dice.below(200), dice.below(16));
                        frame.painted.set(x, y, z, dice.below(18) as u8);
                    }
                }
            }
        }
    }

    /// Row 25 of the extremes table: 1000 random edits in a chain, each result the next source. Outside
    /// the region and the paint nothing changes, and bricks that the edit misses keep their memory.
    #[test]
    fn row_25_untouched_labels_stay() {
        let mut dice = Dice(25, 0);
        let generated: Vec<VoxelGrid> = (0..4).map(|_| random_grid(&mut dice)).collect();
        let mut frame = Frame::new(BevLayout::default(), BTreeMap::new(), random_grid(&mut dice));
        let (mut edits_with_region, mut shared) = (0, 0);
        for edit in 0..1000 {
            random_edit(&mut frame, &mut dice);
            let region = Region::of_edit(&frame, dice.below(4));
            let (source, new) = (&frame.source.occupancy, &generated[edit % 4]);
            let result = composite(source, new, &region, &frame.painted);
            let paint = &frame.painted;
            assert_eq!(
                untouched_hash(source, &region, paint),
                untouched_hash(&result, &region, paint),
                "edit {edit}"
            );
            assert_eq!(untouched_voxels_changed(source, &result, &region, paint), 0);
            for (x, y, z, label) in paint.iter_set() {
                assert_eq!(result.get(x, y, z), label);
            }
            for (brick, (old, now)) in source.bricks().iter().zip(result.bricks()).enumerate() {
                shared += usize::from(Arc::ptr_eq(old, now));
                assert!(
                    old != now || Arc::ptr_eq(old, now),
                    "edit {edit}: brick {brick} copied for nothing"
                );
            }
            for (i, _) in region.columns.iter().enumerate().filter(|(_, c)| **c) {
                let (x, y) = (i / GridSpec::NY, i % GridSpec::NY);
                if paint.column(x, y).iter().all(|p| *p == NOT_PAINTED) {
                    assert_eq!(result.column(x, y), new.column(x, y));
                }
            }
            edits_with_region += usize::from(!region.is_empty());
            frame.source = Arc::new(crate::scene::SourceFrame {
                layout: frame.layout.clone(),
                boxes: frame.boxes.clone(),
                occupancy: result,
            });
        }
        assert!(
            edits_with_region > 500 && shared > 100_000,
            "{edits_with_region} {shared}"
        );
    }

    /// The measures are not blind: one voxel changed outside is found by all of them.
    #[test]
    fn a_broken_promise_is_counted() {
        let frame = {
            let mut f = frame_with(&[car(1, 5.0, 2.0, 0.1)]);
            f.boxes.clear();
            f
        };
        let region = Region::of_edit(&frame, 2);
        let source = &frame.source.occupancy;
        let mut broken = source.clone();
        broken.set(0, 0, 9, 4);
        assert_eq!(
            untouched_voxels_changed(source, &broken, &region, &frame.painted),
            1
        );
        assert_ne!(
            untouched_hash(source, &region, &frame.painted),
            untouched_hash(&broken, &region, &frame.painted)
        );
        assert_ne!(label_hash(source), label_hash(&broken));
        let mut paint = VoxelPaint::new();
        paint.set(0, 0, 9, 4);
        assert_eq!(untouched_voxels_changed(source, &broken, &region, &paint), 0);
        // The seam: all of its 16 voxels per column, or only the ground.
        assert_eq!(seam_change_share(source, source, &region, 2), 0.0);
        let free = composite(source, &VoxelGrid::new(), &region, &frame.painted);
        let share = seam_change_share(source, &free, &region, 2);
        assert!((1.0 / 16.0..0.2).contains(&share), "{share}");
    }

    /// Row 26 of the extremes table, as far as compositing goes: regions that do not meet commute.
    #[test]
    fn row_26_disjoint_composites_commute() {
        let mut dice = Dice(26, 0);
        let (source, new) = (random_grid(&mut dice), random_grid(&mut dice));
        let square = |lo: usize, hi: usize| {
            let inside = |i: usize| (lo..hi).contains(&(i / 200)) && (lo..hi).contains(&(i % 200));
            Region::of_columns((0..GridSpec::COLUMNS).map(inside).collect())
        };
        let (a, b, paint) = (square(20, 60), square(61, 90), VoxelPaint::new());
        let then = |first: &Region, second: &Region| {
            composite(&composite(&source, &new, first, &paint), &new, second, &paint)
        };
        assert_eq!(then(&a, &b), then(&b, &a));
        assert_ne!(then(&a, &b), source);
    }

    /// Region and composite of a scene with many boxes, on the full grid, stay far below a frame time.
    #[test]
    fn region_and_composite_take_less_than_5_ms() {
        let mut dice = Dice(5, 0);
        let boxes: Vec<SceneBox> = (0..60)
            .map(|i| {
                car(
                    i,
                    dice.within(-40.0, 40.0),
                    dice.within(-40.0, 40.0),
                    dice.within(-3.0, 3.0),
                )
            })
            .collect();
        let mut frame = frame_with(&boxes);
        let new = random_grid(&mut dice);
        for id in 0..5 {
            frame.boxes.remove(&BoxId(id));
            frame.boxes.insert(
                BoxId(100 + id),
                car(100 + id, f64::from(id) * 8.0 - 16.0, 9.0, 0.5),
            );
        }
        frame.painted.set(1, 2, 3, 4);
        let measure = |work: &mut dyn FnMut()| {
            // The least of many: other processes share these cores.
            let times = (0..40).map(|_| {
                let start = Instant::now();
                work();
                start.elapsed().as_secs_f64() * 1e3
            });
            times.fold(f64::INFINITY, f64::min)
        };
        let local_ms = measure(&mut || {
            let region = Region::of_edit(&frame, 2);
            std::hint::black_box(composite(&frame.source.occupancy, &new, &region, &frame.painted));
        });
        let full_ms = measure(&mut || {
            let region = Region::full();
            std::hint::black_box(composite(&frame.source.occupancy, &new, &region, &frame.painted));
        });
        println!("region and composite: 10 boxes changed {local_ms:.2} ms, whole grid {full_ms:.2} ms");
        assert!(local_ms < 5.0 && full_ms < 5.0, "{local_ms} ms, {full_ms} ms");
    }
}
