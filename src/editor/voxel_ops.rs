//! Sets of voxels that the voxel tools work on: boxes, lines, connected voxels, faces pulled out, mirror images. None
//! is ever larger than the grid, and each is sorted and holds a voxel once.

use std::collections::BTreeMap;

use glam::IVec3;

use scene::{Class, Extent, Frame, VoxelGrid};

use super::Edit;

/// Index of a voxel `[x, y, z]`.
pub type VoxelIndex = [usize; 3];

fn holds(extent: Extent, [x, y, z]: VoxelIndex) -> bool {
    extent.holds(x, y) && z < extent.nz()
}

fn cell_at(extent: Extent, p: IVec3) -> Option<VoxelIndex> {
    let cell = p.to_array().map(usize::try_from);
    match cell {
        [Ok(x), Ok(y), Ok(z)] => Some([x, y, z]).filter(|c| holds(extent, *c)),
        _ => None,
    }
}

fn ivec(c: VoxelIndex) -> IVec3 {
    IVec3::from_array(c.map(|v| v as i32))
}

/// Every voxel between two corners, both included; corners outside are moved to the rim.
pub fn between(extent: Extent, a: VoxelIndex, b: VoxelIndex) -> Vec<VoxelIndex> {
    let size = extent.shape();
    let low = [0, 1, 2].map(|i| a[i].min(b[i]).min(size[i] - 1));
    let high = [0, 1, 2].map(|i| a[i].max(b[i]).min(size[i] - 1));
    let mut cells = Vec::new();
    for x in low[0]..=high[0] {
        for y in low[1]..=high[1] {
            cells.extend((low[2]..=high[2]).map(|z| [x, y, z]));
        }
    }
    cells
}

/// The voxels from one to another along a straight line, each `size` wide, connected by faces, edges or
/// corners; as many steps as the longest side.
pub fn line(extent: Extent, a: VoxelIndex, b: VoxelIndex, size: usize) -> Vec<VoxelIndex> {
    let (a, b) = (ivec(a).as_dvec3(), ivec(b).as_dvec3());
    let steps = (b - a).abs().max_element().min(1e4);
    let size = size.clamp(1, extent.nz()) as i32;
    let low = (size - 1) / 2;
    let mut cells = Vec::new();
    for i in 0..=steps as usize {
        let t = if steps > 0.0 { i as f64 / steps } else { 0.0 };
        let at = a.lerp(b, t).round().as_ivec3();
        for x in 0..size {
            for y in 0..size {
                for z in 0..size {
                    cells.extend(cell_at(extent, at + IVec3::new(x - low, y - low, z)));
                }
            }
        }
    }
    tidy(cells)
}

fn tidy(mut cells: Vec<VoxelIndex>) -> Vec<VoxelIndex> {
    cells.sort_unstable();
    cells.dedup();
    cells
}

/// Voxels of one class that connect to `start` by faces; empty for a free one or one outside the grid.
pub fn connected(grid: &VoxelGrid, start: VoxelIndex) -> Vec<VoxelIndex> {
    let extent = grid.extent();
    if !holds(extent, start) {
        return Vec::new();
    }
    let [x, y, z] = start;
    let class = grid.get(x, y, z);
    if class == Class::FREE {
        return Vec::new();
    }
    // Whole runs of a column at once, one bit per voxel.
    let mut seen = vec![0u64; extent.columns()];
    let mut open = vec![([x, y], 1u64 << z)];
    while let Some(([x, y], touched)) = open.pop() {
        let column = grid.column(x, y).iter().enumerate();
        let own = column.fold(0, |word, (z, v)| word | u64::from(*v == class) << z);
        let seen = &mut seen[extent.index(x, y)];
        let new = runs(touched, own) & !*seen;
        if new == 0 {
            continue;
        }
        *seen |= new;
        let sides = [
            [x.wrapping_sub(1), y],
            [x + 1, y],
            [x, y.wrapping_sub(1)],
            [x, y + 1],
        ];
        let inside = sides.into_iter().filter(|[x, y]| extent.holds(*x, *y));
        open.extend(inside.map(|side| (side, new)));
    }
    let mut cells = Vec::new();
    for ([x, y], word) in extent.all_columns().zip(seen) {
        if word != 0 {
            let set = (0..extent.nz()).filter(|z| word >> z & 1 == 1);
            cells.extend(set.map(|z| [x, y, z]));
        }
    }
    cells
}

/// The runs of `within` that a word touches.
fn runs(touched: u64, within: u64) -> u64 {
    let mut bits = touched & within;
    loop {
        let spread = (bits | bits << 1 | bits >> 1) & within;
        if spread == bits {
            return bits;
        }
        bits = spread;
    }
}

