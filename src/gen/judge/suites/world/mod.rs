//! `eval world`: simulated labels compared with known figures of real ones.

mod complete;
pub mod lidar;

use rayon::prelude::*;
use serde::Deserialize;
use serde_json::{Value, json};

use crate::suite::{Options, SuiteFigures};
use calibration::MeasurementProgress;
use calibration::held_out::TEST_SEED;
use dataset::{occupancy_frame, world_of};
use metrics::occupancy::OccupancyStatistics;
use scene::Class;

/// Figures of real labels.
const TARGETS: &str = assets::statistics::OCC3D;

/// A file of `assets/statistics`.
#[derive(Deserialize)]
pub(super) struct Targets {
    targets: Vec<ReferenceFigure>,
}

/// One figure: its measured value, and the range in which the mean of a data set is plausible.
#[derive(Deserialize)]
struct ReferenceFigure {
    metric: String,
    value: f64,
    accept: [f64; 2],
}

impl Targets {
    /// One row per figure, and the number of figures inside their accepted range.
    pub(super) fn compare(&self, found: impl Fn(&str) -> Option<f64>) -> (Vec<Value>, usize) {
        let mut inside = 0;
        let row = |target: &ReferenceFigure| {
            let found = found(&target.metric);
            let [low, high] = target.accept;
            let accepted = found.is_some_and(|f| (low..=high).contains(&f));
            inside += usize::from(accepted);
            json!({
                "metric": target.metric,
                "found": found.map(|f| (f * 1e5).round() / 1e5),
                "real": target.value,
                "accept": target.accept,
                "inside": accepted,
                // In half widths of the accepted range: 0 is equal, 1 about at its edge.
                "distance": found.map(|f| ((f - target.value).abs() / (high - low) * 2e3).round() / 1e3),
            })
        };
        let rows = self.targets.iter().map(row).collect();
        (rows, inside)
    }
}

/// Names of the figures of [`Targets::compare`] that lie outside their range.
pub(super) fn outside(rows: &[Value]) -> Vec<&Value> {
    let not_inside = |row: &&Value| row["inside"] == json!(false);
    rows.iter().filter(not_inside).map(|row| &row["metric"]).collect()
}

impl Options {
    /// Statistics of simulated labels; the bar is the share of figures inside their accepted range.
    pub(crate) fn world(&self, progress: &dyn MeasurementProgress) -> anyhow::Result<SuiteFigures> {
        let targets: Targets = serde_json::from_str(TARGETS)?;
        let mut statistics = OccupancyStatistics::default();
        let frames: Vec<usize> = (0..self.frames).collect();
        for some in frames.chunks(8) {
            progress.at("world", some[0], self.frames);
            let made: Vec<_> = some
                .par_iter()
                .map(|i| occupancy_frame(TEST_SEED, *i as u64, |_| None).labels)
                .collect();
            for (i, labels) in some.iter().zip(&made) {
                let (world, _) = world_of(TEST_SEED, *i as u64, |_| None);
                statistics.add(labels, &world.layout.relief);
                for (class, name) in [(Class::Car, "cars"), (Class::Pedestrian, "pedestrians")] {
                    let count = world.boxes.values().filter(|b| b.class == class).count();
                    statistics.ratio(&format!("layout.{name}_per_frame_pm40"), count, 1);
                }
            }
        }
        let means = statistics.means();
        let (rows, mut inside) = targets.compare(|metric| means.get(metric).copied());
        let (lidar, lidar_inside) = self.world_lidar(progress)?;
        let mut of = rows.len();
        inside += lidar_inside[0];
        of += lidar_inside[1];
        let share = inside as f64 / of as f64;
        let (complete, sound) = self.world_complete(progress);
        let report = json!({
            "outside": outside(&rows),
            "statistics": rows,
            "lidar": lidar,
            "complete_worlds": complete,
            "inside": inside,
            "of": of,
        });
        let bars = vec![
            ("figures inside their accepted range", share, 1.0),
            (
                "at most 1 % of the worlds with an error",
                f64::from(u8::from(sound)),
                1.0,
            ),
        ];
        Ok((report, bars))
    }
}
