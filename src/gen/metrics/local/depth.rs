//! Features of windows of depth images: steps and bends of depth from pixel to pixel, share of sky, random
//! convolutions. On a plane 1 / depth is linear in the picture, so facades and ground have no bends and rubble has them
//! everywhere.

use super::Windows;
use super::random::{Bank, FeatureMapView};

/// Size of the depth images, px.
pub const IMAGE: [u32; 2] = [80, 45];
/// Rows and columns of a window, px: 3 x 5 windows to an image.
const WINDOW: [usize; 2] = [15, 16];
const FILTERS: usize = 24;
/// Depth at which the signal is one half, m.
const MIDDLE_M: f64 = 10.0;
/// Bounds of the bins: of the logarithm of the ratio of neighbouring depths, and of the bend relative to the signal.
const STEPS: [f64; 5] = [0.02, 0.06, 0.15, 0.4, 1.0];
const BENDS: [f64; 4] = [0.01, 0.04, 0.12, 0.4];
/// Depth that stands for the sky, m.
const SKY_M: f64 = 200.0;

/// Names of the features of a window, in their order.
pub fn names() -> Vec<String> {
    let mut out: Vec<String> = ["nearness", "spread of nearness", "sky"]
        .map(str::to_owned)
        .into();
    for along in ["across", "down"] {
        out.extend((0..=STEPS.len()).map(|n| format!("depth steps {along}, size {n}")));
        out.extend((0..=BENDS.len()).map(|n| format!("depth bends {along}, size {n}")));
    }
    out.extend((0..FILTERS).map(|n| format!("random filter {n}")));
    out.extend(["upper row", "middle row", "lower row"].map(str::to_owned));
    out
}

/// Features of the windows of one image, in the order of [`names`]. `depth_m` is row-major, not above 0 for sky. An
/// image of another size than [`IMAGE`] gives no windows.
pub fn windows(depth_m: &[f32]) -> Windows {
    let [columns, rows] = IMAGE.map(|n| n as usize);
    if depth_m.len() != rows * columns {
        return Windows::new();
    }
    let depth = |d: f32| {
        if d > 0.0 && d.is_finite() {
            f64::from(d)
        } else {
            SKY_M
        }
    };
    let log: Vec<f64> = depth_m.iter().map(|d| depth(*d).ln()).collect();
    let near: Vec<f64> = depth_m
        .iter()
        .map(|d| 1.0 / (1.0 + depth(*d) / MIDDLE_M))
        .collect();
    let inverse: Vec<f64> = depth_m.iter().map(|d| 1.0 / depth(*d)).collect();
    let data: Vec<f32> = near.iter().map(|v| (*v * 4.0 - 1.0) as f32).collect();
    let map = FeatureMapView {
        data: &data,
        rows,
        columns,
    };
    let by_chance = Bank::new("depth", 1, 5, FILTERS).means(&map, WINDOW);
    let across = columns / WINDOW[1];
    let area = (WINDOW[0] * WINDOW[1]) as f64;
    let each = by_chance.into_iter().enumerate().map(|(i, by_chance)| {
        let (v0, u0) = (i / across * WINDOW[0], i % across * WINDOW[1]);
        let inside = || (v0..v0 + WINDOW[0]).flat_map(|v| (u0..u0 + WINDOW[1]).map(move |u| (u, v)));
        let pixels = || inside().map(|(u, v)| v * columns + u);
        let mean = pixels().map(|p| near[p]).sum::<f64>() / area;
        let spread = pixels().map(|p| (near[p] - mean).powi(2)).sum::<f64>() / area;
        let sky = pixels().filter(|p| depth_m[*p] <= 0.0).count() as f64 / area;
        let mut out = vec![mean, spread.sqrt(), sky];
        for (stride, last) in [(1, columns), (columns, rows)] {
            let mut steps = [0.0; STEPS.len() + 1];
            let mut bends = [0.0; BENDS.len() + 1];
            for (u, v) in inside() {
                let (p, place) = (v * columns + u, if stride == 1 { u } else { v });
                let bin = |bounds: &[f64], value: f64| bounds.iter().filter(|b| value > **b).count();
                if place + 1 < last {
                    steps[bin(&STEPS, (log[p + stride] - log[p]).abs())] += 1.0 / area;
                }
                if place > 0 && place + 1 < last {
                    let bend = inverse[p - stride] + inverse[p + stride] - 2.0 * inverse[p];
                    bends[bin(&BENDS, bend.abs() / inverse[p])] += 1.0 / area;
                }
            }
            out.extend(steps);
            out.extend(bends);
        }
        out.extend(by_chance);
        out.extend((0..3).map(|row| if i / across == row { 1.0 } else { 0.0 }));
        out
    });
    each.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plane_bends_nowhere_and_rubble_does() {
        let [columns, rows] = IMAGE.map(|n| n as usize);
        let plane: Vec<f32> = (0..rows * columns)
            .map(|i| 1.0 / (0.02 + (i % columns) as f32 * 1e-3 + (i / columns) as f32 * 2e-3))
            .collect();
        let rubble: Vec<f32> = plane
            .iter()
            .enumerate()
            .map(|(i, d)| if i * 7919 % 3 == 0 { d * 1.5 } else { *d })
            .collect();
        let names = names();
        let at = |name: &str| names.iter().position(|n| n == name).expect("a name");
        let flat = at("depth bends across, size 0");
        let (plane, rubble) = (windows(&plane), windows(&rubble));
        assert_eq!((plane.len(), plane[0].len()), (15, names.len()));
        assert!(plane[7][flat] > 0.99 && rubble[7][flat] < 0.2);
        assert_eq!(plane[7][at("sky")], 0.0);
        assert_eq!(windows(&vec![-1.0; rows * columns])[0][at("sky")], 1.0);
        assert!(windows(&[1.0; 7]).is_empty());
        let broken = windows(&vec![f32::NAN; rows * columns]);
        assert!(broken.iter().flatten().all(|v| v.is_finite()));
    }
}
