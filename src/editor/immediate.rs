//! Makes an edit visible in the voxels at once: clears or stamps boxes, lays ground. Generation soon replaces this rough
//! version. Painted voxels are locked and never touched.

use glam::{DVec2, DVec3};

use scene::clip::MARGIN_M;
use scene::draft::{box_columns, ground_bin, ground_class};
use scene::grid::NOT_PAINTED;
use scene::raster::box_cells;
use scene::{BevLayer, BevLayout, Class, Extent, Frame, SceneBox, VoxelGrid};

/// Bins above the ground's own in which ground classes may lie in Occ3D labels: a kerb's second bin, a bumpy verge.
const GROUND_BINS: usize = 2;
/// How far around a column without layout ground is searched for, columns.
const MAX_REACH: usize = 24;

/// Clears the voxels of a box that has just left `frame.boxes`, and lays ground where they stood.
/// Voxels that lie nearer to another box of the same class stay.
pub(super) fn clear_box(frame: &mut Frame, old: &SceneBox) {
    let class = old.class.id();
    let others: Vec<SceneBox> = frame
        .boxes
        .values()
        .filter(|b| b.class == old.class && b.id != old.id && near(b, old))
        .copied()
        .collect();
    let extent = frame.extent();
    let top_m = old.center_m.z + old.size_m.z / 2.0 + MARGIN_M;
    let mut emptied = Vec::new();
    box_cells(extent, old, MARGIN_M, |x, y| {
        if others
            .iter()
            .any(|b| outside_m(extent, b, x, y) <= outside_m(extent, old, x, y))
        {
            return;
        }
        let painted = frame.painted.column(x, y);
        let mut column = frame.occupancy.column(x, y).to_vec();
        for z in 0..column.len() {
            let inside = extent.center(x, y, z).z <= top_m;
            if inside && column[z] == class && painted[z] == NOT_PAINTED {
                column[z] = background(frame.source.occupancy.get(x, y, z));
                if z == ground_bin(&frame.layout, x, y) && column[z] == Class::FREE {
                    emptied.push([x, y]);
                }
            }
        }
        if column != frame.occupancy.column(x, y) {
            frame.occupancy.column_mut(x, y).copy_from_slice(&column);
        }
    });
    refill_ground(&mut frame.occupancy, &frame.layout, &emptied);
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
        let painted = frame.painted.column(x, y);
        let ground = ground_bin(&frame.layout, x, y).min(layers - 1);
        for (z, locked) in painted.iter().enumerate().take(layers).skip(ground) {
            if *locked == NOT_PAINTED {
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
}
