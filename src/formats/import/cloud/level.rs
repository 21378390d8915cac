//! The height of the ground in a cloud, and how far the cloud must be lifted so that it lies on the map.
//!
//! - The **lowest return** of each square of 1 m within 25 m is taken, if two others lie just above it: a single one
//!   below the road is an echo by way of a mirror. Squares of one or two returns are taken as they are.
//! - A **plane** is fitted to them by RANSAC: the best of 400 planes through three of them (tilted by 12 degrees at
//!   most) by the number of lowest returns on it minus the number below it, then least squares through those on it.
//! - The plane is the ground if enough squares lie on it in enough directions, which a table or a ceiling does not
//!   have.
//!
//! Equal points give an equal plane: random draws start from a fixed seed.

use glam::{DQuat, DVec2, DVec3};
use numeric::linear::solve;
use numeric::splitmix::SplitMix64;
use scene::Pose;

/// Farthest distance from the origin at which ground is looked for, along the ground, m.
const REACH_M: f64 = 25.0;
/// Nearest: closer returns are of the vehicle, m.
const NEAREST_M: f64 = 1.0;
/// Squares along one side of the area around the reach; each is 1 m wide.
const SIDE: usize = 2 * REACH_M as usize;
/// Height within which a lowest return has two others above it, m; squares of one or two returns are taken as they are.
const SUPPORT_M: f32 = 0.2;
/// Planes that RANSAC tries.
const TRIALS: usize = 400;
/// Slope of the steepest plane: 12 degrees.
const STEEPEST: f64 = 0.2126;
/// Twice the area of the smallest triangle of a plane, from above, m². Smaller triangles do not determine a plane.
const LEAST_SPREAD_M2: f64 = 8.0;
/// Height above or below a plane within which a lowest return lies on it, m.
const ON_M: f64 = 0.15;
/// Depth below a plane from which a lowest return counts against it, m.
const BELOW_M: f64 = 0.4;
/// Fewest squares that lie on ground.
const FEWEST_SQUARES: usize = 50;
/// Smallest share of all squares that lie on ground.
const LEAST_SHARE: f64 = 0.25;
/// Parts of the horizon.
const DIRECTIONS: usize = 8;
/// Fewest directions in which ground lies.
const LEAST_DIRECTIONS: u32 = 3;
/// Lowest height of ground in the ego frame, m: labelled clouds have the road at -0.8 m.
const LOWEST_M: f64 = -0.9;
/// Highest height of ground in the ego frame, m: the top of the map.
const HIGHEST_M: f64 = scene::Window::MAX_M[2];
/// Height by which the ground of a cloud without labels is off at least if the cloud is moved, m.
const OFF_M: f64 = 0.25;
/// Greatest height at which a vehicle carries a sensor, m.
pub(super) const HIGHEST_MOUNT_M: f64 = 5.0;
/// Smallest tilt that is reported, and for which a cloud is turned, degrees: the ground is 0.7 m off at 20 m.
const TILTED_DEG: f64 = 2.0;

/// The ground around the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct GroundPlane {
    /// Height at the origin, m.
    pub(super) height_m: f64,
    /// Slope along x and y.
    pub(super) slope: DVec2,
    /// True if most of it lies below or above the heights that ground of the ego frame has.
    is_off_heights: bool,
}

impl GroundPlane {
    /// The ground that these points lie on; `None` if they show no ground.
    pub(super) fn from_points(points: impl Iterator<Item = DVec3>) -> Option<Self> {
        let lowest = lowest_returns(points);
        let plane = fit_plane(&lowest)?;
        let on: Vec<DVec3> = lowest
            .iter()
            .filter(|p| plane.above_m(**p).abs() < ON_M)
            .copied()
            .collect();
        let directions = on.iter().fold(0u8, |seen, p| seen | 1 << direction(p.truncate()));
        let is_ground = on.len() >= FEWEST_SQUARES
            && on.len() as f64 >= LEAST_SHARE * lowest.len() as f64
            && directions.count_ones() >= LEAST_DIRECTIONS;
        let off_heights = on
            .iter()
            .filter(|p| !(LOWEST_M..=HIGHEST_M).contains(&p.z))
            .count();
        is_ground.then_some(Self {
            is_off_heights: 2 * off_heights > on.len(),
            ..plane
        })
    }

