//! Prompts to use again: those that the user keeps, and the last ones typed.

use egui::accesskit::Role;
use egui::{Sense, Ui, WidgetInfo, vec2};

use super::field::PromptField;
use language::{t, tf};
use widgets::icons::{self, section};
use widgets::theme;

/// Lines of the history that are listed.
const RECENT: usize = 5;
/// Most prompts that are kept.
const MOST: usize = 100;

impl PromptField {
    /// Keeps a prompt, or no longer keeps it; the newest stands first.
    pub fn star(&mut self, words: &str) {
        let before = self.favourites.len();
        self.favourites.retain(|kept| kept != words);
        if self.favourites.len() == before {
            self.favourites.insert(0, words.to_owned());
            self.favourites.truncate(MOST);
        }
    }

    /// Draws both lists.
    pub(super) fn recent(&mut self, ui: &mut Ui) {
        let kept = self.favourites.clone();
        if !kept.is_empty() {
            section(ui, t("Kept words"));
            for words in &kept {
                self.line(ui, words, true);
            }
        }
        let past = self.history.iter().rev().filter(|words| !kept.contains(words));
        let past: Vec<String> = past.take(RECENT).cloned().collect();
        if !past.is_empty() {
            section(ui, t("Typed before"));
            for words in &past {
                self.line(ui, words, false);
            }
        }
    }

    /// A line with its star.
    fn line(&mut self, ui: &mut Ui, words: &str, starred: bool) {
        ui.horizontal_top(|ui| {
            ui.spacing_mut().item_spacing.x = 2.0;
            let (rect, star) = ui.allocate_exact_size(vec2(20.0, theme::ROW), Sense::click());
            let name = tf!("Keep the words “{words}”", words = words);
            star.widget_info(|| WidgetInfo::selected(Role::CheckBox, true, starred, &name));
            let color = if starred {
                theme::warn()
            } else {
                theme::text_weak()
            };
            icons::star(ui, rect.center(), color, starred);
            icons::focus_ring(ui, &star, rect);
            if star
                .on_hover_text(t("Kept words stand first, in every scene"))
                .clicked()
            {
                self.star(words);
            }
            let text = egui::RichText::new(words).small().color(theme::text());
            let button = egui::Button::new(text).wrap().fill(theme::field());
            let button = ui.add(button);
            if button.on_hover_text(t("Alt+Up and Alt+Down too")).clicked() {
                words.clone_into(&mut self.prompt);
                self.wants_focus = true;
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_kept_once_and_let_go() {
        let mut field = PromptField::default();
        field.star("a {car|bus} ahead");
        field.star("fog");
        assert_eq!(field.favourites, ["fog", "a {car|bus} ahead"]);
        field.star("fog");
        assert_eq!(field.favourites, ["a {car|bus} ahead"]);
        for i in 0..2 * MOST {
            field.star(&i.to_string());
        }
        assert_eq!(field.favourites.len(), MOST);
    }
}
