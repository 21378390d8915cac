//! The cameras of a rig as the calibration of a world scenario: f-theta models under the names that readers look for.

use glam::EulerRot;
use scene::rig::Aim;
use scene::{Camera, SensorRig};
use serde_json::{Value, json};

use super::ftheta::FTheta;

/// The cameras that the models were trained with: name, heading and width of view in degrees.
const KNOWN: [(&str, f64, f64); 7] = [
    ("camera:front:wide:120fov", 0.0, 120.0),
    ("camera:cross:left:120fov", 66.0, 120.0),
    ("camera:cross:right:120fov", -67.0, 120.0),
    ("camera:rear:left:70fov", 151.0, 70.0),
    ("camera:rear:right:70fov", -155.0, 70.0),
    ("camera:rear:tele:30fov", 180.0, 30.0),
    ("camera:front:tele:30fov", 0.0, 30.0),
];
/// Largest angle between a camera's direction and that of the name it gets, degrees.
const AWAY_DEG: f64 = 50.0;

/// A camera under its name in the scenario.
pub(crate) struct ScenarioCamera {
    pub(crate) name: String,
    pub(crate) camera: Camera,
    pub(crate) model: FTheta,
    /// True for one that the rig has not, see [`substitute`].
    pub(crate) added: bool,
}

impl ScenarioCamera {
    /// The name as used in names of files.
    pub(crate) fn file_name(&self) -> String {
        self.name.replace(':', "_")
    }
}

/// The cameras of a rig, in its order. Each of the known names goes to the camera that looks most nearly that way; others keep
/// their own. Names that no camera got follow, so that readers find all seven; a rig without cameras stays so.
pub(crate) fn named(rig: &SensorRig) -> Vec<ScenarioCamera> {
    let mut names: Vec<Option<String>> = vec![None; rig.cameras.len()];
    let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
    for (i, camera) in rig.cameras.iter().enumerate() {
        for (k, (_, yaw_deg, fov_deg)) in KNOWN.iter().enumerate() {
            let away_deg = (camera.aim().yaw_deg - yaw_deg + 180.0).rem_euclid(360.0) - 180.0;
            // The width of the view decides between two that look the same way.
            let unlike = (camera.fov_deg() / fov_deg).ln().abs();
            if away_deg.abs() <= AWAY_DEG {
                pairs.push((away_deg.abs() + 10.0 * unlike, i, k));
            }
        }
    }
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let mut taken = [false; KNOWN.len()];
    for (_, i, k) in pairs {
        if names[i].is_none() && !taken[k] {
            names[i] = Some(KNOWN[k].0.to_owned());
            taken[k] = true;
        }
    }
    let mut out: Vec<ScenarioCamera> = Vec::new();
    for (camera, name) in rig.cameras.iter().zip(names) {
        let name = name.unwrap_or_else(|| own_name(&camera.name));
        let is_new = |name: &str| out.iter().all(|n| n.name != name);
        let name = match is_new(&name) {
            true => name,
            false => (2..)
                .map(|i| format!("{name}:{i}"))
                .find(|n| is_new(n))
                .unwrap_or(name),
        };
        out.push(ScenarioCamera {
            name,
            camera: camera.clone(),
            model: FTheta::from_camera(camera),
            added: false,
        });
    }
    let missing = KNOWN.iter().zip(taken).filter(|(_, taken)| !taken);
    let added: Vec<ScenarioCamera> = missing.filter_map(|(known, _)| substitute(rig, *known)).collect();
    out.extend(added);
    out
}

/// A pinhole camera of the heading and width that belong to a known name, where the camera of the rig stands that looks most
/// nearly that way.
fn substitute(rig: &SensorRig, (name, yaw_deg, fov_deg): (&str, f64, f64)) -> Option<ScenarioCamera> {
    let away_deg = |c: &Camera| ((c.aim().yaw_deg - yaw_deg + 180.0).rem_euclid(360.0) - 180.0).abs();
    let nearest = rig
        .cameras
        .iter()
        .min_by(|a, b| away_deg(a).total_cmp(&away_deg(b)))?;
    let mut camera = Camera::new(name, fov_deg);
    camera.translation_m = nearest.translation_m;
    camera.set_aim(Aim {
        yaw_deg,
        pitch_deg: 0.0,
        roll_deg: 0.0,
    });
    Some(ScenarioCamera {
        name: name.to_owned(),
        model: FTheta::from_camera(&camera),
        camera,
        added: true,
    })
}

/// `CAM_FRONT` as `camera:cam:front`.
fn own_name(name: &str) -> String {
    let tidy = |c: char| {
        if c.is_ascii_alphanumeric() {
            c.to_ascii_lowercase()
        } else {
            ':'
        }
    };
    let name: String = name.chars().map(tidy).collect();
    let parts: Vec<&str> = name.split(':').filter(|part| !part.is_empty()).collect();
    format!("camera:{}", parts.join(":"))
}

/// The text of `rig_json`. Errors never: every number of a sound rig is finite.
pub(crate) fn to_json(rig: &SensorRig) -> String {
    let sensors: Vec<Value> = named(rig).iter().map(sensor).collect();
    json!({"rig": {"sensors": sensors, "vehicle": {}}, "version": 8}).to_string()
}

