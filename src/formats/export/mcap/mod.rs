//! A clip as MCAP with Foxglove's schemas (protobuf), for Foxglove, Rerun and others.
//!
//! Every moment of the clip's rate has, with its time in the clip as log time: `/tf` (`map` to `base_link`, the ego frame, and
//! that to each sensor), `/pose`, `/markers/annotations` (boxes), `/occupancy` (voxels around the vehicle), `/lidar_top`, `/NAME/points` for each radar, and
//! for each camera `/NAME/camera_info` and `/NAME/image_rect_compressed` (`image_compressed` where its lens is no pinhole).
//! `/drivable_area` and `/semantic_map` are there once; the recipe is metadata. Chunks are compressed by lz4.

mod grids;
mod messages;

use std::collections::BTreeMap;
use std::io::Cursor;

use glam::{DQuat, DVec3};
use mcap::records::MessageHeader;
use mcap::{Compression, WriteOptions, Writer};
use prost::Message;
use scene::{Camera, Lens, LidarPattern, LidarSweep, Pose, RadarPattern, RadarScan, Scene, SceneBox};

use super::{ExportPicture, ExportSpan, Exporter, OutFile, Product, Products};
use crate::recipe::{self, Recipe};
use crate::sensor_names::{self, LIDAR};
use crate::{FormatError, Holds, jpeg, moments, physical};
use messages::{
    CameraCalibration, Color, CompressedImage, CubePrimitive, FrameTransform, FrameTransforms, KeyValuePair,
    Numeric, PointCloud, PoseInFrame, SceneEntity, SceneEntityDeletion, SceneUpdate, Time, fields,
    nanoseconds,
};

/// See the module.
pub const EXPORTER: Exporter = Exporter {
    id: "mcap",
    title: "MCAP with Foxglove schemas: frames, boxes, LiDAR, radars, cameras, voxels, map",
    file_name: Some("scene.mcap"),
    holds: &[Holds::Boxes, Holds::Points, Holds::Pictures, Holds::Occupancy],
    lost: "",
    span: ExportSpan::Clip,
    needs: &[Product::Sweep, Product::Radar, Product::Pictures],
    write: |scene, products| Ok(vec![OutFile::new("scene.mcap", to_bytes(scene, products)?)]),
};

/// Descriptors of all messages, made by `make_descriptors.py` from Foxglove's package `foxglove-schemas-protobuf` (MIT).
const DESCRIPTORS: &[u8] = include_bytes!("foxglove.desc");
/// Frame of the scene.
const MAP: &str = "map";
/// The ego frame.
const BASE: &str = "base_link";

/// The file.
fn to_bytes(scene: &Scene, products: &mut dyn Products) -> Result<Vec<u8>, FormatError> {
    if let Some(problem) = scene.rig.problem() {
        return Err(FormatError::new(problem));
    }
    let mut log = Log::new(products.recipe())?;
    let cameras = sensor_names::cameras(&scene.rig);
    let radars = sensor_names::radars(&scene.rig);
    let times_s = moments::times_s(scene, scene.clip().rate_hz);
    for (i, &time_s) in times_s.iter().enumerate() {
        products.show(time_s)?;
        let now = scene.at(time_s);
        if let Some(problem) = now.frame().boxes.values().find_map(SceneBox::problem) {
            return Err(FormatError::new(problem));
        }
        log.time_s = time_s;
        log.put(
            "/tf",
            "FrameTransforms",
            &transforms(&now, (&cameras, &radars), log.stamp()),
        )?;
        let pose = PoseInFrame {
            timestamp: log.stamp(),
            frame_id: MAP.into(),
            pose: Some(now.frame().world_from_ego.into()),
        };
        log.put("/pose", "PoseInFrame", &pose)?;
        log.put("/markers/annotations", "SceneUpdate", &boxes(&now, log.stamp()))?;
        if i == 0 {
            let layout = &now.canvas().layout;
            log.put(
                "/drivable_area",
                "Grid",
                &grids::drivable_area(layout, log.stamp()),
            )?;
            log.put("/semantic_map", "Grid", &grids::semantic_map(layout, log.stamp()))?;
        }
        log.put("/occupancy", "VoxelGrid", &grids::occupancy(&now, log.stamp()))?;
        if let Some(lidar) = now.rig.lidars.first() {
            let mut sweep = products.sweep()?;
            let origin_in_ego = lidar.ego_from_sensor().translation_m;
            physical::to_physical_ground(&mut sweep, origin_in_ego, now.frame());
            log.put("/lidar_top", "PointCloud", &points(&sweep, lidar, log.stamp()))?;
        }
        if !radars.is_empty() {
            let scans = products.radars()?;
            for ((scan, radar), name) in scans.iter().zip(&now.rig.radars).zip(&radars) {
                let message = radar_points(scan, radar, name, log.stamp());
                log.put(
                    &format!("/{}/points", name.to_lowercase()),
                    "PointCloud",
                    &message,
                )?;
            }
        }
        if !cameras.is_empty() {
            pictures(&mut log, products, &now, &cameras)?;
        }
    }
    log.finish()
}

