//! The messages of the protocol, written by hand: names and numbers are those of `docs/sensorsim.proto`, which says what each
//! field means. Lengths are in m, times in us, angles in rad.

mod camera;
mod common;
mod render;

pub use camera::{
    AvailableCamera, AvailableCamerasRequest, AvailableCamerasReturn, CameraParam, CameraSpec, Fisheye,
    Ftheta, FthetaPolynomial, LinearCde, Pinhole, ShutterType, Windshield, WindshieldParam,
};
pub use common::{
    ApiVersion, AvailableScenesReturn, Empty, PoseAtTime, PosePair, Quat, Trajectory, Vec3, VersionId,
    WirePose,
};
pub use render::{
    AggregatedRenderRequest, AggregatedRenderReturn, AvailableEgoMasksReturn, AvailableTrajectoriesRequest,
    AvailableTrajectoriesReturn, AvailableTrajectory, BatchRgbRenderRequest, BatchRgbRenderRequestItem,
    BatchRgbRenderReturn, BatchRgbRenderReturnItem, DynamicObject, EgoMaskId, EgoMaskMetadata, ImageFormat,
    LidarDeviceType, LidarRenderRequest, LidarRenderReturn, LidarSpec, RgbRenderRequest, RgbRenderReturn,
};

/// Full name of the service, as it stands in the paths of its methods.
pub const SERVICE: &str = "nre.grpc.protos.sensorsim.SensorsimService";
