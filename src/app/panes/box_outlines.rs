//! Chosen boxes over camera pictures: their edges, as each camera sees them.

use egui::{Color32, Painter, Pos2, Rect, Stroke, pos2};
use glam::DVec3;

use crate::camera_views::CamerasShown;
use crate::state::UiState;
use scene::{Camera, Scene, SceneBox};
use sensors::pictures::march::GroundHeight;
use sensors::pictures::perspective::{EDGES, bent_line, clip_near};
use sensors::raycast::rays::CameraRays;
use viewport::GROUND_TOP_M;
use widgets::theme;

/// How far below the physical ground the pictures show objects, m. Pictures of voxels have the ground at the height of
/// the labels.
pub fn drop_m(shown: &CamerasShown) -> f64 {
    match shown.shown_source().about().ground {
        GroundHeight::Physical => 0.0,
        GroundHeight::AsLabelled => -GROUND_TOP_M,
    }
}

/// The edges of a box in pixels of the camera, clipped at its near plane. Edges behind the camera are left out.
pub fn edges(camera: &Camera, b: &SceneBox, drop_m: f64) -> Vec<[[f64; 2]; 2]> {
    let pose = camera.ego_from_camera();
    let corner = |i: usize| {
        let sign = |bit: usize| if i >> bit & 1 == 1 { 0.5 } else { -0.5 };
        let local = DVec3::new(sign(0), sign(1), sign(2)) * b.size_m;
        b.to_ego(local) - DVec3::Z * drop_m
    };
    let rays = CameraRays::new(camera, camera.width, camera.height);
    if !rays.is_plain() {
        // A lens bends edges, so they are drawn in short pieces.
        let velocity = b.velocity_mps.extend(0.0);
        let pieces = EDGES
            .iter()
            .flat_map(|edge| bent_line(&rays, edge.map(corner), velocity));
        return pieces.map(|ends| ends.map(|p| p.to_array())).collect();
    }
    let corner = |i: usize| pose.rotation.inverse() * (corner(i) - pose.translation_m);
    let pixel = |p: DVec3| {
        let at = |axis: usize| camera.focal_px[axis] * p[axis] / p.z + camera.center_px[axis];
        [at(0), at(1)]
    };
    EDGES
        .iter()
        .filter_map(|[i, j]| <[DVec3; 2]>::try_from(clip_near(&[corner(*i), corner(*j)])).ok())
        .map(|[a, b]| [pixel(a), pixel(b)])
        .filter(|ends| ends.iter().flatten().all(|v| v.is_finite()))
        .collect()
}

/// Draws the chosen boxes over the picture of a camera in `rect`.
pub fn draw(painter: &Painter, rect: Rect, camera: &Camera, scene: &Scene, state: &UiState) {
    let painter = painter.with_clip_rect(painter.clip_rect().intersect(rect));
    let part = |[x, y]: [f64; 2]| -> Pos2 {
        // Points far outside are clamped: huge numbers would only upset the tessellation.
        let at = |v: f64, size: u32| (v / f64::from(size.max(1))).clamp(-20.0, 20.0) as f32;
        rect.min + pos2(at(x, camera.width), at(y, camera.height)).to_vec2() * rect.size()
    };
    for id in state.chosen() {
        let Some(b) = scene.frame().boxes.get(&id).filter(|b| b.problem().is_none()) else {
            continue;
        };
        let lines: Vec<[Pos2; 2]> = edges(camera, b, drop_m(&state.cameras))
            .into_iter()
            .map(|ends| ends.map(part))
            .collect();
        for ends in &lines {
            painter.line_segment(*ends, Stroke::new(3.0, Color32::from_black_alpha(130)));
        }
        for ends in &lines {
            painter.line_segment(*ends, Stroke::new(1.4, theme::ON_CANVAS));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::{BoxId, Class, SensorRig};

    #[test]
    fn a_box_is_lit_where_a_camera_sees_it() {
        let rig = SensorRig::default();
        let mut b = SceneBox {
            id: BoxId(1),
            class: Class::Car,
            center_m: DVec3::new(15.0, 0.0, 0.8),
            size_m: DVec3::new(4.6, 2.0, 1.6),
            yaw_rad: 0.4,
            velocity_mps: glam::DVec2::ZERO,
            label: Default::default(),
        };
        let named = |name: &str| rig.cameras.iter().find(|c| c.name == name).expect("in the rig");
        let (front, back) = (named("CAM_FRONT"), named("CAM_BACK"));
        let seen = edges(front, &b, 0.0);
        assert_eq!((seen.len(), edges(back, &b, 0.0).len()), (12, 0));
        let inside = |p: &[f64; 2]| {
            (0.0..f64::from(front.width)).contains(&p[0]) && (0.0..f64::from(front.height)).contains(&p[1])
        };
        assert!(seen.iter().flatten().all(inside), "{seen:?}");
        // A lower box in the world is lower in the picture.
        let lowered = edges(front, &b, 0.6);
        assert!(seen.iter().zip(&lowered).all(|(a, b)| b[0][1] > a[0][1]));
        // A box around the camera is clipped at the near plane, and no coordinate is infinite.
        b.center_m = front.ego_from_camera().translation_m;
        b.size_m = DVec3::splat(3.0);
        let around = edges(front, &b, 0.0);
        assert!(!around.is_empty() && around.len() < 12, "{}", around.len());
    }
}
