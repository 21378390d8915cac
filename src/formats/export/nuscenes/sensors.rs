//! Sweeps, scans and pictures, where the sensors are, and where the vehicle was.

use std::collections::BTreeMap;
use std::ops::Range;

use glam::DVec3;
use scene::{BoxId, LidarPoint, LidarSweep, RadarScan, Returns, Scene, SceneBox};

use super::{Writing, log_name, timestamp_us};
use crate::export::{ExportPicture, Products, nuscenes_lidar};
use crate::nuscenes::tables::{CalibratedSensor, EgoPose, Lidarseg, NuscenesSensor, SampleData};
use crate::nuscenes::{categories, wxyz};
use crate::sensor_names::{self, LIDAR};
use crate::{FormatError, jpeg, nuscenes_radar, physical};

/// Time between two sweeps, s.
const SWEEP_S: f64 = 0.1;
/// Longest clip with sweeps between its key frames, s: the sweeps of a minute are 400 MB.
const LONGEST_S: f64 = 60.0;
/// How far off the faces of boxes returns are kept, m.
const OFF_FACE_M: f64 = 1e-3;
/// Bits of a token's number that count the measurements of a sensor.
const COUNT_BITS: u64 = 32;

/// The sensors that are written: the cameras of the rig in its order, its first LiDAR after them, and its radars.
pub(super) struct Sensors {
    /// Channels in that order.
    channels: Vec<String>,
    /// Place of the LiDAR among them.
    lidar: Option<usize>,
    /// Place of the first radar.
    radars: usize,
    /// How many files each has.
    counts: Vec<u64>,
    log: String,
    has_sweeps: bool,
}

/// Share of each box that cameras see, of what they would see without anything in front, 0 to 1, all cameras together.
pub(super) type Visible = BTreeMap<BoxId, f64>;

/// Visibility of the boxes in a key frame, to the LiDAR and to the cameras.
#[derive(Default)]
pub(super) struct Sighted {
    /// Returns of the sweep, as it is written, that lie in each box; boxes without returns are left out.
    pub(super) returns: BTreeMap<BoxId, u32>,
    /// Returns of all radars that lie in each box, seen from above.
    pub(super) radar_returns: BTreeMap<BoxId, u32>,
    pub(super) visible: Visible,
}

/// A file of a sensor.
struct SensorFile<'a> {
    sensor: usize,
    sample: &'a str,
    now: &'a Scene,
    is_key_frame: bool,
    /// Columns and rows of a picture.
    size: [u32; 2],
    bytes: Vec<u8>,
}

impl Sensors {
    /// Their rows. The intrinsics of cameras follow with their first picture.
    pub(super) fn new(writing: &mut Writing<'_>) -> Self {
        let rig = &writing.scene.rig;
        let mut channels = sensor_names::cameras(rig);
        let lidar = (!rig.lidars.is_empty()).then_some(channels.len());
        channels.extend(lidar.map(|_| LIDAR.to_owned()));
        let radars = channels.len();
        channels.extend(sensor_names::radars(rig));
        let cameras = rig.cameras.iter().map(|c| ("camera", c.ego_from_camera()));
        let of_lidar = rig.lidars.iter().take(1).map(|l| ("lidar", l.ego_from_sensor()));
        let of_radars = rig.radars.iter().map(|r| ("radar", r.ego_from_sensor()));
        for (i, (modality, pose)) in cameras.chain(of_lidar).chain(of_radars).enumerate() {
            let camera = rig.cameras.get(i);
            writing.tables.sensor.push(NuscenesSensor {
                token: writing.tokens.token("sensor", i as u64),
                channel: channels[i].clone(),
                modality: modality.into(),
            });
            writing.tables.calibrated_sensor.push(CalibratedSensor {
                token: writing.tokens.token("calibrated_sensor", i as u64),
                sensor_token: writing.tokens.token("sensor", i as u64),
                translation: pose.translation_m.to_array(),
                rotation: wxyz(pose.rotation),
                camera_intrinsic: camera.map_or_else(Vec::new, intrinsics),
            });
        }
        Self {
            counts: vec![0; channels.len()],
            channels,
            lidar,
            radars,
            log: log_name(writing.scene),
            has_sweeps: writing.scene.clip().length_s <= LONGEST_S,
        }
    }

