//! Carries out the commands of the tools for things.

use crate::shell::app::SceneloomApp;
use crate::tools::Choose;
use editor::Edit;
use scene::background::STOREY_M;
use scene::{Background, Form, ThingId};

use super::{Draft, Outcome, Pointer, Site, ThingCommand, words};

/// By how much a step makes things higher that have no storeys, m.
const STEP_M: f64 = 0.5;

impl SceneloomApp {
    /// Carries out one command of the tools for things.
    pub(crate) fn thing_command(&mut self, command: ThingCommand) {
        match command {
            ThingCommand::Pointer(pointer) => self.thing_pointer(&pointer),
            ThingCommand::Finish => {
                let mut draft = std::mem::take(&mut self.state.tools.things.draft);
                let outcome = draft.finish(&self.state.tools.things);
                self.state.tools.things.draft = draft;
                self.drawn(outcome);
            }
            ThingCommand::DropPoint => self.state.tools.things.draft.drop_point(),
            ThingCommand::Abandon => self.state.tools.things.draft = Draft::None,
            ThingCommand::Choose(ids, how) => self.state.choose_things(&ids, how),
            ThingCommand::Raise(steps) => self.raise(steps),
            ThingCommand::Apply(label, edits) => self.apply(label, &edits),
            ThingCommand::Commit(label) => self.document.commit_drag(label),
            ThingCommand::Take(kind) => self.state.take_thing(kind),
            ThingCommand::ToggleShown => self.show_things(!self.state.tools.things.shown),
            ThingCommand::ToggleLocked => self.lock_things(!self.state.tools.things.locked),
        }
    }

    fn show_things(&mut self, shown: bool) {
        self.state.tools.things.shown = shown;
        self.forget_closed();
    }

    fn lock_things(&mut self, locked: bool) {
        self.state.tools.things.locked = locked;
        self.forget_closed();
    }

    /// What cannot be seen or changed is not chosen either.
    fn forget_closed(&mut self) {
        let things = &mut self.state.tools.things;
        if !things.is_open() {
            things.chosen.clear();
            things.draft = Draft::None;
        }
    }

    fn thing_pointer(&mut self, pointer: &Pointer) {
        let Some(tool) = self.state.thing_tool() else {
            return;
        };
        let scene = self.document.settled_scene().clone();
        let to_ego = scene.frame().world_from_ego.inverse();
        let (mut trees_m, mut houses_m) = (Vec::new(), Vec::new());
        for thing in scene.background.iter() {
            match thing.form.in_frame(&to_ego) {
                Form::Tree(tree) => trees_m.push(tree.position_m),
                Form::Building(building) => houses_m.push(building.outline_m),
                _ => {}
            }
        }
        let site = Site {
            layout: &scene.frame().layout,
            trees_m: &trees_m,
            houses_m: &houses_m,
            brush_m: self.state.brush_m,
        };
        let things = &mut self.state.tools.things;
        let mut draft = std::mem::take(&mut things.draft);
        let outcome = draft.pointer(tool, pointer, &site, things);
        things.draft = draft;
        self.drawn(outcome);
    }

    /// Shows or adds what a tool has drawn.
    fn drawn(&mut self, outcome: Outcome) {
        let world_from_ego = self.document.settled_scene().frame().world_from_ego;
        let in_world =
            |forms: Vec<Form>| -> Vec<Form> { forms.iter().map(|f| f.in_frame(&world_from_ego)).collect() };
        match outcome {
            Outcome::Nothing => {}
            Outcome::Preview(forms) => {
                let edit = Edit::AddThings {
                    forms: in_world(forms),
                };
                // What cannot be is said when the button comes up.
                if self.document.preview(&edit).is_err() {
                    self.document.cancel_drag();
                }
            }
            Outcome::Add(forms) => self.add_things("Add", in_world(forms), Vec::new()),
            Outcome::Refused(text) => {
                self.document.cancel_drag();
                self.note(&text);
            }
        }
    }

    /// Adds things (world frame), with other edits, as one undo step, and chooses them.
    pub(crate) fn add_things(&mut self, verb: &str, forms: Vec<Form>, mut edits: Vec<Edit>) {
        let named: Vec<&Form> = forms.iter().collect();
        let label = format!("{verb} {}", words::count(&named));
        let before = self.document.settled_scene().background.clone();
        edits.push(Edit::AddThings { forms });
        self.apply(label, &edits);
        let new = added(&before, &self.document.settled_scene().background);
        self.state.choose_things(&new, Choose::Only);
    }

    /// Brings the chosen things into the middle of both large views.
    pub(crate) fn frame_things(&mut self) {
        let scene = self.document.scene();
        let to_ego = scene.frame().world_from_ego.inverse();
        let chosen = self.state.tools.things.chosen_in(&scene.background);
        let bounds = chosen.map(|t| t.form.in_frame(&to_ego).bounds_m());
        if let Some((min, max)) = bounds.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))) {
            self.frame_at(((min + max) / 2.0).extend(1.0));
        }
    }

    fn raise(&mut self, steps: i32) {
        let background = self.document.settled_scene().background.clone();
        let chosen: Vec<_> = self.state.tools.things.chosen_in(&background).collect();
        let has_storeys = |form: &Form| matches!(form, Form::Building(_));
        let edits = [true, false].into_iter().filter_map(|storeys| {
            let ids: Vec<ThingId> = chosen
                .iter()
                .filter(|t| has_storeys(&t.form) == storeys)
                .map(|t| t.id)
                .collect();
            let by_m = f64::from(steps) * if storeys { STOREY_M } else { STEP_M };
            (!ids.is_empty()).then_some(Edit::RaiseThings { ids, by_m })
        });
        let edits: Vec<Edit> = edits.collect();
        if !edits.is_empty() {
            let forms: Vec<&Form> = chosen.iter().map(|t| &t.form).collect();
            let verb = if steps > 0 { "Raise" } else { "Lower" };
            self.apply(format!("{verb} {}", words::count(&forms)), &edits);
        }
    }
}

/// Ids of things that were not there before.
fn added(before: &Background, after: &Background) -> Vec<ThingId> {
    let new = after.iter().filter(|t| before.get(t.id).is_none());
    new.map(|t| t.id).collect()
}
