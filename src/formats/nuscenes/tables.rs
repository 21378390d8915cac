//! Rows of the tables. Keys that a reader does not know are passed over; keys that it does not need may be missing.

use serde::{Deserialize, Serialize};

/// Category of an object or a point.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Category {
    /// Key.
    pub token: String,
    /// `vehicle.car`.
    pub name: String,
    /// For a person.
    #[serde(default)]
    pub description: String,
    /// Number of the class in lidarseg files, in folders that have them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub index: Option<u8>,
}

/// A token, a name or level, and a description: tables `attribute`.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Attribute {
    /// Key.
    pub token: String,
    /// `vehicle.parked`.
    pub name: String,
    /// For a person.
    #[serde(default)]
    pub description: String,
}

/// A bin of visibility.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Visibility {
    /// Key: `1` to `4`.
    pub token: String,
    /// `v60-80`, per cent.
    pub level: String,
    /// For a person.
    #[serde(default)]
    pub description: String,
}

/// A drive.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Log {
    /// Key.
    pub token: String,
    /// Name of the recording.
    #[serde(default)]
    pub logfile: String,
    /// Which car.
    #[serde(default)]
    pub vehicle: String,
    /// `2018-07-24`.
    #[serde(default)]
    pub date_captured: String,
    /// `boston-seaport` or one of three places in Singapore.
    #[serde(default)]
    pub location: String,
    /// Not in the schema: how the files came to be ([`crate::recipe`]). Only in folders that Sceneloom wrote.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub recipe: Option<serde_json::Value>,
}

/// A map that logs were driven on.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct NuscenesMap {
    /// Key.
    pub token: String,
    /// Logs.
    #[serde(default)]
    pub log_tokens: Vec<String>,
    /// `semantic_prior`.
    #[serde(default)]
    pub category: String,
    /// A picture of 0.1 m per pixel, 255 where one drives or walks.
    #[serde(default)]
    pub filename: String,
    /// Not in the schema: where the origin of the scene's world frame is in the global frame, m. Only in folders that
    /// Sceneloom wrote.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub world_origin_m: Option<[f64; 2]>,
}

/// A scene of about 20 s.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct SceneRow {
    /// Key.
    pub token: String,
    /// Its log.
    #[serde(default)]
    pub log_token: String,
    /// Number of key frames.
    #[serde(default)]
    pub nbr_samples: u64,
    /// First key frame.
    #[serde(default)]
    pub first_sample_token: String,
    /// Last key frame.
    #[serde(default)]
    pub last_sample_token: String,
    /// `scene-0061`.
    #[serde(default)]
    pub name: String,
    /// Description of what happens.
    #[serde(default)]
    pub description: String,
    /// Not in the schema: the title of the scene. Only in folders that Sceneloom wrote.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub title: Option<String>,
}

/// A key frame.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct NuscenesSample {
    /// Key.
    pub token: String,
    /// Time, µs.
    pub timestamp: i64,
    /// Its scene.
    pub scene_token: String,
    /// The one before; empty for the first.
    #[serde(default)]
    pub prev: String,
    /// The next one; empty for the last.
    #[serde(default)]
    pub next: String,
}

/// One measurement of a sensor.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct SampleData {
    /// Key.
    pub token: String,
    /// The key frame, or the next one after it.
    pub sample_token: String,
    /// Where the vehicle was.
    pub ego_pose_token: String,
    /// Where the sensor is on it.
    pub calibrated_sensor_token: String,
    /// Time, µs.
    pub timestamp: i64,
    /// `pcd` or `jpg`.
    #[serde(default)]
    pub fileformat: String,
    /// True for a measurement of a key frame.
    pub is_key_frame: bool,
    /// Rows of a picture; 0 for other files.
    #[serde(default)]
    pub height: u32,
    /// Pixels per row of a picture; 0 for other files.
    #[serde(default)]
    pub width: u32,
    /// File, from the folder of the data set on.
    pub filename: String,
    /// Previous measurement of the same sensor.
    #[serde(default)]
    pub prev: String,
    /// Next measurement of the same sensor.
    #[serde(default)]
    pub next: String,
}

/// Where the vehicle was.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct EgoPose {
    /// Key.
    pub token: String,
    /// Time, µs.
    #[serde(default)]
    pub timestamp: i64,
    /// w, x, y, z.
    pub rotation: [f64; 4],
    /// Global frame, m.
    pub translation: [f64; 3],
}

/// A kind of sensor.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct NuscenesSensor {
    /// Key.
    pub token: String,
    /// `CAM_FRONT`.
    pub channel: String,
    /// `camera`, `lidar` or `radar`.
    pub modality: String,
}

/// A sensor on a vehicle.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct CalibratedSensor {
    /// Key.
    pub token: String,
    /// Its kind of sensor.
    pub sensor_token: String,
    /// In the ego frame, m.
    pub translation: [f64; 3],
    /// w, x, y, z.
    pub rotation: [f64; 4],
    /// 3 x 3, pixels; empty for a sensor that is no camera.
    #[serde(default)]
    pub camera_intrinsic: Vec<[f64; 3]>,
}

/// One object through a scene.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Instance {
    /// Key.
    pub token: String,
    /// Its category.
    pub category_token: String,
    /// In how many key frames it is.
    #[serde(default)]
    pub nbr_annotations: u64,
    /// First of them.
    #[serde(default)]
    pub first_annotation_token: String,
    /// Last of them.
    #[serde(default)]
    pub last_annotation_token: String,
}

/// A box of a key frame.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct SampleAnnotation {
    /// Key.
    pub token: String,
    /// The key frame.
    pub sample_token: String,
    /// The object.
    pub instance_token: String,
    /// How much of it the cameras see.
    #[serde(default)]
    pub visibility_token: String,
    /// States of the object, such as parked.
    #[serde(default)]
    pub attribute_tokens: Vec<String>,
    /// Centre in the global frame, m.
    pub translation: [f64; 3],
    /// Width, length, height, m.
    pub size: [f64; 3],
    /// w, x, y, z.
    pub rotation: [f64; 4],
    /// Previous box of the same object.
    #[serde(default)]
    pub prev: String,
    /// Next box of the same object.
    #[serde(default)]
    pub next: String,
    /// LiDAR returns.
    #[serde(default)]
    pub num_lidar_pts: u32,
    /// Radar returns.
    #[serde(default)]
    pub num_radar_pts: u32,
}

/// Labels of the points of a key frame's sweep.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Lidarseg {
    /// Key.
    pub token: String,
    /// The sweep.
    pub sample_data_token: String,
    /// File, from the folder of the data set on: a byte per point.
    pub filename: String,
}
