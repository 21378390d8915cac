//! The camera of the 3D view: orbits a target in the ego frame (x forward, y left, z up).

use glam::{DMat4, DVec2, DVec3, DVec4};

use scene::{Camera, Extent, Lattice, Lens, Optics, Pose};

/// A viewpoint that orbits a target; perspective or orthographic.
///
/// Depth is reversed: 1 at the near plane, 0 infinitely far (perspective) or at the far plane
/// (orthographic). The view frame is x right, y up, z backward.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViewCamera {
    /// Point in the middle of the view, ego frame, m.
    pub target_m: DVec3,
    /// From the eye to the target, m.
    pub distance_m: f64,
    /// Direction of view about z, rad: 0 looks along ego x, pi/2 along ego y.
    pub yaw_rad: f64,
    /// Direction of view above the horizon, rad; -pi/2 looks straight down.
    pub pitch_rad: f64,
    /// Vertical field of view, rad. In an orthographic view it sets, with the distance, the height shown.
    pub fov_y_rad: f64,
    /// True for an orthographic view.
    pub ortho: bool,
}

/// Standard viewpoints.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ViewPreset {
    /// From behind and above, perspective: the start view.
    Perspective,
    /// From above, orthographic, ego x up.
    Top,
    /// From the front toward the ego vehicle, orthographic.
    Front,
    /// From behind the ego vehicle, orthographic.
    Back,
    /// From the ego vehicle's right side, orthographic.
    Side,
    /// From its left side, orthographic.
    Left,
    /// From where the driver sits, perspective.
    Ego,
}

impl ViewPreset {
    /// Every preset.
    pub const ALL: [ViewPreset; 7] = [
        ViewPreset::Perspective,
        ViewPreset::Top,
        ViewPreset::Front,
        ViewPreset::Back,
        ViewPreset::Side,
        ViewPreset::Left,
        ViewPreset::Ego,
    ];

    /// Name as on a command line: `perspective`.
    pub fn name(self) -> &'static str {
        match self {
            ViewPreset::Perspective => "perspective",
            ViewPreset::Top => "top",
            ViewPreset::Front => "front",
            ViewPreset::Back => "back",
            ViewPreset::Side => "side",
            ViewPreset::Left => "left",
            ViewPreset::Ego => "ego",
        }
    }

    /// The preset of that name.
    pub fn from_name(name: &str) -> Option<ViewPreset> {
        Self::ALL.into_iter().find(|p| p.name() == name)
    }
}

impl Default for ViewCamera {
    fn default() -> Self {
        Self::preset(ViewPreset::Perspective)
    }
}

/// A whole map is looked at from this many times the distance at which its corners are just seen.
const ROOM_AROUND: f64 = 1.05;
/// Nearest visible distance in a perspective view, m.
const NEAR_M: f64 = 0.1;
/// Half of the depth that an orthographic view shows about its target at least, m.
const ORTHO_HALF_DEPTH_M: f64 = 1000.0;
/// Farthest hit under the pointer that zooming goes to, m.
const FAR_ZOOM_M: f64 = 400.0;
/// A map that is seen less steeply than this is seen from its edge, rad.
const LEVEL_RAD: f64 = -0.17;
const DISTANCE_M: std::ops::RangeInclusive<f64> = 0.2..=15_000.0;
const TARGET_LIMIT_M: f64 = 20_000.0;
const FOV_RAD: std::ops::RangeInclusive<f64> = 0.05..=2.6;

