//! Pointer events on a canvas since the last frame, one by one. In a slow frame a press, a movement and a release may
//! all come together, and none may be lost.

use egui::{Event, Modifiers, PointerButton, Pos2, Response, Ui, Vec2};

use editor::Edit;
use editor::tools::Act;

use super::command::Command;
use super::tools::ToolCommand;

/// One pointer event.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PointerEvent {
    /// A button went down on the canvas.
    Press(PointerButton, Pos2, Modifiers),
    /// The pointer moved to a place, on the canvas or off it.
    Move(Pos2),
    /// A button came up.
    Release(PointerButton, Pos2),
}

/// The events of this frame. Presses count only if the canvas itself is under the pointer, and no widget on it such as
/// the wipe line.
pub fn steps(ui: &Ui, response: &Response) -> Vec<PointerEvent> {
    let ours = response.hovered()
        || response.is_pointer_button_down_on()
        || response.dragged()
        || response.drag_stopped();
    let step = |event: &Event| match event {
        Event::PointerMoved(at) => Some(PointerEvent::Move(*at)),
        Event::PointerButton {
            pos,
            button,
            pressed: true,
            modifiers,
        } => {
            let here = ours && response.rect.contains(*pos);
            here.then_some(PointerEvent::Press(*button, *pos, *modifiers))
        }
        Event::PointerButton {
            pos,
            button,
            pressed: false,
            ..
        } => Some(PointerEvent::Release(*button, *pos)),
        _ => None,
    };
    ui.input(|i| i.events.iter().filter_map(step).collect())
}

/// The button that is held to move the view.
#[derive(Clone, Copy, Debug, Default)]
pub struct ViewDrag {
    button: Option<PointerButton>,
    last: Pos2,
}

impl ViewDrag {
    /// The pointer's movement while a button is held to move the view, with that button; `wants` says which buttons do.
    pub fn travel(
        &mut self,
        steps: &[PointerEvent],
        wants: impl Fn(PointerButton, Modifiers) -> bool,
    ) -> Option<(PointerButton, Vec2)> {
        let mut of = self.button;
        let mut travel = Vec2::ZERO;
        for step in steps {
            match *step {
                PointerEvent::Press(button, at, modifiers)
                    if self.button.is_none() && wants(button, modifiers) =>
                {
                    (self.button, self.last, of) = (Some(button), at, Some(button));
                }
                PointerEvent::Move(at) if self.button.is_some() => {
                    travel += at - self.last;
                    self.last = at;
                }
                PointerEvent::Release(button, _) if self.button == Some(button) => self.button = None,
                _ => {}
            }
        }
        of.map(|button| (button, travel))
    }
}

/// Pushes a preview. It replaces a preview pushed just before in this frame.
pub fn preview(commands: &mut Vec<Command>, edits: Vec<Edit>) {
    match commands.last_mut() {
        Some(Command::Preview(old)) => *old = edits,
        _ => commands.push(Command::Preview(edits)),
    }
}

/// Pushes the commands for a tool's acts.
pub fn carry_out(acts: Vec<Act>, commands: &mut Vec<Command>) {
    for act in acts {
        match act {
            Act::Preview(edits) => preview(commands, edits),
            // Of several tries in one frame, only the last is kept.
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
            PointerEvent::Move(pos2(5.0, 5.0)),
            PointerEvent::Press(PointerButton::Middle, pos2(10.0, 10.0), none),
            PointerEvent::Move(pos2(14.0, 11.0)),
            PointerEvent::Move(pos2(20.0, 12.0)),
            PointerEvent::Release(PointerButton::Middle, pos2(20.0, 12.0)),
            PointerEvent::Move(pos2(90.0, 90.0)),
        ];
        let middle = |button, _| button == PointerButton::Middle;
        let expected = Some((PointerButton::Middle, egui::vec2(10.0, 2.0)));
        assert_eq!(ViewDrag::default().travel(&all, middle), expected);
        // The same events, one per frame.
        let mut held = ViewDrag::default();
        let parts = all.map(|step| held.travel(&[step], middle).map_or(Vec2::ZERO, |(_, d)| d));
        assert_eq!(
            parts.into_iter().fold(Vec2::ZERO, |a, b| a + b),
            egui::vec2(10.0, 2.0)
        );
        assert_eq!(
            ViewDrag::default().travel(&all, |button, _| button == PointerButton::Primary),
            None
        );
    }
}
