//! What the pointer did on a canvas since the last frame, event by event: where frames are slow, a
//! press, a way and a release may all fall into one of them, and none may be lost.

use egui::{Event, Modifiers, PointerButton, Pos2, Response, Ui, Vec2};

use editor::Edit;
use editor::tools::Act;

use super::command::Command;
use super::tools::ToolCommand;

/// One event.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Step {
    /// A button went down on the canvas.
    Press(PointerButton, Pos2, Modifiers),
    /// The pointer is there now, on the canvas or off it.
    Move(Pos2),
    /// A button came up.
    Release(PointerButton, Pos2),
}

/// The events of this frame. Presses count if the canvas is what lies under the pointer, and nothing that stands on it, as
/// the line of a wipe does.
pub fn steps(ui: &Ui, response: &Response) -> Vec<Step> {
    let ours = response.hovered()
        || response.is_pointer_button_down_on()
        || response.dragged()
        || response.drag_stopped();
    let step = |event: &Event| match event {
        Event::PointerMoved(at) => Some(Step::Move(*at)),
        Event::PointerButton {
            pos,
            button,
            pressed: true,
            modifiers,
        } => {
            let here = ours && response.rect.contains(*pos);
            here.then_some(Step::Press(*button, *pos, *modifiers))
        }
        Event::PointerButton {
            pos,
            button,
            pressed: false,
            ..
        } => Some(Step::Release(*button, *pos)),
        _ => None,
    };
    ui.input(|i| i.events.iter().filter_map(step).collect())
}

/// A button that is held to move the view.
#[derive(Clone, Copy, Debug, Default)]
pub struct Held {
    button: Option<PointerButton>,
    last: Pos2,
}

impl Held {
    /// How far the pointer went while a button was held that `wants` lets move the view, and that button.
    pub fn travel(
        &mut self,
        steps: &[Step],
        wants: impl Fn(PointerButton, Modifiers) -> bool,
    ) -> Option<(PointerButton, Vec2)> {
        let mut of = self.button;
        let mut travel = Vec2::ZERO;
        for step in steps {
            match *step {
                Step::Press(button, at, modifiers) if self.button.is_none() && wants(button, modifiers) => {
                    (self.button, self.last, of) = (Some(button), at, Some(button));
                }
                Step::Move(at) if self.button.is_some() => {
                    travel += at - self.last;
                    self.last = at;
                }
                Step::Release(button, _) if self.button == Some(button) => self.button = None,
                _ => {}
            }
        }
        of.map(|button| (button, travel))
    }
}

/// Asks for a preview; one that was asked for before in this frame is of no use any more.
pub fn preview(commands: &mut Vec<Command>, edits: Vec<Edit>) {
    match commands.last_mut() {
        Some(Command::Preview(old)) => *old = edits,
        _ => commands.push(Command::Preview(edits)),
    }
}

/// Asks for what a tool answered.
pub fn carry_out(acts: Vec<Act>, commands: &mut Vec<Command>) {
    for act in acts {
        match act {
            Act::Preview(edits) => preview(commands, edits),
            // Of what is tried within one frame the last is shown.
            Act::Try(edits) => {
                if let Some(Command::Tools(ToolCommand::Act(Act::Try(_)))) = commands.last() {
                    commands.pop();
                }
                commands.push(Command::Tools(ToolCommand::Act(Act::Try(edits))));
            }
            Act::Cancel => commands.push(Command::CancelDrag),
            act => commands.push(Command::Tools(ToolCommand::Act(act))),
        }
    }
}

#[cfg(test)]
mod tests {
    use egui::pos2;

    use super::*;

    #[test]
    fn a_whole_drag_in_one_frame_moves_the_view() {
        let none = Modifiers::NONE;
        let all = [
            Step::Move(pos2(5.0, 5.0)),
            Step::Press(PointerButton::Middle, pos2(10.0, 10.0), none),
            Step::Move(pos2(14.0, 11.0)),
            Step::Move(pos2(20.0, 12.0)),
            Step::Release(PointerButton::Middle, pos2(20.0, 12.0)),
            Step::Move(pos2(90.0, 90.0)),
        ];
        let middle = |button, _| button == PointerButton::Middle;
        let expected = Some((PointerButton::Middle, egui::vec2(10.0, 2.0)));
        assert_eq!(Held::default().travel(&all, middle), expected);
        // The same, an event per frame.
        let mut held = Held::default();
        let parts = all.map(|step| held.travel(&[step], middle).map_or(Vec2::ZERO, |(_, d)| d));
        assert_eq!(
            parts.into_iter().fold(Vec2::ZERO, |a, b| a + b),
            egui::vec2(10.0, 2.0)
        );
        assert_eq!(
            Held::default().travel(&all, |button, _| button == PointerButton::Primary),
            None
        );
    }
}
