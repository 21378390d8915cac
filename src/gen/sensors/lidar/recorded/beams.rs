//! Beams of a recorded sweep: the returns beside one on its beam, and the rays from which nothing came back.

use std::cmp::Ordering::Equal;
use std::collections::HashMap;
use std::f64::consts::{PI, TAU};

use glam::DVec3;
use scene::{LidarPattern, Pose, RecordedReturn, SweepRecording};

/// Beams of a sweep at most.
const MOST_BEAMS: usize = 256;
/// Largest difference in elevation between neighbours of one beam where files tell no rings, degrees: the first that gives
/// beams is taken.
const SAME_DEG: [f64; 5] = [0.01, 0.015, 0.02, 0.03, 0.05];
/// Returns by which the height of the beams' origin is looked for, heights that are tried, and width of the bins of elevations.
const SAMPLED: usize = 20_000;
const ORIGIN_STEPS: i32 = 15;
const ORIGIN_STEP_M: f64 = 0.006;
const BIN_DEG: f64 = 0.02;
/// Largest spread of elevations of such a beam, degrees, such beams at most, and the least share of returns on them.
const THICKEST_DEG: f64 = 0.4;
const MOST_FOUND: usize = 130;
const LEAST_HELD: f64 = 0.85;
/// Rays without a return after which no more beams are looked at.
const MOST_EMPTY: usize = 1_000_000;
/// Columns of a turn, the least and the most.
const MOST_APART: f64 = 90.0;
const MOST_COLUMNS: f64 = 8192.0;
/// Width of a part without any return that the sensor does not look at, degrees.
const WIDE_DEG: usize = 60;
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
    /// Record between those of the returns on both sides, if there are records for the rays between them.
    pub slot: Option<u32>,
    /// Its direction on the beam, rad.
    azimuth_rad: f64,
}

/// The beams of a sweep; none if they cannot be told.
#[derive(Clone, Debug, Default)]
pub struct Beams {
    /// Returns of each beam by their direction.
    beams: Vec<Vec<BeamReturn>>,
    /// Beam and place on it of each record that has a return on a beam.
    places: Vec<Option<[u32; 2]>>,
    /// Rays without a return.
    pub empty: Vec<EmptyRay>,
    /// Mean elevation of each beam in the sensor's frame, rad; the lowest first.
    elevations_rad: Vec<f64>,
    /// Middle step between two returns of a beam, rad.
    step_rad: f64,
}

/// A return beside a ray on its beam.
#[derive(Clone, Copy, Debug)]
pub struct BesideRay {
    /// Its record.
    pub record: u32,
    /// Angle between both, rad.
    pub apart_rad: f64,
}

/// A return as its beam has it.
#[derive(Clone, Copy, Debug)]
struct BeamReturn {
    azimuth_rad: f64,
    elevation_rad: f64,
    record: u32,
}

impl Beams {
    /// The beams of a recording.
    pub fn new(recording: &SweepRecording) -> Self {
        let beams = sorted_beams(recording);
        let mut steps: Vec<f64> = beams.iter().filter_map(|beam| step(beam)).collect();
        steps.sort_by(f64::total_cmp);
        let mut all = Self {
            elevations_rad: beams.iter().map(|beam| elevation(beam)).collect(),
            step_rad: steps.get(steps.len() / 2).copied().unwrap_or_default(),
            beams,
            places: vec![None; recording.returns.len()],
            empty: Vec::new(),
        };
        for (beam, number) in all.beams.iter().zip(0u32..) {
            for (r, at) in beam.iter().zip(0u32..) {
                all.places[r.record as usize] = Some([number, at]);
            }
            if all.empty.len() < MOST_EMPTY {
                fill_gaps(beam, &recording.world_from_file, &mut all.empty);
            }
        }
        all
    }

    /// The beam of a record, 0 for the lowest; of a return on no beam the one nearest to its elevation in rad. `None` without
    /// beams.
    pub fn ring(&self, record: u32, elevation_rad: f64) -> Option<u16> {
        if let Some([beam, _]) = self.places.get(record as usize).copied().flatten() {
            return Some(beam as u16);
        }
        let off = |i: &usize| (self.elevations_rad[*i] - elevation_rad).abs();
        let nearest = (0..self.elevations_rad.len()).min_by(|a, b| off(a).total_cmp(&off(b)));
        nearest.map(|ring| ring as u16)
    }

    /// The pattern of the sensor, with what its beams do not tell from another one. `None` without beams.
    pub fn pattern(&self, recording: &SweepRecording, like: &LidarPattern) -> Option<LidarPattern> {
        let ego_from_world = recording
            .before
            .at(recording.time_s)
            .frame()
            .world_from_ego
            .inverse();
        let turn = (ego_from_world * recording.world_from_file).rotation;
        let columns = (TAU / self.step_rad).round();
        if self.elevations_rad.is_empty() || !(MOST_APART..=MOST_COLUMNS).contains(&columns) {
            return None;
        }
        let [first_deg, sector_deg] = sector(self.beams.iter().flatten());
        Some(LidarPattern {
            elevations_deg: self.elevations_rad.iter().map(|e| e.to_degrees()).collect(),
            columns: columns as u32,
            first_azimuth_deg: first_deg,
            sector_deg,
            rotation_wxyz: [turn.w, turn.x, turn.y, turn.z],
            translation_m: ego_from_world.apply(recording.sensor_m).to_array(),
            clockwise: false,
            part: None,
            ..like.clone()
        })
    }

