//! Speeds of a driver who keeps a distance: the Intelligent Driver Model. Treiber, Hennecke and Helbing 2000,
//! arXiv cond-mat/0002177.

use glam::DVec2;

use scene::clip::Speed;
use scene::road_map::project;
use scene::{BoxId, Class, SceneBox};

/// Parameters of a driver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Driver {
    /// Speed behind a vehicle that is faster than `desired_mps`, m/s: a follower goes as fast as it takes to keep up.
    pub desired_mps: f64,
    /// Speed behind a vehicle that is faster than `desired_mps`, m/s: a follower goes as fast as it takes to keep up.
    pub catching_up_mps: f64,
    /// Free distance kept at every speed, m, instead of `headway_s` and `gap_m`.
    pub headway_s: f64,
    /// Distance kept while standing, m.
    pub gap_m: f64,
    /// Free distance kept at every speed, m, in place of the two before.
    pub keeps_m: Option<f64>,
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
            catching_up_mps: desired_mps,
            headway_s: 1.5,
            gap_m: 2.0,
            keeps_m: None,
            acceleration: 1.5,
            braking: 2.0,
        }
    }

    /// Acceleration at a speed, m/s², with a vehicle `ahead` (free distance, m; its speed, m/s). At least -9: tyres do
    /// no more.
    pub fn acceleration(&self, mps: f64, ahead: Option<(f64, f64)>) -> f64 {
        let desired_mps = ahead.map_or(self.desired_mps, |_| self.desired_mps.max(self.catching_up_mps));
        let free = 1.0 - (mps / desired_mps.max(0.1)).powi(4);
        let near = ahead.map_or(0.0, |(gap_m, other_mps)| {
            let closing = mps * (mps - other_mps) / (2.0 * (self.acceleration * self.braking).sqrt());
            let wanted_m = self.gap_m + (mps * self.headway_s + closing).max(0.0);
            (wanted_m / gap_m.max(0.1)).powi(2)
        });
        (self.acceleration * (free - near)).max(HARDEST)
    }

    /// Acceleration that keeps a distance to the vehicle ahead (free distance, m; speed, m/s; acceleration, m/s²),
    /// m/s².
    fn keeping(&self, keeps_m: f64, mps: f64, (gap_m, other_mps, other_mps2): (f64, f64, f64)) -> f64 {
        let off_m = (gap_m - keeps_m).min(FAR_M);
        let wanted = other_mps2 + PULL * off_m + DAMPING * (other_mps - mps);
        wanted.clamp(HARDEST, self.acceleration)
    }
}

/// Braking that tyres allow, m/s².
const HARDEST: f64 = -9.0;
/// Spring of a kept distance, 1/s²; its damping, 1/s; and the deviation from which the pull grows no more, m.
const PULL: f64 = 1.0;
const DAMPING: f64 = 2.0;
const FAR_M: f64 = 8.0;

/// Limits of a class: top speed, m/s, and acceleration of a driver in a hurry, m/s².
pub fn can(class: Option<Class>) -> (f64, f64) {
    match class {
        Some(Class::Pedestrian) => (6.0, 2.0),
        Some(Class::Bicycle) => (11.0, 1.5),
        Some(Class::Bus | Class::Truck | Class::Trailer) => (28.0, 1.5),
        Some(Class::ConstructionVehicle) => (11.0, 1.2),
        _ => (60.0, 3.0),
    }
}

/// Another road user at a moment.
#[derive(Clone, Copy, Debug)]
pub struct Other {
    /// The box; `None` for the ego vehicle.
    pub id: Option<BoxId>,
    /// Position, size and velocity.
    pub body: SceneBox,
}

impl Other {
    /// Half of its extent along a direction, m.
    fn half_m(&self, way: DVec2) -> f64 {
        let heading = self.body.heading();
        (self.body.size_m.x * heading.dot(way).abs() + self.body.size_m.y * heading.perp_dot(way).abs()) / 2.0
    }
}

/// Body of a driving vehicle, measured from the point that its path leads: a box's middle, the ego vehicle's rear axle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VehicleBody {
    /// From there to its front, m.
    pub front_m: f64,
    /// Half of its width, m.
    pub half_width_m: f64,
}

/// Result of following: speeds, and the gap.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Followed {
    /// Speeds at times.
    pub speeds: Vec<Speed>,
    /// Free distance to the first vehicle ahead, m: at the start, and at the end; `None` if none was ahead.
    pub gap_m: Option<[f64; 2]>,
}

