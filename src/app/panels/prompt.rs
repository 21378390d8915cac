//! The prompt: words that become a scene or change the one at hand; each part that was read is a chip.

use egui::accesskit::Role;
use egui::text::{CCursor, CCursorRange};
use egui::text_edit::TextEditState;
use egui::{Key, Modifiers, Ui, WidgetInfo, vec2};

use super::completion::Completion;
use super::heard::{self, Both};
use super::prompt_plan::{Plan, Told};
use crate::app::command::Command;
use crate::app::icons::section;
use crate::app::text::doubts;
use crate::app::theme;
use crate::generation::place::description::{TimeOfDay, Weather};
use crate::generation::words::account::Why;
use crate::generation::words::answer::{answer, sentence, thing};
use crate::generation::words::hear::Heard;
use crate::generation::words::reading::What;
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
    draft: String,
    read: Option<Both>,
    /// What came of the words that were carried out last, and what must be answered first.
    done: Option<String>,
    asks: bool,
    /// Enter was pressed on words that describe a scene: which of the two is meant?
    offers: bool,
    notes: Vec<String>,
    wants_focus: bool,
    offered: Option<Completion>,
    is_sent: bool, // and not changed since
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
                self.answers(ui, scene, commands);
                self.chips(ui, scene, commands);
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
        if change && !self.offers && self.read.as_ref().is_some_and(Both::is_described) {
            // (a whole scene was described: which is meant is asked once, with what each would do)
            (self.offers, change) = (true, false);
        }
        let (changes, makes) = self.choices(ui);
        change |= changes;
        make |= makes;
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

    /// The words are others now: nothing that came of those before holds.
    fn touched(&mut self) {
        (self.done, self.asks, self.offers, self.is_sent) = (None, false, false, false);
        self.notes.clear();
    }

    /// The two things that words can do; where they describe a scene, with what each would do. Which was clicked.
    fn choices(&self, ui: &mut Ui) -> (bool, bool) {
        let some = !self.prompt.trim().is_empty();
        let button = |ui: &mut Ui, name: &str, hint: &str, first: bool| {
            let mut button = egui::Button::new(name);
            if first {
                button = button.fill(theme::accent_fill());
            }
            ui.add_enabled(some, button).on_hover_text(hint).clicked()
        };
        let hints = [
            "Enter: “remove the parked car”, “add two cones ahead”, “make it night”",
            "Ctrl+Enter: road, objects and style are made from the words",
        ];
        if !self.offers {
            let row = ui.horizontal(|ui| {
                let change = button(ui, "Change this scene", hints[0], true);
                (change, button(ui, "New scene", hints[1], false))
            });
            return row.inner;
        }
        let read = self.read.as_ref();
        let says = |ui: &mut Ui, text: Option<String>| {
            if let Some(text) = text {
                ui.label(egui::RichText::new(text).small().color(theme::text_weak()));
            }
        };
        ui.label("A scene is described. Enter again changes this one, Ctrl+Enter makes a new one.");
        let change = button(ui, "Change this scene", hints[0], true);
        says(ui, read.and_then(|r| r.edited.as_ref().ok()).map(|e| e.answer()));
        let make = button(ui, "New scene", hints[1], false);
        says(
            ui,
            read.and_then(|r| r.prompted.as_ref().ok()).map(|p| p.answer()),
        );
        (change, make)
    }

    /// Reads what is typed, if it is not read yet.
    fn listen(&mut self, scene: &Scene) {
        if self.prompt.trim().is_empty() {
            self.read = None;
            return;
        }
        match &mut self.read {
            Some(read) if read.text == self.prompt => {
                // (what was carried out is not carried out again for a preview)
                if !self.is_sent {
                    read.follow(scene, self.seed);
                }
            }
            _ => self.read = Some(Both::of(&self.prompt, scene, self.seed)),
        }
    }

    fn make(&mut self, seed: u64, scene: &Scene, commands: &mut Vec<Command>) {
        match self.read.as_ref().map(|r| &r.prompted) {
            Some(Ok(prompted)) => {
                let ask = self
                    .plan
                    .ask(&self.prompt, &prompted.described.description, seed, scene);
                self.done = Some(prompted.answer());
                (self.asks, self.notes) = (false, doubts(&prompted.heard));
                self.plan.makes(&self.prompt, seed);
                commands.push(Command::NewFromPrompt(Box::new(ask)));
            }
            Some(Err(error)) => self.notes = vec![error.clone()],
            None => {}
        }
    }

    /// Variants, how the last scene came about, and the scene graph.
    fn beyond_words(&mut self, ui: &mut Ui, scene: &Scene, commands: &mut Vec<Command>) {
        let Some(Ok(prompted)) = self.read.as_ref().map(|r| &r.prompted) else {
            return;
        };
        let read = prompted.described.description.clone();
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
        self.touched();
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
        (self.done, self.asks) = (Some(edited.answer()), edited.asks());
        self.notes = doubts(&edited.heard);
        if !edits.is_empty() && !self.asks {
            commands.push(Command::ApplyWords(self.prompt.clone(), edits));
            // (carried out again, the words are read again)
            self.read = None;
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

    /// Each part of what was read: to be changed, locked, re-rolled or taken out. Of a change that was carried out nothing is
    /// left to change.
    fn chips(&mut self, ui: &mut Ui, scene: &Scene, commands: &mut Vec<Command>) {
        let Some(both) = &self.read else { return };
        if self.is_sent && self.done.is_some() && !self.plan.made_of(&self.prompt) {
            return;
        }
        // (chips are of what Enter would do)
        let as_change = !both.is_described() && !self.plan.made_of(&self.prompt) && both.edited.is_ok();
        let (mut gone, mut number, mut other) = (None, None, None);
        let takes_other;
        ui.add_space(4.0);
        if as_change {
            let Ok(edited) = &both.edited else { return };
            ui.horizontal_wrapped(|ui| {
                ui.spacing_mut().item_spacing = vec2(4.0, 4.0);
                for (i, act) in edited.heard.reading.acts.iter().enumerate() {
                    match &act.what {
                        What::Add { things } if things.len() > 1 => {
                            for (k, t) in things.iter().enumerate() {
                                gone =
                                    gone.or(chip(ui, &format!("adds {}", thing(t))).then_some((i, Some(k))));
                            }
                        }
                        what => gone = gone.or(chip(ui, &sentence(what)).then_some((i, None))),
                    }
                }
            });
            takes_other = self.say_doubts(ui, &edited.heard);
        } else {
            let Ok(prompted) = &both.prompted else { return };
            self.plan.follow(&self.prompt);
            let (plan, described) = (&mut self.plan, &prompted.described);
            ui.horizontal_wrapped(|ui| {
                ui.spacing_mut().item_spacing = vec2(4.0, 4.0);
                for (i, act) in prompted.heard.reading.acts.iter().enumerate() {
                    match &act.what {
                        What::Add { things } => {
                            for (k, t) in things.iter().enumerate() {
                                let text = thing(t);
                                let objects: Vec<usize> = (0..described.from.len())
                                    .filter(|o| described.from[*o] == (i, k))
                                    .collect();
                                super::chip::make_room(ui, &text);
                                let read = &described.description;
                                if let Some(n) = plan.object_menu(ui, &objects, &text, scene, read, commands)
                                {
                                    number = Some((i, k, n));
                                }
                                if chip_end(ui, &text) {
                                    gone = Some((i, Some(k)));
                                }
                            }
                        }
                        What::Time { what } => {
                            let names = TimeOfDay::ALL.iter().map(|t| (t.name(), What::Time { what: *t }));
                            style_menu(ui, what.name(), names, i, &mut other);
                            gone = gone.or(chip_end(ui, what.name()).then_some((i, None)));
                        }
                        What::Weather { what } => {
                            let names = Weather::ALL
                                .iter()
                                .map(|t| (t.name(), What::Weather { what: *t }));
                            style_menu(ui, what.name(), names, i, &mut other);
                            gone = gone.or(chip_end(ui, what.name()).then_some((i, None)));
                        }
                        what => gone = gone.or(chip(ui, &sentence(what)).then_some((i, None))),
                    }
                }
                for (words, _) in &prompted.background {
                    ui.label(egui::RichText::new(words).small().color(theme::text_weak()));
                }
            });
            takes_other = self.say_doubts(ui, &prompted.heard);
        }
        let Some(both) = &mut self.read else { return };
        match (takes_other, as_change) {
            (true, true) => both.take_other_edit(scene),
            (true, false) => both.take_other_prompt(),
            _ => {}
        }
        if let Some((act, k)) = gone {
            match as_change {
                true => both.set_edit(scene, |r| heard::take_out(r, act, k)),
                false => both.set_prompt(|r| heard::take_out(r, act, k)),
            }
        }
        if let Some((act, k, n)) = number {
            both.set_prompt(|r| heard::set_number(r, act, k, n));
        }
        if let Some((act, what)) = other {
            both.set_prompt(|r| r.acts[act].what = what);
        }
    }

    /// What of the words is doubtful or not in the reading; not again after they were carried out. True if what the other
    /// reader says is taken.
    fn say_doubts(&self, ui: &mut Ui, heard: &Heard) -> bool {
        if self.done.is_some() {
            return false;
        }
        for m in &heard.missing {
            let why = match m.why {
                Why::Unknown => "Not understood",
                Why::NotCarriedOut => "No effect",
                Why::TooLong => "Too long, not read",
            };
            warn(ui, &format!("{why}: “{}”", m.words));
        }
        for m in &heard.mended {
            let typed = m.span.of(&self.prompt);
            let text = format!("“{typed}” is read as “{}”", m.to);
            ui.label(egui::RichText::new(text).small().color(theme::text_weak()));
        }
        if !heard.unsure.is_empty() {
            let text = "Not sure that this is what was meant";
            ui.label(egui::RichText::new(text).small().color(theme::warn()));
        }
        let Some(other) = &heard.other else { return false };
        let text = format!("It may also mean: {}", answer(other, None, &[], &[]));
        let text = egui::RichText::new(text).small().color(theme::text());
        let button = egui::Button::new(text).wrap().fill(theme::field());
        ui.add(button)
            .on_hover_text("A click takes this reading")
            .clicked()
    }

    /// What came of the words, in a sentence; what must be answered first.
    fn answers(&mut self, ui: &mut Ui, scene: &Scene, commands: &mut Vec<Command>) {
        // (a question stands below, with what can be answered)
        if let Some(done) = self.done.as_ref().filter(|_| !self.asks) {
            ui.add(egui::Label::new(egui::RichText::new(done).color(theme::text())).wrap());
        }
        for note in &self.notes {
            warn(ui, note);
        }
        if !self.asks {
            return;
        }
        // (of another scene other boxes are meant)
        if let Some(read) = &mut self.read
            && read.follow(scene, self.seed)
            && let Ok(edited) = &read.edited
        {
            (self.asks, self.done) = (edited.asks(), Some(edited.answer()));
        }
        let Some(Ok(edited)) = self.read.as_ref().map(|r| &r.edited) else {
            return;
        };
        let (mut chosen, mut said) = (None, None);
        for question in &edited.outcome.questions {
            section(ui, &question.text);
            for candidate in &question.candidates {
                let id = candidate.id;
                let text = format!(
                    "{} #{}   {}",
                    candidate.class.replace('_', " "),
                    id.0,
                    candidate.place
                );
                let button = egui::Button::new(text).min_size(vec2(ui.available_width(), theme::ROW));
                let response = ui.add(button);
                if response.hovered() && scene.frame().boxes.contains_key(&id) {
                    commands.push(Command::Select(Some(id)));
                }
                if response.clicked() {
                    chosen = Some((question.act, question.thing.clone(), id));
                }
            }
        }
        for question in &edited.things.questions {
            section(ui, &question.text);
            for candidate in &question.candidates {
                let text = format!("{} {}   {}", candidate.class, candidate.answer, candidate.place);
                let button = egui::Button::new(text).min_size(vec2(ui.available_width(), theme::ROW));
                if ui.add(button).clicked() {
                    said = Some((question.phrase.clone(), candidate.answer.clone()));
                }
            }
        }
        if let (Some((act, asked, id)), Some(read)) = (chosen, &mut self.read) {
            read.set_edit(scene, |r| heard::answer(r, act, &asked, id));
            self.change(scene, commands);
        } else if let Some((phrase, answer)) = said {
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

/// A chip whose value may be another of its kind.
fn style_menu(
    ui: &mut Ui,
    text: &str,
    names: impl Iterator<Item = (&'static str, What)>,
    act: usize,
    other: &mut Option<(usize, What)>,
) {
    super::chip::make_room(ui, text);
    let response = super::chip::menu(ui, text, |ui| {
        for (name, what) in names {
            if ui.button(name).clicked() {
                *other = Some((act, what));
                ui.close();
            }
        }
    });
    let label = format!("Change {text}");
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &label));
}

fn chip(ui: &mut Ui, text: &str) -> bool {
    super::chip::make_room(ui, text);
    taken_out(super::chip::plain(ui, text), text)
}

fn chip_end(ui: &mut Ui, text: &str) -> bool {
    taken_out(super::chip::end(ui), text)
}

fn taken_out(response: egui::Response, text: &str) -> bool {
    let label = format!("Take out {text}");
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &label));
    response.on_hover_text("A click takes it out").clicked()
}

fn warn(ui: &mut Ui, text: &str) {
    ui.label(egui::RichText::new(text).color(theme::warn()));
}
