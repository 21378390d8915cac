//! The prompt: words that become a scene or change the one at hand, each phrase as a chip that says what it became.

use egui::accesskit::Role;
use egui::text::{CCursor, CCursorRange};
use egui::text_edit::TextEditState;
use egui::{Key, Modifiers, Ui, WidgetInfo, vec2};

use super::completion::Completion;
use super::phrases;
use super::prompt_plan::{Plan, Told};
use crate::app::command::Command;
use crate::app::icons::section;
use crate::app::text;
use crate::app::theme;
use crate::generation::text::description::{Became, Phrase, Reading, TimeOfDay, Unread, Weather};
use crate::generation::text::edit::{EditReading, Question};
use crate::scene::Scene;

/// Prompts kept.
const HISTORY: usize = 50;

const EXAMPLES: [&str; 5] = [
    "busy intersection at night in the rain, five cones block my lane, a bus waits at the crossing",
    "suburban street, three parked cars on the right, a cyclist 12 m ahead",
    "highway, two trucks in front of me, no pedestrians, foggy",
    "remove the nearest car",
    "add a pedestrian 8 m ahead on the crossing",
];

/// What is typed, and what came of it.
#[derive(Default)]
pub struct PromptPane {
    prompt: String,
    seed: u64,
    history: Vec<String>,
    back: usize, // steps back in the history; 0 is what is typed
    read: Option<(String, Result<Reading, String>)>,
    questions: Vec<Question>,
    notes: Vec<String>,
    wants_focus: bool,
    offered: Option<Completion>,
    is_sent: bool, // and not changed since
    /// The words carried out last as a change of the scene.
    changed_by: String,
    plan: Plan,
}

fn field_id() -> egui::Id {
    egui::Id::unique("prompt field")
}

impl PromptPane {
    /// The next frame gives the field the focus.
    pub fn focus(&mut self) {
        self.wants_focus = true;
    }

    /// Where the thread that makes a scene tells how it came about.
    pub fn told(&self) -> Told {
        self.plan.told()
    }

    /// Draws the pane.
    pub fn show(&mut self, ui: &mut Ui, scene: &Scene, commands: &mut Vec<Command>) {
        egui::ScrollArea::vertical()
            .id_salt("prompt")
            .auto_shrink(false)
            .show(ui, |ui| {
                self.field(ui, scene, commands);
                self.chips(ui, scene, commands);
                self.answers(ui, scene, commands);
                self.beyond_words(ui, scene, commands);
                if self.prompt.is_empty() {
                    self.recent(ui);
                    self.examples(ui);
                }
            });
    }