    /// Sweep and pictures of a key frame. Returns the visibility of each box in them.
    pub(super) fn key_frame(
        &mut self,
        writing: &mut Writing<'_>,
        products: &mut dyn Products,
        sample: &str,
        now: &Scene,
    ) -> Result<Sighted, FormatError> {
        let mut seen = Sighted::default();
        if let Some(lidar) = self.lidar {
            let sweep = sweep(now, products)?;
            let pose = now.frame().world_from_ego;
            let in_world = |p: &LidarPoint| pose.apply(DVec3::from_array(p.position_in_ego.map(f64::from)));
            let returns = Returns::new(sweep.points.iter().map(in_world));
            seen.returns = returns.by_box(now.frame().boxes.values());
            let token = self.add_sweep(writing, lidar, &sweep, sample, now, true);
            let labels = sweep
                .points
                .iter()
                .map(|p| categories::of_points(p.class))
                .collect();
            let folder = format!("lidarseg/{}", super::VERSION);
            let filename = writing.file(&folder, &format!("{token}_lidarseg.bin"), labels);
            writing.tables.lidarseg.push(Lidarseg {
                sample_data_token: token.clone(),
                token,
                filename,
            });
        }
        let scans = self.add_scans(writing, products, sample, now, true)?;
        seen.radar_returns = within_boxes(&scans, now);
        if now.rig.cameras.is_empty() {
            return Ok(seen);
        }
        // Pixels that show a box, and pixels that would show it without anything in front.
        let mut pixels: BTreeMap<BoxId, [f64; 2]> = BTreeMap::new();
        let mut next = 0;
        products.truth(&mut |picture, truth| {
            // In the order of the rig, of which a name may stand for several.
            let same = |i: &usize| now.rig.cameras[*i].name == picture.camera;
            let Some(camera) = (next..now.rig.cameras.len()).find(same) else {
                return Ok(());
            };
            next = camera + 1;
            for one in &truth.boxes {
                let [shown, whole] = pixels.entry(one.of.id).or_default();
                *shown += one.visibility * f64::from(one.whole_px);
                *whole += f64::from(one.whole_px);
            }
            self.add_picture(writing, &picture, camera, sample, now)
        })?;
        let shown = pixels.into_iter().filter(|(_, [_, whole])| *whole > 0.0);
        seen.visible = shown.map(|(id, [shown, whole])| (id, shown / whole)).collect();
        Ok(seen)
    }

    /// Sweeps and scans between two key frames, without these.
    pub(super) fn between(
        &mut self,
        writing: &mut Writing<'_>,
        products: &mut dyn Products,
        sample: &str,
        times_s: Range<f64>,
    ) -> Result<(), FormatError> {
        let has_ranging = self.lidar.is_some() || self.radars < self.channels.len();
        if !(has_ranging && self.has_sweeps) {
            return Ok(());
        }
        let steps = ((times_s.end - times_s.start) / SWEEP_S).round() as usize;
        for step in 1..steps {
            let time_s = times_s.start + SWEEP_S * step as f64;
            products.show(time_s)?;
            let now = writing.scene.at(time_s);
            if let Some(lidar) = self.lidar {
                let sweep = sweep(&now, products)?;
                self.add_sweep(writing, lidar, &sweep, sample, &now, false);
            }
            self.add_scans(writing, products, sample, &now, false)?;
        }
        Ok(())
    }

    /// Writes the scans of all radars, and returns them.
    fn add_scans(
        &mut self,
        writing: &mut Writing<'_>,
        products: &mut dyn Products,
        sample: &str,
        now: &Scene,
        is_key_frame: bool,
    ) -> Result<Vec<RadarScan>, FormatError> {
        if now.rig.radars.is_empty() {
            return Ok(Vec::new());
        }
        let scans = products.radars()?;
        for (i, (scan, radar)) in scans.iter().zip(&now.rig.radars).enumerate() {
            let measured = SensorFile {
                sensor: self.radars + i,
                sample,
                now,
                is_key_frame,
                size: [0; 2],
                bytes: nuscenes_radar::to_bytes(scan, radar),
            };
            self.add(writing, measured);
        }
        Ok(scans)
    }

    fn add_sweep(
        &mut self,
        writing: &mut Writing<'_>,
        lidar: usize,
        sweep: &LidarSweep,
        sample: &str,
        now: &Scene,
        is_key_frame: bool,
    ) -> String {
        let measured = SensorFile {
            sensor: lidar,
            sample,
            now,
            is_key_frame,
            size: [0; 2],
            bytes: nuscenes_lidar::to_bytes(sweep, &now.rig.lidars[0]),
        };
        self.add(writing, measured)
    }

    fn add_picture(
        &mut self,
        writing: &mut Writing<'_>,
        picture: &ExportPicture,
        camera: usize,
        sample: &str,
        now: &Scene,
    ) -> Result<(), FormatError> {
        let bytes = jpeg::rgba(picture.width, picture.height, &picture.rgba).map_err(FormatError::new)?;
        let size = [picture.width as u32, picture.height as u32];
        let resized = now.rig.cameras[camera].resized(size[0], size[1]);
        writing.tables.calibrated_sensor[camera].camera_intrinsic = intrinsics(&resized);
        let measured = SensorFile {
            sensor: camera,
            sample,
            now,
            is_key_frame: true,
            size,
            bytes,
        };
        self.add(writing, measured);
        Ok(())
    }

