//! Tests of tracks of made finds.

use numeric::splitmix::SplitMix64;

use super::*;

fn find(at_m: DVec2, yaw_rad: f64, score: f64) -> Find {
    Find {
        group: DetectionGroup::Car,
        score,
        at_m,
        size_m: DVec3::new(4.5, 1.9, 1.6),
        yaw_rad,
    }
}

/// Finds of a car that drives at 8 m/s along x past one that is parked, whose front the network mistakes now and then, with
/// errors of 0.3 m, gaps and ghosts.
fn street() -> (Vec<Vec<Find>>, Vec<f64>) {
    let mut random = SplitMix64::new(5);
    let times_s: Vec<f64> = (0..16).map(|i| f64::from(i) * 0.5).collect();
    let moments = times_s.iter().enumerate().map(|(i, t)| {
        let mut off = || DVec2::new(random.unit() - 0.5, random.unit() - 0.5) * 0.6;
        let turned = if i % 5 == 2 { std::f64::consts::PI } else { 0.0 };
        let mut finds = vec![find(DVec2::new(10.0, 4.0) + off(), 1.5 + turned, 0.7)];
        if i % 6 != 3 {
            finds.push(find(DVec2::new(8.0 * t - 30.0, 0.0) + off(), turned, 0.6));
        }
        // Ghosts, each somewhere else.
        finds.push(find(DVec2::new(off().x * 100.0, 20.0 + off().y * 30.0), 0.0, 0.5));
        finds
    });
    (moments.collect(), times_s)
}

#[test]
fn what_drives_is_one_track_what_stands_is_one_box_and_ghosts_are_none() {
    let (moments, times_s) = street();
    let found = objects(&moments, &times_s);
    assert_eq!(found.len(), 2, "{found:?}");
    let standing = found
        .iter()
        .find(|o| o.places.len() == 1)
        .expect("the parked one");
    let (_, at_m, yaw_rad) = standing.places[0];
    assert!(at_m.distance(DVec2::new(10.0, 4.0)) < 0.2, "{at_m}");
    assert!(
        DVec2::from_angle(yaw_rad).dot(DVec2::from_angle(1.5)) > 0.99,
        "{yaw_rad}"
    );
    let moving = found
        .iter()
        .find(|o| o.places.len() > 1)
        .expect("the one that drives");
    assert!(moving.places.len() >= 12);
    for (moment, at_m, yaw_rad) in &moving.places {
        let truth = DVec2::new(8.0 * times_s[*moment] - 30.0, 0.0);
        assert!(at_m.distance(truth) < 0.45, "{moment}: {at_m}, {truth}");
        assert!(yaw_rad.abs() < 0.1, "{moment}: {yaw_rad}");
    }
}

#[test]
fn nothing_and_single_moments_are_sound() {
    assert!(objects(&[], &[]).is_empty());
    let one = vec![vec![
        find(DVec2::ZERO, 0.0, 0.9),
        find(DVec2::ONE * 9.0, 0.0, 0.2),
    ]];
    assert_eq!(objects(&one, &[0.0]).len(), 1);
}
