//! Scenes that move, and sensors that see them, for the tests of formats of clips: rays against boxes and flat ground,
//! pictures of one colour.

use std::sync::Arc;

use glam::{DVec2, DVec3};
use scene::clip::ObjectVoxels;
use scene::truth::SeenBox;
use scene::{
    BevLayer, BoxId, CameraMaps, CameraTruth, Class, Key, LidarPoint, LidarSweep, Motion, Polyline,
    PolylineKind, Pose, Scene, SceneBox, Track,
};

use crate::FormatError;
use crate::export::{BoxVisibility, ExportPicture, Products};
use crate::recipe::Recipe;
use crate::table_tests::random_scene;

/// Where labels have the ground under the vehicle, m.
const LABEL_GROUND_M: f64 = -0.6;

/// A random scene of 2 s: its even boxes move, one of them comes later and one leaves; the ego vehicle turns.
pub(crate) fn clip_scene(seed: u64) -> Scene {
    let mut scene = random_scene(seed);
    let moving: Vec<SceneBox> = (scene.frame().boxes.values().filter(|b| b.id.0 % 2 == 0))
        .copied()
        .collect();
    scene.change_canvas(|canvas| {
        canvas.boxes.retain(|id, _| id.0 % 2 == 1);
        let line = |kind, points: [[f64; 2]; 2]| Polyline {
            kind,
            points_m: points.map(DVec2::from_array).to_vec(),
        };
        canvas.layout.polylines = Arc::new(vec![
            line(PolylineKind::LaneDivider, [[-30.0, 1.5], [30.0, 1.5]]),
            line(PolylineKind::RoadDivider, [[-30.0, -2.0], [30.0, -2.0]]),
        ]);
        (0..200).for_each(|x| canvas.layout.set(BevLayer::DrivableArea, x, 100, true));
    });
    scene.change_clip(|clip| {
        clip.length_s = 2.0;
        clip.ego = Some(Motion::Keys(vec![
            key(0.0, [0.0, 0.0], 0.0),
            key(1.0, [6.0, 0.5], 10.0),
            key(2.0, [11.0, 2.0], 25.0),
        ]));
        for b in moving {
            let there_s = match b.id.0 {
                2 => [Some(0.7), None],
                4 => [None, Some(1.2)],
                _ => [None; 2],
            };
            clip.tracks.insert(b.id, track(b, there_s));
        }
    });
    scene
}

fn key(time_s: f64, at: [f64; 2], yaw_deg: f64) -> Key {
    Key {
        time_s,
        at_m: DVec2::from_array(at),
        yaw_deg,
    }
}

fn track(made: SceneBox, there_s: [Option<f64>; 2]) -> Track {
    let from = made.center_m.truncate();
    let keys = [0.0, 0.6, 1.9].map(|time_s| {
        let at = from + made.velocity_mps * time_s + DVec2::new(0.0, time_s * time_s);
        key(time_s, at.to_array(), made.yaw_rad.to_degrees() + 8.0 * time_s)
    });
    Track {
        made,
        motion: Motion::Keys(keys.to_vec()),
        there_s,
        voxels: ObjectVoxels::empty(),
        settled: true,
        own_shape: false,
    }
}

/// A return that the sensor of the rig got, ego frame.
pub(crate) fn point(position_in_ego: [f32; 3], class: Class) -> LidarPoint {
    LidarPoint {
        position_in_ego,
        range_m: 10.0,
        ring: 3,
        azimuth: 7,
        class,
        intensity: 21.5,
        drop_probability: 0.0,
        time_s: 0.0,
        velocity_mps: [0.0; 2],
    }
}

/// Sensors of a scene at the moment that was asked for.
pub(crate) struct Plain {
    scene: Scene,
    recipe: Recipe,
    /// Every so many columns of the LiDAR are cast.
    pub(crate) every: u32,
    /// Pixels of pictures.
    pub(crate) size: [usize; 2],
}

impl Plain {
    pub(crate) fn of(scene: &Scene) -> Self {
        Self {
            scene: scene.clone(),
            recipe: Recipe::of(scene),
            every: 18,
            size: [32, 18],
        }
    }

    /// Boxes of the moment in the ego frame.
    fn boxes(&self) -> Vec<SceneBox> {
        let frame = self.scene.frame();
        let to_ego = frame.world_from_ego.inverse();
        frame.boxes.values().map(|b| b.in_frame(&to_ego)).collect()
    }

    /// How far along a ray something is met, and what.
    fn cast(&self, boxes: &[SceneBox], origin: DVec3, dir: DVec3) -> Option<(f64, Class, Option<BoxId>)> {
        let ground =
            (dir.z < 0.0).then(|| ((LABEL_GROUND_M - origin.z) / dir.z, Class::DriveableSurface, None));
        let met = boxes.iter().filter_map(|b| {
            let (from, to) = (b.to_local(origin), b.to_local(origin + dir));
            let (way, half) = (to - from, b.size_m / 2.0);
            let (a, b_) = ((-half - from) / way, (half - from) / way);
            let (near, far) = (a.min(b_).max_element(), a.max(b_).min_element());
            (near > 0.0 && near <= far).then_some((near, b.class, Some(b.id)))
        });
        met.chain(ground).min_by(|a, b| a.0.total_cmp(&b.0))
    }
}

