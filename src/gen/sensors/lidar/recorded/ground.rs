//! The ground that a recorded sweep shows: a plane in each square of 1 m, from the lowest returns of the squares around.

use glam::{DVec2, DVec3};
use numeric::linear::solve;

/// Distance from the sensor within which ground is looked for, m.
const REACH_M: f64 = 80.0;
/// Squares along a side.
const SIDE: usize = 2 * REACH_M as usize;
/// Height within which the lowest return of a square has two others above it, m.
const SUPPORT_M: f64 = 0.2;
/// Height above the lowest return up to which returns are of the ground, m.
const THICK_M: f64 = 0.12;
/// Largest step between a square and the ground around it, m.
const STEP_M: f64 = 0.25;
/// Distance around the sensor within which ground is level with the vehicle, m.
const NEAR_M: f64 = 12.0;
/// Squares around one, on each side, in which ground that is known tells its height.
const GROWN: usize = 6;
/// Squares around one, on each side, that its plane is fitted to, the least first.
const FITTED: [usize; 3] = [2, 4, 6];
/// Squares that a plane is fitted to at least, and weight's distance, m.
const LEAST_FITTED: usize = 6;
const WEIGHT_M: f64 = 1.5;
/// Steepest plane.
const STEEPEST: f64 = 0.3;
/// Steps along the ground in which a ray looks for it, m, and halvings of the last.
const WALK_M: f64 = 0.5;
const HALVINGS: usize = 20;

/// Heights of the ground around a sensor.
#[derive(Clone, Debug)]
pub struct GroundMap {
    corner: DVec2,
    planes: Vec<Option<GroundPatch>>,
}

/// A plane through the middle of a square.
#[derive(Clone, Copy, Debug)]
struct GroundPatch {
    height_m: f64,
    slope: DVec2,
    /// Mean strength of the returns.
    strength: f32,
}

/// Returns of the ground in a square.
#[derive(Clone, Copy, Debug)]
struct GroundSquare {
    middle: DVec3,
    strength: f32,
}

impl GroundMap {
    /// The ground around a sensor, from the places of returns and their strengths.
    pub fn new(sensor: DVec2, returns: impl Iterator<Item = (DVec3, f32)>) -> Self {
        let corner = sensor - DVec2::splat(REACH_M);
        let mut squares: Vec<Vec<(DVec3, f32)>> = vec![Vec::new(); SIDE * SIDE];
        for (at, strength) in returns {
            if let Some(i) = square_at(corner, at.truncate()) {
                squares[i].push((at, strength));
            }
        }
        let lowest: Vec<Option<f64>> = squares.iter_mut().map(|s| lowest(s)).collect();
        let ground = grown(&lowest);
        let mean = |(returns, height): (&Vec<(DVec3, f32)>, &Option<f64>)| {
            let top_m = (*height)? + THICK_M;
            let of_ground = || returns.iter().filter(|(at, _)| at.z <= top_m);
            let n = of_ground().count() as f64;
            Some(GroundSquare {
                middle: of_ground().map(|(at, _)| *at).sum::<DVec3>() / n,
                strength: of_ground().map(|(_, s)| f64::from(*s)).sum::<f64>() as f32 / n as f32,
            })
        };
        let means: Vec<Option<GroundSquare>> = squares.iter().zip(&ground).map(mean).collect();
        let planes = (0..SIDE * SIDE).map(|i| patch(corner, &means, i)).collect();
        Self { corner, planes }
    }

    /// Height of the ground at a place, m; `None` where none was measured nearby.
    pub fn height_m(&self, p: DVec2) -> Option<f64> {
        // Between the middles of four squares, each with its plane.
        let u = p - self.corner - DVec2::splat(0.5);
        let (low, share) = (u.floor(), u - u.floor());
        let (mut sum, mut weight) = (0.0, 0.0);
        for (dx, dy) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let (x, y) = (low.x + f64::from(dx), low.y + f64::from(dy));
            let middle = self.corner + DVec2::new(x + 0.5, y + 0.5);
            let Some(patch) = square_at(self.corner, middle).and_then(|i| self.planes[i]) else {
                continue;
            };
            let along = |d: i32, s: f64| if d == 1 { s } else { 1.0 - s };
            let w = along(dx, share.x) * along(dy, share.y) + 1e-9;
            sum += w * (patch.height_m + patch.slope.dot(p - middle));
            weight += w;
        }
        (weight > 0.0).then(|| sum / weight)
    }

    /// Mean strength of the returns of the ground around a place.
    pub fn strength(&self, p: DVec2) -> Option<f32> {
        self.planes[square_at(self.corner, p)?].map(|patch| patch.strength)
    }

    /// Distance at which a ray from above meets the ground, m, at most `limit_m`.
    pub fn met_by(&self, origin: DVec3, direction: DVec3, limit_m: f64) -> Option<f64> {
        let flat = direction.truncate().length();
        let step = WALK_M / flat.max(1e-3);
        let above = |t: f64| {
            let p = origin + direction * t;
            self.height_m(p.truncate()).map(|ground_m| p.z - ground_m)
        };
        let (mut t, mut was_above) = (0.0, None);
        while t < limit_m {
            let next = (t + step).min(limit_m);
            match above(next) {
                Some(height_m) if height_m <= 0.0 => {
                    // Without ground before it, nothing tells where the ray went in.
                    let mut ends = [was_above?, next];
                    for _ in 0..HALVINGS {
                        let middle = (ends[0] + ends[1]) / 2.0;
                        let is_above = above(middle).is_none_or(|height_m| height_m > 0.0);
                        ends[usize::from(!is_above)] = middle;
                    }
                    return Some((ends[0] + ends[1]) / 2.0);
                }
                Some(_) => was_above = Some(next),
                None => {}
            }
            t = next;
        }
        None
    }
}

