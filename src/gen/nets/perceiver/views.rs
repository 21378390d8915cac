//! Objects of a real sweep: the network looks at it several times, turned and thinned to sparser sensors, and what it finds most
//! of the time counts.
//!
//! It learned on worlds of our own with 32 beams and streets along x. On the sweeps of `shared/data/sweeps` a single look finds
//! six of nine cars that were marked by eye; of twelve looks, those found in two of five on average are seven of nine.

use glam::{DVec3, Vec2};
use rayon::prelude::*;
use scene::Window;

use super::detection::{Detection, DetectionGroup};
use super::stands::Stands;
use super::{LidarPerceiver, Perceived};
use crate::ModelError;

/// Of how many rows one is kept, and how many rows there are.
const THINNED: [usize; 3] = [1, 2, 4];
const ROWS: usize = 128;
/// Quarter turns.
const TURNS: usize = 4;
const LOOKS: f32 = (THINNED.len() * TURNS) as f32;
/// Returns of a sweep as the network learned with, near enough.
const RETURNS_LEARNED: usize = 36_000;
/// Depth by which boxes may reach into each other, m: they are guesses.
const INTO_M: f32 = 0.15;
/// Height above the ground from which something is no object that stands on it, m.
const FLOATS_M: f32 = 0.5;
/// Least score of a look that counts.
const LEAST: f32 = 0.2;

/// Vehicles that are found count as one kind: a van is a car to some looks and a truck to others.
fn kind(group: DetectionGroup) -> DetectionGroup {
    match group {
        DetectionGroup::Large => DetectionGroup::Car,
        other => other,
    }
}

/// Least mean score of an object that is found; `None` for kinds that are not told from street furniture on real sweeps.
fn least_mean(group: DetectionGroup) -> Option<f32> {
    match kind(group) {
        DetectionGroup::Car => Some(0.4),
        DetectionGroup::Person | DetectionGroup::Cycle => Some(0.55),
        _ => None,
    }
}

/// Distance within which finds of several looks are one object, m.
fn same_m(group: DetectionGroup) -> f32 {
    match kind(group) {
        DetectionGroup::Car => 2.0,
        _ => 1.0,
    }
}

/// Finds of one object by several looks.
struct Found {
    best: Detection,
    finds: Vec<(usize, Detection)>,
}

impl LidarPerceiver {
    /// What one look at a real sweep finds, boxes from a low score on, to be followed through a drive. Returns as for
    /// [`objects_of_sweep`](Self::objects_of_sweep); `number` is that of the sweep: each second one is looked at turned by half. Rows of sensors with more beams
    /// than the network learned with are thinned.
    pub fn glance(
        &self,
        returns: &[[f32; 4]],
        sensor_m: DVec3,
        number: usize,
    ) -> Result<Perceived, ModelError> {
        let turn = number % 2 * 2;
        // The network learned with 32 beams.
        let step = (returns.len() / RETURNS_LEARNED).clamp(1, 4);
        let rows = match step {
            1 => vec![0; returns.len()],
            _ => rows(returns, sensor_m),
        };
        let kept = returns.iter().zip(&rows).filter(|(_, row)| *row % step == 0);
        let seen = self.perceive(kept.map(|(r, _)| turned(*r, turn)), LEAST)?;
        let stands = |d: &Detection| d.center_m[2] - d.size_m[2] / 2.0 < FLOATS_M;
        let detections = seen.detections.into_iter().map(|d| back(d, turn));
        Ok(Perceived {
            detections: detections.filter(stands).collect(),
            stands: columns_back(&seen.stands, turn),
        })
    }

    /// Objects of a real sweep: x and y in the frame of the vehicle, height above the ground (m) and strength (0 to 255) of each
    /// return; `sensor_m` is where it was taken. The score of an object is the mean over the looks. The same on any number of
    /// threads.
    pub fn objects_of_sweep(
        &self,
        returns: &[[f32; 4]],
        sensor_m: DVec3,
    ) -> Result<Vec<Detection>, ModelError> {
        self.objects_from(returns, sensor_m, 1.0)
    }

