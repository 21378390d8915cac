//! The list of all actions that a key can trigger, used for keys, the sheet of keys and the command palette.

mod editing;
mod window;

use std::sync::LazyLock;

use glam::DVec3;

use crate::command::Command;
use crate::tools::ToolCommand;
use editor::tools::{self, Shortcut};

/// Where a chord counts. If several apply, the later variant wins over the earlier one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum When {
    /// Everywhere.
    Always,
    /// While the pointer is over the 3D view.
    Over3d,
    /// While a box or a thing is chosen, and the tool in hand does not paint.
    Chosen,
    /// While a thing beside the road is chosen and the tool in hand is no brush.
    Things,
    /// While the tool in hand paints.
    Painting,
    /// While a staged result waits for a decision.
    Staged,
}

impl When {
    /// True if one chord may not have two actions in these places. In different places the later one wins.
    pub fn meets(self, other: Self) -> bool {
        self == other
    }
}

/// Sections of the sheet of keys.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ActionGroup {
    /// Tools.
    Tools,
    /// The chosen box.
    Selection,
    /// Views and panes.
    Views,
    /// Time.
    Time,
    /// Generation and versions.
    Generation,
    /// Files and history.
    File,
}

impl ActionGroup {
    /// Every group with its title.
    pub const ALL: [(ActionGroup, &'static str); 6] = [
        (ActionGroup::Tools, "Tools"),
        (ActionGroup::Selection, "Selection"),
        (ActionGroup::Views, "Views"),
        (ActionGroup::Time, "Time"),
        (ActionGroup::Generation, "Generation"),
        (ActionGroup::File, "File and edit"),
    ];
}

/// One action.
#[derive(Clone, Copy)]
pub struct ActionDef {
    /// Its id in key files.
    pub id: &'static str,
    /// Section of the sheet.
    pub group: ActionGroup,
    /// Its title for the user.
    pub title: &'static str,
    /// The condition under which its chords count.
    pub when: When,
    /// Default chords, separated by spaces.
    pub keys: &'static str,
    /// True if it repeats while the key is held.
    pub repeats: bool,
    does: Does,
}

/// Effect of an action.
#[derive(Clone, Copy)]
enum Does {
    /// Pushes a command.
    Command(fn() -> Command),
    /// The shortcut of a tool, by the action's id.
    Shortcut,
}

const fn action(
    group: ActionGroup,
    id: &'static str,
    title: &'static str,
    keys: &'static str,
    command: fn() -> Command,
) -> ActionDef {
    ActionDef {
        id,
        group,
        title,
        when: When::Always,
        keys,
        repeats: false,
        does: Does::Command(command),
    }
}

impl ActionDef {
    /// The command of the action.
    pub fn command(&self) -> Command {
        match self.does {
            Does::Command(command) => command(),
            Does::Shortcut => Command::Tools(ToolCommand::Shortcut(self.id)),
        }
    }

    const fn over_3d(mut self) -> Self {
        self.when = When::Over3d;
        self
    }

    const fn chosen(mut self) -> Self {
        self.when = When::Chosen;
        self
    }

    const fn things(mut self) -> Self {
        self.when = When::Things;
        self
    }

    const fn painting(mut self) -> Self {
        self.when = When::Painting;
        self
    }

    const fn staged(mut self) -> Self {
        self.when = When::Staged;
        self
    }

    const fn repeats(mut self) -> Self {
        self.repeats = true;
        self
    }
}

/// Every action: those of the tools, then all others.
pub static ACTIONS: LazyLock<Vec<ActionDef>> = LazyLock::new(|| {
    let of_tools = tools::all().iter().flat_map(|tool| tool.shortcuts).map(of_tool);
    let others = editing::ACTIONS.iter().chain(window::ACTIONS);
    of_tools.chain(others.copied()).collect()
});

/// The action for a shortcut of a tool.
fn of_tool(shortcut: &'static Shortcut) -> ActionDef {
    ActionDef {
        id: shortcut.id,
        group: match shortcut.when {
            tools::When::Chosen => ActionGroup::Selection,
            _ => ActionGroup::Tools,
        },
        title: shortcut.title,
        when: match shortcut.when {
            tools::When::Always => When::Always,
            tools::When::OverSpace => When::Over3d,
            tools::When::Chosen => When::Chosen,
        },
        keys: shortcut.keys,
        repeats: false,
        does: Does::Shortcut,
    }
}

/// Direction in which an arrow key nudges the chosen box, in the ego frame as the bird's-eye view shows it (forward is
/// up). No preset changes these keys.
pub fn nudge_direction(key: egui::Key) -> Option<DVec3> {
    use egui::Key;
    Some(match key {
        Key::ArrowUp => DVec3::X,
        Key::ArrowDown => -DVec3::X,
        Key::ArrowLeft => DVec3::Y,
        Key::ArrowRight => -DVec3::Y,
        Key::PageUp => DVec3::Z,
        Key::PageDown => -DVec3::Z,
        _ => return None,
    })
}