/// The face that a voxel is part of: voxels of its class in one plane, connected by sides, each with nothing
/// in front of it. `normal` is the outward direction, one entry of +1 or -1. Empty if the voxel shows no face.
pub fn face(grid: &VoxelGrid, start: VoxelIndex, normal: [i32; 3]) -> Vec<VoxelIndex> {
    let normal = IVec3::from_array(normal);
    let Some(axis) = (0..3).find(|a| normal[*a].abs() == 1 && normal.abs().element_sum() == 1) else {
        return Vec::new();
    };
    let extent = grid.extent();
    if !holds(extent, start) {
        return Vec::new();
    }
    let get = |c: VoxelIndex| grid.get(c[0], c[1], c[2]);
    let class = get(start);
    // The rim of the grid is open too: the face shows there.
    let shows = |c: VoxelIndex| {
        get(c) == class && cell_at(extent, ivec(c) + normal).is_none_or(|front| get(front) == Class::FREE)
    };
    if class == Class::FREE || !shows(start) {
        return Vec::new();
    }
    let mut sides = [IVec3::X, IVec3::Y, IVec3::Z].to_vec();
    sides.remove(axis);
    let mut seen = vec![0u64; extent.columns()];
    let mut open = vec![start];
    seen[extent.index(start[0], start[1])] = 1 << start[2];
    let mut cells = Vec::new();
    while let Some(c) = open.pop() {
        cells.push(c);
        for step in sides.iter().flat_map(|s| [*s, -*s]) {
            if let Some(next) = cell_at(extent, ivec(c) + step)
                && let [x, y, z] = next
                && let word = &mut seen[extent.index(x, y)]
                && *word >> z & 1 == 0
                && shows(next)
            {
                *word |= 1 << z;
                open.push(next);
            }
        }
    }
    tidy(cells)
}

/// The voxels that change when a face is pulled out by `layers`: the free voxels in front of it, which are filled (a
/// column ends at the first that is not free), or, for negative layers, the voxels that are taken away.
pub fn extrude(grid: &VoxelGrid, face: &[VoxelIndex], normal: [i32; 3], layers: i32) -> Vec<VoxelIndex> {
    let normal = IVec3::from_array(normal);
    let extent = grid.extent();
    let limit = extent.nx().max(extent.ny()) as i32;
    let layers = layers.clamp(-limit, limit);
    let mut cells = Vec::new();
    for &c in face {
        if layers > 0 {
            let front = (1..=layers).map_while(|i| cell_at(extent, ivec(c) + normal * i));
            cells.extend(front.take_while(|c| grid.get(c[0], c[1], c[2]) == Class::FREE));
        } else {
            let behind = (0..-layers).map_while(|i| cell_at(extent, ivec(c) - normal * i));
            cells.extend(behind.take_while(|c| grid.get(c[0], c[1], c[2]) != Class::FREE));
        }
    }
    tidy(cells)
}

/// The voxels and their mirror images about the ego x axis, as far as the map has them.
pub fn mirrored(extent: Extent, cells: &[VoxelIndex]) -> Vec<VoxelIndex> {
    // Columns count from the lower corner, which lies to the right of the axis or to the left.
    let sum = -1 - 2 * i64::from(extent.from()[1]);
    let image = |[x, y, z]: &VoxelIndex| {
        let y = usize::try_from(sum - *y as i64).ok()?;
        (y < extent.ny()).then_some([*x, y, *z])
    };
    tidy(
        cells
            .iter()
            .copied()
            .chain(cells.iter().filter_map(image))
            .collect(),
    )
}

/// Only the free voxels, or only those that are not; those outside the grid go.
pub fn only(grid: &VoxelGrid, cells: Vec<VoxelIndex>, free: bool) -> Vec<VoxelIndex> {
    let extent = grid.extent();
    let fits = |c: &VoxelIndex| holds(extent, *c) && (grid.get(c[0], c[1], c[2]) == Class::FREE) == free;
    cells.into_iter().filter(fits).collect()
}