    /// How far a cloud with this ground must be lifted to lie on the map, m, to the centimetre; 0 where it does.
    pub(super) fn lift_m(self) -> f64 {
        match self.is_off_heights && !(LOWEST_M..=HIGHEST_M).contains(&self.height_m) {
            true => -(self.height_m * 100.0).round() / 100.0,
            false => 0.0,
        }
    }

    /// The same for a cloud without labels, whose ground lies where vehicles stand on it.
    pub(super) fn unlabelled_lift_m(self) -> f64 {
        match self.height_m.abs() > OFF_M {
            true => -(self.height_m * 100.0).round() / 100.0,
            false => 0.0,
        }
    }

    /// How a cloud in its sensor's frame with this ground comes to lie level on the map: turned where it is tilted, then lifted.
    pub(super) fn leveling(self) -> Pose {
        let rotation = match self.is_tilted() {
            true => DQuat::from_rotation_arc((-self.slope).extend(1.0).normalize(), DVec3::Z),
            false => DQuat::IDENTITY,
        };
        let foot = rotation * (DVec3::Z * self.height_m);
        Pose {
            rotation,
            translation_m: (-foot * 100.0).round() / 100.0,
        }
    }

    /// The ground of a cloud that was moved so.
    pub(super) fn moved(self, by: &Pose) -> Self {
        let normal = by.rotation * (-self.slope).extend(1.0);
        let at = by.apply(DVec3::Z * self.height_m);
        let slope = -normal.truncate() / normal.z;
        Self {
            height_m: at.z - slope.dot(at.truncate()),
            slope,
            is_off_heights: false,
        }
    }

    fn tilt_deg(self) -> f64 {
        self.slope.length().atan().to_degrees()
    }

    /// True if it is so steep that a cloud of a sensor is turned for it.
    fn is_tilted(self) -> bool {
        self.tilt_deg() >= TILTED_DEG
    }

    /// True if a cloud with this ground lies in the frame of a sensor that a vehicle carries.
    pub(super) fn is_below_a_sensor(self) -> bool {
        self.lift_m() > 0.0 && self.lift_m() <= HIGHEST_MOUNT_M
    }

    /// Notes on what was done with a cloud of a sensor that was placed by its ground, for a person.
    pub(super) fn placed_notes(self, mount_m: f64) -> Vec<String> {
        let mut out = vec![format!(
            "the sensor stands {mount_m:.2} m above the road, as the sweep shows"
        )];
        out.extend(self.left_note());
        out
    }

    /// Note on ground that is not level and was left so.
    fn left_note(self) -> Option<String> {
        self.is_tilted()
            .then(|| format!("the ground is tilted by {:.1} degrees: left so", self.tilt_deg()))
    }

    fn turned_note(self) -> Option<String> {
        self.is_tilted()
            .then(|| format!("turned by {:.1} degrees: its ground was tilted", self.tilt_deg()))
    }

    /// Notes on what was done with a cloud that was lifted so far, for a person.
    pub(super) fn notes(self, lift_m: f64) -> Vec<String> {
        let mut out = match lift_m {
            0.0 => Vec::new(),
            _ if self.is_below_a_sensor() => {
                vec![format!(
                    "the sweep lies in its sensor's frame: lifted by {lift_m:.2} m"
                )]
            }
            m if m > 0.0 => vec![format!(
                "the ground lies at {:.2} m: lifted by {m:.2} m",
                self.height_m
            )],
            m => vec![format!(
                "the ground lies at {:.2} m: lowered by {:.2} m",
                self.height_m, -m
            )],
        };
        match self.is_below_a_sensor() {
            true => out.extend(self.turned_note()),
            false => out.extend(self.left_note()),
        }
        out
    }

    /// Height above it, m.
    pub(super) fn above_m(self, p: DVec3) -> f64 {
        p.z - self.height_m - self.slope.dot(p.truncate())
    }
}

/// Which eighth of the horizon a place lies in.
fn direction(at: DVec2) -> usize {
    let turn = at.to_angle() / std::f64::consts::TAU + 0.5;
    ((turn * DIRECTIONS as f64) as usize).min(DIRECTIONS - 1)
}

