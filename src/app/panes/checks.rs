//! The list of the findings of the quality checks. A click goes to a finding, a button repairs it.

mod row;
mod triage;
mod waived;

use std::sync::Arc;

use egui::accesskit::Role;
use egui::{Ui, WidgetInfo, vec2};

use super::id::PaneId;
use super::pane::{Pane, PaneContext, PanePlacement};
use crate::command::{Command, RepairCommand};
use crate::finding_marks::FindingMarks;
use crate::state::called;
use editor::checks::{Finding, Severity, SeverityCounts, waive};
use language::{t, tf};
use row::{key, row, sign};
use scene::{BoxId, Frame, Scene};
use triage::{Grouping, Triage, TriageRow};
use waived::{reason_ui, waived_ui};
use widgets::icons::{self, Icon};
use widgets::theme;

/// The pane of the quality checks.
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

    fn place(&self) -> PanePlacement {
        PanePlacement::BelowViews
    }

    fn ui(&mut self, ui: &mut Ui, cx: &mut PaneContext<'_>, commands: &mut Vec<Command>) {
        let settled = cx.document.settled_scene();
        let input = ChecksInput {
            findings: cx.checking.findings().map(|f| f.as_slice()),
            stale: cx.checking.is_stale(settled.rev),
            selected: cx.state.selected,
            scene: settled,
            lasts: !settled.clip().stands(),
        };
        let marks = theme::panel_frame()
            .show(ui, |ui| checks_ui(ui, &input, commands))
            .inner;
        if cx.state.shown.finding_marks.as_deref() != marks.as_ref() {
            cx.state.shown.finding_marks = marks.map(Arc::new);
            // Some views are drawn before this pane, so another frame is needed.
            ui.ctx().request_repaint();
        }
    }
}

/// Input of the pane.
pub struct ChecksInput<'a> {
    /// The newest findings, errors first; `None` before the first check is done.
    pub findings: Option<&'a [Finding]>,
    /// True if the findings belong to an earlier state of the scene.
    pub stale: bool,
    /// The chosen box.
    pub selected: Option<BoxId>,
    /// The scene that was checked; its frame holds the waivers.
    pub scene: &'a Scene,
    /// True if the scene is a clip: most findings concern only the moment shown.
    pub lasts: bool,
}

impl ChecksInput<'_> {
    fn frame(&self) -> &Frame {
        self.scene.frame()
    }
}

/// Draws the pane. Returns the marks of the finding under the pointer, else of the one that was clicked last.
pub fn checks_ui(ui: &mut Ui, input: &ChecksInput<'_>, commands: &mut Vec<Command>) -> Option<FindingMarks> {
    let mut pointed = Pointed {
        clicked: ui.data(|d| d.get_temp(clicked_id())).unwrap_or_default(),
        hovered: None,
    };
    list_ui(ui, input, &mut pointed, commands);
    let clicked = |f: &&Finding| Some(key(f)) == pointed.clicked;
    let marks = pointed.hovered.or_else(|| {
        input
            .findings?
            .iter()
            .find(clicked)
            .map(|f| marks_of(ui, f, input.scene))
    });
    ui.data_mut(|d| d.insert_temp(clicked_id(), pointed.clicked));
    marks
}

/// The marks of a finding, computed once per state of the scene.
pub(super) fn marks_of(ui: &Ui, finding: &Finding, scene: &Scene) -> FindingMarks {
    type Kept = (String, scene::SceneRev, FindingMarks);
    let (id, of) = (egui::Id::unique("marks of a finding"), key(finding));
    let kept: Option<Kept> = ui.data(|d| d.get_temp(id));
    match kept {
        Some((kept, rev, marks)) if kept == of && rev == scene.rev => marks,
        _ => {
            let marks = FindingMarks::by(finding, scene);
            ui.data_mut(|d| d.insert_temp::<Kept>(id, (of, scene.rev, marks.clone())));
            marks
        }
    }
}

/// The finding under the pointer, and the one clicked last.
pub(super) struct Pointed {
    clicked: Option<String>,
    hovered: Option<FindingMarks>,
}

/// Forgets the clicked finding and a waiver that is being typed, because another scene is shown.
pub(crate) fn forget(ctx: &egui::Context) {
    ctx.data_mut(|d| d.remove_temp::<Option<String>>(clicked_id()));
    waived::forget(ctx);
}

fn clicked_id() -> egui::Id {
    egui::Id::unique("finding clicked last")
}

