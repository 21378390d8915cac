//! The command palette: every action, pane, workspace, class and recent file, found by a few letters.

use std::path::PathBuf;

use egui::{Id, Key, Modal, Ui, vec2};

use crate::command::{Command, FileCommand, ViewCommand};
use crate::panes;
use crate::shell::actions::ACTIONS;
use crate::shell::keymap::Keymap;
use crate::tools::ToolCommand;
use crate::tools::things::tree::TREES;
use crate::tools::things::{ThingCommand, ThingKind};
use scene::Class;
use scene::background::{LineKind, PostKind};
use widgets::theme;

/// Lines that are shown at most.
const SHOWN: usize = 12;

/// What has been typed, and the line chosen.
#[derive(Clone, Debug, Default)]
pub struct Palette {
    /// It is open.
    pub open: bool,
    query: String,
    chosen: usize,
}

/// What a line of the palette does.
enum Does {
    Action(usize),
    Command(Command),
}

struct Item {
    title: String,
    right: String,
    does: Does,
}

impl Palette {
    /// Opens it empty, or closes it.
    pub fn toggle(&mut self) {
        *self = Self {
            open: !self.open,
            ..Self::default()
        };
    }

    /// Draws it while it is open.
    pub fn show(&mut self, ui: &Ui, keymap: &Keymap, recent: &[PathBuf], commands: &mut Vec<Command>) {
        if !self.open {
            return;
        }
        let mut items = matching(items(keymap, recent), &self.query);
        let lines = items.len();
        let (up, down, enter) = ui.input_mut(|i| {
            let none = egui::Modifiers::NONE;
            (
                i.consume_key(none, Key::ArrowUp),
                i.consume_key(none, Key::ArrowDown),
                i.key_pressed(Key::Enter),
            )
        });
        if down {
            self.chosen += 1;
        }
        if up {
            self.chosen = self.chosen.saturating_sub(1);
        }
        self.chosen = self.chosen.min(lines.saturating_sub(1));
        let mut run = enter.then_some(self.chosen);
        let modal = Modal::new(Id::unique("palette")).frame(theme::dialog_frame(ui.style()));
        let shown = modal.show(ui.ctx(), |ui| {
            ui.set_width(520.0);
            let field = egui::TextEdit::singleline(&mut self.query)
                .hint_text("Type to find a command, a pane, a class, a recent file")
                .desired_width(f32::INFINITY)
                .margin(vec2(8.0, 6.0));
            let field = ui.add(field);
            field.request_focus();
            if field.changed() {
                self.chosen = 0;
            }
            ui.add_space(theme::GAP);
            ui.spacing_mut().item_spacing.y = 1.0;
            // The chosen line stays in sight.
            let first = self.chosen.saturating_sub(SHOWN - 1);
            for (i, item) in items.iter().enumerate().skip(first).take(SHOWN) {
                let name = egui::RichText::new(&item.title).color(theme::text());
                let right = egui::RichText::new(&item.right).color(theme::text_weak());
                let fill = if i == self.chosen {
                    theme::accent_fill()
                } else {
                    egui::Color32::TRANSPARENT
                };
                let button = egui::Button::new(name)
                    .shortcut_text(right)
                    .fill(fill)
                    .min_size(vec2(ui.available_width(), theme::ROW));
                if ui.add(button).clicked() {
                    run = Some(i);
                }
            }
            if lines == 0 {
                ui.label(egui::RichText::new("Nothing of that name").color(theme::text_weak()));
            }
        });
        if let Some(i) = run.filter(|i| *i < lines) {
            self.open = false;
            match items.swap_remove(i).does {
                Does::Action(i) => commands.push(ACTIONS[i].command()),
                Does::Command(command) => commands.push(command),
            }
        } else if shown.should_close() {
            self.open = false;
        }
    }
}

fn items(keymap: &Keymap, recent: &[PathBuf]) -> Vec<Item> {
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
    let mut add = |title: String, right: &str, command| {
        out.push(Item {
            title,
            right: right.to_owned(),
            does: Does::Command(command),
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
    for path in recent {
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

/// Those that hold the letters of the query in order, the best ones first.
fn matching(items: Vec<Item>, query: &str) -> Vec<Item> {
    let mut found: Vec<(u32, Item)> = items
        .into_iter()
        .filter_map(|item| Some((score(&item.title, query)?, item)))
        .collect();
    found.sort_by_key(|(score, _)| *score);
    found.into_iter().map(|(_, item)| item).collect()
}

/// How far apart the letters of a query lie in a text, first ones counted from the beginning of a word; none if they
/// are not all there in this order. Lower is better.
fn score(text: &str, query: &str) -> Option<u32> {
    let text: Vec<char> = text.to_lowercase().chars().collect();
    let (mut at, mut cost) = (0, 0);
    for wanted in query.to_lowercase().chars().filter(|c| !c.is_whitespace()) {
        let found = text[at..].iter().position(|c| *c == wanted)?;
        // The beginning of a word counts as near.
        let starts = |i: usize| i == 0 || !text[i - 1].is_alphanumeric();
        let word = (at..text.len()).find(|i| text[*i] == wanted && starts(*i));
        let (next, gap) = match word {
            Some(i) if found > 0 => (i, 1),
            _ => (at + found, found as u32),
        };
        cost += gap;
        at = next + 1;
    }
    Some(cost * 64 + text.len() as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_few_letters_find_the_command() {
        let keymap = Keymap::default();
        let first = |query: &str| matching(items(&keymap, &[]), query).remove(0).title;
        assert_eq!(first("undo"), "Undo");
        assert_eq!(first("gen ev"), "Generate everything");
        assert_eq!(first("cone"), "Place a box: traffic cone");
        assert_eq!(first("lidar"), "Pane: LiDAR sweep");
        assert_eq!(first("swap"), "Swap bird's-eye and 3D view");
        assert!(matching(items(&keymap, &[]), "zzzz").is_empty());
        assert_eq!(matching(items(&keymap, &[]), "").len(), items(&keymap, &[]).len());
    }
}
