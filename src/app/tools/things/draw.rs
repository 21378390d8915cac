//! What is drawn of things over both large views: outlines, what is chosen, handles, what a tool has in hand.

use egui::{Color32, Painter, Pos2, Shape, Stroke, pos2};
use glam::{DVec2, DVec3};

use crate::canvas::ScreenMap;
use crate::state::{Tool, UiState};
use crate::theme;
use crate::tools::bev_draw::tag;
use editor::{outline, pick_things};
use scene::background::{Building, STOREY_M};
use scene::{Form, Frame, Pose, Scene, ThingId};

use super::options::ThingTool;
use super::{Draft, Phase, Pointer, Site, ThingState, line, post};

/// More outlines than this are drawn without those of trees and posts.
const MANY: usize = 4000;
const STEPS: usize = 28;

fn color(form: &Form) -> Color32 {
    let [r, g, b] = match form {
        // Brighter than their class, which is a shade of the ground.
        Form::Building(_) | Form::Bridge(_) => [232, 214, 188],
        Form::Tree(_) | Form::Shrubs(_) => [126, 206, 120],
        Form::Line(line) if line.kind.class() == scene::Class::Vegetation => [126, 206, 120],
        Form::Line(_) => [226, 186, 140],
        Form::Post(_) => [240, 220, 110],
    };
    Color32::from_rgb(r, g, b)
}

/// Points of a form on the screen, and whether they close.
fn trace(form: &Form, to_screen: &dyn Fn(DVec2) -> Option<Pos2>) -> (Vec<Pos2>, bool) {
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

/// How a form is drawn from above.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Look {
    Plain,
    Hovered,
    Chosen,
    Coming,
}

