//! Cameras: lens models, shutters, and the cameras of a scene.

use super::common::WirePose;

/// How the picture is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, prost::Enumeration)]
#[repr(i32)]
pub enum ShutterType {
    /// Not told; taken for global.
    Unknown = 0,
    /// Row by row, the top one first.
    RollingTopToBottom = 1,
    /// Column by column, the left one first.
    RollingLeftToRight = 2,
    /// Row by row, the bottom one first.
    RollingBottomToTop = 3,
    /// Column by column, the right one first.
    RollingRightToLeft = 4,
    /// All at one instant.
    Global = 5,
}

/// Polynomial of an f-theta lens that is given; the other follows from it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, prost::Enumeration)]
#[repr(i32)]
pub enum FthetaPolynomial {
    /// Not told.
    Unknown = 0,
    /// Angle over distance in the picture.
    PixeldistToAngle = 1,
    /// Distance in the picture over angle.
    AngleToPixeldist = 2,
}

/// Linear map from round distances of an f-theta lens to pixels: `x = c * x' + d * y'`, `y = e * x' + y'`.
#[derive(Clone, Copy, PartialEq, prost::Message)]
pub struct LinearCde {
    /// c.
    #[prost(double, tag = "1")]
    pub linear_c: f64,
    /// d.
    #[prost(double, tag = "2")]
    pub linear_d: f64,
    /// e.
    #[prost(double, tag = "3")]
    pub linear_e: f64,
}

/// An f-theta lens.
#[derive(Clone, PartialEq, prost::Message)]
pub struct Ftheta {
    /// Principal point, px.
    #[prost(double, tag = "1")]
    pub principal_point_x: f64,
    /// Principal point, px.
    #[prost(double, tag = "2")]
    pub principal_point_y: f64,
    /// Which polynomial is the given one.
    #[prost(enumeration = "FthetaPolynomial", tag = "3")]
    pub reference_poly: i32,
    /// Angle, rad, by powers of the distance in px, the constant first.
    #[prost(double, repeated, tag = "4")]
    pub pixeldist_to_angle_poly: Vec<f64>,
    /// Distance, px, by powers of the angle in rad, the constant first.
    #[prost(double, repeated, tag = "5")]
    pub angle_to_pixeldist_poly: Vec<f64>,
    /// Angle from the axis beyond which the lens sees nothing, rad; 0 if not told.
    #[prost(double, tag = "6")]
    pub max_angle: f64,
    /// Pixels that are not square.
    #[prost(message, optional, tag = "7")]
    pub linear_cde: Option<LinearCde>,
}

/// OpenCV's pinhole with distortion.
#[derive(Clone, PartialEq, prost::Message)]
pub struct Pinhole {
    /// Principal point, px.
    #[prost(double, tag = "1")]
    pub principal_point_x: f64,
    /// Principal point, px.
    #[prost(double, tag = "2")]
    pub principal_point_y: f64,
    /// Focal length, px.
    #[prost(double, tag = "3")]
    pub focal_length_x: f64,
    /// Focal length, px.
    #[prost(double, tag = "4")]
    pub focal_length_y: f64,
    /// k1 to k6.
    #[prost(double, repeated, tag = "5")]
    pub radial_coeffs: Vec<f64>,
    /// p1, p2.
    #[prost(double, repeated, tag = "6")]
    pub tangential_coeffs: Vec<f64>,
    /// s1 to s4.
    #[prost(double, repeated, tag = "7")]
    pub thin_prism_coeffs: Vec<f64>,
}

/// OpenCV's fisheye.
#[derive(Clone, PartialEq, prost::Message)]
pub struct Fisheye {
    /// Principal point, px.
    #[prost(double, tag = "1")]
    pub principal_point_x: f64,
    /// Principal point, px.
    #[prost(double, tag = "2")]
    pub principal_point_y: f64,
    /// Focal length, px.
    #[prost(double, tag = "3")]
    pub focal_length_x: f64,
    /// Focal length, px.
    #[prost(double, tag = "4")]
    pub focal_length_y: f64,
    /// k1 to k4.
    #[prost(double, repeated, tag = "5")]
    pub radial_coeffs: Vec<f64>,
    /// Angle from the axis beyond which the lens sees nothing, rad; 0 if not told.
    #[prost(double, tag = "6")]
    pub max_angle: f64,
}

/// Distortion by a windshield in front of the camera.
#[derive(Clone, PartialEq, prost::Message)]
pub struct Windshield {
    /// 0 forward, 1 backward.
    #[prost(int32, tag = "1")]
    pub reference_poly: i32,
    /// Coefficients.
    #[prost(double, repeated, tag = "2")]
    pub horizontal_poly: Vec<f64>,
    /// Coefficients.
    #[prost(double, repeated, tag = "3")]
    pub vertical_poly: Vec<f64>,
    /// Coefficients the other way.
    #[prost(double, repeated, tag = "4")]
    pub horizontal_poly_inverse: Vec<f64>,
    /// Coefficients the other way.
    #[prost(double, repeated, tag = "5")]
    pub vertical_poly_inverse: Vec<f64>,
}

/// The lens of a camera.
#[derive(Clone, PartialEq, prost::Oneof)]
pub enum CameraParam {
    /// f-theta.
    #[prost(message, tag = "2")]
    Ftheta(Ftheta),
    /// Pinhole with distortion.
    #[prost(message, tag = "3")]
    Pinhole(Pinhole),
    /// Fisheye.
    #[prost(message, tag = "4")]
    Fisheye(Fisheye),
}

/// Distortion in front of the lens.
#[derive(Clone, PartialEq, prost::Oneof)]
pub enum WindshieldParam {
    /// A windshield.
    #[prost(message, tag = "10")]
    Windshield(Windshield),
}

/// A camera without its place.
#[derive(Clone, PartialEq, prost::Message)]
pub struct CameraSpec {
    /// Its lens.
    #[prost(oneof = "CameraParam", tags = "2, 3, 4")]
    pub camera_param: Option<CameraParam>,
    /// Its name in the rig.
    #[prost(string, tag = "5")]
    pub logical_id: String,
    /// Rows of the picture that the lens is given for.
    #[prost(uint32, tag = "7")]
    pub resolution_h: u32,
    /// Pixels per row of it.
    #[prost(uint32, tag = "8")]
    pub resolution_w: u32,
    /// How the picture is read.
    #[prost(enumeration = "ShutterType", tag = "9")]
    pub shutter_type: i32,
    /// Distortion in front of the lens.
    #[prost(oneof = "WindshieldParam", tags = "10")]
    pub external_distortion: Option<WindshieldParam>,
}

/// Request for the cameras of a scene.
#[derive(Clone, PartialEq, prost::Message)]
pub struct AvailableCamerasRequest {
    /// The scene.
    #[prost(string, tag = "1")]
    pub scene_id: String,
}

/// A camera of a scene's rig.
#[derive(Clone, PartialEq, prost::Message)]
pub struct AvailableCamera {
    /// Lens, size and shutter.
    #[prost(message, optional, tag = "1")]
    pub intrinsics: Option<CameraSpec>,
    /// Pose of the camera in the rig: takes points of the camera to the rig.
    #[prost(message, optional, tag = "2")]
    pub rig_to_camera: Option<WirePose>,
    /// Its name in the rig.
    #[prost(string, tag = "3")]
    pub logical_id: String,
}

/// The cameras of a scene's rig.
#[derive(Clone, PartialEq, prost::Message)]
pub struct AvailableCamerasReturn {
    /// The cameras.
    #[prost(message, repeated, tag = "1")]
    pub available_cameras: Vec<AvailableCamera>,
}
