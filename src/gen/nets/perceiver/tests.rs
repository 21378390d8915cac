//! Against the numbers of the twin, and what happens at the edges.

use std::collections::BTreeMap;
use std::time::Instant;

use super::against::{Against, against};
use super::*;
use crate::twin::{Twin, returns, uniform};
use scene::{BoxId, Class, LidarPoint, Pose, SceneBox, Window};

const TWIN: Twin = Twin("perception");

fn square(side: usize, width: usize, stream: u64) -> FeatureMap {
    FeatureMap {
        data: uniform(side * side * width, stream),
        rows: side,
        columns: side,
        width,
    }
}

fn shipped() -> Arc<LidarPerceiver> {
    LidarPerceiver::bundled().expect("the shipped weights")
}

#[test]
fn pillars_are_those_of_the_twin() {
    let map = pillars(returns());
    let rows = (94..106).flat_map(|x| (94..106).map(move |y| (x * Window::NY + y) * PILLAR));
    let found: Vec<f32> = rows
        .flat_map(|at| map.data[at..at + PILLAR].iter().copied())
        .collect();
    TWIN.compare("pillars", &found);
    let rest = pillars(returns().into_iter().skip(4));
    assert_eq!(map, rest, "what is outside or not finite is left out");
}

#[test]
fn networks_say_what_the_twin_says() {
    let tiny = LidarPerceiver::load(&TWIN.path("tiny.safetensors")).expect("the tiny network");
    for (name, net) in [("shipped", &*shipped()), ("tiny", &tiny)] {
        let said = net.forward(square(32, PILLAR, 2)).expect("finite");
        TWIN.compare(&format!("{name}_stands"), &said.stands.data);
        TWIN.compare(&format!("{name}_boxes"), &said.boxes.data);
    }
}

#[test]
fn boxes_are_those_of_the_twin() {
    let found = decode(&square(16, CELL, 3), 0.6);
    let group = |g: DetectionGroup| {
        DetectionGroup::ALL
            .iter()
            .position(|other| *other == g)
            .expect("one of them")
    };
    let numbers = found.iter().flat_map(|d| {
        let first = [group(d.group) as f32, d.score];
        first
            .into_iter()
            .chain(d.center_m)
            .chain(d.size_m)
            .chain([d.yaw_rad])
    });
    TWIN.compare("decoded", &numbers.collect::<Vec<f32>>());
    assert!(found.len() > 20);
}

#[test]
fn an_empty_sweep_shows_nothing() {
    let seen = shipped().perceive([], SCORE).expect("finite");
    assert_eq!((seen.stands.len(), seen.detections), (200 * 200, vec![]));
    let nan = shipped()
        .perceive([[f32::NAN; 4], [1e30, 0.0, 0.0, 1.0]], SCORE)
        .expect("finite");
    assert_eq!(nan.stands, seen.stands);
}

#[test]
fn bad_maps_are_refused_in_one_line() {
    let refusal = |map: FeatureMap| shipped().forward(map).expect_err("refused").to_string();
    let mut short = square(32, PILLAR, 2);
    short.data.pop();
    assert_eq!(refusal(short), "pillars has 19455 values, expected 19456");
    assert_eq!(
        refusal(square(12, PILLAR, 2)),
        "rows is 12, expected a multiple of 8 up to 4096"
    );
    let mut nan = square(8, PILLAR, 2);
    nan.data[7] = f32::NAN;
    assert!(refusal(nan).starts_with("pillars: value 7 is NaN"));
    let other = WeightFile::parse("text", assets::weights::TEXT).expect("a file");
    let told = LidarPerceiver::on(Cpu, other)
        .map(|_| ())
        .expect_err("another network")
        .to_string();
    assert!(
        told.contains("expected lidar_perceiver") && !told.contains('\n'),
        "{told}"
    );
}

/// A level road, and a car of 4.5 x 1.9 x 1.6 m whose near side and roof send echoes.
fn road_with_car(car_m: [f32; 2]) -> Vec<[f32; 4]> {
    let mut returns = Vec::new();
    let near = |x: f32, y: f32| (x - car_m[0]).abs() < 2.25 && (y - car_m[1]).abs() < 0.95;
    for ring in 1..24 {
        for i in 0..1084 {
            let (sin, cos) = (i as f32 * std::f32::consts::TAU / 1084.0).sin_cos();
            let away = 1.84 / (0.55 - 0.022 * ring as f32).tan();
            let hit = (1..200)
                .map(|k| away * k as f32 / 200.0)
                .find(|r| near(r * cos, r * sin) && 1.84 * (1.0 - r / away) < 1.6);
            let range = hit.unwrap_or(away);
            returns.push([range * cos, range * sin, 1.84 * (1.0 - range / away), 20.0]);
        }
    }
    returns
}