impl ViewCamera {
    /// One of the standard viewpoints.
    pub fn preset(preset: ViewPreset) -> Self {
        use std::f64::consts::{FRAC_PI_2, PI};
        let fov_y_rad = 45f64.to_radians();
        let base = Self {
            target_m: DVec3::new(4.0, 0.0, 0.0),
            distance_m: 58.0,
            yaw_rad: 0.42,
            pitch_rad: -0.56,
            fov_y_rad,
            ortho: false,
        };
        let flat = |target_m, yaw_rad, pitch_rad, height_m: f64| Self {
            target_m,
            yaw_rad,
            pitch_rad,
            ortho: true,
            distance_m: height_m / 2.0 / (fov_y_rad / 2.0).tan(),
            ..base
        };
        match preset {
            ViewPreset::Perspective => base,
            ViewPreset::Top => flat(DVec3::ZERO, 0.0, -FRAC_PI_2, 84.0),
            ViewPreset::Front => flat(DVec3::new(0.0, 0.0, 1.5), PI, 0.0, 30.0),
            ViewPreset::Back => flat(DVec3::new(0.0, 0.0, 1.5), 0.0, 0.0, 30.0),
            ViewPreset::Side => flat(DVec3::new(0.0, 0.0, 1.5), FRAC_PI_2, 0.0, 30.0),
            ViewPreset::Left => flat(DVec3::new(0.0, 0.0, 1.5), -FRAC_PI_2, 0.0, 30.0),
            ViewPreset::Ego => Self {
                target_m: DVec3::new(12.0, 0.0, 0.7),
                distance_m: 11.0,
                yaw_rad: 0.0,
                pitch_rad: -0.05,
                fov_y_rad: 62f64.to_radians(),
                ortho: false,
            },
        }
    }

    /// A standard viewpoint over a map: the one from above shows all of it, the others look where the ego vehicle is. That of the
    /// driver is as high above the ground in every lattice.
    pub fn preset_over(preset: ViewPreset, extent: Extent) -> Self {
        let mut camera = Self::preset(preset);
        if preset == ViewPreset::Top {
            let (low, high) = (extent.min_m(), extent.max_m());
            camera.target_m = ((low + high) / 2.0).with_z(0.0);
            let side_m = (high - low).truncate().max_element();
            camera.distance_m *= side_m * 1.05 / camera.height_at_target_m();
        }
        if preset == ViewPreset::Ego {
            // Above the bonnet, wherever labels have the ground and so the vehicle stands.
            let down_m = |lattice: Lattice| lattice.lowered() as f64 * lattice.voxel_m();
            camera.target_m.z += down_m(Lattice::OCC3D) - down_m(extent.lattice());
        }
        camera.sane()
    }

    /// Looks through a camera of the rig: its position, direction and vertical field of view.
    /// The principal point, roll and what the lens bends are not reproduced.
    pub fn through(camera: &Camera) -> Self {
        let pose = camera.ego_from_camera();
        let forward = pose.rotation * DVec3::Z;
        let distance_m = 10.0;
        Self {
            target_m: pose.translation_m + forward * distance_m,
            distance_m,
            yaw_rad: forward.y.atan2(forward.x),
            pitch_rad: forward.z.clamp(-1.0, 1.0).asin(),
            fov_y_rad: tall_rad(camera),
            ortho: false,
        }
        .sane()
    }

    /// The same view as that of a camera with a picture of some pixels; `None` if it is orthographic.
    pub fn to_camera(&self, [width, height]: [u32; 2]) -> Option<Camera> {
        if self.ortho {
            return None;
        }
        let [right, up, forward] = self.axes();
        let rotation = glam::DQuat::from_mat3(&glam::DMat3::from_cols(right, -up, forward)).normalize();
        let focal_px = f64::from(height) / 2.0 / (self.fov_y_rad / 2.0).tan();
        Some(Camera {
            name: "view".into(),
            width,
            height,
            focal_px: [focal_px; 2],
            center_px: [f64::from(width) / 2.0, f64::from(height) / 2.0],
            rotation_wxyz: [rotation.w, rotation.x, rotation.y, rotation.z],
            translation_m: self.eye_m().into(),
            lens: Lens::Pinhole,
            shutter: None,
            carried: scene::rig::Carried::default(),
        })
    }

    /// Looks from a point to another, both m. Straight up and down the view is turned as ego x lies.
    pub fn from_to(eye_m: DVec3, look_m: DVec3) -> Self {
        let way = look_m - eye_m;
        let level = way.truncate().length();
        Self {
            target_m: look_m,
            distance_m: way.length(),
            yaw_rad: if level > 1e-9 { way.y.atan2(way.x) } else { 0.0 },
            pitch_rad: way.z.atan2(level),
            ..Self::default()
        }
        .sane()
    }