/// The file as written so far.
struct Log {
    writer: Writer<Cursor<Vec<u8>>>,
    schemas: BTreeMap<&'static str, u16>,
    /// Channels by topic, and how many messages each has.
    channels: BTreeMap<String, (u16, u32)>,
    /// The moment of the messages that are put.
    time_s: f64,
}

impl Log {
    fn new(recipe: &Recipe) -> Result<Self, FormatError> {
        let options = WriteOptions::new()
            .compression(Some(Compression::Lz4))
            .library(concat!("sceneloom ", env!("CARGO_PKG_VERSION")));
        let mut writer = options
            .create(Cursor::new(Vec::new()))
            .map_err(FormatError::new)?;
        let told = serde_json::to_string(recipe).map_err(FormatError::new)?;
        let about = mcap::records::Metadata {
            name: recipe::NAME.into(),
            metadata: BTreeMap::from([(recipe::NAME.into(), told)]),
        };
        writer.write_metadata(&about).map_err(FormatError::new)?;
        Ok(Self {
            writer,
            schemas: BTreeMap::new(),
            channels: BTreeMap::new(),
            time_s: 0.0,
        })
    }

    fn stamp(&self) -> Option<Time> {
        Some(Time::of_s(self.time_s))
    }

    /// Puts a message of the schema `foxglove.SCHEMA` on a topic.
    fn put(&mut self, topic: &str, schema: &'static str, message: &impl Message) -> Result<(), FormatError> {
        let (channel_id, sequence) = match self.channels.get(topic) {
            Some(known) => *known,
            None => (self.channel(topic, schema)?, 0),
        };
        self.channels.insert(topic.to_owned(), (channel_id, sequence + 1));
        let time_ns = nanoseconds(self.time_s);
        let header = MessageHeader {
            channel_id,
            sequence,
            log_time: time_ns,
            publish_time: time_ns,
        };
        let written = self
            .writer
            .write_to_known_channel(&header, &message.encode_to_vec());
        written.map_err(FormatError::new)
    }

    fn channel(&mut self, topic: &str, schema: &'static str) -> Result<u16, FormatError> {
        let id = match self.schemas.get(schema) {
            Some(id) => *id,
            None => {
                let name = format!("foxglove.{schema}");
                let id = self.writer.add_schema(&name, "protobuf", DESCRIPTORS);
                let id = id.map_err(FormatError::new)?;
                self.schemas.insert(schema, id);
                id
            }
        };
        let channel = self.writer.add_channel(id, topic, "protobuf", &BTreeMap::new());
        channel.map_err(FormatError::new)
    }

    fn finish(mut self) -> Result<Vec<u8>, FormatError> {
        self.writer.finish().map_err(FormatError::new)?;
        Ok(self.writer.into_inner().into_inner())
    }
}

