//! Poses of the sweeps of a drive, aligned to each other: what a source does not know of them, such as height and pitch, and what
//! it drifts by, is found from the surfaces that the sweeps share.
//!
//! Sweeps are thinned to cubes of 0.25 m first: rings of the road fit rings of the road wherever the vehicle is. Each sweep is laid
//! on the surfaces of the last ones ([`surface`]), from where the source's poses expect it. A small distance from them proves
//! nothing by itself, so a sweep keeps the expected pose where few of its points lie on surfaces or the pose leaps; the tests
//! judge by poses that are known.

mod point_grid;
mod surface;

use std::collections::VecDeque;

use glam::DVec3;
use scene::Pose;

use point_grid::thinned;
use surface::{Fit, Freedom, LocalSurface, Surfaces, fit};

/// Width of the cubes that sweeps are thinned to, m.
const THINNED_M: f64 = 0.25;
/// Distance from the sensor up to which points are used, m.
const FARTHEST_M: f64 = 60.0;
/// Points of a sweep that are laid on surfaces, at most.
const MOST: usize = 5000;
/// Sweeps that a sweep is laid on.
const BEFORE: usize = 8;
/// What a source's poses promise from one sweep to the next: deviations along the sensor's x and y, m, and for each m of the way;
/// along its z, m; about its axes, rad.
const PROMISE_M: f64 = 0.05;
const PROMISE_SHARE: f64 = 0.03;
const PROMISE_UP_M: f64 = 0.5;
const PROMISE_RAD: DVec3 = DVec3::new(0.05, 0.05, 0.01);
/// Smallest share of points near surfaces and of those on them, their largest distance from them, m, and the farthest that a pose
/// is moved, m and rad.
const LEAST_MET: f64 = 0.1;
const LEAST_SHARE: f64 = 0.7;
const LARGEST_RMS_M: f64 = 0.12;
const FARTHEST_MOVE_M: f64 = 1.5;
const FARTHEST_TURN: f64 = 0.15;
/// Poses that differ less from those of the source are the source's: m, m for each m from the first, rad.
const SAME_M: f64 = 0.05;
const SAME_SHARE: f64 = 0.002;
const SAME_RAD: f64 = 0.005;

/// Poses of a drive.
pub(crate) struct Alignment {
    /// Pose of each sensor in the frame of the first.
    pub(crate) poses: Vec<Pose>,
    /// Farthest that a pose was moved, m, and turned, rad.
    pub(super) moved_m: f64,
    pub(super) turned_rad: f64,
    /// Share of the points that lie on surfaces of the sweeps before.
    pub(super) share: f64,
    /// Their distance from these, m.
    pub(super) rms_m: f64,
    /// Sweeps that keep the pose that was expected.
    pub(super) unaligned: usize,
}

impl Alignment {
    /// What was done, for a person.
    pub(crate) fn note(&self) -> String {
        let lie = format!(
            "{:.0} % of their points lie on surfaces of the sweeps before, {:.0} cm off",
            100.0 * self.share,
            100.0 * self.rms_m
        );
        let fits = match self.moved_m + self.turned_rad {
            0.0 => format!("the poses fit the sweeps: {lie}"),
            _ => format!(
                "the poses were off by up to {:.2} m and {:.1} degrees and are aligned: {lie}",
                self.moved_m,
                self.turned_rad.to_degrees()
            ),
        };
        match self.unaligned {
            0 => fits,
            n => format!("{fits}; {n} sweeps show too little and keep their poses"),
        }
    }
}

/// The points of a sweep that are used, in the frame of its sensor, m.
pub(super) fn surveyed(points: impl Iterator<Item = DVec3>) -> Vec<DVec3> {
    let near = points.filter(|p| p.length_squared() < FARTHEST_M * FARTHEST_M);
    thinned(&near.collect::<Vec<_>>(), THINNED_M)
}