    /// The camera with every field finite and in its range; a field that is not finite comes from the start view.
    pub fn sane(&self) -> Self {
        use std::f64::consts::{FRAC_PI_2, PI};
        let start = Self::preset(ViewPreset::Perspective);
        let or = |v: f64, other: f64| if v.is_finite() { v } else { other };
        let limit = DVec3::splat(TARGET_LIMIT_M);
        Self {
            target_m: if self.target_m.is_finite() {
                self.target_m.clamp(-limit, limit)
            } else {
                start.target_m
            },
            distance_m: or(self.distance_m, start.distance_m).clamp(*DISTANCE_M.start(), *DISTANCE_M.end()),
            yaw_rad: (or(self.yaw_rad, start.yaw_rad) + PI).rem_euclid(2.0 * PI) - PI,
            pitch_rad: or(self.pitch_rad, start.pitch_rad).clamp(-FRAC_PI_2, FRAC_PI_2),
            fov_y_rad: or(self.fov_y_rad, start.fov_y_rad).clamp(*FOV_RAD.start(), *FOV_RAD.end()),
            ortho: self.ortho,
        }
    }

    /// Moves along with a thing whose pose was `before` and is `after`.
    pub fn go_along(&mut self, before: &Pose, after: &Pose) {
        let turned = |pose: &Pose| (pose.rotation * DVec3::X).truncate().to_angle();
        self.target_m = after.apply(before.inverse().apply(self.target_m));
        self.yaw_rad += turned(after) - turned(before);
        *self = self.sane();
    }

    /// Unit vectors right, up and forward of the view, ego frame.
    pub fn axes(&self) -> [DVec3; 3] {
        let (sy, cy) = self.yaw_rad.sin_cos();
        let (sp, cp) = self.pitch_rad.sin_cos();
        // Right comes from the yaw alone, so that looking straight down is no special case.
        let right = DVec3::new(sy, -cy, 0.0);
        let forward = DVec3::new(cy * cp, sy * cp, sp);
        [right, right.cross(forward), forward]
    }

    /// Position of the eye, ego frame, m.
    pub fn eye_m(&self) -> DVec3 {
        self.target_m - self.axes()[2] * self.distance_m
    }

    /// Turns about the target so that the scene follows a pointer: angles in rad, `dx` for a move to the
    /// right, `dy` for a move down (the caller scales pixels, near 0.005 rad each).
    pub fn orbit(&mut self, dx: f64, dy: f64) {
        self.yaw_rad -= dx;
        self.pitch_rad -= dy;
        *self = self.sane();
    }

    /// Turns about the eye, as a head does. Angles in rad, `dx` to the right, `dy` down.
    pub fn turn_head(&mut self, dx: f64, dy: f64) {
        let eye = self.eye_m();
        self.orbit(dx, dy);
        self.target_m = eye + self.axes()[2] * self.distance_m;
    }

    /// Shifts the view so that the point at the target follows a pointer that moved by `delta_px`
    /// (y down) in a view of `size_px`.
    pub fn pan(&mut self, delta_px: DVec2, size_px: [u32; 2]) {
        let [right, up, _] = self.axes();
        let m_per_px = self.height_at_target_m() / f64::from(size_px[1].max(1));
        self.target_m += (up * delta_px.y - right * delta_px.x) * m_per_px;
        *self = self.sane();
    }

    /// The point on the ray under the pointer that [`zoom`](Self::zoom) comes nearer to, ego frame, m: where the ray hits, or as
    /// deep as the middle of the view where it hits nothing near and in an orthographic view. `way` is a unit vector.
    pub fn zoom_point_m(&self, from_m: DVec3, way: DVec3, hit_m: Option<f64>) -> DVec3 {
        let [.., forward] = self.axes();
        let level_m = forward.dot(self.target_m - from_m) / forward.dot(way).max(0.1);
        let hit_m = hit_m.filter(|m| !self.ortho && *m < FAR_ZOOM_M);
        from_m + way * hit_m.unwrap_or(level_m)
    }

