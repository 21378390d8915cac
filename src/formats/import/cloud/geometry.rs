//! Classes of points without labels, told by where they lie.
//!
//! - **Ground** is grown from the vehicle outward: the lowest point of a column is ground if it lies near the height of the
//!   ground found around it, and so is every point less than 0.15 m above.
//! - Ground that is reached from the vehicle without a step is taken as driveable surface, other ground as other flat. Grass at
//!   the height of the road cannot be told from it.
//! - A thing on the ground that is lower than 4.2 m and shorter than 14 m on its own is "others": a vehicle, a person,
//!   a bush.
//! - All other points are vegetation where they are thick seen from above, and manmade where they are thin as a wall.
//!
//! Measured on the program's own sweeps; docs/formats/points.md has the figures.

use std::collections::VecDeque;

use glam::{DVec2, DVec3};
use scene::{Class, Extent};

/// Points up to this far above the ground belong to it, m.
const GROUND_BAND_M: f64 = 0.15;
/// How far ground may lie above the ground around it, m, and how much more for each m to the nearest of it.
const RISE_M: f64 = 0.12;
const RISE_PER_M: f64 = 0.10;
/// How far ground may lie below the ground around it, m (lower points are echoes from elsewhere); more per m as above.
const FALL_M: f64 = 0.5;
/// How far ground that is driven on may lie above or below such ground around it, m, and how much more for each m to
/// it.
const STEP_M: f64 = 0.06;
const STEP_PER_M: f64 = 0.02;
/// Ground farther away than this counts as being there, m.
const FARTHEST_M: f64 = 6.0;
/// Radii in which ground is looked for, columns, and how many columns are enough.
const REACH: [usize; 3] = [5, 15, 30];
const ENOUGH: usize = 3;
/// Share of the lowest points near the vehicle that lie below the level, and how near they must be, m.
const LEVEL_SHARE: f64 = 0.25;
const LEVEL_REACH_M: f64 = 15.0;
/// A thing is lower and shorter than this, m.
const THING_TOP_M: f64 = 4.2;
const THING_LENGTH_M: f64 = 14.0;
/// Columns so near each other belong to one thing.
const TOUCH: usize = 2;
/// Vegetation is thicker than this, m: the standard deviation of points of 3 x 3 columns across their main direction.
const WALL_M: f64 = 0.13;
/// Fewest points that have a thickness.
const LEAST_POINTS: f64 = 5.0;
/// Radius in which thickness is averaged, columns.
const SMOOTH: usize = 4;

/// A place that the vehicle was at.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Passed {
    /// Seen from above, m.
    pub(crate) at_m: DVec2,
    /// Height of the ground there, m, and its slope along x and y, if they are known.
    pub(crate) ground: Option<(f64, DVec2)>,
}

impl Passed {
    /// The vehicle of a single sweep.
    pub(crate) const HERE: Self = Self {
        at_m: DVec2::ZERO,
        ground: None,
    };

    /// Height of its ground, continued to another place, m; 0 if nothing is known.
    fn datum_m(&self, at_m: DVec2) -> f64 {
        self.ground
            .map_or(0.0, |(height_m, slope)| height_m + slope.dot(at_m - self.at_m))
    }
}

/// What the shape of points tells.
pub(crate) struct Shapes {
    /// A class for each point: driveable surface, other flat, manmade, vegetation or others.
    pub(crate) classes: Vec<Class>,
    /// Height of each point above the ground found there or near, m.
    pub(crate) above_m: Vec<f64>,
}

/// Classes of points on a map, in m in its frame, by the places that the vehicle was at, one at least.
pub(crate) fn shapes(points: &[DVec3], extent: Extent, passed: &[Passed]) -> Shapes {
    let map = Columns(extent);
    let columns: Vec<usize> = points.iter().map(|p| map.column(*p)).collect();
    let ground = CloudGround::grow(map, points, &columns, passed);
    let above_m: Vec<f64> = points
        .iter()
        .zip(&columns)
        .map(|(p, c)| p.z - ground.height_m[*c])
        .collect();
    let stands = |i: usize| above_m[i] >= GROUND_BAND_M;
    let standing: Vec<usize> = (0..points.len()).filter(|i| stands(*i)).collect();
    let mut above = vec![Above::default(); extent.columns()];
    for &i in &standing {
        above[columns[i]].add(points[i].truncate(), above_m[i]);
    }
    let things = things(map, &above);
    let thickness_m = thickness(map, &above);
    let class = |i: usize| {
        let c = columns[i];
        match (stands(i), things[c]) {
            (false, _) if ground.is_driven[c] => Class::DriveableSurface,
            (false, _) => Class::OtherFlat,
            (true, true) => Class::Others,
            (true, false) if thickness_m[c] > WALL_M => Class::Vegetation,
            (true, false) => Class::Manmade,
        }
    };
    Shapes {
        classes: (0..points.len()).map(class).collect(),
        above_m,
    }
}

