use super::*;
use crate::clip::{Path, Speed};

fn none(_: BoxId) -> Option<Moving> {
    None
}

fn at(motion: &Motion, time_s: f64) -> Moving {
    motion.at(time_s, none).expect("there")
}

fn keys(list: &[(f64, f64, f64, f64)]) -> Motion {
    Motion::Keys(
        list.iter()
            .map(|&(time_s, x, y, yaw_deg)| Key {
                time_s,
                at_m: DVec2::new(x, y),
                yaw_deg,
            })
            .collect(),
    )
}

#[test]
fn keys_are_met_and_nothing_overshoots() {
    let motion = keys(&[
        (0.0, 0.0, 0.0, 0.0),
        (1.0, 10.0, 0.0, 0.0),
        (2.0, 10.0, 0.0, 0.0),
        (4.0, 30.0, 5.0, 350.0),
    ]);
    for (time_s, x) in [
        (-1.0, 0.0),
        (0.0, 0.0),
        (1.0, 10.0),
        (1.5, 10.0),
        (2.0, 10.0),
        (4.0, 30.0),
        (9.0, 30.0),
    ] {
        assert!((at(&motion, time_s).at_m.x - x).abs() < 1e-9, "at {time_s} s");
    }
    for i in 0..=400 {
        let m = at(&motion, f64::from(i) * 0.01);
        assert!((-1e-9..=30.0 + 1e-9).contains(&m.at_m.x) && (-1e-9..=5.0 + 1e-9).contains(&m.at_m.y));
        // From 0 to 350 degrees the short way: back by ten.
        let yaw_deg = (m.yaw_rad.to_degrees() + 180.0).rem_euclid(360.0) - 180.0;
        assert!((-10.1..=0.1).contains(&yaw_deg), "{yaw_deg}");
    }
    assert_eq!(at(&motion, 1.5).velocity_mps, DVec2::ZERO);
    assert_eq!(at(&motion, f64::NAN).at_m, DVec2::ZERO);
    // It stands before and after, but not yet at its ends.
    for (time_s, mps) in [
        (-0.01, 0.0),
        (0.0, 10.0),
        (4.0, 5.0 * 17f64.sqrt() / 2.0),
        (4.01, 0.0),
    ] {
        let found = at(&motion, time_s).velocity_mps.length();
        assert!((found - mps).abs() < 1e-9, "{found} m/s at {time_s} s");
    }
    assert_eq!(at(&keys(&[(1.0, 5.0, 0.0, 0.0)]), 1.0).velocity_mps, DVec2::ZERO);
}

#[test]
fn velocity_is_the_slope_of_the_place() {
    let motion = keys(&[
        (0.0, 0.0, 0.0, 0.0),
        (1.0, 6.0, 1.0, 0.0),
        (2.5, 20.0, 3.0, 20.0),
        (4.0, 22.0, 9.0, 80.0),
    ]);
    let h = 1e-5;
    for i in 1..40 {
        let t = f64::from(i) * 0.1 + 0.003;
        if t > 3.99 {
            break;
        }
        let slope = (at(&motion, t + h).at_m - at(&motion, t - h).at_m) / (2.0 * h);
        assert!((slope - at(&motion, t).velocity_mps).length() < 1e-4, "at {t} s");
    }
}

fn path() -> Path {
    Path {
        points_m: vec![DVec2::ZERO, DVec2::new(50.0, 0.0), DVec2::new(50.0, 50.0)],
        start_m: 5.0,
        speeds: vec![
            Speed {
                time_s: 1.0,
                mps: 10.0,
            },
            Speed {
                time_s: 3.0,
                mps: 0.0,
            },
            Speed {
                time_s: 4.0,
                mps: 0.0,
            },
            Speed {
                time_s: 6.0,
                mps: 20.0,
            },
        ],
        rear_first: false,
    }
}

