//! The pointer and the keys on either view with a tool for things in hand, and clicks that choose things.

use egui::{Key, Modifiers, PointerButton, Response, Ui};
use glam::DVec2;

use crate::command::Command;
use crate::state::{Tool, UiState};
use crate::tools::{Choose, ToolCommand};
use editor::pick_things;
use scene::{Scene, ThingId};

use super::drag::{Pull, ThingDrag};
use super::{Phase, Pointer, ThingCommand, draw};

/// A press that draws.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThingPress {
    from_m: DVec2,
    at_m: DVec2,
    reach_m: f64,
    free: bool,
    moved: bool,
}

fn send(command: ThingCommand, commands: &mut Vec<Command>) {
    commands.push(Command::Tools(ToolCommand::Thing(command)));
}

impl ThingPress {
    /// The button went down; `reach_m` is how far the pointer may move and still click. `None` if things are locked.
    pub fn begin(
        state: &UiState,
        at_m: DVec2,
        free: bool,
        reach_m: f64,
        commands: &mut Vec<Command>,
    ) -> Option<Self> {
        if !state.tools.things.is_open() {
            let why = match state.tools.things.locked {
                true => "Background things are locked: their lock is in the list of layers",
                false => "Background things are hidden: their eye is in the list of layers",
            };
            commands.push(Command::Tools(ToolCommand::Note(why.to_owned())));
            return None;
        }
        let press = Self {
            from_m: at_m,
            at_m,
            reach_m,
            free,
            moved: false,
        };
        press.tell(Phase::Press, commands);
        Some(press)
    }

    /// The pointer moved.
    pub fn drag(&mut self, at_m: DVec2, free: bool, commands: &mut Vec<Command>) {
        let was = self.at_m;
        (self.at_m, self.free) = (at_m, free);
        self.moved |= self.from_m.distance(at_m) > self.reach_m;
        if self.moved && was != at_m {
            self.tell(Phase::Drag, commands);
        }
    }

    /// The button came up.
    pub fn end(self, commands: &mut Vec<Command>) {
        let clicked = !self.moved;
        self.tell(Phase::Release { clicked }, commands);
    }

    fn tell(&self, phase: Phase, commands: &mut Vec<Command>) {
        let pointer = Pointer {
            phase,
            at_m: self.at_m,
            reach_m: self.reach_m,
            free: self.free,
        };
        send(ThingCommand::Pointer(pointer), commands);
    }
}

/// Keys and the double click that belong to what is drawn point by point; they are taken from the frame's input.
pub(crate) fn keys(ui: &Ui, response: &Response, state: &UiState, commands: &mut Vec<Command>) {
    let drawn = !state.tools.things.draft.points_m().is_empty();
    if !drawn || state.thing_tool().is_none() || ui.ctx().text_edit_focused() {
        return;
    }
    let twice =
        response.contains_pointer() && ui.input(|i| i.pointer.button_double_clicked(PointerButton::Primary));
    if twice {
        send(ThingCommand::Finish, commands);
    }
    for (key, command) in [
        (Key::Escape, ThingCommand::Abandon),
        (Key::Enter, ThingCommand::Finish),
        (Key::Backspace, ThingCommand::DropPoint),
    ] {
        if ui.input_mut(|i| i.consume_key(Modifiers::NONE, key)) {
            send(command, commands);
        }
    }
}

/// What a press on the bird's-eye view takes hold of among the chosen things: a corner of the only one, or all of them.
pub(crate) fn held_things(
    scene: &Scene,
    state: &UiState,
    at_m: DVec2,
    reach_m: f64,
    shift: bool,
) -> Option<ThingDrag> {
    let things = &state.tools.things;
    if shift || things.chosen.is_empty() || state.tool != Tool::Select {
        return None;
    }
    let mut chosen = things.chosen_in(&scene.background);
    if let (Some(one), None, None) = (chosen.next(), chosen.next(), state.selected) {
        let p_m = pick_things::ground_in_world(&scene.frame().world_from_ego, at_m);
        if let Some(corner) = pick_things::corner_at(&one.form, p_m, reach_m) {
            return ThingDrag::new(scene, state, Pull::Corner(corner));
        }
    }
    let hit = draw::under(scene, state, at_m, reach_m)?;
    things
        .chosen
        .contains(&hit)
        .then(|| ThingDrag::new(scene, state, Pull::Place))?
}

/// A click on the bird's-eye view where no box is: chooses the thing there, or nothing.
pub(crate) fn click(
    scene: &Scene,
    state: &UiState,
    at_m: DVec2,
    reach_m: f64,
    add: bool,
    commands: &mut Vec<Command>,
) {
    choose(draw::under(scene, state, at_m, reach_m), add, commands);
}

/// Chooses a thing, or nothing.
pub(crate) fn choose(hit: Option<ThingId>, add: bool, commands: &mut Vec<Command>) {
    match (hit, add) {
        (Some(id), true) => send(ThingCommand::Choose(vec![id], Choose::Toggle), commands),
        (Some(id), false) => send(ThingCommand::Choose(vec![id], Choose::Only), commands),
        (None, true) => {}
        (None, false) => commands.push(Command::Select(None)),
    }
}

/// Chooses the things whose middle (ego frame, m) lies in an area, too.
pub(crate) fn in_area(
    scene: &Scene,
    state: &UiState,
    inside: impl Fn(DVec2) -> bool,
    commands: &mut Vec<Command>,
) {
    if state.tools.things.is_open() {
        let to_ego = scene.frame().world_from_ego.inverse();
        let here = |p: DVec2| inside(pick_things::ground_in_world(&to_ego, p));
        let ids = pick_things::things_in(&scene.background, here);
        if !ids.is_empty() {
            send(ThingCommand::Choose(ids, Choose::Add), commands);
        }
    }
}
