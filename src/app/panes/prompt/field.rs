//! The prompt field: words that become a scene or change the open one. Each part that was read is a chip.

use egui::accesskit::Role;
use egui::text::{CCursor, CCursorRange};
use egui::text_edit::TextEditState;
use egui::{Key, Modifiers, Ui, WidgetInfo};

use super::completion::Completion;
use super::plan::{PromptOrigin, PromptPlan};
use super::typed_text::Both;
use crate::command::{Command, FileCommand, step_name};
use crate::text::doubts;
use crate::wildcards;
use language::{t, tf};
use scene::Scene;
use widgets::icons::section;
use widgets::theme;

/// Most prompts in the history.
const HISTORY: usize = 50;

const EXAMPLES: [&str; 5] = [
    "busy intersection at night in the rain, five cones block my lane, a bus waits at the crossing",
    "suburban street, three parked cars on the right, a cyclist 12 m ahead",
    "highway, two trucks in front of me, no pedestrians, foggy",
    "remove the nearest car",
    "add a pedestrian 8 m ahead on the crossing",
];

/// The prompt field: its text, its reading, and the result of its words.
#[derive(Default)]
pub struct PromptField {
    pub(super) prompt: String,
    pub(super) seed: u64,
    pub(super) history: Vec<String>,
    /// Prompts typed for the open scene, the oldest first.
    typed: Vec<String>,
    /// Prompts that the user keeps; saved with the settings.
    pub favourites: Vec<String>,
    pub(super) back: usize, // steps back in the history; 0 is the text being typed
    pub(super) draft: String,
    pub(super) read: Option<Both>,
    /// The answer to the words that were carried out last, and whether it asks a question back (`asks`).
    pub(super) done: Option<String>,
    pub(super) asks: bool,
    /// Enter was pressed on words that describe a scene; the user is asked whether to change this scene or make a new
    /// one.
    pub(super) offers: bool,
    pub(super) notes: Vec<String>,
    pub(super) wants_focus: bool,
    pub(super) offered: Option<Completion>,
    pub(super) is_sent: bool, // carried out, and not changed since
    /// The words that last changed the scene on screen.
    changed: Option<String>,
    /// Name of the last undo step of the document.
    pub(crate) last_step: Option<String>,
    /// The change was undone and is to be made again with another seed.
    redraws: bool,
    pub(super) plan: PromptPlan,
}

fn field_id() -> egui::Id {
    egui::Id::unique("prompt field")
}

/// Appends a line to a list without duplicates, and removes the first line if the list is too long.
fn keep(lines: &mut Vec<String>, line: &str, most: usize) {
    lines.retain(|l| l != line);
    lines.push(line.to_owned());
    if lines.len() > most {
        lines.remove(0);
    }
}

impl PromptField {
    /// Prompts typed for the open scene, the oldest first.
    pub fn typed(&self) -> &[String] {
        &self.typed
    }

    /// The text with its wildcards drawn by the seed. This text is read, carried out and recorded.
    pub(super) fn said(&self) -> String {
        wildcards::drawn(&self.prompt, self.seed)
    }

    /// Gives the field the focus in the next frame.
    pub fn focus(&mut self) {
        self.wants_focus = true;
    }

    /// Cell in which the thread that makes a scene reports how its layout was made.
    pub fn told(&self) -> PromptOrigin {
        self.plan.told()
    }

    /// Notes that another scene is open. The words for the one before are cleared, unless the new scene was made of
    /// them. They stay in the history.
    pub fn opened(&mut self, scene: &Scene) {
        if scene.words.contains(&self.said()) {
            self.typed = vec![self.prompt.clone()];
            return;
        }
        self.typed.clone_from(&scene.kept.typed);
        for line in &scene.kept.typed {
            keep(&mut self.history, line, HISTORY);
        }
        self.prompt.clear();
        (self.read, self.done, self.back) = (None, None, 0);
        (self.asks, self.offers) = (false, false);
        self.notes.clear();
    }

    /// Draws the pane.
    pub fn show(&mut self, ui: &mut Ui, scene: &Scene, commands: &mut Vec<Command>) {
        egui::ScrollArea::vertical()
            .id_salt("prompt")
            .auto_shrink(false)
            .show(ui, |ui| {
                self.field(ui, scene, commands);
                self.answers(ui, scene, commands);
                self.chips(ui, scene, commands);
                self.beyond_words(ui, scene, commands);
                if self.prompt.is_empty() {
                    self.recent(ui);
                    self.examples(ui);
                }
            });
    }

