//! One finding in a line: its text, and its repairs.

use egui::accesskit::Role;
use egui::{Sense, Ui, WidgetInfo, vec2};

use super::waived::waive_button;
use super::{ChecksInput, Pointed, marks_of};
use crate::command::{Command, TimeCommand, ViewCommand};
use editor::checks::{Finding, Severity};
use language::{t, tf};
use widgets::theme;

/// Draws a finding.
pub(super) fn row(
    ui: &mut Ui,
    finding: &Finding,
    input: &ChecksInput<'_>,
    pointed: &mut Pointed,
    commands: &mut Vec<Command>,
) {
    let says = t(&finding.text);
    let line = egui::Rect::from_min_size(ui.cursor().min, vec2(ui.available_width(), theme::ROW));
    if ui.rect_contains_pointer(line) {
        pointed.hovered = Some(marks_of(ui, finding, input.scene));
    }
    ui.allocate_ui_with_layout(
        vec2(ui.available_width(), theme::ROW),
        egui::Layout::right_to_left(egui::Align::Center),
        |ui| {
            waive_button(ui, finding);
            if let Some(first) = finding.fixes.first() {
                if finding.fixes.len() > 1 {
                    ui.menu_button("…", |ui| {
                        for fix in &finding.fixes {
                            if ui.button(t(fix.label)).clicked() {
                                commands.push(Command::Apply(fix.label, fix.edits.clone()));
                                ui.close();
                            }
                        }
                    })
                    .response
                    .widget_info(|| {
                        WidgetInfo::labeled(Role::Button, true, tf!("Ways to fix: {finding}", finding = says))
                    });
                }
                // The button of a repair that enlarges the map shows its name; the others say Fix.
                let name = match first.enlarges_the_map() {
                    true => t(first.label),
                    false => t("Fix"),
                };
                let fix = ui.add(egui::Button::new(name).small());
                fix.widget_info(|| {
                    WidgetInfo::labeled(Role::Button, true, format!("{}: {says}", t(first.label)))
                });
                if fix.on_hover_text(t(first.label)).clicked() {
                    commands.push(Command::Apply(first.label, first.edits.clone()));
                }
            }
            ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
                sign(ui, finding.severity);
                if input.lasts && finding.time_s.is_none() {
                    ui.weak(t("now")).on_hover_text(t(
                        "Found at the moment shown; there may be others at other moments",
                    ));
                }
                let of_box = finding.box_id.is_some() && finding.box_id == input.selected;
                let chosen = of_box || pointed.clicked.as_ref() == Some(&key(finding));
                let text = egui::RichText::new(says);
                let label = egui::Button::selectable(chosen, text).truncate();
                let response = ui.add(label);
                response.widget_info(|| {
                    let name = format!("{}: {says}", theme::sentence(t(finding.severity.name())));
                    WidgetInfo::selected(Role::Button, true, chosen, name)
                });
                // A text that is shown in full needs no hover text.
                let cut = response
                    .intrinsic_size()
                    .is_some_and(|s| s.x > response.rect.width() + 1.0);
                let response = match cut {
                    true => response.on_hover_text(says),
                    false => response,
                };
                if response.clicked() {
                    if finding.box_id.is_some() {
                        commands.push(Command::Select(finding.box_id));
                    }
                    if let Some(time_s) = finding.time_s {
                        commands.push(Command::Time(TimeCommand::Show(time_s)));
                    }
                    commands.push(Command::View(ViewCommand::FrameAt(finding.where_m)));
                    pointed.clicked = Some(key(finding));
                }
            });
        },
    );
}

/// Key of a finding.
pub(super) fn key(finding: &Finding) -> String {
    format!("{} {:?} {:.1}", finding.check, finding.box_id, finding.where_m)
}

/// Draws the sign of a severity: a disc with a bar for errors, a triangle for warnings, an i for infos. Signs differ in
/// shape, not only in colour.
pub(super) fn sign(ui: &mut Ui, severity: Severity) {
    let (rect, _) = ui.allocate_exact_size(vec2(16.0, 16.0), Sense::hover());
    let (painter, c) = (ui.painter(), rect.center());
    let ink = ui.visuals().window_fill; // dark on bright signs, bright on dark ones
    let bar = |from: egui::Vec2, to: egui::Vec2| {
        painter.line_segment([c + from, c + to], egui::Stroke::new(1.8, ink));
    };
    match severity {
        Severity::Error => {
            painter.circle_filled(c, 6.5, ui.visuals().error_fg_color);
            bar(vec2(-3.4, 0.0), vec2(3.4, 0.0));
        }
        Severity::Info => {
            painter.circle_filled(c, 6.5, ui.visuals().weak_text_color());
            bar(vec2(0.0, -0.6), vec2(0.0, 3.6));
            bar(vec2(0.0, -3.4), vec2(0.0, -2.4));
        }
        Severity::Warning => {
            let corners = vec![c + vec2(0.0, -6.5), c + vec2(7.0, 6.0), c + vec2(-7.0, 6.0)];
            let color = ui.visuals().warn_fg_color;
            painter.add(egui::Shape::convex_polygon(corners, color, egui::Stroke::NONE));
            bar(vec2(0.0, -2.4), vec2(0.0, 1.6));
            bar(vec2(0.0, 3.2), vec2(0.0, 4.6));
        }
    }
}
