//! The ruler and a row for every moving object: the span in which it exists, and its keyframes, which can be dragged.

use egui::accesskit::Role;
use egui::{Align2, Color32, Pos2, Rect, Sense, Stroke, TextStyle, Ui, WidgetInfo, pos2, vec2};

use scene::{BoxId, Motion, Scene};

use super::row_menu;
use crate::canvas_draw::box_color;
use crate::command::{Command, TimeCommand};
use crate::state::UiState;
use crate::state::called;
use editor::Edit;
use editor::checks::{Finding, Severity, waive};
use language::{t, tf};
use widgets::theme;

/// Width of the names, points.
const NAME_POINTS: f32 = 150.0;
/// Height of the ruler and of a row, points.
const RULER_POINTS: f32 = 20.0;
const ROW_POINTS: f32 = 20.0;
/// Distance within which the pointer grabs a keyframe, points.
const REACH_POINTS: f32 = 6.0;
/// Least time between two keyframes, s.
const APART_S: f64 = 0.02;

/// Mapping of times to the screen.
#[derive(Clone, Copy)]
pub(super) struct TimeAxis {
    left: f32,
    right: f32,
    length_s: f64,
}

impl TimeAxis {
    /// The screen x of a time.
    pub(super) fn x(&self, time_s: f64) -> f32 {
        let part = (time_s / self.length_s.max(1e-9)) as f32;
        self.left + part * (self.right - self.left)
    }

    /// The time at a screen x, clamped to the clip.
    fn time_s(&self, x: f32) -> f64 {
        let part = f64::from((x - self.left) / (self.right - self.left).max(1.0));
        (part * self.length_s).clamp(0.0, self.length_s)
    }

    /// Left and right end on the screen.
    pub(super) fn ends(&self) -> (f32, f32) {
        (self.left, self.right)
    }
}

/// A keyframe that is dragged.
#[derive(Clone)]
struct KeyframeDrag {
    id: Option<BoxId>,
    motion: Motion,
    there_s: [Option<f64>; 2],
    index: usize,
}

/// The rows, and the keyframe that is dragged.
#[derive(Default)]
pub(super) struct TrackRows {
    drag: Option<KeyframeDrag>,
}

impl TrackRows {
    /// Draws the rows with a total height, points.
    pub(super) fn show(
        &mut self,
        ui: &mut Ui,
        scene: &Scene,
        (state, findings): (&mut UiState, &[Finding]),
        height: f32,
        commands: &mut Vec<Command>,
    ) -> TimeAxis {
        let area = Rect::from_min_size(ui.cursor().min, vec2(ui.available_width(), height));
        let track = TimeAxis {
            left: area.left() + NAME_POINTS,
            right: area.right() - 12.0,
            length_s: scene.clip().length_s,
        };
        let top = Rect::from_min_size(area.min, vec2(area.width(), RULER_POINTS));
        ruler(ui, top, track, scene, state, commands);
        ui.advance_cursor_after_rect(top);
        let rest = (height - RULER_POINTS - 4.0).max(ROW_POINTS);
        let scroll = egui::ScrollArea::vertical()
            .id_salt("tracks")
            .max_height(rest)
            .auto_shrink([false, false]);
        ui.spacing_mut().item_spacing.y = 0.0;
        let ids: Vec<Option<BoxId>> = std::iter::once(None)
            .chain(scene.clip().tracks.keys().copied().map(Some))
            .collect();
        let shown = scroll.show_rows(ui, ROW_POINTS, ids.len(), |ui, range| {
            for id in &ids[range] {
                self.row(ui, *id, track, scene, state, commands);
            }
        });
        let x = track.x(scene.time_s());
        let line = shown.inner_rect.y_range();
        faults(
            ui,
            Rect::from_min_max(top.min, pos2(top.right(), line.max)),
            track,
            scene,
            findings,
            commands,
        );
        ui.painter()
            .vline(x, top.bottom()..=line.max, Stroke::new(1.0, theme::accent()));
        track
    }

