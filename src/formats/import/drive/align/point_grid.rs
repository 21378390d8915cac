//! Points in a grid of cubes: thinning, and the neighbours of a place.

use glam::{DVec3, IVec3};

/// Most cubes of a grid: places far from the others are left out of a larger one.
const MOST_CUBES: f64 = 8e6;

/// Points, sorted by the cube that they lie in.
#[derive(Default)]
pub(super) struct PointGrid {
    low_m: DVec3,
    cube_m: f64,
    cubes: IVec3,
    /// Where the points of a cube begin in `order`; one more at the end.
    starts: Vec<u32>,
    order: Vec<u32>,
}

impl PointGrid {
    /// A grid of these points, which the caller keeps, in cubes of this width, m. Points beyond [`MOST_CUBES`] are not found.
    pub(super) fn new(points: &[DVec3], cube_m: f64) -> Self {
        let low_m = points.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let high_m = points.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
        let side = |axis: usize| ((high_m[axis] - low_m[axis]) / cube_m).min(1e6) as i32 + 1;
        let cubes = IVec3::from_array([0, 1, 2].map(side));
        let all = cubes.to_array().iter().map(|n| f64::from(*n)).product::<f64>();
        if points.is_empty() || all > MOST_CUBES {
            return Self::default();
        }
        let all = all as usize;
        let mut grid = Self {
            low_m,
            cube_m,
            cubes,
            starts: vec![0; all + 1],
            order: vec![0; points.len()],
        };
        let cube_of: Vec<usize> = points.iter().map(|p| grid.index(grid.cube(*p))).collect();
        cube_of.iter().for_each(|c| grid.starts[c + 1] += 1);
        for c in 0..all {
            grid.starts[c + 1] += grid.starts[c];
        }
        let mut next = grid.starts.clone();
        for (i, c) in cube_of.into_iter().enumerate() {
            grid.order[next[c] as usize] = i as u32;
            next[c] += 1;
        }
        grid
    }

    fn cube(&self, p: DVec3) -> IVec3 {
        ((p - self.low_m) / self.cube_m).floor().as_ivec3()
    }

    fn index(&self, cube: IVec3) -> usize {
        let [x, y, z] = cube.to_array().map(|n| n as usize);
        (x * self.cubes.y as usize + y) * self.cubes.z as usize + z
    }

    /// The points in the cubes up to `rings` from that of a place.
    pub(super) fn around(&self, p: DVec3, rings: i32) -> impl Iterator<Item = usize> + '_ {
        let middle = self.cube(p);
        let low = (middle - rings).max(IVec3::ZERO);
        let high = (middle + rings).min(self.cubes - 1);
        let rows = (low.x..=high.x).flat_map(move |x| (low.y..=high.y).map(move |y| (x, y)));
        rows.flat_map(move |(x, y)| {
            let [from, to] = match low.z <= high.z {
                true => [
                    self.starts[self.index(IVec3::new(x, y, low.z))],
                    self.starts[self.index(IVec3::new(x, y, high.z)) + 1],
                ],
                false => [0; 2],
            };
            self.order[from as usize..to as usize].iter().map(|i| *i as usize)
        })
    }

    /// The nearest of the points to a place within a distance, which is at most `rings` cubes.
    pub(super) fn nearest(&self, points: &[DVec3], p: DVec3, within_m: f64, rings: i32) -> Option<usize> {
        let mut best = (within_m * within_m, None);
        for i in self.around(p, rings) {
            let off = points[i].distance_squared(p);
            if off < best.0 {
                best = (off, Some(i));
            }
        }
        best.1
    }
}

/// The mean of the points of each cube of this width, m. Rings of a sweep, dense near the sensor, get the weight of what they show.
pub(super) fn thinned(points: &[DVec3], cube_m: f64) -> Vec<DVec3> {
    let cube = |p: &DVec3| (*p / cube_m).floor().as_ivec3().to_array();
    let mut by_cube: Vec<([i32; 3], u32)> = points
        .iter()
        .enumerate()
        .map(|(i, p)| (cube(p), i as u32))
        .collect();
    by_cube.sort_unstable();
    by_cube
        .chunk_by(|a, b| a.0 == b.0)
        .map(|same| same.iter().map(|(_, i)| points[*i as usize]).sum::<DVec3>() / same.len() as f64)
        .collect()
}

#[cfg(test)]
mod tests {
    use numeric::splitmix::SplitMix64;

    use super::*;

    #[test]
    fn the_nearest_is_that_of_all_points() {
        let mut random = SplitMix64::new(1);
        let mut place = |spread: f64| DVec3::new(random.unit(), random.unit(), random.unit() * 0.3) * spread;
        let points: Vec<DVec3> = (0..500).map(|_| place(10.0)).collect();
        let grid = PointGrid::new(&points, 0.5);
        for _ in 0..200 {
            let p = place(11.0) - 0.5;
            let found = grid.nearest(&points, p, 1.0, 2);
            let off = |i: &usize| points[*i].distance(p);
            let all = (0..points.len()).filter(|i| off(i) < 1.0);
            let expected = all.min_by(|a, b| off(a).total_cmp(&off(b)));
            assert_eq!(found, expected, "{p}");
        }
    }

    #[test]
    fn no_points_and_points_of_countries_are_no_grid() {
        assert_eq!(PointGrid::new(&[], 0.5).nearest(&[], DVec3::ZERO, 1.0, 2), None);
        let far = [DVec3::ZERO, DVec3::splat(1e7)];
        assert_eq!(PointGrid::new(&far, 0.5).nearest(&far, DVec3::ZERO, 1.0, 2), None);
    }

    #[test]
    fn thinned_points_are_means() {
        let points = [0.1, 0.2, -0.1].map(|x| DVec3::new(x, 0.1, 0.1));
        let found = thinned(&points, 0.25);
        assert_eq!(found.len(), 2);
        assert!(found[1].distance(DVec3::new(0.15, 0.1, 0.1)) < 1e-12, "{found:?}");
    }
}
