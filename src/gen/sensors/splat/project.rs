//! EWA projection of isotropic Gaussians: UniScene (arXiv 2412.05435) equations 13 to 15, in f64.

use glam::{DMat3, DVec2, DVec3};

use crate::raycast::rays::CameraRays;
use scene::Camera;

/// A camera at one image size, ready to project points of the ego frame.
#[derive(Clone, Copy, Debug)]
pub struct SplatCamera {
    camera_from_ego: DMat3,
    ego_in_camera: DVec3,
    focal_px: [f64; 2],
    center_px: [f64; 2],
    /// Limits of x/z and y/z for the Jacobian.
    limit: [f64; 2],
    /// Rays of a lens that bends them or a shutter that reads them one after another; `None` for a plain pinhole.
    bent: Option<CameraRays>,
    /// The picture and a rim around it, within which the derivative of such a lens is taken; lower and upper corner,
    /// px.
    rim_px: [DVec2; 2],
}

/// A Gaussian on the image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Footprint {
    /// Depth of the centre along the optical axis, m; above the near plane.
    pub depth_m: f64,
    /// Centre, px; pixel (column, row) is sampled at (column + 1/2, row + 1/2).
    pub mean_px: [f64; 2],
    /// Covariance xx, xy, yy, px^2, before the low-pass.
    pub covariance_px2: [f64; 3],
}

/// Projection of the surroundings of a point, to first order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalProjection {
    /// Depth along the optical axis, m.
    pub depth_m: f64,
    /// The point, px.
    pub mean_px: [f64; 2],
    /// Derivatives of its two coordinates along the axes of the ego frame, px/m.
    pub px_per_m: [DVec3; 2],
}

impl LocalProjection {
    /// A Gaussian there whose covariance is the sum of a aᵀ over `axes_m`: its principal axes in the ego frame, each as long as
    /// the standard deviation along it, m. `None` for numbers that are not finite.
    pub fn footprint(&self, axes_m: [DVec3; 3]) -> Option<Footprint> {
        let mut covariance_px2 = [0.0; 3];
        for axis in axes_m {
            let [u, v] = self.px_per_m.map(|row| row.dot(axis));
            covariance_px2[0] += u * u;
            covariance_px2[1] += u * v;
            covariance_px2[2] += v * v;
        }
        covariance_px2.iter().all(|c| c.is_finite()).then_some(Footprint {
            depth_m: self.depth_m,
            mean_px: self.mean_px,
            covariance_px2,
        })
    }
}

/// The inverse of a 2 x 2 covariance as L D L^T, which keeps its sign and accuracy for long ellipses:
/// d^T cov^-1 d = `along` (dx - `shear` dy)^2 + `across` dy^2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conic {
    /// Weight of the sheared x, 1/px^2.
    pub along: f64,
    /// Shear of x by y.
    pub shear: f64,
    /// Weight of y, 1/px^2.
    pub across: f64,
    /// sqrt(det / det') of the covariance before and after the low-pass: factor of the opacity, so that a splat far
    /// below a pixel does not gain weight (Mip-Splatting, arXiv 2311.16493).
    pub compensation: f64,
    /// Standard deviations along the image axes after the low-pass, px.
    pub extent_px: [f64; 2],
}

/// Least determinant of a covariance, px^4.
const MIN_DETERMINANT: f64 = 1e-12;

impl SplatCamera {
    /// The camera at `width` x `height` pixels; `jacobian_clamp` in units of half the image (1.3 in the paper).
    pub fn new(camera: &Camera, width: u32, height: u32, jacobian_clamp: f64) -> SplatCamera {
        let camera = camera.resized(width, height);
        let camera_from_ego = camera.ego_from_camera().inverse();
        // Not below 0, nor NaN, which cannot hold anything.
        let limit = |size: u32, focal: f64| (jacobian_clamp * 0.5 * f64::from(size) / focal).max(0.0);
        SplatCamera {
            camera_from_ego: DMat3::from_quat(camera_from_ego.rotation),
            ego_in_camera: camera_from_ego.translation_m,
            focal_px: camera.focal_px,
            center_px: camera.center_px,
            limit: [
                limit(width, camera.focal_px[0]),
                limit(height, camera.focal_px[1]),
            ],
            bent: Some(CameraRays::new(&camera, width, height)).filter(|rays| !rays.is_plain()),
            rim_px: rim(width, height, jacobian_clamp),
        }
    }

    /// A point of the ego frame in the optical frame, m.
    pub fn to_camera(&self, p_in_ego: DVec3) -> DVec3 {
        self.camera_from_ego * p_in_ego + self.ego_in_camera
    }

    /// Projects a Gaussian by a lens of any kind. The covariance comes from the lens's own derivative (EWA to first
    /// order), taken at the border of the picture's rim for points beyond.
    fn bent(
        &self,
        rays: &CameraRays,
        p_in_ego: DVec3,
        std_m: f64,
        [near_m, far_m]: [f64; 2],
    ) -> Option<Footprint> {
        let p = rays.to_camera(p_in_ego, DVec3::ZERO);
        let depth_m = rays.optics().depth_m(p);
        // Written so that NaN fails too.
        if !(depth_m > near_m.max(0.0) && depth_m <= far_m && p.is_finite() && std_m.is_finite()) {
            return None;
        }
        let mean = rays.optics().project(p)?;
        let held = mean.clamp(self.rim_px[0], self.rim_px[1]);
        let at = match held == mean {
            true => p,
            false => rays.optics().direction(held.x, held.y) * depth_m,
        };
        if at == DVec3::ZERO {
            return None;
        }
        let [u, v] = rays.optics().jacobian(at).map(|row| row * std_m);
        let covariance_px2 = [u.length_squared(), u.dot(v), v.length_squared()];
        covariance_px2.iter().all(|c| c.is_finite()).then_some(Footprint {
            depth_m,
            mean_px: mean.to_array(),
            covariance_px2,
        })
    }