    pub(super) fn field(&mut self, ui: &mut Ui, scene: &Scene, commands: &mut Vec<Command>) {
        let has_focus = ui.memory(|m| m.has_focus(field_id()));
        if let (true, Some(first)) = (has_focus, self.offered.as_ref().map(|o| o.ends[0]))
            && ui.input_mut(|i| i.consume_key(Modifiers::NONE, Key::Tab))
        {
            self.complete(ui.ctx(), first);
        }
        if has_focus && self.is_sent {
            // After the words were carried out, Ctrl+Z and Ctrl+Shift+Z undo and redo in the scene, not in the text.
            let undone = [
                (Modifiers::CTRL, Command::Undo),
                (Modifiers::CTRL | Modifiers::SHIFT, Command::Redo),
            ];
            for (modifiers, command) in undone.into_iter().rev() {
                if ui.input_mut(|i| i.consume_key(modifiers, Key::Z)) {
                    commands.push(command);
                }
            }
        }
        let field = egui::TextEdit::multiline(&mut self.prompt)
            .id(field_id())
            .lock_focus(self.offered.is_some())
            .hint_text(t("Describe a scene, or say what should change in this one"))
            .desired_rows(2)
            .desired_width(f32::INFINITY)
            .return_key(None);
        let output = field.show(ui);
        let field = output.response.response;
        // A click on a completion takes the focus first.
        if field.has_focus() {
            let caret = output.cursor_range.map(|range| range.primary.index);
            // Words that were carried out get no completions.
            let caret = caret.filter(|_| !self.is_sent);
            self.offered = caret.and_then(|caret| Completion::at(&self.prompt, caret.0));
        }
        field.widget_info(|| WidgetInfo::labeled(Role::MultilineTextInput, true, t("Prompt")));
        if std::mem::take(&mut self.wants_focus) {
            field.request_focus();
        }
        if field.changed() {
            self.back = 0;
            self.touched();
        }
        let (mut make, mut change) = (false, false);
        if field.has_focus() {
            let (up, down) = ui.input_mut(|i| {
                (
                    i.consume_key(Modifiers::ALT, Key::ArrowUp),
                    i.consume_key(Modifiers::ALT, Key::ArrowDown),
                )
            });
            if up || down {
                self.recall(if up { 1 } else { -1 });
            }
            (make, change) = ui.input_mut(|i| {
                (
                    i.consume_key(Modifiers::CTRL, Key::Enter),
                    i.consume_key(Modifiers::NONE, Key::Enter),
                )
            });
        }
        self.completions(ui);
        self.listen(scene);
        let said = self.said();
        if said != self.prompt {
            let text = tf!("Drawn by the seed: {words}", words = said);
            ui.label(egui::RichText::new(text).small().color(theme::text_weak()));
        }
        if change && !self.offers && self.read.as_ref().is_some_and(Both::is_described) {
            // (the words describe a whole scene: the user is asked once, with the effect of each choice)
            (self.offers, change) = (true, false);
        }
        let (changes, makes) = self.choices(ui);
        change |= changes;
        make |= makes;
        // In one row that wraps: a taller one would take height from the history and the examples below.
        ui.horizontal_wrapped(|ui| {
            let some = !self.prompt.trim().is_empty();
            let dice = ui.button(t("Re-roll")).on_hover_text(t(
                "The same words by the next seed: another scene, or the change drawn again",
            ));
            if some && dice.clicked() {
                make |= self.roll(commands);
            }
            let seed = egui::DragValue::new(&mut self.seed)
                .range(0..=99_999)
                .prefix(t("seed "));
            ui.add(seed)
                .on_hover_text(t("The same words and seed give the same scene"));
            self.plan.switches(ui);
        });
        change |= std::mem::take(&mut self.redraws);
        if change || make {
            self.offers = false;
            self.sent(ui.ctx());
        }
        if change {
            self.change(scene, commands);
        } else if make {
            self.remember();
            self.make(self.seed, scene, commands);
        }
    }

