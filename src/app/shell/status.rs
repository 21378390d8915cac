//! The bar at the bottom: the running job and its progress, the receipt of the last generation, and the readout of the
//! place under the pointer.

use egui::accesskit::Role;
use egui::{Color32, Rect, Sense, Ui, WidgetInfo, vec2};

use crate::command::{Command, GenerationCommand, ViewCommand, Window};
use crate::export::ExportProgress;
use crate::panes::id::PaneId;
use crate::panes::pointed::Pointed;
use crate::shell::guard::Pause;
use crate::shell::live::{Purpose, RunningJob};
use editor::checks::SeverityCounts;
use job::{GenReport, Stage};
use language::{t, tf};
use widgets::theme;

/// Time between two updates of the job's duration.
const REPAINT: std::time::Duration = std::time::Duration::from_millis(250);

/// Receipt of a finished generation, for the user.
#[derive(Clone, Debug, PartialEq)]
pub struct Receipt {
    /// Time from the edit to the settled scene, s.
    pub settled_s: f64,
    /// Calls of the network.
    pub network_calls: usize,
    /// Changed voxels outside the region; must be 0.
    pub untouched_voxels_changed: usize,
    /// All changed voxels.
    pub voxels_changed: usize,
    /// True if the whole scene was generated.
    pub full: bool,
}

impl Receipt {
    /// The receipt of a report.
    pub fn new(report: &GenReport, settled_s: f64, full: bool) -> Self {
        Self {
            settled_s,
            network_calls: report.network_calls,
            untouched_voxels_changed: report.untouched_voxels_changed,
            voxels_changed: report.voxels_changed,
            full,
        }
    }

    /// The receipt as one line.
    pub fn text(&self) -> String {
        let seconds = format!("{:.1}", self.settled_s);
        let mut parts = vec![
            match self.full {
                true => tf!("Generated in {seconds} s", seconds = seconds),
                false => tf!("Edit settled in {seconds} s", seconds = seconds),
            },
            match self.network_calls {
                1 => t("1 network call").to_owned(),
                n => tf!("{n} network calls", n = n),
            },
        ];
        if !self.full {
            let changed = self.untouched_voxels_changed;
            parts.push(tf!("untouched voxels changed: {n}", n = changed));
        }
        parts.join("  ·  ")
    }
}

/// Input of the bar.
pub struct StatusInput<'a> {
    /// The running job.
    pub running: Option<&'a RunningJob>,
    /// True if a generation of the whole scene shows a preview.
    pub shows_what_comes: bool,
    /// Present time, on the clock of `running`, s.
    pub now_s: f64,
    /// Receipt of the last generation.
    pub receipt: Option<&'a Receipt>,
    /// True if generation after each edit is on.
    pub live: bool,
    /// True if the state shown needs generation.
    pub unsettled: bool,
    /// Name of other running work, such as opening a file.
    pub busy_with: Option<&'a str>,
    /// Name of the running export, and its progress.
    pub exporting: Option<(&'a str, &'a ExportProgress)>,
    /// Number of unread errors in the log.
    pub unread: usize,
    /// The reason why the last edit is not generated automatically.
    pub paused: Option<&'a Pause>,
    /// True if an edit waits for its generation.
    pub waiting: bool,
    /// True during a drag.
    pub dragging: bool,
    /// Errors and warnings that are not waived; `None` before the first check.
    pub findings: Option<SeverityCounts>,
    /// Hint about the pointer with the tool in hand.
    pub hint: &'a str,
}

/// Draws the bar.
pub fn status_ui(ui: &mut Ui, input: &StatusInput<'_>, pointed: &Pointed, commands: &mut Vec<Command>) {
    ui.horizontal_centered(|ui| {
        ui.spacing_mut().item_spacing.x = theme::GAP;
        ui.spacing_mut().interact_size.y = 20.0;
        // Buttons come before texts that change, so they stay under the pointer.
        if let Some((_, progress)) = input.exporting {
            cancel_export(ui, progress);
        }
        if let Some(running) = input.running {
            progress(ui, running, input, commands);
        } else if let Some(what) = input.busy_with {
            ui.add(egui::Spinner::new().size(13.0).color(theme::accent()));
            say(ui, what, theme::text());
        } else {
            idle(ui, input, commands);
        }
        if let Some((what, progress)) = input.exporting {
            exporting(ui, what, progress);
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let log = egui::RichText::new(t("Log")).color(if input.unread > 0 {
                theme::warn()
            } else {
                theme::text_weak()
            });
            let button = egui::Button::new(log).frame(false).selected(false);
            if ui.add(button).on_hover_text(t("What happened so far")).clicked() {
                commands.push(Command::Toggle(Window::Log));
            }
            if let Some(counts) = input.findings {
                found(ui, counts, commands);
            }
            // First the readout of the place, then the hint; the hint is cut first.
            ui.add(
                egui::Label::new(egui::RichText::new(&pointed.readout).color(theme::text_weak())).truncate(),
            );
            ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
                let text = egui::RichText::new(input.hint).color(theme::text_weak().gamma_multiply(0.85));
                ui.add_space(theme::GAP);
                ui.add(egui::Label::new(text).truncate())
                    .on_hover_text(input.hint);
            });
        });
    });
}

