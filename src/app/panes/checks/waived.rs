//! Waived findings, and the field that waives one.

use egui::Ui;
use egui::WidgetInfo;
use egui::accesskit::Role;

use super::ChecksInput;
use super::row::key;
use crate::command::Command;
use editor::Edit;
use editor::checks::{Finding, waive};
use language::{t, tf};
use widgets::theme;

/// Height of the title of the waived findings, and of their list when it is unfolded, points.
const WAIVED_TITLE: f32 = 30.0;
const WAIVED_LIST: f32 = 94.0;

/// Height of the waived findings, points.
pub(super) fn height(ui: &Ui, waived: &[&Finding]) -> f32 {
    let unfolded = ui.data(|d| d.get_temp::<bool>(waived_unfolded()).unwrap_or_default());
    match (waived.is_empty(), unfolded) {
        (true, _) => 0.0,
        (false, false) => WAIVED_TITLE,
        (false, true) => WAIVED_TITLE + WAIVED_LIST,
    }
}

/// Id of the waiver that is being typed: key of the finding, and text of the reason.
fn typing() -> egui::Id {
    egui::Id::unique("reason of a waiver")
}

/// Id of the waiver whose field has taken the focus.
fn asked() -> egui::Id {
    egui::Id::unique("reason that was asked for")
}

type Typing = Option<(String, String)>;

/// Forgets a waiver that is being typed.
pub(super) fn forget(ctx: &egui::Context) {
    ctx.data_mut(|d| {
        d.remove_temp::<Typing>(typing());
        d.remove_temp::<String>(asked());
    });
}

/// The button that begins a waiver.
pub(super) fn waive_button(ui: &mut Ui, finding: &Finding) {
    let button = ui.add(egui::Button::new(t("Waive")).small());
    button.widget_info(|| {
        WidgetInfo::labeled(
            Role::Button,
            true,
            tf!("Waive: {finding}", finding = t(&finding.text)),
        )
    });
    if button.on_hover_text(t("Let it stand, with a reason")).clicked() {
        let begun: Typing = Some((key(finding), String::new()));
        ui.data_mut(|d| d.insert_temp(typing(), begun));
    }
}

/// The field for the reason of the finding that is being waived.
pub(super) fn reason_ui(ui: &mut Ui, open: &[&Finding], commands: &mut Vec<Command>) {
    let Some((of, mut text)) = ui.data(|d| d.get_temp::<Typing>(typing())).flatten() else {
        return;
    };
    let Some(finding) = open.iter().find(|f| key(f) == of) else {
        return;
    };
    let mut done = false;
    ui.add(egui::Label::new(t(&finding.text)).truncate());
    ui.horizontal(|ui| {
        let field = egui::TextEdit::singleline(&mut text)
            .hint_text(t("Why it may stay"))
            .desired_width((ui.available_width() - 150.0).max(120.0));
        let field = ui.add(field).accessible_name(t("Reason of the waiver"));
        // The field takes the focus once, when the waiver begins.
        let asked = asked();
        if ui.data(|d| d.get_temp::<String>(asked)).as_ref() != Some(&of) {
            ui.data_mut(|d| d.insert_temp(asked, of.clone()));
            field.request_focus();
        }
        let entered = field.lost_focus() && ui.input(|i| i.key_pressed(egui::Key::Enter));
        let ready = !text.trim().is_empty();
        let clicked = ui
            .add_enabled(ready, egui::Button::new(t("Let it stand")))
            .clicked();
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
        done |= ui.button(t("Cancel")).clicked() || ui.input(|i| i.key_pressed(egui::Key::Escape));
    });
    if done {
        ui.data_mut(|d| d.remove_temp::<String>(asked()));
    }
    let left: Typing = (!done).then_some((of, text));
    ui.data_mut(|d| d.insert_temp(typing(), left));
}

/// Draws the waived findings with their reasons, each with a button that takes the waiver back.
pub(super) fn waived_ui(
    ui: &mut Ui,
    waived: &[&Finding],
    input: &ChecksInput<'_>,
    commands: &mut Vec<Command>,
) {
    if waived.is_empty() {
        return;
    }
    ui.add_space(4.0);
    let title = tf!("{n} waived", n = waived.len());
    let list = egui::CollapsingHeader::new(title)
        .id_salt("waived findings")
        .default_open(false)
        .show(ui, |ui| {
            egui::ScrollArea::vertical()
                .id_salt("waived")
                .max_height(WAIVED_LIST)
                .show(ui, |ui| {
                    for finding in waived {
                        let Some(waiver) = waive::of(input.frame(), finding) else {
                            continue;
                        };
                        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                            let back = ui.add(egui::Button::new(t("Take back")).small());
                            back.widget_info(|| {
                                WidgetInfo::labeled(
                                    Role::Button,
                                    true,
                                    tf!("Take back: {finding}", finding = t(&finding.text)),
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
                                let text = format!("{}  ·  {}", t(&finding.text), waiver.reason);
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
