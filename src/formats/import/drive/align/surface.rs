//! Surfaces that points lie on, and the pose of a sweep on them: point-to-plane with robust weights.

use glam::{DMat3, DQuat, DVec3};
use numeric::linear::solve;
use scene::Pose;

use super::point_grid::PointGrid;

/// Width of the cubes in which neighbours are looked for, m.
const CUBE_M: f64 = 0.5;
/// Neighbours that tell a surface, and how far they may be, cubes: a few, or where these lie on one line, as on a ring of a sweep,
/// more.
const NEIGHBOURS: [(usize, i32); 2] = [(12, 2), (40, 5)];
/// Of neighbours on a surface the spread across it is this small a part of that to its side, m at least as if that were so wide;
/// and neighbours on a line spread less to its side than this part of its length.
const FLAT: f64 = 0.15;
const LEAST_WIDE_M: f64 = 0.1;
const LINE: f64 = 0.2;
/// Neighbours on a line that points up are a post if they spread less to its side, m.
const UPRIGHT: f64 = 0.9;
const POST_M: f64 = 0.15;
/// Distance from a surface at which a point counts half as much, m.
const ROBUST_M: f64 = 0.1;
/// A point this near to a surface lies on it, m.
const ON_M: f64 = 0.2;
/// Distances at which the surface of a point is looked for, m: far at first, then near. What moved farther meets nothing.
const FAR_M: f64 = 0.5;
const NEAR_M: f64 = 0.3;
/// Steps of Gauss and Newton at most, and the step that ends them, m and rad.
const STEPS: usize = 30;
const STILL: f64 = 2e-4;
/// Error of a point, m, and how many neighbours share theirs: what is known beforehand is weighed against points so.
const POINT_M: f64 = 0.05;
const ALIKE: f64 = 20.0;

/// Points with the directions of the surfaces that they lie on.
#[derive(Default)]
pub(super) struct Surfaces {
    points: Vec<DVec3>,
    /// `None` where no surface shows.
    local: Vec<Option<LocalSurface>>,
    grid: PointGrid,
}

/// The surface around a point.
#[derive(Clone, Copy, Debug)]
pub(super) enum LocalSurface {
    /// A plane through this place with this unit normal.
    Plane(DVec3, DVec3),
    /// A post through this place, as thin as its points are apart: unit vectors across it.
    Post(DVec3, [DVec3; 2]),
}

impl LocalSurface {
    /// A place on it, and the directions in which a point is off it.
    fn across(&self) -> (DVec3, &[DVec3]) {
        match self {
            Self::Plane(at, normal) => (*at, std::slice::from_ref(normal)),
            Self::Post(at, across) => (*at, across),
        }
    }
}

impl Surfaces {
    /// Puts clouds of points with their surfaces together.
    pub(super) fn of(clouds: impl Iterator<Item = (DVec3, Option<LocalSurface>)>) -> Self {
        let (points, local): (Vec<DVec3>, Vec<Option<LocalSurface>>) = clouds.unzip();
        let grid = PointGrid::new(&points, CUBE_M);
        Self { points, local, grid }
    }

    /// The surface at a place, from the points around it.
    pub(super) fn at(&self, p: DVec3) -> Option<LocalSurface> {
        NEIGHBOURS
            .into_iter()
            .find_map(|(count, cubes)| self.of_nearest(p, count, cubes))
    }

    /// The surface of the nearest points, so many at most.
    fn of_nearest(&self, p: DVec3, count: usize, cubes: i32) -> Option<LocalSurface> {
        let reach_m = CUBE_M * f64::from(cubes);
        let mut near: Vec<(f64, usize)> = self
            .grid
            .around(p, cubes)
            .map(|i| (self.points[i].distance_squared(p), i))
            .filter(|(off, _)| *off < reach_m * reach_m)
            .collect();
        if near.len() < count / 2 {
            return None;
        }
        if near.len() > count {
            near.select_nth_unstable_by(count, |a, b| a.0.total_cmp(&b.0));
            near.truncate(count);
        }
        let n = near.len() as f64;
        let mean = near.iter().map(|(_, i)| self.points[*i]).sum::<DVec3>() / n;
        let mut spread = DMat3::ZERO;
        for (_, i) in &near {
            let d = self.points[*i] - mean;
            spread += DMat3::from_cols(d * d.x, d * d.y, d * d.z);
        }
        let axes = principal(spread * (1.0 / n));
        let [least, middle, most] = axes.map(|(spread, _)| spread);
        let is_wide = middle > LINE * LINE * most;
        let is_flat = least < FLAT * FLAT * middle.max(LEAST_WIDE_M * LEAST_WIDE_M);
        let is_post = !is_wide && axes[2].1.z.abs() > UPRIGHT && middle < POST_M * POST_M;
        match is_wide {
            true => is_flat.then_some(LocalSurface::Plane(mean, axes[0].1)),
            false => is_post.then_some(LocalSurface::Post(mean, [axes[0].1, axes[1].1])),
        }
    }
}

/// Eigenvalues of a symmetric matrix with their vectors, rising.
fn principal(m: DMat3) -> [(f64, DVec3); 3] {
    let c = m.to_cols_array();
    let eigen = nalgebra::Matrix3::from_column_slice(&c).symmetric_eigen();
    let mut axes = [0, 1, 2].map(|i| {
        let v = eigen.eigenvectors.column(i);
        (eigen.eigenvalues[i].max(0.0), DVec3::new(v[0], v[1], v[2]))
    });
    axes.sort_by(|a, b| a.0.total_cmp(&b.0));
    axes
}

