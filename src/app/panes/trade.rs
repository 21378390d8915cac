//! Speed and accuracy: the slider of measured presets, their plot, the receipt of the last edit, the parts computed for
//! it, and the stability since the start.

use egui::{Align, Label, Layout, RichText, Slider, Ui, vec2};

use super::id::PaneId;
use super::pane::{Pane, PaneContext};
use crate::command::{Command, GenerationCommand};
use crate::shell::tuning::{LastEdit, Measuring, Tuning, predicted};
use crate::trade_plot::front_plot;
use calibration::figures::{self, seconds};
use calibration::machine::{Load, machine};
use calibration::plan::TradeoffPoint;
use job::GenParams;
use language::{t, tf};
use trade::Preset;
use widgets::icons::Icon;
use widgets::theme;

/// The pane of the quality slider, its measurements, and the receipt of the last edit.
pub struct Trade;

impl Pane for Trade {
    fn id(&self) -> PaneId {
        PaneId::TRADE
    }

    fn title(&self) -> String {
        "Speed and accuracy".into()
    }

    fn icon(&self) -> Icon {
        Icon::Live
    }

    fn column_points(&self) -> f32 {
        400.0
    }

    fn ui(&mut self, ui: &mut Ui, cx: &mut PaneContext<'_>, commands: &mut Vec<Command>) {
        theme::panel_frame().show(ui, |ui| trade_ui(ui, cx.tuning, cx.params, commands));
    }
}

/// Draws the pane. `params` are the parameters of the next edit.
pub fn trade_ui(ui: &mut Ui, tuning: &mut Tuning, params: &GenParams, commands: &mut Vec<Command>) {
    egui::ScrollArea::vertical()
        .id_salt("trade")
        .auto_shrink(false)
        .show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = 6.0;
            slider(ui, tuning, params, commands);
            calibration(ui, tuning, commands);
            let current = tuning.current(params).map(|i| tuning.presets.all[i].name.clone());
            let last = tuning
                .last
                .as_ref()
                .map(|l| (l.report.total_s(), l.measured_error));
            let size = vec2(ui.available_width().max(120.0), 230.0);
            front_plot(ui, &marks(tuning), current.as_deref(), last, size);
            let from = tf!(
                "Errors: {n} held-out edits against {reference}. X-Scene's time is the paper's.",
                n = edits(tuning),
                reference = t(&tuning.presets.reference)
            );
            ui.label(RichText::new(from).small().color(theme::text_weak()));
            ui.separator();
            receipt(ui, tuning, commands);
            ui.separator();
            stability(ui, tuning);
        });
}

/// A share as text, percent.
fn percent(share: f64) -> String {
    t(&figures::percent(share)).to_owned()
}

fn edits(tuning: &Tuning) -> usize {
    tuning.presets.all.first().map_or(0, |s| s.error.n)
}

fn marks(tuning: &Tuning) -> Vec<TradeoffPoint> {
    let tokens = tuning.tokens_of_next();
    let mark = |s: &Preset| TradeoffPoint {
        name: s.name.clone(),
        wall_s: [tuning.predicted_s(s, tokens); 3],
        error: [s.error.median, s.error.low, s.error.high],
        on_front: true,
        preset: Some(s.name.clone()),
    };
    tuning.presets.all.iter().map(mark).collect()
}

fn slider(ui: &mut Ui, tuning: &Tuning, params: &GenParams, commands: &mut Vec<Command>) {
    let presets = &tuning.presets.all;
    if presets.is_empty() {
        ui.label(t(
            "Nothing was measured for these weights: run `sceneloom trade`.",
        ));
        return;
    }
    let current = tuning.current(params);
    let mut at = current.unwrap_or(0);
    ui.horizontal(|ui| {
        ui.label(RichText::new(t("Fast")).color(theme::text_weak()));
        ui.spacing_mut().slider_width = (ui.available_width() - 130.0).max(60.0);
        let slider = Slider::new(&mut at, 0..=presets.len() - 1).show_value(false);
        let response = ui
            .add(slider)
            .on_hover_text(t("Each preset is a setting on the measured front"));
        let name = tf!("Quality: {preset}", preset = t(&presets[at].name));
        response.widget_info(|| {
            let mut info = egui::WidgetInfo::slider(true, at as f64, &name);
            info.label = Some(name.clone());
            info
        });
        if response.changed() && Some(at) != current {
            commands.push(Command::Generation(GenerationCommand::Quality(at)));
        }
        ui.label(RichText::new(t("Like the reference")).color(theme::text_weak()));
    });
    let tokens = tuning.tokens_of_next();
    match current {
        Some(i) => {
            ui.label(RichText::new(theme::sentence(t(&presets[i].name))).strong());
            let wall_s = tuning.predicted_s(&presets[i], tokens);
            let predicted = predicted(&presets[i], wall_s, tuning.times_of());
            let text = if tuning.last.is_some() {
                tf!("An edit as large as the last one: {cost}", cost = predicted)
            } else {
                tf!("An edit of a few vehicles' size: {cost}", cost = predicted)
            };
            ui.label(RichText::new(text).small());
            let factor = tuning.window_factor();
            if factor > 1.25 {
                let text = tf!(
                    "{times} times as long as in quiet: this window is drawn by the same cores",
                    times = format!("{factor:.1}")
                );
                ui.label(RichText::new(text).small().color(theme::text_weak()));
            }
        }
        None => {
            ui.label(RichText::new(t("Own settings, not measured")).strong());
        }
    }
}

