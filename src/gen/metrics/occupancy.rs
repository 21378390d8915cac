//! Statistics of a labelled grid: class mix, texture, thickness, holes. Used to compare simulated labels with known
//! figures of real ones (`assets/statistics/occ3d.json`).

use std::collections::BTreeMap;

use super::components::{components, flat};
use scene::{Class, Relief, VoxelGrid, Window};

const N: [usize; 3] = [Window::NX, Window::NY, Window::NZ];
/// Distance in the flat `[x][y][z]` array to the next voxel along each axis.
const STRIDE: [usize; 3] = [Window::NY * Window::NZ, Window::NZ, 1];
/// Number of voxels from which a component of cars counts as a well-seen car.
const WELL_SEEN: usize = 100;

/// Sums over frames, by name: (numerator, denominator).
#[derive(Clone, Debug, Default)]
pub struct OccupancyStatistics {
    sums: BTreeMap<String, (f64, f64)>,
}

impl OccupancyStatistics {
    /// Counts one frame.
    ///
    /// Heights are counted from the bin of the ground; `relief` is the ground that the labels were made on.
    pub fn add(&mut self, grid: &VoxelGrid, relief: &Relief) {
        let labels = flat(grid);
        let level = levelled(&labels, relief);
        self.class_mix(&labels);
        self.neighbours(&labels);
        self.vertical(&in_range(&level, relief));
        self.thickness(&labels);
        self.cars(&labels);
        for (cells, name) in [
            (2, "driveable.holes_closing_0.8m"),
            (5, "driveable.holes_closing_2.0m"),
        ] {
            let (holes, area) = road_holes(&level, cells);
            self.ratio(name, holes, area);
        }
    }

    /// Means over the frames so far: ratios of sums, so that a frame with more content counts more.
    pub fn means(&self) -> BTreeMap<&str, f64> {
        let means = self.sums.iter().filter(|(_, (_, n))| *n > 0.0);
        means.map(|(name, (sum, n))| (name.as_str(), sum / n)).collect()
    }

    /// Adds to the numerator and denominator of a ratio of counts.
    pub fn ratio(&mut self, name: &str, part: usize, whole: usize) {
        let (sum, n) = self.sums.entry(name.into()).or_default();
        *sum += part as f64;
        *n += whole as f64;
    }

    fn class_mix(&mut self, labels: &[u8]) {
        let mut counts = [0; Class::COUNT];
        labels.iter().for_each(|l| counts[usize::from(*l)] += 1);
        let occupied = labels.len() - counts[usize::from(Class::FREE)];
        self.ratio("occupied_fraction", occupied, labels.len());
        self.ratio("mean_occupied_voxels", occupied, 1);
        for class in &Class::ALL[..usize::from(Class::FREE)] {
            let name = format!("share_of_occupied.{}", class.name());
            self.ratio(&name, counts[usize::from(class.id())], occupied);
        }
        let road = counts[usize::from(Class::DriveableSurface.id())];
        self.ratio("driveable_voxels_per_frame", road, 1);
        let columns = labels.chunks_exact(Window::NZ);
        let held = columns.filter(|c| c.iter().any(|l| *l != Class::FREE)).count();
        self.ratio("nonempty_column_fraction", held, Window::COLUMNS);
    }

    fn neighbours(&mut self, labels: &[u8]) {
        let (vegetation, manmade) = (Class::Vegetation.id(), Class::Manmade.id());
        for_occupied(labels, |at, [x, y, z]| {
            let own = labels[at];
            let (mut six, mut same, mut all) = (0, 0, 0);
            for dx in -1..=1 {
                for dy in -1..=1 {
                    for dz in -1..=1 {
                        let near = label_at(labels, [x as isize + dx, y as isize + dy, z as isize + dz]);
                        let held = near != Class::FREE && (dx, dy, dz) != (0, 0, 0);
                        all += usize::from(held);
                        if held && dx.abs() + dy.abs() + dz.abs() == 1 {
                            six += 1;
                            same += usize::from(near == own);
                        }
                    }
                }
            }
            self.ratio("p_6_neighbour_occupied", six, 6);
            self.ratio("p_6_neighbour_same_class_given_occupied", same, six);
            self.ratio("isolated_voxel_fraction_26nb", usize::from(all == 0), 1);
            if own == vegetation {
                self.ratio("vegetation.density_26nb_mean_count", all, 1);
                self.ratio("vegetation.interior_fraction", usize::from(six == 6), 1);
            } else if own == manmade {
                self.ratio("manmade.interior_fraction", usize::from(six == 6), 1);
            }
        });
    }