fn list_ui(ui: &mut Ui, input: &ChecksInput<'_>, pointed: &mut Pointed, commands: &mut Vec<Command>) {
    let Some(findings) = input.findings else {
        ui.horizontal(|ui| {
            ui.spinner();
            ui.weak(t("Checking the scene…"));
        });
        return;
    };
    let (open, waived): (Vec<&Finding>, Vec<&Finding>) = findings
        .iter()
        .partition(|f| waive::of(input.frame(), f).is_none());
    let counts = SeverityCounts::from_findings(open.iter().copied());
    if open.is_empty() {
        all_is_well(ui, counts, &waived);
        ui.weak(t(
            "Checked while you work: boxes, occupancy, roads, lanes, what cameras and LiDAR see.",
        ));
        waived_ui(ui, &waived, input, commands);
        return;
    }
    let id = egui::Id::unique("triage of the findings");
    let mut triage: Triage = ui.data(|d| d.get_temp(id)).unwrap_or_default();
    if counts.errors + counts.warnings == 0 {
        all_is_well(ui, counts, &waived);
    }
    bar(ui, input, &open, &mut triage, commands);
    ui.separator();
    reason_ui(ui, &open, commands);
    let name = |id: BoxId| match input.frame().boxes.get(&id) {
        Some(b) => format!("{} {}", called(b), id.0),
        None => tf!("box {number}", number = id.0),
    };
    let lines = triage.lines(&open, &name);
    if lines.is_empty() {
        ui.weak(t("None of these: the filter leaves all of them out."));
    }
    let height = (ui.available_height() - waived::height(ui, &waived)).max(3.0 * theme::ROW);
    egui::ScrollArea::vertical()
        .auto_shrink([false, false])
        .max_height(height)
        .show_rows(ui, theme::ROW, lines.len(), |ui, range| {
            for (i, line) in range.clone().zip(&lines[range]) {
                ui.push_id(i, |ui| match line {
                    TriageRow::Finding(i) => row(ui, open[*i], input, pointed, commands),
                    TriageRow::Group { .. } => group_row(ui, line, &open, input, &mut triage, commands),
                });
            }
        });
    ui.data_mut(|d| d.insert_temp(id, triage));
    waived_ui(ui, &waived, input, commands);
}

fn all_is_well(ui: &mut Ui, counts: SeverityCounts, waived: &[&Finding]) {
    ui.horizontal(|ui| {
        let (dot, _) = ui.allocate_exact_size(vec2(12.0, 12.0), egui::Sense::hover());
        ui.painter().circle_filled(dot.center(), 4.0, theme::good());
        ui.label(match (counts.infos, waived.len()) {
            (0, 0) => t("All is well: no check found anything."),
            (0, _) => t("All is well, but for what was waived."),
            _ => t("All is well. Worth knowing:"),
        });
    });
}

/// The bar above the list: severities, grouping, filter, and the button that repairs all findings.
fn bar(
    ui: &mut Ui,
    input: &ChecksInput<'_>,
    open: &[&Finding],
    triage: &mut Triage,
    commands: &mut Vec<Command>,
) {
    let counts = SeverityCounts::from_findings(open.iter().copied());
    ui.horizontal(|ui| {
        for (severity, hidden) in Severity::ALL.into_iter().zip(&mut triage.hidden) {
            let n = counts.count(severity);
            if n > 0 {
                severity_button(ui, severity, n, hidden);
            }
        }
        let groupings = Grouping::ALL.map(|(grouping, name, hint)| (grouping, t(name), t(hint)));
        icons::segments(ui, &mut triage.grouping, &groupings);
        if input.stale {
            ui.spinner();
        }
        let fixable = open.iter().filter(|f| f.first_fix().is_some()).count();
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let button = egui::Button::new(tf!("Fix all ({n})…", n = fixable));
            let response = ui.add_enabled(fixable > 0 && !input.stale, button);
            if response
                .on_hover_text(t("Lists first what would be repaired, and how"))
                .clicked()
            {
                commands.push(Command::Repair(RepairCommand::PlanAll));
            }
            let field = egui::TextEdit::singleline(&mut triage.words)
                .id(egui::Id::unique("filter of the findings"))
                .hint_text(t("Filter"))
                .desired_width(ui.available_width().clamp(40.0, 130.0));
            ui.add(field).accessible_name(t("Filter the findings"));
        });
    });
}

