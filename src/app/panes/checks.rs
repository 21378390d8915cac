//! The list of what the quality checks found: a click leads there, a button repairs it.

use egui::accesskit::Role;
use egui::{Sense, Ui, WidgetInfo, vec2};

use std::sync::Arc;

use super::id::PaneId;
use super::pane::{Pane, PaneContext, Place};
use crate::command::{Command, TimeCommand, ViewCommand};
use crate::finding_marks::FindingMarks;
use editor::Edit;
use editor::checks::{Finding, Severity, waive};
use scene::{BoxId, Frame};
use widgets::icons::Icon;
use widgets::theme;

/// What the quality checks found.
pub struct Checks;

impl Pane for Checks {
    fn id(&self) -> PaneId {
        PaneId::CHECKS
    }

    fn title(&self) -> String {
        "Checks".into()
    }

    fn icon(&self) -> Icon {
        Icon::Tick
    }

    fn place(&self) -> Place {
        Place::BelowViews
    }

    fn ui(&mut self, ui: &mut Ui, cx: &mut PaneContext<'_>, commands: &mut Vec<Command>) {
        let settled = cx.document.settled_scene();
        let input = ChecksInput {
            findings: cx.checking.findings().map(|f| f.as_slice()),
            stale: cx.checking.is_stale(settled.rev),
            selected: cx.state.selected,
            frame: settled.frame(),
            lasts: !settled.clip().stands(),
        };
        let marks = theme::panel_frame()
            .show(ui, |ui| checks_ui(ui, &input, commands))
            .inner;
        if cx.state.shown.finding_marks.as_deref() != marks.as_ref() {
            cx.state.shown.finding_marks = marks.map(Arc::new);
            // The views are drawn before this pane or after it.
            ui.ctx().request_repaint();
        }
    }
}

/// What the pane shows.
pub struct ChecksInput<'a> {
    /// The newest findings, errors first; `None` before the first check is done.
    pub findings: Option<&'a [Finding]>,
    /// They belong to an earlier state of the scene.
    pub stale: bool,
    /// The chosen box.
    pub selected: Option<BoxId>,
    /// What the findings are about; it holds the waivers.
    pub frame: &'a Frame,
    /// Things move in the scene: most findings are of the moment shown alone.
    pub lasts: bool,
}

/// What the title of the waived findings takes at the bottom, and what they take unfolded, points.
const WAIVED_TITLE: f32 = 30.0;
const WAIVED_LIST: f32 = 94.0;

/// Draws the pane. Returns the marks of the finding under the pointer, else of the one that was clicked last.
pub fn checks_ui(ui: &mut Ui, input: &ChecksInput<'_>, commands: &mut Vec<Command>) -> Option<FindingMarks> {
    let mut pointed = Pointed {
        clicked: ui.data(|d| d.get_temp(clicked_id())).unwrap_or_default(),
        hovered: None,
    };
    list_ui(ui, input, &mut pointed, commands);
    let clicked = |f: &&Finding| Some(key(f)) == pointed.clicked;
    let marks = pointed
        .hovered
        .or_else(|| input.findings?.iter().find(clicked).map(FindingMarks::by));
    ui.data_mut(|d| d.insert_temp(clicked_id(), pointed.clicked));
    marks
}

/// Which finding the user points at.
struct Pointed {
    clicked: Option<String>,
    hovered: Option<FindingMarks>,
}

fn clicked_id() -> egui::Id {
    egui::Id::unique("finding clicked last")
}