impl Products for Plain {
    fn observed(&mut self) -> Result<crate::export::ObservationMasks, FormatError> {
        Err(FormatError::new("nobody observes voxels here"))
    }

    fn show(&mut self, time_s: f64) -> Result<(), FormatError> {
        self.scene.show(time_s);
        Ok(())
    }

    fn gaussians(&mut self) -> Result<scene::GaussianScene, FormatError> {
        Err(FormatError::new("no Gaussians"))
    }

    fn seen(&mut self) -> Result<BoxVisibility, FormatError> {
        let ids = self.scene.frame().boxes.keys();
        Ok(BoxVisibility {
            lidar_returns: Some(ids.map(|id| (*id, id.0 * 3)).collect()),
            camera_pixels: None,
        })
    }

    fn sweep(&mut self) -> Result<LidarSweep, FormatError> {
        let lidar = self.scene.rig.lidars.first();
        let lidar = lidar.ok_or_else(|| FormatError::new("no LiDAR"))?;
        let (pose, boxes) = (lidar.ego_from_sensor(), self.boxes());
        let mut points = Vec::new();
        for (ring, elevation_deg) in lidar.elevations_deg.iter().enumerate() {
            let (up, along) = elevation_deg.to_radians().sin_cos();
            for column in (0..lidar.columns).step_by(self.every as usize) {
                let (y, x) = lidar.azimuth_rad(column).sin_cos();
                let dir = pose.rotation * DVec3::new(along * x, along * y, up);
                let met = self.cast(&boxes, pose.translation_m, dir);
                let Some((range_m, class, _)) = met.filter(|m| m.0 <= lidar.max_range_m) else {
                    continue;
                };
                let at = pose.translation_m + dir * range_m;
                points.push(LidarPoint {
                    range_m: range_m as f32,
                    ring: ring as u16,
                    azimuth: column as u16,
                    ..point(at.as_vec3().to_array(), class)
                });
            }
        }
        Ok(LidarSweep {
            rays: points.len(),
            points,
            physical: false,
            provenance: Vec::new(),
        })
    }

    fn sweep_edits(&mut self, _: usize) -> Result<scene::SweepEdits, FormatError> {
        Ok(scene::SweepEdits::default())
    }

    fn radars(&mut self) -> Result<Vec<scene::RadarScan>, FormatError> {
        let scan = |radar: &scene::RadarPattern| scene::RadarScan {
            radar: radar.name.clone(),
            returns: vec![crate::table_tests::radar_return(radar, 12.0, -2.0)],
        };
        Ok(self.scene.rig.radars.iter().map(scan).collect())
    }

    fn camera_maps(
        &mut self,
        _take: &mut dyn FnMut(CameraMaps) -> Result<(), FormatError>,
    ) -> Result<(), FormatError> {
        Err(FormatError::new("no maps"))
    }

    fn pictures(
        &mut self,
        take: &mut dyn FnMut(ExportPicture) -> Result<(), FormatError>,
    ) -> Result<(), FormatError> {
        let [width, height] = self.size;
        for (i, camera) in self.scene.rig.cameras.iter().enumerate() {
            take(ExportPicture {
                camera: camera.name.clone(),
                width,
                height,
                rgba: [40 * i as u8, 90, 160, 255].repeat(width * height),
            })?;
        }
        Ok(())
    }

    /// The pictures; the first two cameras see a quarter of each box for each of the last digits of its id in base 5.
    fn truth(
        &mut self,
        take: &mut dyn FnMut(ExportPicture, CameraTruth) -> Result<(), FormatError>,
    ) -> Result<(), FormatError> {
        let (cameras, boxes) = (self.scene.rig.cameras.clone(), self.boxes());
        let [width, height] = self.size;
        let mut next = 0;
        self.pictures(&mut |picture| {
            let camera = cameras[next].resized(width as u32, height as u32);
            next += 1;
            let seen = |b: &SceneBox| SeenBox {
                of: *b,
                center_in_camera_m: DVec3::Z,
                corners_px: [None; 8],
                visible_px: 0,
                whole_px: 20 * next as u32,
                visibility: f64::from(b.id.0 % 5) / 4.0,
                in_picture: 1.0,
                visible_bounds_px: None,
                whole_bounds_px: [0.0; 4],
            };
            let boxes = if next > 2 {
                Vec::new()
            } else {
                boxes.iter().map(seen).collect()
            };
            let truth = CameraTruth {
                camera,
                width,
                height,
                pixels: Vec::new(),
                flow_s: None,
                boxes,
            };
            take(picture, truth)
        })
    }

    fn recipe(&self) -> &Recipe {
        &self.recipe
    }

    fn world_from_ego(&self) -> Pose {
        self.scene.frame().world_from_ego
    }

    fn view(&mut self) -> Result<ExportPicture, FormatError> {
        Err(FormatError::new("no view"))
    }
}
