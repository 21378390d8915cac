//! Messages: short cards over the views, and the log that keeps them.

use egui::{Align2, Color32, Frame, Id, Margin, Order, Rect, Stroke, Ui, vec2};

use language::t;
use widgets::icons::{self, Icon};
use widgets::theme;

/// How serious a message is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MessageLevel {
    /// For information.
    Info,
    /// For a failure.
    Error,
}

#[derive(Clone, Debug)]
struct ToastMessage {
    level: MessageLevel,
    text: String,
    at_s: f64,
    dismissed: bool,
}

/// All messages of this session.
#[derive(Debug, Default)]
pub struct Toasts {
    entries: Vec<ToastMessage>,
    read: usize,
}

/// Time that a card stays, s.
const INFO_S: f64 = 4.0;
const ERROR_S: f64 = 12.0;
/// Most messages that are kept.
const KEPT: usize = 500;

impl Toasts {
    /// Shows a message as a card and writes it into the log.
    pub fn push(&mut self, level: MessageLevel, text: impl Into<String>, now_s: f64) {
        let text = text.into();
        match level {
            MessageLevel::Error => tracing::error!("{text}"),
            _ => tracing::info!("{text}"),
        }
        let entry = ToastMessage {
            level,
            text,
            at_s: now_s,
            dismissed: false,
        };
        self.entries.push(entry);
        if self.entries.len() > KEPT {
            self.entries.remove(0);
            self.read = self.read.saturating_sub(1);
        }
    }

    /// Writes a line into the log without a card.
    pub fn log(&mut self, text: impl Into<String>, now_s: f64) {
        self.push(MessageLevel::Info, text, now_s);
        if let Some(last) = self.entries.last_mut() {
            last.dismissed = true;
        }
    }

    /// Number of unread errors in the log.
    pub fn unread(&self) -> usize {
        self.entries[self.read..]
            .iter()
            .filter(|e| e.level == MessageLevel::Error)
            .count()
    }

    /// The newest message.
    pub fn last(&self) -> Option<&str> {
        self.entries.last().map(|e| e.text.as_str())
    }

    /// Draws the cards over the lower right corner of `over`.
    pub fn show(&mut self, ui: &Ui, over: Rect, now_s: f64) {
        let stays = |e: &ToastMessage| {
            if e.level == MessageLevel::Error {
                ERROR_S
            } else {
                INFO_S
            }
        };
        let mut next_s = f64::INFINITY;
        let mut bottom = over.bottom() - 14.0;
        for (i, entry) in self.entries.iter_mut().enumerate().rev().take(40) {
            let left_s = stays(entry) - (now_s - entry.at_s);
            if entry.dismissed || left_s <= 0.0 {
                continue;
            }
            next_s = next_s.min(left_s);
            let area = egui::Area::new(Id::unique(("toast", i)))
                .order(Order::Foreground)
                .pivot(Align2::RIGHT_BOTTOM)
                .fixed_pos(egui::pos2(over.right() - 14.0, bottom));
            let shown = area.show(ui.ctx(), |ui| card(ui, entry));
            bottom = shown.response.rect.top() - 8.0;
            if bottom < over.top() + 60.0 {
                break;
            }
        }
        if next_s.is_finite() {
            ui.ctx()
                .request_repaint_after(std::time::Duration::from_secs_f64(next_s.max(0.02)));
        }
    }

    /// Draws the log as a window.
    pub fn log_window(&mut self, ui: &Ui, over: Rect, open: &mut bool) {
        if *open {
            self.read = self.entries.len();
        }
        let window = egui::Window::new(t("Log"))
            .id(Id::unique("Log"))
            .open(open)
            .default_size(vec2(560.0, 260.0))
            .default_pos(over.right_bottom() - vec2(610.0, 340.0))
            .vscroll(true);
        window.show(ui.ctx(), |ui| {
            if self.entries.is_empty() {
                ui.weak(t("Nothing has happened yet."));
            }
            for entry in &self.entries {
                ui.horizontal(|ui| {
                    let at = format!("{:02}:{:02}", entry.at_s as u64 / 60, entry.at_s as u64 % 60);
                    ui.label(egui::RichText::new(at).monospace().color(theme::text_weak()));
                    let color = if entry.level == MessageLevel::Error {
                        theme::bad()
                    } else {
                        theme::text()
                    };
                    ui.add(egui::Label::new(egui::RichText::new(&entry.text).color(color)).wrap());
                });
            }
        });
    }
}

fn card(ui: &mut Ui, entry: &mut ToastMessage) {
    let edge = if entry.level == MessageLevel::Error {
        theme::bad()
    } else {
        theme::accent()
    };
    let frame = Frame::new()
        .fill(Color32::from_rgb(44, 48, 56))
        .stroke(Stroke::new(1.0, Color32::from_rgb(66, 72, 84)))
        .corner_radius(6)
        .inner_margin(Margin {
            left: 14,
            right: 8,
            top: 7,
            bottom: 7,
        })
        .shadow(ui.visuals().popup_shadow);
    let shown = frame.show(ui, |ui| {
        ui.set_max_width(420.0);
        ui.horizontal(|ui| {
            ui.add(egui::Label::new(&entry.text).wrap());
            if icons::button(ui, Icon::Close, t("Dismiss message"), "", false, true).clicked() {
                entry.dismissed = true;
            }
        });
    });
    let rect = shown.response.rect;
    let bar = Rect::from_min_size(rect.left_top() + vec2(4.0, 7.0), vec2(3.0, rect.height() - 14.0));
    ui.painter().rect_filled(bar, 2.0, edge);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_unread_until_the_log_was_open() {
        let mut toasts = Toasts::default();
        toasts.log("opened", 0.0);
        assert_eq!(toasts.unread(), 0);
        toasts.push(MessageLevel::Error, "no weights", 1.0);
        assert_eq!((toasts.unread(), toasts.last()), (1, Some("no weights")));
        let ctx = egui::Context::default();
        let _ = ctx.run_ui(egui::RawInput::default(), |ui| {
            toasts.log_window(ui, ui.max_rect(), &mut true);
        });
        assert_eq!(toasts.unread(), 0);
        for i in 0..2 * KEPT {
            toasts.push(MessageLevel::Info, format!("{i}"), 2.0);
        }
        assert_eq!(toasts.entries.len(), KEPT);
    }
}