    /// What many looks at a sweep find as in [`objects_of_sweep`](Self::objects_of_sweep), from this share of the usual scores on.
    pub fn objects_from(
        &self,
        returns: &[[f32; 4]],
        sensor_m: DVec3,
        share: f32,
    ) -> Result<Vec<Detection>, ModelError> {
        let rows = rows(returns, sensor_m);
        let looks = THINNED
            .into_iter()
            .flat_map(|step| (0..TURNS).map(move |turn| (step, turn)));
        let looks: Vec<(usize, usize)> = looks.collect();
        let seen: Vec<Vec<Detection>> = looks
            .par_iter()
            .map(|&(step, turn)| {
                let kept = returns.iter().zip(&rows).filter(|(_, row)| *row % step == 0);
                let seen = self.perceive(kept.map(|(r, _)| turned(*r, turn)), LEAST)?;
                Ok(seen.detections.into_iter().map(|d| back(d, turn)).collect())
            })
            .collect::<Result<_, ModelError>>()?;
        let finds = seen.into_iter().enumerate();
        let finds = finds.flat_map(|(look, found)| found.into_iter().map(move |d| (look, d)));
        let mut objects: Vec<Detection> = gathered(finds.collect())
            .iter()
            .filter_map(|found| {
                let mean = found.mean_score();
                let object = (mean >= share * least_mean(found.best.group)?).then(|| found.object(mean))?;
                (object.center_m[2] - object.size_m[2] / 2.0 < FLOATS_M).then_some(object)
            })
            .collect();
        objects.sort_by(|a, b| b.score.total_cmp(&a.score));
        Ok(apart(objects))
    }
}

/// Rows of the returns, from the lowest of [`ROWS`] on: ranks of their elevations, as a sensor with evenly used beams has them.
fn rows(returns: &[[f32; 4]], sensor_m: DVec3) -> Vec<usize> {
    let sensor = sensor_m.as_vec3();
    let elevation = |r: &[f32; 4]| {
        let flat = Vec2::new(r[0] - sensor.x, r[1] - sensor.y).length();
        (r[2] - sensor.z).atan2(flat)
    };
    let elevations: Vec<f32> = returns.iter().map(elevation).collect();
    let mut order: Vec<usize> = (0..returns.len()).collect();
    order.sort_by(|a, b| elevations[*a].total_cmp(&elevations[*b]).then(a.cmp(b)));
    let mut rows = vec![0; returns.len()];
    for (rank, i) in order.into_iter().enumerate() {
        rows[i] = rank * ROWS / returns.len();
    }
    rows
}

/// A return after so many quarter turns to the left.
fn turned([x, y, z, strength]: [f32; 4], turn: usize) -> [f32; 4] {
    let (x, y) = match turn % TURNS {
        0 => (x, y),
        1 => (-y, x),
        2 => (-x, -y),
        _ => (y, -x),
    };
    [x, y, z, strength]
}

/// A detection turned back.
fn back(detection: Detection, turn: usize) -> Detection {
    let [x, y, z] = detection.center_m;
    let [x, y, z, _] = turned([x, y, z, 0.0], TURNS - turn % TURNS);
    Detection {
        center_m: [x, y, z],
        yaw_rad: detection.yaw_rad - turn as f32 * std::f32::consts::FRAC_PI_2,
        ..detection
    }
}

/// Columns of the window, `[x][y]`, turned back.
fn columns_back(columns: &[Stands], turn: usize) -> Vec<Stands> {
    let (side, last) = (Window::NX, Window::NX - 1);
    let at = |c: usize| {
        let (x, y) = (c / side, c % side);
        let (x, y) = match turn % TURNS {
            0 => (x, y),
            1 => (last - y, x),
            2 => (last - x, last - y),
            _ => (y, last - x),
        };
        columns[x * side + y]
    };
    (0..columns.len()).map(at).collect()
}