fn list_ui(ui: &mut Ui, input: &ChecksInput<'_>, pointed: &mut Pointed, commands: &mut Vec<Command>) {
    let Some(findings) = input.findings else {
        ui.horizontal(|ui| {
            ui.spinner();
            ui.weak("Checking the scene…");
        });
        return;
    };
    let (open, waived): (Vec<&Finding>, Vec<&Finding>) =
        findings.iter().partition(|f| waive::of(input.frame, f).is_none());
    if open.is_empty() {
        ui.horizontal(|ui| {
            let (dot, _) = ui.allocate_exact_size(egui::vec2(12.0, 12.0), egui::Sense::hover());
            ui.painter()
                .circle_filled(dot.center(), 4.0, widgets::theme::good());
            ui.label(match waived.len() {
                0 => "All is well: no check found anything.",
                _ => "All is well, but for what was waived.",
            });
        });
        ui.weak("Checked while you work: boxes, occupancy, roads, lanes, what cameras and LiDAR see.");
        waived_ui(ui, &waived, input, commands);
        return;
    }
    ui.horizontal(|ui| {
        ui.label(summary(open.iter().copied()));
        if input.stale {
            ui.spinner();
        }
        let fixable = open.iter().filter(|f| !f.fixes.is_empty()).count();
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
    reason_ui(ui, &open, commands);
    let row_height = theme::ROW;
    let unfolded = ui.data(|d| d.get_temp::<bool>(waived_unfolded()).unwrap_or_default());
    let below = match (waived.is_empty(), unfolded) {
        (true, _) => 0.0,
        (false, false) => WAIVED_TITLE,
        (false, true) => WAIVED_TITLE + WAIVED_LIST,
    };
    let height = (ui.available_height() - below).max(3.0 * row_height);
    egui::ScrollArea::vertical()
        .auto_shrink([false, false])
        .max_height(height)
        .show_rows(ui, row_height, open.len(), |ui, range| {
            for (i, finding) in range.clone().zip(&open[range]) {
                ui.push_id(i, |ui| row(ui, finding, input, pointed, commands));
            }
        });
    waived_ui(ui, &waived, input, commands);
}

/// `2 errors, 1 warning`
pub fn summary<'a>(findings: impl IntoIterator<Item = &'a Finding>) -> String {
    let severities: Vec<Severity> = findings.into_iter().map(|f| f.severity).collect();
    let errors = severities.iter().filter(|s| **s == Severity::Error).count();
    let count = |n: usize, what: &str| format!("{n} {what}{}", if n == 1 { "" } else { "s" });
    match (errors, severities.len() - errors) {
        (0, warnings) => count(warnings, "warning"),
        (errors, 0) => count(errors, "error"),
        (errors, warnings) => format!("{}, {}", count(errors, "error"), count(warnings, "warning")),
    }
}

fn row(
    ui: &mut Ui,
    finding: &Finding,
    input: &ChecksInput<'_>,
    pointed: &mut Pointed,
    commands: &mut Vec<Command>,
) {
    let line = egui::Rect::from_min_size(ui.cursor().min, vec2(ui.available_width(), theme::ROW));
    if ui.rect_contains_pointer(line) {
        pointed.hovered = Some(FindingMarks::by(finding));
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
                if input.lasts && finding.time_s.is_none() {
                    ui.weak("now")
                        .on_hover_text("Found at the moment shown; there may be others at other moments");
                }
                let of_box = finding.box_id.is_some() && finding.box_id == input.selected;
                let chosen = of_box || pointed.clicked.as_ref() == Some(&key(finding));
                let text = egui::RichText::new(&finding.text);
                let label = egui::Button::selectable(chosen, text).truncate();
                let response = ui.add(label);
                response.widget_info(|| {
                    let name = format!("{}: {}", theme::sentence(finding.severity.name()), finding.text);
                    WidgetInfo::selected(Role::Button, true, chosen, name)
                });
                // Read already where it fits.
                let cut = response
                    .intrinsic_size()
                    .is_some_and(|s| s.x > response.rect.width() + 1.0);
                let response = match cut {
                    true => response.on_hover_text(&finding.text),
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

/// Where the reason is kept while it is typed: check and box or place, and the text.
fn typing() -> egui::Id {
    egui::Id::unique("reason of a waiver")
}

type Typing = Option<(String, String)>;

/// Tells findings apart.
fn key(finding: &Finding) -> String {
    format!("{} {:?} {:.1}", finding.check, finding.box_id, finding.where_m)
}

/// The button that begins a waiver.
fn waive_button(ui: &mut Ui, finding: &Finding) {
    let button = ui.add(egui::Button::new("Waive").small());
    button.widget_info(|| WidgetInfo::labeled(Role::Button, true, format!("Waive: {}", finding.text)));
    if button.on_hover_text("Let it stand, with a reason").clicked() {
        let begun: Typing = Some((key(finding), String::new()));
        ui.data_mut(|d| d.insert_temp(typing(), begun));
    }
}

/// The field for the reason of the finding that is being waived.
fn reason_ui(ui: &mut Ui, open: &[&Finding], commands: &mut Vec<Command>) {
    let Some((of, mut text)) = ui.data(|d| d.get_temp::<Typing>(typing())).flatten() else {
        return;
    };
    let Some(finding) = open.iter().find(|f| key(f) == of) else {
        return;
    };
    let mut done = false;
    ui.add(egui::Label::new(&finding.text).truncate());
    ui.horizontal(|ui| {
        let field = egui::TextEdit::singleline(&mut text)
            .hint_text("Why it may stay")
            .desired_width((ui.available_width() - 150.0).max(120.0));
        let field = ui.add(field).accessible_name("Reason of the waiver");
        if text.is_empty() && !field.has_focus() && !field.lost_focus() {
            field.request_focus();
        }
        let entered = field.lost_focus() && ui.input(|i| i.key_pressed(egui::Key::Enter));
        let ready = !text.trim().is_empty();
        let clicked = ui.add_enabled(ready, egui::Button::new("Let it stand")).clicked();
        if ready && (clicked || entered) {
            commands.push(Command::Apply(
                "Waive a finding",
                vec![Edit::Waive {
                    check: finding.check.into(),
                    box_id: finding.box_id,
                    where_m: finding.where_m,
                    reason: text.clone(),
                }],
            ));
            done = true;
        }
        done |= ui.button("Cancel").clicked() || ui.input(|i| i.key_pressed(egui::Key::Escape));
    });
    let left: Typing = (!done).then_some((of, text));
    ui.data_mut(|d| d.insert_temp(typing(), left));
}

/// What was waived, with the reasons, and the way back.
fn waived_ui(ui: &mut Ui, waived: &[&Finding], input: &ChecksInput<'_>, commands: &mut Vec<Command>) {
    if waived.is_empty() {
        return;
    }
    ui.add_space(4.0);
    let title = format!("{} waived", waived.len());
    let list = egui::CollapsingHeader::new(title)
        .id_salt("waived findings")
        .default_open(false)
        .show(ui, |ui| {
            egui::ScrollArea::vertical()
                .id_salt("waived")
                .max_height(WAIVED_LIST)
                .show(ui, |ui| {
                    for finding in waived {
                        let Some(waiver) = waive::of(input.frame, finding) else {
                            continue;
                        };
                        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                            let back = ui.add(egui::Button::new("Take back").small());
                            back.widget_info(|| {
                                WidgetInfo::labeled(
                                    Role::Button,
                                    true,
                                    format!("Take back: {}", finding.text),
                                )
                            });
                            if back.clicked() {
                                commands.push(Command::Apply(
                                    "Take a waiver back",
                                    vec![Edit::Unwaive {
                                        check: waiver.check.to_string(),
                                        box_id: waiver.box_id,
                                        where_m: waiver.where_m,
                                    }],
                                ));
                            }
                            ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
                                let text = format!("{}  ·  {}", finding.text, waiver.reason);
                                let label =
                                    egui::Label::new(egui::RichText::new(&text).color(theme::text_weak()));
                                ui.add(label.truncate()).on_hover_text(&text);
                            });
                        });
                    }
                });
        });
    ui.data_mut(|d| d.insert_temp(waived_unfolded(), list.fully_open()));
}

fn waived_unfolded() -> egui::Id {
    egui::Id::unique("waived findings are unfolded")
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
            time_s: None,
            cells: Vec::new(),
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
