//! A trial of what is told about the ground behind a removed object: a car that was never there is put into a recorded sweep, the
//! returns that it would hide are hidden, it is removed, and what its rays then meet is compared with what was measured.

use std::sync::Arc;

use glam::{DVec2, DVec3};
use scene::{BoxId, Class, Frame, RecordedReturn, Scene, SceneBox, SweepRecording};

use super::EditableSweep;
use super::added::entered;
use super::changes::LOWEST_M;

/// Size of the car, m.
const CAR_M: DVec3 = DVec3::new(4.5, 1.9, 1.6);
/// Distances of cars from the sensor, and steps between them, m.
const NEAREST_M: f64 = 6.0;
const FARTHEST_M: f64 = 25.0;
const STEP_M: f64 = 5.0;
/// Returns that a car hides at least.
const LEAST_HIDDEN: usize = 100;
/// Height above the ground from which a return stands in the way of a car, m.
const CLEAR_M: f32 = 0.3;

/// What became of the rays that one car hid.
#[derive(Clone, Debug)]
pub struct HoleTrial {
    /// Where the car was.
    pub center_m: DVec3,
    /// Rays that it hid, all of them with a return in the recording.
    pub hidden: usize,
    /// Difference of the told from the measured range of each ray that has a return again, m.
    pub errors_m: Vec<f64>,
}

/// A trial for each place around the sensor where a car can stand, with what other sweeps of the drive saw there.
pub fn holes(recording: &Arc<SweepRecording>, others: &[Arc<SweepRecording>]) -> Vec<HoleTrial> {
    let whole = EditableSweep::new(recording.clone(), &[]);
    let steps = (FARTHEST_M / STEP_M) as i32;
    let places = (-steps..=steps).flat_map(|x| (-steps..=steps).map(move |y| [x, y]));
    let cars = places.filter_map(|[x, y]| {
        let p = recording.sensor_m.truncate() + DVec2::new(f64::from(x), f64::from(y)) * STEP_M;
        let far_m = p.distance(recording.sensor_m.truncate());
        let ground_m = whole.ground.height_m(p)?;
        let car = SceneBox {
            id: BoxId(1_000_000),
            class: Class::Car,
            center_m: p.extend(ground_m + CAR_M.z / 2.0),
            size_m: CAR_M,
            yaw_rad: f64::from(x + 3 * y),
            velocity_mps: DVec2::ZERO,
            label: Default::default(),
        };
        let is_free = || {
            let standing = whole.held(&car, 0.2).filter(|i| whole.heights_m[*i] > CLEAR_M);
            standing.count() == 0
        };
        ((NEAREST_M..=FARTHEST_M).contains(&far_m) && is_free()).then_some(car)
    });
    let cars: Vec<SceneBox> = cars.collect();
    cars.iter()
        .filter_map(|car| trial(recording, others, car))
        .collect()
}

fn trial(
    recording: &Arc<SweepRecording>,
    others: &[Arc<SweepRecording>],
    car: &SceneBox,
) -> Option<HoleTrial> {
    let sensor = recording.sensor_m;
    let (mut returns, mut hidden) = (recording.returns.to_vec(), Vec::new());
    for (i, r) in returns.iter_mut().enumerate() {
        let Some(way) = r.map(|r| r.place() - sensor) else {
            continue;
        };
        let direction = way.normalize_or_zero();
        let Some(t_m) = entered(car, sensor, direction).filter(|t| *t < way.length()) else {
            continue;
        };
        let lowest_m = car.center_m.z - CAR_M.z / 2.0 + 2.0 * LOWEST_M;
        if (sensor + direction * t_m).z < lowest_m {
            continue;
        }
        hidden.push((i as u32, way.length()));
        // A little inside, as returns on its faces are its own.
        let at = sensor + direction * (t_m + 0.01);
        *r = r.map(|r| RecordedReturn {
            at_m: at.as_vec3().to_array(),
            ..r
        });
    }
    if hidden.len() < LEAST_HIDDEN {
        return None;
    }
    let before = with_box(&recording.before, car);
    let after = recording.before.clone();
    let hidden_by_car = SweepRecording {
        returns: Arc::new(returns),
        before: Arc::new(before),
        ..SweepRecording::clone(recording)
    };
    let sweep = EditableSweep::new(Arc::new(hidden_by_car), others);
    let edits = sweep.edits(&after);
    let told = |(record, range_m): &(u32, f64)| {
        let new = edits.changed.get(record).copied().flatten()?;
        Some(new.at_m.distance(sensor) - range_m)
    };
    Some(HoleTrial {
        center_m: car.center_m,
        hidden: hidden.len(),
        errors_m: hidden.iter().filter_map(told).collect(),
    })
}

fn with_box(scene: &Scene, b: &SceneBox) -> Scene {
    let frame: &Frame = scene.frame();
    let relief_m = frame.layout.relief.height_m(b.center_m.truncate());
    let mut scene = scene.clone();
    scene.change_canvas(|canvas| {
        let on_scene = SceneBox {
            center_m: b.center_m.with_z(relief_m + b.size_m.z / 2.0),
            ..*b
        };
        canvas.boxes.insert(b.id, on_scene);
    });
    scene
}
