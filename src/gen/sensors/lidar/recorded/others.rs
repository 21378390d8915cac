//! Measurements of other sweeps of a drive in the directions that an edit opens.

use std::collections::HashMap;

use glam::DVec3;
use rayon::prelude::*;
use scene::{SceneBox, SweepRecording};

use super::ground::GroundMap;
use super::is_in_windows;

/// Edge of a cell of directions, and largest angle between a ray and a return that tells of it, degrees.
const CELL_DEG: f64 = 0.5;
/// Cells of a turn.
const CELLS: i32 = 720;
/// Returns that tell of a ray: the nearest, at most and at least.
const MOST: usize = 8;
const LEAST: usize = 3;
/// Height above or below the map's up to which a return is of the ground, m.
const GROUND_M: f64 = 0.25;
/// Largest difference in range within one surface, m.
const APART_M: f64 = 0.5;
/// Distance around an object within which other sweeps' returns may be its own, m.
const BESIDE_M: f64 = 0.3;

/// Returns of other sweeps by direction from the sensor.
pub struct OtherReturns {
    cells: HashMap<[i32; 2], Vec<OtherReturn>>,
}

struct OtherReturn {
    direction: DVec3,
    range_m: f64,
    /// Height above the ground, m; `None` where no ground is known.
    height_m: Option<f64>,
    strength: f32,
}

/// Statement of other sweeps about a ray.
pub enum Told {
    /// It meets the ground, so much higher than the map has it, m.
    Ground(f64),
    /// It meets something that stands: distance, m, and strength.
    Standing(f64, f32),
}

impl OtherReturns {
    /// Returns that lie in some windows as seen from the sensor, but for those of objects that are gone or move. `moving` are
    /// the boxes of these at the time of a sweep.
    pub fn new(
        sensor: DVec3,
        others: &[std::sync::Arc<SweepRecording>],
        windows: &[[f64; 2]],
        moving: impl Fn(&SweepRecording) -> Vec<SceneBox>,
        ground: &GroundMap,
    ) -> Self {
        let mut cells: HashMap<[i32; 2], Vec<OtherReturn>> = HashMap::new();
        for other in others {
            let boxes = moving(other);
            let is_of_object = |p: DVec3| {
                boxes.iter().any(|b| {
                    let at = b.to_local(p).abs() - b.size_m / 2.0;
                    at.truncate().max_element() < BESIDE_M && at.z < 1.0
                })
            };
            let of_sweep = other.returns.par_iter().with_min_len(4096).filter_map(|r| {
                let at = (*r)?.place();
                let way = at - sensor;
                if !is_in_windows(windows, way) || is_of_object(at) {
                    return None;
                }
                let ground_m = ground.height_m(at.truncate());
                Some(OtherReturn {
                    direction: way.try_normalize()?,
                    range_m: way.length(),
                    height_m: ground_m.map(|m| at.z - m),
                    strength: (*r)?.strength,
                })
            });
            for r in of_sweep.collect::<Vec<_>>() {
                cells.entry(cell(r.direction)).or_default().push(r);
            }
        }
        Self { cells }
    }

    /// Statement about a ray beyond a distance, m.
    pub fn told(&self, direction: DVec3, from_m: f64) -> Option<Told> {
        let [x, y] = cell(direction);
        let around = (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| [(x + dx).rem_euclid(CELLS), y + dy]));
        let limit = CELL_DEG.to_radians();
        let mut near: Vec<(f64, &OtherReturn)> = around
            .filter_map(|at| self.cells.get(&at))
            .flatten()
            .filter(|r| r.range_m >= from_m)
            .map(|r| (r.direction.angle_between(direction), r))
            .filter(|(angle, _)| *angle <= limit)
            .collect();
        near.sort_by(|a, b| a.0.total_cmp(&b.0));
        near.truncate(MOST);
        if near.len() < LEAST {
            return None;
        }
        let weight = |angle: f64| 1.0 / (angle + limit / 20.0);
        let heights: Option<Vec<f64>> = near.iter().map(|(_, r)| r.height_m).collect();
        if let Some(heights) = heights
            && heights.iter().all(|height_m| height_m.abs() <= GROUND_M)
        {
            let weighted = near
                .iter()
                .zip(&heights)
                .map(|((angle, _), m)| (weight(*angle), m));
            let (sum, all) = weighted.fold((0.0, 0.0), |(sum, all), (w, m)| (sum + w * m, all + w));
            return Some(Told::Ground(sum / all));
        }
        // The nearest surface of several hides those behind it.
        near.sort_by(|a, b| a.1.range_m.total_cmp(&b.1.range_m));
        let surfaces = near.chunk_by(|a, b| b.1.range_m - a.1.range_m <= APART_M);
        let front = surfaces.into_iter().find(|surface| surface.len() >= LEAST)?;
        if front
            .iter()
            .all(|(_, r)| r.height_m.is_some_and(|m| m.abs() <= GROUND_M))
        {
            let sum: f64 = front.iter().filter_map(|(_, r)| r.height_m).sum();
            return Some(Told::Ground(sum / front.len() as f64));
        }
        let (sum, all) = front.iter().fold((0.0, 0.0), |(sum, all), (angle, r)| {
            (sum + weight(*angle) * r.range_m, all + weight(*angle))
        });
        let strength = front.iter().map(|(_, r)| r.strength).sum::<f32>() / front.len() as f32;
        Some(Told::Standing(sum / all, strength))
    }
}

/// The cell of a direction: along the horizon and upwards.
fn cell(direction: DVec3) -> [i32; 2] {
    let turn = direction.y.atan2(direction.x).to_degrees().rem_euclid(360.0);
    let up = direction.z.clamp(-1.0, 1.0).asin().to_degrees();
    [
        ((turn / CELL_DEG) as i32).rem_euclid(CELLS),
        (up / CELL_DEG).floor() as i32,
    ]
}