/// How far a pose may be from the one that is expected: standard deviations along the axes of the sensor, m, and about them,
/// rad.
#[derive(Clone, Copy, Debug)]
pub(super) struct Freedom {
    pub(super) m: DVec3,
    pub(super) rad: DVec3,
}

/// A pose that was found.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fit {
    /// The pose.
    pub(super) pose: Pose,
    /// Share of the points that are near a surface, and the share of these that lie on it.
    pub(super) met: f64,
    pub(super) share: f64,
    /// Root mean square of their distances from it, m.
    pub(super) rms_m: f64,
}

/// The pose near the expected one with which most points lie on the surfaces; `None` if too little is known.
pub(super) fn fit(points: &[DVec3], on: &Surfaces, expected: Pose, freedom: Freedom) -> Option<Fit> {
    let mut pose = expected;
    for step in 0..STEPS {
        let within_m = if step < 4 { FAR_M } else { NEAR_M };
        let normal = Normal::of(points, on, &pose, within_m).with_expected(&pose, &expected, freedom);
        let [turn, way] = normal.solved()?;
        let angle = turn.length();
        let rotation = match angle > 0.0 {
            true => DQuat::from_axis_angle(turn / angle, angle),
            false => DQuat::IDENTITY,
        };
        pose = Pose {
            rotation: (rotation * pose.rotation).normalize(),
            translation_m: pose.translation_m + way,
        };
        if !pose.translation_m.is_finite() {
            return None;
        }
        if step > 4 && angle < STILL / 20.0 && way.length() < STILL {
            break;
        }
    }
    let last = Normal::of(points, on, &pose, NEAR_M);
    (last.on > 0.0).then(|| Fit {
        pose,
        met: last.met / points.len() as f64,
        share: last.on / last.met,
        rms_m: (last.squares / last.on).sqrt(),
    })
}

/// Normal equations of a turn about the sensor and a way, in the frame of the surfaces.
struct Normal {
    matrix: [[f64; 6]; 6],
    right: [f64; 6],
    /// Points near a surface, those on it, and the squares of their distances from it.
    met: f64,
    on: f64,
    squares: f64,
}

impl Normal {
    fn of(points: &[DVec3], on: &Surfaces, pose: &Pose, within_m: f64) -> Self {
        let mut out = Self {
            matrix: [[0.0; 6]; 6],
            right: [0.0; 6],
            met: 0.0,
            on: 0.0,
            squares: 0.0,
        };
        let rings = (within_m / CUBE_M).ceil() as i32;
        let weight_of_all = 1.0 / (POINT_M * POINT_M * ALIKE);
        for p in points {
            let at = pose.apply(*p);
            let Some(i) = on.grid.nearest(&on.points, at, within_m, rings) else {
                continue;
            };
            let Some(surface) = &on.local[i] else { continue };
            out.met += 1.0;
            let (place, across) = surface.across();
            let off: f64 = across.iter().map(|d| d.dot(at - place).powi(2)).sum();
            if off < ON_M * ON_M {
                out.on += 1.0;
                out.squares += off;
            }
            let weight = weight_of_all / (1.0 + off / (ROBUST_M * ROBUST_M));
            for direction in across {
                let turning = (at - pose.translation_m).cross(*direction);
                let row = [
                    turning.x,
                    turning.y,
                    turning.z,
                    direction.x,
                    direction.y,
                    direction.z,
                ];
                out.add(row, -direction.dot(at - place), weight);
            }
        }
        out
    }

    fn add(&mut self, row: [f64; 6], to: f64, weight: f64) {
        for i in 0..6 {
            self.right[i] += weight * row[i] * to;
            for j in 0..6 {
                self.matrix[i][j] += weight * row[i] * row[j];
            }
        }
    }

    /// Draws the pose to the expected one.
    fn with_expected(mut self, pose: &Pose, expected: &Pose, freedom: Freedom) -> Self {
        let off = expected.rotation * pose.rotation.inverse();
        let off = if off.w < 0.0 { -off } else { off };
        let (axis, angle) = off.to_axis_angle();
        let turn = axis * angle;
        let way = expected.translation_m - pose.translation_m;
        for (k, axis) in [DVec3::X, DVec3::Y, DVec3::Z].into_iter().enumerate() {
            let along = expected.rotation * axis;
            let row = |turn: DVec3, way: DVec3| [turn.x, turn.y, turn.z, way.x, way.y, way.z];
            self.add(row(along, DVec3::ZERO), along.dot(turn), freedom.rad[k].powi(-2));
            self.add(row(DVec3::ZERO, along), along.dot(way), freedom.m[k].powi(-2));
        }
        self
    }

    fn solved(&self) -> Option<[DVec3; 2]> {
        let rows = self.matrix.iter().zip(self.right);
        let rows = rows.map(|(row, right)| row.iter().copied().chain([right]).collect());
        let found = solve(rows.collect())?;
        let [a, b, c, d, e, f]: [f64; 6] = found.try_into().ok()?;
        Some([DVec3::new(a, b, c), DVec3::new(d, e, f)])
    }
}
