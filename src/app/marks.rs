//! Paints the marks of the tools over a view. The editor gives the shapes as data; their colours and widths are chosen
//! here.

use egui::{Align2, Color32, Painter, Pos2, Rect, Shape, Stroke, StrokeKind, Ui, vec2};
use glam::DVec2;

use editor::tools::{At, Role, ScreenProjection, ToolMark};
use scene::{BevLayer, Extent};

use super::canvas_draw::{BoxStyle, draw_box};
use super::screen_map::{ScreenMap, pos};
use super::thing_outlines;
use widgets::theme;

/// Colours of x, y and z, as usual: red, green, blue.
const AXES: [Color32; 3] = [
    Color32::from_rgb(235, 92, 92),
    Color32::from_rgb(120, 200, 90),
    Color32::from_rgb(96, 150, 245),
];
/// Corners of a circle in 3D space.
const CORNERS: usize = 48;

/// Target on which marks are painted.
pub(super) struct Board<'a> {
    /// Painter of the view.
    pub painter: &'a Painter,
    /// Projection of points to the screen.
    pub view: &'a dyn ScreenProjection,
    /// The map, if the view is from above.
    pub map: Option<&'a ScreenMap>,
    /// Extent of the scene shown.
    pub extent: Extent,
}

fn layer_color(layer: BevLayer) -> Color32 {
    theme::rgb(layer.color())
}

