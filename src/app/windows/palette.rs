//! The command palette: finds every command, setting and object by a few letters.

mod items;

use egui::{Id, Key, Modal, Ui, vec2};

use crate::command::Command;
use crate::shell::actions::ACTIONS;
pub use items::Known;
use language::t;
use widgets::theme;

/// Most lines that are shown.
const SHOWN: usize = 12;

/// The typed query, and the chosen line.
#[derive(Clone, Debug, Default)]
pub struct Palette {
    /// True if it is open.
    pub open: bool,
    query: String,
    chosen: usize,
}

/// Effect of a line.
enum Does {
    Action(usize),
    Commands(Vec<Command>),
}

struct Item {
    title: String,
    /// The title in the language of the interface.
    shown: String,
    right: String,
    does: Does,
}

impl Palette {
    /// Opens the palette empty, or closes it.
    pub fn toggle(&mut self) {
        *self = Self {
            open: !self.open,
            ..Self::default()
        };
    }

    /// Draws the palette while it is open.
    pub fn show(&mut self, ui: &Ui, known: &Known<'_>, commands: &mut Vec<Command>) {
        if !self.open {
            return;
        }
        let mut items = matching(items::items(known), &self.query);
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
                .hint_text(t("Type to find a command, a setting, weather, an object, a file"))
                .desired_width(f32::INFINITY)
                .margin(vec2(8.0, 6.0));
            let field = ui.add(field);
            field.request_focus();
            if field.changed() {
                self.chosen = 0;
            }
            ui.add_space(theme::GAP);
            ui.spacing_mut().item_spacing.y = 1.0;
            // The same height for few lines as for many, so the field stays in place.
            ui.set_min_height(SHOWN as f32 * (theme::ROW + 1.0));
            // The list scrolls so that the chosen line is visible.
            let first = self.chosen.saturating_sub(SHOWN - 1);
            for (i, item) in items.iter().enumerate().skip(first).take(SHOWN) {
                let name = egui::RichText::new(&item.shown).color(theme::text());
                let right = egui::RichText::new(t(&item.right)).color(theme::text_weak());
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
                ui.label(egui::RichText::new(t("Nothing of that name")).color(theme::text_weak()));
            }
        });
        if let Some(i) = run.filter(|i| *i < lines) {
            self.open = false;
            match items.swap_remove(i).does {
                Does::Action(i) => commands.push(ACTIONS[i].command()),
                Does::Commands(all) => commands.extend(all),
            }
        } else if shown.should_close() {
            self.open = false;
        }
    }
}

/// The items in which every word of the query begins a word or is contained, the best first. If there are none, the
/// items that contain the letters of the query in order and close together. The English title counts as much as the
/// translated one.
fn matching(items: Vec<Item>, query: &str) -> Vec<Item> {
    let best = |item: &Item, of: fn(&str, &str) -> Option<u32>| {
        let own = (item.shown != item.title).then(|| of(&item.shown, query));
        of(&item.title, query).into_iter().chain(own.flatten()).min()
    };
    let mut found: Vec<(u32, Item)> = Vec::new();
    let mut others = Vec::new();
    for item in items {
        match best(&item, by_words) {
            Some(score) => found.push((score, item)),
            None => others.push(item),
        }
    }
    if found.is_empty() {
        let near = |item: Item| Some((best(&item, score)?, item));
        found.extend(others.into_iter().filter_map(near));
    }
    found.sort_by_key(|(score, _)| *score);
    found.into_iter().map(|(_, item)| item).collect()
}

/// Cost of matching every word of a query in a text; lower is better, `None` if a word is missing.
fn by_words(text: &str, query: &str) -> Option<u32> {
    let text = text.to_lowercase();
    let mut cost = 0;
    for wanted in query.to_lowercase().split_whitespace() {
        let words = || text.split(|c: char| !c.is_alphanumeric());
        cost += match () {
            () if words().any(|word| word == wanted) => 0,
            () if words().any(|word| word.starts_with(wanted)) => 1,
            // (one letter is enough in scripts without spaces between words)
            () if (wanted.chars().count() > 1 || !wanted.is_ascii()) && text.contains(wanted) => 4,
            () => return None,
        };
    }
    Some(cost * 256 + text.chars().count() as u32)
}

/// Cost of matching the letters of a query in a text: how far apart they are, where the beginning of a word counts as
/// near. Lower is better; `None` if they are not all there in this order, or are too far apart.
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
    // Letters that are spread over the whole text are no match.
    let most = query.chars().count() as u32;
    (cost <= most).then_some(cost * 64 + text.len() as u32)
}

#[cfg(test)]
mod tests {
    use super::items::{Known, items};
    use super::*;
    use crate::shell::keymap::Keymap;
    use scene::{BoxLabel, BoxName, Extent, Frame, Scene, SceneBox};

    fn scene() -> Scene {
        let b = SceneBox {
            id: scene::BoxId(4),
            class: scene::Class::Bus,
            center_m: glam::DVec3::ZERO,
            size_m: glam::DVec3::ONE,
            yaw_rad: 0.0,
            velocity_mps: glam::DVec2::ZERO,
            label: BoxLabel {
                name: BoxName::new("school bus"),
                paint: None,
            },
        };
        let layout = scene::BevLayout::over(Extent::WINDOW);
        let frame = Frame::new(layout, [(b.id, b)].into(), scene::VoxelGrid::new());
        Scene::single("a", frame, Default::default(), 0)
    }

    #[test]
    fn a_few_letters_find_whatever_there_is() {
        let (keymap, scene) = (Keymap::default(), scene());
        let known = Known {
            keymap: &keymap,
            recent: &[],
            scene: &scene,
            learned: false,
        };
        let first = |query: &str| matching(items(&known), query).remove(0).title;
        assert_eq!(first("undo"), "Undo");
        assert_eq!(first("gen ev"), "Generate everything");
        assert_eq!(first("cone"), "Place a box: traffic cone");
        assert_eq!(first("lidar"), "Pane: LiDAR sweep");
        assert_eq!(first("swap"), "Swap bird's-eye and 3D view");
        assert_eq!(first("rain"), "Weather: rain");
        assert_eq!(first("night"), "Time of day: night");
        assert_eq!(first("school"), "Choose school bus, number 4");
        assert_eq!(first("bus 4"), "Choose school bus, number 4");
        assert_eq!(first("depth"), "Cameras: depth");
        assert_eq!(first("roundabout"), "New scene: roundabout");
        assert_eq!(first("ui scale"), "Settings: UI scale, size of everything");
        assert_eq!(first("theme"), "Settings: theme, dark or light");
        assert_eq!(first("grd"), "Grid", "letters in order, if no word is meant");
        for nothing in ["zzzz", "german"] {
            assert!(matching(items(&known), nothing).is_empty(), "{nothing}");
        }
        assert_eq!(matching(items(&known), "").len(), items(&known).len());
    }

    #[test]
    fn the_english_and_what_is_shown_find_a_line() {
        for (query, lines) in [
            ("rain", 1),
            ("weather", 1),
            ("雨", 1),
            ("天気", 1),
            ("snow", 0),
            ("雪", 0),
        ] {
            let item = Item {
                title: "Weather: rain".into(),
                shown: "天気: 小雨".into(),
                right: String::new(),
                does: Does::Commands(Vec::new()),
            };
            assert_eq!(matching(vec![item], query).len(), lines, "{query}");
        }
    }
}