    fn vertical(&mut self, labels: &[u8]) {
        let is_ground = |l: u8| Class::from_id(l).is_some_and(Class::is_ground);
        for column in labels.chunks_exact(Window::NZ) {
            // Runs of voxels that are not ground and touch neither end: a lone hit shows as a run of three.
            let mut run = 0;
            for (z, label) in column.iter().enumerate() {
                if *label != Class::FREE && !is_ground(*label) {
                    run += 1;
                } else {
                    if run > 0 && z > run {
                        self.ratio("nonground_vertical_runs_ge_3_share", usize::from(run >= 3), 1);
                        self.ratio(
                            "nonground_vertical_runs_exactly_3_share",
                            usize::from(run == 3),
                            1,
                        );
                    }
                    run = 0;
                }
            }
            let heights = |class: Class| {
                let bottom = column.iter().position(|l| *l == class.id())?;
                let top = column.iter().rposition(|l| *l == class.id())?;
                Some((bottom, top))
            };
            if let Some((bottom, top)) = heights(Class::Vegetation) {
                let held = column.iter().filter(|l| **l == Class::Vegetation.id()).count();
                // A mean over columns: each column counts once.
                let (sum, n) = self
                    .sums
                    .entry("vegetation.column_fill_between_bottom_and_top".into())
                    .or_default();
                *sum += held as f64 / (top - bottom + 1) as f64;
                *n += 1.0;
            }
            if let Some((bottom, _)) = heights(Class::Car) {
                self.ratio("car.columns_reaching_bin_0", usize::from(bottom == 0), 1);
            }
            for (z, label) in column.iter().enumerate() {
                if *label == Class::Sidewalk.id() {
                    self.ratio("sidewalk.share_in_bin_0", usize::from(z == 0), 1);
                }
            }
        }
    }

    /// The shorter of the x-run and the y-run through a voxel.
    fn thickness(&mut self, labels: &[u8]) {
        for_occupied(labels, |at, place| {
            let own = labels[at];
            let run = |axis: usize| {
                let forward = (1..N[axis] - place[axis]).take_while(|i| labels[at + i * STRIDE[axis]] == own);
                let back = (1..=place[axis]).take_while(|i| labels[at - i * STRIDE[axis]] == own);
                1 + forward.count() + back.count()
            };
            if own == Class::Manmade.id() {
                let thin = run(0).min(run(1)) <= 2;
                self.ratio("manmade.horizontal_thickness_share_1_or_2", usize::from(thin), 1);
            } else if own == Class::Vegetation.id() {
                let thin = run(0).min(run(1)) == 1;
                self.ratio("vegetation.horizontal_thickness_share_1", usize::from(thin), 1);
            }
        });
    }

    fn cars(&mut self, labels: &[u8]) {
        for car in components(labels.iter().map(|l| *l == Class::Car.id()).collect()) {
            if car.len() < WELL_SEEN {
                continue;
            }
            let mut columns: Vec<usize> = car.iter().map(|at| at / Window::NZ).collect();
            columns.sort_unstable();
            columns.dedup();
            let heights = || car.iter().map(|at| at % Window::NZ);
            let (low, high) = (heights().min().unwrap_or(0), heights().max().unwrap_or(0));
            self.ratio("car.voxels_per_well_seen_car", car.len(), 1);
            self.ratio(
                "car.fill_of_footprint_times_height",
                car.len(),
                columns.len() * (high - low + 1),
            );
        }
    }
}

fn for_occupied(labels: &[u8], mut visit: impl FnMut(usize, [usize; 3])) {
    for (at, label) in labels.iter().enumerate() {
        if *label != Class::FREE {
            visit(at, [at / STRIDE[0], at / STRIDE[1] % N[1], at % N[2]]);
        }
    }
}

/// Label at a place; free outside the grid.
fn label_at(labels: &[u8], place: [isize; 3]) -> u8 {
    let inside = place.iter().zip(N).all(|(p, n)| (0..n as isize).contains(p));
    if inside {
        labels[place
            .iter()
            .zip(STRIDE)
            .map(|(p, s)| *p as usize * s)
            .sum::<usize>()]
    } else {
        Class::FREE
    }
}

/// Levelled labels without the columns whose ground lies below the grid's lowest bin: no height is known there.
fn in_range(level: &[u8], relief: &Relief) -> Vec<u8> {
    let mut out = level.to_vec();
    for (c, column) in out.chunks_exact_mut(Window::NZ).enumerate() {
        if relief.column_m(c / Window::NY, c % Window::NY) < -Window::VOXEL_M / 2.0 {
            column.fill(Class::FREE);
        }
    }
    out
}

