//! The keyboard: chords to commands. Nothing while a text field has the focus; bare letters belong
//! to the tools, and to the flight while the right button is held in the 3D view.

use egui::{Context, Key, Modifiers};
use glam::DVec3;

use crate::viewport::ViewPreset;

use super::command::Command;
use super::state::{Pane, Tool, UiState, VoxelVerb};

/// A chord and what it is for, as the sheet of keys shows it.
pub const SHEET: [(&str, &[(&str, &str)]); 5] = [
    (
        "Tools",
        &[
            ("V", "Select"),
            ("B", "Brush; voxel brush over the 3D view"),
            ("A", "Add box"),
            ("[  ]", "Brush size (also Ctrl+wheel)"),
            ("E, hold Shift", "Erase"),
            ("T  R  Y", "Voxels: attach, remove, recolour"),
            ("Esc", "Cancel the drag, drop the selection"),
        ],
    ),
    (
        "Selection",
        &[
            ("Del", "Delete"),
            ("Ctrl+D", "Duplicate"),
            ("Arrows, PgUp PgDn", "Nudge 0.1 m (Shift 1 m, Ctrl 0.01 m)"),
            ("Z  X", "Turn left, right 1° (Shift 15°)"),
            ("C, Q", "Turn 90°, 180°"),
            ("J, Shift+J", "Next, previous box"),
        ],
    ),
    (
        "Views",
        &[
            ("Middle drag", "Orbit; pan in the bird's-eye view"),
            ("Shift+middle, Space+left", "Pan"),
            ("Wheel", "Zoom to the pointer"),
            ("Hold right + WASD QE", "Fly (Shift fast, Alt slow)"),
            ("F, Home", "Frame selection, frame all"),
            ("7  1  3  5  0", "3D view: top, front, side, perspective, ego"),
            ("Ctrl+Alt+1…6", "Look through a camera"),
            ("Tab, G", "Swap views, grid"),
        ],
    ),
    (
        "Generation",
        &[
            ("Ctrl+Enter", "Generate everything"),
            ("Ctrl+Space", "Live on or off"),
            ("Ctrl+Backspace", "Cancel"),
        ],
    ),
    (
        "File and edit",
        &[
            ("Ctrl+Z", "Undo"),
            ("Ctrl+Shift+Z, Ctrl+Y", "Redo"),
            ("Ctrl+N  O  S  Shift+S", "New, open, save, save as"),
            ("F12", "Screenshot of the 3D view"),
            ("F1 or ?", "This sheet"),
        ],
    ),
];

/// Commands of the keys pressed in this frame.
pub fn commands(ctx: &Context, state: &mut UiState, flying: bool, commands: &mut Vec<Command>) {
    if ctx.text_edit_focused() {
        return;
    }
    tab(ctx, commands);
    for (key, modifiers, repeat) in pressed(ctx) {
        let command = if modifiers.command || modifiers.ctrl {
            with_ctrl(key, modifiers, repeat, state)
        } else if modifiers.alt || flying && is_flight(key) {
            None
        } else {
            bare(key, modifiers.shift, repeat, state)
        };
        commands.extend(command);
    }
}

/// Tab belongs to the views here, so what egui has given the focus for it loses it again.
fn tab(ctx: &Context, commands: &mut Vec<Command>) {
    if ctx.input(|i| i.modifiers.is_none() && i.key_pressed(Key::Tab)) {
        commands.push(Command::SwapPanes);
        ctx.memory_mut(|m| {
            if let Some(id) = m.focused() {
                m.surrender_focus(id);
            }
        });
    }
}

fn pressed(ctx: &Context) -> Vec<(Key, Modifiers, bool)> {
    let event = |e: &egui::Event| match e {
        egui::Event::Key {
            key,
            pressed: true,
            repeat,
            modifiers,
            ..
        } => Some((*key, *modifiers, *repeat)),
        // Window systems turn these chords into events of their own.
        _ => None,
    };
    ctx.input(|i| i.events.iter().filter_map(event).collect())
}

fn is_flight(key: Key) -> bool {
    matches!(key, Key::W | Key::A | Key::S | Key::D | Key::Q | Key::E)
}

fn with_ctrl(key: Key, m: Modifiers, repeat: bool, state: &UiState) -> Option<Command> {
    if m.alt {
        let digits = [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5, Key::Num6];
        return digits.iter().position(|d| *d == key).map(Command::LookThrough);
    }
    if let Some(nudge) = nudge(key, 0.01, state) {
        return Some(nudge);
    }
    match key {
        Key::Z if m.shift => return Some(Command::Redo),
        Key::Z => return Some(Command::Undo),
        Key::Y => return Some(Command::Redo),
        _ => {}
    }
    if repeat {
        return None;
    }
    Some(match key {
        Key::S if m.shift => Command::SaveAs,
        Key::S => Command::Save,
        Key::O => Command::Open,
        Key::N => Command::New,
        Key::Q => Command::Quit,
        Key::D => Command::DuplicateSelected,
        Key::Enter => Command::Generate { full: true },
        Key::Space => Command::ToggleLive,
        Key::Backspace => Command::CancelGeneration,
        _ => return None,
    })
}