    /// The picture around a point of the ego frame to first order (EWA), the derivative held as in [`Self::project`]; `None` as
    /// there.
    pub fn around(&self, p_in_ego: DVec3, [near_m, far_m]: [f64; 2]) -> Option<LocalProjection> {
        let to_ego = |row: DVec3| self.camera_from_ego.transpose() * row;
        if let Some(rays) = &self.bent {
            let p = rays.to_camera(p_in_ego, DVec3::ZERO);
            let depth_m = rays.optics().depth_m(p);
            // Written so that NaN fails too.
            if !(depth_m > near_m.max(0.0) && depth_m <= far_m && p.is_finite()) {
                return None;
            }
            let mean = rays.optics().project(p)?;
            let held = mean.clamp(self.rim_px[0], self.rim_px[1]);
            let at = match held == mean {
                true => p,
                false => rays.optics().direction(held.x, held.y) * depth_m,
            };
            return (at != DVec3::ZERO).then(|| LocalProjection {
                depth_m,
                mean_px: mean.to_array(),
                px_per_m: rays.optics().jacobian(at).map(to_ego),
            });
        }
        let p = self.to_camera(p_in_ego);
        if !(p.z > near_m.max(0.0) && p.z <= far_m && p.is_finite()) {
            return None;
        }
        let ([fx, fy], z) = (self.focal_px, p.z);
        let (u, v) = (p.x / z, p.y / z);
        let cu = u.clamp(-self.limit[0], self.limit[0]);
        let cv = v.clamp(-self.limit[1], self.limit[1]);
        let rows = [
            DVec3::new(fx, 0.0, -fx * cu) / z,
            DVec3::new(0.0, fy, -fy * cv) / z,
        ];
        Some(LocalProjection {
            depth_m: z,
            mean_px: [fx * u + self.center_px[0], fy * v + self.center_px[1]],
            px_per_m: rows.map(to_ego),
        })
    }

    /// Projects a Gaussian of standard deviation `std_m`. `None` unless `near_m < depth <= far_m`
    /// and near_m is at least 0, so nothing at or behind the camera is ever divided by its depth.
    pub fn project(&self, p_in_ego: DVec3, std_m: f64, near_m: f64, far_m: f64) -> Option<Footprint> {
        if let Some(rays) = &self.bent {
            return self.bent(rays, p_in_ego, std_m, [near_m, far_m]);
        }
        let p = self.to_camera(p_in_ego);
        let z = p.z;
        // Written so that NaN fails too.
        if !(z > near_m.max(0.0) && z <= far_m && p.is_finite() && std_m.is_finite()) {
            return None;
        }
        let [fx, fy] = self.focal_px;
        let (u, v) = (p.x / z, p.y / z);
        let (cu, cv) = (
            u.clamp(-self.limit[0], self.limit[0]),
            v.clamp(-self.limit[1], self.limit[1]),
        );
        // Isotropic: cov = std^2 J J^T with J = [[fx, 0, -fx u], [0, fy, -fy v]] / z.
        let s = (std_m / z) * (std_m / z);
        Some(Footprint {
            depth_m: z,
            mean_px: [fx * u + self.center_px[0], fy * v + self.center_px[1]],
            covariance_px2: [
                s * fx * fx * (1.0 + cu * cu),
                s * fx * fy * cu * cv,
                s * fy * fy * (1.0 + cv * cv),
            ],
        })
    }
}

/// The picture with a rim, `clamp` times as large.
fn rim(width: u32, height: u32, clamp: f64) -> [DVec2; 2] {
    let half = DVec2::new(f64::from(width), f64::from(height)) / 2.0;
    // Not below the picture, nor NaN.
    let reach = half * clamp.max(1.0);
    [half - reach, half + reach]
}

impl Conic {
    /// The inverse of a covariance (xx, xy, yy) with `low_pass_px2` added to its diagonal.
    /// `None` for numbers that are not finite.
    pub fn new(covariance_px2: [f64; 3], low_pass_px2: f64) -> Option<Conic> {
        let [xx, xy, yy] = covariance_px2;
        let (a, b, c) = (xx + low_pass_px2, xy, yy + low_pass_px2);
        let before = (xx * yy - xy * xy).max(0.0);
        // Grouped so that the low-pass keeps its share when the first term cancels.
        let determinant = (before + low_pass_px2 * (xx + yy + low_pass_px2)).max(MIN_DETERMINANT);
        let c = c.max(MIN_DETERMINANT.sqrt());
        let conic = Conic {
            along: c / determinant,
            shear: b / c,
            across: 1.0 / c,
            compensation: (before / determinant).sqrt(),
            extent_px: [a.max(0.0).sqrt(), c.sqrt()],
        };
        [a, b, c, conic.along]
            .iter()
            .all(|v| v.is_finite())
            .then_some(conic)
    }

    /// The matrix itself: xx, xy, yy, 1/px^2.
    pub fn matrix(&self) -> [f64; 3] {
        let xy = -self.along * self.shear;
        [self.along, xy, self.across - xy * self.shear]
    }
}
