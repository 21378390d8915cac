//! Distance between the distributions of forecast and true stacks of frames. A stack is cut into places; each gives the
//! mean of its features over the frames, and their mean change from frame to frame.

use metrics::MetricError;
use metrics::extractor::Extractor;
use metrics::local::Windows;
use metrics::scenewise::{self, Distance};
use scene::VoxelGrid;

/// Cells along a side of a frame, and along a side of a place (8 m).
const SIDE: usize = 50;
const PLACE: usize = 5;
/// Number of neighbouring channels of the extractor that are averaged, so that a few drives have more places than
/// numbers.
const TOGETHER: usize = 8;

/// Features of every frame of a drive, cell by cell.
pub struct Stack(Vec<Windows>);

impl Stack {
    /// Features of frames. Errors if the extractor cannot compute.
    pub fn from_frames(extractor: &Extractor, frames: &[VoxelGrid]) -> anyhow::Result<Self> {
        let cells: Result<Vec<Windows>, _> = frames.iter().map(|grid| extractor.cells(grid)).collect();
        Ok(Self(cells?))
    }

    /// Steadiness of the frames: mean, over the frames after the first, of the cosines with the frame before and with
    /// the first, of features pooled over the frame (as in the code of UniScene, 2412.05435).
    pub fn steadiness(&self) -> f64 {
        let pooled: Vec<Vec<f64>> = self.0.iter().map(|cells| mean(cells.iter())).collect();
        let cos = |a: &[f64], b: &[f64]| {
            let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
            dot(a, b) / (dot(a, a) * dot(b, b)).sqrt().max(1e-12)
        };
        let later = pooled
            .windows(2)
            .map(|pair| (cos(&pair[1], &pair[0]) + cos(&pair[1], &pooled[0])) / 2.0);
        later.sum::<f64>() / (pooled.len().max(2) - 1) as f64
    }

    /// One row for each place: means over the frames, then mean changes from one frame to the next.
    pub fn places(&self) -> Windows {
        let frames: Vec<Windows> = self.0.iter().map(pooled).collect();
        let count = (SIDE / PLACE) * (SIDE / PLACE);
        let row = |place: usize| {
            let mut row = mean(frames.iter().map(|f| &f[place]));
            let changes: Vec<Vec<f64>> = frames
                .windows(2)
                .map(|pair| {
                    let both = pair[1][place].iter().zip(&pair[0][place]);
                    both.map(|(now, before)| (now - before).abs()).collect()
                })
                .collect();
            row.extend(mean(changes.iter()));
            row
        };
        (0..count).map(row).collect()
    }
}

/// Fréchet and kernel distance of a method's places to the true ones, in units of the true ones' spread.
pub fn distances(truth: &[Windows], found: &[Windows]) -> Result<[Distance; 2], MetricError> {
    let [truth, found] = scenewise::standardised(truth, found)?;
    Ok([
        scenewise::frechet(&truth, &found)?,
        scenewise::kernel(&truth, &found)?,
    ])
}

fn mean<'a>(rows: impl Iterator<Item = &'a Vec<f64>>) -> Vec<f64> {
    let (mut sums, mut n) = (Vec::new(), 0.0f64);
    for row in rows {
        sums.resize(row.len(), 0.0);
        sums.iter_mut().zip(row).for_each(|(s, v)| *s += v);
        n += 1.0;
    }
    sums.into_iter().map(|s| s / n.max(1.0)).collect()
}

/// The places of a frame: means over their cells and over neighbouring channels.
fn pooled(cells: &Windows) -> Windows {
    let places = SIDE / PLACE;
    let place = |at: usize| {
        let (i, j) = (at / places * PLACE, at % places * PLACE);
        let own = (0..PLACE * PLACE).map(|k| &cells[(i + k / PLACE) * SIDE + j + k % PLACE]);
        let all = mean(own);
        all.chunks(TOGETHER)
            .map(|c| c.iter().sum::<f64>() / c.len() as f64)
            .collect()
    };
    (0..places * places).map(place).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::Class;

    fn frames(shift: usize) -> Vec<VoxelGrid> {
        let frame = |t: usize| {
            let mut grid = VoxelGrid::new();
            for x in 0..200 {
                for y in 0..200 {
                    grid.set(x, y, 0, Class::DriveableSurface.id());
                    if (x / 9 + y / 7 + shift * t).is_multiple_of(5) {
                        (1..6).for_each(|z| grid.set(x, y, z, Class::Manmade.id()));
                    }
                }
            }
            grid
        };
        (0..3).map(frame).collect()
    }

    #[test]
    fn stacks_that_flicker_are_farther_from_still_ones_than_still_ones() {
        let extractor = Extractor::bundled().expect("the shipped weights");
        let stack = |shift: usize| Stack::from_frames(&extractor, &frames(shift)).expect("features");
        let (still, restless) = (stack(0), stack(1));
        assert!(still.steadiness() > 0.999 && restless.steadiness() < still.steadiness());
        let (a, b) = (vec![still.places(); 2], vec![restless.places(); 2]);
        assert_eq!((a[0].len(), a[0][0].len()), (100, 48));
        let near = distances(&a, &a).expect("distances")[0].mean;
        let far = distances(&a, &b).expect("distances")[0].mean;
        assert!(near.abs() < 1e-3 && far > 1.0, "{near} {far}");
    }
}
