//! The drive from whose sweeps labels are made.

use glam::DVec2;

use crate::World;
use scene::{Polyline, PolylineKind};

/// Parameters of the simulated labelling drive.
#[derive(Clone, Debug)]
pub struct Drive {
    /// Sweeps along the drive.
    pub sweeps: usize,
    /// Metres between sweeps.
    pub step_m: f64,
    /// Share of rays that return nothing at random.
    pub dropout: f64,
    /// Standard deviation of the measured range, m.
    pub range_noise_m: f64,
}

impl Default for Drive {
    fn default() -> Self {
        Self {
            sweeps: 24,
            step_m: 1.8,
            dropout: 0.08,
            range_noise_m: 0.02,
        }
    }
}

/// Poses of the labelling drive: along the lane nearest to the ego, as far as it stays in the grid.
pub(super) fn poses(world: &World, drive: &Drive) -> Vec<(DVec2, f64)> {
    let lanes = world
        .layout
        .polylines
        .iter()
        .filter(|l| l.kind == PolylineKind::LaneCenter);
    let nearest = |line: &Polyline| {
        let distances = line.points_m.iter().map(|p| p.length_squared());
        distances.fold(f64::INFINITY, f64::min)
    };
    let lane = lanes.min_by(|a, b| nearest(a).total_cmp(&nearest(b)));
    let straight: Vec<DVec2> = [-40.0, 40.0].map(|x| DVec2::new(x, 0.0)).to_vec();
    let points = lane.map_or(&straight, |l| &l.points_m);
    // Every metre of the lane, then the ones nearest to the ego at the wanted spacing.
    let mut fine = Vec::new();
    for pair in points.windows(2) {
        let (d, length) = (
            (pair[1] - pair[0]).normalize_or(DVec2::X),
            pair[0].distance(pair[1]),
        );
        fine.extend((0..length.ceil() as usize).map(|i| (pair[0] + d * i as f64, d.to_angle())));
    }
    fine.retain(|(p, _)| p.abs().max_element() < 39.0);
    let start = (0..fine.len())
        .min_by(|a, b| fine[*a].0.length().total_cmp(&fine[*b].0.length()))
        .unwrap_or(0);
    let half = drive.sweeps as f64 / 2.0;
    (0..drive.sweeps)
        .filter_map(|i| {
            let at = start as f64 + (i as f64 - half) * drive.step_m;
            (at >= 0.0).then(|| fine.get(at as usize).copied()).flatten()
        })
        .collect()
}
