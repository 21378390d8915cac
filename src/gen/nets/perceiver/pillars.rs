//! Returns of a LiDAR as a map of columns: the input of the perceiver.

use nn::map::FeatureMap;
use scene::Window;

/// Bins of height.
const BINS: usize = 12;
/// Numbers of a column.
pub const PILLAR: usize = BINS + 7;
/// Start of the lowest bin, and height of each, m.
const BIN_LOW_M: f32 = -1.2;
const BIN_M: f32 = scene::Window::VOXEL_M as f32;
/// Range of heights, m; heights beyond count as its ends.
const HEIGHTS_M: [f32; 2] = [-3.0, 6.0];
/// Half the side of the window, m.
const HALF_M: f32 = 40.0;
const COLUMN_M: f32 = Window::VOXEL_M as f32;

/// Sums over the returns of a column.
#[derive(Clone, Copy)]
struct PillarSums {
    bins: [u32; BINS],
    count: u32,
    heights_m: [f32; 2],
    strength: f32,
    offset: [f32; 2],
}

const EMPTY: PillarSums = PillarSums {
    bins: [0; BINS],
    count: 0,
    heights_m: [f32::INFINITY, f32::NEG_INFINITY],
    strength: 0.0,
    offset: [0.0; 2],
};

/// Returns (x, y, z in m in the ego frame, echo strength 0 to 255) as `[x][y][19]`, 200 x 200 columns. Of each column: log counts of twelve
/// bins of 0.4 m from 1.2 m below the frame's origin on (lower and higher ones go to the last), then highest and lowest (3 m), mean
/// strength (255), log count, mean place in the column (-0.5 to 0.5), and how far away the column is (40 m): the only one that an empty
/// one has. Returns that are not finite or outside the window are left out.
pub fn pillars(returns: impl IntoIterator<Item = [f32; 4]>) -> FeatureMap {
    let mut columns = vec![EMPTY; Window::COLUMNS];
    for point @ [x, y, z, strength] in returns {
        let at = [x, y].map(|v| (v + HALF_M) / COLUMN_M);
        let cell = at.map(f32::floor);
        let inside =
            cell[0] >= 0.0 && cell[0] < Window::NX as f32 && cell[1] >= 0.0 && cell[1] < Window::NY as f32;
        if !inside || point.iter().any(|v| !v.is_finite()) {
            continue;
        }
        let column = &mut columns[cell[0] as usize * Window::NY + cell[1] as usize];
        let z = z.clamp(HEIGHTS_M[0], HEIGHTS_M[1]);
        let bin = ((z - BIN_LOW_M) / BIN_M).floor().clamp(0.0, BINS as f32 - 1.0);
        column.bins[bin as usize] += 1;
        column.count += 1;
        column.heights_m = [column.heights_m[0].min(z), column.heights_m[1].max(z)];
        column.strength += strength / 255.0;
        for axis in 0..2 {
            column.offset[axis] += at[axis] - cell[axis] - 0.5;
        }
    }
    let mut data = Vec::with_capacity(Window::COLUMNS * PILLAR);
    for (i, column) in columns.iter().enumerate() {
        column.describe([i / Window::NY, i % Window::NY], &mut data);
    }
    FeatureMap {
        data,
        rows: Window::NX,
        columns: Window::NY,
        width: PILLAR,
    }
}

impl PillarSums {
    fn describe(&self, place: [usize; 2], into: &mut Vec<f32>) {
        let log = |count: u32| (count as f32).ln_1p() / 4.0;
        into.extend(self.bins.map(log));
        let count = self.count.max(1) as f32;
        let [low, high] = match self.count {
            0 => [0.0; 2],
            _ => self.heights_m.map(|z| z / 3.0),
        };
        into.extend([high, low, self.strength / count, log(self.count)]);
        into.extend(self.offset.map(|sum| sum / count));
        let [x, y] = place.map(|i| (i as f32 + 0.5) * COLUMN_M - HALF_M);
        into.push((x * x + y * y).sqrt() / HALF_M);
    }
}