/// Finds that belong to one object each, the surest first.
fn gathered(mut finds: Vec<(usize, Detection)>) -> Vec<Found> {
    finds.sort_by(|a, b| b.1.score.total_cmp(&a.1.score).then(a.0.cmp(&b.0)));
    let mut out: Vec<Found> = Vec::new();
    for (look, find) in finds {
        // A look that finds two things finds two.
        let takes = |f: &&mut Found| {
            kind(f.best.group) == kind(find.group)
                && flat_m(&f.best, &find) < same_m(find.group)
                && !f
                    .finds
                    .iter()
                    .any(|(l, other)| *l == look && other.group == find.group)
        };
        let nearest = out
            .iter_mut()
            .filter(takes)
            .min_by(|a, b| flat_m(&a.best, &find).total_cmp(&flat_m(&b.best, &find)));
        match nearest {
            Some(found) => found.finds.push((look, find)),
            None => out.push(Found {
                best: find,
                finds: vec![(look, find)],
            }),
        }
    }
    out
}

fn flat_m(a: &Detection, b: &Detection) -> f32 {
    (a.center_m[0] - b.center_m[0]).hypot(a.center_m[1] - b.center_m[1])
}

impl Found {
    /// Mean over all looks of the best score of each; 0 for those that did not find it.
    fn mean_score(&self) -> f32 {
        let mut looks: Vec<(usize, f32)> = Vec::new();
        for (look, find) in &self.finds {
            match looks.iter_mut().find(|(l, _)| l == look) {
                Some((_, score)) => *score = score.max(find.score),
                None => looks.push((*look, find.score)),
            }
        }
        looks.iter().map(|(_, score)| score).sum::<f32>() / LOOKS
    }

    /// The object: its place and size are means of finds that agree with the surest in group and axis; its heading is that of most.
    fn object(&self, score: f32) -> Detection {
        let best = &self.best;
        let agrees = |f: &Detection| f.group == best.group && (f.yaw_rad - best.yaw_rad).cos().abs() > 0.9;
        let (mut place, mut size, mut weights, mut ahead) = ([0.0; 3], [0.0; 3], 0.0, 0.0);
        for (_, f) in self.finds.iter().filter(|(_, f)| agrees(f)) {
            weights += f.score;
            for axis in 0..3 {
                place[axis] += f.score * f.center_m[axis];
                size[axis] += f.score * f.size_m[axis];
            }
            ahead += f.score * (f.yaw_rad - best.yaw_rad).cos().signum();
        }
        Detection {
            score,
            center_m: place.map(|v| v / weights),
            size_m: size.map(|v| v / weights),
            yaw_rad: match ahead < 0.0 {
                true => best.yaw_rad + std::f32::consts::PI,
                false => best.yaw_rad,
            },
            ..*best
        }
    }
}

/// Leaves out objects that overlap a surer one.
fn apart(objects: Vec<Detection>) -> Vec<Detection> {
    let mut kept: Vec<Detection> = Vec::new();
    for one in objects {
        if !kept
            .iter()
            .any(|other| reaches_into(&one, other) || reaches_into(other, &one))
        {
            kept.push(one);
        }
    }
    kept
}

