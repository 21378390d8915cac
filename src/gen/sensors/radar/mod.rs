//! Scans of radars: rays over the field of view meet the surfaces that the exact LiDAR meets; what they send back adds up in cells
//! of range, azimuth, speed and, where heights are measured, elevation; the peaks that stand out of the noise are returns.
//!
//! Labels of Occ3D have the ground lower than it is: a ray ends where it meets the ground at its true height.
//!
//! Left out: echoes over several surfaces, limbs and wheels that move by themselves, interference by other radars.

mod cells;
mod echo;

use glam::DVec3;

use crate::lidar::rolling;
use cells::Cells;
use echo::Echo;
use scene::draft::ground_class;
use scene::{Class, LidarPattern, LidarPoint, Pose, RadarPattern, RadarScan, Scene};

/// Azimuths of rays, degrees apart.
const COLUMN_DEG: f64 = 0.2;
/// Elevations of rays above the plane of the sensor, as parts of the angle at which the antenna's gain is a half. What stands on the
/// ground is met at smaller elevations the farther it is: each is about 1.4 times the one before.
const ELEVATIONS: [f64; 14] = [
    0.01, 0.02, 0.032, 0.048, 0.07, 0.1, 0.14, 0.2, 0.28, 0.4, 0.55, 0.75, 1.0, 1.25,
];
/// Rays in a step of elevation that a radar tells apart.
const IN_STEP: f64 = 2.0;

/// A scan of every radar of the rig, in its order, at the moment that is shown. The scene is one for sensors
/// ([`Scene::for_sensors`]); positions are in its frame. The same scene gives the same scans on any number of threads.
pub fn scans(scene: &Scene) -> Vec<RadarScan> {
    scene.rig.radars.iter().map(|radar| scan(scene, radar)).collect()
}

/// A scan of one radar; see [`scans`].
pub fn scan(scene: &Scene, radar: &RadarPattern) -> RadarScan {
    let fan = fan(radar);
    let mut with = scene.clone();
    let rig = std::sync::Arc::make_mut(&mut with.rig);
    rig.lidars = vec![fan.clone()];
    let sweep = rolling::exact(&with);
    let world_from_sensor = radar.ego_from_sensor();
    let sensor_from_world = world_from_sensor.inverse();
    let velocity_mps = velocity_mps(scene, &world_from_sensor);
    let solid_angles = solid_angles(&fan.elevations_deg, radar.half_elevation_deg);
    let origin = world_from_sensor.translation_m;
    let mut cells = Cells::new(radar);
    let mut echo = Echo::new(scene);
    for point in &sweep.points {
        let (at, class) = above_ground(scene, origin, point);
        // What goes on beyond the map has no boxes, whatever its voxels say.
        if class.is_object() && scene.frame().extent().column_at(at.x, at.y).is_none() {
            continue;
        }
        let in_sensor = sensor_from_world.apply(at);
        let range_m = in_sensor.length();
        let Some(direction) = (at - origin).try_normalize() else {
            continue;
        };
        let moves = match class.is_ground() {
            true => DVec3::ZERO,
            false => glam::Vec2::from(point.velocity_mps).as_dvec2().extend(0.0),
        };
        let area_m2 = solid_angles[usize::from(point.ring)] * range_m * range_m;
        cells.add(cells::Patch {
            in_sensor,
            range_m,
            speed_mps: (moves - velocity_mps).dot(direction),
            own_mps: -velocity_mps.dot(direction),
            cross_section_m2: area_m2 * echo.per_m2(class, at, direction),
            class,
        });
    }
    let seed = cells::mix(scene.seed, (scene.time_s() * 1e3).round() as u64);
    RadarScan {
        radar: radar.name.clone(),
        returns: cells.returns(&world_from_sensor, seed),
    }
}

/// Place and class of what a ray met, or of the ground at its true height before it.
fn above_ground(scene: &Scene, origin: DVec3, point: &LidarPoint) -> (DVec3, Class) {
    let frame = scene.frame();
    let at = DVec3::from_array(point.position_in_ego.map(f64::from));
    match frame.layout.relief.met_by(origin, at - origin, 1.0) {
        Some(share) if share > 0.0 => {
            let met = origin + (at - origin) * share;
            let cell = frame.extent().column_at(met.x, met.y);
            let class = ground_class(cell.map_or(0, |[x, y]| frame.layout.cell(x, y)));
            (met, class)
        }
        _ => (at, point.class),
    }
}

/// Velocity of a sensor over the ground, in the frame of the scene, m/s.
fn velocity_mps(scene: &Scene, world_from_sensor: &Pose) -> DVec3 {
    let arm = world_from_sensor.translation_m - scene.rig.vehicle.translation_m;
    let moving = scene.clip().ego_moving(scene.time_s());
    let of_vehicle = moving.map_or(scene.rig.velocity_mps(), |moving| moving.velocity_mps.extend(0.0));
    of_vehicle + DVec3::Z.cross(arm) * scene.yaw_rate_rps()
}

/// The rays of a radar as those of a LiDAR: all at one instant, through the own vehicle.
fn fan(radar: &RadarPattern) -> LidarPattern {
    let half_deg = radar.half_azimuth_deg().min(180.0);
    LidarPattern {
        name: radar.name.clone(),
        elevations_deg: elevations_deg(radar),
        columns: (360.0 / COLUMN_DEG) as u32,
        first_azimuth_deg: -half_deg + COLUMN_DEG / 2.0,
        sector_deg: 2.0 * half_deg,
        clockwise: false,
        spin_hz: 0.0,
        part: None,
        max_range_m: radar.max_range_m(),
        min_range_m: radar.min_range_m,
        own_body: false,
        beyond_grid: true,
        rotation_wxyz: radar.rotation_wxyz,
        translation_m: radar.translation_m,
    }
}

/// Elevations of rays, ascending: denser near the plane of the sensor, and two in each step of a radar that measures heights.
fn elevations_deg(radar: &RadarPattern) -> Vec<f64> {
    let half_deg = radar.half_elevation_deg;
    let mut up: Vec<f64> = ELEVATIONS.iter().map(|part| part * half_deg).collect();
    if radar.elevation_step_deg > 0.0 {
        let step_deg = (radar.elevation_step_deg / IN_STEP).max(half_deg / 64.0);
        let most = up.last().copied().unwrap_or_default();
        up.extend(
            (0..)
                .map(|i| (f64::from(i) + 0.5) * step_deg)
                .take_while(|deg| *deg < most),
        );
    }
    up.retain(|deg| *deg < 90.0);
    let mut all: Vec<f64> = up.iter().flat_map(|deg| [*deg, -deg]).collect();
    all.sort_by(f64::total_cmp);
    all.dedup();
    all
}

/// Solid angle of one ray of each elevation, times the antenna's gain there and back, sr.
fn solid_angles(elevations_deg: &[f64], half_elevation_deg: f64) -> Vec<f64> {
    let up = elevations_deg;
    let last = up.len() - 1;
    let border = |i: usize| f64::midpoint(up[i], up[i + 1]);
    let of = |i: usize| {
        let from = if i == 0 {
            2.0 * up[0] - border(0)
        } else {
            border(i - 1)
        };
        let to = if i == last {
            2.0 * up[last] - border(last - 1)
        } else {
            border(i)
        };
        // The gain at the half-power angle is a half, there and back a quarter.
        let gain = 0.25f64.powf((up[i] / half_elevation_deg).powi(2));
        (to - from).to_radians() * COLUMN_DEG.to_radians() * up[i].to_radians().cos() * gain
    };
    (0..up.len()).map(of).collect()
}

#[cfg(test)]
mod tests;
