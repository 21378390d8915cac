//! Features of windows of 8 x 8 columns of occupancy, and of patches of 3 x 3 windows: class shares, patterns of 2 x 2
//! columns and of 2 x 2 x 2 voxels (the borders of masks: edges, corners, thin lines), steps of height, runs, random
//! convolutions.

use super::Windows;
use super::random::{Bank, FeatureMapView, normal};
use scene::{Class, VoxelGrid, Window};
use world::draw::Draw;

/// Columns of a window along each side.
pub const WINDOW: usize = 8;
/// Windows of a frame along each side.
pub const SIDE: usize = Window::NX / WINDOW;
/// Windows of a patch along each side.
const PATCH: usize = 3;

const NY: usize = Window::NY;
const NZ: usize = Window::NZ;
/// Channels of a column for the random convolutions, and their filters.
const CHANNELS: usize = 8;
const FILTERS: usize = 32;

/// Masks of columns whose 2 x 2 patterns are counted.
const MASKS: [&str; 6] = ["manmade", "vegetation", "road", "sidewalk", "terrain", "object"];
const PATTERNS: [&str; 5] = ["corner", "edge", "diagonal", "notch", "inside"];
const STEPS: [&str; 4] = ["level", "step of 1", "step of 2 or 3", "step above 3"];
const RUNS: [&str; 4] = [
    "manmade runs",
    "vegetation runs",
    "class changes",
    "empty columns",
];
const OCTANTS: usize = 7;

/// Masks, occupancy, tops and runs of one column.
#[derive(Clone, Copy, Default)]
struct ColumnFeatures {
    masks: u8,
    occupied: u16,
    tops: [Option<u8>; 2], // of manmade, of vegetation
    runs: [u8; 4],
}

impl ColumnFeatures {
    fn from_labels(labels: &[u8; NZ]) -> Self {
        let mut out = Self::default();
        let mut below = Class::FREE;
        for (z, label) in labels.iter().enumerate() {
            let class = Class::from_id(*label).unwrap_or(Class::Others);
            let bit = match class {
                Class::Free => 0,
                Class::Manmade => 1,
                Class::Vegetation => 2,
                Class::DriveableSurface => 4,
                Class::Sidewalk => 8,
                Class::Terrain | Class::OtherFlat => 16,
                _ => 32,
            };
            out.masks |= bit;
            out.occupied |= u16::from(bit != 0) << z;
            if bit == 1 || bit == 2 {
                out.tops[bit as usize - 1] = Some(z as u8);
                out.runs[bit as usize - 1] += u8::from(below != *label);
            }
            out.runs[2] += u8::from(below != *label);
            below = *label;
        }
        out.runs[3] = u8::from(out.masks == 0);
        out
    }
}

/// Names of the features of a window, in their order.
pub fn names() -> Vec<String> {
    let mut out: Vec<String> = Class::ALL[..17]
        .iter()
        .map(|c| format!("{} voxels", c.label()))
        .collect();
    for mask in MASKS {
        out.extend(PATTERNS.iter().map(|p| format!("{mask} {p}")));
    }
    for what in ["roof", "treetop"] {
        out.extend(STEPS.iter().map(|s| format!("{what} {s}")));
    }
    out.extend(RUNS.iter().map(|r| (*r).to_owned()));
    out.extend((1..=OCTANTS).map(|n| format!("{n} of 2x2x2 voxels")));
    out.extend((0..FILTERS).map(|n| format!("random filter {n}")));
    out
}

/// Features of the 25 x 25 windows of a frame, row by row; in the order of [`names`].
pub fn windows(grid: &VoxelGrid) -> Windows {
    let columns: Vec<ColumnFeatures> = (0..Window::COLUMNS)
        .map(|c| ColumnFeatures::from_labels(grid.window_column(c / NY, c % NY)))
        .collect();
    let by_chance = convolved(grid);
    let each = by_chance.into_iter().enumerate().map(|(i, by_chance)| {
        let mut out = by_hand(grid, &columns, i / SIDE * WINDOW, i % SIDE * WINDOW);
        out.extend(by_chance);
        out
    });
    each.collect()
}

fn convolved(grid: &VoxelGrid) -> Windows {
    let mut draw = Draw::new(1, "columns of random convolutions");
    let embedding: Vec<f32> = (0..NZ * Class::COUNT * CHANNELS)
        .map(|_| normal(&mut draw) as f32)
        .collect();
    let mut data = vec![0.0f32; Window::COLUMNS * CHANNELS];
    for (x, y, z, label) in grid.iter_set() {
        let entry = (z * Class::COUNT + usize::from(label.min(Class::FREE))) * CHANNELS;
        let at = (x * NY + y) * CHANNELS;
        let sum = data[at..at + CHANNELS].iter_mut();
        sum.zip(&embedding[entry..entry + CHANNELS])
            .for_each(|(s, e)| *s += e);
    }
    let map = FeatureMapView {
        data: &data,
        rows: Window::NX,
        columns: NY,
    };
    Bank::new("occupancy", CHANNELS, 3, FILTERS).means(&map, [WINDOW, WINDOW])
}