    fn row(
        &mut self,
        ui: &mut Ui,
        id: Option<BoxId>,
        track: TimeAxis,
        scene: &Scene,
        state: &mut UiState,
        commands: &mut Vec<Command>,
    ) {
        let clip = scene.clip();
        let (rect, response) =
            ui.allocate_exact_size(vec2(ui.available_width(), ROW_POINTS), Sense::click_and_drag());
        let (name, color) = match id.and_then(|id| clip.tracks.get(&id)) {
            Some(t) => (
                format!("{} {}", theme::sentence(&called(&t.made)), t.made.id.0),
                theme::rgb(box_color(&t.made, state.shown.by_track)),
            ),
            None => (t("Ego vehicle").to_owned(), theme::accent()),
        };
        let chosen = id.is_some_and(|id| state.is_chosen(id)) || id.is_none() && state.selected.is_none();
        response
            .widget_info(|| WidgetInfo::selected(Role::Row, true, chosen, tf!("Track {name}", name = name)));
        let painter = ui.painter_at(rect);
        if chosen {
            painter.rect_filled(rect, theme::RADIUS, theme::accent_fill());
        } else if response.hovered() {
            painter.rect_filled(rect, theme::RADIUS, theme::field());
        }
        let font = TextStyle::Small.resolve(ui.style());
        let middle = rect.center().y;
        painter.rect_filled(
            Rect::from_center_size(pos2(rect.left() + 10.0, middle), vec2(9.0, 9.0)),
            3.0,
            color,
        );
        let names = painter.with_clip_rect(Rect::from_min_max(
            rect.min,
            pos2(track.left - 6.0, rect.bottom()),
        ));
        names.text(
            pos2(rect.left() + 20.0, middle),
            Align2::LEFT_CENTER,
            name,
            font,
            theme::text(),
        );
        let there_s = id
            .and_then(|id| clip.tracks.get(&id))
            .map_or([None; 2], |t| t.there_s);
        let motion = clip.motion(id);
        let (from, to) = (there_s[0].unwrap_or(0.0), there_s[1].unwrap_or(track.length_s));
        let bar = Rect::from_x_y_ranges(track.x(from)..=track.x(to), middle - 2.0..=middle + 2.0);
        let shade = if motion.is_some() { 0.55 } else { 0.15 };
        painter.rect_filled(bar, 2.0, color.gamma_multiply(shade));
        let keys = motion.map(Motion::times_s).unwrap_or_default();
        // Followers have a speed every tenth of a second; these are no keyframes to drag.
        let many = keys.len() > 64;
        for time_s in keys.iter().filter(|_| !many) {
            diamond(&painter, pos2(track.x(*time_s), middle), color);
        }
        let motion = motion.filter(|_| !many).map(|m| (m, there_s));
        self.drag_key(&response, id, motion, track, commands);
        response.context_menu(|ui| row_menu::entries(ui, scene, &mut state.playback, id, commands));
        if response.clicked() {
            commands.push(Command::Select(id));
            if let Some(at) = response.interact_pointer_pos().filter(|p| p.x >= track.left) {
                let near = keys.iter().find(|t| (track.x(**t) - at.x).abs() <= REACH_POINTS);
                let time_s = near.copied().unwrap_or_else(|| track.time_s(at.x));
                commands.push(Command::Time(TimeCommand::Show(
                    time_s.clamp(0.0, track.length_s),
                )));
            }
        }
    }

    /// Moves the keyframe under the pointer to another time, between its neighbours.
    fn drag_key(
        &mut self,
        response: &egui::Response,
        id: Option<BoxId>,
        motion: Option<(&Motion, [Option<f64>; 2])>,
        track: TimeAxis,
        commands: &mut Vec<Command>,
    ) {
        if response.drag_started()
            && let (Some((motion, there_s)), Some(at)) = (motion, response.interact_pointer_pos())
        {
            let keys = motion.times_s();
            let near = keys
                .iter()
                .position(|t| (track.x(*t) - at.x).abs() <= REACH_POINTS);
            self.drag = near.map(|index| KeyframeDrag {
                id,
                motion: motion.clone(),
                there_s,
                index,
            });
        }
        let Some(drag) = self.drag.clone().filter(|d| d.id == id) else {
            return;
        };
        if response.dragged()
            && let Some(at) = response.interact_pointer_pos()
        {
            let keys = drag.motion.times_s();
            let low = drag.index.checked_sub(1).map_or(0.0, |i| keys[i] + APART_S);
            let high = keys.get(drag.index + 1).map_or(track.length_s, |t| t - APART_S);
            let moved_s = track.time_s(at.x).clamp(low.min(high), high.max(low));
            let old_s = keys[drag.index];
            let motion = with_key_at(&drag.motion, old_s, moved_s);
            commands.push(Command::Preview(vec![Edit::SetMotion {
                id,
                motion: Some(motion),
                from_s: drag.there_s[0],
                to_s: drag.there_s[1],
            }]));
        }
        if response.drag_stopped() {
            commands.push(Command::Commit("Move keyframe"));
            self.drag = None;
        }
    }
}

/// The motion with one of its times moved; the others stay.
fn with_key_at(motion: &Motion, old_s: f64, new_s: f64) -> Motion {
    let mut out = motion.clone();
    let time = |t: &mut f64| {
        if *t == old_s {
            *t = new_s;
        }
    };
    match &mut out {
        Motion::Keys(keys) => keys.iter_mut().for_each(|k| time(&mut k.time_s)),
        Motion::Path(path) => path.speeds.iter_mut().for_each(|s| time(&mut s.time_s)),
        Motion::Attached { .. } => {}
    }
    out
}

