//! Transform from the ego frame to the screen of the bird's-eye view, and back.

use egui::{Pos2, Rect, vec2};
use glam::{DVec2, DVec3};

use editor::pick::PickRay;
use editor::tools::{ScreenProjection, ViewKind};

/// Transform from the ego frame to the screen and back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScreenMap {
    /// The pane, points.
    pub rect: Rect,
    /// Point of the ego frame at the centre of the pane, m.
    pub center_m: DVec2,
    /// Points per metre.
    pub scale: f64,
}

impl ScreenMap {
    /// The screen position of a point of the ego frame.
    pub fn to_screen(&self, p_m: DVec2) -> Pos2 {
        let d = (p_m - self.center_m) * self.scale;
        self.rect.center() + vec2(-d.y as f32, -d.x as f32)
    }

    /// The point of the ego frame under a point of the screen, m.
    pub fn to_ego(&self, p: Pos2) -> DVec2 {
        let d = p - self.rect.center();
        self.center_m + DVec2::new(-f64::from(d.y), -f64::from(d.x)) / self.scale
    }

    /// The rectangle between two points of the ego frame, m.
    pub fn rect_of(&self, min_m: DVec2, max_m: DVec2) -> Rect {
        Rect::from_two_pos(self.to_screen(min_m), self.to_screen(max_m))
    }
}

/// Converts a screen position to the type of the tools.
pub(super) fn point(p: Pos2) -> DVec2 {
    DVec2::new(p.x.into(), p.y.into())
}

/// Converts a screen position from the type of the tools.
pub(super) fn pos(p: DVec2) -> Pos2 {
    egui::pos2(p.x as f32, p.y as f32)
}

/// Height at which rays from above begin, m.
const ABOVE_M: f64 = 1000.0;

impl ScreenProjection for ScreenMap {
    fn kind(&self) -> ViewKind {
        ViewKind::Bev
    }

    fn project(&self, p_m: DVec3) -> Option<DVec2> {
        Some(point(self.to_screen(p_m.truncate())))
    }

    fn ray(&self, at: DVec2) -> Option<PickRay> {
        PickRay::new(self.to_ego(pos(at)).extend(ABOVE_M), -DVec3::Z)
    }

    fn right(&self) -> DVec3 {
        DVec3::X
    }

    fn scale(&self) -> f64 {
        self.scale
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::pos2;

    #[test]
    fn the_map_goes_both_ways() {
        let map = ScreenMap {
            rect: Rect::from_min_size(pos2(100.0, 50.0), vec2(400.0, 300.0)),
            center_m: DVec2::new(3.0, -2.0),
            scale: 7.5,
        };
        let p = DVec2::new(11.25, 4.5);
        assert!(map.to_ego(map.to_screen(p)).distance(p) < 1e-4);
        // Forward is up, left is left.
        assert!(map.to_screen(DVec2::new(10.0, -2.0)).y < map.rect.center().y);
        assert!(map.to_screen(DVec2::new(3.0, 5.0)).x < map.rect.center().x);
    }
}
