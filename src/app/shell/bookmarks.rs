//! Bookmarks: viewpoints kept under the numbers 1 to 9, each of the 3D view and the bird's-eye view together.

use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};

use super::app::SceneloomApp;
use super::toasts::MessageLevel;
use crate::canvas::BevCanvas;
use language::tf;
use viewport::ViewCamera;

/// Numbers of bookmarks.
pub const SLOTS: std::ops::RangeInclusive<u8> = 1..=9;

/// Viewpoints of both large views.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Bookmark {
    /// Target of the 3D view, ego frame, m.
    target_m: DVec3,
    distance_m: f64,
    yaw_rad: f64,
    pitch_rad: f64,
    fov_y_rad: f64,
    ortho: bool,
    /// Centre of the bird's-eye view, ego frame, m.
    bev_center_m: DVec2,
    /// Points per metre of the bird's-eye view.
    bev_scale: f64,
}

impl Bookmark {
    /// The present viewpoints.
    pub fn from_camera(camera: &ViewCamera, canvas: &BevCanvas) -> Self {
        let (bev_center_m, bev_scale) = canvas.place();
        Self {
            target_m: camera.target_m,
            distance_m: camera.distance_m,
            yaw_rad: camera.yaw_rad,
            pitch_rad: camera.pitch_rad,
            fov_y_rad: camera.fov_y_rad,
            ortho: camera.ortho,
            bev_center_m,
            bev_scale,
        }
    }

    /// The camera of the 3D view, made valid since a file may hold any number.
    pub fn camera(&self) -> ViewCamera {
        ViewCamera {
            target_m: self.target_m,
            distance_m: self.distance_m,
            yaw_rad: self.yaw_rad,
            pitch_rad: self.pitch_rad,
            fov_y_rad: self.fov_y_rad,
            ortho: self.ortho,
        }
        .sane()
    }
}

impl SceneloomApp {
    /// Keeps the viewpoints of both views.
    pub(crate) fn keep_bookmark(&mut self, slot: u8) {
        if SLOTS.contains(&slot) {
            let bookmark = Bookmark::from_camera(&self.views.view3d.camera, &self.views.canvas);
            self.preferences.settings.bookmarks.insert(slot, bookmark);
            self.tell(tf!("View {n} is kept: F{n} comes back to it", n = slot));
        }
    }

    /// Restores the viewpoints of both views.
    pub(crate) fn go_to_bookmark(&mut self, slot: u8) {
        match self.preferences.settings.bookmarks.get(&slot).copied() {
            Some(bookmark) => {
                self.views.view3d.camera = bookmark.camera();
                self.views.canvas.go_to(bookmark.bev_center_m, bookmark.bev_scale);
            }
            None => self.tell(tf!("No view is kept as {n}: Ctrl+F{n} keeps this one", n = slot)),
        }
    }

    fn tell(&mut self, text: String) {
        let now_s = self.now_s();
        self.toasts.push(MessageLevel::Info, text, now_s);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bookmarks_come_back_from_a_file_and_bad_ones_do_no_harm() {
        let camera = ViewCamera {
            target_m: DVec3::new(3.0, -7.0, 1.0),
            distance_m: 21.0,
            yaw_rad: 1.2,
            pitch_rad: -0.3,
            ..ViewCamera::default()
        };
        let bookmark = Bookmark::from_camera(&camera, &BevCanvas::default());
        let text = serde_json::to_string(&bookmark).expect("JSON");
        let again: Bookmark = serde_json::from_str(&text).expect("read");
        assert_eq!(again, bookmark);
        let there = again.camera();
        assert_eq!(
            (there.target_m, there.distance_m),
            (camera.target_m, camera.distance_m)
        );
        assert!((there.yaw_rad - 1.2).abs() < 1e-9 && (there.pitch_rad + 0.3).abs() < 1e-9);
        let bad = Bookmark {
            distance_m: f64::INFINITY,
            target_m: DVec3::NAN,
            ..bookmark
        };
        let camera = bad.camera();
        assert!(camera.distance_m.is_finite() && camera.target_m.is_finite());
    }
}
