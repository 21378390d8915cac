//! Distances between sets of LiDAR sweeps as LidarDM defines them (Zyrianov et al. 2024, arXiv 2404.02903), on occupied
//! voxels seen from above: JSD of the maps' sum, MMD between single maps.

use super::MetricError;
use super::kernel::{Kernel, mmd2_biased};

/// Number of voxels along x and y, and along z.
const VOXELS: [usize; 2] = [640, 35];
/// Lower corner in the sensor frame, m, and edges of a voxel.
const LOWER_M: [f64; 3] = [-50.0, -50.0, -3.23];
const EDGE_M: [f64; 3] = [0.15625, 0.15625, 0.2];
/// Cells of the averaged map along each axis.
const SIDE: usize = 100;
/// Bandwidth of the kernel between maps.
const BANDWIDTH: f64 = 0.5;

/// A sweep from above: mean number of occupied voxels (of 0.156 x 0.156 x 0.2 m) per column, averaged to 1 m cells.
pub fn bird_map(points_in_sensor: impl IntoIterator<Item = [f64; 3]>) -> Vec<f64> {
    let [wide, high] = VOXELS;
    let mut occupied = vec![0u64; wide * wide]; // one bit per height
    for p in points_in_sensor {
        let at: [f64; 3] = std::array::from_fn(|a| ((p[a] - LOWER_M[a]) / EDGE_M[a]).floor());
        let inside = |a: usize, n: usize| at[a] >= 0.0 && at[a] < n as f64;
        if inside(0, wide) && inside(1, wide) && inside(2, high) {
            occupied[at[0] as usize * wide + at[1] as usize] |= 1 << at[2] as u64;
        }
    }
    // Adaptive average pooling: cell i covers columns floor(i w / n) to ceil((i + 1) w / n).
    let span = |i: usize| i * wide / SIDE..((i + 1) * wide).div_ceil(SIDE);
    let mut map = Vec::with_capacity(SIDE * SIDE);
    for i in 0..SIDE {
        for j in 0..SIDE {
            let columns = span(i).flat_map(|x| span(j).map(move |y| x * wide + y));
            let counts = columns.map(|c| f64::from(occupied[c].count_ones()));
            map.push(counts.sum::<f64>() / (span(i).len() * span(j).len()) as f64);
        }
    }
    map
}

/// Jensen-Shannon divergence in nats of two histograms, which are normalised first; 0 to ln 2. Two empty histograms
/// have 0, an empty and a non-empty one ln 2. Negative and NaN counts are taken as 0.
pub fn js_divergence(p: &[f64], q: &[f64]) -> f64 {
    let clean = |v: f64| if v > 0.0 && v.is_finite() { v } else { 0.0 };
    let sum = |h: &[f64]| h.iter().map(|v| clean(*v)).sum::<f64>();
    let (of_p, of_q) = (sum(p), sum(q));
    if of_p == 0.0 || of_q == 0.0 {
        return if of_p == of_q { 0.0 } else { std::f64::consts::LN_2 };
    }
    let mut total = 0.0;
    for (a, b) in p.iter().zip(q) {
        let (a, b) = (clean(*a) / of_p, clean(*b) / of_q);
        let m = (a + b) / 2.0;
        // 0 log 0 is 0.
        let term = |v: f64| if v > 0.0 { v * (v / m).ln() } else { 0.0 };
        total += (term(a) + term(b)) / 2.0;
    }
    total.clamp(0.0, std::f64::consts::LN_2)
}

/// LidarDM's JSD of two sets of maps: root of the divergence of their sums.
pub fn jsd(x: &[Vec<f64>], y: &[Vec<f64>]) -> f64 {
    let sum = |maps: &[Vec<f64>]| {
        let mut all = vec![0.0; SIDE * SIDE];
        for map in maps {
            all.iter_mut().zip(map).for_each(|(a, v)| *a += v);
        }
        all
    };
    js_divergence(&sum(x), &sum(y)).sqrt()
}

/// LidarDM's MMD: every map normalised to a sum of 1, Gaussian kernel of bandwidth 0.5, V-statistic.
pub fn mmd(x: &[Vec<f64>], y: &[Vec<f64>]) -> Result<f64, MetricError> {
    let normalised = |maps: &[Vec<f64>]| -> Vec<Vec<f64>> {
        let one = |map: &Vec<f64>| {
            let sum: f64 = map.iter().sum();
            map.iter().map(|v| v / sum.max(1e-300)).collect()
        };
        maps.iter().map(one).collect()
    };
    let kernel = Kernel::Gaussian { bandwidth: BANDWIDTH };
    mmd2_biased(kernel, &normalised(x), &normalised(y))
}

#[cfg(test)]
mod tests {
    use super::super::reference::Reference;
    use super::*;

    /// Row 57 of the extremes table: SciPy 1.17.1, 1e-12 (reference/metrics.json); empty, disjoint and equal sets.
    #[test]
    fn row_57_jsd() {
        for case in Reference::open().array("jsd") {
            let numbers = |name: &str| -> Vec<f64> {
                let list = case[name].as_array().expect("a histogram");
                list.iter().map(|v| v.as_f64().expect("a number")).collect()
            };
            let found = js_divergence(&numbers("p"), &numbers("q"));
            let truth = case["divergence_nats"].as_f64().expect("a number");
            assert!(
                (found - truth).abs() <= 1e-12,
                "{}: {found}, expected {truth}",
                case["name"]
            );
            assert!((0.0..=std::f64::consts::LN_2 + 1e-12).contains(&found));
        }
        let some = [1.0, 2.0, 0.0];
        assert_eq!(js_divergence(&some, &some), 0.0);
        assert_eq!(js_divergence(&[0.0; 3], &[0.0; 3]), 0.0);
        assert_eq!(js_divergence(&[0.0; 3], &some), std::f64::consts::LN_2);
        assert!(js_divergence(&[f64::NAN, 1.0, f64::INFINITY], &some).is_finite());
    }

    #[test]
    fn a_map_counts_voxels_once_and_keeps_their_sum() {
        // Two points of one voxel, one above it, one outside.
        let points = [
            [0.05, 0.05, 0.0],
            [0.06, 0.06, 0.01],
            [0.05, 0.05, 1.0],
            [60.0, 0.0, 0.0],
        ];
        let map = bird_map(points);
        // Column 320 is in cell 50 alone, which averages 7 x 7 columns.
        assert_eq!(map.iter().filter(|v| **v > 0.0).count(), 1);
        assert!((map[50 * SIDE + 50] - 2.0 / 49.0).abs() < 1e-12);
        let far = bird_map([[30.0, 5.0, 0.0]]);
        let sets = |m: &Vec<f64>| vec![m.clone(), m.clone()];
        assert_eq!(jsd(&sets(&map), &sets(&map)), 0.0);
        assert!((jsd(&sets(&map), &sets(&far)) - std::f64::consts::LN_2.sqrt()).abs() < 1e-12);
        assert!(mmd(&sets(&map), &sets(&map)).expect("two each").abs() < 1e-12);
        assert!(mmd(&sets(&map), &sets(&far)).expect("two each") > 0.5);
    }
}