/// What a vehicle sees does not depend on where it stands on the map.
#[test]
fn a_sweep_is_seen_from_its_vehicle() {
    let returns = road_with_car([8.0, 3.0]);
    let map_from_vehicle = Pose::planar(120.0, -40.0, 0.5);
    let points = returns.iter().map(|[x, y, z, intensity]| {
        let at = map_from_vehicle.apply(glam::Vec3::new(*x, *y, *z).as_dvec3());
        LidarPoint {
            position_in_ego: at.as_vec3().to_array(),
            intensity: *intensity,
            ..point(0.0, 0.0)
        }
    });
    let sweep = LidarSweep {
        points: points.collect(),
        ..Default::default()
    };
    let placed = shipped()
        .perceive_sweep(&sweep, &map_from_vehicle)
        .expect("finite");
    let seen = shipped().perceive(returns, SCORE).expect("finite");
    // A return on the edge of a column may fall into the next one.
    let pairs = placed.stands.iter().zip(&seen.stands);
    let same = pairs.filter(|(a, b)| a == b).count();
    assert!(same * 100 > 99 * seen.stands.len(), "{same}");
    assert_eq!(placed.detections.len(), seen.detections.len());
}

/// The same bytes on one thread and on two; and it is quick.
#[test]
fn threads_do_not_change_what_is_seen() {
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("a pool").install(|| {
            let start = Instant::now();
            let said = shipped()
                .forward(pillars(road_with_car([8.0, 3.0])))
                .expect("finite");
            println!("{threads} threads: {:.0} ms", start.elapsed().as_secs_f64() * 1e3);
            said
        })
    };
    let bits = |map: &FeatureMap| map.data.iter().map(|v| v.to_bits()).collect::<Vec<u32>>();
    let (one, two) = (run(1), run(2));
    assert_eq!(bits(&one.stands), bits(&two.stands));
    assert_eq!(bits(&one.boxes), bits(&two.boxes));
}

fn point(x: f32, y: f32) -> LidarPoint {
    LidarPoint {
        position_in_ego: [x, y, 0.8],
        range_m: 1.0,
        ring: 0,
        azimuth: 0,
        class: Class::Car,
        intensity: 0.0,
        drop_probability: 0.0,
        time_s: 0.0,
        velocity_mps: [0.0; 2],
    }
}

fn car(id: u32, x: f64, y: f64) -> SceneBox {
    SceneBox {
        id: BoxId(id),
        class: Class::Car,
        center_m: glam::DVec3::new(x, y, 0.8),
        size_m: glam::DVec3::new(4.5, 1.9, 1.6),
        yaw_rad: 0.0,
        velocity_mps: glam::DVec2::ZERO,
        label: Default::default(),
    }
}

#[test]
fn misses_and_ghosts_are_told_apart() {
    // The vehicle stands 100 m ahead on the map.
    let map_from_vehicle = Pose::planar(100.0, 0.0, 0.0);
    let boxes: BTreeMap<u32, SceneBox> = [(1, 110.0), (2, 120.0), (3, 130.0), (4, 300.0)]
        .into_iter()
        .map(|(id, x)| (id, car(id, x, 0.0)))
        .collect();
    let (first, second) = (vec![point(110.0, 0.5); 7], vec![point(120.0, 0.5); 9]);
    let sweep = LidarSweep {
        points: [first, second].concat(),
        ..Default::default()
    };
    let seen = |x: f32| Detection {
        group: DetectionGroup::Car,
        score: 0.9,
        center_m: [x, 0.3, 0.8],
        size_m: [4.5, 1.9, 1.6],
        yaw_rad: 0.1,
    };
    let held = against(
        &[seen(10.5), seen(-10.0)],
        boxes.values(),
        &sweep,
        &map_from_vehicle,
    );
    assert_eq!(held.ghosts, [1]);
    assert_eq!(held.boxes.len(), 3, "one is far outside the window");
    assert_eq!(held.boxes[0].found, Some(0));
    let missed: Vec<BoxId> = held.missed().iter().map(|b| b.id).collect();
    assert_eq!(missed, [BoxId(2)], "the third has no return");
    let nothing = against(&[], [], &LidarSweep::default(), &Pose::IDENTITY);
    assert_eq!(nothing, Against::default());
    assert_eq!(seen(1.0).to_box(BoxId(9)).class, Class::Car);
}
