//! Messages of the Foxglove schemas (`foxglove.*`, protobuf), with the fields that are written. Numbers of the fields are
//! those of `foxglove.desc`.

use glam::{DQuat, DVec3};
use prost::Message;

/// `google.protobuf.Timestamp`.
#[derive(Clone, Copy, PartialEq, Message)]
pub(super) struct Time {
    #[prost(int64, tag = "1")]
    pub seconds: i64,
    #[prost(int32, tag = "2")]
    pub nanos: i32,
}

#[derive(Clone, Copy, PartialEq, Message)]
pub(super) struct Vector2 {
    #[prost(double, tag = "1")]
    pub x: f64,
    #[prost(double, tag = "2")]
    pub y: f64,
}

#[derive(Clone, Copy, PartialEq, Message)]
pub(super) struct Vector3 {
    #[prost(double, tag = "1")]
    pub x: f64,
    #[prost(double, tag = "2")]
    pub y: f64,
    #[prost(double, tag = "3")]
    pub z: f64,
}

#[derive(Clone, Copy, PartialEq, Message)]
pub(super) struct Quaternion {
    #[prost(double, tag = "1")]
    pub x: f64,
    #[prost(double, tag = "2")]
    pub y: f64,
    #[prost(double, tag = "3")]
    pub z: f64,
    #[prost(double, tag = "4")]
    pub w: f64,
}

#[derive(Clone, Copy, PartialEq, Message)]
pub(super) struct FoxglovePose {
    #[prost(message, optional, tag = "1")]
    pub position: Option<Vector3>,
    #[prost(message, optional, tag = "2")]
    pub orientation: Option<Quaternion>,
}