impl Board<'_> {
    fn at(&self, at: &At) -> Option<Pos2> {
        match at {
            At::Ego(p_m) => self.view.project(*p_m).map(pos),
            At::Screen(p) => Some(pos(*p)),
        }
    }

    fn color(&self, role: Role) -> Color32 {
        match role {
            Role::Paint(layer) => layer_color(layer),
            Role::Erase => theme::bad(),
            Role::Choose => theme::accent(),
            Role::Measure => theme::warn(),
            Role::Hand if self.map.is_some() => theme::ON_CANVAS,
            Role::Hand => theme::accent(),
            Role::Axis(axis) => AXES[axis.min(2)],
        }
    }

    /// Paints all marks, in order. Voxels, and boxes in 3D, are part of the picture itself.
    pub fn paint(&self, ui: &Ui, marks: &[ToolMark]) {
        for mark in marks {
            self.mark(ui, mark);
        }
    }

    fn mark(&self, ui: &Ui, mark: &ToolMark) {
        let painter = self.painter;
        match mark {
            ToolMark::Line(points, role) => self.line(points, *role),
            ToolMark::Dashed(points, role) => {
                let points: Vec<Pos2> = points.iter().filter_map(|p| self.at(p)).collect();
                let stroke = Stroke::new(1.5, self.color(*role));
                painter.extend(Shape::dashed_line(&points, stroke, 5.0, 4.0));
            }
            ToolMark::Ribbon(points_m, width_m, role) => {
                let points = points_m.iter().filter_map(|p| self.at(&(*p).into())).collect();
                let width = (width_m * self.view.scale()) as f32;
                let color = self.color(*role).gamma_multiply(0.35);
                painter.add(Shape::line(points, Stroke::new(width, color)));
            }
            ToolMark::Rect(a, b, _) => {
                if let (Some(a), Some(b)) = (self.at(a), self.at(b)) {
                    marquee(painter, Rect::from_two_pos(a, b));
                }
            }
            ToolMark::Columns(cells, role) => {
                if let Some(map) = self.map {
                    let color = self.color(*role).gamma_multiply(0.4);
                    for [low_m, high_m] in runs(self.extent, cells) {
                        painter.rect_filled(map.rect_of(low_m, high_m), 0.0, color);
                    }
                }
            }
            ToolMark::Disc(middle_m, radius_m, role) => self.disc(*middle_m, *radius_m, *role),
            ToolMark::Dot(at, role) => {
                if let Some(p) = self.at(at) {
                    let edge = match role {
                        Role::Measure => theme::CANVAS,
                        _ => theme::ON_CANVAS,
                    };
                    painter.circle(p, 3.5, self.color(*role), Stroke::new(1.2, edge));
                }
            }
            ToolMark::Handle(at) => {
                if let Some(p) = self.at(at) {
                    let square = Rect::from_center_size(p, egui::Vec2::splat(6.0));
                    let edge = Stroke::new(1.0, theme::CANVAS);
                    painter.rect(square, 1.0, Color32::WHITE, edge, StrokeKind::Outside);
                }
            }
            ToolMark::Tag(at, text) => {
                if let Some(p) = self.at(at) {
                    tag(painter, p, text);
                }
            }
            ToolMark::Label(at, text) => {
                if let Some(p) = self.at(at) {
                    label(painter, p, text);
                }
            }
            ToolMark::Ghost(b) => {
                if let Some(map) = self.map {
                    draw_box(ui, map, b, b.class.color(), BoxStyle::Ghost);
                }
            }
            ToolMark::Coming(form) => match self.map {
                Some(map) => thing_outlines::coming(painter, map, form),
                None => {
                    let (points, closed) = thing_outlines::trace(form, &|p_m| self.on_ground(p_m));
                    let stroke = Stroke::new(2.0, theme::accent());
                    painter.add(match closed {
                        true => Shape::closed_line(points, stroke),
                        false => Shape::line(points, stroke),
                    });
                }
            },
            ToolMark::Arrow {
                ends: [from, to],
                role,
                hot,
                square,
            } => {
                if let (Some(from), Some(to)) = (self.at(from), self.at(to)) {
                    arrow(painter, [from, to], self.color(*role), *hot, *square);
                }
            }
            ToolMark::Ring(points, hot) => {
                let points = points.iter().filter_map(|p| self.at(p)).collect();
                let width = if *hot { 3.5 } else { 2.0 };
                painter.line(points, Stroke::new(width, AXES[2]));
            }
            ToolMark::Knob(p_m, hot) => {
                if let Some(p) = self.view.project(*p_m).map(pos) {
                    let color = if *hot { Color32::WHITE } else { theme::accent() };
                    painter.circle(p, 6.0, color, Stroke::new(1.5, Color32::WHITE));
                    let up = vec2(0.0, -12.0);
                    painter.arrow(p + up * 0.5, up, Stroke::new(1.8, color));
                }
            }
            ToolMark::Voxels(..) => {}
        }
    }

    /// The screen position of a point on the ground.
    fn on_ground(&self, p_m: DVec2) -> Option<Pos2> {
        self.view.project(p_m.extend(0.1)).map(pos)
    }

    fn line(&self, points: &[At], role: Role) {
        let points: Vec<Pos2> = points.iter().filter_map(|p| self.at(p)).collect();
        let color = self.color(role);
        let stroke = match role {
            Role::Measure => Stroke::new(1.6, color),
            Role::Axis(_) => Stroke::new(1.0, color.gamma_multiply(0.7)),
            _ => Stroke::new(2.0, color),
        };
        for pair in points.windows(2) {
            if role == Role::Measure {
                let shadow = Stroke::new(3.5, Color32::from_black_alpha(160));
                self.painter.line_segment([pair[0], pair[1]], shadow);
            }
            self.painter.line_segment([pair[0], pair[1]], stroke);
        }
    }

    /// A disc on the ground: the brush, or an area.
    fn disc(&self, middle_m: DVec2, radius_m: f64, role: Role) {
        let (color, fill) = match role {
            Role::Paint(layer) => (theme::ON_CANVAS, theme::rgba(layer.color(), 0.35)),
            Role::Erase => (theme::bad(), theme::bad().gamma_multiply(0.12)),
            role => (self.color(role), Color32::TRANSPARENT),
        };
        let Some(middle) = self.on_ground(middle_m) else {
            return;
        };
        let outline: Vec<Pos2> = match self.map {
            Some(_) => Vec::new(),
            None => {
                let angle = |i: usize| i as f64 / CORNERS as f64 * std::f64::consts::TAU;
                let corner = |i| middle_m + DVec2::from_angle(angle(i)) * radius_m;
                (0..CORNERS).filter_map(|i| self.on_ground(corner(i))).collect()
            }
        };
        let radius = (radius_m * self.view.scale()) as f32;
        let painter = self.painter;
        let edge = |width: f32, color: Color32| match self.map {
            Some(_) => drop(painter.circle_stroke(middle, radius, Stroke::new(width, color))),
            None => drop(painter.add(Shape::closed_line(outline.clone(), Stroke::new(width, color)))),
        };
        if self.map.is_some() {
            painter.circle_filled(middle, radius, fill);
        }
        edge(3.0, Color32::from_black_alpha(140));
        edge(1.5, color);
        if role != Role::Choose {
            painter.circle_filled(middle, 1.5, color);
        }
    }
}

