//! The lines of the palette.

use std::path::PathBuf;

use super::{Does, Item};
use crate::command::{Command, FileCommand, ViewCommand};
use crate::panes::{self, conditions};
use crate::shell::actions::ACTIONS;
use crate::shell::keymap::Keymap;
use crate::tools::ToolCommand;
use crate::tools::things::tree::TREES;
use crate::tools::things::{ThingCommand, ThingKind};
use scene::background::{LineKind, PostKind};
use scene::{Class, Scene, TimeOfDay, Weather};
use sensors::cameras;
use world::template::TEMPLATES;

/// Objects that are listed at most.
const MOST_OBJECTS: usize = 2000;
/// What is said of lines that change light and air.
const CONDITIONS: &str = "conditions";
/// What the window of settings holds, as it is looked for.
const SETTINGS: [&str; 6] = [
    "theme, dark or light",
    "class colours, safe for colour-blind people",
    "UI scale, size of everything",
    "memory for undo",
    "start screen",
    "assistants may drive this editor",
];

/// What the palette can offer.
pub struct Known<'a> {
    /// Keys of the actions.
    pub keymap: &'a Keymap,
    /// Files that were open.
    pub recent: &'a [PathBuf],
    /// What is open.
    pub scene: &'a Scene,
}

/// Every line there is.
pub(super) fn items(known: &Known<'_>) -> Vec<Item> {
    let (keymap, scene) = (known.keymap, known.scene);
    let mut out: Vec<Item> = ACTIONS
        .iter()
        .enumerate()
        .filter(|(_, a)| a.id != "palette")
        .map(|(i, a)| Item {
            title: a.title.to_owned(),
            right: keymap.first(a.id),
            does: Does::Action(i),
        })
        .collect();
    let mut add = |title: String, right: &str, command: Command| {
        out.push(Item {
            title,
            right: right.to_owned(),
            does: Does::Commands(match right {
                // Light and air are seen in pictures.
                CONDITIONS => vec![
                    command,
                    Command::View(ViewCommand::Cameras(cameras::pictures::VIEW.id)),
                ],
                _ => vec![command],
            }),
        });
    };
    for pane in panes::infos() {
        add(
            format!("Pane: {}", pane.title),
            "pane",
            Command::View(ViewCommand::ShowPane(pane.id)),
        );
    }
    for class in Class::OBJECTS {
        let title = format!("Place a box: {}", class.label());
        add(title, "box", Command::PlaceClass(class));
    }
    for (kind, name) in kinds() {
        let title = format!("Beside the road: {name}");
        add(
            title,
            "thing",
            Command::Tools(ToolCommand::Thing(ThingCommand::Take(kind))),
        );
    }
    for weather in Weather::ALL {
        let command = conditions::becomes(scene, scene.conditions.time, weather);
        add(format!("Weather: {}", weather.name()), CONDITIONS, command);
    }
    for time in TimeOfDay::ALL {
        let command = conditions::becomes(scene, time, scene.conditions.weather);
        add(format!("Time of day: {}", time.name()), CONDITIONS, command);
    }
    for view in cameras::views() {
        let title = format!("Cameras: {}", view.title.to_lowercase());
        add(title, "view", Command::View(ViewCommand::Cameras(view.id)));
    }
    for name in TEMPLATES {
        add(
            format!("New scene: {name}"),
            "file",
            Command::File(FileCommand::NewFrom(name)),
        );
    }
    for b in scene.frame().boxes.values().take(MOST_OBJECTS) {
        let title = format!("Choose {}, number {}", b.called(), b.id.0);
        add(title, "object", Command::Select(Some(b.id)));
    }
    for name in SETTINGS {
        add(format!("Settings: {name}"), "settings", Command::OpenSettings);
    }
    for path in known.recent {
        let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
        add(
            format!("Open {name}"),
            "recent file",
            Command::File(FileCommand::OpenPath(path.clone())),
        );
    }
    out
}

/// Every kind of thing that a tool draws or puts down.
fn kinds() -> Vec<(ThingKind, String)> {
    let trees = TREES.map(|(kind, name, _)| (ThingKind::Tree(kind), format!("{} tree", name.to_lowercase())));
    let lines = LineKind::ALL.map(|kind| (ThingKind::Line(kind), kind.name().to_owned()));
    let posts = PostKind::ALL.map(|kind| (ThingKind::Post(kind), kind.name().to_owned()));
    trees.into_iter().chain(lines).chain(posts).collect()
}
