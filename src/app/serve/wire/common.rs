//! Poses, trajectories, versions: the package `common`.

/// Empty message.
#[derive(Clone, Copy, PartialEq, prost::Message)]
pub struct Empty {}

/// A rotation, a unit quaternion.
#[derive(Clone, Copy, PartialEq, prost::Message)]
pub struct Quat {
    /// Scalar part.
    #[prost(float, tag = "1")]
    pub w: f32,
    /// Part along x.
    #[prost(float, tag = "2")]
    pub x: f32,
    /// Part along y.
    #[prost(float, tag = "3")]
    pub y: f32,
    /// Part along z.
    #[prost(float, tag = "4")]
    pub z: f32,
}

/// A place or a way, m.
#[derive(Clone, Copy, PartialEq, prost::Message)]
pub struct Vec3 {
    /// Along x.
    #[prost(float, tag = "1")]
    pub x: f32,
    /// Along y.
    #[prost(float, tag = "2")]
    pub y: f32,
    /// Along z.
    #[prost(float, tag = "3")]
    pub z: f32,
}

/// Pose of an inner frame in an outer one: takes points of the inner frame to the outer one.
#[derive(Clone, Copy, PartialEq, prost::Message)]
pub struct WirePose {
    /// Origin of the inner frame, m.
    #[prost(message, optional, tag = "1")]
    pub vec: Option<Vec3>,
    /// Rotation from the inner frame to the outer one.
    #[prost(message, optional, tag = "2")]
    pub quat: Option<Quat>,
}

/// A pose at the start and at the end of a frame.
#[derive(Clone, Copy, PartialEq, prost::Message)]
pub struct PosePair {
    /// At the start.
    #[prost(message, optional, tag = "1")]
    pub start_pose: Option<WirePose>,
    /// At the end.
    #[prost(message, optional, tag = "2")]
    pub end_pose: Option<WirePose>,
}

/// A pose at a time.
#[derive(Clone, Copy, PartialEq, prost::Message)]
pub struct PoseAtTime {
    /// The pose.
    #[prost(message, optional, tag = "1")]
    pub pose: Option<WirePose>,
    /// The time, us.
    #[prost(fixed64, tag = "2")]
    pub timestamp_us: u64,
}

/// Poses in the order of their times.
#[derive(Clone, PartialEq, prost::Message)]
pub struct Trajectory {
    /// The poses.
    #[prost(message, repeated, tag = "1")]
    pub poses: Vec<PoseAtTime>,
}

/// Version of the protocol's messages.
#[derive(Clone, Copy, PartialEq, prost::Message)]
pub struct ApiVersion {
    /// First number.
    #[prost(uint32, tag = "1")]
    pub major: u32,
    /// Second number.
    #[prost(uint32, tag = "2")]
    pub minor: u32,
    /// Third number.
    #[prost(uint32, tag = "3")]
    pub patch: u32,
}

/// Name and version of the program that answers.
#[derive(Clone, PartialEq, prost::Message)]
pub struct VersionId {
    /// Name and version of the program.
    #[prost(string, tag = "1")]
    pub version_id: String,
    /// Commit it was built from; empty where it is not known.
    #[prost(string, tag = "2")]
    pub git_hash: String,
    /// Version of the messages it follows.
    #[prost(message, optional, tag = "3")]
    pub grpc_api_version: Option<ApiVersion>,
}

/// The scenes that there are.
#[derive(Clone, PartialEq, prost::Message)]
pub struct AvailableScenesReturn {
    /// Their names.
    #[prost(string, repeated, tag = "1")]
    pub scene_ids: Vec<String>,
}