/// The number of errors and warnings; a click opens or closes their list.
fn found(ui: &mut Ui, counts: SeverityCounts, commands: &mut Vec<Command>) {
    let (text, color) = match (counts.errors, counts.errors + counts.warnings) {
        (_, 0) => (t("Checks").to_owned(), theme::text_weak()),
        (errors, 1) => (
            t("1 finding").to_owned(),
            if errors > 0 { theme::bad() } else { theme::warn() },
        ),
        (0, n) => (tf!("{n} findings", n = n), theme::warn()),
        (_, n) => (tf!("{n} findings", n = n), theme::bad()),
    };
    let button = egui::Button::new(egui::RichText::new(text).color(color)).frame(false);
    let hint = tf!(
        "Checks: {findings}",
        findings = crate::panes::checks::in_words(counts)
    );
    let response = ui.add(button).on_hover_text(&hint);
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &hint));
    if response.clicked() {
        commands.push(Command::View(ViewCommand::TogglePane(PaneId::CHECKS)));
    }
}

fn say(ui: &mut Ui, text: &str, color: Color32) {
    ui.label(egui::RichText::new(text).color(color));
}

fn dot(ui: &mut Ui, color: Color32) {
    let (rect, _) = ui.allocate_exact_size(vec2(10.0, 10.0), Sense::hover());
    ui.painter().circle_filled(rect.center(), 4.0, color);
}

fn idle(ui: &mut Ui, input: &StatusInput<'_>, commands: &mut Vec<Command>) {
    if let (true, Some(pause)) = (input.unsettled, input.paused) {
        dot(ui, theme::warn());
        say(ui, &pause.text(), theme::text());
        let generate = ui.add(egui::Button::new(t("Generate it")).small());
        if generate.on_hover_text("Ctrl+Shift+Enter").clicked() {
            commands.push(Command::Generation(GenerationCommand::Generate { full: false }));
        }
        return;
    }
    if input.unsettled && input.waiting {
        dot(ui, theme::warn());
        let why = if input.dragging {
            t("Edited, generated when the drag ends")
        } else {
            t("Edited, generated in a moment")
        };
        say(ui, why, theme::text());
        let drop = ui.add(egui::Button::new(t("Drop")).small());
        drop.widget_info(|| WidgetInfo::labeled(Role::Button, true, t("Drop the edit that waits")));
        if drop
            .on_hover_text(t("This state is not generated; the next edit is"))
            .clicked()
        {
            commands.push(Command::Generation(GenerationCommand::Cancel {
                running: false,
                waiting: true,
            }));
        }
        return;
    }
    match input.receipt {
        _ if input.unsettled && !input.live => {
            dot(ui, theme::warn());
            say(ui, t("Edited, not generated: live is off"), theme::text());
        }
        _ if input.unsettled => {
            dot(ui, theme::warn());
            say(ui, t("Edited, not generated"), theme::text());
        }
        Some(receipt) => {
            let sound = receipt.full || receipt.untouched_voxels_changed == 0;
            dot(ui, if sound { theme::good() } else { theme::bad() });
            say(ui, &receipt.text(), theme::text());
        }
        None => {
            dot(ui, theme::good());
            say(ui, t("Ready"), theme::text());
        }
    }
}

