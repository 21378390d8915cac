//! The list of what the quality checks found: a click leads there, a button repairs it.

use egui::accesskit::Role;
use egui::{Sense, Ui, WidgetInfo, pos2, vec2};

use crate::app::command::Command;
use crate::app::theme;
use crate::editor::checks::{Finding, Severity};
use crate::scene::BoxId;

/// What the panel shows.
pub struct ChecksInput<'a> {
    /// The newest findings, errors first; `None` before the first check is done.
    pub findings: Option<&'a [Finding]>,
    /// They belong to an earlier state of the scene.
    pub stale: bool,
    /// The chosen box.
    pub selected: Option<BoxId>,
}

/// Draws the panel in a window of its own.
pub fn checks_window(ui: &Ui, input: &ChecksInput<'_>, open: &mut bool, commands: &mut Vec<Command>) {
    egui::Window::new("Checks")
        .id(egui::Id::unique("checks"))
        .open(open)
        .default_pos(pos2(360.0, 160.0))
        .default_size(vec2(460.0, 300.0))
        .show(ui.ctx(), |ui| checks_ui(ui, input, commands));
}

/// Draws the panel.
pub fn checks_ui(ui: &mut Ui, input: &ChecksInput<'_>, commands: &mut Vec<Command>) {
    let Some(findings) = input.findings else {
        ui.horizontal(|ui| {
            ui.spinner();
            ui.weak("Checking the scene…");
        });
        return;
    };
    if findings.is_empty() {
        ui.horizontal(|ui| {
            let (dot, _) = ui.allocate_exact_size(egui::vec2(12.0, 12.0), egui::Sense::hover());
            ui.painter()
                .circle_filled(dot.center(), 4.0, crate::app::theme::good());
            ui.label("All is well: no check found anything.");
        });
        ui.weak("Checked while you work: boxes, occupancy, roads, lanes, what cameras and LiDAR see.");
        return;
    }
    ui.horizontal(|ui| {
        ui.label(summary(findings));
        if input.stale {
            ui.spinner();
        }
        let fixable = findings.iter().filter(|f| !f.fixes.is_empty()).count();
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let button = egui::Button::new(format!("Fix all ({fixable})"));
            let response = ui.add_enabled(fixable > 0 && !input.stale, button);
            if response
                .on_hover_text("Repairs all that can be repaired, as one step to undo")
                .clicked()
            {
                commands.push(Command::FixAll);
            }
        });
    });
    ui.separator();
    let row_height = theme::ROW;
    egui::ScrollArea::vertical()
        .auto_shrink([false, false])
        .show_rows(ui, row_height, findings.len(), |ui, range| {
            for (i, finding) in range.clone().zip(&findings[range]) {
                ui.push_id(i, |ui| row(ui, finding, input, commands));
            }
        });
}

/// `2 errors, 1 warning`
pub fn summary(findings: &[Finding]) -> String {
    let errors = findings.iter().filter(|f| f.severity == Severity::Error).count();
    let count = |n: usize, what: &str| format!("{n} {what}{}", if n == 1 { "" } else { "s" });
    match (errors, findings.len() - errors) {
        (0, warnings) => count(warnings, "warning"),
        (errors, 0) => count(errors, "error"),
        (errors, warnings) => format!("{}, {}", count(errors, "error"), count(warnings, "warning")),
    }
}

fn row(ui: &mut Ui, finding: &Finding, input: &ChecksInput<'_>, commands: &mut Vec<Command>) {
    ui.allocate_ui_with_layout(
        vec2(ui.available_width(), theme::ROW),
        egui::Layout::right_to_left(egui::Align::Center),
        |ui| {
            if let Some(first) = finding.fixes.first() {
                if finding.fixes.len() > 1 {
                    ui.menu_button("…", |ui| {
                        for fix in &finding.fixes {
                            if ui.button(fix.label).clicked() {
                                commands.push(Command::Apply(fix.label, fix.edits.clone()));
                                ui.close();
                            }
                        }
                    })
                    .response
                    .widget_info(|| {
                        WidgetInfo::labeled(Role::Button, true, format!("Ways to fix: {}", finding.text))
                    });
                }
                let fix = ui.add(egui::Button::new("Fix").small());
                fix.widget_info(|| {
                    WidgetInfo::labeled(Role::Button, true, format!("{}: {}", first.label, finding.text))
                });
                if fix.on_hover_text(first.label).clicked() {
                    commands.push(Command::Apply(first.label, first.edits.clone()));
                }
            }
            ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
                sign(ui, finding.severity);
                let chosen = finding.box_id.is_some() && finding.box_id == input.selected;
                let text = egui::RichText::new(&finding.text);
                let label = egui::Button::selectable(chosen, text).truncate();
                let response = ui.add(label);
                response.widget_info(|| {
                    let name = format!("{}: {}", theme::sentence(finding.severity.name()), finding.text);
                    WidgetInfo::selected(Role::Button, true, chosen, name)
                });
                if response.on_hover_text(&finding.text).clicked() {
                    if finding.box_id.is_some() {
                        commands.push(Command::Select(finding.box_id));
                    }
                    commands.push(Command::FrameAt(finding.where_m));
                }
            });
        },
    );
}

/// A disc with a bar through it for errors, a triangle for warnings: told apart by shape, not only by colour.
fn sign(ui: &mut Ui, severity: Severity) {
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
        Severity::Warning => {
            let corners = vec![c + vec2(0.0, -6.5), c + vec2(7.0, 6.0), c + vec2(-7.0, 6.0)];
            let color = ui.visuals().warn_fg_color;
            painter.add(egui::Shape::convex_polygon(corners, color, egui::Stroke::NONE));
            bar(vec2(0.0, -2.4), vec2(0.0, 1.6));
            bar(vec2(0.0, 3.2), vec2(0.0, 4.6));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn summaries_count() {
        let finding = |severity| Finding {
            check: "unsound",
            severity,
            where_m: glam::DVec3::ZERO,
            box_id: None,
            text: "x".into(),
            fixes: Vec::new(),
        };
        let of = |errors: usize, warnings: usize| {
            let mut all = vec![finding(Severity::Error); errors];
            all.extend(vec![finding(Severity::Warning); warnings]);
            summary(&all)
        };
        assert_eq!(of(1, 0), "1 error");
        assert_eq!(of(2, 1), "2 errors, 1 warning");
        assert_eq!(of(0, 12), "12 warnings");
    }
}