    /// The rows of a file, and the file. Returns the token.
    fn add(&mut self, writing: &mut Writing<'_>, measured: SensorFile<'_>) -> String {
        let (sensor, count) = (measured.sensor, self.counts[measured.sensor]);
        self.counts[sensor] += 1;
        let token = writing
            .tokens
            .token("sample_data", (sensor as u64) << COUNT_BITS | count);
        let timestamp = timestamp_us(measured.now.time_s());
        let channel = &self.channels[sensor];
        let (kind, format) = match sensor {
            i if Some(i) == self.lidar => ("pcd.bin", "pcd"),
            i if i >= self.radars => ("pcd", "pcd"),
            _ => ("jpg", "jpg"),
        };
        let folder = if measured.is_key_frame {
            "samples"
        } else {
            "sweeps"
        };
        let name = format!("{}__{channel}__{timestamp}.{kind}", self.log);
        let filename = writing.file(&format!("{folder}/{channel}"), &name, measured.bytes);
        let (rotation, translation) = writing.global_pose(&measured.now.frame().world_from_ego);
        writing.tables.ego_pose.push(EgoPose {
            token: token.clone(),
            timestamp,
            rotation,
            translation,
        });
        writing.tables.sample_data.push(SampleData {
            token: token.clone(),
            sample_token: measured.sample.to_owned(),
            ego_pose_token: token.clone(),
            calibrated_sensor_token: writing.tokens.token("calibrated_sensor", sensor as u64),
            timestamp,
            fileformat: format.into(),
            is_key_frame: measured.is_key_frame,
            height: measured.size[1],
            width: measured.size[0],
            filename,
            prev: String::new(),
            next: String::new(),
        });
        token
    }

    /// Chains the files of each sensor.
    pub(super) fn link(&self, writing: &mut Writing<'_>) {
        let mut last: Vec<Option<usize>> = vec![None; self.channels.len()];
        let rows = &mut writing.tables.sample_data;
        for i in 0..rows.len() {
            let sensors = &writing.tables.calibrated_sensor;
            let sensor = sensors
                .iter()
                .position(|s| s.token == rows[i].calibrated_sensor_token);
            let Some(last) = sensor.map(|sensor| &mut last[sensor]) else {
                continue;
            };
            if let Some(before) = last.replace(i) {
                rows[before].next = rows[i].token.clone();
                rows[i].prev = rows[before].token.clone();
            }
        }
    }
}

/// Returns of radars that lie in each box; those of radars that measure no heights as seen from above.
fn within_boxes(scans: &[RadarScan], now: &Scene) -> BTreeMap<BoxId, u32> {
    let pose = now.frame().world_from_ego;
    let returns: Vec<(DVec3, bool)> = scans
        .iter()
        .flat_map(|scan| &scan.returns)
        .map(|r| {
            let at = pose.apply(DVec3::from_array(r.position_m.map(f64::from)));
            (at, r.elevation_rad.is_some())
        })
        .collect();
    let within = |b: &SceneBox| {
        let level = |(at, has_height): &(DVec3, bool)| match has_height {
            true => *at,
            false => at.truncate().extend(b.center_m.z),
        };
        returns.iter().filter(|r| b.contains(level(r), 0.0)).count() as u32
    };
    let counts = now.frame().boxes.values().map(|b| (b.id, within(b)));
    counts.filter(|(_, count)| *count > 0).collect()
}

/// The sweep of the moment that is shown, on the physical ground. No return is exactly on a face of a box, so readers
/// that round differently count the same returns within it.
fn sweep(now: &Scene, products: &mut dyn Products) -> Result<LidarSweep, FormatError> {
    let mut sweep = products.sweep()?;
    let origin_in_ego = now.rig.lidars[0].ego_from_sensor().translation_m;
    physical::to_physical_ground(&mut sweep, origin_in_ego, now.frame());
    off_faces(&mut sweep, now);
    Ok(sweep)
}

/// Moves returns on a face of a box a little off it: returns of the ground out of the box, which stands on the road,
/// and all others into it.
fn off_faces(sweep: &mut LidarSweep, now: &Scene) {
    let pose = now.frame().world_from_ego;
    let boxes: Vec<&SceneBox> = now.frame().boxes.values().collect();
    let reach_m = |b: &SceneBox| b.size_m.length() / 2.0 + OFF_FACE_M;
    let reach: Vec<f64> = boxes.iter().map(|b| reach_m(b)).collect();
    for point in &mut sweep.points {
        let before = pose.apply(DVec3::from_array(point.position_in_ego.map(f64::from)));
        let mut at = before;
        for (b, reach_m) in boxes.iter().zip(&reach) {
            if at.distance_squared(b.center_m) > reach_m * reach_m {
                continue;
            }
            let (mut local, half) = (b.to_local(at), b.size_m / 2.0);
            let over = local.abs() - half;
            let face = (0..3).find(|axis| over[*axis].abs() < OFF_FACE_M / 2.0);
            if let Some(axis) = face
                && over.max_element() < OFF_FACE_M / 2.0
            {
                let off_m = if point.class.is_ground() {
                    OFF_FACE_M
                } else {
                    -OFF_FACE_M
                };
                local[axis] = (half[axis] + off_m).copysign(local[axis]);
                at = b.to_ego(local);
            }
        }
        if at != before {
            point.position_in_ego = pose.inverse().apply(at).as_vec3().to_array();
        }
    }
}

fn intrinsics(camera: &scene::Camera) -> Vec<[f64; 3]> {
    let ([fx, fy], [cx, cy]) = (camera.focal_px, camera.center_px);
    vec![[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]]
}