/// The columns of a map, by number.
#[derive(Clone, Copy)]
struct Columns(Extent);

impl Columns {
    fn column(self, p: DVec3) -> usize {
        let u = self.0.to_voxel_units(p);
        (u.x as usize).min(self.0.nx() - 1) * self.0.ny() + (u.y as usize).min(self.0.ny() - 1)
    }

    fn center_m(self, c: usize) -> DVec2 {
        let [x, y] = self.0.column(c);
        self.0.center(x, y, 0).truncate()
    }

    /// The columns within a radius.
    fn around(self, c: usize, reach: usize) -> impl Iterator<Item = usize> {
        let (nx, ny) = (self.0.nx(), self.0.ny());
        let (x, y) = (c / ny, c % ny);
        let xs = x.saturating_sub(reach)..=(x + reach).min(nx - 1);
        xs.flat_map(move |x| {
            let ys = y.saturating_sub(reach)..=(y + reach).min(ny - 1);
            ys.map(move |y| x * ny + y)
        })
    }

    fn distance_m(self, a: usize, b: usize) -> f64 {
        let ny = self.0.ny();
        let d = [(a / ny).abs_diff(b / ny), (a % ny).abs_diff(b % ny)];
        DVec2::from_array(d.map(|n| n as f64)).length() * self.0.voxel_m()
    }
}

/// Heights of the ground per column.
struct CloudGround {
    /// Height of the ground that was found there or is near, m.
    height_m: Vec<f64>,
    /// Reached from the vehicle without a step.
    is_driven: Vec<bool>,
}

impl CloudGround {
    fn grow(map: Columns, points: &[DVec3], columns: &[usize], passed: &[Passed]) -> Self {
        let all = map.0.columns();
        // Distance from the vehicle, m, and where it was then.
        let nearest = |c: usize| {
            let at_m = map.center_m(c);
            let away = passed.iter().map(|p| (p.at_m - at_m).length()).enumerate();
            away.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, 0.0))
        };
        // Heights are those above the ground that the vehicle stood on.
        let mut lowest = vec![f64::INFINITY; all];
        let mut datum_m = vec![f64::NAN; all];
        for (p, c) in points.iter().zip(columns) {
            if datum_m[*c].is_nan() {
                let by = passed.get(nearest(*c).0);
                datum_m[*c] = by.map_or(0.0, |passed| passed.datum_m(map.center_m(*c)));
            }
            lowest[*c] = lowest[*c].min(p.z - datum_m[*c]);
        }
        let seen = (0..all).filter(|c| lowest[*c].is_finite());
        let mut order: Vec<(f64, usize, usize)> = seen
            .map(|c| {
                let (place, away_m) = nearest(c);
                (away_m, c, place)
            })
            .collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        let near = order.iter().take_while(|(away_m, ..)| *away_m < LEVEL_REACH_M);
        let near: Vec<f64> = near.map(|(_, c, _)| lowest[*c]).collect();
        let every = || order.iter().map(|(_, c, _)| lowest[*c]).collect();
        let usual_m = quantile(if near.is_empty() { every() } else { near });
        let level_at = |place: usize| match passed.get(place).and_then(|p| p.ground) {
            Some(_) => 0.0,
            None => usual_m,
        };
        let mut found = vec![f64::NAN; all];
        let mut driven = vec![f64::NAN; all];
        let mut height_m = vec![usual_m; all];
        for (away_m, c, place) in order {
            let level_m = level_at(place);
            let (around_m, gap_m) = mean_around(map, &found, c).unwrap_or((level_m, away_m));
            let gap_m = gap_m.min(FARTHEST_M);
            let rise_m = lowest[c] - around_m;
            let more_m = RISE_PER_M * gap_m;
            if rise_m >= RISE_M + more_m || rise_m <= -FALL_M - more_m {
                height_m[c] = around_m;
                continue;
            }
            (found[c], height_m[c]) = (lowest[c], lowest[c]);
            let (road_m, gap_m) = mean_around(map, &driven, c).unwrap_or((level_m, 0.0));
            if (lowest[c] - road_m).abs() < STEP_M + STEP_PER_M * gap_m.min(FARTHEST_M) {
                driven[c] = lowest[c];
            }
        }
        for (height_m, datum_m) in height_m.iter_mut().zip(datum_m) {
            *height_m += if datum_m.is_nan() { 0.0 } else { datum_m };
        }
        Self {
            height_m,
            is_driven: driven.iter().map(|h| !h.is_nan()).collect(),
        }
    }
}

fn quantile(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let at = (values.len() as f64 * LEVEL_SHARE) as usize;
    values.get(at).copied().unwrap_or(0.0)
}