fn nudge(key: Key, step_m: f64, state: &UiState) -> Option<Command> {
    state.selected?;
    // Arrows as the bird's-eye view shows them: forward is up.
    let direction = match key {
        Key::ArrowUp => DVec3::X,
        Key::ArrowDown => -DVec3::X,
        Key::ArrowLeft => DVec3::Y,
        Key::ArrowRight => -DVec3::Y,
        Key::PageUp => DVec3::Z,
        Key::PageDown => -DVec3::Z,
        _ => return None,
    };
    Some(Command::Nudge(direction * step_m))
}

fn bare(key: Key, shift: bool, repeat: bool, state: &mut UiState) -> Option<Command> {
    if let Some(nudge) = nudge(key, if shift { 1.0 } else { 0.1 }, state) {
        return Some(nudge);
    }
    let turn = if shift { 15.0 } else { 1.0 };
    match key {
        Key::Z if state.selected.is_some() => return Some(Command::Turn(turn)),
        Key::X if state.selected.is_some() => return Some(Command::Turn(-turn)),
        Key::OpenBracket | Key::OpenCurlyBracket => return Some(Command::BrushSize(-1)),
        Key::CloseBracket | Key::CloseCurlyBracket => return Some(Command::BrushSize(1)),
        _ => {}
    }
    if repeat {
        return None;
    }
    let over_3d = state.hovered_pane == Some(Pane::View3d);
    Some(match key {
        Key::V => Command::Tool(Tool::Select),
        Key::B if over_3d && state.tool != Tool::Voxel => Command::Tool(Tool::Voxel),
        Key::B => Command::Tool(Tool::Brush),
        Key::A => Command::Tool(Tool::AddBox),
        Key::E => {
            state.erase = !state.erase;
            return None;
        }
        Key::T => Command::Verb(VoxelVerb::Attach),
        Key::R => Command::Verb(VoxelVerb::Remove),
        Key::Y => Command::Verb(VoxelVerb::Recolour),
        Key::C if state.selected.is_some() => Command::Turn(90.0),
        Key::Q if state.selected.is_some() => Command::Turn(180.0),
        Key::J => Command::SelectNext(if shift { -1 } else { 1 }),
        Key::Delete | Key::Backspace => Command::DeleteSelected,
        Key::F => Command::FrameSelection,
        Key::Home => Command::FrameAll,
        Key::G => Command::ToggleGrid,
        Key::Num7 if over_3d => Command::View(ViewPreset::Top),
        Key::Num1 if over_3d => Command::View(ViewPreset::Front),
        Key::Num3 if over_3d => Command::View(ViewPreset::Side),
        Key::Num5 if over_3d => Command::View(ViewPreset::Perspective),
        Key::Num0 if over_3d => Command::View(ViewPreset::Ego),
        Key::F12 => Command::QuickShot,
        Key::F1 | Key::Questionmark => Command::ToggleKeys,
        Key::Escape => Command::Escape,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::BoxId;

    fn of(key: Key, modifiers: Modifiers, state: &mut UiState, flying: bool) -> Vec<Command> {
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
        let mut out = Vec::new();
        let _ = ctx.run_ui(input, |ui| commands(ui.ctx(), state, flying, &mut out));
        out
    }

    #[test]
    fn letters_belong_to_tools_and_to_flight() {
        let mut state = UiState::default();
        assert_eq!(
            of(Key::A, Modifiers::NONE, &mut state, false),
            [Command::Tool(Tool::AddBox)]
        );
        assert!(of(Key::A, Modifiers::NONE, &mut state, true).is_empty());
        assert_eq!(
            of(Key::B, Modifiers::NONE, &mut state, false),
            [Command::Tool(Tool::Brush)]
        );
        state.hovered_pane = Some(Pane::View3d);
        assert_eq!(
            of(Key::B, Modifiers::NONE, &mut state, false),
            [Command::Tool(Tool::Voxel)]
        );
        of(Key::E, Modifiers::NONE, &mut state, false);
        assert!(state.erase);
    }

    #[test]
    fn arrows_nudge_what_is_chosen() {
        let mut state = UiState::default();
        assert!(of(Key::ArrowUp, Modifiers::NONE, &mut state, false).is_empty());
        state.selected = Some(BoxId(3));
        let up = of(Key::ArrowUp, Modifiers::NONE, &mut state, false);
        assert_eq!(up, [Command::Nudge(DVec3::X * 0.1)]);
        let fine = of(Key::ArrowLeft, Modifiers::CTRL, &mut state, false);
        assert_eq!(fine, [Command::Nudge(DVec3::Y * 0.01)]);
        assert_eq!(
            of(Key::Z, Modifiers::SHIFT, &mut state, false),
            [Command::Turn(15.0)]
        );
    }

    #[test]
    fn chords_with_ctrl_are_global() {
        let mut state = UiState::default();
        for (key, modifiers, command) in [
            (Key::Z, Modifiers::CTRL, Command::Undo),
            (Key::Z, Modifiers::CTRL | Modifiers::SHIFT, Command::Redo),
            (Key::Y, Modifiers::CTRL, Command::Redo),
            (Key::Enter, Modifiers::CTRL, Command::Generate { full: true }),
            (Key::Space, Modifiers::CTRL, Command::ToggleLive),
            (Key::S, Modifiers::CTRL | Modifiers::SHIFT, Command::SaveAs),
            (
                Key::Num2,
                Modifiers::CTRL | Modifiers::ALT,
                Command::LookThrough(1),
            ),
        ] {
            assert_eq!(of(key, modifiers, &mut state, true), [command]);
        }
    }
}