/// Index of the square over a place.
fn square_at(corner: DVec2, p: DVec2) -> Option<usize> {
    let u = (p - corner).floor();
    let range = 0.0..SIDE as f64;
    (range.contains(&u.x) && range.contains(&u.y)).then(|| u.x as usize * SIDE + u.y as usize)
}

/// The lowest return of a square that two others lie just above; of few returns the lowest. Sorts the returns by height.
fn lowest(returns: &mut [(DVec3, f32)]) -> Option<f64> {
    returns.sort_by(|a, b| a.0.z.total_cmp(&b.0.z));
    let supported = returns
        .windows(3)
        .find(|three| three[2].0.z - three[0].0.z <= SUPPORT_M);
    let lowest = supported.and_then(|three| three.first()).or(match returns.len() {
        1 | 2 => returns.first(),
        _ => None,
    });
    lowest.map(|(at, _)| at.z)
}

/// Heights of the squares that the ground around the sensor leads to, step by step.
fn grown(lowest: &[Option<f64>]) -> Vec<Option<f64>> {
    let middle = (SIDE as f64 - 1.0) / 2.0;
    let far = |i: usize| {
        let (x, y) = ((i / SIDE) as f64 - middle, (i % SIDE) as f64 - middle);
        x.hypot(y)
    };
    let mut order: Vec<usize> = (0..lowest.len()).filter(|i| lowest[*i].is_some()).collect();
    order.sort_by(|a, b| far(*a).total_cmp(&far(*b)));
    let mut near: Vec<f64> = order
        .iter()
        .filter(|i| far(**i) <= NEAR_M)
        .filter_map(|i| lowest[*i])
        .collect();
    near.sort_by(f64::total_cmp);
    let mut ground = vec![None; lowest.len()];
    let Some(level_m) = near.get(near.len() / 2).copied() else {
        return ground;
    };
    for i in order {
        let Some(height_m) = lowest[i] else { continue };
        let expected_m = around(&ground, i).or((far(i) <= NEAR_M).then_some(level_m));
        if expected_m.is_some_and(|expected_m| (height_m - expected_m).abs() <= STEP_M) {
            ground[i] = Some(height_m);
        }
    }
    ground
}

/// Mean height of the known squares nearest to one.
fn around(ground: &[Option<f64>], i: usize) -> Option<f64> {
    (1..=GROWN).find_map(|reach| {
        let known: Vec<f64> = squares_around(i, reach).filter_map(|j| ground[j]).collect();
        (!known.is_empty()).then(|| known.iter().sum::<f64>() / known.len() as f64)
    })
}

/// Squares at most `reach` from one along both axes.
fn squares_around(i: usize, reach: usize) -> impl Iterator<Item = usize> {
    let span = move |v: usize| v.saturating_sub(reach)..(v + reach + 1).min(SIDE);
    span(i / SIDE).flat_map(move |x| span(i % SIDE).map(move |y| x * SIDE + y))
}

/// The plane of a square by least squares through the squares around it, near ones first.
fn patch(corner: DVec2, means: &[Option<GroundSquare>], i: usize) -> Option<GroundPatch> {
    let middle = corner + DVec2::new((i / SIDE) as f64 + 0.5, (i % SIDE) as f64 + 0.5);
    let mut known: Vec<GroundSquare> = Vec::new();
    for reach in FITTED {
        known = squares_around(i, reach).filter_map(|j| means[j]).collect();
        if known.len() >= LEAST_FITTED {
            break;
        }
    }
    if known.is_empty() {
        return None;
    }
    let mut sums = [[0.0; 4]; 3];
    let (mut strength, mut weights) = (0.0, 0.0);
    for square in &known {
        let d = square.middle.truncate() - middle;
        let w = (-d.length_squared() / (2.0 * WEIGHT_M * WEIGHT_M))
            .exp()
            .max(1e-9);
        let row = [1.0, d.x, d.y];
        for (a, sum) in sums.iter_mut().enumerate() {
            for b in 0..3 {
                sum[b] += w * row[a] * row[b];
            }
            sum[3] += w * row[a] * square.middle.z;
        }
        strength += w * f64::from(square.strength);
        weights += w;
    }
    // A little level ground, so that squares in a row give a plane.
    (sums[1][1], sums[2][2]) = (sums[1][1] + 0.05 * weights, sums[2][2] + 0.05 * weights);
    let plane = solve(sums.map(|row| row.to_vec()).to_vec())?;
    let slope = DVec2::new(plane[1], plane[2]);
    Some(GroundPatch {
        height_m: plane[0],
        slope: slope.clamp_length_max(STEEPEST),
        strength: (strength / weights) as f32,
    })
}
