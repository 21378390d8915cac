//! Agreement of a camera's label and depth maps with the true ones: labels, depths, outlines.

use numeric::quantile::{median, quantile};
use scene::sensor_data::RenderId;

/// A label map with depths, row-major; a depth that is not above 0 means no surface.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LabelledDepth {
    /// Pixels per row.
    pub width: usize,
    /// Labels.
    pub label: Vec<RenderId>,
    /// Depths along the optical axis, m.
    pub depth_m: Vec<f32>,
}

/// Counts over any number of views.
#[derive(Clone, Debug, Default)]
pub struct MapAgreement {
    pixels: usize,
    same: usize,
    errors_m: Vec<f64>,
    outlines: [OutlineCounts; 2],
}

/// Numbers of outline pixels, and of those near the outline of the other map.
#[derive(Clone, Copy, Debug, Default)]
struct OutlineCounts {
    found: usize,
    found_right: usize,
    truth: usize,
    truth_met: usize,
}

/// Distances within which outlines count as matching, px (the larger of the distances along u and v).
pub const OUTLINE_PX: [usize; 2] = [1, 2];

impl MapAgreement {
    /// Adds a view; both maps have the same size.
    pub fn add(&mut self, found: &LabelledDepth, truth: &LabelledDepth) {
        self.pixels += truth.label.len();
        let pairs = found.label.iter().zip(&truth.label);
        self.same += pairs.filter(|(a, b)| a == b).count();
        for (f, t) in found.depth_m.iter().zip(&truth.depth_m) {
            if *f > 0.0 && *t > 0.0 {
                self.errors_m.push(f64::from((f - t).abs()));
            }
        }
        let (a, b) = (outline(found), outline(truth));
        for (counts, px) in self.outlines.iter_mut().zip(OUTLINE_PX) {
            let (near_a, near_b) = (grown(&a, found.width, px), grown(&b, truth.width, px));
            let both = |x: &[bool], y: &[bool]| x.iter().zip(y).filter(|(x, y)| **x && **y).count();
            counts.found += a.iter().filter(|v| **v).count();
            counts.truth += b.iter().filter(|v| **v).count();
            counts.found_right += both(&a, &near_b);
            counts.truth_met += both(&b, &near_a);
        }
    }

    /// Share of pixels with the same label; NaN before the first.
    pub fn labels(&self) -> f64 {
        self.same as f64 / self.pixels as f64
    }

    /// Median and 95 % quantile of the depth error in m, where both maps have a depth.
    pub fn depth_error_m(&self) -> (f64, f64) {
        (median(&self.errors_m), quantile(&self.errors_m, 0.95))
    }

    /// F-score of the outlines for each of [`OUTLINE_PX`]; 1 if neither map has outlines.
    pub fn outline_f(&self) -> [f64; 2] {
        self.outlines.map(|o| {
            if o.found + o.truth == 0 {
                return 1.0;
            }
            let precision = o.found_right as f64 / o.found.max(1) as f64;
            let recall = o.truth_met as f64 / o.truth.max(1) as f64;
            2.0 * precision * recall / (precision + recall).max(1e-12)
        })
    }
}

/// Pixels whose right or lower neighbour has another label.
fn outline(map: &LabelledDepth) -> Vec<bool> {
    let (w, n) = (map.width, map.label.len());
    let differs = |i: usize, j: usize, fits: bool| fits && map.label[i] != map.label[j.min(n - 1)];
    (0..n)
        .map(|i| differs(i, i + 1, i % w + 1 < w) || differs(i, i + w, i + w < n))
        .collect()
}

/// Pixels within `px` of a set one, grown along rows, then along columns.
fn grown(set: &[bool], width: usize, px: usize) -> Vec<bool> {
    if width == 0 {
        return Vec::new();
    }
    let height = set.len() / width;
    let along = |from: &[bool], at: &dyn Fn(usize, usize) -> usize, lines: usize, length: usize| {
        let mut out = vec![false; from.len()];
        for line in 0..lines {
            for i in 0..length {
                if from[at(line, i)] {
                    for k in i.saturating_sub(px)..(i + px + 1).min(length) {
                        out[at(line, k)] = true;
                    }
                }
            }
        }
        out
    };
    let rows = along(set, &|line, i| line * width + i, height, width);
    along(&rows, &|line, i| i * width + line, width, height)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square of label 4 at `x0` on label 11, depth `d`.
    fn square(x0: usize, d: f32) -> LabelledDepth {
        let (w, h) = (40, 20);
        let inside = |i: usize| (x0..x0 + 8).contains(&(i % w)) && (6..14).contains(&(i / w));
        LabelledDepth {
            width: w,
            label: (0..w * h).map(|i| if inside(i) { 4 } else { 11 }).collect(),
            depth_m: (0..w * h).map(|i| if inside(i) { d } else { -1.0 }).collect(),
        }
    }

    #[test]
    fn a_shift_shows_in_labels_outlines_and_depth() {
        let mut same = MapAgreement::default();
        same.add(&square(10, 5.0), &square(10, 5.0));
        assert_eq!((same.labels(), same.outline_f()), (1.0, [1.0, 1.0]));
        assert_eq!(same.depth_error_m(), (0.0, 0.0));
        let mut off = MapAgreement::default();
        off.add(&square(12, 5.5), &square(10, 5.0));
        assert_eq!(off.labels(), 1.0 - 32.0 / 800.0);
        assert_eq!(off.depth_error_m(), (0.5, 0.5));
        let [one, two] = off.outline_f();
        assert!(one < 0.75 && two == 1.0, "{one} {two}");
        let empty = MapAgreement::default();
        assert!(empty.labels().is_nan() && empty.outline_f() == [1.0, 1.0]);
    }

    #[test]
    fn nothing_and_one_pixel() {
        let mut a = MapAgreement::default();
        a.add(&LabelledDepth::default(), &LabelledDepth::default());
        let one = LabelledDepth {
            width: 1,
            label: vec![3],
            depth_m: vec![f32::NAN],
        };
        a.add(&one, &one);
        assert_eq!(a.labels(), 1.0);
        assert!(a.depth_error_m().0.is_nan());
    }
}