/// The lowest return of each square that has two others just above it; squares of one or two returns are taken as they
/// are.
fn lowest_returns(points: impl Iterator<Item = DVec3>) -> Vec<DVec3> {
    let mut squares: Vec<Vec<[f32; 3]>> = vec![Vec::new(); SIDE * SIDE];
    for p in points {
        let distance_m = p.truncate().length();
        if (NEAREST_M..REACH_M).contains(&distance_m) {
            let [x, y] = [p.x, p.y].map(|v| ((v + REACH_M) as usize).min(SIDE - 1));
            squares[x * SIDE + y].push(p.as_vec3().to_array());
        }
    }
    let lowest_supported = |square: &mut Vec<[f32; 3]>| {
        square.sort_unstable_by(|a, b| a[2].total_cmp(&b[2]));
        let found = match square.len() {
            0..=2 => square.first(),
            _ => square
                .windows(3)
                .find(|w| w[2][2] - w[0][2] < SUPPORT_M)
                .map(|w| &w[0]),
        };
        found.map(|p| DVec3::from_array(p.map(f64::from)))
    };
    squares.iter_mut().filter_map(lowest_supported).collect()
}

/// The plane that most of these points lie on and few lie below; `None` if no three of them give one.
fn fit_plane(points: &[DVec3]) -> Option<GroundPlane> {
    let mut random = SplitMix64::new(0);
    let mut best: Option<(i64, GroundPlane)> = None;
    for _ in 0..TRIALS {
        if points.len() < 3 {
            return None;
        }
        let three = [(); 3].map(|()| points[random.below(points.len())]);
        let Some(plane) = through(three) else { continue };
        let score = points.iter().map(|p| match plane.above_m(*p) {
            above if above.abs() < ON_M => 1,
            above => -i64::from(above < -BELOW_M),
        });
        let score = score.sum();
        if best.is_none_or(|(most, _)| score > most) {
            best = Some((score, plane));
        }
    }
    let (_, mut plane) = best?;
    for _ in 0..5 {
        let on = points.iter().filter(|p| plane.above_m(**p).abs() < ON_M);
        plane = fitted(on).unwrap_or(plane);
    }
    Some(plane)
}

/// The plane through three points, if they determine one that is not too steep.
fn through([a, b, c]: [DVec3; 3]) -> Option<GroundPlane> {
    let (ab, ac) = (b - a, c - a);
    let area = ab.truncate().perp_dot(ac.truncate());
    let slope = DVec2::new(ab.z * ac.y - ac.z * ab.y, ac.z * ab.x - ab.z * ac.x) / area;
    (area.abs() >= LEAST_SPREAD_M2 && slope.length() <= STEEPEST).then(|| GroundPlane {
        height_m: a.z - slope.dot(a.truncate()),
        slope,
        is_off_heights: false,
    })
}

