//! The keyboard: turns chords into commands, except while a text field has the focus. Letters without modifiers belong
//! to the tools, and to the flight while the right button is held in the 3D view.

use egui::{Context, Key, Modifiers};

use super::actions::{When, nudge_direction};
use super::keymap::{Chord, Keymap};
use crate::command::Command;
use crate::fly;
use crate::panes::id::PaneId;
use crate::state::UiState;
use crate::tools::{Hand, ToolCommand};

/// Actions that are allowed during a drag.
const DURING_A_DRAG: [&str; 5] = [
    "escape",
    "brush_smaller",
    "brush_larger",
    "brush_lower",
    "brush_higher",
];

/// State of the pointer, which some keys depend on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Hands {
    /// It flies in the 3D view, where letters steer.
    pub flying: bool,
    /// It drags with the button down; only the keys of [`DURING_A_DRAG`] count.
    pub dragging: bool,
    /// A staged result waits for a decision.
    pub staged: bool,
    /// It is over a floating window that shows no part of the scene; keys without Ctrl do not go to the scene.
    pub over_window: bool,
}

/// Commands of the keys pressed in this frame.
pub fn commands(ctx: &Context, keymap: &Keymap, state: &UiState, hands: Hands, commands: &mut Vec<Command>) {
    if ctx.text_edit_focused() {
        return;
    }
    let focused = ctx.memory(|m| m.focused().is_some());
    for Pressed {
        key,
        physical,
        modifiers,
        repeat,
    } in pressed(ctx)
    {
        let chord = Chord::pressed(key, modifiers);
        // The focused widget handles these keys itself.
        if focused && (is_arrow(key) || matches!(key, Key::Space | Key::Enter)) {
            continue;
        }
        // A running drag or flight can be ended wherever the pointer is.
        let under_way = hands.dragging || hands.flying || key == Key::Escape;
        if hands.over_window && !under_way && !chord.ctrl {
            continue;
        }
        if hands.flying && fly::steers(physical.unwrap_or(key)) && !chord.ctrl {
            continue;
        }
        if let Some(nudge) = nudge(chord, state).filter(|_| !hands.dragging) {
            commands.push(nudge);
            continue;
        }
        let over_3d = state.pointed.pane == Some(PaneId::VIEW3D);
        // With a brush in hand its own letters count.
        let brush = state.tool.def().is_brush;
        let chosen = state.any_chosen() && !state.tool.def().paints;
        let things = !state.tools.things.chosen.is_empty() && !brush;
        let paints = state.tool.def().paints;
        let applies = |when| match when {
            When::Always => true,
            When::Over3d => over_3d,
            When::Chosen => chosen,
            When::Things => things,
            When::Painting => paints,
            When::Staged => hands.staged,
        };
        // Shift can turn a key into another one, such as a backslash into `|`. Then the physical key counts.
        let on_key = || keymap.action(Chord::pressed(physical?, modifiers), applies);
        let Some(action) = keymap.action(chord, applies).or_else(on_key) else {
            continue;
        };
        if hands.dragging && !DURING_A_DRAG.contains(&action.id) {
            continue;
        }
        if !repeat || action.repeats {
            commands.push(action.command());
        }
    }
}

/// Longest time between two events of a held key, s; X11 waits 0.66 s before the first repetition.
const HELD_S: f64 = 0.8;

/// A key press.
struct Pressed {
    key: Key,
    /// The physical key, named as on a US keyboard.
    physical: Option<Key>,
    modifiers: Modifiers,
    repeat: bool,
}

fn pressed(ctx: &Context) -> Vec<Pressed> {
    let ctrl = |key| Pressed {
        key,
        physical: None,
        modifiers: Modifiers::CTRL,
        repeat: false,
    };
    let event = |e: &egui::Event| match e {
        egui::Event::Key {
            key,
            physical_key,
            pressed: true,
            repeat,
            modifiers,
        } => Some(Pressed {
            key: *key,
            physical: *physical_key,
            modifiers: *modifiers,
            repeat: *repeat,
        }),
        // Window systems turn these chords into events of their own.
        egui::Event::Copy => Some(ctrl(Key::C)),
        egui::Event::Cut => Some(ctrl(Key::X)),
        egui::Event::Paste(_) => Some(ctrl(Key::V)),
        _ => None,
    };
    let (mut keys, now_s): (Vec<Pressed>, f64) =
        ctx.input(|i| (i.events.iter().filter_map(event).collect(), i.time));
    // If Shift is released before its key, the key's release has another name, and its next press looks like a
    // repetition.
    let id = egui::Id::unique("last presses");
    ctx.data_mut(|data| {
        let last: &mut std::collections::HashMap<Key, f64> = data.get_temp_mut_or_default(id);
        for pressed in &mut keys {
            let before_s = last.insert(pressed.key, now_s);
            pressed.repeat &= before_s.is_some_and(|s| now_s - s < HELD_S);
        }
    });
    keys
}

