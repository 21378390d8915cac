//! Manmade voxels seen from above: length of their edges, number of parts, evenness of roofs.

use super::{ShapeFigures, share};
use numeric::quantile::median;
use scene::{Class, VoxelGrid, Window};

/// Sides that face a column without manmade, per manmade column: 0 inside, 4 for a post.
pub const EDGE: &str = "edge_per_manmade_column";
/// Groups of manmade columns that touch by a side or a corner.
pub const PARTS: &str = "manmade_parts";
/// Median size of these groups in columns.
pub const PART_COLUMNS: &str = "manmade_part_median_columns";
/// Share of the neighbouring pairs of manmade columns whose highest manmade voxels differ in height.
pub const ROOF_STEPS: &str = "roof_steps";

const NY: usize = Window::NY;

/// The highest manmade voxel of every column, `[x][y]`; `None` for columns without one.
pub fn tops(grid: &VoxelGrid) -> Vec<Option<usize>> {
    let top = |column: &[u8]| column.iter().rposition(|l| *l == Class::Manmade.id());
    (0..Window::COLUMNS)
        .map(|c| top(grid.column(c / NY, c % NY)))
        .collect()
}

pub fn figures(grid: &VoxelGrid, out: &mut ShapeFigures) {
    let tops = tops(grid);
    let (mut edges, mut pairs, mut steps) = (0, 0, 0);
    for c in 0..Window::COLUMNS {
        let right = (c % NY + 1 < NY).then_some(c + 1);
        let ahead = (c / NY + 1 < Window::NX).then_some(c + NY);
        for near in [right, ahead].into_iter().flatten() {
            match (tops[c], tops[near]) {
                (None, None) => {}
                (Some(a), Some(b)) => {
                    pairs += 1;
                    steps += usize::from(a != b);
                }
                _ => edges += 1,
            }
        }
    }
    share(out, EDGE, edges, tops.iter().flatten().count());
    share(out, ROOF_STEPS, steps, pairs);
    let sizes = parts(tops.iter().map(Option::is_some).collect());
    out.insert(PARTS, sizes.len() as f64);
    if !sizes.is_empty() {
        out.insert(PART_COLUMNS, median(&sizes));
    }
}

/// Sizes of the groups of columns that touch by a side or a corner.
fn parts(mut inside: Vec<bool>) -> Vec<f64> {
    let mut sizes = Vec::new();
    for start in 0..inside.len() {
        if !std::mem::replace(&mut inside[start], false) {
            continue;
        }
        let (mut stack, mut size) = (vec![start], 0.0);
        while let Some(c) = stack.pop() {
            size += 1.0;
            let (x, y) = (c / NY, c % NY);
            for i in x.saturating_sub(1)..=(x + 1).min(Window::NX - 1) {
                for j in y.saturating_sub(1)..=(y + 1).min(NY - 1) {
                    if std::mem::replace(&mut inside[i * NY + j], false) {
                        stack.push(i * NY + j);
                    }
                }
            }
        }
        sizes.push(size);
    }
    sizes
}
