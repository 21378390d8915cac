//! Turns the pointer and the keys of a view into events of the tool in hand, and its answers into commands. Both large
//! views drive the tools through here.

use egui::{CursorIcon, Key as Pressed, PointerButton, Pos2, Response, Ui};

use editor::tools::{
    Context, Cursor, Event, Key, Modifiers, Pointer, ReadonlyContext, Response as Answer, ScreenProjection,
    ToolMark, ViewKind, Wants,
};
use scene::Scene;

use super::command::Command;
use super::pointer::{self, PointerEvent};
use super::screen_map::point;
use super::tools::ToolState;

/// Holder of the pointer while the button is down.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Hold {
    /// The button is up.
    #[default]
    Nobody,
    /// No tool until the button is released: the drag was cancelled, ended at the press, or moves the camera.
    Waits,
    /// The tool in hand.
    Tool,
}

/// The pointer of one view.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Driver {
    hold: Hold,
}

/// Context of a view for the tools.
#[derive(Clone, Copy)]
pub(super) struct ViewContext<'a> {
    /// The scene shown, a drag in progress included.
    pub scene: &'a Scene,
    /// The scene without the drag in progress.
    pub settled: &'a Scene,
    /// The view.
    pub view: &'a dyn ScreenProjection,
}

fn modifiers(m: egui::Modifiers) -> Modifiers {
    Modifiers {
        shift: m.shift,
        ctrl: m.ctrl || m.command,
        alt: m.alt,
    }
}

/// Sends an event to the tool in hand.
fn tell(seen: &ViewContext<'_>, tools: &mut ToolState, event: Event, commands: &mut Vec<Command>) -> Answer {
    let ToolState { toolbox, hand, .. } = tools;
    let tool = toolbox.tool_mut(hand.tool);
    let mut cx = Context {
        scene: seen.scene,
        settled: seen.settled,
        view: seen.view,
        hand,
    };
    let mut answer = tool.event(&mut cx, &event);
    pointer::carry_out(std::mem::take(&mut answer.acts), commands);
    answer
}

impl Driver {
    /// True while a tool draws, moves or marks something on this view.
    pub fn is_dragging(self) -> bool {
        self.hold == Hold::Tool
    }

    /// True while the button is down on this view.
    pub fn is_held(self) -> bool {
        self.hold != Hold::Nobody
    }

    /// Answers the pointer and the keys of this frame.
    pub fn drive(
        &mut self,
        ui: &Ui,
        response: &Response,
        steps: &[PointerEvent],
        seen: &ViewContext<'_>,
        tools: &mut ToolState,
        commands: &mut Vec<Command>,
    ) {
        let in_space = seen.view.kind() == ViewKind::Space;
        let (space, escape, held) = ui.input(|i| {
            (
                i.key_down(Pressed::Space),
                i.key_pressed(Pressed::Escape),
                i.modifiers,
            )
        });
        if escape && self.hold != Hold::Nobody {
            if self.hold == Hold::Tool {
                tell(seen, tools, Event::Cancel, commands);
                commands.push(Command::CancelDrag);
            }
            self.hold = Hold::Waits;
        }
        let at = |p: Pos2, m: egui::Modifiers| Pointer {
            at: point(p),
            held: modifiers(m),
        };
        for step in steps {
            match *step {
                PointerEvent::Press(PointerButton::Primary, p, m) if in_space && (m.alt || space) => {
                    if m.alt {
                        tell(seen, tools, Event::Pick(at(p, m)), commands);
                    }
                    self.hold = Hold::Waits;
                }
                PointerEvent::Press(PointerButton::Primary, p, m) if !space => {
                    let answer = tell(seen, tools, Event::Press(at(p, m)), commands);
                    self.hold = if answer.holds { Hold::Tool } else { Hold::Waits };
                    self.drag(seen, tools, at(p, m), commands);
                }
                PointerEvent::Move(p) => self.drag(seen, tools, at(p, held), commands),
                PointerEvent::Release(PointerButton::Primary, p) if self.hold != Hold::Nobody => {
                    self.drag(seen, tools, at(p, held), commands);
                    if self.hold == Hold::Tool {
                        tell(seen, tools, Event::Release(at(p, held)), commands);
                    }
                    self.hold = Hold::Nobody;
                }
                _ => {}
            }
        }
        // Keys come after the pointer: the click that ends an outline is one of its points.
        self.keys(ui, response, seen, tools, commands);
    }

    fn drag(
        &self,
        seen: &ViewContext<'_>,
        tools: &mut ToolState,
        pointer: Pointer,
        commands: &mut Vec<Command>,
    ) {
        if self.hold == Hold::Tool {
            tell(seen, tools, Event::Drag(pointer), commands);
        }
    }