    fn field(&mut self, ui: &mut Ui, scene: &Scene, commands: &mut Vec<Command>) {
        let has_focus = ui.memory(|m| m.has_focus(field_id()));
        if let (true, Some(first)) = (has_focus, self.offered.as_ref().map(|o| o.ends[0]))
            && ui.input_mut(|i| i.consume_key(Modifiers::NONE, Key::Tab))
        {
            self.complete(ui.ctx(), first);
        }
        if has_focus && self.is_sent {
            // The field has nothing to take back that its user means.
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
            .hint_text("Describe a scene, or say what should change in this one")
            .desired_rows(2)
            .desired_width(f32::INFINITY)
            .return_key(None);
        let output = field.show(ui);
        let field = output.response.response;
        // A click on what is offered takes the focus first.
        if field.has_focus() {
            let caret = output.cursor_range.map(|range| range.primary.index);
            // Words that were taken want no other end.
            let caret = caret.filter(|_| !self.is_sent);
            self.offered = caret.and_then(|caret| Completion::at(&self.prompt, caret.0));
        }
        field.widget_info(|| WidgetInfo::labeled(Role::MultilineTextInput, true, "Prompt"));
        if std::mem::take(&mut self.wants_focus) {
            field.request_focus();
        }
        if field.changed() {
            (self.back, self.questions) = (0, Vec::new());
            self.notes.clear();
            self.is_sent = false;
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
        ui.horizontal(|ui| {
            let some = !self.prompt.trim().is_empty();
            let button = egui::Button::new("Change this scene").fill(theme::accent_fill());
            let hint = "Enter: “remove the parked car”, “add two cones ahead”, “make it night”";
            change |= ui.add_enabled(some, button).on_hover_text(hint).clicked();
            let button = egui::Button::new("New scene");
            let hint = "Ctrl+Enter: road, objects and style are made from the words";
            make |= ui.add_enabled(some, button).on_hover_text(hint).clicked();
        });
        // In one flow: what they take is missed by the history and the examples below.
        ui.horizontal_wrapped(|ui| {
            let some = !self.prompt.trim().is_empty();
            let dice = ui
                .button("Re-roll")
                .on_hover_text("Another scene of the same words");
            if some && dice.clicked() {
                self.seed = self.seed.wrapping_add(1) % 100_000;
                make = true;
            }
            let seed = egui::DragValue::new(&mut self.seed)
                .range(0..=99_999)
                .prefix("seed ");
            ui.add(seed)
                .on_hover_text("The same words and seed give the same scene");
            self.plan.switches(ui);
        });
        if change || make {
            self.sent(ui.ctx());
        }
        if change {
            self.change(scene, commands);
        } else if make {
            self.remember();
            self.make(self.seed, scene, commands);
        }
    }

    fn make(&mut self, seed: u64, scene: &Scene, commands: &mut Vec<Command>) {
        match text::read(&self.prompt) {
            Ok(reading) => {
                let ask = self.plan.ask(&self.prompt, &reading.description, seed, scene);
                self.plan.makes(&self.prompt, seed);
                commands.push(Command::NewFromPrompt(Box::new(ask)));
            }
            Err(error) => self.notes = vec![format!("{error:#}")],
        }
    }

    /// Variants, how the last scene came about, and the scene graph.
    fn beyond_words(&mut self, ui: &mut Ui, scene: &Scene, commands: &mut Vec<Command>) {
        let Some((_, Ok(reading))) = &self.read else {
            return;
        };
        if self.prompt.trim().is_empty() {
            return;
        }
        let read = reading.description.clone();
        let ask = self.plan.ask(&self.prompt, &read, self.seed, scene);
        self.plan.recalled(ui, &ask);
        let chosen = self.plan.variants(ui, &ask);
        self.plan.origin(ui);
        let place = self.plan.graph(ui, &ask.description, self.seed, scene, commands);
        if let Some(seed) = chosen {
            self.seed = seed;
        }
        if chosen.is_some() || place {
            self.remember();
            self.make(self.seed, scene, commands);
        }
    }

    /// Offers ends of the word at the caret; Tab takes the first.
    fn completions(&mut self, ui: &mut Ui) {
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
                let label = format!("Complete with {end}");
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

    /// The words were taken: the next ones replace them as they are typed.
    fn sent(&mut self, ctx: &egui::Context) {
        (self.offered, self.is_sent) = (None, true);
        let mut state = TextEditState::load(ctx, field_id()).unwrap_or_default();
        let all = CCursorRange::two(
            CCursor::default(),
            CCursor::new(egui::text::CharIndex(self.prompt.chars().count())),
        );
        state.cursor.set_char_range(Some(all));
        state.store(ctx, field_id());
    }

    fn complete(&mut self, ctx: &egui::Context, end: &str) {
        let Some(offered) = self.offered.take() else {
            return;
        };
        let caret = offered.take(&mut self.prompt, end);
        let mut state = TextEditState::load(ctx, field_id()).unwrap_or_default();
        let at = CCursor::new(egui::text::CharIndex(caret));
        state.cursor.set_char_range(Some(CCursorRange::one(at)));
        state.store(ctx, field_id());
    }

    fn recent(&mut self, ui: &mut Ui) {
        if self.history.is_empty() {
            return;
        }
        section(ui, "Typed before");
        for past in self.history.clone().iter().rev().take(5) {
            let text = egui::RichText::new(past).small().color(theme::text());
            let button = egui::Button::new(text).wrap().fill(theme::field());
            if ui.add(button).on_hover_text("Alt+Up and Alt+Down too").clicked() {
                self.prompt.clone_from(past);
                self.wants_focus = true;
            }
        }
    }

    /// Carries out the words as edits of the scene at hand; what must be asked first is shown.
    fn change(&mut self, scene: &Scene, commands: &mut Vec<Command>) {
        self.remember();
        self.changed_by.clone_from(&self.prompt);
        let reading = text::read_edit(&self.prompt, scene, self.seed);
        let edits = text::all_edits(&reading);
        // "The trees near the junction" ask for no other road.
        let no_things = reading.things.is_empty();
        let EditReading {
            questions,
            not_understood,
            notes,
            ..
        } = reading;
        self.notes = notes;
        self.notes.extend(not_understood.iter().map(unread));
        let road = text::read(&self.prompt)
            .ok()
            .filter(|_| no_things)
            .and_then(|r| r.description.road.kind);
        if let Some(road) = road {
            let name = format!("{road:?}").to_lowercase();
            self.notes.push(format!(
                "The road stays as it is: “New scene” makes the road: {name}."
            ));
        }
        self.questions = questions;
        if edits.is_empty() && self.questions.is_empty() && self.notes.is_empty() {
            self.notes.push("The words name no change of this scene.".into());
        }
        if !edits.is_empty() && self.questions.is_empty() {
            commands.push(Command::ApplyWords(self.prompt.clone(), edits));
        }
    }

    fn remember(&mut self) {
        self.history.retain(|p| *p != self.prompt);
        self.history.push(self.prompt.clone());
        if self.history.len() > HISTORY {
            self.history.remove(0);
        }
        self.back = 0;
    }

    fn recall(&mut self, step: i32) {
        let back = (self.back as i64 + i64::from(step)).clamp(0, self.history.len() as i64) as usize;
        if back != self.back {
            self.back = back;
            self.prompt = match back {
                0 => String::new(),
                n => self.history[self.history.len() - n].clone(),
            };
        }
    }

    /// Each phrase with what it became: to be changed, locked, re-rolled or taken out.
    fn chips(&mut self, ui: &mut Ui, scene: &Scene, commands: &mut Vec<Command>) {
        if self.prompt.trim().is_empty() {
            return;
        }
        if self.read.as_ref().is_none_or(|(of, _)| *of != self.prompt) {
            let reading = text::read(&self.prompt).map_err(|error| format!("{error:#}"));
            self.read = Some((self.prompt.clone(), reading));
        }
        let Some((_, Ok(reading))) = &self.read else {
            return;
        };
        let (mut gone, mut other, mut number) = (None, None, None);
        let read = &reading.description;
        self.plan.follow(&self.prompt);
        let plan = &mut self.plan;
        ui.add_space(4.0);
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing = vec2(4.0, 4.0);
            let mut shown = std::collections::BTreeSet::new();
            for phrase in &reading.phrases {
                // What says something of two objects is one phrase all the same.
                if !shown.insert((phrase.span.start, phrase.span.end)) {
                    continue;
                }
                super::chip::make_room(ui, &phrase.text);
                match phrase.became {
                    Became::Object(i) => {
                        if let Some(n) = plan.object_menu(ui, i, &phrase.text, scene, read, commands) {
                            number = phrases::with_number(&self.prompt, phrase, &read.foreground[i].noun, n);
                        }
                    }
                    Became::Time => {
                        style_menu(ui, phrase, TimeOfDay::ALL.iter().map(|t| t.name()), &mut other)
                    }
                    Became::Weather => {
                        style_menu(ui, phrase, Weather::ALL.iter().map(|w| w.name()), &mut other)
                    }
                    _ => {}
                }
                if chip(ui, phrase) {
                    gone = Some(phrase.clone());
                }
            }
        });
        // Carried out as a change, they were read another way, and `notes` says what of it was not understood.
        if self.changed_by != self.prompt {
            for unread_part in &reading.not_understood {
                warn(ui, &unread(unread_part));
            }
            for note in &reading.notes {
                ui.label(egui::RichText::new(note).small().color(theme::text_weak()));
            }
        }
        if let Some(prompt) = number {
            self.prompt = prompt;
        }
        if let Some((phrase, word)) = other {
            self.prompt = self.prompt.replacen(&phrase.text, word, 1);
        }
        if let Some(phrase) = gone {
            self.prompt = phrases::without(&self.prompt, &phrase);
        }
    }

    fn answers(&mut self, ui: &mut Ui, scene: &Scene, commands: &mut Vec<Command>) {
        for note in &self.notes {
            warn(ui, note);
        }
        let mut chosen = None;
        for question in &self.questions {
            section(ui, &question.text);
            for candidate in &question.candidates {
                let id = candidate.id;
                let text = format!(
                    "{} {}   {}",
                    candidate.class.replace('_', " "),
                    candidate.says(),
                    candidate.place
                );
                let button = egui::Button::new(text).min_size(vec2(ui.available_width(), theme::ROW));
                let response = ui.add(button);
                if response.hovered() && candidate.answer.is_none() && scene.frame().boxes.contains_key(&id) {
                    commands.push(Command::Select(Some(id)));
                }
                if response.clicked() {
                    chosen = Some((question.phrase.clone(), candidate.says()));
                }
            }
        }
        if let Some((phrase, answer)) = chosen {
            self.prompt = self.prompt.replacen(&phrase, &answer, 1);
            self.change(scene, commands);
        }
    }

    fn examples(&mut self, ui: &mut Ui) {
        section(ui, "Examples");
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

/// A chip whose words may be others of their kind.
fn style_menu(
    ui: &mut Ui,
    phrase: &Phrase,
    names: impl Iterator<Item = &'static str>,
    other: &mut Option<(Phrase, &'static str)>,
) {
    let response = super::chip::menu(ui, &phrase.text, |ui| {
        for name in names {
            if ui.button(name).clicked() {
                *other = Some((phrase.clone(), name));
                ui.close();
            }
        }
    });
    let label = format!("Change {}", phrase.text);
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &label));
}

fn chip(ui: &mut Ui, phrase: &Phrase) -> bool {
    let has_menu = matches!(phrase.became, Became::Object(_) | Became::Time | Became::Weather);
    let response = match has_menu {
        true => super::chip::end(ui),
        false => super::chip::plain(ui, &phrase.text),
    };
    let label = format!("Take out {}", phrase.text);
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &label));
    response
        .on_hover_text(format!("{}\nA click takes it out.", phrase.meaning))
        .clicked()
}

fn warn(ui: &mut Ui, text: &str) {
    ui.label(egui::RichText::new(text).color(theme::warn()));
}

fn unread(part: &Unread) -> String {
    match &part.why {
        Some(why) => format!("Not understood: “{}” ({why})", part.text),
        None => format!("Not understood: “{}”", part.text),
    }
}