#[test]
fn a_path_is_driven_with_its_speeds() {
    let motion = Motion::Path(path());
    assert_eq!(motion.problem(), None);
    assert_eq!(at(&motion, 0.0), Moving::still(DVec2::new(5.0, 0.0), 0.0));
    // 10 m/s falling evenly to 0 in 2 s: 10 m.
    assert!((at(&motion, 3.5).at_m - DVec2::new(15.0, 0.0)).length() < 1e-9);
    // 0 to 20 m/s in 2 s: 20 m more.
    assert!((at(&motion, 6.0).at_m - DVec2::new(35.0, 0.0)).length() < 1e-9);
    assert!((at(&motion, 6.0).velocity_mps - DVec2::new(20.0, 0.0)).length() < 1e-9);
    // The last speed stays, around the corner, to the end of the path.
    let corner = at(&motion, 6.75);
    assert!((corner.yaw_rad.to_degrees() - 45.0).abs() < 1e-6, "{corner:?}");
    let end = at(&motion, 100.0);
    assert!((end.at_m - DVec2::new(50.0, 50.0)).length() < 1e-9 && end.velocity_mps == DVec2::ZERO);
    let mut backward = path();
    backward.rear_first = true;
    assert!((at(&Motion::Path(backward), 2.0).yaw_rad.abs() - std::f64::consts::PI).abs() < 1e-9);
}

#[test]
fn carried_motions_keep_their_shape() {
    let from = at(&Motion::Path(path()), 2.0);
    let to = Moving::still(DVec2::new(-3.0, 8.0), 0.6);
    let sampling = KeyframeSampling {
        length_s: 8.0,
        parent: &|_, _| None,
    };
    for motion in [
        Motion::Path(path()),
        keys(&[
            (0.0, 5.0, 0.0, 0.0),
            (2.0, 12.5, 0.0, 0.0),
            (5.0, 30.0, 9.0, 40.0),
        ]),
    ] {
        let from = Moving {
            velocity_mps: DVec2::ZERO,
            ..at(&motion, 2.0)
        };
        let carried = motion.carried(&from, &to);
        let here = at(&carried, 2.0);
        assert!((here.at_m - to.at_m).length() < 1e-9 && (here.yaw_rad - to.yaw_rad).abs() < 1e-9);
        for t in [0.5, 3.0, 5.0] {
            let (a, b) = (at(&motion, t), at(&carried, t));
            let turned = DVec2::from_angle(to.yaw_rad - from.yaw_rad).rotate(a.at_m - from.at_m);
            assert!((b.at_m - to.at_m - turned).length() < 1e-9);
        }
        // From here on: keys before the moment stay.
        let later = motion.carried_from(2.0, &from, &to, &sampling);
        assert!((at(&later, 0.0).at_m - at(&motion, 0.0).at_m).length() < 1e-9);
        assert!((at(&later, 2.0).at_m - to.at_m).length() < 1e-9);
        assert!((at(&later, 5.0).at_m - at(&carried, 5.0).at_m).length() < 0.3);
        // A path moves to its new line within a second.
        if matches!(motion, Motion::Path(_)) {
            assert!((at(&later, 0.9).at_m - at(&motion, 0.9).at_m).length() < 0.15);
        }
        // One moment: the keys around it stay.
        let through = motion.through(2.0, &to, &sampling);
        assert!((at(&through, 2.0).at_m - to.at_m).length() < 1e-9);
        assert!((at(&through, 5.0).at_m - at(&motion, 5.0).at_m).length() < 0.15);
        for m in [later, through] {
            assert_eq!(m.problem(), None);
        }
    }
    let _ = from;
}

#[test]
fn retimed_and_mirrored_motions_are_what_they_say() {
    let motion = Motion::Path(path());
    let slow = motion.retimed(|t| 2.0 * t);
    for t in [0.5, 2.0, 3.5, 5.0, 6.0] {
        assert!(
            (at(&slow, 2.0 * t).at_m - at(&motion, t).at_m).length() < 1e-6,
            "at {t} s"
        );
    }
    let mirrored = motion.mirrored(DVec2::new(0.0, 2.0), 0.0);
    assert!((at(&mirrored, 3.0).at_m - DVec2::new(15.0, 4.0)).length() < 1e-9);
    let turned = keys(&[(0.0, 0.0, 1.0, 30.0)]).mirrored(DVec2::ZERO, 0.0);
    assert_eq!(turned, keys(&[(0.0, 0.0, -1.0, -30.0)]));
}

#[test]
fn what_is_attached_goes_along() {
    let truck = Moving {
        at_m: DVec2::new(10.0, 5.0),
        yaw_rad: std::f64::consts::FRAC_PI_2,
        velocity_mps: DVec2::new(0.0, 7.0),
    };
    let trailer = Motion::Attached {
        to: BoxId(1),
        at_m: DVec2::new(-8.0, 0.0),
        yaw_deg: 0.0,
    };
    let m = trailer.at(0.0, |_| Some(truck)).expect("there");
    assert!((m.at_m - DVec2::new(10.0, -3.0)).length() < 1e-9 && m.velocity_mps == truck.velocity_mps);
    assert_eq!(trailer.at(0.0, none), None);
    // Dragged a metre to its side, it stays there.
    let to = Moving {
        at_m: m.at_m + DVec2::X,
        ..m
    };
    let moved = trailer.carried(&m, &to);
    let there = moved.at(0.0, |_| Some(truck)).expect("there");
    assert!((there.at_m - to.at_m).length() < 1e-9);
}

