//! Requests to render, and their answers.

use super::camera::CameraSpec;
use super::common::{PosePair, Trajectory};

/// An object that is somewhere else than the scene has it.
#[derive(Clone, PartialEq, prost::Message)]
pub struct DynamicObject {
    /// Number of the box or track in the scene.
    #[prost(string, tag = "1")]
    pub track_id: String,
    /// Pose of the middle of its box.
    #[prost(message, optional, tag = "2")]
    pub pose_pair: Option<PosePair>,
}

/// How a picture is packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, prost::Enumeration)]
#[repr(i32)]
pub enum ImageFormat {
    /// Not told.
    Undefined = 0,
    /// PNG.
    Png = 1,
    /// JPEG.
    Jpeg = 2,
    /// JPEG 2000.
    Jpeg2000 = 3,
    /// Bytes: all red ones row by row, then all green, then all blue.
    RgbUint8Planar = 4,
    /// H.264.
    Avc = 5,
    /// AV1.
    Av1 = 6,
}

/// Names a mask of the own vehicle.
#[derive(Clone, PartialEq, prost::Message)]
pub struct EgoMaskId {
    /// The camera.
    #[prost(string, tag = "1")]
    pub camera_logical_id: String,
    /// The vehicle's rig.
    #[prost(string, tag = "2")]
    pub rig_config_id: String,
}

/// A mask of the own vehicle.
#[derive(Clone, PartialEq, prost::Message)]
pub struct EgoMaskMetadata {
    /// Its name.
    #[prost(message, optional, tag = "1")]
    pub ego_mask_id: Option<EgoMaskId>,
}

/// The masks that there are.
#[derive(Clone, PartialEq, prost::Message)]
pub struct AvailableEgoMasksReturn {
    /// The masks.
    #[prost(message, repeated, tag = "1")]
    pub ego_mask_metadata: Vec<EgoMaskMetadata>,
}

/// A picture that is asked for.
#[derive(Clone, PartialEq, prost::Message)]
pub struct RgbRenderRequest {
    /// The scene.
    #[prost(string, tag = "1")]
    pub scene_id: String,
    /// Rows.
    #[prost(uint32, tag = "2")]
    pub resolution_h: u32,
    /// Pixels per row.
    #[prost(uint32, tag = "3")]
    pub resolution_w: u32,
    /// Lens and shutter.
    #[prost(message, optional, tag = "4")]
    pub camera_intrinsics: Option<CameraSpec>,
    /// Start of the frame, us.
    #[prost(fixed64, tag = "5")]
    pub frame_start_us: u64,
    /// End of the frame, us.
    #[prost(fixed64, tag = "6")]
    pub frame_end_us: u64,
    /// Pose of the camera in the world.
    #[prost(message, optional, tag = "7")]
    pub sensor_pose: Option<PosePair>,
    /// Objects that are elsewhere than the scene has them.
    #[prost(message, repeated, tag = "8")]
    pub dynamic_objects: Vec<DynamicObject>,
    /// How the picture is packed.
    #[prost(enumeration = "ImageFormat", tag = "9")]
    pub image_format: i32,
    /// Quality of JPEG.
    #[prost(float, tag = "10")]
    pub image_quality: f32,
    /// True if a mask of the own vehicle goes over the picture.
    #[prost(bool, tag = "11")]
    pub insert_ego_mask: bool,
    /// Name of the mask.
    #[prost(message, optional, tag = "12")]
    pub ego_mask_id: Option<EgoMaskId>,
    /// Pose of the own vehicle in the world.
    #[prost(message, optional, tag = "13")]
    pub ego_pose: Option<PosePair>,
}

/// A picture.
#[derive(Clone, PartialEq, prost::Message)]
pub struct RgbRenderReturn {
    /// Packed as asked for.
    #[prost(bytes = "vec", tag = "1")]
    pub image_bytes: Vec<u8>,
}

/// Models of LiDARs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, prost::Enumeration)]
#[repr(i32)]
pub enum LidarDeviceType {
    /// Hesai Pandar128: all round, 128 beams.
    Pandar128 = 0,
    /// Hesai AT128: a third of the circle, 128 beams.
    At128 = 1,
}

/// Which LiDAR.
#[derive(Clone, Copy, PartialEq, prost::Message)]
pub struct LidarSpec {
    /// The model.
    #[prost(enumeration = "LidarDeviceType", tag = "2")]
    pub lidar_type: i32,
}