/// Where the vehicle is on the map, and where each sensor is on the vehicle.
fn transforms(
    now: &Scene,
    (cameras, radars): (&[String], &[String]),
    timestamp: Option<Time>,
) -> FrameTransforms {
    let one = |parent: &str, child: &str, pose: Pose| FrameTransform {
        timestamp,
        parent_frame_id: parent.into(),
        child_frame_id: child.into(),
        translation: Some(pose.translation_m.into()),
        rotation: Some(pose.rotation.into()),
    };
    let mut transforms = vec![one(MAP, BASE, now.frame().world_from_ego)];
    let of_cameras = now.rig.cameras.iter().zip(cameras);
    transforms.extend(of_cameras.map(|(camera, name)| one(BASE, name, camera.ego_from_camera())));
    let lidar = now.rig.lidars.first();
    transforms.extend(lidar.map(|lidar| one(BASE, LIDAR, lidar.ego_from_sensor())));
    let of_radars = now.rig.radars.iter().zip(radars);
    transforms.extend(of_radars.map(|(radar, name)| one(BASE, name, radar.ego_from_sensor())));
    FrameTransforms { transforms }
}

/// The boxes of a moment, which replace those of the moment before: an entity each, x along the heading.
fn boxes(now: &Scene, timestamp: Option<Time>) -> SceneUpdate {
    let entity = |b: &SceneBox| {
        let [r, g, blue] = b.class.color().map(|c| f64::from(c) / 255.0);
        let pose = Pose {
            rotation: DQuat::from_rotation_z(b.yaw_rad),
            translation_m: b.center_m,
        };
        let [vx, vy] = b.velocity_mps.to_array();
        let metadata = [
            ("class", b.class.name().to_owned()),
            ("name", b.label.name.as_str().to_owned()),
            ("velocity_mps", format!("{vx} {vy}")),
        ];
        SceneEntity {
            timestamp,
            frame_id: MAP.into(),
            id: format!("box {}", b.id.0),
            frame_locked: true,
            metadata: metadata
                .map(|(key, value)| KeyValuePair {
                    key: key.into(),
                    value,
                })
                .to_vec(),
            cubes: vec![CubePrimitive {
                pose: Some(pose.into()),
                size: Some(b.size_m.into()),
                color: Some(Color {
                    r,
                    g,
                    b: blue,
                    a: 0.5,
                }),
            }],
        }
    };
    let all = SceneEntityDeletion {
        timestamp,
        r#type: 1,
        id: String::new(),
    };
    SceneUpdate {
        deletions: vec![all],
        entities: now.frame().boxes.values().map(entity).collect(),
    }
}

/// Returns in the frame of the radar; `speed` is measured, `speed_over_ground` without the own motion.
fn radar_points(scan: &RadarScan, radar: &RadarPattern, name: &str, timestamp: Option<Time>) -> PointCloud {
    let radar_from_ego = radar.ego_from_sensor().inverse();
    let mut data = Vec::with_capacity(scan.returns.len() * 29);
    for one in &scan.returns {
        let at = radar_from_ego.apply(DVec3::from_array(one.position_m.map(f64::from)));
        let [x, y, z] = at.as_vec3().to_array();
        let told = [one.speed_mps, one.speed_over_ground_mps, one.rcs_dbsm, one.snr_db];
        data.extend([x, y, z].into_iter().chain(told).flat_map(f32::to_le_bytes));
        data.push(one.class.id());
    }
    let mut numbers = ["x", "y", "z", "speed", "speed_over_ground", "rcs", "snr"]
        .map(|name| (name, Numeric::Float32))
        .to_vec();
    numbers.push(("class", Numeric::Uint8));
    PointCloud {
        timestamp,
        frame_id: name.to_owned(),
        pose: Some(Pose::IDENTITY.into()),
        point_stride: 29,
        fields: fields(&numbers),
        data,
    }
}