#[test]
fn bad_motions_are_told_in_one_line() {
    let two = |a, b| keys(&[(a, 0.0, 0.0, 0.0), (b, 1.0, 0.0, 0.0)]);
    let path = |change: fn(&mut Path)| {
        let mut path = path();
        change(&mut path);
        Motion::Path(path)
    };
    for (motion, says) in [
        (keys(&[]), "0 keyframes, expected 1 to 10000"),
        (
            two(2.0, 1.0),
            "keyframe 1 at 1 s is before the one before it at 2 s",
        ),
        (two(1.0, 1.0), "keyframe 1 at 1 s is at the same time as"),
        (two(1.0, f64::NAN), "keyframe 1: time_s is NaN"),
        (keys(&[(0.0, 1e6, 0.0, 0.0)]), "at most 10000 m"),
        (keys(&[(0.0, 0.0, 0.0, f64::INFINITY)]), "inf degrees"),
        (
            Motion::Keys(vec![
                Key {
                    time_s: 0.0,
                    at_m: DVec2::ZERO,
                    yaw_deg: 0.0
                };
                20_000
            ]),
            "20000 keyframes",
        ),
        (
            path(|p| p.points_m.truncate(1)),
            "a path of 1 points in one place",
        ),
        (
            path(|p| p.points_m.fill(DVec2::ONE)),
            "a path of 3 points in one place",
        ),
        (path(|p| p.points_m[1].x = f64::NAN), "point 1 of a path"),
        (path(|p| p.speeds.clear()), "0 speeds"),
        (path(|p| p.speeds[1].mps = 1e4), "speed 1 is 10000 m/s"),
        (path(|p| p.speeds[2].time_s = 1.0), "speed 2 at 1 s is before"),
        (path(|p| p.start_m = f64::NAN), "start_m is NaN"),
    ] {
        let problem = motion.problem().expect(says);
        assert!(problem.contains(says) && !problem.contains('\n'), "{problem}");
    }
}

#[test]
fn the_way_covered_grows_with_the_motion_and_not_by_turning() {
    // A quarter of a circle of radius 10 m, walked forward.
    let way: Vec<(f64, f64, f64, f64)> = (0..=9)
        .map(|i| {
            let turn = f64::from(i) * 10f64.to_radians();
            (
                f64::from(i),
                10.0 * turn.sin(),
                10.0 - 10.0 * turn.cos(),
                turn.to_degrees(),
            )
        })
        .collect();
    let quarter_m = 5.0 * std::f64::consts::PI;
    let covered_m = keys(&way).covered_m(9.0);
    assert!((covered_m - quarter_m).abs() < 0.1, "{covered_m}");
    let (mut before_m, motion) = (0.0, keys(&way));
    for i in 0..=1200 {
        let now_m = motion.covered_m(f64::from(i) * 0.01);
        assert!(
            (-1e-9..0.03).contains(&(now_m - before_m)),
            "{now_m} after {before_m}"
        );
        before_m = now_m;
    }
    assert_eq!(motion.covered_m(-5.0), 0.0);
    assert!(motion.covered_m(f64::NAN).is_nan() || motion.covered_m(f64::NAN) == 0.0);
    let path = |rear_first| {
        Motion::Path(Path {
            points_m: vec![DVec2::ZERO, DVec2::new(20.0, 0.0)],
            speeds: vec![
                Speed {
                    time_s: 1.0,
                    mps: 2.0,
                },
                Speed {
                    time_s: 9.0,
                    mps: 2.0,
                },
            ],
            start_m: 3.0,
            rear_first,
        })
    };
    assert_eq!([0.0, 1.0, 4.0].map(|t| path(false).covered_m(t)), [0.0, 0.0, 6.0]);
    assert_eq!(path(true).covered_m(4.0), -6.0);
    let attached = Motion::Attached {
        to: BoxId(2),
        at_m: DVec2::ZERO,
        yaw_deg: 0.0,
    };
    assert_eq!(attached.covered_m(4.0), 0.0);
}
