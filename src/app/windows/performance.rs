//! The performance overlay: times of frames and edits, the stages of the worker, and processor time.

use egui::accesskit::Role;
use egui::{Align2, Color32, Rect, Sense, Ui, WidgetInfo, pos2, vec2};

use crate::shell::perf::{BLOCKED_S, Perf, Quantiles, SHOWN};
use language::{t, tf};
use widgets::theme;

/// Draws the overlay into the upper right corner of `over` while it is open.
pub fn performance_ui(ui: &Ui, over: Rect, perf: &mut Perf) {
    if !perf.open {
        return;
    }
    let mut open = true;
    egui::Window::new(t("Performance"))
        .id(egui::Id::unique("performance"))
        .open(&mut open)
        .collapsible(false)
        .resizable(false)
        .pivot(Align2::RIGHT_TOP)
        .default_pos(over.right_top() + vec2(-10.0, 10.0))
        .show(ui.ctx(), |ui| {
            ui.set_width(300.0);
            bars(ui, perf);
            egui::Grid::new("performance")
                .num_columns(5)
                .spacing([theme::GAP, 2.0])
                .show(ui, |ui| {
                    for title in ["ms", "middle", "95 %", "most", "of"] {
                        weak(ui, t(title));
                    }
                    ui.end_row();
                    row(ui, "Frame", perf.frames.quantiles());
                    row(ui, "  worker busy", perf.frames_while_working.quantiles());
                    row(ui, "Edit to picture", perf.visible.quantiles());
                    row(ui, "Edit to result", perf.settled.quantiles());
                });
            ui.add_space(4.0);
            let [all, working] = perf.blocked;
            weak(
                ui,
                &tf!(
                    "Input held up over 50 ms: {all} frames, {working} of them while generating",
                    all = all,
                    working = working
                ),
            );
            let cpu = perf.cpu_share.map_or_else(
                || t("not known here").to_owned(),
                |share| tf!("{percent} % of a core", percent = format!("{:.0}", share * 100.0)),
            );
            weak(ui, &tf!("Processor: {share}", share = cpu));
            if !perf.stages.is_empty() {
                let of = |(name, s): (&&str, &f64)| format!("{} {:.0}", t(name), s * 1e3);
                let stages: Vec<String> = perf.stages.iter().map(of).collect();
                weak(
                    ui,
                    &tf!("Last generation, ms: {stages}", stages = stages.join(", ")),
                );
            }
        });
    perf.open = open;
}

fn weak(ui: &mut Ui, text: &str) {
    ui.label(egui::RichText::new(text).small().color(theme::text_weak()));
}

fn row(ui: &mut Ui, name: &str, q: Quantiles) {
    ui.label(egui::RichText::new(t(name)).small());
    for value in [q.p50, q.p95, q.max] {
        let slow = q.n > 0 && value > BLOCKED_S && name != "Edit to result";
        let color = if slow { theme::warn() } else { theme::text() };
        let text = match q.n {
            0 => "–".to_owned(),
            _ => format!("{:.1}", value * 1e3),
        };
        ui.label(egui::RichText::new(text).small().color(color));
    }
    weak(ui, &q.n.to_string());
    ui.end_row();
}

/// Draws the newest frames as bars, with a line at 50 ms.
fn bars(ui: &mut Ui, perf: &Perf) {
    const MOST_S: f64 = 0.1;
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), 44.0), Sense::hover());
    let last = perf.frames.newest(1).last().unwrap_or(0.0);
    response.widget_info(|| {
        let text = tf!(
            "Newest frames; the last took {ms} ms",
            ms = format!("{:.0}", last * 1e3)
        );
        WidgetInfo::labeled(Role::Image, true, text)
    });
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 3.0, theme::well());
    let width = rect.width() / SHOWN as f32;
    let y = |s: f64| rect.bottom() - (s / MOST_S).min(1.0) as f32 * rect.height();
    for (i, s) in perf.frames.newest(SHOWN).enumerate() {
        let x = rect.left() + i as f32 * width;
        let bar = Rect::from_min_max(pos2(x, y(s)), pos2(x + width.max(1.0) - 0.4, rect.bottom()));
        let color = if s > BLOCKED_S {
            theme::warn()
        } else {
            theme::accent()
        };
        painter.rect_filled(bar, 0.0, color);
    }
    let line: Color32 = theme::text_weak();
    painter.hline(rect.x_range(), y(BLOCKED_S), egui::Stroke::new(1.0, line));
}