fn diamond(painter: &egui::Painter, at: Pos2, color: Color32) {
    let r = 4.5;
    let corners = vec![
        at + vec2(0.0, -r),
        at + vec2(r, 0.0),
        at + vec2(0.0, r),
        at + vec2(-r, 0.0),
    ];
    painter.add(egui::Shape::convex_polygon(
        corners,
        color,
        Stroke::new(1.0, Color32::WHITE),
    ));
}

/// Marks moments with findings over all rows; a click shows the moment.
fn faults(
    ui: &Ui,
    area: Rect,
    track: TimeAxis,
    scene: &Scene,
    findings: &[Finding],
    commands: &mut Vec<Command>,
) {
    let open = waive::open(scene.frame(), findings);
    for (i, finding) in open.enumerate() {
        let Some(time_s) = finding.time_s else {
            continue;
        };
        let x = track.x(time_s.clamp(0.0, track.length_s));
        let color = match finding.severity {
            Severity::Error => theme::bad(),
            Severity::Warning => theme::warn(),
            Severity::Info => theme::text_weak(),
        };
        let stroke = Stroke::new(1.0, color.gamma_multiply(0.5));
        ui.painter()
            .vline(x, area.top() + RULER_POINTS..=area.bottom(), stroke);
        let knob = Rect::from_center_size(pos2(x, area.top() + RULER_POINTS - 4.0), vec2(9.0, 9.0));
        ui.painter().circle_filled(knob.center(), 3.5, color);
        let response = ui.interact(knob, ui.scope_id().with(("fault", i)), Sense::click());
        response.widget_info(|| WidgetInfo::labeled(Role::Button, true, t(&finding.text)));
        if response.on_hover_text(t(&finding.text)).clicked() {
            if finding.box_id.is_some() {
                commands.push(Command::Select(finding.box_id));
            }
            commands.push(Command::Time(TimeCommand::Show(time_s)));
        }
    }
}

/// Draws times with ticks; a click or a drag shows that moment.
fn ruler(ui: &Ui, rect: Rect, track: TimeAxis, scene: &Scene, state: &UiState, commands: &mut Vec<Command>) {
    let (left, right) = track.ends();
    let strip = Rect::from_x_y_ranges(left - 6.0..=right + 6.0, rect.y_range());
    let response = ui.interact(strip, ui.scope_id().with("ruler"), Sense::click_and_drag());
    let text = tf!("Time {time} s", time = format!("{:.2}", scene.time_s()));
    response.widget_info(|| WidgetInfo::labeled(Role::Slider, true, &text));
    let painter = ui.painter_at(rect);
    painter.rect_filled(
        Rect::from_x_y_ranges(left..=right, rect.y_range()),
        2.0,
        theme::well(),
    );
    let [from, to] = state.playback.span(track.length_s);
    if state.playback.span_s.is_some() {
        let part = Rect::from_x_y_ranges(track.x(from)..=track.x(to), rect.y_range());
        painter.rect_filled(part, 0.0, theme::accent_fill());
    }
    let step_s = [0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 30.0, 60.0]
        .into_iter()
        .find(|s| track.x(*s) - track.x(0.0) > 46.0)
        .unwrap_or(120.0);
    let font = TextStyle::Small.resolve(ui.style());
    for i in 0..=(track.length_s / step_s + 1e-6) as usize {
        let time_s = i as f64 * step_s;
        let x = track.x(time_s);
        painter.vline(
            x,
            rect.bottom() - 5.0..=rect.bottom(),
            Stroke::new(1.0, theme::text_weak()),
        );
        let digits = usize::from(step_s < 1.0);
        // The last time has no room to its right.
        let (place, align) = match right - x < 30.0 {
            true => (x - 3.0, Align2::RIGHT_TOP),
            false => (x + 3.0, Align2::LEFT_TOP),
        };
        painter.text(
            pos2(place, rect.top() + 1.0),
            align,
            format!("{time_s:.digits$}"),
            font.clone(),
            theme::text_weak(),
        );
    }
    let x = track.x(scene.time_s());
    // The handle leaves the times above it readable.
    let top = rect.bottom() - 9.0;
    let knob = vec![pos2(x - 5.0, top), pos2(x + 5.0, top), pos2(x, rect.bottom())];
    painter.add(egui::Shape::convex_polygon(knob, theme::accent(), Stroke::NONE));
    if let Some(at) = response
        .interact_pointer_pos()
        .filter(|_| response.is_pointer_button_down_on() || response.clicked())
    {
        commands.push(Command::Time(TimeCommand::Scrub(track.time_s(at.x))));
    }
}