/// The number of findings of a severity; a click removes them from the list, or adds them.
fn severity_button(ui: &mut Ui, severity: Severity, n: usize, hidden: &mut bool) {
    let text = words(severity, n);
    let color = if *hidden {
        theme::text_weak().gamma_multiply(0.6)
    } else {
        theme::text()
    };
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 3.0;
        sign(ui, severity);
        let button = egui::Button::selectable(!*hidden, egui::RichText::new(&text).color(color));
        let response = ui.add(button).on_hover_text(t("Listed, or left out"));
        response.widget_info(|| {
            WidgetInfo::selected(
                Role::CheckBox,
                true,
                !*hidden,
                tf!("List {findings}", findings = text),
            )
        });
        if response.clicked() {
            *hidden ^= true;
        }
    });
}

fn group_row(
    ui: &mut Ui,
    line: &TriageRow,
    open: &[&Finding],
    input: &ChecksInput<'_>,
    triage: &mut Triage,
    commands: &mut Vec<Command>,
) {
    let TriageRow::Group {
        title,
        of,
        worst,
        folded,
    } = line
    else {
        return;
    };
    let fixable: Vec<usize> = of
        .iter()
        .copied()
        .filter(|i| open[*i].first_fix().is_some())
        .collect();
    ui.allocate_ui_with_layout(
        vec2(ui.available_width(), theme::ROW),
        egui::Layout::right_to_left(egui::Align::Center),
        |ui| {
            if fixable.len() > 1 {
                let button = egui::Button::new(tf!("Fix {n}…", n = fixable.len())).small();
                let response = ui.add_enabled(!input.stale, button);
                let name = tf!("Fix {n}: {what}", n = fixable.len(), what = t(title));
                response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &name));
                if response
                    .on_hover_text(t("Lists first what would be repaired, and how"))
                    .clicked()
                {
                    let these: Vec<Finding> = fixable.iter().map(|i| open[*i].clone()).collect();
                    commands.push(Command::Repair(RepairCommand::PlanThese(these)));
                }
            }
            ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
                sign(ui, *worst);
                fold_sign(ui, *folded);
                let text =
                    egui::RichText::new(format!("{}  {}", theme::sentence(t(title)), of.len())).strong();
                let response = ui.add(egui::Button::new(text).frame(false).truncate());
                let name = format!("{}, {}", t(title), of.len());
                response.widget_info(|| WidgetInfo::selected(Role::Button, true, !folded, &name));
                if response.clicked() && !triage.turned.remove(title) {
                    triage.turned.insert(title.clone());
                }
            });
        },
    );
}

/// A triangle: to the right for a folded group, else down.
fn fold_sign(ui: &mut Ui, folded: bool) {
    let (rect, _) = ui.allocate_exact_size(vec2(10.0, 10.0), egui::Sense::hover());
    let turn = match folded {
        true => egui::emath::Rot2::IDENTITY,
        false => egui::emath::Rot2::from_angle(std::f32::consts::FRAC_PI_2),
    };
    let corners = [vec2(-2.5, -4.0), vec2(3.5, 0.0), vec2(-2.5, 4.0)].map(|v| rect.center() + turn * v);
    let shape = egui::Shape::convex_polygon(corners.to_vec(), theme::text_weak(), egui::Stroke::NONE);
    ui.painter().add(shape);
}

/// Text such as `2 errors`, `1 warning`, `3 infos`.
fn words(severity: Severity, n: usize) -> String {
    match (severity, n) {
        (Severity::Info, _) => tf!("{n} info", n = n),
        (Severity::Warning, 1) => tf!("{n} warning", n = n),
        (Severity::Warning, _) => tf!("{n} warnings", n = n),
        (Severity::Error, 1) => tf!("{n} error", n = n),
        (Severity::Error, _) => tf!("{n} errors", n = n),
    }
}

/// Text such as `2 errors, 1 warning`.
pub fn in_words(counts: SeverityCounts) -> String {
    let some = Severity::ALL.into_iter().filter(|s| counts.count(*s) > 0);
    let all: Vec<String> = some.map(|s| words(s, counts.count(s))).collect();
    match all.is_empty() {
        true => t("no finding").into(),
        false => all.join(", "),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn summaries_count() {
        let of = |errors, warnings, infos| {
            in_words(SeverityCounts {
                errors,
                warnings,
                infos,
            })
        };
        assert_eq!(of(1, 0, 0), "1 error");
        assert_eq!(of(2, 1, 3), "2 errors, 1 warning, 3 info");
        assert_eq!(of(0, 12, 0), "12 warnings");
        assert_eq!(of(0, 0, 0), "no finding");
    }
}
