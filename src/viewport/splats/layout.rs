//! Data that the splat shaders read, field by field as in `shaders/shared/splat.wgsl`.

use glam::DMat3;

use scene::Camera;
use scene::sensor_data::RENDER_IDS;
use scene::splats::{Gaussian, SplatOptions};

/// Cameras in one batch: as many as the uniform has room for.
pub(super) const MAX_VIEWS: usize = 128;
/// Farthest a Gaussian may be and largest it may be, m: beyond, products of f32 overflow.
const FAR_AWAY_M: f32 = 1e12;

/// A Gaussian as the device holds it.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
pub(super) struct GpuGaussian {
    position: [f32; 3],
    std_m: f32,
    opacity: f32,
    id: u32,
    unused: [u32; 2],
}

impl GpuGaussian {
    /// `None` for a Gaussian that is never drawn: not finite, without opacity, with an invalid id, or over 1e12 m away.
    pub fn new(g: &Gaussian) -> Option<GpuGaussian> {
        let near = |v: f32| v.is_finite() && v.abs() <= FAR_AWAY_M;
        // Not above 0 also drops NaN.
        (g.position_m.iter().all(|&v| near(v))
            && g.std_m.is_finite()
            && g.opacity > 0.0
            && usize::from(g.id) < RENDER_IDS)
            .then(|| GpuGaussian {
                position: g.position_m,
                std_m: g.std_m.abs().min(FAR_AWAY_M),
                opacity: g.opacity.min(1.0),
                id: g.id.into(),
                unused: [0; 2],
            })
    }
}

/// A camera as the device holds it.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
struct GpuView {
    rows: [[f32; 4]; 3],
    rest: [f32; 4],
    focal_center: [f32; 4],
    limits: [f32; 4],
}

impl GpuView {
    fn new(camera: &Camera, [width, height]: [u32; 2], options: &SplatOptions) -> GpuView {
        let camera = camera.resized(width, height);
        let ego_from_camera = camera.ego_from_camera();
        let camera_from_ego = DMat3::from_quat(ego_from_camera.rotation.inverse());
        let eye = ego_from_camera.translation_m;
        let limit = |axis: usize, size: u32| {
            let half = 0.5 * f64::from(size) / camera.focal_px[axis];
            let limit = options.jacobian_clamp * half;
            // As on the processor: NaN holds everything at the axis.
            if limit > 0.0 { limit.min(1e9) as f32 } else { 0.0 }
        };
        let row = |i: usize| {
            let r = camera_from_ego.row(i).as_vec3();
            [r.x, r.y, r.z, eye[i] as f32]
        };
        let rest = (eye - eye.as_vec3().as_dvec3()).as_vec3();
        let [fx, fy] = camera.focal_px;
        let [cx, cy] = camera.center_px;
        let view = GpuView {
            rows: [row(0), row(1), row(2)],
            rest: [rest.x, rest.y, rest.z, 0.0],
            focal_center: [fx, fy, cx, cy].map(|v| v as f32),
            limits: [limit(0, width), limit(1, height), near_m(options), far_m(options)],
        };
        let numbers: &[f32] = bytemuck::cast_slice(bytemuck::bytes_of(&view));
        if numbers.iter().all(|v| v.is_finite()) {
            view
        } else {
            // A camera without a place sees nothing.
            GpuView {
                limits: [0.0, 0.0, 0.0, -1.0],
                ..bytemuck::Zeroable::zeroed()
            }
        }
    }
}

/// Nearest depth, held to where f32 can go.
fn near_m(options: &SplatOptions) -> f32 {
    rounded_down(options.near_m.max(0.0).min(FAR_AWAY_M.into()))
}

/// Farthest depth; -1 where an option is not a number, so that nothing is drawn then.
fn far_m(options: &SplatOptions) -> f32 {
    let drawn = options.low_pass_px2.is_finite() && !options.alpha_min.is_nan() && !options.t_stop.is_nan();
    if drawn && options.far_m >= 0.0 {
        rounded_down(options.far_m.min(FAR_AWAY_M.into()))
    } else {
        -1.0
    }
}

/// The largest f32 that is not above `limit` (0 or more): an f32 is above the one if it is above the other.
fn rounded_down(limit: f64) -> f32 {
    let near = limit as f32;
    if f64::from(near) > limit {
        near.next_down()
    } else {
        near
    }
}

