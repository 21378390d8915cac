//! Drawings of things over both large views: outlines, the selection, and previews of new things.

use egui::{Color32, Painter, Pos2, Shape, Stroke, pos2};
use glam::{DVec2, DVec3};

use editor::tools::beside::ThingState;
use scene::{Form, Scene, ThingId};

use super::screen_map::ScreenMap;

/// Number of outlines above which those of trees and posts are left out.
const MANY: usize = 4000;
const STEPS: usize = 28;

fn color(form: &Form) -> Color32 {
    let [r, g, b] = match form {
        // Brighter than the colour of their class, which is close to that of the ground.
        Form::Building(_) | Form::Bridge(_) => [232, 214, 188],
        Form::Tree(_) | Form::Shrubs(_) => [126, 206, 120],
        Form::Line(line) if line.kind.class() == scene::Class::Vegetation => [126, 206, 120],
        Form::Line(_) => [226, 186, 140],
        Form::Post(_) => [240, 220, 110],
    };
    Color32::from_rgb(r, g, b)
}

/// The points of a form on the screen, and whether they are a closed outline.
pub(super) fn trace(form: &Form, to_screen: &dyn Fn(DVec2) -> Option<Pos2>) -> (Vec<Pos2>, bool) {
    let round = |middle: DVec2, radius: f64| {
        let at =
            |i: usize| middle + DVec2::from_angle(i as f64 / STEPS as f64 * std::f64::consts::TAU) * radius;
        (0..STEPS).filter_map(|i| to_screen(at(i))).collect()
    };
    match form {
        Form::Tree(t) => (round(t.position_m, t.crown_radius_m), true),
        Form::Post(p) => (round(p.position_m, 0.4), true),
        Form::Line(l) => (l.points_m.iter().filter_map(|p| to_screen(*p)).collect(), false),
        Form::Bridge(b) => (b.points_m.iter().filter_map(|p| to_screen(*p)).collect(), false),
        Form::Building(b) => (b.outline_m.iter().filter_map(|p| to_screen(*p)).collect(), true),
        Form::Shrubs(s) => (s.outline_m.iter().filter_map(|p| to_screen(*p)).collect(), true),
    }
}

/// Style of a form from above.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Style {
    Plain,
    Hovered,
    Chosen,
    Coming,
}

/// Draws previews of things (world frame) that would be added.
pub(super) fn copies(painter: &Painter, map: &ScreenMap, scene: &Scene, forms: &[Form]) {
    let ego_from_world = scene.frame().world_from_ego.inverse();
    for form in forms {
        draw_form(painter, map, &form.in_frame(&ego_from_world), Style::Coming);
    }
}

fn draw_form(painter: &Painter, map: &ScreenMap, form: &Form, style: Style) {
    let color = color(form);
    let (points, closed) = trace(form, &|p| Some(map.to_screen(p)));
    let (width, edge, fill) = match style {
        Style::Plain => (1.0, color.gamma_multiply(0.75), 0.16),
        Style::Hovered => (1.8, color, 0.3),
        Style::Chosen => (2.0, Color32::WHITE, 0.42),
        Style::Coming => (1.5, color, 0.25),
    };
    if let Form::Line(line) = form {
        let thick = (line.width_m * map.scale).max(1.6) as f32;
        painter.line(points.clone(), Stroke::new(thick, color.gamma_multiply(0.85)));
        if style != Style::Plain {
            painter.line(points, Stroke::new(width, edge));
        }
        return;
    }
    if let Form::Bridge(bridge) = form {
        let thick = (bridge.width_m * map.scale) as f32;
        painter.line(points.clone(), Stroke::new(thick, color.gamma_multiply(fill)));
    }
    if closed && is_convex(&points) {
        let fill = color.gamma_multiply(fill);
        painter.add(Shape::convex_polygon(points.clone(), fill, Stroke::NONE));
    }
    let stroke = Stroke::new(width, edge);
    painter.add(match closed {
        true => Shape::closed_line(points, stroke),
        false => Shape::line(points, stroke),
    });
    if let Form::Post(post) = form {
        let (at, ahead) = (post.position_m, DVec2::from_angle(post.yaw_rad));
        let ends = [map.to_screen(at), map.to_screen(at + ahead * 1.2)];
        painter.line_segment(ends, Stroke::new(width, edge));
    }
}

/// Draws the preview of a thing, from above.
pub(super) fn coming(painter: &Painter, map: &ScreenMap, form: &Form) {
    draw_form(painter, map, form, Style::Coming);
}

fn is_convex(points: &[Pos2]) -> bool {
    let n = points.len();
    let turn = |i: usize| {
        let (a, b, c) = (points[i], points[(i + 1) % n], points[(i + 2) % n]);
        let (u, v) = (b - a, c - b);
        u.x * v.y - u.y * v.x
    };
    n >= 3 && ((0..n).all(|i| turn(i) <= 0.0) || (0..n).all(|i| turn(i) >= 0.0))
}

/// Draws the outlines of all things over the map layers; `hovered` is the thing that a click would choose.
pub(crate) fn outlines(
    painter: &Painter,
    map: &ScreenMap,
    scene: &Scene,
    things: &ThingState,
    hovered: Option<ThingId>,
) {
    if !things.shown || scene.background.is_empty() {
        return;
    }
    let many = scene.background.len() > MANY;
    for thing in scene.background.iter() {
        let chosen = things.chosen.contains(&thing.id);
        let small = matches!(thing.form, Form::Tree(_) | Form::Post(_));
        if many && small && !chosen {
            continue;
        }
        let form = &thing.form;
        let (min, max) = form.bounds_m();
        if !map.rect_of(min, max).intersects(map.rect) {
            continue;
        }
        let style = match () {
            () if chosen => Style::Chosen,
            () if hovered == Some(thing.id) => Style::Hovered,
            () => Style::Plain,
        };
        draw_form(painter, map, form, style);
    }
}

/// Draws the outlines of chosen things, over the 3D view.
pub(crate) fn in_3d(
    painter: &Painter,
    project: &dyn Fn(DVec3) -> Option<Pos2>,
    scene: &Scene,
    things: &ThingState,
) {
    let frame = scene.frame();
    let relief = |p: DVec2| frame.layout.relief.height_m(p);
    for thing in things.chosen_in(&scene.background) {
        let form = &thing.form;
        let stroke = Stroke::new(1.6, Color32::WHITE);
        let floor = |p: DVec2| project(p.extend(relief(p) + 0.1));
        let middle = form.middle_m();
        let top_z = relief(middle) + form.height_m();
        let top = |p: DVec2| project(p.extend(top_z));
        for part in [&floor as &dyn Fn(DVec2) -> Option<Pos2>, &top] {
            let (points, closed) = trace(form, part);
            let whole = points.len() == trace(form, &|_| Some(pos2(0.0, 0.0))).0.len();
            if points.len() >= 2 {
                painter.add(match closed && whole {
                    true => Shape::closed_line(points, stroke),
                    false => Shape::line(points, stroke),
                });
            }
        }
        let posts = match form {
            Form::Building(b) => b.outline_m.clone(),
            Form::Line(l) => l.points_m.clone(),
            _ => Vec::new(),
        };
        for p in posts {
            if let (Some(a), Some(b)) = (floor(p), top(p)) {
                painter.line_segment([a, b], stroke);
            }
        }
    }
}
