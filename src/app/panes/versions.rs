//! The list of versions, to view, compare, name, star and restore them.

use egui::accesskit::Role;
use egui::{Color32, Rect, Sense, TextureOptions, Ui, WidgetInfo, pos2, vec2};

use super::id::PaneId;
use super::pane::{Pane, PaneContext, PanePlacement};
use crate::bev_image;
use crate::command::{Command, GenerationCommand, ViewCommand};
use crate::panes::comparing::{CompareMode, CompareSettings};
use crate::shell::versions::{Version, Versions};
use language::{t, tf};
use scene::SceneRev;
use widgets::icons;
use widgets::icons::Icon;
use widgets::theme;

/// The pane of the versions.
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

    fn place(&self) -> PanePlacement {
        PanePlacement::ColumnAtOnce
    }

    fn column_points(&self) -> f32 {
        266.0
    }

    fn controls(&mut self, ui: &mut Ui, cx: &mut PaneContext<'_>, commands: &mut Vec<Command>) {
        if ui
            .button(t("Keep"))
            .on_hover_text(t("Keep this state as a version"))
            .clicked()
        {
            commands.push(Command::Generation(GenerationCommand::KeepVersion));
        }
        versions_controls(ui, &mut cx.state.compare);
    }

    fn ui(&mut self, ui: &mut Ui, cx: &mut PaneContext<'_>, commands: &mut Vec<Command>) {
        let shown = cx.document.settled_scene().content();
        let reference = cx.compare.reference.as_ref().map(|s| s.content());
        theme::panel_frame().show(ui, |ui| versions_ui(ui, cx.versions, shown, reference, commands));
    }
}

/// Height of an entry, points.
const ENTRY: f32 = 52.0;

/// Draws the list, the newest first. `shown` is the present state, `reference` the one that it is compared with.
pub fn versions_ui(
    ui: &mut Ui,
    versions: &mut Versions,
    shown: SceneRev,
    reference: Option<SceneRev>,
    commands: &mut Vec<Command>,
) {
    if versions.list().len() < 2 {
        let text = t(
            "Each generation leaves a version here: click one to compare with it, double-click to go back to it, right-click to name it. They are saved with the scene.",
        );
        ui.label(egui::RichText::new(text).small().color(theme::text_weak()));
        ui.add_space(4.0);
    }
    ui.spacing_mut().item_spacing.y = 2.0;
    egui::ScrollArea::vertical()
        .id_salt("versions")
        .auto_shrink(false)
        .show(ui, |ui| {
            for i in (0..versions.list().len()).rev() {
                let entry = VersionEntry {
                    rev: versions.list()[i].scene.content(),
                    shown,
                    reference,
                };
                entry.ui(ui, versions, i, commands);
            }
        });
}

/// The title of a version in the language of the interface; a name given by the user is not translated.
fn title(version: &Version) -> &str {
    match version.name.is_empty() {
        true => t(version.title()),
        false => version.title(),
    }
}

/// One entry of the list.
struct VersionEntry {
    rev: SceneRev,
    shown: SceneRev,
    reference: Option<SceneRev>,
}

impl VersionEntry {
    fn ui(&self, ui: &mut Ui, versions: &mut Versions, i: usize, commands: &mut Vec<Command>) {
        let size = vec2(ui.available_width(), ENTRY);
        let (rect, response) = ui.allocate_exact_size(size, Sense::click());
        if !ui.is_rect_visible(rect) {
            return;
        }
        let is_shown = self.rev == self.shown;
        let title = title(&versions.list()[i]).to_owned();
        response.widget_info(|| WidgetInfo::selected(Role::Button, true, is_shown, &title));
        let fill = match (is_shown, self.reference == Some(self.rev), response.hovered()) {
            (true, ..) => theme::accent_fill(),
            (_, true, _) => theme::field_active(),
            (_, _, true) => theme::field_hover(),
            _ => theme::field(),
        };
        ui.painter().rect_filled(rect, theme::RADIUS, fill);
        let picture = Rect::from_min_size(rect.min + vec2(4.0, 4.0), vec2(ENTRY - 8.0, ENTRY - 8.0));
        thumbnail(ui, picture, &mut versions.list_mut()[i]);
        let version = &versions.list()[i];
        let at = pos2(picture.right() + 8.0, rect.top() + 7.0);
        let room = rect.right() - 30.0 - at.x;
        let line = |at, text: &str, style, color| line(ui, at, room, text, style, color);
        if versions.renaming.as_ref().is_none_or(|(rev, _)| *rev != self.rev) {
            line(at, &title, egui::TextStyle::Body, theme::text_strong());
        }
        let below = match (version.name.is_empty(), version.note.is_empty()) {
            (true, _) => t(&version.note).to_owned(),
            (false, true) => t(&version.label).to_owned(),
            (false, false) => format!("{} · {}", t(&version.label), t(&version.note)),
        };
        let seed = version
            .made
            .as_ref()
            .map(|made| tf!("seed {n}", n = made.params.seed));
        let below = match seed {
            Some(seed) if below.is_empty() => seed,
            Some(seed) => format!("{below} · {seed}"),
            None => below,
        };
        let found = versions.findings_in_words(i);
        let below = match found {
            Some(found) if below.is_empty() => found,
            Some(found) => format!("{found} · {below}"),
            None => below,
        };
        line(
            at + vec2(0.0, 21.0),
            &below,
            egui::TextStyle::Small,
            theme::text_weak(),
        );
        let star = Rect::from_center_size(pos2(rect.right() - 16.0, rect.center().y), vec2(24.0, 24.0));
        let starring = ui.interact(star, ui.scope_id().with(("star", i)), Sense::click());
        let starred = version.starred;
        starring.widget_info(|| WidgetInfo::selected(Role::CheckBox, true, starred, t("Keep this version")));
        let color = if starred {
            theme::warn()
        } else {
            theme::text_weak()
        };
        icons::star(ui, star.center(), color, starred);
        icons::focus_ring(ui, &starring, star);
        if starring.on_hover_text(t("Keep this version")).clicked() {
            versions.star(self.rev);
        }
        icons::focus_ring(ui, &response, rect);
        if self.name_field(ui, Rect::from_min_size(at, vec2(room, 20.0)), versions) {
            return;
        }
        if response.double_clicked() {
            commands.push(self.go_back());
        } else if response.clicked() {
            commands.push(self.compare());
        }
        response.context_menu(|ui| self.menu(ui, versions, commands));
    }

