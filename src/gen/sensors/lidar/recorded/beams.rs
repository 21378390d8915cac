//! Rays of a recorded sweep from which nothing came back: gaps between the returns of a beam.

use glam::DVec3;
use scene::{Pose, RecordedReturn, SweepRecording};

/// Beams of a sweep at most.
const MOST_BEAMS: usize = 256;
/// Largest difference in elevation between neighbours of one beam where files tell no rings, rad.
const SAME_RAD: f64 = 0.015 * std::f64::consts::PI / 180.0;
/// Returns of a beam at least.
const LEAST: usize = 20;
/// Gap from which rays are missing, in steps of the beam, and largest gap, rad.
const GAP: f64 = 1.5;
const WIDEST_RAD: f64 = 0.6;

/// A ray without a return.
#[derive(Clone, Copy, Debug)]
pub struct EmptyRay {
    /// Unit direction in the world frame.
    pub direction: DVec3,
    /// Record of a return beside it on its beam.
    pub like: u32,
}

/// A return as its beam has it.
#[derive(Clone, Copy)]
struct BeamReturn {
    azimuth_rad: f64,
    elevation_rad: f64,
    record: u32,
}

/// The rays without a return of a sweep; none if its beams cannot be told.
pub fn empty_rays(recording: &SweepRecording) -> Vec<EmptyRay> {
    let file_from_world = recording.world_from_file.inverse();
    let sensor = file_from_world.apply(recording.sensor_m);
    let places = recording.returns.iter().zip(0..).filter_map(|(r, record)| {
        let r = (*r)?;
        let way = file_from_world.apply(r.place()) - sensor;
        let flat = way.truncate();
        let of_beam = BeamReturn {
            azimuth_rad: flat.y.atan2(flat.x),
            elevation_rad: way.z.atan2(flat.length()),
            record,
        };
        Some((r.ring, of_beam))
    });
    let mut rays = Vec::new();
    for mut beam in beams(places.collect()) {
        beam.sort_by(|a, b| a.azimuth_rad.total_cmp(&b.azimuth_rad));
        fill_gaps(&beam, &recording.world_from_file, &mut rays);
    }
    rays
}

/// Returns by beam: by ring, or by elevation if there are no rings.
fn beams(mut returns: Vec<(u16, BeamReturn)>) -> Vec<Vec<BeamReturn>> {
    let has_rings = returns.iter().all(|(ring, _)| *ring != RecordedReturn::NO_RING);
    let groups: Vec<Vec<BeamReturn>> = if has_rings {
        returns.sort_by_key(|(ring, _)| *ring);
        let by_ring = returns.chunk_by(|a, b| a.0 == b.0);
        by_ring.map(|beam| beam.iter().map(|r| r.1).collect()).collect()
    } else {
        returns.sort_by(|a, b| a.1.elevation_rad.total_cmp(&b.1.elevation_rad));
        let by_elevation = returns.chunk_by(|a, b| b.1.elevation_rad - a.1.elevation_rad < SAME_RAD);
        by_elevation
            .map(|beam| beam.iter().map(|r| r.1).collect())
            .collect()
    };
    let full: Vec<Vec<BeamReturn>> = groups.into_iter().filter(|beam| beam.len() >= LEAST).collect();
    // Elevations that run into each other tell no beams.
    let are_thin = has_rings || full.iter().all(|beam| thickness(beam) < 20.0 * SAME_RAD);
    match full.len() <= MOST_BEAMS && are_thin {
        true => full,
        false => Vec::new(),
    }
}

fn thickness(beam: &[BeamReturn]) -> f64 {
    let ends = beam.first().zip(beam.last());
    ends.map_or(0.0, |(a, b)| b.elevation_rad - a.elevation_rad)
}

fn fill_gaps(beam: &[BeamReturn], world_from_file: &Pose, rays: &mut Vec<EmptyRay>) {
    let gap = |a: &BeamReturn, b: &BeamReturn| {
        (b.azimuth_rad - a.azimuth_rad).rem_euclid(std::f64::consts::TAU)
    };
    let mut steps: Vec<f64> = beam.windows(2).map(|two| gap(&two[0], &two[1])).collect();
    steps.retain(|step| *step > 1e-5);
    steps.sort_by(f64::total_cmp);
    let Some(step) = steps.get(steps.len() / 2).copied() else {
        return;
    };
    let Some((first, last)) = beam.first().zip(beam.last()) else {
        return;
    };
    let pairs = beam.windows(2).map(|two| (&two[0], &two[1]));
    for (a, b) in pairs.chain([(last, first)]) {
        let wide = gap(a, b);
        if wide < GAP * step || wide > WIDEST_RAD {
            continue;
        }
        let missing = (wide / step).round() as usize;
        for i in 1..missing {
            let share = i as f64 / missing as f64;
            let azimuth = a.azimuth_rad + wide * share;
            let elevation = a.elevation_rad + (b.elevation_rad - a.elevation_rad) * share;
            let (sin, cos) = elevation.sin_cos();
            let in_file = DVec3::new(cos * azimuth.cos(), cos * azimuth.sin(), sin);
            rays.push(EmptyRay {
                direction: world_from_file.rotation * in_file,
                like: if share < 0.5 { a.record } else { b.record },
            });
        }
    }
}