/// Points in the frame of the LiDAR.
fn points(sweep: &LidarSweep, lidar: &LidarPattern, timestamp: Option<Time>) -> PointCloud {
    let lidar_from_ego = lidar.ego_from_sensor().inverse();
    let mut data = Vec::with_capacity(sweep.points.len() * 19);
    for p in &sweep.points {
        let at = lidar_from_ego.apply(DVec3::from_array(p.position_in_ego.map(f64::from)));
        let [x, y, z] = at.as_vec3().to_array();
        data.extend([x, y, z, p.intensity].into_iter().flat_map(f32::to_le_bytes));
        data.extend(p.ring.to_le_bytes());
        data.push(p.class.id());
    }
    PointCloud {
        timestamp,
        frame_id: LIDAR.into(),
        pose: Some(Pose::IDENTITY.into()),
        point_stride: 19,
        fields: fields(&[
            ("x", Numeric::Float32),
            ("y", Numeric::Float32),
            ("z", Numeric::Float32),
            ("intensity", Numeric::Float32),
            ("ring", Numeric::Uint16),
            ("class", Numeric::Uint8),
        ]),
        data,
    }
}

fn pictures(
    log: &mut Log,
    products: &mut dyn Products,
    now: &Scene,
    names: &[String],
) -> Result<(), FormatError> {
    let cameras = &now.rig.cameras;
    let mut next = 0;
    products.pictures(&mut |picture| {
        // In the order of the rig, of which a name may stand for several.
        let Some(i) = (next..cameras.len()).find(|i| cameras[*i].name == picture.camera) else {
            return Ok(());
        };
        next = i + 1;
        let topic = format!("/{}", names[i].to_lowercase());
        let info = calibration(&cameras[i], &names[i], &picture, log.stamp());
        log.put(&format!("{topic}/camera_info"), "CameraCalibration", &info)?;
        let data = jpeg::rgba(picture.width, picture.height, &picture.rgba).map_err(FormatError::new)?;
        let image = CompressedImage {
            timestamp: log.stamp(),
            data,
            format: "jpeg".into(),
            frame_id: names[i].clone(),
        };
        let rectified = if cameras[i].lens == Lens::Pinhole {
            "_rect"
        } else {
            ""
        };
        let topic = format!("{topic}/image{rectified}_compressed");
        log.put(&topic, "CompressedImage", &image)
    })
}

/// At the size of the picture. Distortion as OpenCV lists it; f-theta, which the schema does not know, by its name.
fn calibration(
    camera: &Camera,
    name: &str,
    picture: &ExportPicture,
    timestamp: Option<Time>,
) -> CameraCalibration {
    let camera = camera.resized(picture.width as u32, picture.height as u32);
    let ([fx, fy], [cx, cy]) = (camera.focal_px, camera.center_px);
    let (model, distortion) = match camera.lens {
        Lens::Pinhole => ("", Vec::new()),
        Lens::Distorted { k, p } => match k[3..] == [0.0; 3] {
            true => ("plumb_bob", vec![k[0], k[1], p[0], p[1], k[2]]),
            false => {
                let all = vec![k[0], k[1], p[0], p[1], k[2], k[3], k[4], k[5]];
                ("rational_polynomial", all)
            }
        },
        Lens::Fisheye { k, .. } => ("kannala_brandt", k.to_vec()),
        Lens::FTheta { c, .. } => ("f_theta", c.to_vec()),
    };
    CameraCalibration {
        timestamp,
        width: camera.width,
        height: camera.height,
        distortion_model: model.into(),
        distortion,
        intrinsic: vec![fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0],
        rectification: vec![1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
        projection: vec![fx, 0.0, cx, 0.0, 0.0, fy, cy, 0.0, 0.0, 0.0, 1.0, 0.0],
        frame_id: name.to_owned(),
    }
}

#[cfg(test)]
mod tests;
