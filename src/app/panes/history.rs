//! The undo steps. A click goes to any of them; the menu of a step leaves it out.

use egui::Ui;

use super::id::PaneId;
use super::pane::{Pane, PaneContext, PanePlacement};
use crate::command::Command;
use editor::Document;
use language::{t, tf};
use scene::op::Author;
use widgets::icons::Icon;
use widgets::theme;

/// Height of a line, with the gap.
const HISTORY_ROW: f32 = theme::ROW - 3.0;

/// The pane of the undo steps.
pub struct History;

impl Pane for History {
    fn id(&self) -> PaneId {
        PaneId::HISTORY
    }

    fn title(&self) -> String {
        "History".into()
    }

    fn icon(&self) -> Icon {
        Icon::Undo
    }

    fn place(&self) -> PanePlacement {
        PanePlacement::ColumnAtOnce
    }

    fn column_points(&self) -> f32 {
        266.0
    }

    fn controls(&mut self, ui: &mut Ui, cx: &mut PaneContext<'_>, _commands: &mut Vec<Command>) {
        let text = history_title(cx.document);
        ui.label(egui::RichText::new(text).small().color(theme::text_weak()));
    }

    fn ui(&mut self, ui: &mut Ui, cx: &mut PaneContext<'_>, commands: &mut Vec<Command>) {
        theme::panel_frame().show(ui, |ui| history_ui(ui, cx.document, commands));
    }
}

/// Memory of the history and its limit, for the header of its pane.
pub fn history_title(document: &Document) -> String {
    let mb = |bytes: usize| bytes as f64 / f64::from(1 << 20);
    let (used, limit) = (mb(document.history_bytes()), mb(document.history_limit()));
    tf!(
        "{used} of {limit} MB",
        used = format!("{used:.1}"),
        limit = format!("{limit:.0}")
    )
}

/// Commands of one step.
fn step_menu(ui: &mut Ui, step: usize, can_leave: bool, commands: &mut Vec<Command>) {
    let leave = egui::Button::new(t("Leave this step out"));
    let leave = ui.add_enabled(can_leave, leave).on_hover_text(t(
        "The later steps are applied again, as far as they can be without it",
    ));
    let command = if leave.clicked() {
        Command::LeaveOut(step)
    } else if ui.button(t("Replay the history from its origin")).clicked() {
        Command::ReplayHistory
    } else {
        return;
    };
    commands.push(command);
    ui.close();
}

/// Draws every step; a click goes to its state.
pub fn history_ui(ui: &mut Ui, document: &Document, commands: &mut Vec<Command>) {
    let (steps, at) = (document.history_steps(), document.position());
    ui.spacing_mut().item_spacing.y = HISTORY_ROW - (theme::ROW - 4.0);
    let mut area = egui::ScrollArea::vertical()
        .id_salt("history")
        .auto_shrink([false, false])
        .stick_to_bottom(at + 1 == steps.len());
    // When the state changes, the list scrolls to its line.
    let shown = ui.scope_id().with("history position");
    if ui.data_mut(|d| d.get_temp::<usize>(shown)) != Some(at) {
        ui.data_mut(|d| d.insert_temp(shown, at));
        // The line is centred, but the offset stays within the list, or the list would jump back in the next frame.
        let room = ui.available_height();
        let above = at as f32 * HISTORY_ROW - room / 2.0;
        let most = steps.len() as f32 * HISTORY_ROW - room;
        area = area.vertical_scroll_offset(above.min(most).max(0.0));
    }
    area.show_rows(ui, theme::ROW - 4.0, steps.len(), |ui, range| {
        for i in range {
            let color = match i.cmp(&at) {
                std::cmp::Ordering::Less => theme::text(),
                std::cmp::Ordering::Equal => theme::text_strong(),
                std::cmp::Ordering::Greater => theme::text_weak().gamma_multiply(0.7),
            };
            let size = egui::vec2(ui.available_width(), theme::ROW - 4.0);
            // The id is the number of the step, whatever the scroll offset.
            let row = |ui: &mut Ui| ui.allocate_exact_size(size, egui::Sense::click());
            let (rect, response) = ui.push_id(i, row).inner;
            let step = steps[i];
            let name = tf!("History {number} {step}", number = i, step = t(step.label));
            response.widget_info(|| {
                egui::WidgetInfo::selected(egui::accesskit::Role::Button, true, i == at, &name)
            });
            let fill = match (i == at, response.hovered()) {
                (true, _) => theme::field(),
                (_, true) => theme::field().gamma_multiply(0.6),
                _ => egui::Color32::TRANSPARENT,
            };
            ui.painter().rect_filled(rect, theme::RADIUS, fill);
            let font = egui::TextStyle::Body.resolve(ui.style());
            let mut format = egui::TextFormat::simple(font, color);
            if step.is_left_out {
                format.color = theme::text_weak();
                format.strikethrough = egui::Stroke::new(1.0, theme::text_weak());
            }
            let mut line = egui::text::LayoutJob::single_section(t(step.label).to_owned(), format.clone());
            if let Some(author) = step.author.filter(|author| **author != Author::USER) {
                format.color = theme::text_weak();
                format.strikethrough = egui::Stroke::NONE;
                line.append(t(author.name()), 8.0, format);
            }
            line.wrap = egui::text::TextWrapping::truncate_at_width(rect.width() - 16.0);
            let galley = ui.fonts_mut(|fonts| fonts.layout_job(line));
            let corner = rect.left_center() + egui::vec2(8.0, -galley.size().y / 2.0);
            let cut = galley.elided;
            ui.painter().galley(corner, galley, color);
            let response = match cut {
                true => response.on_hover_text(t(step.label)),
                false => response,
            };
            if response.clicked() {
                commands.push(Command::JumpTo(i));
            }
            response.context_menu(|ui| step_menu(ui, i, step.can_leave_out, commands));
        }
    });
}