fn calibration(ui: &mut Ui, tuning: &Tuning, commands: &mut Vec<Command>) {
    ui.horizontal_wrapped(|ui| match tuning.measuring() {
        Some((Measuring::Presets, done, all)) => {
            if ui.button(t("Stop")).clicked() {
                commands.push(Command::Generation(GenerationCommand::StopMeasuring));
            }
            ui.add(egui::Spinner::new().size(13.0));
            ui.label(tf!(
                "Calibrating, {done} of {all} presets timed, 30 s at most",
                done = done,
                all = all
            ));
        }
        _ => {
            let text = t("Times every preset on this computer: 30 s at most. Best while nothing else runs.");
            if ui.button(t("Calibrate")).on_hover_text(text).clicked() {
                commands.push(Command::Generation(GenerationCommand::Calibrate));
            }
            let load = Load::now();
            let (line, color) = match (tuning.calibrated, load.is_busy()) {
                (_, true) => (
                    tf!(
                        "busy: {load} running processes per core on {cores} cores; times would be too long",
                        load = format!("{:.2}", load.per_core.unwrap_or_default()),
                        cores = load.cores
                    ),
                    theme::warn(),
                ),
                (true, _) => (
                    tf!(
                        "times of this machine ({machine})",
                        machine = tuning.presets.machine
                    ),
                    theme::text_weak(),
                ),
                // (the times may be from other weights or an older program)
                (false, _) if tuning.presets.machine == machine() => (
                    tf!(
                        "times of a machine like this one ({machine})",
                        machine = tuning.presets.machine
                    ),
                    theme::text_weak(),
                ),
                (false, _) => (
                    tf!(
                        "times of another machine ({machine})",
                        machine = tuning.presets.machine
                    ),
                    theme::warn(),
                ),
            };
            ui.label(RichText::new(line).small().color(color));
        }
    });
    if let Some(message) = &tuning.message {
        ui.label(RichText::new(t(message)).small().color(theme::text_weak()));
    }
}

/// A name and its value, on as many lines as the value needs.
fn row(ui: &mut Ui, name: &str, value: impl Into<RichText>) {
    ui.horizontal_top(|ui| {
        ui.spacing_mut().item_spacing.y = 2.0;
        let width = 86.0;
        ui.allocate_ui_with_layout(vec2(width, 16.0), Layout::top_down(Align::Min), |ui| {
            ui.set_width(width);
            ui.add(Label::new(RichText::new(name).color(theme::text_weak())).truncate());
        });
        ui.add(Label::new(value.into()).wrap());
    });
}