    /// Draws the same words with the next seed. Returns true if a new scene is to be made; a change is undone and made
    /// again.
    fn roll(&mut self, commands: &mut Vec<Command>) -> bool {
        let said = self.said();
        let is_change = self.changed.as_ref() == Some(&said);
        let is_last = self.last_step.as_deref() == Some(&*step_name(&said));
        if is_change && !is_last {
            self.notes = vec![
                t("Something came after this change: take that back first, or type the change anew.")
                    .to_owned(),
            ];
            return false;
        }
        self.seed = self.seed.wrapping_add(1) % 100_000;
        if is_change {
            commands.push(Command::Undo);
            self.redraws = true;
        }
        !is_change
    }

    /// Makes a new scene of words that were typed elsewhere.
    pub fn describe(&mut self, words: &str, scene: &Scene, commands: &mut Vec<Command>) {
        self.prompt = words.to_owned();
        self.touched();
        self.listen(scene);
        self.remember();
        self.make(self.seed, scene, commands);
        self.is_sent = true;
    }

    /// Drops the results of the words before the text changed.
    pub(super) fn touched(&mut self) {
        (self.done, self.asks, self.offers, self.is_sent) = (None, false, false, false);
        self.notes.clear();
    }

    /// Draws the two buttons, to change the scene or make a new one; for words that describe a scene, with the effect
    /// of each. Returns which was clicked.
    pub(super) fn choices(&self, ui: &mut Ui) -> (bool, bool) {
        let some = !self.prompt.trim().is_empty();
        let button = |ui: &mut Ui, name: &str, hint: &str, first: bool| {
            let mut button = egui::Button::new(name);
            if first {
                button = button.fill(theme::accent_fill());
            }
            ui.add_enabled(some, button).on_hover_text(hint).clicked()
        };
        let hints = [
            t("Enter: “remove the parked car”, “add two cones ahead”, “make it night”"),
            t("Ctrl+Enter: road, objects and style are made from the words"),
        ];
        if !self.offers {
            let row = ui.horizontal(|ui| {
                let change = button(ui, t("Change this scene"), hints[0], true);
                (change, button(ui, t("New scene"), hints[1], false))
            });
            return row.inner;
        }
        let read = self.read.as_ref();
        let says = |ui: &mut Ui, text: Option<String>| {
            if let Some(text) = text {
                ui.label(egui::RichText::new(text).small().color(theme::text_weak()));
            }
        };
        ui.label(t(
            "A scene is described. Enter again changes this one, Ctrl+Enter makes a new one.",
        ));
        let change = button(ui, t("Change this scene"), hints[0], true);
        says(ui, read.and_then(|r| r.edited.as_ref().ok()).map(|e| e.answer()));
        let make = button(ui, t("New scene"), hints[1], false);
        says(
            ui,
            read.and_then(|r| r.prompted.as_ref().ok()).map(|p| p.answer()),
        );
        (change, make)
    }

    /// Reads the text, if it is not read yet.
    pub(super) fn listen(&mut self, scene: &Scene) {
        if self.prompt.trim().is_empty() {
            self.read = None;
            return;
        }
        let said = self.said();
        match &mut self.read {
            Some(read) if read.text == said => {
                // (words that were carried out are not applied again for a preview)
                if !self.is_sent {
                    read.follow(scene, self.seed);
                }
            }
            _ => self.read = Some(Both::from_text(&said, scene, self.seed)),
        }
    }

    pub(super) fn make(&mut self, seed: u64, scene: &Scene, commands: &mut Vec<Command>) {
        // (another seed draws other words from wildcards)
        self.listen(scene);
        let said = self.said();
        match self.read.as_ref().map(|r| &r.prompted) {
            Some(Ok(prompted)) => {
                let ask = self.plan.ask(&said, &prompted.described.description, seed, scene);
                self.done = Some(prompted.answer());
                (self.asks, self.notes) = (false, doubts(&prompted.heard));
                self.plan.makes(&said, seed);
                self.changed = None;
                commands.push(Command::File(FileCommand::NewFromPrompt(Box::new(ask))));
            }
            Some(Err(error)) => self.notes = vec![error.clone()],
            None => {}
        }
    }

    /// Variants, the origin of the last scene, and the scene graph.
    pub(super) fn beyond_words(&mut self, ui: &mut Ui, scene: &Scene, commands: &mut Vec<Command>) {
        let Some(Ok(prompted)) = self.read.as_ref().map(|r| &r.prompted) else {
            return;
        };
        let read = prompted.described.description.clone();
        let ask = self.plan.ask(&self.said(), &read, self.seed, scene);
        self.plan.recalled(ui, &ask);
        let chosen = self.plan.variants(ui, &ask);
        self.plan.origin(ui);
        let place = self.plan.graph(ui, &ask.description, self.seed, scene, commands);
        if let Some(seed) = chosen {
            // A variant is made of the words as they were drawn for it.
            self.prompt = self.said();
            self.seed = seed;
        }
        if chosen.is_some() || place {
            self.remember();
            self.make(self.seed, scene, commands);
        }
    }