    fn go_back(&self) -> Command {
        Command::Generation(GenerationCommand::RestoreVersion(self.rev))
    }

    fn compare(&self) -> Command {
        Command::View(ViewCommand::CompareWith(self.rev))
    }

    fn menu(&self, ui: &mut Ui, versions: &mut Versions, commands: &mut Vec<Command>) {
        if ui.button(t("Compare with it")).clicked() {
            commands.push(self.compare());
        }
        if ui.button(t("Go back to it")).clicked() {
            commands.push(self.go_back());
        }
        if let Some(made) = versions.made(self.rev)
            && ui
                .button(t("Use these settings again"))
                .on_hover_text(made.in_words())
                .clicked()
        {
            commands.push(Command::Generation(GenerationCommand::UseAgain(self.rev)));
        }
        ui.separator();
        if ui.button(t("Name…")).clicked()
            && let Some(i) = versions.index_of(self.rev)
        {
            versions.renaming = Some((self.rev, title(&versions.list()[i]).to_owned()));
        }
        let is_last = versions.list().len() < 2;
        if ui.add_enabled(!is_last, egui::Button::new(t("Remove"))).clicked() {
            versions.remove(self.rev);
        }
    }

    /// The field for the version's name; returns false if this version is not being renamed.
    fn name_field(&self, ui: &mut Ui, rect: Rect, versions: &mut Versions) -> bool {
        let Some((_, text)) = versions.renaming.as_mut().filter(|(rev, _)| *rev == self.rev) else {
            return false;
        };
        let field = egui::TextEdit::singleline(text)
            .id_salt("version name")
            .char_limit(Versions::LONGEST_NAME)
            .hint_text(t("name"));
        let field = ui.put(rect, field).accessible_name(t("Name of the version"));
        if field.lost_focus() {
            let text = text.clone();
            if !ui.input(|i| i.key_pressed(egui::Key::Escape)) {
                versions.rename(self.rev, &text);
            }
            versions.renaming = None;
        } else if !field.has_focus() {
            field.request_focus();
        }
        true
    }
}

fn thumbnail(ui: &Ui, rect: Rect, version: &mut Version) {
    let texture = version.thumbnail.get_or_insert_with(|| {
        let behind = Color32::from_rgb(29, 32, 37);
        let image = bev_image::occupancy(&version.scene.frame().occupancy, behind);
        ui.ctx().load_texture("version", image, TextureOptions::LINEAR)
    });
    let unit = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
    ui.painter().image(texture.id(), rect, unit, Color32::WHITE);
}

/// Draws text on one line, cut at the available width.
fn line(ui: &Ui, at: egui::Pos2, room: f32, text: &str, style: egui::TextStyle, color: Color32) {
    let font = style.resolve(ui.style());
    let mut job = egui::text::LayoutJob::simple_singleline(text.to_owned(), font, color);
    job.wrap = egui::text::TextWrapping::truncate_at_width(room.max(20.0));
    let galley = ui.painter().layout_job(job);
    ui.painter().galley(at, galley, color);
}

/// Draws the controls in the header of the list.
pub fn versions_controls(ui: &mut Ui, settings: &mut CompareSettings) {
    let choices = CompareMode::ALL.map(|(mode, name, hint)| (mode, t(name), t(hint)));
    icons::choice(ui, &mut settings.mode, &choices, t("Compare"));
}