/// Edits that lock voxels as they are: each is painted in the class that it has.
pub fn lock(frame: &Frame, cells: &[VoxelIndex]) -> Vec<Edit> {
    let mut by_class: BTreeMap<u8, Vec<VoxelIndex>> = BTreeMap::new();
    let extent = frame.occupancy.extent();
    for &[x, y, z] in cells.iter().filter(|c| holds(extent, **c)) {
        let class = frame.occupancy.get(x, y, z);
        by_class.entry(class).or_default().push([x, y, z]);
    }
    let edit = |(id, cells): (u8, Vec<VoxelIndex>)| {
        Class::from_id(id).map(|class| Edit::PaintVoxels { cells, class })
    };
    by_class.into_iter().filter_map(edit).collect()
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::Document;
    use scene::{BevLayout, Scene};

    fn grid() -> VoxelGrid {
        let mut grid = VoxelGrid::new();
        // A wall of 4 x 1 x 3 with a hole in its top row, on ground of 10 x 10.
        for [x, y, z] in between(Extent::WINDOW, [100, 100, 0], [109, 109, 0]) {
            grid.set(x, y, z, Class::Terrain.id());
        }
        for [x, y, z] in between(Extent::WINDOW, [102, 103, 1], [105, 103, 3]) {
            grid.set(x, y, z, Class::Manmade.id());
        }
        grid.set(104, 103, 3, Class::FREE);
        grid
    }

    #[test]
    fn boxes_and_lines() {
        assert_eq!(between(Extent::WINDOW, [5, 7, 2], [3, 9, 2]).len(), 9);
        assert_eq!(
            between(Extent::WINDOW, [0; 3], [usize::MAX; 3]).len(),
            Extent::WINDOW.voxels()
        );
        let diagonal = line(Extent::WINDOW, [0, 0, 0], [9, 4, 2], 1);
        assert_eq!(diagonal.len(), 10);
        assert!(diagonal.contains(&[9, 4, 2]) && diagonal.contains(&[0, 0, 0]));
        for pair in diagonal.windows(2) {
            assert!((ivec(pair[1]) - ivec(pair[0])).abs().max_element() == 1);
        }
        assert_eq!(line(Extent::WINDOW, [3, 3, 3], [3, 3, 3], 1), [[3, 3, 3]]);
        // A thick one is cut at the rim.
        assert_eq!(line(Extent::WINDOW, [0, 0, 15], [0, 0, 15], 3).len(), 2 * 2);
    }

    #[test]
    fn the_wand_takes_one_class_by_faces() {
        let grid = grid();
        assert_eq!(connected(&grid, [102, 103, 2]).len(), 11);
        assert_eq!(connected(&grid, [100, 100, 0]).len(), 100);
        assert!(connected(&grid, [0, 0, 5]).is_empty() && connected(&grid, [200, 0, 0]).is_empty());
    }

    #[test]
    fn faces_are_pulled_out_and_pushed_in() {
        let grid = grid();
        let front = face(&grid, [103, 103, 2], [0, -1, 0]);
        assert_eq!(front.len(), 11);
        assert_eq!(extrude(&grid, &front, [0, -1, 0], 2).len(), 22);
        assert_eq!(extrude(&grid, &front, [0, -1, 0], -1), front);
        assert_eq!(
            extrude(&grid, &front, [0, -1, 0], -5),
            front,
            "the wall is one thick"
        );
        let top = face(&grid, [102, 103, 3], [0, 0, 1]);
        assert_eq!(top, [[102, 103, 3], [103, 103, 3]]);
        assert_eq!(
            extrude(&grid, &top, [0, 0, 1], 1000).len(),
            2 * 12,
            "up to the top of the grid"
        );
        assert!(face(&grid, [103, 103, 1], [0, 0, 1]).is_empty(), "covered");
        assert!(
            face(&grid, [103, 103, 1], [0, 1, 1]).is_empty() && face(&grid, [0; 3], [0, 0, 1]).is_empty()
        );
    }

    #[test]
    fn mirror_images_and_filters() {
        assert_eq!(mirrored(Extent::WINDOW, &[[3, 0, 1]]), [[3, 0, 1], [3, 199, 1]]);
        let grid = grid();
        let cells = between(Extent::WINDOW, [100, 103, 0], [109, 103, 3]);
        assert_eq!(only(&grid, cells.clone(), false).len(), 10 + 11);
        assert_eq!(only(&grid, cells, true).len(), 40 - 21);
        assert!(only(&grid, vec![[500, 0, 0]], true).is_empty());
    }

    #[test]
    fn the_whole_grid_is_one_step_and_locks_keep_what_is_there() {
        let frame = Frame::new(BevLayout::default(), BTreeMap::new(), grid());
        let mut document = Document::new(Scene::single("all", frame, Arc::default(), 1));
        let wall = connected(&document.scene().frame().occupancy, [102, 103, 2]);
        let before = document.scene().frame().occupancy.clone();
        let locks = lock(document.scene().frame(), &wall);
        document.apply_all("Lock", &locks).expect("sound");
        assert_eq!(document.scene().frame().occupancy, before);
        assert_eq!(document.scene().frame().painted.count_set(), 11);
        let cells = between(Extent::WINDOW, [0; 3], [usize::MAX; 3]);
        let class = Class::Manmade;
        document
            .apply("Fill", &Edit::PaintVoxels { cells, class })
            .expect("sound");
        assert_eq!(
            document.scene().frame().occupancy.count_set(),
            Extent::WINDOW.voxels()
        );
        assert_eq!(document.undo(), Some("Fill"));
        assert_eq!(document.scene().frame().occupancy, before);
    }
}