/// A sweep that is asked for.
#[derive(Clone, PartialEq, prost::Message)]
pub struct LidarRenderRequest {
    /// The scene.
    #[prost(string, tag = "1")]
    pub scene_id: String,
    /// Which LiDAR.
    #[prost(message, optional, tag = "2")]
    pub lidar_config: Option<LidarSpec>,
    /// Start of the spin, us.
    #[prost(fixed64, tag = "3")]
    pub frame_start_us: u64,
    /// End of the spin, us.
    #[prost(fixed64, tag = "4")]
    pub frame_end_us: u64,
    /// Pose of the LiDAR in the world.
    #[prost(message, optional, tag = "5")]
    pub sensor_pose: Option<PosePair>,
    /// Objects that are elsewhere than the scene has them.
    #[prost(message, repeated, tag = "6")]
    pub dynamic_objects: Vec<DynamicObject>,
}

/// A sweep, in the LiDAR's frame at the end of the spin.
#[derive(Clone, PartialEq, prost::Message)]
pub struct LidarRenderReturn {
    /// x, y, z of each point, m.
    #[prost(float, repeated, tag = "1")]
    pub point_xyzs: Vec<f32>,
    /// Strength of each echo, 0 to 1.
    #[prost(float, repeated, tag = "2")]
    pub point_intensities: Vec<f32>,
    /// Number of points.
    #[prost(uint32, tag = "3")]
    pub num_points: u32,
    /// `point_xyzs` as little-endian 32-bit floats.
    #[prost(bytes = "vec", tag = "4")]
    pub point_xyzs_buffer: Vec<u8>,
    /// `point_intensities` as little-endian 32-bit floats.
    #[prost(bytes = "vec", tag = "5")]
    pub point_intensities_buffer: Vec<u8>,
}

/// Several sensors at once.
#[derive(Clone, PartialEq, prost::Message)]
pub struct AggregatedRenderRequest {
    /// Pictures.
    #[prost(message, repeated, tag = "1")]
    pub rgb_requests: Vec<RgbRenderRequest>,
    /// Sweeps.
    #[prost(message, repeated, tag = "2")]
    pub lidar_requests: Vec<LidarRenderRequest>,
}

/// Pictures and sweeps of several sensors, in the order of the request.
#[derive(Clone, PartialEq, prost::Message)]
pub struct AggregatedRenderReturn {
    /// Pictures.
    #[prost(message, repeated, tag = "1")]
    pub rgb_returns: Vec<RgbRenderReturn>,
    /// Sweeps.
    #[prost(message, repeated, tag = "2")]
    pub lidar_returns: Vec<LidarRenderReturn>,
    /// Extra data for the driver; always empty.
    #[prost(bytes = "vec", tag = "3")]
    pub driver_data: Vec<u8>,
}

/// A picture of a batch.
#[derive(Clone, PartialEq, prost::Message)]
pub struct BatchRgbRenderRequestItem {
    /// Comes back in the answer.
    #[prost(string, tag = "1")]
    pub camera_name: String,
    /// The picture.
    #[prost(message, optional, tag = "2")]
    pub request: Option<RgbRenderRequest>,
}

/// Several pictures at once.
#[derive(Clone, PartialEq, prost::Message)]
pub struct BatchRgbRenderRequest {
    /// The pictures.
    #[prost(message, repeated, tag = "1")]
    pub items: Vec<BatchRgbRenderRequestItem>,
}

/// Result of one picture of a batch.
#[derive(Clone, PartialEq, prost::Message)]
pub struct BatchRgbRenderReturnItem {
    /// Name from the request.
    #[prost(string, tag = "1")]
    pub camera_name: String,
    /// The picture, if there is one.
    #[prost(message, optional, tag = "2")]
    pub result: Option<RgbRenderReturn>,
    /// True if there is one.
    #[prost(bool, tag = "3")]
    pub success: bool,
    /// Why there is none.
    #[prost(string, tag = "4")]
    pub error_message: String,
}

/// Results of a batch, in its order.
#[derive(Clone, PartialEq, prost::Message)]
pub struct BatchRgbRenderReturn {
    /// One for each picture.
    #[prost(message, repeated, tag = "1")]
    pub items: Vec<BatchRgbRenderReturnItem>,
}

/// Request for the trajectories of a scene's own vehicle.
#[derive(Clone, PartialEq, prost::Message)]
pub struct AvailableTrajectoriesRequest {
    /// The scene.
    #[prost(string, tag = "1")]
    pub scene_id: String,
}

/// A trajectory of the own vehicle.
#[derive(Clone, PartialEq, prost::Message)]
pub struct AvailableTrajectory {
    /// Its poses in the world.
    #[prost(message, optional, tag = "2")]
    pub trajectory: Option<Trajectory>,
}

/// The ways of a scene's own vehicle.
#[derive(Clone, PartialEq, prost::Message)]
pub struct AvailableTrajectoriesReturn {
    /// The ways.
    #[prost(message, repeated, tag = "1")]
    pub available_trajectories: Vec<AvailableTrajectory>,
}