fn receipt(ui: &mut Ui, tuning: &mut Tuning, commands: &mut Vec<Command>) {
    ui.label(RichText::new(t("Receipt of the last edit")).strong());
    let measuring = tuning.measuring();
    let Some(last) = &tuning.last else {
        ui.label(RichText::new(t("Edit something: what it cost is written here.")).color(theme::text_weak()));
        return;
    };
    let r = &last.report;
    ui.scope(|ui| {
        ui.spacing_mut().item_spacing.y = 2.0;
        row(
            ui,
            t("Region"),
            tf!(
                "{n} columns ({share})",
                n = r.region_columns,
                share = percent(r.region_share)
            ),
        );
        row(
            ui,
            t("Computed"),
            tf!(
                "{tokens} of 625 tokens, {calls} network calls",
                tokens = r.tokens,
                calls = r.network_calls
            ),
        );
        let (took, settled) = (seconds(r.total_s()), seconds(last.settled_s));
        let time = match last.predicted_s {
            Some(s) => tf!(
                "{took}, predicted {predicted}; on screen after {settled}",
                took = took,
                predicted = last.predicted_of.told(s),
                settled = settled
            ),
            None => tf!(
                "{took}; on screen after {settled}",
                took = took,
                settled = settled
            ),
        };
        row(ui, t("Time"), time);
        row(ui, t("Stages"), stages(last));
        let error = match (last.measured_error, last.predicted_error) {
            (Some(e), Some([_, low, high])) => {
                let where_ = match e {
                    e if e < low => t("better than predicted"),
                    e if e <= high => t("as predicted"),
                    _ => t("more than predicted"),
                };
                tf!(
                    "{error} measured, {verdict} ({low} to {high})",
                    error = percent(e),
                    verdict = where_,
                    low = percent(low),
                    high = percent(high)
                )
            }
            (Some(e), None) => tf!("{error} measured", error = percent(e)),
            (None, Some([e, low, high])) => {
                tf!(
                    "{error} predicted ({low} to {high})",
                    error = percent(e),
                    low = percent(low),
                    high = percent(high)
                )
            }
            (None, None) => t("unknown for own settings").into(),
        };
        row(ui, t("Differs"), error);
        let untouched = if r.untouched_voxels_changed == 0 {
            tf!("identical, {hash}", hash = format!("{:016x}", r.untouched_hash))
        } else {
            tf!("{n} CHANGED", n = r.untouched_voxels_changed)
        };
        row(ui, t("Untouched"), untouched);
    });
    ui.horizontal_wrapped(|ui| {
        match measuring {
            Some((Measuring::Error, done, all)) => {
                if ui.button(t("Stop")).clicked() {
                    commands.push(Command::Generation(GenerationCommand::StopMeasuring));
                }
                ui.add(egui::Spinner::new().size(13.0));
                ui.label(tf!(
                    "Measuring against the reference, step {done} of {all}",
                    done = done,
                    all = all
                ));
            }
            _ => {
                let about = tuning
                    .presets
                    .named("reference")
                    .map(|s| s.invert_s + s.cost.fixed_s);
                let about = about.map_or(String::new(), |s| {
                    format!(" {}", tf!("About {time}.", time = seconds(s)))
                });
                let does =
                    t("Runs the reference on the same edit in the background and says how much differs.");
                let text = format!("{does}{about}");
                if ui.button(t("Refine")).on_hover_text(text).clicked() {
                    commands.push(Command::Generation(GenerationCommand::Refine));
                }
            }
        }
        ui.checkbox(&mut tuning.show_modelled, t("Show what was computed"))
            .on_hover_text(t(
                "Tokens, columns and bricks of the last edit, in the bird's-eye view",
            ));
    });
}

/// Stages that took a millisecond or more.
fn stages(last: &LastEdit) -> String {
    let parts = last.report.wall_s.iter().filter(|(_, s)| **s >= 1e-3);
    parts
        .map(|(name, s)| format!("{} {}", t(name), seconds(*s)))
        .collect::<Vec<_>>()
        .join(", ")
}

fn stability(ui: &mut Ui, tuning: &Tuning) {
    ui.label(RichText::new(t("Stability")).strong());
    let s = &tuning.stability;
    ui.scope(|ui| {
        ui.spacing_mut().item_spacing.y = 2.0;
        if let Some(r) = tuning.last.as_ref().map(|l| &l.report)
            && let (Some(std), Some(max)) = (r.noise_std, r.noise_max_abs)
        {
            let sound = (0.9..=1.1).contains(&std) && max < 6.0;
            let verdict = if sound {
                t("as a draw would be")
            } else {
                t("unlike a draw (std 0.9 to 1.1, max 6)")
            };
            row(
                ui,
                t("Inverted noise"),
                tf!(
                    "std {std}, max {max}: {verdict}",
                    std = format!("{std:.2}"),
                    max = format!("{max:.1}"),
                    verdict = verdict
                ),
            );
        }
        row(
            ui,
            t("Generations"),
            tf!(
                "{n}, {fallbacks} with a fallback or warning",
                n = s.runs,
                fallbacks = s.fallbacks
            ),
        );
        row(
            ui,
            t("Failed"),
            tf!(
                "{n}, {not_finite} by a number that was not finite",
                n = s.failures,
                not_finite = s.not_finite
            ),
        );
        let color = if s.untouched_changed == 0 {
            theme::text()
        } else {
            theme::bad()
        };
        row(
            ui,
            t("Untouched"),
            RichText::new(tf!("{n} voxels changed", n = s.untouched_changed)).color(color),
        );
    });
    if let Some(notes) = tuning
        .last
        .as_ref()
        .map(|l| &l.report.notes)
        .filter(|n| !n.is_empty())
    {
        for note in notes {
            ui.label(RichText::new(t(note)).small().color(theme::warn()));
        }
    }
}
