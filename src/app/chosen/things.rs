//! Carries out the commands of the tools for things.

use crate::shell::app::SceneloomApp;
use crate::tools::Choose;
use editor::Edit;
use language::{filled, t, tf};
use scene::background::STOREY_M;
use scene::{Background, Form, ThingId};

use crate::tools::things::{ThingCommand, words};

/// Step in height for things that have no storeys, m.
const STEP_M: f64 = 0.5;

impl SceneloomApp {
    /// Carries out one command of the tools for things.
    pub(crate) fn thing_command(&mut self, command: ThingCommand) {
        match command {
            ThingCommand::Choose(ids, how) => self.state.choose_things(&ids, how),
            ThingCommand::Raise(steps) => self.raise(steps),
            ThingCommand::Apply(label, edits) => self.apply(label, &edits),
            ThingCommand::Commit(label) => self.document.commit_drag(label),
            ThingCommand::Take(kind) => {
                self.state.tools.toolbox.put_down();
                self.state.take_thing(kind);
            }
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

    /// Clears the selection of things while they are hidden or locked, and puts their tool down.
    fn forget_closed(&mut self) {
        if !self.state.tools.things.is_open() {
            self.state.tools.things.chosen.clear();
            self.state.tools.toolbox.put_down();
        }
    }

    /// Adds things (world frame), with other edits, as one undo step, and chooses them. `label` names the step:
    /// English, with a place for `{things}`.
    pub(crate) fn add_things(&mut self, label: &str, forms: Vec<Form>, mut edits: Vec<Edit>) {
        let named: Vec<&Form> = forms.iter().collect();
        let label = filled(t(label), &[("things", &words::count(&named))]);
        let before = self.document.settled_scene().background.clone();
        edits.push(Edit::AddThings { forms });
        self.apply(label, &edits);
        let new = added(&before, &self.document.settled_scene().background);
        self.state.choose_things(&new, Choose::Only);
    }

    /// Centres the chosen things in both large views.
    pub(crate) fn frame_things(&mut self) {
        let scene = self.document.scene();
        let chosen = self.state.tools.things.chosen_in(&scene.background);
        let bounds = chosen.map(|t| t.form.bounds_m());
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
            let things = words::count(&forms);
            let label = match steps > 0 {
                true => tf!("Raise {things}", things = things),
                false => tf!("Lower {things}", things = things),
            };
            self.apply(label, &edits);
        }
    }
}

/// Ids of things that were not there before.
fn added(before: &Background, after: &Background) -> Vec<ThingId> {
    let new = after.iter().filter(|t| before.get(t.id).is_none());
    new.map(|t| t.id).collect()
}