fn arrow(painter: &Painter, [from, to]: [Pos2; 2], color: Color32, hot: bool, square: bool) {
    let color = if hot { theme::ON_CANVAS } else { color };
    painter.line_segment([from, to], Stroke::new(if hot { 3.5 } else { 2.2 }, color));
    let along = (to - from).normalized();
    if square {
        painter.rect_filled(Rect::from_center_size(to, vec2(8.0, 8.0)), 1.0, color);
    } else {
        let side = along.rot90() * 4.5;
        let head = vec![to + along * 9.0, to + side, to - side];
        painter.add(Shape::convex_polygon(head, color, Stroke::NONE));
    }
}

/// Paints the latent cells that are marked to be inpainted.
pub(super) fn region(painter: &Painter, map: &ScreenMap, cells: impl Iterator<Item = [i32; 2]>) {
    const CELL_M: f64 = 1.6;
    let window_m = Extent::WINDOW.min_m();
    for [i, j] in cells {
        let corner_m = DVec2::new(
            window_m.x + f64::from(i) * CELL_M,
            window_m.y + f64::from(j) * CELL_M,
        );
        let rect = map.rect_of(corner_m, corner_m + CELL_M);
        painter.rect_filled(rect.shrink(0.5), 0.0, theme::accent().gamma_multiply(0.28));
    }
}

/// A selection rectangle.
fn marquee(painter: &Painter, rect: Rect) {
    painter.rect_filled(rect, 0.0, theme::accent().gamma_multiply(0.12));
    painter.rect_stroke(rect, 0.0, Stroke::new(1.2, theme::accent()), StrokeKind::Middle);
}

/// A line of text beside a point.
fn tag(painter: &Painter, at: Pos2, text: &str) {
    let font = egui::FontId::proportional(13.0);
    let galley = painter.layout_no_wrap(text.to_owned(), font, theme::ON_CANVAS);
    let rect = Rect::from_min_size(at + vec2(16.0, 14.0), galley.size()).expand2(vec2(6.0, 3.0));
    painter.rect_filled(rect, 3.0, Color32::from_black_alpha(200));
    painter.galley(rect.min + vec2(6.0, 3.0), galley, theme::ON_CANVAS);
}

/// A short text in the middle of a line.
fn label(painter: &Painter, middle: Pos2, text: &str) {
    let font = egui::FontId::proportional(12.0);
    let galley = painter.layout_no_wrap(text.to_owned(), font, theme::ON_CANVAS);
    let rect = Align2::CENTER_CENTER
        .anchor_size(middle, galley.size())
        .expand(3.0);
    painter.rect_filled(rect, 3.0, Color32::from_black_alpha(200));
    painter.galley(rect.min + vec2(3.0, 3.0), galley, theme::ON_CANVAS);
}

/// Merges sorted cells of a map into few rectangles, each from corner to corner, ego frame, m.
fn runs(extent: Extent, cells: &[[usize; 2]]) -> Vec<[DVec2; 2]> {
    let corner = |x: usize, y: usize| {
        DVec2::new(
            extent.min_m().x + x as f64 * extent.voxel_m(),
            extent.min_m().y + y as f64 * extent.voxel_m(),
        )
    };
    let joined = cells.chunk_by(|a, b| a[0] == b[0] && a[1] + 1 == b[1]);
    let run = |cells: &[[usize; 2]]| {
        let ([x, from], [_, to]) = (cells[0], cells[cells.len() - 1]);
        [corner(x, from), corner(x + 1, to + 1)]
    };
    joined.map(run).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_become_rectangles_that_cover_them() {
        let cells = [[3, 5], [3, 6], [3, 8], [4, 5]];
        let rects = runs(Extent::WINDOW, &cells);
        assert_eq!(rects.len(), 3);
        let area: f64 = rects.iter().map(|[a, b]| (*b - *a).element_product()).sum();
        assert!((area - 4.0 * 0.16).abs() < 1e-9);
        assert!(
            (rects[0][0] - DVec2::new(-38.8, -38.0)).length() < 1e-9,
            "{rects:?}"
        );
        assert!(runs(Extent::WINDOW, &[]).is_empty());
    }
}
