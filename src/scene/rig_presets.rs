//! Sensors to begin with: LiDARs and radars by their published patterns, camera rigs of common vehicles.

use super::rig::Aim;
use super::{Camera, LidarPattern, RadarField, RadarPattern, SensorRig};

/// A LiDAR model by its name.
pub struct LidarPreset {
    /// Name that its maker uses.
    pub name: &'static str,
    /// Builds the pattern, mounted on the roof of the default vehicle, level.
    pub build: fn() -> LidarPattern,
}

/// Patterns from data sheets and from measurements (`reference/rigs.json`).
pub const LIDARS: [LidarPreset; 5] = [
    LidarPreset {
        name: "HDL-32E (nuScenes)",
        build: || SensorRig::default().lidars[0].clone(),
    },
    LidarPreset {
        name: "VLP-16",
        build: || level("VLP-16", even(-15.0, 15.0, 16), 1800, 100.0, 1.84),
    },
    LidarPreset {
        name: "HDL-64E (KITTI)",
        build: || {
            // Two blocks: 32 beams half a degree apart below, 32 a third of a degree apart above.
            let lower = (0..32).map(|i| -24.33 + 0.5 * f64::from(i));
            let upper = (0..32).map(|i| -8.33 + f64::from(i) / 3.0);
            let mut lidar = level("HDL-64E", lower.chain(upper).collect(), 2010, 120.0, 1.73);
            lidar.translation_m[0] = 0.81;
            lidar
        },
    },
    LidarPreset {
        name: "64 beams (Waymo-like)",
        build: || {
            let mut lidar = level("TOP-64", even(-17.54, 2.5, 64), 2650, 75.0, 2.18);
            lidar.translation_m[0] = 1.43;
            lidar
        },
    },
    LidarPreset {
        name: "128 beams, 45 degrees",
        build: || level("OS1-128", even(-22.5, 22.5, 128), 1024, 120.0, 1.84),
    },
];

/// A radar model by its name.
pub struct RadarPreset {
    /// Name that its maker or the field uses.
    pub name: &'static str,
    /// Builds the pattern, mounted at the front of the default vehicle, level.
    pub build: fn() -> RadarPattern,
}

/// Patterns from data sheets; the last two are of their kind, not of one maker.
pub const RADARS: [RadarPreset; 3] = [
    RadarPreset {
        name: "ARS 408-21 (nuScenes)",
        build: || {
            // Continental's data sheet: a near scan that is finer, a far one ahead; leaving at up to 400 km/h, approaching at up to 200.
            let near = |half_azimuth_deg, max_range_m, azimuth_step_deg| {
                field(half_azimuth_deg, max_range_m, 0.39, azimuth_step_deg)
            };
            RadarPattern {
                fields: vec![
                    near(45.0, 70.0, 3.2),
                    near(60.0, 20.0, 4.5),
                    field(4.0, 250.0, 1.79, 1.6),
                    field(9.0, 150.0, 1.79, 1.6),
                ],
                half_elevation_deg: 9.0,
                speed_step_mps: 0.12,
                speeds_mps: [-55.6, 111.1],
                car_range_m: 200.0,
                most_returns: 125,
                scan_hz: 13.0,
                ..radar()
            }
        },
    },
    RadarPreset {
        name: "Corner radar, 77 GHz, 80 m",
        build: || RadarPattern {
            fields: vec![field(75.0, 80.0, 0.3, 4.0)],
            half_elevation_deg: 8.0,
            car_range_m: 75.0,
            most_returns: 128,
            scan_hz: 20.0,
            ..radar()
        },
    },
    RadarPreset {
        name: "Imaging radar, 77 GHz, with heights",
        build: || RadarPattern {
            fields: vec![field(60.0, 300.0, 0.4, 1.0)],
            half_elevation_deg: 12.0,
            elevation_step_deg: 2.0,
            car_range_m: 280.0,
            most_returns: 2000,
            scan_hz: 15.0,
            ..radar()
        },
    },
];

fn field(half_azimuth_deg: f64, max_range_m: f64, range_step_m: f64, azimuth_step_deg: f64) -> RadarField {
    RadarField {
        half_azimuth_deg,
        max_range_m,
        range_step_m,
        azimuth_step_deg,
    }
}

/// What radars of cars have in common.
fn radar() -> RadarPattern {
    RadarPattern {
        name: "RADAR_FRONT".into(),
        fields: Vec::new(),
        half_elevation_deg: 10.0,
        elevation_step_deg: 0.0,
        min_range_m: 0.2,
        speed_step_mps: 0.1,
        speeds_mps: [-60.0, 60.0],
        car_range_m: 100.0,
        most_returns: 128,
        scan_hz: 15.0,
        rotation_wxyz: [1.0, 0.0, 0.0, 0.0],
        translation_m: [3.4, 0.0, 0.5],
    }
}