/// Labels with every column lowered by the bin that its ground lies in.
fn levelled(labels: &[u8], relief: &Relief) -> Vec<u8> {
    let mut out = labels.to_vec();
    if relief.is_flat() {
        return out;
    }
    for (c, column) in out.chunks_exact_mut(Window::NZ).enumerate() {
        let down = scene::Lattice::OCC3D.ground_bin(relief.column_m(c / Window::NY, c % Window::NY));
        column[..down].fill(Class::FREE);
        column.rotate_left(down);
    }
    out
}

/// Number of columns inside the road, closed with a disc of `radius` columns, that hold nothing in bin 0; and the
/// number of columns of the closed road. The area outside the grid does not limit the closing.
fn road_holes(labels: &[u8], radius: usize) -> (usize, usize) {
    let pad = 2 * radius;
    let (rows, columns) = (N[0] + 2 * pad, N[1] + 2 * pad);
    let mut road = vec![false; rows * columns];
    for c in 0..Window::COLUMNS {
        let held = labels[c * Window::NZ] == Class::DriveableSurface.id();
        road[(c / N[1] + pad) * columns + c % N[1] + pad] = held;
    }
    let r = radius as isize;
    let disc: Vec<(isize, isize)> = (-r..=r)
        .flat_map(|dx| (-r..=r).map(move |dy| (dx, dy)))
        .filter(|(dx, dy)| dx * dx + dy * dy <= r * r)
        .collect();
    // Grows the cells equal to `from` by the disc.
    let grow = |map: &[bool], from: bool| {
        let mut out = map.to_vec();
        for x in radius..rows - radius {
            for y in radius..columns - radius {
                if map[x * columns + y] == from {
                    for (dx, dy) in &disc {
                        let at = (x as isize + dx) as usize * columns + (y as isize + dy) as usize;
                        out[at] = from;
                    }
                }
            }
        }
        out
    };
    let closed = grow(&grow(&road, true), false);
    let (mut holes, mut area) = (0, 0);
    for c in 0..Window::COLUMNS {
        if closed[(c / N[1] + pad) * columns + c % N[1] + pad] {
            area += 1;
            holes += usize::from(labels[c * Window::NZ] == Class::FREE);
        }
    }
    (holes, area)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn means(grid: &VoxelGrid) -> BTreeMap<String, f64> {
        let mut statistics = OccupancyStatistics::default();
        statistics.add(grid, &Relief::FLAT);
        let means = statistics.means();
        means.into_iter().map(|(k, v)| (k.to_string(), v)).collect()
    }

    #[test]
    fn a_scene_counted_by_hand() {
        let mut grid = VoxelGrid::new();
        // A road of 20 x 20 columns with one hole, a wall two thick, a lone leaf in the air.
        for x in 50..70 {
            for y in 50..70 {
                grid.set(x, y, 0, Class::DriveableSurface.id());
            }
        }
        grid.set(60, 60, 0, Class::FREE);
        for x in 100..102 {
            for y in 100..110 {
                for z in 2..6 {
                    grid.set(x, y, z, Class::Manmade.id());
                }
            }
        }
        grid.set(150, 150, 8, Class::Vegetation.id());
        let m = means(&grid);
        let occupied = 399.0 + 80.0 + 1.0;
        assert_eq!(m["mean_occupied_voxels"], occupied);
        assert_eq!(m["share_of_occupied.manmade"], 80.0 / occupied);
        assert_eq!(m["isolated_voxel_fraction_26nb"], 1.0 / occupied);
        assert_eq!(m["manmade.horizontal_thickness_share_1_or_2"], 1.0);
        assert_eq!(m["manmade.interior_fraction"], 0.0);
        assert_eq!(m["vegetation.horizontal_thickness_share_1"], 1.0);
        // Twenty runs of four in the wall, one of one voxel.
        assert_eq!(m["nonground_vertical_runs_ge_3_share"], 20.0 / 21.0);
        assert_eq!(m["driveable.holes_closing_0.8m"], 1.0 / 400.0);
        assert_eq!(m["nonempty_column_fraction"], (399.0 + 20.0 + 1.0) / 40_000.0);
        assert!(!m.contains_key("car.columns_reaching_bin_0"));
    }

    #[test]
    fn a_car_is_a_component() {
        let mut grid = VoxelGrid::new();
        for x in 0..10 {
            for y in 0..5 {
                for z in 0..if x < 5 { 4 } else { 2 } {
                    grid.set(x, y, z, Class::Car.id());
                }
            }
        }
        let m = means(&grid);
        assert_eq!(m["car.voxels_per_well_seen_car"], 150.0);
        assert_eq!(m["car.fill_of_footprint_times_height"], 150.0 / 200.0);
        assert_eq!(m["car.columns_reaching_bin_0"], 1.0);
        assert!(means(&VoxelGrid::new()).contains_key("occupied_fraction"));
    }
}
