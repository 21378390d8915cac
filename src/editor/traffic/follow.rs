//! Speeds of a driver who keeps a distance: the Intelligent Driver Model. Treiber, Hennecke and Helbing 2000,
//! arXiv cond-mat/0002177.

use glam::DVec2;

use scene::clip::Speed;
use scene::road_map::project;

/// How somebody drives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Driver {
    /// Speed on a free road, m/s.
    pub desired_mps: f64,
    /// Time kept to the vehicle ahead, s.
    pub headway_s: f64,
    /// Distance kept while standing, m.
    pub gap_m: f64,
    /// Acceleration, m/s².
    pub acceleration: f64,
    /// Comfortable braking, m/s².
    pub braking: f64,
}

impl Driver {
    /// An ordinary one.
    pub fn at(desired_mps: f64) -> Self {
        Self {
            desired_mps,
            headway_s: 1.5,
            gap_m: 2.0,
            acceleration: 1.5,
            braking: 2.0,
        }
    }

    /// Acceleration at a speed, with somebody `ahead` (free distance, m; their speed, m/s), m/s². At least -9: tyres do no
    /// more.
    pub fn acceleration(&self, mps: f64, ahead: Option<(f64, f64)>) -> f64 {
        let free = 1.0 - (mps / self.desired_mps.max(0.1)).powi(4);
        let near = ahead.map_or(0.0, |(gap_m, other_mps)| {
            let closing = mps * (mps - other_mps) / (2.0 * (self.acceleration * self.braking).sqrt());
            let wanted_m = self.gap_m + (mps * self.headway_s + closing).max(0.0);
            (wanted_m / gap_m.max(0.1)).powi(2)
        });
        (self.acceleration * (free - near)).max(-9.0)
    }
}

/// Somebody else on the road at a moment.
#[derive(Clone, Copy, Debug)]
pub struct Other {
    /// Where, m.
    pub at_m: DVec2,
    /// Velocity, m/s.
    pub velocity_mps: DVec2,
    /// Half of its length, m.
    pub half_length_m: f64,
}

/// Time between two speeds, s.
const STEP_S: f64 = 0.1;
/// Who is farther from the path than this is not on it, m.
const BESIDE_M: f64 = 1.7;

/// Speeds along a path over `length_s`, starting `start_m` along it at `start_mps`. `others` says who is where at a time.
pub fn speeds(
    driver: &Driver,
    points_m: &[DVec2],
    (start_m, start_mps): (f64, f64),
    half_length_m: f64,
    length_s: f64,
    others: impl Fn(f64) -> Vec<Other>,
) -> Vec<Speed> {
    let steps = (length_s / STEP_S).ceil().clamp(1.0, 6000.0) as usize;
    let (mut along_m, mut mps) = (start_m, start_mps.max(0.0));
    let mut out = Vec::with_capacity(steps + 1);
    for i in 0..=steps {
        let time_s = i as f64 * STEP_S;
        out.push(Speed { time_s, mps });
        let ahead = others(time_s).into_iter().filter_map(|other| {
            let on_path = project(points_m, other.at_m)?;
            let beside_m = on_path.distance_m;
            let gap_m = on_path.along_m - along_m - half_length_m - other.half_length_m;
            let way = on_path.direction;
            // Who is beside or behind counts for nothing.
            let is_ahead = on_path.along_m > along_m && beside_m <= BESIDE_M;
            is_ahead.then(|| (gap_m, other.velocity_mps.dot(way)))
        });
        let nearest = ahead.min_by(|a, b| a.0.total_cmp(&b.0));
        let next = (mps + driver.acceleration(mps, nearest) * STEP_S).max(0.0);
        along_m += (mps + next) / 2.0 * STEP_S;
        mps = next;
    }
    thinned(&out)
}

/// Speeds between those that are kept lie within this of the straight line between them, m/s.
const OFF_MPS: f64 = 0.1;

