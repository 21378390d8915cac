//! The lines of the palette.

use std::path::PathBuf;

use super::{Does, Item};
use crate::camera_views::offered_views;
use crate::command::{Command, FileCommand, ViewCommand};
use crate::panes::{self, conditions};
use crate::shell::actions::ACTIONS;
use crate::shell::keymap::Keymap;
use crate::state::called;
use crate::tools::ToolCommand;
use crate::tools::things::tree::TREES;
use crate::tools::things::{ThingCommand, ThingKind};
use language::{filled, t};
use scene::background::{LineKind, PostKind};
use scene::{Class, Scene, TimeOfDay, Weather};
use sensors::cameras::ViewId;
use world::template::TEMPLATES;

/// Most objects that are listed.
const MOST_OBJECTS: usize = 2000;
/// Text on the right of lines that change the conditions.
const CONDITIONS: &str = "conditions";
/// Contents of the settings window, as search texts.
const SETTINGS: [&str; 6] = [
    "theme, dark or light",
    "class colours, safe for colour-blind people",
    "UI scale, size of everything",
    "memory for undo",
    "start screen",
    "assistants may drive this editor",
];

/// Data that the lines of the palette are made of.
pub struct Known<'a> {
    /// Chords of the actions.
    pub keymap: &'a Keymap,
    /// Recent files.
    pub recent: &'a [PathBuf],
    /// The open scene.
    pub scene: &'a Scene,
    /// True if learned pictures are offered.
    pub learned: bool,
}

/// A title in English, and in the language of the interface.
type Title = [String; 2];

/// A title that contains a name; the name is a text of the interface.
fn titled(text: &str, name: &str) -> Title {
    titled_as(text, [name, t(name)])
}

/// A title that contains a name, given in English and in the language of the interface.
fn titled_as(text: &str, [english, own]: [&str; 2]) -> Title {
    [
        filled(text, &[("name", &english)]),
        filled(t(text), &[("name", &own)]),
    ]
}

/// A title for use inside a line: in lower case in English, unchanged in other languages.
fn inside(title: &str) -> [String; 2] {
    let (small, own) = (title.to_lowercase(), t(title));
    let own = if own == title {
        small.clone()
    } else {
        own.to_owned()
    };
    [small, own]
}

/// All lines.
pub(super) fn items(known: &Known<'_>) -> Vec<Item> {
    let (keymap, scene) = (known.keymap, known.scene);
    let mut out: Vec<Item> = ACTIONS
        .iter()
        .enumerate()
        .filter(|(_, a)| a.id != "palette")
        .map(|(i, a)| Item {
            title: a.title.to_owned(),
            shown: t(a.title).to_owned(),
            right: keymap.first(a.id),
            does: Does::Action(i),
        })
        .collect();
    let mut add = |[title, shown]: Title, right: &str, command: Command| {
        out.push(Item {
            title,
            shown,
            right: right.to_owned(),
            does: Does::Commands(match right {
                // Conditions are visible in pictures only.
                CONDITIONS => vec![command, Command::View(ViewCommand::ShowLight)],
                _ => vec![command],
            }),
        });
    };
    for pane in panes::infos() {
        add(
            titled("Pane: {name}", &pane.title),
            "pane",
            Command::View(ViewCommand::ShowPane(pane.id)),
        );
    }
    for class in Class::OBJECTS {
        let title = titled("Place a box: {name}", &class.label());
        add(title, "box", Command::PlaceClass(class));
    }
    for (kind, title) in kinds() {
        add(
            title,
            "thing",
            Command::Tools(ToolCommand::Thing(ThingCommand::Take(kind))),
        );
    }
    for weather in Weather::ALL {
        let command = conditions::becomes(scene, scene.conditions.time, weather);
        add(titled("Weather: {name}", weather.name()), CONDITIONS, command);
    }
    for time in TimeOfDay::ALL {
        let command = conditions::becomes(scene, time, scene.conditions.weather);
        add(titled("Time of day: {name}", time.name()), CONDITIONS, command);
    }
    for view in offered_views(known.learned, ViewId::default()) {
        let names = inside(view.title);
        let title = titled_as("Cameras: {name}", names.each_ref().map(String::as_str));
        add(title, "view", Command::View(ViewCommand::Cameras(view.id)));
    }
    for name in TEMPLATES {
        add(
            titled("New scene: {name}", name),
            "file",
            Command::File(FileCommand::NewFrom(name, scene::Lattice::OCC3D)),
        );
    }
    for b in scene.frame().boxes.values().take(MOST_OBJECTS) {
        let (text, id) = ("Choose {name}, number {id}", b.id.0);
        let title = [
            filled(text, &[("name", &b.called()), ("id", &id)]),
            filled(t(text), &[("name", &called(b)), ("id", &id)]),
        ];
        add(title, "object", Command::Select(Some(b.id)));
    }
    for name in SETTINGS {
        add(
            titled("Settings: {name}", name),
            "settings",
            Command::OpenSettings,
        );
    }
    for path in known.recent {
        let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
        add(
            titled_as("Open {name}", [&*name; 2]),
            "recent file",
            Command::File(FileCommand::OpenPath(path.clone())),
        );
    }
    out
}

/// Every kind of thing that has a tool.
fn kinds() -> Vec<(ThingKind, Title)> {
    let trees = TREES.map(|(kind, name, _)| {
        let names = inside(name);
        let names = names.each_ref().map(String::as_str);
        let title = titled_as("Beside the road: {name} tree", names);
        (ThingKind::Tree(kind), title)
    });
    let other = |name: &str| titled("Beside the road: {name}", name);
    let lines = LineKind::ALL.map(|kind| (ThingKind::Line(kind), other(kind.name())));
    let posts = PostKind::ALL.map(|kind| (ThingKind::Post(kind), other(kind.name())));
    trees.into_iter().chain(lines).chain(posts).collect()
}