    /// Handles the keys and the wheel that the tool in hand asks for, and takes them from the frame's input.
    fn keys(
        &mut self,
        ui: &Ui,
        response: &Response,
        seen: &ViewContext<'_>,
        tools: &mut ToolState,
        commands: &mut Vec<Command>,
    ) {
        let holds = self.hold == Hold::Tool;
        let wants = tools.toolbox.tool(tools.hand.tool).wants();
        match wants {
            Wants::Nothing => {}
            Wants::Wheel => {
                let notches = ui.input(|i| wheel(&i.events));
                if holds && notches != 0 {
                    tell(seen, tools, Event::Scroll(notches), commands);
                }
            }
            Wants::Drag => {
                if holds {
                    self.steer(ui, seen, tools, commands);
                }
            }
            Wants::Escape | Wants::Points => {
                let drawn_in = tools.toolbox.tool(tools.hand.tool).draws_in();
                let elsewhere = drawn_in.is_some_and(|kind| kind != seen.view.kind());
                if elsewhere || ui.ctx().text_edit_focused() {
                    return;
                }
                let twice = response.contains_pointer()
                    && ui.input(|i| i.pointer.button_double_clicked(PointerButton::Primary));
                if twice && wants == Wants::Points {
                    tell(seen, tools, Event::DoubleClick, commands);
                }
                let keys = [
                    (Pressed::Escape, Key::Escape),
                    (Pressed::Enter, Key::Enter),
                    (Pressed::Backspace, Key::Backspace),
                ];
                let count = if wants == Wants::Escape { 1 } else { keys.len() };
                for (pressed, key) in &keys[..count] {
                    if ui.input_mut(|i| took(&mut i.events, *pressed)) {
                        let event = Event::Key(*key, false, Modifiers::default());
                        tell(seen, tools, event, commands);
                    }
                }
            }
        }
    }

    /// Handles keys that steer a drag.
    fn steer(&mut self, ui: &Ui, seen: &ViewContext<'_>, tools: &mut ToolState, commands: &mut Vec<Command>) {
        let events = ui.input(|i| i.events.clone());
        let mut left = Vec::with_capacity(events.len());
        for event in events {
            let told = match event {
                egui::Event::Key {
                    key,
                    pressed: true,
                    repeat,
                    modifiers: m,
                    ..
                } if self.hold == Hold::Tool => {
                    steering(key).map(|key| Event::Key(key, repeat, modifiers(m)))
                }
                _ => None,
            };
            let answer = told
                .map(|event| tell(seen, tools, event, commands))
                .unwrap_or_default();
            if answer.done {
                self.hold = Hold::Waits;
            }
            if !answer.taken {
                left.push(event);
            }
        }
        ui.input_mut(|i| i.events = left);
    }

    /// The marks that the tool in hand draws over the view, and its cursor.
    pub fn sight(
        &self,
        ui: &Ui,
        hover: Option<Pos2>,
        seen: &ViewContext<'_>,
        tools: &ToolState,
    ) -> (Vec<ToolMark>, CursorIcon) {
        let held = ui.input(|i| modifiers(i.modifiers));
        let pointer = hover.map(|p| Pointer { at: point(p), held });
        let sight = ReadonlyContext {
            scene: seen.scene,
            settled: seen.settled,
            view: seen.view,
            hand: &tools.hand,
            pointer,
        };
        let tool = tools.toolbox.tool(tools.hand.tool);
        (tool.overlay(&sight), icon(tool.cursor(&sight)))
    }
}

fn icon(cursor: Cursor) -> CursorIcon {
    match cursor {
        Cursor::Default => CursorIcon::Default,
        Cursor::Crosshair => CursorIcon::Crosshair,
        Cursor::Hidden => CursorIcon::None,
        Cursor::Forbidden => CursorIcon::NotAllowed,
        Cursor::Pointing => CursorIcon::PointingHand,
        Cursor::Move => CursorIcon::Move,
        Cursor::Turn => CursorIcon::Alias,
    }
}

/// Takes a press of a key out of the events. Enter counts with any modifier, since the user who held Ctrl to take away
/// still holds it when the outline is closed. Other keys count without modifiers only.
fn took(events: &mut Vec<egui::Event>, wanted: Pressed) -> bool {
    let is_it = |event: &egui::Event| match event {
        egui::Event::Key {
            key,
            pressed: true,
            modifiers,
            ..
        } => *key == wanted && (wanted == Pressed::Enter || modifiers.is_none()),
        _ => false,
    };
    let at = events.iter().position(is_it);
    at.map(|at| events.remove(at)).is_some()
}

fn steering(key: Pressed) -> Option<Key> {
    Some(match key {
        Pressed::X => Key::Axis(0),
        Pressed::Y => Key::Axis(1),
        Pressed::Z => Key::Axis(2),
        Pressed::Enter => Key::Enter,
        Pressed::Backspace => Key::Backspace,
        Pressed::Num0 => Key::Digit('0'),
        Pressed::Num1 => Key::Digit('1'),
        Pressed::Num2 => Key::Digit('2'),
        Pressed::Num3 => Key::Digit('3'),
        Pressed::Num4 => Key::Digit('4'),
        Pressed::Num5 => Key::Digit('5'),
        Pressed::Num6 => Key::Digit('6'),
        Pressed::Num7 => Key::Digit('7'),
        Pressed::Num8 => Key::Digit('8'),
        Pressed::Num9 => Key::Digit('9'),
        Pressed::Period | Pressed::Comma => Key::Digit('.'),
        Pressed::Minus => Key::Digit('-'),
        _ => return None,
    })
}

/// Notches of the wheel, up positive.
fn wheel(events: &[egui::Event]) -> i32 {
    let notch = |e: &egui::Event| match e {
        egui::Event::MouseWheel { delta, .. } if delta.y > 0.0 => 1,
        egui::Event::MouseWheel { delta, .. } if delta.y < 0.0 => -1,
        _ => 0,
    };
    events.iter().map(notch).sum()
}