/// The few of a list of speeds that tell it: from each one the farthest that everything between lies near to a line to.
fn thinned(all: &[Speed]) -> Vec<Speed> {
    let mut out: Vec<Speed> = all.first().copied().into_iter().collect();
    let mut from = 0;
    while from + 1 < all.len() {
        let is_told = |to: usize| {
            let (a, b) = (all[from], all[to]);
            let slope = (b.mps - a.mps) / (b.time_s - a.time_s);
            let near = |s: &Speed| (a.mps + slope * (s.time_s - a.time_s) - s.mps).abs() <= OFF_MPS;
            all[from + 1..to].iter().all(near)
        };
        let to = (from + 1..all.len())
            .take_while(|to| is_told(*to))
            .last()
            .unwrap_or(from + 1);
        out.push(all[to]);
        from = to;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn road() -> Vec<DVec2> {
        (0..400).map(|i| DVec2::new(f64::from(i), 0.0)).collect()
    }

    fn place_m(speeds: &[Speed], time_s: f64) -> f64 {
        let path = scene::clip::Path {
            points_m: road(),
            start_m: 0.0,
            speeds: speeds.to_vec(),
            rear_first: false,
        };
        path.along(time_s).0
    }

    #[test]
    fn on_a_free_road_the_desired_speed_is_reached() {
        let found = speeds(&Driver::at(13.9), &road(), (0.0, 0.0), 2.2, 25.0, |_| Vec::new());
        assert!((found.last().expect("some").mps - 13.9).abs() < 0.3);
        let harshest = found
            .windows(2)
            .map(|w| (w[1].mps - w[0].mps) / (w[1].time_s - w[0].time_s));
        assert!(harshest.fold(0.0, f64::max) < 1.51);
        assert!(found.len() < 20, "{} speeds", found.len());
    }

    #[test]
    fn behind_somebody_the_headway_is_kept_and_nobody_is_hit() {
        // One ahead drives 8 m/s, brakes to a stop at 10 s, from 6 m/s² on.
        let lead = |t: f64| {
            let braked = (t - 10.0).clamp(0.0, 8.0 / 6.0);
            let mps = 8.0 - 6.0 * braked;
            let way = 8.0 * t.min(10.0) + 8.0 * braked - 3.0 * braked * braked;
            (25.0 + way, mps)
        };
        let others = |t: f64| {
            let (x, mps) = lead(t);
            vec![
                Other {
                    at_m: DVec2::new(x, 0.4),
                    velocity_mps: DVec2::new(mps, 0.0),
                    half_length_m: 2.2,
                },
                // Beside and behind: neither slows it.
                Other {
                    at_m: DVec2::new(x - 10.0, 3.5),
                    velocity_mps: DVec2::ZERO,
                    half_length_m: 2.2,
                },
            ]
        };
        let found = speeds(&Driver::at(13.9), &road(), (0.0, 13.0), 2.2, 25.0, others);
        for t in (0..250).map(|i| f64::from(i) * 0.1) {
            let gap_m = lead(t).0 - place_m(&found, t) - 4.4;
            assert!(gap_m > 0.5, "{gap_m} m at {t} s");
        }
        // While it lasted: 8 m/s, at about 2 m and 1.5 s.
        let gap_m = lead(9.9).0 - place_m(&found, 9.9) - 4.4;
        assert!((12.0..17.0).contains(&gap_m), "{gap_m} m");
        assert!(found.last().expect("some").mps < 0.1);
    }

    #[test]
    fn extremes_stay_finite() {
        for desired in [0.0, 1e-9, 100.0] {
            for gap in [-5.0, 0.0, 1e-9, 1e9] {
                for mps in [0.0, 1e-12, 100.0] {
                    let a = Driver::at(desired).acceleration(mps, Some((gap, 0.0)));
                    assert!(
                        a.is_finite() && (-9.0..=1.5).contains(&a),
                        "{desired} {gap} {mps}: {a}"
                    );
                }
            }
        }
    }
}
