//! The bar at the bottom: what runs and how far it is, the receipt of the last generation, what is
//! under the pointer.

use egui::accesskit::Role;
use egui::{Color32, Rect, Sense, Ui, WidgetInfo, vec2};

use crate::app::command::Command;
use crate::app::live::{Purpose, Running};
use crate::app::state::UiState;
use crate::app::theme;
use crate::generation::job::{GenReport, Stage};

/// What a finished generation did, for a person.
#[derive(Clone, Debug, PartialEq)]
pub struct Receipt {
    /// From the edit to the settled scene, s.
    pub settled_s: f64,
    /// Calls of the network.
    pub network_calls: usize,
    /// Voxels outside the region that changed; 0 is the promise.
    pub untouched_voxels_changed: usize,
    /// Voxels that changed at all.
    pub voxels_changed: usize,
    /// All of the scene was generated.
    pub full: bool,
}

impl Receipt {
    /// From a report.
    pub fn new(report: &GenReport, settled_s: f64, full: bool) -> Self {
        Self {
            settled_s,
            network_calls: report.network_calls,
            untouched_voxels_changed: report.untouched_voxels_changed,
            voxels_changed: report.voxels_changed,
            full,
        }
    }

    /// One line.
    pub fn text(&self) -> String {
        let what = if self.full { "Generated" } else { "Edit settled" };
        let calls = if self.network_calls == 1 { "call" } else { "calls" };
        let mut text = format!(
            "{what} in {:.1} s  ·  {} network {calls}",
            self.settled_s, self.network_calls
        );
        if !self.full {
            text += &format!("  ·  untouched voxels changed: {}", self.untouched_voxels_changed);
        }
        text
    }
}

/// What the bar shows.
pub struct StatusInput<'a> {
    /// The job on its way.
    pub running: Option<&'a Running>,
    /// Now, on the clock of `running`, s.
    pub now_s: f64,
    /// Of the last generation.
    pub receipt: Option<&'a Receipt>,
    /// Generation after each edit is on.
    pub live: bool,
    /// The state shown needs generating.
    pub unsettled: bool,
    /// Something else that runs: opening a file.
    pub busy_with: Option<&'a str>,
    /// Log lines that nobody has seen.
    pub unread: usize,
}

/// Draws the bar.
pub fn status_ui(ui: &mut Ui, input: &StatusInput<'_>, state: &UiState, commands: &mut Vec<Command>) {
    ui.horizontal_centered(|ui| {
        ui.spacing_mut().item_spacing.x = theme::GAP;
        ui.spacing_mut().interact_size.y = 20.0;
        if let Some(running) = input.running {
            progress(ui, running, input.now_s, commands);
        } else if let Some(what) = input.busy_with {
            ui.add(egui::Spinner::new().size(13.0).color(theme::accent()));
            say(ui, what, theme::text());
        } else {
            idle(ui, input);
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let log = egui::RichText::new("Log").color(if input.unread > 0 {
                theme::warn()
            } else {
                theme::text_weak()
            });
            let button = egui::Button::new(log).frame(false).selected(false);
            if ui.add(button).on_hover_text("What happened so far").clicked() {
                commands.push(Command::ToggleLog);
            }
            ui.add(
                egui::Label::new(egui::RichText::new(&state.readout).color(theme::text_weak())).truncate(),
            );
        });
    });
}

fn say(ui: &mut Ui, text: &str, color: Color32) {
    ui.label(egui::RichText::new(text).color(color));
}

fn dot(ui: &mut Ui, color: Color32) {
    let (rect, _) = ui.allocate_exact_size(vec2(10.0, 10.0), Sense::hover());
    ui.painter().circle_filled(rect.center(), 4.0, color);
}

fn idle(ui: &mut Ui, input: &StatusInput<'_>) {
    match input.receipt {
        _ if input.unsettled && !input.live => {
            dot(ui, theme::warn());
            say(ui, "Edited, not generated: live is off", theme::text());
        }
        _ if input.unsettled => {
            dot(ui, theme::warn());
            say(ui, "Edited, not generated", theme::text());
        }
        Some(receipt) => {
            let sound = receipt.full || receipt.untouched_voxels_changed == 0;
            dot(ui, if sound { theme::good() } else { theme::bad() });
            say(ui, &receipt.text(), theme::text());
        }
        None => {
            dot(ui, theme::good());
            say(ui, "Ready", theme::text());
        }
    }
}

fn progress(ui: &mut Ui, running: &Running, now_s: f64, commands: &mut Vec<Command>) {
    let seconds = (now_s - running.submitted_s).max(0.0);
    let (stage, step, steps) = running
        .progress
        .map_or(("Waiting", 0, 0), |(stage, step, steps)| {
            (stage_text(stage), step, steps)
        });
    let (rect, response) = ui.allocate_exact_size(vec2(120.0, 6.0), Sense::hover());
    let done = if steps > 0 {
        (step as f32 / steps as f32).clamp(0.0, 1.0)
    } else {
        0.0
    };
    response.widget_info(|| {
        let mut info = WidgetInfo::labeled(Role::ProgressIndicator, true, "Generation progress");
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
        Purpose::WarmUp => ("Getting ready to edit  ·  ", String::new()),
        _ => ("", format!("  ·  {x:.0} × {y:.0} m")),
    };
    say(
        ui,
        &format!("{what}{stage}{count}  ·  {seconds:.1} s{extent}"),
        theme::text(),
    );
    let cancel = ui.add(egui::Button::new("Cancel").small());
    cancel.widget_info(|| WidgetInfo::labeled(Role::Button, true, "Cancel generation"));
    if cancel.on_hover_text("Ctrl+Backspace").clicked() {
        commands.push(Command::CancelGeneration);
    }
    ui.ctx()
        .request_repaint_after(std::time::Duration::from_millis(250));
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