/// True if the middle, a corner or the middle of a side of one box lies in another by more than a hand.
fn reaches_into(one: &Detection, other: &Detection) -> bool {
    let [ahead, aside] = [0.0, std::f32::consts::FRAC_PI_2].map(|turn| Vec2::from_angle(one.yaw_rad + turn));
    let steps = [-0.5, 0.0, 0.5];
    let points = steps.iter().flat_map(|a| steps.iter().map(move |b| (a, b)));
    points.into_iter().any(|(a, b)| {
        let at = ahead * one.size_m[0] * *a + aside * one.size_m[1] * *b;
        let way = Vec2::new(
            one.center_m[0] - other.center_m[0],
            one.center_m[1] - other.center_m[1],
        ) + at;
        let local = Vec2::from_angle(-other.yaw_rad).rotate(way).abs();
        local.x < other.size_m[0] / 2.0 - INTO_M && local.y < other.size_m[1] / 2.0 - INTO_M
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn find(x: f32, y: f32, yaw_deg: f32, score: f32) -> Detection {
        Detection {
            group: DetectionGroup::Car,
            score,
            center_m: [x, y, 0.8],
            size_m: [4.5, 1.9, 1.6],
            yaw_rad: yaw_deg.to_radians(),
        }
    }

    #[test]
    fn turning_there_and_back_leaves_a_detection_where_it_was() {
        for turn in 0..TURNS {
            let at = find(3.0, -7.0, 30.0, 0.5);
            let [x, y, z, _] = turned([3.0, -7.0, 0.8, 0.0], turn);
            let seen = Detection {
                center_m: [x, y, z],
                yaw_rad: at.yaw_rad + turn as f32 * std::f32::consts::FRAC_PI_2,
                ..at
            };
            let back = back(seen, turn);
            assert_eq!(back.center_m, at.center_m);
            assert!((back.yaw_rad - at.yaw_rad).abs() < 1e-5);
        }
    }

    #[test]
    fn an_object_is_what_most_looks_find_where_they_find_it() {
        // Eight looks find a car, three of them the other way round; one look finds another one that is not there.
        let mut finds: Vec<(usize, Detection)> = (0..8)
            .map(|look| {
                (
                    look,
                    find(
                        5.0 + 0.1 * look as f32,
                        2.0,
                        if look < 3 { 180.0 } else { 0.0 },
                        0.8,
                    ),
                )
            })
            .collect();
        finds.push((3, find(20.0, 2.0, 0.0, 0.9)));
        // Of one look that finds two things in one place the second is another.
        finds.push((3, find(5.2, 2.3, 0.0, 0.3)));
        let found = gathered(finds);
        assert_eq!(found.len(), 3);
        let car = found.iter().find(|f| f.finds.len() > 1).expect("the car");
        assert!((car.mean_score() - 8.0 * 0.8 / 12.0).abs() < 1e-5);
        let object = car.object(car.mean_score());
        assert!((object.center_m[0] - 5.33).abs() < 0.05, "{object:?}");
        assert!(object.yaw_rad.cos() > 0.99, "{object:?}");
        let ghost = found
            .iter()
            .find(|f| f.best.center_m[0] > 19.0)
            .expect("the ghost");
        assert!(ghost.mean_score() < 0.1);
    }

    #[test]
    fn of_two_objects_in_one_place_the_surer_stays() {
        let kept = apart(vec![
            find(0.0, 0.0, 0.0, 0.9),
            find(2.1, 0.3, 90.0, 0.5),
            find(3.6, 0.0, 90.0, 0.45),
            find(0.0, 3.0, 0.0, 0.4),
        ]);
        assert_eq!(kept.iter().map(|d| d.score).collect::<Vec<_>>(), [0.9, 0.45, 0.4]);
    }

    #[test]
    fn nothing_is_found_where_nothing_is() {
        let net = LidarPerceiver::bundled().expect("the shipped network");
        assert_eq!(net.objects_of_sweep(&[], DVec3::Z), Ok(Vec::new()));
        let flat: Vec<[f32; 4]> = (0..4000)
            .map(|i| [(i % 80) as f32 - 40.0, (i / 80) as f32 - 25.0, 0.0, 20.0])
            .chain([[f32::NAN; 4]])
            .collect();
        assert_eq!(net.objects_of_sweep(&flat, DVec3::Z * 1.8), Ok(Vec::new()));
    }
}
