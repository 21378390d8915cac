//! Connected groups of voxels (26 neighbours), as flat indices of `[x][y][z]`.

use scene::{VoxelGrid, Window};

const N: [usize; 3] = [Window::NX, Window::NY, Window::NZ];

/// Labels `[x][y][z]`, z fastest.
pub fn flat(grid: &VoxelGrid) -> Vec<u8> {
    let columns = (0..Window::COLUMNS).map(|c| grid.column(c / Window::NY, c % Window::NY));
    columns.flatten().copied().collect()
}

/// Column and bin of a flat index.
pub fn place(at: usize) -> [usize; 3] {
    [at / (N[1] * N[2]), at / N[2] % N[1], at % N[2]]
}

/// The up to 26 voxels around one.
pub fn around(at: usize) -> impl Iterator<Item = usize> {
    let [x, y, z] = place(at);
    let span = |v: usize, n: usize| v.saturating_sub(1)..=(v + 1).min(n - 1);
    let (ys, zs) = (span(y, N[1]), span(z, N[2]));
    span(x, N[0])
        .flat_map(move |i| ys.clone().map(move |j| (i * N[1] + j) * N[2]))
        .flat_map(move |column| zs.clone().map(move |k| column + k))
        .filter(move |near| *near != at)
}

/// All voxels inside that are connected to `group`, with `group` itself, which is inside too. Takes them out of
/// `inside`.
pub fn spread(inside: &mut [bool], mut group: Vec<usize>) -> Vec<usize> {
    group.iter().for_each(|at| inside[*at] = false);
    let mut next = 0;
    while let Some(&at) = group.get(next) {
        next += 1;
        for near in around(at) {
            if std::mem::replace(&mut inside[near], false) {
                group.push(near);
            }
        }
    }
    group
}

/// Connected groups of the voxels inside, in the order of their first voxels.
pub fn components(mut inside: Vec<bool>) -> Vec<Vec<usize>> {
    let mut out = Vec::new();
    for start in 0..inside.len() {
        if inside[start] {
            out.push(spread(&mut inside, vec![start]));
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_touch_by_corners_and_end_at_gaps() {
        let at = |x: usize, y: usize, z: usize| (x * N[1] + y) * N[2] + z;
        let mut inside = vec![false; Window::VOXELS];
        for voxel in [at(5, 5, 5), at(6, 6, 6), at(8, 6, 6), at(0, 199, 15), at(1, 0, 0)] {
            inside[voxel] = true;
        }
        let found = components(inside);
        assert_eq!(found.len(), 4, "{found:?}");
        assert_eq!(found[2], vec![at(5, 5, 5), at(6, 6, 6)]);
        assert_eq!(place(at(6, 7, 8)), [6, 7, 8]);
        assert_eq!(
            (around(at(0, 0, 0)).count(), around(at(9, 9, 9)).count()),
            (7, 26)
        );
    }
}
