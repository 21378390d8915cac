//! Calibration of the sensors for programs that read their files: one JSON object beside pictures and sweeps.
//!
//! `frames` names every frame that numbers are given in. A camera has `intrinsic` (3 x 3, row-major, px), its `lens` with the
//! coefficients of the model (see [`scene::Lens`]), `shutter` where it rolls, and its pose in the ego frame: as quaternion w, x, y, z with
//! translation, m, and as a row-major 4 x 4 matrix. `ego_pose` places the ego frame in the world.

use serde_json::{Value, json};

use scene::{Camera, LidarPattern, Pose, RadarPattern, Scene};

const FORMAT: &str = "sceneloom_calibration";
const VERSION: u32 = 1;

/// Name of the file.
pub const FILE: &str = "calibration.json";

/// The bytes of such a file for the moment that a scene shows. Cameras are at the size of their pictures, `size`;
/// `None` leaves them at the size in the rig. `world_from_ego` is the pose of the ego vehicle.
pub fn to_bytes(scene: &Scene, world_from_ego: &Pose, size: Option<[u32; 2]>) -> Vec<u8> {
    let mut text = serde_json::to_string_pretty(&of(scene, world_from_ego, size)).unwrap_or_default();
    text.push('\n');
    text.into_bytes()
}

/// The content of such a file as a JSON value, from the arguments of [`to_bytes`].
pub fn of(scene: &Scene, world_from_ego: &Pose, size: Option<[u32; 2]>) -> Value {
    let sized = |c: &Camera| size.map_or_else(|| c.clone(), |[w, h]| c.resized(w, h));
    json!({
        "format": FORMAT,
        "version": VERSION,
        "scene": &*scene.name,
        "time_s": scene.time_s(),
        "timestamp_us": (scene.time_s() * 1e6).round() as i64,
        "rig": scene.rig.name,
        "frames": {
            "world": "x, y on the ground, z up, m; of the scene",
            "ego": "x forward, y left, z up, m; origin on the ground below the rear axle",
            "camera": "x right, y down, z forward, m; pixel i has its middle at i + 1/2",
            "lidar": "as the sensor's mount says, m",
            "radar": "x ahead, y left, z up, m",
        },
        "ego_pose": pose(world_from_ego),
        "cameras": scene.rig.cameras.iter().map(|c| camera(&sized(c))).collect::<Vec<_>>(),
        "lidars": scene.rig.lidars.iter().map(lidar).collect::<Vec<_>>(),
        "radars": scene.rig.radars.iter().map(radar).collect::<Vec<_>>(),
    })
}

fn pose(pose: &Pose) -> Value {
    let (q, t) = (pose.rotation, pose.translation_m);
    let columns = [glam::DVec3::X, glam::DVec3::Y, glam::DVec3::Z].map(|axis| q * axis);
    let row = |i: usize| [columns[0][i], columns[1][i], columns[2][i], t[i]];
    json!({
        "rotation_wxyz": [q.w, q.x, q.y, q.z],
        "translation_m": t.to_array(),
        "matrix": [row(0), row(1), row(2), [0.0, 0.0, 0.0, 1.0]],
    })
}

fn camera(c: &Camera) -> Value {
    let ([fx, fy], [cx, cy]) = (c.focal_px, c.center_px);
    let depth = match c.lens.is_wide() {
        true => "distance from the optical centre, m",
        false => "along the optical axis, m",
    };
    json!({
        "name": c.name,
        "width": c.width,
        "height": c.height,
        "intrinsic": [[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]],
        "lens": c.lens,
        "shutter": c.shutter,
        "depth": depth,
        "ego_from_camera": pose(&c.ego_from_camera()),
    })
}

fn lidar(l: &LidarPattern) -> Value {
    json!({
        "name": l.name,
        "elevations_deg": l.elevations_deg,
        "columns": l.columns,
        "first_azimuth_deg": l.first_azimuth_deg,
        "clockwise": l.clockwise,
        "spin_hz": l.spin_hz,
        "ego_from_lidar": pose(&l.ego_from_sensor()),
    })
}

fn radar(r: &RadarPattern) -> Value {
    json!({
        "name": r.name,
        "fields": r.fields,
        "speeds_mps": r.speeds_mps,
        "scan_hz": r.scan_hz,
        "ego_from_radar": pose(&r.ego_from_sensor()),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table_tests::scene;

    #[test]
    fn a_point_goes_from_the_world_to_its_pixel() {
        let mut scene = scene();
        let rig = std::sync::Arc::make_mut(&mut scene.rig);
        rig.cameras[1].lens = scene::Lens::Fisheye {
            k: [0.01, 0.0, 0.0, 0.0],
            max_angle_deg: 90.0,
        };
        let ego = Pose::from_wxyz([0.8, 0.0, 0.0, 0.6], [30.0, -4.0, 0.0]);
        let bytes = to_bytes(&scene, &ego, Some([800, 450]));
        let value: Value = serde_json::from_slice(&bytes).expect("JSON");
        let camera = &value["cameras"][1];
        assert_eq!(camera["lens"]["fisheye"]["k"][0], 0.01);
        let matrix = |v: &Value| -> glam::DMat4 {
            let rows: Vec<[f64; 4]> = serde_json::from_value(v["matrix"].clone()).expect("4 x 4");
            glam::DMat4::from_cols_array_2d(&[rows[0], rows[1], rows[2], rows[3]]).transpose()
        };
        let world_from_camera = matrix(&value["ego_pose"]) * matrix(&camera["ego_from_camera"]);
        let in_camera = glam::DVec3::new(0.0, 0.0, 12.0);
        let expected = ego.apply(scene.rig.cameras[1].ego_from_camera().apply(in_camera));
        assert!(world_from_camera.transform_point3(in_camera).distance(expected) < 1e-9);
        let half = scene.rig.cameras[1].focal_px[0] / 2.0;
        assert_eq!(camera["intrinsic"][0][0].as_f64(), Some(half));
        assert_eq!(value["timestamp_us"], 0);
    }
}
