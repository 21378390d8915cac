//! The reading of a prompt: a chip for each part, doubtful parts, and the questions that come back.

use egui::accesskit::Role;
use egui::{Ui, WidgetInfo, vec2};

use super::field::PromptField;
use super::typed_text;
use crate::command::Command;
use crate::tools::things::ThingCommand;
use crate::tools::{Choose, ToolCommand};
use language::{t, tf};
use scene::Scene;
use scene::{TimeOfDay, Weather};
use widgets::chip;
use widgets::icons::section;
use widgets::theme;
use words::account::Why;
use words::answer::{answer, sentence, thing};
use words::hear::CheckedReading;
use words::reading::{ActKind, Reading};

impl PromptField {
    /// Draws a chip for each part of the reading, which can be changed, locked, re-rolled or removed. A change that was
    /// carried out has no chips.
    pub(super) fn chips(&mut self, ui: &mut Ui, scene: &Scene, commands: &mut Vec<Command>) {
        let said = self.said();
        let Some(both) = &self.read else { return };
        if self.is_sent && self.done.is_some() && !self.plan.made_of(&said) {
            return;
        }
        // (the chips are of the reading that Enter would carry out)
        let as_change = !both.is_described() && !self.plan.made_of(&said) && both.edited.is_ok();
        let (mut gone, mut number, mut other, mut beside) = (None, None, None, None);
        let takes_other;
        ui.add_space(4.0);
        if as_change {
            let Ok(edited) = &both.edited else { return };
            ui.horizontal_wrapped(|ui| {
                ui.spacing_mut().item_spacing = vec2(4.0, 4.0);
                for (i, act) in edited.heard.reading.acts.iter().enumerate() {
                    match &act.what {
                        ActKind::Add { things } if things.len() > 1 => {
                            for (k, t) in things.iter().enumerate() {
                                gone =
                                    gone.or(one(ui, &format!("adds {}", thing(t))).then_some((i, Some(k))));
                            }
                        }
                        what => gone = gone.or(one(ui, &sentence(what)).then_some((i, None))),
                    }
                }
                for (i, said) in edited.heard.reading.background.iter().enumerate() {
                    beside = beside.or(one(ui, &said.to_string()).then_some(i));
                }
            });
            takes_other = self.say_doubts(ui, &edited.heard);
        } else {
            let Ok(prompted) = &both.prompted else { return };
            self.plan.follow(&said);
            let (plan, described) = (&mut self.plan, &prompted.described);
            ui.horizontal_wrapped(|ui| {
                ui.spacing_mut().item_spacing = vec2(4.0, 4.0);
                for (i, act) in prompted.heard.reading.acts.iter().enumerate() {
                    match &act.what {
                        ActKind::Add { things } => {
                            for (k, t) in things.iter().enumerate() {
                                let text = thing(t);
                                let objects: Vec<usize> = (0..described.from.len())
                                    .filter(|o| described.from[*o] == (i, k))
                                    .collect();
                                chip::make_room(ui, &text);
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
                        ActKind::Time { what } => {
                            let names = TimeOfDay::ALL
                                .iter()
                                .map(|t| (t.name(), ActKind::Time { what: *t }));
                            style_menu(ui, t(what.name()), names, i, &mut other);
                            gone = gone.or(chip_end(ui, t(what.name())).then_some((i, None)));
                        }
                        ActKind::Weather { what } => {
                            let names = Weather::ALL
                                .iter()
                                .map(|t| (t.name(), ActKind::Weather { what: *t }));
                            style_menu(ui, t(what.name()), names, i, &mut other);
                            gone = gone.or(chip_end(ui, t(what.name())).then_some((i, None)));
                        }
                        what => gone = gone.or(one(ui, &sentence(what)).then_some((i, None))),
                    }
                }
                for (i, said) in prompted.heard.reading.background.iter().enumerate() {
                    beside = beside.or(one(ui, &said.described()).then_some(i));
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
                true => both.set_edit(scene, |r| typed_text::take_out(r, act, k)),
                false => both.set_prompt(|r| typed_text::take_out(r, act, k)),
            }
        }
        if let Some(i) = beside {
            let take_out = |r: &mut Reading| {
                r.background.remove(i);
            };
            match as_change {
                true => both.set_edit(scene, take_out),
                false => both.set_prompt(take_out),
            }
        }
        if let Some((act, k, n)) = number {
            both.set_prompt(|r| typed_text::set_number(r, act, k, n));
        }
        if let Some((act, what)) = other {
            both.set_prompt(|r| r.acts[act].what = what);
        }
    }

    /// Tells which words were doubtful or not read; after they were carried out the answer tells it. Returns true if
    /// the user takes the other reader's reading.
    fn say_doubts(&self, ui: &mut Ui, heard: &CheckedReading) -> bool {
        let said = self.said();
        for m in &heard.mended {
            let typed = m.span.of(&said);
            let text = tf!("“{typed}” is read as “{meant}”", typed = typed, meant = m.to);
            ui.label(egui::RichText::new(text).small().color(theme::text()));
        }
        if self.done.is_some() {
            return false;
        }
        for m in &heard.missing {
            let why = match m.why {
                Why::Unknown => t("Not understood"),
                Why::NotCarriedOut => t("No effect"),
                Why::TooLong => t("Too long, not read"),
            };
            warn(ui, &format!("{why}: “{}”", m.words));
        }
        if !heard.unsure.is_empty() {
            let text = t("Not sure that this is what was meant");
            ui.label(egui::RichText::new(text).small().color(theme::warn()));
        }
        let Some(other) = &heard.other else { return false };
        let text = tf!(
            "It may also mean: {answer}",
            answer = answer(other, None, &[], &[])
        );
        let text = egui::RichText::new(text).small().color(theme::text());
        let button = egui::Button::new(text).wrap().fill(theme::field());
        ui.add(button)
            .on_hover_text(t("A click takes this reading"))
            .clicked()
    }

    /// Draws the answer to the words in a sentence, and the questions that must be answered first.
    pub(super) fn answers(&mut self, ui: &mut Ui, scene: &Scene, commands: &mut Vec<Command>) {
        // (a question is drawn below, with its possible answers)
        if let Some(done) = self.done.as_ref().filter(|_| !self.asks) {
            ui.add(egui::Label::new(egui::RichText::new(done).color(theme::text())).wrap());
        }
        for note in &self.notes {
            warn(ui, note);
        }
        if !self.asks {
            return;
        }
        // (in another scene, the candidates are other boxes)
        if let Some(read) = &mut self.read
            && read.follow(scene, self.seed)
            && let Ok(edited) = &read.edited
        {
            (self.asks, self.done) = (edited.asks(), Some(edited.answer_on(scene)));
        }
        let Some(Ok(edited)) = self.read.as_ref().map(|r| &r.edited) else {
            return;
        };
        let (mut chosen, mut beside) = (None, None);
        for question in &edited.outcome.questions {
            section(ui, &question.text);
            for candidate in &question.candidates {
                let id = candidate.id;
                let text = format!(
                    "{} #{}   {}",
                    t(&candidate.class.replace('_', " ")),
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
                let text = format!("{}   {}", candidate.answer(), candidate.place);
                let button = egui::Button::new(text).min_size(vec2(ui.available_width(), theme::ROW));
                let response = ui.add(button);
                if response.hovered() && scene.background.get(candidate.id).is_some() {
                    let choose = ThingCommand::Choose(vec![candidate.id], Choose::Only);
                    commands.push(Command::Tools(ToolCommand::Thing(choose)));
                }
                if response.clicked() {
                    beside = Some((question.clause, candidate.said.clone()));
                }
            }
        }
        if let (Some((act, asked, id)), Some(read)) = (chosen, &mut self.read) {
            read.set_edit(scene, |r| typed_text::answer(r, act, &asked, id));
            self.change(scene, commands);
        } else if let (Some((clause, said)), Some(read)) = (beside, &mut self.read) {
            read.set_edit(scene, |r| r.background[clause] = said);
            self.change(scene, commands);
        }
    }
}

/// A chip whose value can be replaced by another of its kind.
fn style_menu(
    ui: &mut Ui,
    text: &str,
    names: impl Iterator<Item = (&'static str, ActKind)>,
    act: usize,
    other: &mut Option<(usize, ActKind)>,
) {
    chip::make_room(ui, text);
    let response = chip::menu(ui, text, |ui| {
        for (name, what) in names {
            if ui.button(t(name)).clicked() {
                *other = Some((act, what));
                ui.close();
            }
        }
    });
    let label = tf!("Change {what}", what = text);
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &label));
}

fn one(ui: &mut Ui, text: &str) -> bool {
    chip::make_room(ui, text);
    taken_out(chip::plain(ui, text), text)
}

fn chip_end(ui: &mut Ui, text: &str) -> bool {
    taken_out(chip::end(ui), text)
}

fn taken_out(response: egui::Response, text: &str) -> bool {
    let label = tf!("Take out {what}", what = text);
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &label));
    response.on_hover_text(t("A click takes it out")).clicked()
}

fn warn(ui: &mut Ui, text: &str) {
    ui.label(egui::RichText::new(text).color(theme::warn()));
}