fn draw_form(painter: &Painter, map: &ScreenMap, form: &Form, look: Look) {
    let color = color(form);
    let (points, closed) = trace(form, &|p| Some(map.to_screen(p)));
    let (width, edge, fill) = match look {
        Look::Plain => (1.0, color.gamma_multiply(0.75), 0.16),
        Look::Hovered => (1.8, color, 0.3),
        Look::Chosen => (2.0, Color32::WHITE, 0.42),
        Look::Coming => (1.5, color, 0.25),
    };
    if let Form::Line(line) = form {
        let thick = (line.width_m * map.scale).max(1.6) as f32;
        painter.line(points.clone(), Stroke::new(thick, color.gamma_multiply(0.85)));
        if look != Look::Plain {
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

fn is_convex(points: &[Pos2]) -> bool {
    let n = points.len();
    let turn = |i: usize| {
        let (a, b, c) = (points[i], points[(i + 1) % n], points[(i + 2) % n]);
        let (u, v) = (b - a, c - b);
        u.x * v.y - u.y * v.x
    };
    n >= 3 && ((0..n).all(|i| turn(i) <= 0.0) || (0..n).all(|i| turn(i) >= 0.0))
}

/// The thing under a point of the bird's-eye view that a click would choose.
pub(crate) fn under(scene: &Scene, state: &UiState, at_m: DVec2, reach_m: f64) -> Option<ThingId> {
    let p_m = pick_things::ground_in_world(&scene.frame().world_from_ego, at_m);
    let open = state.tools.things.is_open();
    open.then(|| pick_things::thing_at(&scene.background, p_m, reach_m))
        .flatten()
}

/// Outlines of all things over the map layers; `hovered_m` is where the pointer chooses.
pub(crate) fn outlines(
    painter: &Painter,
    map: &ScreenMap,
    scene: &Scene,
    state: &UiState,
    hovered: Option<ThingId>,
) {
    let things = &state.tools.things;
    if !things.shown || scene.background.is_empty() {
        return;
    }
    let to_ego = scene.frame().world_from_ego.inverse();
    let many = scene.background.len() > MANY;
    for thing in scene.background.iter() {
        let chosen = things.chosen.contains(&thing.id);
        let small = matches!(thing.form, Form::Tree(_) | Form::Post(_));
        if many && small && !chosen {
            continue;
        }
        let form = in_frame(&thing.form, &to_ego);
        let (min, max) = form.bounds_m();
        if !map.rect_of(min, max).intersects(map.rect) {
            continue;
        }
        let look = match () {
            () if chosen => Look::Chosen,
            () if hovered == Some(thing.id) => Look::Hovered,
            () => Look::Plain,
        };
        draw_form(painter, map, &form, look);
    }
}

fn in_frame<'a>(form: &'a Form, to_ego: &Pose) -> std::borrow::Cow<'a, Form> {
    match *to_ego == Pose::IDENTITY {
        true => std::borrow::Cow::Borrowed(form),
        false => std::borrow::Cow::Owned(form.in_frame(to_ego)),
    }
}

/// Corners that can be pulled of the one chosen thing, ego frame, m.
fn handles_m(scene: &Scene, state: &UiState) -> Vec<DVec2> {
    let things = &state.tools.things;
    let mut chosen = things.chosen_in(&scene.background);
    match (chosen.next(), chosen.next()) {
        (Some(one), None) if state.tool == Tool::Select && state.selected.is_none() => {
            let form = one.form.in_frame(&scene.frame().world_from_ego.inverse());
            match form {
                Form::Tree(_) | Form::Post(_) => Vec::new(),
                form => form.points_m(),
            }
        }
        _ => Vec::new(),
    }
}

/// Handles of what is chosen, and what a tool has in hand, over the bird's-eye view.
pub(crate) fn hands(
    painter: &Painter,
    map: &ScreenMap,
    scene: &Scene,
    state: &UiState,
    pointer: Option<Pos2>,
    free: bool,
) {
    for corner in handles_m(scene, state) {
        let square = egui::Rect::from_center_size(map.to_screen(corner), egui::Vec2::splat(6.0));
        painter.rect(
            square,
            1.0,
            Color32::WHITE,
            Stroke::new(1.0, theme::CANVAS),
            egui::StrokeKind::Outside,
        );
    }
    let Some(tool) = state.thing_tool() else { return };
    let at_m = pointer.map(|p| map.to_ego(p));
    let coming = in_hand(tool, scene.frame(), state, at_m, free);
    for form in &coming.forms {
        draw_form(painter, map, form, Look::Coming);
    }
    for pair in coming.way_m.windows(2) {
        let ends = [map.to_screen(pair[0]), map.to_screen(pair[1])];
        painter.line_segment(ends, Stroke::new(1.6, theme::ON_CANVAS));
    }
    for p in state.tools.things.draft.points_m() {
        painter.circle(
            map.to_screen(*p),
            3.5,
            theme::accent(),
            Stroke::new(1.2, theme::ON_CANVAS),
        );
    }
    if let (Some(at), Some(text)) = (pointer, coming.text) {
        tag(painter, at, &text);
    }
}

/// What would come of a tool where the pointer is, ego frame, m.
#[derive(Default)]
struct InHand {
    forms: Vec<Form>,
    way_m: Vec<DVec2>,
    text: Option<String>,
}

fn in_hand(tool: ThingTool, frame: &Frame, state: &UiState, at_m: Option<DVec2>, free: bool) -> InHand {
    let things = &state.tools.things;
    let site = Site {
        layout: &frame.layout,
        trees_m: &[],
        houses_m: &[],
        brush_m: state.brush_m,
    };
    let pointer = |at_m| Pointer {
        phase: Phase::Press,
        at_m,
        reach_m: 0.0,
        free,
    };
    let mut out = InHand::default();
    let drawn = things.draft.points_m();
    match tool {
        ThingTool::Building => {
            let corners: Vec<DVec2> = drawn.iter().copied().chain(at_m).collect();
            if !drawn.is_empty() {
                if corners.len() >= 3 {
                    out.forms.push(Form::Building(Building {
                        outline_m: corners.clone(),
                        height_m: STOREY_M,
                        roof: things.roof,
                        facade: things.facade,
                    }));
                }
                out.text = length(&corners);
            }
            out.way_m = corners;
        }
        ThingTool::Line => {
            let end = at_m.map(|p| line::snapped(&pointer(p), &site, things));
            let points: Vec<DVec2> = drawn.iter().copied().chain(end).collect();
            match points.len() {
                0 | 1 => out.forms.extend(end.map(dot)),
                _ => out.forms.push(Form::Line(things.line_of(points.clone()))),
            }
            out.text = length(&points);
        }
        ThingTool::Post if things.draft == Draft::None => {
            let post = at_m.map(|p| post::placed(&pointer(p), &site, things));
            out.forms.extend(post.map(Form::Post));
        }
        ThingTool::Tree if things.draft == Draft::None => {
            out.forms.extend(at_m.map(|position_m| {
                Form::Tree(scene::background::Tree {
                    position_m,
                    height_m: things.tree_m,
                    crown_radius_m: ThingState::crown_m(things.tree, things.tree_m),
                    kind: things.tree,
                })
            }));
        }
        ThingTool::Shrubs if things.draft == Draft::None => {
            let area = at_m.and_then(|p| outline::of_stroke(&[p], state.brush_m));
            out.forms.extend(area.map(|outline_m| {
                Form::Shrubs(scene::background::Shrubs {
                    outline_m,
                    height_m: things.shrubs_m,
                    per_m2: 0.5,
                })
            }));
        }
        _ => {}
    }
    out
}

/// Where the first point of a line would lie.
fn dot(at_m: DVec2) -> Form {
    Form::Tree(scene::background::Tree {
        position_m: at_m,
        height_m: 1.0,
        crown_radius_m: 0.4,
        kind: Default::default(),
    })
}

/// Length of the last piece, and of all of them.
fn length(points: &[DVec2]) -> Option<String> {
    let pieces: Vec<f64> = points.windows(2).map(|p| p[0].distance(p[1])).collect();
    let last = pieces.last()?;
    Some(match pieces.len() {
        1 => format!("{last:.1} m"),
        _ => format!("{last:.1} m  ·  {:.1} m in all", pieces.iter().sum::<f64>()),
    })
}

/// The knob that raises what is chosen in the 3D view: in the middle of its top, ego frame, m.
pub(crate) fn knob_m(scene: &Scene, state: &UiState) -> Option<DVec3> {
    let frame = scene.frame();
    let to_ego = frame.world_from_ego.inverse();
    let chosen = state.tools.things.chosen_in(&scene.background);
    let tops: Vec<DVec3> = chosen.map(|t| top_m(&t.form.in_frame(&to_ego), frame)).collect();
    let shown = state.tool == Tool::Select && !tops.is_empty();
    shown.then(|| {
        let middle = tops.iter().sum::<DVec3>() / tops.len() as f64;
        let highest = tops.iter().map(|t| t.z).fold(f64::MIN, f64::max);
        middle.with_z(highest + 0.6)
    })
}

/// The middle of a form's top, ego frame, m.
fn top_m(form: &Form, frame: &Frame) -> DVec3 {
    let points = form.points_m();
    // The middle of a bent line lies beside it.
    let middle = match form {
        Form::Line(_) | Form::Bridge(_) => points[points.len() / 2],
        _ => form.middle_m(),
    };
    middle.extend(frame.layout.relief.height_m(middle) + form.height_m())
}

/// Chosen things and what a tool has in hand, over the 3D view; `ground_m` is where the pointer meets it.
pub(crate) fn in_3d(
    painter: &Painter,
    project: &dyn Fn(DVec3) -> Option<Pos2>,
    scene: &Scene,
    state: &UiState,
    pointer: (Option<Pos2>, Option<DVec2>),
) {
    let frame = scene.frame();
    let to_ego = frame.world_from_ego.inverse();
    let relief = |p: DVec2| frame.layout.relief.height_m(p);
    for thing in state.tools.things.chosen_in(&scene.background) {
        let form = thing.form.in_frame(&to_ego);
        let stroke = Stroke::new(1.6, Color32::WHITE);
        let floor = |p: DVec2| project(p.extend(relief(p) + 0.1));
        let middle = form.middle_m();
        let top_z = relief(middle) + form.height_m();
        let top = |p: DVec2| project(p.extend(top_z));
        for part in [&floor as &dyn Fn(DVec2) -> Option<Pos2>, &top] {
            let (points, closed) = trace(&form, part);
            let whole = points.len() == trace(&form, &|_| Some(pos2(0.0, 0.0))).0.len();
            if points.len() >= 2 {
                painter.add(match closed && whole {
                    true => Shape::closed_line(points, stroke),
                    false => Shape::line(points, stroke),
                });
            }
        }
        let posts = match &form {
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
    if let Some(knob) = knob_m(scene, state).and_then(project) {
        let hot = pointer.0.is_some_and(|p| p.distance(knob) < KNOB_REACH);
        let color = if hot { Color32::WHITE } else { theme::accent() };
        painter.circle(knob, 6.0, color, Stroke::new(1.5, Color32::WHITE));
        let up = egui::vec2(0.0, -12.0);
        painter.arrow(knob + up * 0.5, up, Stroke::new(1.8, color));
    }
    let Some(tool) = state.thing_tool() else { return };
    let coming = in_hand(tool, frame, state, pointer.1, false);
    let floor = |p: DVec2| project(p.extend(relief(p) + 0.1));
    let lines = coming.forms.iter().map(|f| trace(f, &floor));
    let way = (coming.way_m.iter().filter_map(|p| floor(*p)).collect(), false);
    for (points, closed) in lines.chain([way]) {
        let stroke = Stroke::new(2.0, theme::accent());
        painter.add(match closed {
            true => Shape::closed_line(points, stroke),
            false => Shape::line(points, stroke),
        });
    }
    if let (Some(at), Some(text)) = (pointer.0, coming.text) {
        tag(painter, at, &text);
    }
}

/// How near the pointer takes hold of the knob, points.
pub(crate) const KNOB_REACH: f32 = 9.0;