    /// The nearest returns on both sides of a record on its beam, of those that are `there`, at most [`WIDEST_RAD`] away.
    pub fn beside(&self, record: u32, there: impl Fn(u32) -> bool) -> [Option<BesideRay>; 2] {
        let Some([beam, at]) = self.places.get(record as usize).copied().flatten() else {
            return [None; 2];
        };
        let beam = &self.beams[beam as usize];
        let azimuth_rad = beam[at as usize].azimuth_rad;
        self.around(beam, at as usize, azimuth_rad, there)
    }

    /// The same for a ray without a return.
    pub fn beside_empty(&self, ray: &EmptyRay, there: impl Fn(u32) -> bool) -> [Option<BesideRay>; 2] {
        let Some([beam, at]) = self.places.get(ray.like as usize).copied().flatten() else {
            return [None; 2];
        };
        self.around(&self.beams[beam as usize], at as usize, ray.azimuth_rad, there)
    }

    fn around(
        &self,
        beam: &[BeamReturn],
        at: usize,
        azimuth_rad: f64,
        there: impl Fn(u32) -> bool,
    ) -> [Option<BesideRay>; 2] {
        let n = beam.len();
        let apart = |r: &BeamReturn, forward: bool| match forward {
            true => (r.azimuth_rad - azimuth_rad).rem_euclid(TAU),
            false => (azimuth_rad - r.azimuth_rad).rem_euclid(TAU),
        };
        [false, true].map(|forward| {
            let order = (0..n).map(|i| match forward {
                true => (at + i) % n,
                false => (at + n - i) % n,
            });
            let near = order
                .map(|i| (&beam[i], apart(&beam[i], forward)))
                .skip_while(|(_, apart)| *apart > PI)
                .take_while(|(_, apart)| *apart <= WIDEST_RAD);
            near.filter(|(r, _)| there(r.record))
                .map(|(r, apart_rad)| BesideRay {
                    record: r.record,
                    apart_rad,
                })
                .next()
        })
    }
}

/// Returns of each beam by their direction.
fn sorted_beams(recording: &SweepRecording) -> Vec<Vec<BeamReturn>> {
    let file_from_world = recording.world_from_file.inverse();
    let mut sensor = file_from_world.apply(recording.sensor_m);
    sensor.z += beam_origin_m(recording, &file_from_world, sensor);
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
    let mut beams = beams(places.collect());
    for beam in &mut beams {
        beam.sort_by(|a, b| a.azimuth_rad.total_cmp(&b.azimuth_rad));
    }
    beams.sort_by(|a, b| elevation(a).total_cmp(&elevation(b)));
    beams
}

/// Height of the point that the beams of a sweep without rings come from above its sensor's place, m: that from which
/// elevations are least spread. A few centimetres blur the beams of near returns.
fn beam_origin_m(recording: &SweepRecording, file_from_world: &Pose, sensor: DVec3) -> f64 {
    let every = (recording.returns.len() / SAMPLED).max(1);
    let sample = recording.returns.iter().flatten().step_by(every);
    let ways: Vec<(f64, f64)> = sample
        .filter(|r| r.ring == RecordedReturn::NO_RING)
        .map(|r| {
            let way = file_from_world.apply(r.place()) - sensor;
            (way.truncate().length(), way.z)
        })
        .collect();
    // Returns in one bin, squared and summed: the more, the fewer bins hold them.
    let crisp = |up_m: f64| {
        let mut bins: HashMap<i32, u64> = HashMap::new();
        for (flat_m, z) in &ways {
            let up_deg = (z - up_m).atan2(*flat_m).to_degrees();
            // Edges of bins are no usual elevations.
            *bins.entry((up_deg / BIN_DEG + 0.37).floor() as i32).or_default() += 1;
        }
        bins.values().map(|n| n * n).sum::<u64>()
    };
    let heights = (-ORIGIN_STEPS..=ORIGIN_STEPS).map(|i| f64::from(i) * ORIGIN_STEP_M);
    let best = heights.max_by_key(|up_m| (crisp(*up_m), std::cmp::Reverse((up_m.abs() * 1e3) as u64)));
    best.filter(|_| !ways.is_empty()).unwrap_or_default()
}

/// Mean elevation of a beam, rad.
fn elevation(beam: &[BeamReturn]) -> f64 {
    beam.iter().map(|r| r.elevation_rad).sum::<f64>() / beam.len().max(1) as f64
}

/// Angle from a return to the next on its beam, rad.
fn gap(a: &BeamReturn, b: &BeamReturn) -> f64 {
    (b.azimuth_rad - a.azimuth_rad).rem_euclid(TAU)
}