fn exporting(ui: &mut Ui, what: &str, progress: &ExportProgress) {
    ui.separator();
    ui.add(egui::Spinner::new().size(13.0).color(theme::accent()));
    let text = match progress.pictures() {
        Some((done, of)) => tf!(
            "Writing {name}, {done} of {all}",
            name = t(what),
            done = done,
            all = of,
        ),
        None => tf!("Writing {name}", name = t(what)),
    };
    if progress.is_cancelled() {
        return say(ui, t("Cancelling"), theme::text());
    }
    say(ui, &text, theme::text());
    ui.ctx().request_repaint_after(REPAINT);
}

/// The button that cancels the running export.
fn cancel_export(ui: &mut Ui, progress: &ExportProgress) {
    let button = egui::Button::new(t("Cancel writing")).small();
    let cancel = ui.add_enabled(!progress.is_cancelled(), button);
    if cancel.on_hover_text(t("Nothing is written")).clicked() {
        progress.cancel();
    }
}

fn progress(ui: &mut Ui, running: &RunningJob, input: &StatusInput<'_>, commands: &mut Vec<Command>) {
    let seconds = (input.now_s - running.submitted_s).max(0.0);
    let (stage, step, steps) = running
        .progress
        .map_or((t("Waiting"), 0, 0), |(stage, step, steps)| {
            (t(stage_text(stage)), step, steps)
        });
    let (rect, response) = ui.allocate_exact_size(vec2(120.0, 6.0), Sense::hover());
    let done = if steps > 0 {
        (step as f32 / steps as f32).clamp(0.0, 1.0)
    } else {
        0.0
    };
    response.widget_info(|| {
        let mut info = WidgetInfo::labeled(Role::ProgressIndicator, true, t("Generation progress"));
        info.value = Some(f64::from(done));
        info
    });
    ui.painter().rect_filled(rect, 3.0, theme::field());
    let filled = Rect::from_min_size(rect.min, vec2(rect.width() * done, rect.height()));
    ui.painter().rect_filled(filled, 3.0, theme::accent());
    let count = if steps > 0 {
        format!(" {step}/{steps}")
    } else {
        String::new()
    };
    let [x, y] = running.extent_m;
    let (what, extent) = match running.purpose {
        Purpose::WarmUp => (format!("{}  ·  ", t("Getting ready to edit")), String::new()),
        _ => (String::new(), format!("  ·  {x:.0} × {y:.0} m")),
    };
    if running.cancelled {
        // The job stops between two steps of its stage.
        say(ui, t("Cancelling"), theme::text());
        ui.ctx().request_repaint_after(REPAINT);
        return;
    }
    let cancel = ui.add(egui::Button::new(t("Cancel")).small());
    cancel.widget_info(|| WidgetInfo::labeled(Role::Button, true, t("Cancel generation")));
    if cancel.on_hover_text("Ctrl+Backspace").clicked() {
        commands.push(Command::Generation(GenerationCommand::Cancel {
            running: true,
            waiting: false,
        }));
    }
    let all = ui.add(egui::Button::new(t("Cancel all")).small());
    if all
        .on_hover_text(t("What runs and what waits, Ctrl+Shift+Backspace"))
        .clicked()
    {
        commands.push(Command::Generation(GenerationCommand::Cancel {
            running: true,
            waiting: true,
        }));
    }
    if input.shows_what_comes {
        let stop = ui.add(egui::Button::new(t("Keep this")).small());
        if stop.on_hover_text(t("Ends here, with what is shown")).clicked() {
            commands.push(Command::Generation(GenerationCommand::StopHere));
        }
    }
    say(
        ui,
        &format!("{what}{stage}{count}  ·  {seconds:.1} s{extent}"),
        theme::text(),
    );
    ui.ctx().request_repaint_after(REPAINT);
}

fn stage_text(stage: Stage) -> &'static str {
    match stage {
        Stage::Load => "Loading networks",
        Stage::Encode => "Encoding",
        Stage::Invert => "Inverting",
        Stage::Denoise => "Denoising",
        Stage::Decode => "Decoding",
        Stage::Composite => "Compositing",
        Stage::Lidar => "LiDAR",
        Stage::Cameras => "Cameras",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn receipts_say_what_was_promised() {
        let report = GenReport {
            network_calls: 20,
            ..GenReport::default()
        };
        let text = Receipt::new(&report, 1.26, false).text();
        assert_eq!(
            text,
            "Edit settled in 1.3 s  ·  20 network calls  ·  untouched voxels changed: 0"
        );
        let text = Receipt::new(&report, 8.0, true).text();
        assert_eq!(text, "Generated in 8.0 s  ·  20 network calls");
    }
}
