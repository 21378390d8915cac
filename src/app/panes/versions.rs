//! The list of versions: looked at, compared with, starred, gone back to.

use egui::accesskit::Role;
use egui::{Color32, Rect, Sense, TextureOptions, Ui, WidgetInfo, pos2, vec2};

use super::id::PaneId;
use super::pane::{Pane, PaneContext, Place};
use crate::bev_image;
use crate::command::{Command, GenerationCommand, ViewCommand};
use crate::panes::comparing::{CompareMode, Comparing};
use crate::shell::versions::Versions;
use scene::SceneRev;
use widgets::icons;
use widgets::icons::Icon;
use widgets::theme;

/// What was generated so far.
pub struct VersionsPane;

impl Pane for VersionsPane {
    fn id(&self) -> PaneId {
        PaneId::VERSIONS
    }

    fn title(&self) -> String {
        "Versions".into()
    }

    fn icon(&self) -> Icon {
        Icon::Stack
    }

    fn place(&self) -> Place {
        Place::ColumnAtOnce
    }

    fn column_points(&self) -> f32 {
        266.0
    }

    fn controls(&mut self, ui: &mut Ui, cx: &mut PaneContext<'_>, _commands: &mut Vec<Command>) {
        versions_controls(ui, &mut cx.state.compare);
    }

    fn ui(&mut self, ui: &mut Ui, cx: &mut PaneContext<'_>, commands: &mut Vec<Command>) {
        let shown = cx.document.settled_scene().content();
        let before = cx.compare.before.as_ref().map(|s| s.content());
        theme::panel_frame().show(ui, |ui| versions_ui(ui, cx.versions, shown, before, commands));
    }
}

/// Height of an entry, points.
const ENTRY: f32 = 52.0;

/// Draws the list, the newest first. `shown` is the present state, `before` the one it is compared with.
pub fn versions_ui(
    ui: &mut Ui,
    versions: &mut Versions,
    shown: SceneRev,
    before: Option<SceneRev>,
    commands: &mut Vec<Command>,
) {
    if versions.list().len() < 2 {
        let text = "Each generation leaves a version here: click one to compare with it, double-click to go back to it.";
        ui.label(egui::RichText::new(text).small().color(theme::text_weak()));
        ui.add_space(4.0);
    }
    ui.spacing_mut().item_spacing.y = 2.0;
    egui::ScrollArea::vertical()
        .id_salt("versions")
        .auto_shrink(false)
        .show(ui, |ui| {
            for (i, version) in versions.list_mut().iter_mut().enumerate().rev() {
                let size = vec2(ui.available_width(), ENTRY);
                let (rect, response) = ui.allocate_exact_size(size, Sense::click());
                if !ui.is_rect_visible(rect) {
                    continue;
                }
                let is_shown = version.scene.content() == shown;
                let label = version.label.clone();
                response.widget_info(|| WidgetInfo::selected(Role::Button, true, is_shown, &label));
                let fill = match (
                    is_shown,
                    before == Some(version.scene.content()),
                    response.hovered(),
                ) {
                    (true, ..) => theme::accent_fill(),
                    (_, true, _) => theme::field_active(),
                    (_, _, true) => theme::field_hover(),
                    _ => theme::field(),
                };
                ui.painter().rect_filled(rect, theme::RADIUS, fill);
                let texture = version.thumbnail.get_or_insert_with(|| {
                    let behind = Color32::from_rgb(29, 32, 37);
                    let image = bev_image::occupancy(&version.scene.frame().occupancy, behind);
                    ui.ctx().load_texture("version", image, TextureOptions::LINEAR)
                });
                let picture = Rect::from_min_size(rect.min + vec2(4.0, 4.0), vec2(ENTRY - 8.0, ENTRY - 8.0));
                let unit = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
                ui.painter().image(texture.id(), picture, unit, Color32::WHITE);
                let text = |y: f32, text: &str, style: egui::TextStyle, color| {
                    let font = style.resolve(ui.style());
                    let at = pos2(picture.right() + 8.0, rect.top() + y);
                    let room = rect.right() - 30.0 - at.x;
                    let mut job = egui::text::LayoutJob::simple_singleline(text.to_owned(), font, color);
                    job.wrap = egui::text::TextWrapping::truncate_at_width(room.max(20.0));
                    let galley = ui.painter().layout_job(job);
                    ui.painter().galley(at, galley, color);
                };
                text(7.0, &version.label, egui::TextStyle::Body, theme::text_strong());
                text(28.0, &version.note, egui::TextStyle::Small, theme::text_weak());
                let star =
                    Rect::from_center_size(pos2(rect.right() - 16.0, rect.center().y), vec2(24.0, 24.0));
                let starring = ui.interact(star, ui.scope_id().with(("star", i)), Sense::click());
                let starred = version.starred;
                starring
                    .widget_info(|| WidgetInfo::selected(Role::CheckBox, true, starred, "Keep this version"));
                let color = if version.starred {
                    theme::warn()
                } else {
                    theme::text_weak()
                };
                draw_star(ui, star.center(), color, version.starred);
                icons::focus_ring(ui, &starring, star);
                if starring.on_hover_text("Keep this version").clicked() {
                    version.starred = !version.starred;
                }
                icons::focus_ring(ui, &response, rect);
                if response.double_clicked() {
                    commands.push(Command::Generation(GenerationCommand::RestoreVersion(
                        version.scene.content(),
                    )));
                } else if response.clicked() {
                    commands.push(Command::View(ViewCommand::CompareWith(version.scene.content())));
                }
            }
        });
}

/// What the header of the list offers.
pub fn versions_controls(ui: &mut Ui, how: &mut Comparing) {
    icons::choice(ui, &mut how.mode, &CompareMode::ALL, "Compare");
}

fn draw_star(ui: &Ui, center: egui::Pos2, color: Color32, filled: bool) {
    let point = |i: usize| {
        let radius = if i.is_multiple_of(2) { 7.0 } else { 3.2 };
        let angle = (i as f32) * std::f32::consts::PI / 5.0 - std::f32::consts::FRAC_PI_2;
        center + radius * egui::Vec2::angled(angle)
    };
    let points: Vec<_> = (0..10).map(point).collect();
    if filled {
        for i in 0..10 {
            let triangle = vec![center, points[i], points[(i + 1) % 10]];
            let shape = egui::Shape::convex_polygon(triangle, color, egui::Stroke::NONE);
            ui.painter().add(shape);
        }
    }
    ui.painter()
        .add(egui::Shape::closed_line(points, egui::Stroke::new(1.2, color)));
}
