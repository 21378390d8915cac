//! The LiDAR part of `eval world`: sweeps through procedural worlds, compared with known figures of real ones.

use rayon::prelude::*;
use serde_json::{Value, json};

use super::{Targets, outside};
use crate::suite::Options;
use calibration::MeasurementProgress;
use calibration::held_out::TEST_SEED;
use dataset::world_of;
use metrics::sweep::SweepFigures;
use scene::SensorRig;
use sensors::lidar::truth;

/// Figures of real sweeps.
const TARGETS: &str = assets::statistics::LIDAR;

/// The figures of sweeps beside the real ones; and how many are inside their accepted range, of how many. Figures that
/// these sweeps do not have are left out.
pub fn lidar_rows(sums: &SweepFigures) -> anyhow::Result<(Vec<Value>, [usize; 2])> {
    let targets: Targets = serde_json::from_str(TARGETS)?;
    let figures = sums.figures();
    let (rows, inside) = targets.compare(|metric| figures.get(metric).copied());
    let rows: Vec<Value> = rows.into_iter().filter(|row| !row["found"].is_null()).collect();
    let of = rows.len();
    Ok((rows, [inside, of]))
}

impl Options {
    /// Figures of simulated sweeps: rows, those outside the real range, and how well a trivial predictor tells which
    /// echoes are lost; and how many figures are inside.
    pub fn world_lidar(&self, progress: &dyn MeasurementProgress) -> anyhow::Result<(Value, [usize; 2])> {
        let pattern = &SensorRig::default().lidars[0];
        let mut sums = SweepFigures::default();
        let frames: Vec<usize> = (0..self.frames).collect();
        for some in frames.chunks(8) {
            progress.at("sweeps", some[0], self.frames);
            let made: Vec<_> = some
                .par_iter()
                .map(|i| {
                    let (world, seed) = world_of(TEST_SEED, *i as u64, |_| None);
                    truth::sweep(&world, pattern, seed)
                })
                .collect();
            for rays in &made {
                sums.add_truth(rays, pattern);
            }
        }
        let (rows, inside) = lidar_rows(&sums)?;
        let rings: Vec<Value> = (0..pattern.elevations_deg.len())
            .map(|ring| {
                let [own, none] = sums.ring(ring).map(|v| (v * 1e4).round() / 1e4);
                json!({ "ring": ring, "own_body": own, "no_return": none })
            })
            .collect();
        // NaN, with a single world or no lost echo, is null in JSON.
        let auc = sums.loss_auc();
        let report = json!({
            "outside": outside(&rows),
            "lost_auc": auc.is_finite().then_some((auc * 1e4).round() / 1e4),
            "statistics": rows,
            "rings": rings,
        });
        Ok((report, inside))
    }
}