/// All features except the convolutions of the window that starts at a column. Every figure is per column of the
/// window.
fn by_hand(grid: &VoxelGrid, columns: &[ColumnFeatures], x0: usize, y0: usize) -> Vec<f64> {
    let mut shares = [0u32; 17];
    let mut patterns = [[0u32; PATTERNS.len()]; MASKS.len()];
    let mut steps = [[0u32; STEPS.len()]; 2];
    let mut runs = [0u32; RUNS.len()];
    let mut octants = [0u32; OCTANTS];
    for x in x0..x0 + WINDOW {
        for y in y0..y0 + WINDOW {
            let c = x * NY + y;
            for label in grid.column(x, y) {
                if let Some(share) = shares.get_mut(usize::from(*label)) {
                    *share += 1;
                }
            }
            let own = columns[c];
            runs.iter_mut()
                .zip(own.runs)
                .for_each(|(sum, n)| *sum += u32::from(n));
            let right = (y + 1 < NY).then(|| columns[c + 1]);
            let ahead = (x + 1 < Window::NX).then(|| columns[c + NY]);
            for near in [right, ahead].into_iter().flatten() {
                for (of, steps) in steps.iter_mut().enumerate() {
                    if let (Some(a), Some(b)) = (own.tops[of], near.tops[of]) {
                        steps[[0, 1, 2, 2, 3][usize::from(a.abs_diff(b).min(4))]] += 1;
                    }
                }
            }
            let (Some(right), Some(ahead)) = (right, ahead) else {
                continue;
            };
            let across = columns[c + NY + 1];
            for (mask, counts) in patterns.iter_mut().enumerate() {
                let set = |c: ColumnFeatures| usize::from(c.masks >> mask & 1);
                let (pair, other) = (set(own) + set(across), set(right) + set(ahead));
                match pair + other {
                    0 => {}
                    2 if pair != 1 => counts[2] += 1,
                    n => counts[[0, 0, 1, 3, 4][n]] += 1,
                }
            }
            let quad = [own, right, ahead, across].map(|c| c.occupied);
            for z in 0..NZ - 1 {
                let n: u32 = quad.iter().map(|bits| (bits >> z & 3).count_ones()).sum();
                if (1..=OCTANTS as u32).contains(&n) {
                    octants[n as usize - 1] += 1;
                }
            }
        }
    }
    let all = shares
        .iter()
        .chain(patterns.iter().flatten())
        .chain(steps.iter().flatten())
        .chain(&runs)
        .chain(&octants);
    all.map(|n| f64::from(*n) / (WINDOW * WINDOW) as f64).collect()
}

/// Features of the 8 x 8 patches of 24 x 24 columns of a frame: mean and spread of each feature over a patch's windows.
pub fn patches(windows: &Windows) -> Windows {
    let across = SIDE / PATCH;
    let patch = |i: usize| {
        let (x0, y0) = (i / across * PATCH, i % across * PATCH);
        let inside: Vec<&Vec<f64>> = (x0..x0 + PATCH)
            .flat_map(|x| (y0..y0 + PATCH).map(move |y| x * SIDE + y))
            .filter_map(|w| windows.get(w))
            .collect();
        let n = inside.len().max(1) as f64;
        let width = inside.first().map_or(0, |w| w.len());
        let mean: Vec<f64> = (0..width)
            .map(|f| inside.iter().map(|w| w[f]).sum::<f64>() / n)
            .collect();
        let spread =
            (0..width).map(|f| (inside.iter().map(|w| (w[f] - mean[f]).powi(2)).sum::<f64>() / n).sqrt());
        let spread: Vec<f64> = spread.collect();
        [mean, spread].concat()
    };
    (0..across * across).map(patch).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_of_a_block_and_of_its_shards() {
        let mut block = VoxelGrid::new();
        for x in 2..6 {
            for y in 2..6 {
                block.column_mut(x, y)[..4].fill(Class::Manmade.id());
            }
        }
        let names = names();
        let of = |grid: &VoxelGrid, name: &str| {
            let found = windows(grid);
            assert_eq!((found.len(), found[0].len()), (SIDE * SIDE, names.len()));
            let at = names.iter().position(|n| n == name).expect("a name");
            (found[0][at] * 64.0).round()
        };
        assert_eq!(of(&block, "manmade voxels"), 64.0);
        assert_eq!(of(&block, "manmade corner"), 4.0);
        assert_eq!(of(&block, "manmade edge"), 12.0);
        assert_eq!(of(&block, "manmade inside"), 9.0);
        assert_eq!(of(&block, "roof level"), 24.0);
        assert_eq!(of(&block, "empty columns"), 48.0);
        let mut shards = block.clone();
        shards.column_mut(3, 3)[..].fill(Class::FREE);
        shards.set(4, 4, 3, Class::FREE);
        assert_eq!(of(&shards, "manmade notch"), 4.0);
        assert_eq!(of(&shards, "roof step of 1"), 4.0);
        let mut diagonal = VoxelGrid::new();
        diagonal.set(2, 2, 0, Class::Sidewalk.id());
        diagonal.set(3, 3, 5, Class::Sidewalk.id());
        assert_eq!(of(&diagonal, "sidewalk diagonal"), 1.0);
        assert_eq!(of(&diagonal, "1 of 2x2x2 voxels"), 4.0 + 4.0 + 4.0);
        let patches = patches(&windows(&block));
        assert_eq!((patches.len(), patches[0].len()), (64, 2 * names.len()));
        assert!(patches.iter().flatten().all(|v| v.is_finite()));
    }
}