    /// Comes nearer by `factor` (2 halves the distance), keeping the point `toward` where it is on screen.
    pub fn zoom(&mut self, factor: f64, toward: Option<DVec3>) {
        if !(factor.is_finite() && factor > 0.0) {
            return;
        }
        let old = self.distance_m;
        self.distance_m = (old / factor).clamp(*DISTANCE_M.start(), *DISTANCE_M.end());
        if let Some(point) = toward.filter(|p| p.is_finite()) {
            self.target_m = point + (self.target_m - point) * (self.distance_m / old);
        }
        *self = self.sane();
    }

    /// Moves eye and target by `step_m` in metres: x right, y up (ego z), z forward.
    pub fn fly(&mut self, step_m: DVec3) {
        let [right, _, forward] = self.axes();
        self.target_m += right * step_m.x + DVec3::Z * step_m.y + forward * step_m.z;
        *self = self.sane();
    }

    /// Puts a sphere (m) in the middle of the view and fits it in.
    pub fn focus(&mut self, center_m: DVec3, radius_m: f64) {
        self.target_m = center_m;
        self.distance_m = radius_m.max(0.5) * 1.15 / (self.sane().fov_y_rad / 2.0).sin();
        *self = self.sane();
    }

    /// Fits a whole map into a view of an aspect (width by height), with little left around it; from above if it was looked at along
    /// the ground.
    pub fn focus_map(&mut self, extent: Extent, aspect: f64) {
        let (low, high) = (extent.min_m(), extent.max_m());
        let middle = ((low + high) / 2.0).with_z(0.0);
        if !self.ortho {
            // After the view of a camera it would be seen from its edge, and widely.
            let usual = Self::default();
            self.fov_y_rad = usual.fov_y_rad;
            if self.pitch_rad > LEVEL_RAD {
                self.pitch_rad = usual.pitch_rad;
            }
        }
        self.target_m = middle;
        *self = self.sane();
        let [right, up, forward] = self.axes();
        let aspect = if aspect.is_finite() {
            aspect.clamp(0.05, 20.0)
        } else {
            1.0
        };
        let half_height = (self.fov_y_rad / 2.0).tan();
        // How far away each corner is just seen.
        let far_m = |corner: DVec3| {
            let way = corner - middle;
            let aside_m = way.dot(right).abs() / (half_height * aspect);
            let above_m = way.dot(up).abs() / half_height;
            let nearer_m = if self.ortho { 0.0 } else { way.dot(forward) };
            aside_m.max(above_m) - nearer_m
        };
        let corners = (0..4).map(|i| {
            let x = if i & 1 == 0 { low.x } else { high.x };
            let y = if i & 2 == 0 { low.y } else { high.y };
            DVec3::new(x, y, 0.0)
        });
        self.distance_m = corners.map(far_m).fold(0.5, f64::max) * ROOM_AROUND;
        *self = self.sane();
    }

    /// Half of the depth that an orthographic view shows about its target, m.
    fn half_depth_m(&self) -> f64 {
        ORTHO_HALF_DEPTH_M.max(self.distance_m)
    }

    /// Height of the view at the target, m.
    pub fn height_at_target_m(&self) -> f64 {
        2.0 * self.distance_m * (self.fov_y_rad / 2.0).tan()
    }

    /// Takes points of the ego frame to the view frame.
    pub fn view_from_world(&self) -> DMat4 {
        let [right, up, forward] = self.axes();
        let eye = self.eye_m();
        let row = |axis: DVec3| axis.extend(-axis.dot(eye));
        DMat4::from_cols(row(right), row(up), row(-forward), DVec4::W).transpose()
    }