/// Time between two speeds, s.
pub(crate) const STEP_S: f64 = 0.1;
/// Distance from the path beyond which a vehicle is not on it, m, if it is also farther away than the half-widths of
/// both bodies together.
const BESIDE_M: f64 = 1.7;

/// The nearest road user ahead on a path, by free distance: the user, the distance, m, and the path's direction there.
pub fn ahead_of(
    points_m: &[DVec2],
    along_m: f64,
    body: &VehicleBody,
    others: &[Other],
) -> Option<(Other, f64, DVec2)> {
    // Objects that are not even near the path's rectangle need no projection.
    let inf = DVec2::splat(f64::INFINITY);
    let (low, high) = points_m
        .iter()
        .fold((inf, -inf), |(low, high), p| (low.min(*p), high.max(*p)));
    let found = others.iter().filter_map(|other| {
        let at_m = other.body.center_m.truncate();
        let reach_m = BESIDE_M + body.half_width_m + other.body.size_m.truncate().length();
        if (at_m - at_m.clamp(low, high)).length() > reach_m {
            return None;
        }
        let on_path = project(points_m, at_m)?;
        let way = on_path.direction;
        // Objects beside or behind do not count.
        let beside_m = BESIDE_M.max(body.half_width_m + other.half_m(way.perp()));
        let is_ahead = on_path.along_m > along_m && on_path.distance_m <= beside_m;
        let gap_m = on_path.along_m - along_m - body.front_m - other.half_m(way);
        is_ahead.then_some((*other, gap_m, way))
    });
    found.min_by(|a, b| a.1.total_cmp(&b.1))
}

/// Speeds along a path over `length_s`, starting `start_m` along it at `start_mps`. `others` gives the road users at a
/// time.
pub fn follow(
    driver: &Driver,
    points_m: &[DVec2],
    (start_m, start_mps): (f64, f64),
    body: &VehicleBody,
    length_s: f64,
    others: impl Fn(f64) -> Vec<Other>,
) -> Followed {
    let steps = (length_s / STEP_S).ceil().clamp(1.0, 6000.0) as usize;
    let (mut along_m, mut mps) = (start_m, start_mps.max(0.0));
    let mut out = Vec::with_capacity(steps + 1);
    let mut first: Option<(Option<BoxId>, [f64; 2])> = None;
    let mut now = others(0.0);
    for i in 0..=steps {
        let time_s = i as f64 * STEP_S;
        out.push(Speed { time_s, mps });
        let nearest = ahead_of(points_m, along_m, body, &now);
        if let Some((other, gap_m, _)) = &nearest {
            match &mut first {
                None if i == 0 => first = Some((other.id, [*gap_m; 2])),
                Some((id, gap)) if *id == other.id => gap[1] = *gap_m,
                _ => {}
            }
        }
        let then = others(time_s + STEP_S);
        let wish = match (driver.keeps_m, &nearest) {
            (Some(keeps_m), Some((other, gap_m, way))) => {
                let next = then.iter().find(|o| o.id == other.id).unwrap_or(other);
                let (now_mps, next_mps) = (
                    other.body.velocity_mps.dot(*way),
                    next.body.velocity_mps.dot(*way),
                );
                driver.keeping(keeps_m, mps, (*gap_m, now_mps, (next_mps - now_mps) / STEP_S))
            }
            _ => {
                let near = nearest.map(|(other, gap_m, way)| (gap_m, other.body.velocity_mps.dot(way)));
                driver.acceleration(mps, near)
            }
        };
        let most_mps = mps.max(driver.desired_mps).max(driver.catching_up_mps);
        let next = (mps + wish * STEP_S).clamp(0.0, most_mps);
        along_m += (mps + next) / 2.0 * STEP_S;
        mps = next;
        now = then;
    }
    Followed {
        // (a gap that is kept to the decimetre needs speeds as exact)
        speeds: thinned(
            &out,
            if driver.keeps_m.is_some() {
                OFF_MPS / 5.0
            } else {
                OFF_MPS
            },
        ),
        gap_m: first.map(|f| f.1),
    }
}

/// Speeds between those that are kept lie within this of the straight line between them, m/s.
const OFF_MPS: f64 = 0.1;