fn is_arrow(key: Key) -> bool {
    matches!(
        key,
        Key::ArrowUp | Key::ArrowDown | Key::ArrowLeft | Key::ArrowRight
    )
}

/// The nudge of an arrow key: 0.1 m, with Shift 1 m, with Ctrl 0.01 m.
fn nudge(chord: Chord, hand: &Hand) -> Option<Command> {
    if !hand.any_chosen() {
        return None;
    }
    let step_m = match (chord.ctrl, chord.shift, chord.alt) {
        (true, _, false) => 0.01,
        (false, true, false) => 1.0,
        (false, false, false) => 0.1,
        _ => return None,
    };
    nudge_direction(chord.key).map(|d| Command::Tools(ToolCommand::Nudge(d * step_m)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::command::{FileCommand, GenerationCommand, ViewCommand};
    use crate::tools::Choose;
    use glam::DVec3;
    use scene::BoxId;

    fn of(key: Key, modifiers: Modifiers, state: &UiState, flying: bool) -> Vec<Command> {
        let hands = Hands {
            flying,
            ..Hands::default()
        };
        with(key, modifiers, state, hands)
    }

    fn with(key: Key, modifiers: Modifiers, state: &UiState, hands: Hands) -> Vec<Command> {
        let ctx = Context::default();
        let event = egui::Event::Key {
            key,
            physical_key: None,
            pressed: true,
            repeat: false,
            modifiers,
        };
        let input = egui::RawInput {
            events: vec![event],
            ..Default::default()
        };
        let (mut out, keymap) = (Vec::new(), Keymap::default());
        let _ = ctx.run_ui(input, |ui| commands(ui.ctx(), &keymap, state, hands, &mut out));
        out
    }

    #[test]
    fn letters_belong_to_tools_and_to_flight() {
        let mut state = UiState::default();
        assert_eq!(
            of(Key::A, Modifiers::NONE, &state, false),
            [Command::Tools(ToolCommand::Shortcut("add_box_tool"))]
        );
        assert!(of(Key::A, Modifiers::NONE, &state, true).is_empty());
        assert_eq!(
            of(Key::B, Modifiers::NONE, &state, false),
            [Command::Tools(ToolCommand::Shortcut("brush_tool"))]
        );
        state.pointed.pane = Some(PaneId::VIEW3D);
        assert_eq!(
            of(Key::B, Modifiers::NONE, &state, false),
            [Command::Tools(ToolCommand::Shortcut("voxel_brush"))]
        );
        assert_eq!(
            of(Key::E, Modifiers::NONE, &state, false),
            [Command::Tools(ToolCommand::Shortcut("toggle_erase"))]
        );
    }

    #[test]
    fn digits_and_x_paint_with_a_brush_in_hand_and_enter_accepts_what_waits() {
        let mut state = UiState::default();
        state.pointed.pane = Some(PaneId::VIEW3D);
        let top = Command::View(ViewCommand::Preset(viewport::ViewPreset::Top));
        assert_eq!(of(Key::Num7, Modifiers::NONE, &state, false), [top]);
        state.tool = editor::tools::voxel::ID;
        assert_eq!(
            of(Key::Num7, Modifiers::NONE, &state, false),
            [Command::PaintWith(6)]
        );
        assert_eq!(
            of(Key::Num0, Modifiers::NONE, &state, false),
            [Command::PaintWith(9)]
        );
        assert_eq!(
            of(Key::X, Modifiers::NONE, &state, false),
            [Command::PaintWithLast]
        );
        assert_eq!(of(Key::Enter, Modifiers::NONE, &state, false), []);
        let hands = Hands {
            staged: true,
            ..Hands::default()
        };
        let accept = Command::Generation(GenerationCommand::Decide(crate::command::Verdict::Accept));
        assert_eq!(with(Key::Enter, Modifiers::NONE, &state, hands), [accept]);
    }

    #[test]
    fn keys_wait_for_the_end_of_a_drag() {
        let mut state = UiState::default();
        state.choose(&[BoxId(3)], Choose::Only);
        let hands = Hands {
            dragging: true,
            ..Hands::default()
        };
        let pressed = |key, state: &UiState| with(key, Modifiers::NONE, state, hands);
        for key in [Key::X, Key::Z, Key::ArrowUp, Key::Delete] {
            assert_eq!(pressed(key, &state), [], "{key:?}");
        }
        assert_eq!(pressed(Key::OpenBracket, &state), [Command::BrushSize(-1)]);
        assert_eq!(pressed(Key::Escape, &state).len(), 1);
    }

    #[test]
    fn over_a_floating_window_only_chords_with_ctrl_count() {
        let mut state = UiState::default();
        state.choose(&[BoxId(3)], Choose::Only);
        let hands = Hands {
            over_window: true,
            ..Hands::default()
        };
        for key in [Key::B, Key::Delete, Key::ArrowUp] {
            assert_eq!(with(key, Modifiers::NONE, &state, hands), [], "{key:?}");
        }
        assert_eq!(with(Key::Z, Modifiers::CTRL, &state, hands), [Command::Undo]);
        assert_eq!(
            with(Key::Escape, Modifiers::NONE, &state, hands),
            [Command::Escape]
        );
    }

    #[test]
    fn arrows_nudge_what_is_chosen() {
        let mut state = UiState::default();
        assert!(of(Key::ArrowUp, Modifiers::NONE, &state, false).is_empty());
        state.selected = Some(BoxId(3));
        let up = of(Key::ArrowUp, Modifiers::NONE, &state, false);
        assert_eq!(up, [Command::Tools(ToolCommand::Nudge(DVec3::X * 0.1))]);
        let fine = of(Key::ArrowLeft, Modifiers::CTRL, &state, false);
        assert_eq!(fine, [Command::Tools(ToolCommand::Nudge(DVec3::Y * 0.01))]);
        assert_eq!(
            of(Key::Z, Modifiers::SHIFT, &state, false),
            [Command::Tools(ToolCommand::Turn(15.0))]
        );
    }

    /// On a US keyboard Shift+backslash arrives as `|`.
    #[test]
    fn what_shift_makes_another_key_of_still_counts() {
        let ctx = Context::default();
        let (mut out, keymap, state) = (Vec::new(), Keymap::default(), UiState::default());
        let input = egui::RawInput {
            events: vec![egui::Event::Key {
                key: Key::Pipe,
                physical_key: Some(Key::Backslash),
                pressed: true,
                repeat: false,
                modifiers: Modifiers::SHIFT,
            }],
            ..Default::default()
        };
        let _ = ctx.run_ui(input, |ui| {
            commands(ui.ctx(), &keymap, &state, Hands::default(), &mut out)
        });
        assert_eq!(out, [Command::View(ViewCommand::CycleCompare)]);
    }

    #[test]
    fn chords_with_ctrl_are_global() {
        let state = UiState::default();
        for (key, modifiers, command) in [
            (Key::Z, Modifiers::CTRL, Command::Undo),
            (Key::Z, Modifiers::CTRL | Modifiers::SHIFT, Command::Redo),
            (Key::Y, Modifiers::CTRL, Command::Redo),
            (
                Key::Enter,
                Modifiers::CTRL,
                Command::Generation(GenerationCommand::Generate { full: true }),
            ),
            (
                Key::Space,
                Modifiers::CTRL,
                Command::Generation(GenerationCommand::ToggleLive),
            ),
            (
                Key::S,
                Modifiers::CTRL | Modifiers::SHIFT,
                Command::File(FileCommand::SaveAs),
            ),
            (
                Key::Num2,
                Modifiers::CTRL | Modifiers::ALT,
                Command::View(ViewCommand::LookThrough(1)),
            ),
        ] {
            assert_eq!(of(key, modifiers, &state, true), [command]);
        }
    }
}