/// The poses of sweeps ([`surveyed`]) near those that the source gives, the first being the identity.
pub(crate) fn align(sweeps: &[&[DVec3]], given: &[Pose]) -> Alignment {
    let mut aligned = Aligned::default();
    let mut fits = Vec::new();
    let mut unaligned = 0;
    for (i, (points, pose)) in sweeps.iter().zip(given).enumerate() {
        let expected = match i {
            0 => *pose,
            _ => aligned.poses[i - 1] * (given[i - 1].inverse() * *pose),
        };
        let found = (i > 0).then(|| aligned.pose_of(points, expected)).flatten();
        unaligned += usize::from(i > 0 && found.is_none());
        fits.extend(found);
        aligned.push(points, found.map_or(expected, |fit| fit.pose));
    }
    let rms_m = match fits.len() {
        0 => 0.0,
        n => (fits.iter().map(|fit| fit.rms_m * fit.rms_m).sum::<f64>() / n as f64).sqrt(),
    };
    let share = fits.iter().map(|fit| fit.met * fit.share).sum::<f64>() / fits.len().max(1) as f64;
    let off = aligned.poses.iter().zip(given).map(|(a, b)| difference(a, b));
    let is_same = off.clone().zip(given).all(|((m, rad), pose)| {
        let way_m = pose.translation_m.distance(given[0].translation_m);
        m < SAME_M + SAME_SHARE * way_m && rad < SAME_RAD
    });
    let most = off.fold((0.0, 0.0), |most, off| {
        (f64::max(most.0, off.0), f64::max(most.1, off.1))
    });
    let (poses, (moved_m, turned_rad)) = match is_same {
        true => (given.to_vec(), (0.0, 0.0)),
        false => (aligned.poses, most),
    };
    Alignment {
        poses,
        moved_m,
        turned_rad,
        share,
        rms_m,
        unaligned,
    }
}

/// Distance of two poses, m, and the angle between them, rad.
fn difference(a: &Pose, b: &Pose) -> (f64, f64) {
    (
        a.translation_m.distance(b.translation_m),
        a.rotation.angle_between(b.rotation),
    )
}

/// The sweeps so far.
#[derive(Default)]
struct Aligned {
    poses: Vec<Pose>,
    /// Points of the last ones in the frame of the first, with their surfaces.
    last: VecDeque<Vec<(DVec3, Option<LocalSurface>)>>,
}

impl Aligned {
    /// The pose of a sweep on the last ones, if it is believed.
    fn pose_of(&self, points: &[DVec3], expected: Pose) -> Option<Fit> {
        let surfaces = Surfaces::of(self.last.iter().flatten().copied());
        let every = points.len().div_ceil(MOST).max(1);
        let some: Vec<DVec3> = points.iter().copied().step_by(every).collect();
        let before = self.poses.last().unwrap_or(&expected);
        let way_m = before.translation_m.distance(expected.translation_m);
        let aside_m = PROMISE_M + PROMISE_SHARE * way_m;
        let promise = Freedom {
            m: DVec3::new(aside_m, aside_m, PROMISE_UP_M),
            rad: PROMISE_RAD,
        };
        let found = fit(&some, &surfaces, expected, promise)?;
        let (m, rad) = difference(&found.pose, &expected);
        let is_sound = found.met >= LEAST_MET && found.share >= LEAST_SHARE && found.rms_m <= LARGEST_RMS_M;
        (is_sound && m <= FARTHEST_MOVE_M && rad <= FARTHEST_TURN).then_some(found)
    }

    /// Adds a sweep at its pose.
    fn push(&mut self, points: &[DVec3], pose: Pose) {
        self.poses.push(pose);
        if self.last.len() == BEFORE {
            self.last.pop_front();
        }
        let placed = || points.iter().map(|p| (pose.apply(*p), None));
        let all = Surfaces::of(self.last.iter().flatten().copied().chain(placed()));
        let with_surfaces = placed().map(|(p, _)| (p, all.at(p))).collect();
        self.last.push_back(with_surfaces);
    }
}

#[cfg(test)]
mod tests;
