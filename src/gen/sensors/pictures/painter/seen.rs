//! Inputs of the networks for a frame, and the rendered light, which is no input but decides where pictures change
//! (shadows).

use rayon::prelude::*;

use super::PaintInput;
use super::ring::Ring;
use crate::pictures::appearance::{Appearance, Quality, light_direction};
use crate::pictures::picture_hints::{HintedFrame, PictureHints};
use nets::picture::{CAMERA_NUMBERS, Condition, Motion, RingSize};
use scene::{Camera, Conditions, Pose, TimeOfDay, Weather};

/// Distance from its earlier place beyond which a camera sees another scene, m.
const FAR_M: f64 = 4.0;
/// Turn beyond which it does, rad.
const TURNED_RAD: f64 = 0.35;

/// A frame as the cameras of a ring see it.
#[derive(PartialEq)]
pub(super) struct RingFrame {
    conditions: Conditions,
    /// Cameras at the size of their pictures, in the ring's order.
    cameras: Vec<Camera>,
    views: Vec<HintedView>,
}

#[derive(PartialEq)]
struct HintedView {
    hints: PictureHints,
    /// sRGB of the program's own renderer, row-major, without effects of the lens.
    plain: Vec<[u8; 3]>,
}

impl RingFrame {
    /// Looks at a scene.
    pub fn from_input(input: &PaintInput<'_>, ring: &Ring) -> Self {
        let [height, width] = ring.size.pixels().map(|n| n as u32);
        let cameras = ring.in_ring_order(&input.rig.cameras);
        let (teller, appearance) = rayon::join(
            || HintedFrame::new(input.frame),
            || Appearance::with_things(input.frame, input.background, input.rig, &input.conditions),
        );
        let view = |camera: &&Camera| {
            let plain = appearance.render_plain(camera, [width, height], Quality::Preview);
            let byte = |v: f32| (v * 255.0).round().clamp(0.0, 255.0) as u8;
            HintedView {
                hints: teller.of(camera, [width, height]),
                plain: plain.into_iter().map(|c| c.map(byte)).collect(),
            }
        };
        Self {
            conditions: input.conditions,
            views: cameras.par_iter().map(view).collect(),
            cameras: cameras.iter().map(|c| c.resized(width, height)).collect(),
        }
    }

    /// The seed of the conditions.
    pub fn seed(&self) -> u64 {
        self.conditions.seed
    }

    /// Name of the camera of a view.
    pub fn camera_name(&self, view: usize) -> &str {
        &self.cameras[view].name
    }

    /// The camera of a view, at the size of its picture.
    pub fn camera(&self, view: usize) -> &Camera {
        &self.cameras[view]
    }

    /// True if the same cameras look from the same places in the same light.
    pub fn differs_in_scene_alone(&self, other: &Self) -> bool {
        self.conditions == other.conditions && self.cameras == other.cameras
    }

    /// Hints and rendered colours of each pixel of a view.
    pub fn pixels(&self, view: usize) -> (&PictureHints, &[[u8; 3]]) {
        let view = &self.views[view];
        (&view.hints, &view.plain)
    }

    /// Depths of all pixels, `[view][height][width]`, m; 0 where there is nothing.
    pub fn depth_m(&self) -> Vec<f32> {
        self.views
            .iter()
            .flat_map(|v| v.hints.depth_m.iter().copied())
            .collect()
    }

    /// Condition of the transformer.
    pub fn condition(&self, size: RingSize) -> Condition {
        let bytes = |of: fn(&PictureHints) -> &[u8]| {
            let views = self.views.iter();
            views
                .flat_map(|v| of(&v.hints).iter().copied())
                .collect::<Vec<u8>>()
        };
        let to_light = light_direction(&self.conditions).as_dvec3();
        let numbers = |camera: &Camera| -> [f32; CAMERA_NUMBERS] {
            let rotation = camera.ego_from_camera().rotation;
            let light = (rotation.inverse() * to_light).as_vec3();
            // The third row of the matrix is the third column of its inverse.
            let up = (rotation.inverse() * glam::DVec3::Z).as_vec3();
            let focal = (camera.focal_px[0] / f64::from(camera.width.max(1))) as f32;
            [light.x, light.y, light.z, up.x, up.y, up.z, focal]
        };
        Condition {
            size,
            classes: bytes(|h| &h.class),
            depth_m: self.depth_m(),
            facings: bytes(|h| &h.facing),
            time: TimeOfDay::ALL.iter().position(|t| *t == self.conditions.time),
            weather: Weather::ALL.iter().position(|w| *w == self.conditions.weather),
            cameras: self.cameras.iter().map(numbers).collect(),
        }
    }

    /// Motion of each camera since an earlier frame; `None` if the light differs, or if a camera moved so far that it
    /// sees another scene.
    pub fn motion_since(&self, earlier: &Self, size: RingSize) -> Option<Vec<Motion>> {
        let fits = self.conditions == earlier.conditions && self.cameras.len() == earlier.cameras.len();
        debug_assert_eq!(size.views(), self.cameras.len());
        let pairs = self.cameras.iter().zip(&earlier.cameras);
        let motions = pairs.map(|(now, then)| motion(now, then));
        motions.collect::<Option<Vec<_>>>().filter(|_| fits)
    }
}

fn motion(now: &Camera, then: &Camera) -> Option<Motion> {
    let inside = |c: &Camera| (c.width, c.height, c.focal_px, c.center_px, c.lens);
    let (a, b) = (now.ego_from_camera(), then.ego_from_camera());
    let near = a.translation_m.distance(b.translation_m) <= FAR_M
        && a.rotation.angle_between(b.rotation) <= TURNED_RAD
        && inside(now) == inside(then);
    near.then(|| Motion {
        focal_px: now.focal_px.map(|v| v as f32),
        center_px: now.center_px.map(|v| v as f32),
        then_from_now: matrix(&b.inverse(), &a),
    })
}

/// First three rows of the matrix of `outer` after `inner`.
fn matrix(outer: &Pose, inner: &Pose) -> [[f32; 4]; 3] {
    let turn = glam::DMat3::from_quat(outer.rotation * inner.rotation);
    let shift = outer.apply(inner.translation_m);
    let row = |i: usize| {
        let row = turn.row(i);
        [row.x, row.y, row.z, shift[i]].map(|v| v as f32)
    };
    [row(0), row(1), row(2)]
}