    /// Takes points of the view frame to clip space, reversed depth, 0 to 1.
    pub fn clip_from_view(&self, size_px: [u32; 2]) -> DMat4 {
        let aspect = aspect(size_px);
        if self.ortho {
            let half_h = self.height_at_target_m() / 2.0;
            let half_w = half_h * aspect;
            let (near, far) = (
                self.distance_m - self.half_depth_m(),
                self.distance_m + self.half_depth_m(),
            );
            // Depth 1 at `near`, 0 at `far`; z of the view frame points backward.
            let depth = far - near;
            DMat4::from_cols(
                DVec4::new(1.0 / half_w, 0.0, 0.0, 0.0),
                DVec4::new(0.0, 1.0 / half_h, 0.0, 0.0),
                DVec4::new(0.0, 0.0, 1.0 / depth, 0.0),
                DVec4::new(0.0, 0.0, far / depth, 1.0),
            )
        } else {
            let f = 1.0 / (self.fov_y_rad / 2.0).tan();
            DMat4::from_cols(
                DVec4::new(f / aspect, 0.0, 0.0, 0.0),
                DVec4::new(0.0, f, 0.0, 0.0),
                DVec4::new(0.0, 0.0, 0.0, -1.0),
                DVec4::new(0.0, 0.0, NEAR_M, 0.0),
            )
        }
    }

    /// Takes points of the ego frame to clip space.
    pub fn clip_from_world(&self, size_px: [u32; 2]) -> DMat4 {
        self.clip_from_view(size_px) * self.view_from_world()
    }

    /// Origin and unit direction, ego frame, of the ray through a point of the picture
    /// (pixels, origin at the upper left corner, pixel centres at .5).
    /// In an orthographic view the origin lies on the near plane.
    pub fn ray_in_world(&self, pixel: DVec2, size_px: [u32; 2]) -> (DVec3, DVec3) {
        let camera = self.sane();
        let [right, up, forward] = camera.axes();
        let size = DVec2::new(f64::from(size_px[0].max(1)), f64::from(size_px[1].max(1)));
        let pixel = if pixel.is_finite() { pixel } else { size / 2.0 };
        let ndc = DVec2::new(pixel.x / size.x * 2.0 - 1.0, 1.0 - pixel.y / size.y * 2.0);
        let half_h = (camera.fov_y_rad / 2.0).tan();
        let across = (right * (ndc.x * aspect(size_px)) + up * ndc.y) * half_h;
        if camera.ortho {
            let origin = camera.target_m + across * camera.distance_m - forward * camera.half_depth_m();
            (origin, forward)
        } else {
            (camera.eye_m(), (forward + across).normalize())
        }
    }

    /// Where a point of the ego frame appears, in pixels; `None` behind the near plane or for NaN.
    pub fn project(&self, p_in_world: DVec3, size_px: [u32; 2]) -> Option<DVec2> {
        let clip = self.sane().clip_from_world(size_px) * p_in_world.extend(1.0);
        if !clip.is_finite() || clip.w <= NEAR_M * 0.5 {
            return None;
        }
        let ndc = DVec2::new(clip.x, clip.y) / clip.w;
        let size = DVec2::new(f64::from(size_px[0].max(1)), f64::from(size_px[1].max(1)));
        Some(DVec2::new((ndc.x + 1.0) / 2.0, (1.0 - ndc.y) / 2.0) * size)
    }
}

fn aspect(size_px: [u32; 2]) -> f64 {
    f64::from(size_px[0].max(1)) / f64::from(size_px[1].max(1))
}

/// Vertical field of view, rad; for a wide lens the part of it that a flat picture can show.
fn tall_rad(camera: &Camera) -> f64 {
    let pinhole = 2.0 * (f64::from(camera.height) / 2.0 / camera.focal_px[1]).atan();
    if camera.lens == Lens::Pinhole {
        return pinhole;
    }
    let d = Optics::new(camera).direction(camera.center_px[0], f64::from(camera.height));
    let half = if d == DVec3::ZERO { 1.2 } else { d.y.atan2(d.z) };
    (2.0 * half).clamp(0.05, 2.4)
}

#[cfg(test)]
#[path = "camera_tests.rs"]
mod tests;