/// The mean of the known values around a column, near ones counting more, and the distance to the nearest, m. `None` if
/// too few are known.
fn mean_around(map: Columns, values: &[f64], c: usize) -> Option<(f64, f64)> {
    REACH.into_iter().find_map(|reach| {
        let (mut known, mut sum, mut weights, mut nearest_m) = (0, 0.0, 0.0, f64::INFINITY);
        for other in map.around(c, reach).filter(|o| !values[*o].is_nan()) {
            let d = map.distance_m(c, other);
            let weight = (d + 0.2).powi(-2);
            known += 1;
            sum += weight * values[other];
            weights += weight;
            nearest_m = nearest_m.min(d);
        }
        (known >= ENOUGH).then_some((sum / weights, nearest_m))
    })
}

/// Points of a column that stand on the ground.
#[derive(Clone, Copy, Default)]
struct Above {
    count: f64,
    /// Sums of x and y, of their squares and of their product; from the first point of the column on, to stay exact.
    first_m: DVec2,
    sum: DVec2,
    squares: DVec2,
    product: f64,
    top_m: f64,
}

impl Above {
    fn add(&mut self, at: DVec2, height_m: f64) {
        if self.count == 0.0 {
            self.first_m = at;
        }
        let d = at - self.first_m;
        self.count += 1.0;
        self.sum += d;
        self.squares += d * d;
        self.product += d.x * d.y;
        self.top_m = self.top_m.max(height_m);
    }

    /// The sums of both, from the first point of this one on.
    fn joined(self, other: &Self) -> Self {
        let by = other.first_m - self.first_m;
        let n = other.count;
        Self {
            count: self.count + n,
            first_m: self.first_m,
            sum: self.sum + other.sum + n * by,
            squares: self.squares + other.squares + 2.0 * by * other.sum + n * by * by,
            product: self.product + other.product + by.x * other.sum.y + by.y * other.sum.x + n * by.x * by.y,
            top_m: self.top_m.max(other.top_m),
        }
    }

    /// Standard deviation across the main direction, m.
    fn thickness_m(&self) -> f64 {
        let mean = self.sum / self.count;
        let spread = self.squares / self.count - mean * mean;
        let product = self.product / self.count - mean.x * mean.y;
        let half = (spread.x - spread.y) / 2.0;
        let least = (spread.x + spread.y) / 2.0 - (half * half + product * product).sqrt();
        least.max(0.0).sqrt()
    }
}

/// Tells for each column whether its points above the ground belong to a low and short thing that stands alone.
fn things(map: Columns, above: &[Above]) -> Vec<bool> {
    let mut out = vec![false; above.len()];
    let mut seen: Vec<bool> = above.iter().map(|a| a.count == 0.0).collect();
    for start in 0..above.len() {
        if std::mem::replace(&mut seen[start], true) {
            continue;
        }
        let (mut part, mut open) = (Vec::new(), VecDeque::from([start]));
        while let Some(c) = open.pop_front() {
            part.push(c);
            for near in map.around(c, TOUCH) {
                if !std::mem::replace(&mut seen[near], true) {
                    open.push_back(near);
                }
            }
        }
        let top_m = part.iter().map(|c| above[*c].top_m).fold(0.0, f64::max);
        let length = |place: &dyn Fn(usize) -> usize| {
            let places = part.iter().map(|c| place(*c));
            let (low, high) = (places.clone().min(), places.max());
            high.zip(low).map_or(0, |(high, low)| high - low + 1) as f64 * map.0.voxel_m()
        };
        let ny = map.0.ny();
        let length_m = length(&|c| c / ny).max(length(&|c| c % ny));
        if top_m < THING_TOP_M && length_m < THING_LENGTH_M {
            part.into_iter().for_each(|c| out[c] = true);
        }
    }
    out
}

/// Thickness of the things in each column, seen from above, m: the mean over the columns around. 0 where too few points
/// stand.
fn thickness(map: Columns, above: &[Above]) -> Vec<f64> {
    let of_column = |c: usize| {
        let here = above[c];
        let joined = map
            .around(c, 1)
            .filter(|o| *o != c && above[*o].count > 0.0)
            .fold(here, |sum, o| sum.joined(&above[o]));
        let is_known = here.count > 0.0 && joined.count >= LEAST_POINTS;
        (is_known.then(|| joined.thickness_m()), here.count)
    };
    let known: Vec<(Option<f64>, f64)> = (0..above.len()).map(of_column).collect();
    let mean = |c: usize| {
        if above[c].count == 0.0 {
            return 0.0;
        }
        let (mut sum, mut weights) = (0.0, 0.0);
        for (thickness_m, count) in map.around(c, SMOOTH).map(|o| known[o]) {
            if let Some(thickness_m) = thickness_m {
                sum += thickness_m * count;
                weights += count;
            }
        }
        if weights > 0.0 { sum / weights } else { 0.0 }
    };
    (0..above.len()).map(mean).collect()
}