#[derive(Clone, Copy, PartialEq, Message)]
pub(super) struct Color {
    #[prost(double, tag = "1")]
    pub r: f64,
    #[prost(double, tag = "2")]
    pub g: f64,
    #[prost(double, tag = "3")]
    pub b: f64,
    #[prost(double, tag = "4")]
    pub a: f64,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct FrameTransform {
    #[prost(message, optional, tag = "1")]
    pub timestamp: Option<Time>,
    #[prost(string, tag = "2")]
    pub parent_frame_id: String,
    #[prost(string, tag = "3")]
    pub child_frame_id: String,
    #[prost(message, optional, tag = "4")]
    pub translation: Option<Vector3>,
    #[prost(message, optional, tag = "5")]
    pub rotation: Option<Quaternion>,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct FrameTransforms {
    #[prost(message, repeated, tag = "1")]
    pub transforms: Vec<FrameTransform>,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct PoseInFrame {
    #[prost(message, optional, tag = "1")]
    pub timestamp: Option<Time>,
    #[prost(string, tag = "2")]
    pub frame_id: String,
    #[prost(message, optional, tag = "3")]
    pub pose: Option<FoxglovePose>,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct CameraCalibration {
    #[prost(message, optional, tag = "1")]
    pub timestamp: Option<Time>,
    #[prost(fixed32, tag = "2")]
    pub width: u32,
    #[prost(fixed32, tag = "3")]
    pub height: u32,
    #[prost(string, tag = "4")]
    pub distortion_model: String,
    /// D.
    #[prost(double, repeated, tag = "5")]
    pub distortion: Vec<f64>,
    /// K, 3 x 3.
    #[prost(double, repeated, tag = "6")]
    pub intrinsic: Vec<f64>,
    /// R, 3 x 3.
    #[prost(double, repeated, tag = "7")]
    pub rectification: Vec<f64>,
    /// P, 3 x 4.
    #[prost(double, repeated, tag = "8")]
    pub projection: Vec<f64>,
    #[prost(string, tag = "9")]
    pub frame_id: String,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct CompressedImage {
    #[prost(message, optional, tag = "1")]
    pub timestamp: Option<Time>,
    #[prost(bytes = "vec", tag = "2")]
    pub data: Vec<u8>,
    #[prost(string, tag = "3")]
    pub format: String,
    #[prost(string, tag = "4")]
    pub frame_id: String,
}

/// Types of numbers in packed data.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, prost::Enumeration)]
#[repr(i32)]
pub(super) enum Numeric {
    Unknown = 0,
    Uint8 = 1,
    Uint16 = 3,
    Float32 = 7,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct PackedElementField {
    #[prost(string, tag = "1")]
    pub name: String,
    #[prost(fixed32, tag = "2")]
    pub offset: u32,
    #[prost(enumeration = "Numeric", tag = "3")]
    pub r#type: i32,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct PointCloud {
    #[prost(message, optional, tag = "1")]
    pub timestamp: Option<Time>,
    #[prost(string, tag = "2")]
    pub frame_id: String,
    #[prost(message, optional, tag = "3")]
    pub pose: Option<FoxglovePose>,
    #[prost(fixed32, tag = "4")]
    pub point_stride: u32,
    #[prost(message, repeated, tag = "5")]
    pub fields: Vec<PackedElementField>,
    #[prost(bytes = "vec", tag = "6")]
    pub data: Vec<u8>,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct Grid {
    #[prost(message, optional, tag = "1")]
    pub timestamp: Option<Time>,
    #[prost(string, tag = "2")]
    pub frame_id: String,
    #[prost(message, optional, tag = "3")]
    pub pose: Option<FoxglovePose>,
    #[prost(fixed32, tag = "4")]
    pub column_count: u32,
    #[prost(message, optional, tag = "5")]
    pub cell_size: Option<Vector2>,
    #[prost(fixed32, tag = "6")]
    pub row_stride: u32,
    #[prost(fixed32, tag = "7")]
    pub cell_stride: u32,
    #[prost(message, repeated, tag = "8")]
    pub fields: Vec<PackedElementField>,
    #[prost(bytes = "vec", tag = "9")]
    pub data: Vec<u8>,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct VoxelGrid {
    #[prost(message, optional, tag = "1")]
    pub timestamp: Option<Time>,
    #[prost(string, tag = "2")]
    pub frame_id: String,
    #[prost(message, optional, tag = "3")]
    pub pose: Option<FoxglovePose>,
    #[prost(fixed32, tag = "4")]
    pub row_count: u32,
    #[prost(fixed32, tag = "5")]
    pub column_count: u32,
    #[prost(message, optional, tag = "6")]
    pub cell_size: Option<Vector3>,
    #[prost(fixed32, tag = "7")]
    pub slice_stride: u32,
    #[prost(fixed32, tag = "8")]
    pub row_stride: u32,
    #[prost(fixed32, tag = "9")]
    pub cell_stride: u32,
    #[prost(message, repeated, tag = "10")]
    pub fields: Vec<PackedElementField>,
    #[prost(bytes = "vec", tag = "11")]
    pub data: Vec<u8>,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct SceneEntityDeletion {
    #[prost(message, optional, tag = "1")]
    pub timestamp: Option<Time>,
    /// 1: all of the topic.
    #[prost(int32, tag = "2")]
    pub r#type: i32,
    #[prost(string, tag = "3")]
    pub id: String,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct KeyValuePair {
    #[prost(string, tag = "1")]
    pub key: String,
    #[prost(string, tag = "2")]
    pub value: String,
}

#[derive(Clone, Copy, PartialEq, Message)]
pub(super) struct CubePrimitive {
    #[prost(message, optional, tag = "1")]
    pub pose: Option<FoxglovePose>,
    #[prost(message, optional, tag = "2")]
    pub size: Option<Vector3>,
    #[prost(message, optional, tag = "3")]
    pub color: Option<Color>,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct SceneEntity {
    #[prost(message, optional, tag = "1")]
    pub timestamp: Option<Time>,
    #[prost(string, tag = "2")]
    pub frame_id: String,
    #[prost(string, tag = "3")]
    pub id: String,
    #[prost(bool, tag = "5")]
    pub frame_locked: bool,
    #[prost(message, repeated, tag = "6")]
    pub metadata: Vec<KeyValuePair>,
    #[prost(message, repeated, tag = "8")]
    pub cubes: Vec<CubePrimitive>,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct SceneUpdate {
    #[prost(message, repeated, tag = "1")]
    pub deletions: Vec<SceneEntityDeletion>,
    #[prost(message, repeated, tag = "2")]
    pub entities: Vec<SceneEntity>,
}

impl Time {
    /// So long after 1970, s.
    pub(super) fn of_s(time_s: f64) -> Self {
        let nanos = nanoseconds(time_s);
        Self {
            seconds: (nanos / 1_000_000_000) as i64,
            nanos: (nanos % 1_000_000_000) as i32,
        }
    }
}

/// A time in the clip as log time, ns.
pub(super) fn nanoseconds(time_s: f64) -> u64 {
    (time_s * 1e9).round().max(0.0) as u64
}

impl From<DVec3> for Vector3 {
    fn from(v: DVec3) -> Self {
        Self {
            x: v.x,
            y: v.y,
            z: v.z,
        }
    }
}

impl From<DQuat> for Quaternion {
    fn from(q: DQuat) -> Self {
        Self {
            x: q.x,
            y: q.y,
            z: q.z,
            w: q.w,
        }
    }
}

impl From<scene::Pose> for FoxglovePose {
    fn from(pose: scene::Pose) -> Self {
        Self {
            position: Some(pose.translation_m.into()),
            orientation: Some(pose.rotation.into()),
        }
    }
}

/// Fields of packed data, one after another.
pub(super) fn fields(list: &[(&str, Numeric)]) -> Vec<PackedElementField> {
    let mut offset = 0;
    let mut one = |(name, of): &(&str, Numeric)| {
        let field = PackedElementField {
            name: (*name).into(),
            offset,
            r#type: *of as i32,
        };
        offset += match of {
            Numeric::Unknown => 0,
            Numeric::Uint8 => 1,
            Numeric::Uint16 => 2,
            Numeric::Float32 => 4,
        };
        field
    };
    list.iter().map(&mut one).collect()
}