fn sensor(named: &ScenarioCamera) -> Value {
    let (camera, model) = (&named.camera, &named.model);
    let origin = if named.added { "added" } else { "sceneloom" };
    let polynomial: Vec<String> = model.angle_of_px.iter().map(|k| format!("{k:e}")).collect();
    json!({
        "name": named.name,
        "protocol": "camera.virtual",
        // (a list of keys and values)
        "parameter": format!("{origin}={},fit_error_px={:.4}", camera.name.replace([',', '='], "_"), model.error_px),
        "properties": {
            "Model": "ftheta",
            "cx": model.center_px[0].to_string(),
            "cy": model.center_px[1].to_string(),
            "width": model.width.to_string(),
            "height": model.height.to_string(),
            "polynomial": polynomial.join(" "),
            "polynomial-type": "pixeldistance-to-angle",
            "linear-c": model.linear_c.to_string(),
            "linear-d": "0",
            "linear-e": "0",
        },
        "nominalSensor2Rig_FLU": {
            "t": camera.translation_m,
            "roll-pitch-yaw": roll_pitch_yaw_deg(camera),
        },
        "correction_sensor_R_FLU": {"roll-pitch-yaw": [0.0, 0.0, 0.0]},
        "correction_rig_T": [0.0, 0.0, 0.0],
    })
}

/// How the camera's body (x along the view, y left, z up) is turned in the ego frame: about x, then y, then z, degrees. A
/// positive pitch looks down.
fn roll_pitch_yaw_deg(camera: &Camera) -> [f64; 3] {
    let ahead = Aim {
        yaw_deg: 0.0,
        pitch_deg: 0.0,
        roll_deg: 0.0,
    };
    let mut level = camera.clone();
    level.set_aim(ahead);
    let optical = level.ego_from_camera().rotation;
    let body = camera.ego_from_camera().rotation * optical.inverse();
    let (yaw, pitch, roll) = body.normalize().to_euler(EulerRot::ZYX);
    // Adding 0 turns -0 into 0.
    [roll, pitch, yaw].map(|angle| angle.to_degrees() + 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DMat3, DQuat, DVec3};

    #[test]
    fn cameras_get_the_names_of_those_that_look_their_way() {
        let rig = SensorRig::default();
        let names: Vec<String> = named(&rig)
            .into_iter()
            .map(|n| format!("{} {}", n.camera.name, n.name))
            .collect();
        assert_eq!(
            names,
            [
                "CAM_FRONT_LEFT camera:cross:left:120fov",
                "CAM_FRONT camera:front:wide:120fov",
                "CAM_FRONT_RIGHT camera:cross:right:120fov",
                "CAM_BACK_RIGHT camera:rear:right:70fov",
                "CAM_BACK camera:rear:tele:30fov",
                "CAM_BACK_LEFT camera:rear:left:70fov",
                "camera:front:tele:30fov camera:front:tele:30fov",
            ]
        );
        // Two that look ahead, and one more that keeps its own name.
        let mut rig = SensorRig {
            cameras: vec![
                Camera::new("A tele", 30.0),
                Camera::new("wide", 110.0),
                Camera::new("wide", 100.0),
            ],
            ..rig
        };
        rig.cameras.push(Camera::new("WIDE", 100.0));
        let all = named(&rig);
        let names: Vec<&str> = all.iter().filter(|n| !n.added).map(|n| n.name.as_str()).collect();
        let expected = [
            "camera:front:tele:30fov",
            "camera:front:wide:120fov",
            "camera:wide",
            "camera:wide:2",
        ];
        assert_eq!(names, expected);
        // The five names that nobody got: readers look for all seven.
        let added: Vec<&ScenarioCamera> = all.iter().filter(|n| n.added).collect();
        assert_eq!(added.len(), 5);
        for (name, yaw_deg, fov_deg) in KNOWN {
            assert_eq!(all.iter().filter(|n| n.name == name).count(), 1, "{name}");
            if let Some(new) = added.iter().find(|n| n.name == name) {
                assert!((new.camera.fov_deg() - fov_deg).abs() < 1e-6, "{name}");
                let away_deg = (new.camera.aim().yaw_deg - yaw_deg).rem_euclid(360.0);
                assert!(away_deg.min(360.0 - away_deg) < 1e-6, "{name}");
                assert_eq!(new.camera.translation_m, rig.cameras[0].translation_m, "{name}");
            }
        }
        assert!(
            named(&SensorRig {
                cameras: Vec::new(),
                ..rig
            })
            .is_empty()
        );
    }

    /// The pose as a reader puts it together: scipy's `from_euler("xyz")`, then optical axes.
    #[test]
    fn angles_are_those_that_readers_turn_by() {
        let rig = SensorRig::default();
        for camera in &rig.cameras {
            let [roll, pitch, yaw] = roll_pitch_yaw_deg(camera).map(f64::to_radians);
            let body =
                DQuat::from_rotation_z(yaw) * DQuat::from_rotation_y(pitch) * DQuat::from_rotation_x(roll);
            let body = DMat3::from_quat(body);
            let optical = DMat3::from_cols(-body.y_axis, -body.z_axis, body.x_axis);
            let expected = DMat3::from_quat(camera.ego_from_camera().rotation);
            for (a, b) in [
                (optical.x_axis, expected.x_axis),
                (optical.y_axis, expected.y_axis),
                (optical.z_axis, expected.z_axis),
            ] {
                assert!((a - b).length() < 1e-9, "{}", camera.name);
            }
        }
        let mut down = Camera::new("CAM", 90.0);
        down.set_aim(Aim {
            yaw_deg: 0.0,
            pitch_deg: -20.0,
            roll_deg: 0.0,
        });
        assert!((roll_pitch_yaw_deg(&down)[1] - 20.0).abs() < 1e-9);
        assert!((down.ego_from_camera().rotation * DVec3::Z).z < 0.0);
    }
}
