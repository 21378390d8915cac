//! Calibrated sensors as a rig.

use glam::DVec3;
use scene::rig_presets::RADARS;
use scene::{Camera, LidarPattern, Pose, RadarPattern, SensorRig};

use super::read::Kinds;
use super::{Skipped, count};
use crate::nuscenes::pose;
use crate::nuscenes::tables::{CalibratedSensor, SampleData};
use crate::sensor_names::LIDAR;

/// Height below which no LiDAR is: points are in the frame of the vehicle, m.
const LOWEST_LIDAR_M: f64 = 0.3;

/// Place of the LiDAR whose points have this pose in the ego frame, m. Points of T4 are in that frame itself: then it is that of the
/// highest LiDAR that the tables know, else that of the known vehicle.
pub(super) fn lidar_place(kinds: &Kinds<'_>, ego_from_points: &Pose) -> DVec3 {
    let at_m = ego_from_points.translation_m;
    if at_m.z >= LOWEST_LIDAR_M {
        return at_m;
    }
    let known = SensorRig::default();
    let usual_m = known
        .lidars
        .first()
        .map_or(at_m, |l| DVec3::from_array(l.translation_m));
    let others = kinds
        .lidar_places()
        .filter(|at| at.is_finite() && at.z >= LOWEST_LIDAR_M);
    others.max_by(|a, b| a.z.total_cmp(&b.z)).unwrap_or(usual_m)
}

/// The sensors that measured something in these key frames, as they were calibrated at the first. Cameras of the known vehicle are in the order of its rig, others in that of the table. The tables do not hold the
/// beams of a LiDAR or the pattern of a radar: these are the known vehicle's.
pub(super) fn rig(kinds: &Kinds<'_>, data: &[SampleData], skipped: &mut Skipped) -> SensorRig {
    let known = SensorRig::default();
    let mut rig = SensorRig {
        name: "nuScenes".into(),
        cameras: Vec::new(),
        lidars: Vec::new(),
        radars: Vec::new(),
        ..known.clone()
    };
    let (mut cameras, mut taken) = (Vec::new(), Vec::new());
    for row in data {
        let Some((calibrated, sensor)) = kinds.of(row) else {
            continue;
        };
        if taken.contains(&&*sensor.channel) {
            continue;
        }
        taken.push(&sensor.channel);
        match sensor.modality.as_str() {
            "camera" => match camera(&sensor.channel, calibrated, row) {
                Some(camera) => cameras.push(camera),
                None => count(skipped, "cameras without sound intrinsics", 1),
            },
            "lidar" => match lidar(&sensor.channel, calibrated, kinds, &known) {
                Some(lidar) => rig.lidars.push(lidar),
                None => count(skipped, "LiDARs without a sound pose", 1),
            },
            "radar" => match radar(&sensor.channel, calibrated) {
                Some(radar) => rig.radars.push(radar),
                None => count(skipped, "radars without a sound pose", 1),
            },
            _ => count(skipped, "sensors of other kinds", 1),
        }
    }
    let known_place = |c: &Camera| known.cameras.iter().position(|k| k.name == c.name);
    let all_known = cameras.iter().all(|c| known_place(c).is_some());
    cameras.sort_by_key(|c| match all_known {
        true => known_place(c),
        false => kinds.channels.iter().position(|channel| *channel == c.name),
    });
    cameras.truncate(SensorRig::MOST_SENSORS);
    rig.cameras = cameras;
    // The first LiDAR is the one that sweeps are made of.
    rig.lidars.sort_by_key(|l| l.name != LIDAR);
    rig.lidars.truncate(SensorRig::MOST_SENSORS);
    rig.radars.truncate(SensorRig::MOST_SENSORS);
    rig
}

fn camera(name: &str, calibrated: &CalibratedSensor, row: &SampleData) -> Option<Camera> {
    let [[fx, _, cx], [_, fy, cy], _] = *calibrated.camera_intrinsic.first_chunk::<3>()?;
    let camera = Camera {
        width: row.width,
        height: row.height,
        focal_px: [fx, fy],
        center_px: [cx, cy],
        rotation_wxyz: calibrated.rotation,
        translation_m: calibrated.translation,
        ..Camera::new(name, 90.0)
    };
    let alone = SensorRig {
        // (names are looked at where the whole rig is known)
        cameras: vec![Camera {
            name: "CAM".into(),
            ..camera.clone()
        }],
        ..SensorRig::default()
    };
    alone.problem().is_none().then_some(camera)
}

fn lidar(
    name: &str,
    calibrated: &CalibratedSensor,
    kinds: &Kinds<'_>,
    known: &SensorRig,
) -> Option<LidarPattern> {
    let ego_from_points = pose(name, calibrated.rotation, calibrated.translation).ok()?;
    Some(LidarPattern {
        name: name.into(),
        rotation_wxyz: calibrated.rotation,
        translation_m: lidar_place(kinds, &ego_from_points).to_array(),
        ..known.lidars.first()?.clone()
    })
}

fn radar(name: &str, calibrated: &CalibratedSensor) -> Option<RadarPattern> {
    pose(name, calibrated.rotation, calibrated.translation).ok()?;
    Some(RadarPattern {
        name: name.into(),
        rotation_wxyz: calibrated.rotation,
        translation_m: calibrated.translation,
        ..(RADARS.first()?.build)()
    })
}