/// Middle step of a beam, rad.
fn step(beam: &[BeamReturn]) -> Option<f64> {
    let mut steps: Vec<f64> = beam.windows(2).map(|two| gap(&two[0], &two[1])).collect();
    steps.retain(|step| *step > 1e-5);
    steps.sort_by(f64::total_cmp);
    steps.get(steps.len() / 2).copied()
}

/// First direction and width of the sector that returns come from, degrees: all round unless a wide part is empty.
fn sector<'a>(returns: impl Iterator<Item = &'a BeamReturn>) -> [f64; 2] {
    let mut seen = [false; 360];
    for r in returns {
        seen[(r.azimuth_rad.to_degrees().rem_euclid(360.0) as usize).min(359)] = true;
    }
    let empty_from = |from: usize| (0..360).take_while(|i| !seen[(from + i) % 360]).count();
    let widest = (0..360).max_by_key(|from| empty_from(*from)).unwrap_or(0);
    match empty_from(widest) {
        wide if wide < WIDE_DEG || wide == 360 => [0.0, 360.0],
        wide => [((widest + wide) % 360) as f64, (360 - wide) as f64],
    }
}

/// Returns by beam: by ring, or by elevation if there are no rings.
fn beams(mut returns: Vec<(u16, BeamReturn)>) -> Vec<Vec<BeamReturn>> {
    let grouped = |returns: &[(u16, BeamReturn)], same: &dyn Fn(&Numbered, &Numbered) -> bool| {
        let groups = returns.chunk_by(|a, b| same(a, b));
        let full = groups.filter(|beam| beam.len() >= LEAST);
        full.map(|beam| beam.iter().map(|r| r.1).collect::<Vec<_>>())
            .collect::<Vec<_>>()
    };
    if returns.iter().all(|(ring, _)| *ring != RecordedReturn::NO_RING) {
        returns.sort_by(|a, b| {
            (a.0, a.1.azimuth_rad)
                .partial_cmp(&(b.0, b.1.azimuth_rad))
                .unwrap_or(Equal)
        });
        let beams = grouped(&returns, &|a, b| a.0 == b.0);
        if beams.len() <= MOST_BEAMS && beams.iter().all(|beam| is_smooth(beam)) {
            return beams;
        }
        // The field is no number of a ring.
    }
    returns.sort_by(|a, b| a.1.elevation_rad.total_cmp(&b.1.elevation_rad));
    let by_elevation = SAME_DEG.iter().map(|same_deg| {
        let same = |a: &Numbered, b: &Numbered| b.1.elevation_rad - a.1.elevation_rad < same_deg.to_radians();
        grouped(&returns, &same)
    });
    // Elevations that run into each other tell no beams.
    let are_thin = |beams: &Vec<Vec<BeamReturn>>| {
        let held: usize = beams.iter().map(Vec::len).sum();
        let thin = beams
            .iter()
            .all(|beam| thickness(beam) < THICKEST_DEG.to_radians());
        thin && beams.len() <= MOST_FOUND && held as f64 >= LEAST_HELD * returns.len() as f64
    };
    by_elevation.into_iter().find(are_thin).unwrap_or_default()
}

/// A return and its ring.
type Numbered = (u16, BeamReturn);

/// True if neighbours on a beam have nearly one elevation.
fn is_smooth(beam: &[BeamReturn]) -> bool {
    let mut steps: Vec<f64> = beam
        .windows(2)
        .map(|two| (two[1].elevation_rad - two[0].elevation_rad).abs())
        .collect();
    steps.sort_by(f64::total_cmp);
    steps
        .get(steps.len() / 2)
        .is_none_or(|step| *step <= THICKEST_DEG.to_radians())
}

fn thickness(beam: &[BeamReturn]) -> f64 {
    let ends = beam.first().zip(beam.last());
    ends.map_or(0.0, |(a, b)| b.elevation_rad - a.elevation_rad)
}

fn fill_gaps(beam: &[BeamReturn], world_from_file: &Pose, rays: &mut Vec<EmptyRay>) {
    let Some(step) = step(beam).filter(|step| TAU / step <= MOST_COLUMNS) else {
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
            let between = i64::from(b.record) - i64::from(a.record);
            let has_slots = between.unsigned_abs() % missing as u64 == 0;
            let slot = i64::from(a.record) + between / missing as i64 * i as i64;
            let azimuth = a.azimuth_rad + wide * share;
            let elevation = a.elevation_rad + (b.elevation_rad - a.elevation_rad) * share;
            let (sin, cos) = elevation.sin_cos();
            let in_file = DVec3::new(cos * azimuth.cos(), cos * azimuth.sin(), sin);
            rays.push(EmptyRay {
                direction: world_from_file.rotation * in_file,
                like: if share < 0.5 { a.record } else { b.record },
                slot: u32::try_from(slot).ok().filter(|_| has_slots),
                azimuth_rad: azimuth,
            });
        }
    }
}