fn even(low_deg: f64, high_deg: f64, beams: u32) -> Vec<f64> {
    let step = (high_deg - low_deg) / f64::from(beams - 1);
    (0..beams).map(|i| low_deg + step * f64::from(i)).collect()
}

fn level(
    name: &str,
    elevations_deg: Vec<f64>,
    columns: u32,
    max_range_m: f64,
    height_m: f64,
) -> LidarPattern {
    LidarPattern {
        name: name.into(),
        elevations_deg,
        columns,
        first_azimuth_deg: 0.0,
        sector_deg: 360.0,
        clockwise: false,
        spin_hz: 0.0,
        part: None,
        max_range_m,
        min_range_m: 1.0,
        own_body: true,
        beyond_grid: true,
        rotation_wxyz: [1.0, 0.0, 0.0, 0.0],
        translation_m: [0.94, 0.0, height_m],
    }
}

/// A rig by its name.
pub struct RigPreset {
    /// Name in the menu.
    pub name: &'static str,
    /// Builds the rig.
    pub build: fn() -> SensorRig,
}

/// Sensors of whole vehicles.
pub const RIGS: [RigPreset; 4] = [
    RigPreset {
        name: "nuScenes: six cameras, HDL-32E, five radars",
        build: SensorRig::default,
    },
    RigPreset {
        name: "Front camera, VLP-16",
        build: || rig("front", &[("CAM_FRONT", 0.0, 60.0)], 1),
    },
    RigPreset {
        name: "Surround: four 110 degree cameras, 128 beams",
        build: || {
            let cameras = [
                ("CAM_LEFT", 90.0, 110.0),
                ("CAM_FRONT", 0.0, 110.0),
                ("CAM_RIGHT", -90.0, 110.0),
                ("CAM_BACK", 180.0, 110.0),
            ];
            rig("surround", &cameras, 4)
        },
    },
    RigPreset {
        name: "Five cameras, 64 beams (Waymo-like)",
        build: || {
            let cameras = [
                ("CAM_SIDE_LEFT", 90.0, 50.0),
                ("CAM_FRONT_LEFT", 45.0, 50.0),
                ("CAM_FRONT", 0.0, 50.0),
                ("CAM_FRONT_RIGHT", -45.0, 50.0),
                ("CAM_SIDE_RIGHT", -90.0, 50.0),
            ];
            rig("five cameras", &cameras, 3)
        },
    },
];

/// A rig of cameras, given by name, yaw and field of view in degrees, at about the height of the windscreen, and of the
/// LiDAR `LIDARS[lidar]`.
fn rig(name: &str, cameras: &[(&str, f64, f64)], lidar: usize) -> SensorRig {
    let of = |&(name, yaw_deg, fov_deg): &(&str, f64, f64)| {
        let mut camera = Camera::new(name, fov_deg);
        camera.set_aim(Aim {
            yaw_deg,
            pitch_deg: 0.0,
            roll_deg: 0.0,
        });
        let (sin, cos) = yaw_deg.to_radians().sin_cos();
        camera.translation_m = [1.0 + 0.7 * cos, 0.5 * sin, 1.55];
        camera
    };
    SensorRig {
        name: name.into(),
        cameras: cameras.iter().map(of).collect(),
        lidars: vec![(LIDARS[lidar].build)()],
        radars: Vec::new(),
        ..SensorRig::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn presets_are_sound_and_beams_go_upward() {
        for preset in &RIGS {
            let rig = (preset.build)();
            assert_eq!(rig.problem(), None, "{}", preset.name);
            for c in &rig.cameras {
                let right = c.ego_from_camera().rotation * glam::DVec3::X;
                assert!(right.z.abs() < 0.05, "{}: {} stands askew", preset.name, c.name);
            }
        }
        for preset in &LIDARS {
            let lidar = (preset.build)();
            assert!(lidar.elevations_deg.is_sorted(), "{}", preset.name);
        }
        assert_eq!((LIDARS[2].build)().elevations_deg.len(), 64);
        for preset in &RADARS {
            assert_eq!((preset.build)().problem(), None, "{}", preset.name);
        }
        let model = (RADARS[0].build)();
        for radar in &SensorRig::default().radars {
            assert_eq!(
                (&radar.fields, radar.car_range_m),
                (&model.fields, model.car_range_m)
            );
        }
    }
}