/// Bits of the largest sort key of a depth.
pub(super) fn key_bits(options: &SplatOptions) -> u32 {
    let (near, far) = (near_m(options), far_m(options));
    let largest = if far > near {
        far.to_bits() - near.to_bits()
    } else {
        0
    };
    u32::BITS - largest.leading_zeros()
}

/// Uniforms of a batch of cameras.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
pub(super) struct GpuBatch {
    size_px: [u32; 2],
    tiles: [u32; 2],
    gaussians: u32,
    key_base: u32,
    planes: u32,
    compensate: u32,
    low_pass_px2: f32,
    alpha_min: f32,
    alpha_max: f32,
    t_stop: f32,
    views: [GpuView; MAX_VIEWS],
}

impl GpuBatch {
    pub fn new(
        cameras: &[Camera],
        size_px: [u32; 2],
        gaussians: u32,
        planes: u32,
        options: &SplatOptions,
    ) -> GpuBatch {
        let mut batch = GpuBatch {
            size_px,
            tiles: size_px.map(|v| v.div_ceil(super::TILE)),
            gaussians,
            key_base: near_m(options).to_bits(),
            planes,
            compensate: options.compensate_opacity.into(),
            low_pass_px2: options.low_pass_px2 as f32,
            alpha_min: options.alpha_min.max(0.0),
            // As on the processor, where NaN caps nothing.
            alpha_max: options.alpha_max.clamp(0.0, 0.999).min(1.0),
            t_stop: options.t_stop.clamp(-1.0, 2.0),
            views: [bytemuck::Zeroable::zeroed(); MAX_VIEWS],
        };
        for (view, camera) in batch.views.iter_mut().zip(cameras) {
            *view = GpuView::new(camera, size_px, options);
        }
        batch
    }
}

/// Size of the uniforms of the splat shaders, bytes; a test compares it with the shaders'.
pub const SPLAT_UNIFORM_BYTES: usize = size_of::<GpuBatch>();

const _: () = assert!(size_of::<GpuGaussian>() == 32);
const _: () = assert!(size_of::<GpuView>() == 96);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn row_43_keys_span_the_depths() {
        let bits = |near_m, far_m| {
            key_bits(&SplatOptions {
                near_m,
                far_m,
                ..Default::default()
            })
        };
        assert_eq!(bits(0.2, 200.0), 27);
        assert_eq!(bits(0.0, f64::INFINITY), 31);
        assert_eq!(bits(5.0, 5.0), 0);
        assert_eq!(bits(5.0, 1.0), 0);
        assert_eq!(bits(0.2, f64::NAN), 0);
        assert_eq!(bits(f64::NAN, 1.5e-45), 1);
    }

    #[test]
    fn planes_are_not_moved_by_rounding() {
        assert!(0.2f32 > rounded_down(0.2) && rounded_down(0.2).next_up() == 0.2f32);
        assert_eq!(
            (rounded_down(0.0), rounded_down(200.0), rounded_down(1e-60)),
            (0.0, 200.0, 0.0)
        );
    }

    #[test]
    fn what_is_never_drawn_stays_here() {
        let sound = Gaussian {
            position_m: [1.0, 2.0, 3.0],
            std_m: -0.2,
            opacity: 7.0,
            id: 19,
        };
        let kept = GpuGaussian::new(&sound).expect("drawn");
        assert_eq!((kept.std_m, kept.opacity, kept.id), (0.2, 1.0, 19));
        for wrong in [
            Gaussian {
                position_m: [0.0, f32::NAN, 0.0],
                ..sound
            },
            Gaussian {
                position_m: [0.0, 0.0, -1e13],
                ..sound
            },
            Gaussian {
                std_m: f32::INFINITY,
                ..sound
            },
            Gaussian {
                opacity: f32::NAN,
                ..sound
            },
            Gaussian {
                opacity: -0.0,
                ..sound
            },
            Gaussian { id: 20, ..sound },
        ] {
            assert!(GpuGaussian::new(&wrong).is_none(), "{wrong:?}");
        }
    }

    #[test]
    fn a_camera_without_a_place_sees_nothing() {
        let mut camera = scene::SensorRig::default().cameras[0].clone();
        assert!(GpuView::new(&camera, [400, 225], &SplatOptions::default()).limits[3] == 200.0);
        camera.translation_m[1] = f64::NAN;
        assert!(GpuView::new(&camera, [400, 225], &SplatOptions::default()).limits[3] < 0.0);
    }
}
