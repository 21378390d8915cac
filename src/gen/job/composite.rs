//! Puts the generated region into the old occupancy and leaves everything else bit-identical. Also measures that
//! nothing else changed, and how well the region joins its surroundings.
//!
//! This is done with labels, after decoding. Blending latents instead would change labels outside the region, because
//! the decoder of a cell sees its neighbours.

use super::region::Region;
use numeric::hash::Fnv1a;
use scene::grid::NOT_PAINTED;
use scene::{VoxelGrid, VoxelPaint, Window};

/// The source, with the region's columns from `generated` and the user's painted voxels on top.
/// Bricks in which nothing differs share memory with the source.
pub fn composite(
    source: &VoxelGrid,
    generated: &VoxelGrid,
    region: &Region,
    painted: &VoxelPaint,
) -> VoxelGrid {
    let mut out = source.clone();
    for (i, _) in region.columns.iter().enumerate().filter(|(_, c)| **c) {
        let (x, y) = (i / Window::NY, i % Window::NY);
        // Paint is applied first, so that a brick is not copied for labels that paint replaces anyway.
        let mut column = *generated.window_column(x, y);
        for (label, paint) in column.iter_mut().zip(painted.column(x, y)) {
            if *paint != NOT_PAINTED {
                *label = *paint;
            }
        }
        if column != *source.window_column(x, y) {
            *out.window_column_mut(x, y) = column;
        }
    }
    for (x, y, z, label) in painted.iter_set() {
        out.set(x, y, z, label);
    }
    out
}

/// Number of voxels outside the region, not painted, that differ between `result` and `source`; must be 0.
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
        let (x, y) = (i / Window::NY, i % Window::NY);
        let (before, after) = (source.column(x, y), result.column(x, y));
        if before != after {
            let paint = painted.column(x, y);
            count += (0..Window::NZ)
                .filter(|z| before[*z] != after[*z] && paint[*z] == NOT_PAINTED)
                .count();
        }
    }
    count
}

/// Share of the voxels along the inner border of the region, `width` columns wide, in which `result`
/// differs from `source`; 0 without a border. It is high if the new content does not join the old.
pub fn seam_change_share(source: &VoxelGrid, result: &VoxelGrid, region: &Region, width: usize) -> f64 {
    let (mut changed, mut all) = (0usize, 0usize);
    for (i, _) in region.inner_border(width).iter().enumerate().filter(|(_, c)| **c) {
        let (x, y) = (i / Window::NY, i % Window::NY);
        let pairs = source.column(x, y).iter().zip(result.column(x, y));
        changed += pairs.filter(|(a, b)| a != b).count();
        all += Window::NZ;
    }
    if all == 0 {
        0.0
    } else {
        changed as f64 / all as f64
    }
}

/// Hash (FNV-1a, 64 bit) of the labels outside the region that are not painted, in order: the same before and after an
/// edit.
pub fn untouched_hash(grid: &VoxelGrid, region: &Region, painted: &VoxelPaint) -> u64 {
    let mut hash = Fnv1a::new();
    for (i, _) in region.columns.iter().enumerate().filter(|(_, c)| !**c) {
        let (x, y) = (i / Window::NY, i % Window::NY);
        let pairs = grid.column(x, y).iter().zip(painted.column(x, y));
        pairs.for_each(|(label, paint)| {
            hash.add(if *paint == NOT_PAINTED {
                *label
            } else {
                NOT_PAINTED
            })
        });
    }
    hash.get()
}

/// Hash (FNV-1a, 64 bit) of all labels of a grid in C order.
pub fn label_hash(grid: &VoxelGrid) -> u64 {
    untouched_hash(grid, &Region::empty(), &VoxelPaint::new())
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;
    use std::sync::Arc;
    use std::time::Instant;

    use glam::DVec2;

    use super::super::region::tests::{Dice, car, frame_with, random_grid};
    use super::*;
    use scene::Extent;
    use scene::raster::disc_cells;
    use scene::{BevLayer, BevLayout, BoxId, Frame, SceneBox};

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
                    disc_cells(Extent::WINDOW, DVec2::new(x, y), dice.within(0.1, 4.0), |x, y| {
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
                let (x, y) = (i / Window::NY, i % Window::NY);
                if paint.column(x, y).iter().all(|p| *p == NOT_PAINTED) {
                    assert_eq!(result.column(x, y), new.column(x, y));
                }
            }
            edits_with_region += usize::from(!region.is_empty());
            frame.source = Arc::new(scene::SourceFrame {
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
            Region::of_columns((0..Window::COLUMNS).map(inside).collect())
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