/// The few of a list of speeds that tell it: from each one the farthest that everything between lies near to a line to.
fn thinned(all: &[Speed], off_mps: f64) -> Vec<Speed> {
    let mut out: Vec<Speed> = all.first().copied().into_iter().collect();
    let mut from = 0;
    while from + 1 < all.len() {
        let is_told = |to: usize| {
            let (a, b) = (all[from], all[to]);
            let slope = (b.mps - a.mps) / (b.time_s - a.time_s);
            let near = |s: &Speed| (a.mps + slope * (s.time_s - a.time_s) - s.mps).abs() <= off_mps;
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

    const BODY: VehicleBody = VehicleBody {
        front_m: 2.2,
        half_width_m: 0.9,
    };

    fn other(id: u32, at_m: [f64; 2], mps: f64) -> Other {
        Other {
            id: Some(BoxId(id)),
            body: SceneBox {
                id: BoxId(id),
                class: Class::Car,
                center_m: glam::DVec3::new(at_m[0], at_m[1], 0.8),
                size_m: glam::DVec3::new(4.4, 1.8, 1.6),
                yaw_rad: 0.0,
                velocity_mps: DVec2::new(mps, 0.0),
                label: Default::default(),
            },
        }
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
        let found = follow(&Driver::at(13.9), &road(), (0.0, 0.0), &BODY, 25.0, |_| {
            Vec::new()
        })
        .speeds;
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
                other(1, [x, 0.4], mps),
                // Beside and behind: neither slows it.
                other(2, [x - 10.0, 3.5], 0.0),
            ]
        };
        let found = follow(&Driver::at(13.9), &road(), (0.0, 13.0), &BODY, 25.0, others).speeds;
        for t in (0..250).map(|i| f64::from(i) * 0.1) {
            let gap_m = lead(t).0 - place_m(&found, t) - 4.4;
            assert!(gap_m > 0.5, "{gap_m} m at {t} s");
        }
        // While it lasted: 8 m/s, at about 2 m and 1.5 s.
        let gap_m = lead(9.9).0 - place_m(&found, 9.9) - 4.4;
        assert!((12.0..17.0).contains(&gap_m), "{gap_m} m");
        assert!(found.last().expect("some").mps < 0.1);
    }

    /// A leader who speeds up, slows down and stops: a distance that is kept is kept to a few decimetres throughout.
    #[test]
    fn a_distance_is_kept_whatever_the_leader_does() {
        let pace = |t: f64| match t {
            t if t < 3.0 => 10.0,
            t if t < 6.0 => 10.0 + 2.0 * (t - 3.0),
            t if t < 10.0 => 16.0,
            t => (16.0 - 4.0 * (t - 10.0)).max(0.0),
        };
        let place = |t: f64| {
            let steps = (t * 100.0).round() as usize;
            30.0 + (0..steps).map(|i| pace(i as f64 / 100.0) * 0.01).sum::<f64>()
        };
        for keeps_m in [5.0, 12.0, 25.6] {
            let driver = Driver {
                keeps_m: Some(keeps_m),
                catching_up_mps: 60.0,
                acceleration: 3.0,
                ..Driver::at(10.0)
            };
            let others = |t: f64| vec![other(1, [place(t), 0.0], pace(t))];
            let found = follow(&driver, &road(), (0.0, 10.0), &BODY, 16.0, others);
            for t in (105..=160).map(|i| f64::from(i) * 0.1) {
                let gap_m = place(t) - place_m(&found.speeds, t) - 4.4;
                assert!(
                    (gap_m - keeps_m).abs() < 0.8,
                    "{gap_m} m in place of {keeps_m} at {t} s"
                );
            }
            let [_, last] = found.gap_m.expect("somebody is ahead");
            assert!((last - keeps_m).abs() < 0.3, "{last}");
        }
    }

    #[test]
    fn who_stands_across_the_path_is_in_the_way() {
        let mut bus = other(1, [40.0, 4.0], 0.0);
        bus.body.size_m.x = 12.0;
        let past = ahead_of(&road(), 0.0, &BODY, &[bus]);
        assert!(past.is_none(), "beside the path, along it");
        bus.body.yaw_rad = std::f64::consts::FRAC_PI_2;
        let (_, gap_m, _) = ahead_of(&road(), 0.0, &BODY, &[bus]).expect("across it");
        assert!((gap_m - (40.0 - 0.9 - 2.2)).abs() < 1e-9, "{gap_m}");
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
