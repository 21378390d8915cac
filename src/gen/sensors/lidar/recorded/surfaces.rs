//! Upright surfaces that a recorded sweep shows from some height on, continued down to the ground: what stands behind an object
//! hides its lower part until the object is removed.

use glam::{DVec2, DVec3};

/// Width of a direction, rad.
const WIDE_RAD: f64 = 0.25 * std::f64::consts::PI / 180.0;
/// Directions of a turn.
const DIRECTIONS: usize = 1440;
/// Largest distance between two returns of one surface in a direction, m.
const APART_M: f64 = 0.4;
/// Distance behind a surface from which a return that is seen below it lies beyond it, m.
const BEYOND_M: f64 = 1.0;
/// Returns of a surface at least.
const LEAST: usize = 4;
/// Height above the ground down to which a surface must be seen, and its least height, m.
const SEEN_M: f64 = 2.0;
const TALL_M: f64 = 0.5;

/// Standing returns by direction from the sensor.
#[derive(Clone, Debug)]
pub struct StandingReturns {
    sensor: DVec3,
    directions: Vec<Vec<StandingReturn>>,
}

#[derive(Clone, Copy, Debug)]
struct StandingReturn {
    record: u32,
    /// Distance along the ground, m.
    far_m: f64,
    /// Height above the ground, m.
    height_m: f64,
    /// Height in the frame of the ray, m.
    z: f64,
    /// Rise of its ray, m for each m along the ground.
    rise: f64,
    strength: f32,
}

/// A hit on a surface.
pub struct SurfaceHit {
    /// Distance along the ray, m.
    pub t_m: f64,
    /// Mean strength of the surface's returns.
    pub strength: f32,
    /// A return of the surface.
    pub record: u32,
}

impl StandingReturns {
    /// Returns that stand on the ground: record, place, height above the ground in m, strength.
    pub fn new(sensor: DVec3, returns: impl Iterator<Item = (u32, DVec3, f64, f32)>) -> Self {
        let mut directions = vec![Vec::new(); DIRECTIONS];
        for (record, at, height_m, strength) in returns {
            let way = (at - sensor).truncate();
            directions[direction(way)].push(StandingReturn {
                record,
                far_m: way.length(),
                height_m,
                z: at.z,
                rise: (at.z - sensor.z) / way.length().max(1e-6),
                strength,
            });
        }
        for some in &mut directions {
            some.sort_by(|a, b| a.far_m.total_cmp(&b.far_m));
        }
        Self { sensor, directions }
    }

    /// Where a ray from the sensor meets a surface beyond `from_m`, of returns that are `there`.
    pub fn met_by(&self, way: DVec3, from_m: f64, there: impl Fn(u32) -> bool) -> Option<SurfaceHit> {
        let flat = way.truncate();
        let (cos, at) = (flat.length(), direction(flat));
        let around = [at + DIRECTIONS - 1, at, at + 1].map(|d| d % DIRECTIONS);
        let mut returns: Vec<&StandingReturn> = around
            .iter()
            .flat_map(|d| &self.directions[*d])
            .filter(|r| r.far_m >= from_m * cos && there(r.record))
            .collect();
        returns.sort_by(|a, b| a.far_m.total_cmp(&b.far_m));
        let surfaces = returns.chunk_by(|a, b| b.far_m - a.far_m <= APART_M);
        let rise = way.z / cos.max(1e-6);
        surfaces.into_iter().find_map(|surface| {
            let low = surface.iter().map(|r| r.height_m).fold(f64::INFINITY, f64::min);
            let high = surface.iter().map(|r| r.height_m).fold(0.0, f64::max);
            let top_z = surface.iter().map(|r| r.z).fold(f64::NEG_INFINITY, f64::max);
            if surface.len() < LEAST || low > SEEN_M || high - low < TALL_M {
                return None;
            }
            // What is seen below a surface and beyond it shows that it does not go on.
            let lowest_rise = surface.iter().map(|r| r.rise).fold(f64::INFINITY, f64::min);
            let end_m = surface.last().map_or(0.0, |r| r.far_m) + BEYOND_M;
            let is_below = |r: &&&StandingReturn| r.rise > rise && r.rise < lowest_rise;
            if returns.iter().filter(is_below).any(|r| r.far_m > end_m) {
                return None;
            }
            // The lower part of a surface that leans is nearest to its lowest returns.
            let lowest = surface.iter().filter(|r| r.height_m <= low + TALL_M);
            let (n, sum) = lowest.fold((0.0, 0.0), |(n, sum), r| (n + 1.0, sum + r.far_m));
            let t_m = sum / n / cos.max(1e-6);
            let z = self.sensor.z + way.z * t_m;
            let strength = surface.iter().map(|r| r.strength).sum::<f32>() / surface.len() as f32;
            (z <= top_z + 0.1).then_some(SurfaceHit {
                t_m,
                strength,
                record: surface[0].record,
            })
        })
    }
}

/// Number of a direction on the ground.
fn direction(way: DVec2) -> usize {
    let turn = way.y.atan2(way.x).rem_euclid(std::f64::consts::TAU);
    (turn / WIDE_RAD) as usize % DIRECTIONS
}