/// The plane of least squares, if it is not too steep. Ridge term of weight 1 per point on the slope: keeps the plane
/// level across a narrow strip.
fn fitted<'a>(points: impl Iterator<Item = &'a DVec3>) -> Option<GroundPlane> {
    let mut rows = vec![vec![0.0; 4]; 3];
    for p in points {
        let row = [p.x, p.y, 1.0, p.z];
        rows[0][0] += 1.0;
        rows[1][1] += 1.0;
        for (i, sums) in rows.iter_mut().enumerate() {
            for (sum, v) in sums.iter_mut().zip(row) {
                *sum += row[i] * v;
            }
        }
    }
    let found = solve(rows)?;
    let slope = DVec2::new(found[0], found[1]);
    (slope.length() <= STEEPEST).then_some(GroundPlane {
        height_m: found[2],
        slope,
        is_off_heights: false,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns of a plane with this height and slope, on a lattice of 0.5 m within 20 m, a wall along x at y = 8 m and
    /// a car.
    fn street(height_m: f64, slope: DVec2) -> Vec<DVec3> {
        let mut out = Vec::new();
        let mut random = SplitMix64::new(7);
        let mut put = |x: f64, y: f64, up_m: f64| {
            let z = height_m + slope.dot(DVec2::new(x, y)) + up_m + 0.06 * (random.unit() - 0.5);
            out.push(DVec3::new(x, y, z));
        };
        for i in -40..40 {
            let x = f64::from(i) * 0.5;
            (-40..16).for_each(|j| put(x, f64::from(j) * 0.5, 0.0));
            (0..30).for_each(|k| put(x, 8.1, f64::from(k) * 0.2));
        }
        for i in 0..20 {
            (0..8).for_each(|k| put(4.0 + f64::from(i) * 0.2, -3.0, 0.3 + f64::from(k) * 0.2));
        }
        out
    }

    #[test]
    fn ground_is_found_at_its_height_whatever_its_tilt() {
        for height_m in [-2.2, -1.84, -0.8, 0.0, 35.0] {
            for slope in [DVec2::ZERO, DVec2::new(0.05, 0.0), DVec2::new(-0.08, 0.07)] {
                let found = GroundPlane::from_points(street(height_m, slope).into_iter()).expect("ground");
                assert!(
                    (found.height_m - height_m).abs() < 0.03,
                    "{found:?}, expected {height_m}"
                );
                assert!(found.slope.distance(slope) < 0.01, "{found:?}, expected {slope}");
            }
        }
    }

    /// Echoes by way of a mirror lie below the road, one in twenty of the squares has some.
    #[test]
    fn echoes_below_the_road_do_not_draw_it_down() {
        let mut points = street(-1.9, DVec2::ZERO);
        for i in 0..80 {
            let turn = f64::from(i) * 0.7;
            points
                .push((DVec2::from_angle(turn) * (4.0 + f64::from(i % 15))).extend(-4.0 - f64::from(i % 3)));
        }
        let found = GroundPlane::from_points(points.into_iter()).expect("ground");
        assert!((found.height_m + 1.9).abs() < 0.03, "{found:?}");
    }

    #[test]
    fn what_is_no_ground_is_not_taken_for_it() {
        let of = |points: Vec<DVec3>| GroundPlane::from_points(points.into_iter());
        assert_eq!(of(Vec::new()), None);
        assert_eq!(of(vec![DVec3::NAN; 100]), None);
        assert_eq!(
            of((0..3)
                .map(|i| DVec3::new(5.0 + f64::from(i), 0.0, -2.0))
                .collect()),
            None
        );
        // The walls of a hall without its floor, and a table in front of the sensor.
        let mut hall = Vec::new();
        for i in 0..200 {
            let along = f64::from(i) * 0.1 - 10.0;
            for k in 0..20 {
                let z = f64::from(k) * 0.2 - 1.0;
                hall.extend([DVec3::new(along, 10.0, z), DVec3::new(10.0, along, z)]);
            }
        }
        assert_eq!(of(hall.clone()), None);
        hall.extend(
            (0..400).map(|i| DVec3::new(2.0 + f64::from(i % 20) * 0.1, f64::from(i / 20) * 0.1, -0.5)),
        );
        assert_eq!(of(hall), None);
    }

    #[test]
    fn only_ground_off_the_map_is_lifted_and_that_is_told() {
        let ground = |height_m| GroundPlane {
            height_m,
            slope: DVec2::ZERO,
            is_off_heights: true,
        };
        for height_m in [-0.83, -0.37, 0.0, 1.0] {
            assert_eq!(ground(height_m).lift_m(), 0.0, "{height_m}");
            assert_eq!(ground(height_m).notes(0.0), Vec::<String>::new());
        }
        assert_eq!(ground(-1.838).lift_m(), 1.84);
        let notes = |height_m| ground(height_m).notes(-height_m).concat();
        assert_eq!(
            notes(-1.838),
            "the sweep lies in its sensor's frame: lifted by 1.84 m"
        );
        assert_eq!(notes(35.2), "the ground lies at 35.20 m: lowered by 35.20 m");
        assert_eq!(notes(-35.2), "the ground lies at -35.20 m: lifted by 35.20 m");
        let tilted = GroundPlane {
            slope: DVec2::new(0.1, 0.0),
            ..ground(0.0)
        };
        assert_eq!(
            tilted.notes(0.0),
            ["the ground is tilted by 5.7 degrees: left so"]
        );
        let turned = GroundPlane {
            slope: DVec2::new(0.1, 0.0),
            ..ground(-2.0)
        };
        assert_eq!(
            turned.notes(2.0)[1],
            "turned by 5.7 degrees: its ground was tilted"
        );
        let level = turned.leveling();
        for at in [DVec2::ZERO, DVec2::new(20.0, 0.0), DVec2::new(-8.0, 13.0)] {
            let foot = at.extend(turned.height_m + turned.slope.dot(at));
            assert!(level.apply(foot).z.abs() < 0.01, "{foot}");
        }
        let now = turned.moved(&level);
        assert!(now.height_m.abs() < 0.01 && now.slope.length() < 1e-9, "{now:?}");
    }
}