    /// Offers completions of the word at the caret; Tab takes the first.
    pub(super) fn completions(&mut self, ui: &mut Ui) {
        let Some(offered) = &self.offered else { return };
        let mut taken = None;
        ui.horizontal_wrapped(|ui| {
            for (i, end) in offered.ends.iter().enumerate() {
                let color = if i == 0 { theme::text() } else { theme::text_weak() };
                let shown = if i == 0 {
                    format!("{end}  Tab")
                } else {
                    (*end).to_owned()
                };
                let text = egui::RichText::new(shown).small().color(color);
                let button = ui.add(egui::Button::new(text).fill(theme::field()));
                let label = tf!("Complete with {word}", word = end);
                button.widget_info(|| WidgetInfo::labeled(Role::Button, true, &label));
                if button.clicked() {
                    taken = Some(*end);
                }
            }
        });
        if let Some(end) = taken {
            self.complete(ui.ctx(), end);
            self.wants_focus = true;
        }
    }

    /// Notes that the words were carried out: the next text that is typed replaces them.
    pub(super) fn sent(&mut self, ctx: &egui::Context) {
        (self.offered, self.is_sent) = (None, true);
        let mut state = TextEditState::load(ctx, field_id()).unwrap_or_default();
        let all = CCursorRange::two(
            CCursor::default(),
            CCursor::new(egui::text::CharIndex(self.prompt.chars().count())),
        );
        state.cursor.set_char_range(Some(all));
        state.store(ctx, field_id());
    }

    pub(super) fn complete(&mut self, ctx: &egui::Context, end: &str) {
        let Some(offered) = self.offered.take() else {
            return;
        };
        let caret = offered.take(&mut self.prompt, end);
        self.touched();
        let mut state = TextEditState::load(ctx, field_id()).unwrap_or_default();
        let at = CCursor::new(egui::text::CharIndex(caret));
        state.cursor.set_char_range(Some(CCursorRange::one(at)));
        state.store(ctx, field_id());
    }

    /// Carries out the words as edits of the open scene; questions that come back are shown.
    pub(super) fn change(&mut self, scene: &Scene, commands: &mut Vec<Command>) {
        self.remember();
        self.listen(scene);
        if let Some(read) = &mut self.read {
            read.follow(scene, self.seed);
        }
        let edited = match self.read.as_ref().map(|r| &r.edited) {
            Some(Ok(edited)) => edited,
            Some(Err(error)) => {
                self.notes = vec![error.clone()];
                return;
            }
            None => return,
        };
        let edits = edited.edits();
        (self.done, self.asks) = (Some(edited.answer_on(scene)), edited.asks());
        self.notes = doubts(&edited.heard);
        if !edits.is_empty() && !self.asks {
            commands.push(Command::ApplyWords(self.said(), edits));
            self.changed = Some(self.said());
            // (to be carried out again, the words are read again)
            self.read = None;
        }
    }

    pub(super) fn remember(&mut self) {
        keep(&mut self.history, &self.prompt, HISTORY);
        keep(&mut self.typed, &self.prompt, HISTORY);
        self.back = 0;
    }

    pub(super) fn recall(&mut self, step: i32) {
        let back = (self.back as i64 + i64::from(step)).clamp(0, self.history.len() as i64) as usize;
        if back != self.back {
            if self.back == 0 {
                self.draft.clone_from(&self.prompt);
            }
            self.back = back;
            self.prompt = match back {
                0 => self.draft.clone(),
                n => self.history[self.history.len() - n].clone(),
            };
            self.touched();
        }
    }

    pub(super) fn examples(&mut self, ui: &mut Ui) {
        section(ui, t("Examples"));
        for example in EXAMPLES {
            let text = egui::RichText::new(example).small().color(theme::text());
            let button = egui::Button::new(text).wrap().fill(theme::field());
            if ui.add(button).clicked() {
                self.prompt = example.to_owned();
                self.wants_focus = true;
            }
        }
    }
}
