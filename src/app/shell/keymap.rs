//! Actions, their chords, and presets of chords. A preset is a file of `assets/keys/`; the user's own chords override
//! it.

use std::collections::BTreeMap;
use std::fmt;
use std::str::FromStr;

use egui::{Key, Modifiers};

use super::actions::{ACTIONS, ActionDef, When};

/// A key with its modifiers. `Ctrl` stands for the command key on systems that have one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Chord {
    /// The key.
    pub key: Key,
    /// Ctrl (or Cmd) is held.
    pub ctrl: bool,
    /// Shift is held.
    pub shift: bool,
    /// Alt is held.
    pub alt: bool,
}

impl Chord {
    /// A key press as a chord. Shift does not count for keys that need it on some keyboards only.
    pub fn pressed(key: Key, m: Modifiers) -> Self {
        let by_layout = matches!(
            key,
            Key::Questionmark | Key::OpenCurlyBracket | Key::CloseCurlyBracket | Key::Plus | Key::Colon
        );
        Self {
            key,
            ctrl: m.command || m.ctrl,
            shift: m.shift && !by_layout,
            alt: m.alt,
        }
    }
}

impl fmt::Display for Chord {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (on, name) in [(self.ctrl, "Ctrl+"), (self.alt, "Alt+"), (self.shift, "Shift+")] {
            if on {
                f.write_str(name)?;
            }
        }
        f.write_str(match self.key {
            Key::OpenBracket => "[",
            Key::CloseBracket => "]",
            Key::OpenCurlyBracket => "{",
            Key::CloseCurlyBracket => "}",
            Key::Questionmark => "?",
            Key::Delete => "Del",
            Key::Escape => "Esc",
            Key::PageUp => "PgUp",
            Key::PageDown => "PgDn",
            key => key.name(),
        })
    }
}

impl FromStr for Chord {
    type Err = String;

    /// Parses a chord such as `Ctrl+Shift+Z`, as it is shown. Errors name the chord.
    fn from_str(text: &str) -> Result<Self, String> {
        let bad = || format!("{text:?} is no chord, expected one like \"Ctrl+Shift+Z\"");
        let mut parts: Vec<&str> = text.split('+').map(str::trim).collect();
        let name = parts.pop().filter(|n| !n.is_empty()).ok_or_else(bad)?;
        let key = match name {
            "[" => Key::OpenBracket,
            "]" => Key::CloseBracket,
            "{" => Key::OpenCurlyBracket,
            "}" => Key::CloseCurlyBracket,
            "?" => Key::Questionmark,
            "Del" => Key::Delete,
            "Esc" => Key::Escape,
            "PgUp" => Key::PageUp,
            "PgDn" => Key::PageDown,
            name => Key::from_name(name).ok_or_else(bad)?,
        };
        let mut chord = Self {
            key,
            ctrl: false,
            shift: false,
            alt: false,
        };
        for part in parts {
            match part {
                "Ctrl" => chord.ctrl = true,
                "Shift" => chord.shift = true,
                "Alt" => chord.alt = true,
                _ => return Err(bad()),
            }
        }
        Ok(chord)
    }
}

/// Bundled presets: name, and the file with its differences from the default.
pub const PRESETS: [(&str, &str); 4] = [
    ("Default", "{}"),
    ("Blender", assets::keys::BLENDER),
    ("MagicaVoxel", assets::keys::MAGICAVOXEL),
    ("Labeler", assets::keys::LABELER),
];

/// Chords by the id of their action. The list of an action holds all of its chords.
pub type Chords = BTreeMap<String, Vec<String>>;

/// The chords of all actions.
#[derive(Clone, Debug)]
pub struct Keymap {
    /// Name of its preset.
    pub preset: String,
    /// Chords that the user changed.
    pub own: Chords,
    /// Chords of each of [`ACTIONS`], in its order.
    chords: Vec<Vec<Chord>>,
}

impl Default for Keymap {
    fn default() -> Self {
        Self::new("Default", Chords::new())
    }
}

impl Keymap {
    /// A preset with the user's changes; the default preset if there is none of that name. Invalid chords and unknown
    /// actions are left out.
    pub fn new(preset: &str, own: Chords) -> Self {
        let (name, file) = PRESETS
            .into_iter()
            .find(|(n, _)| *n == preset)
            .unwrap_or(PRESETS[0]);
        // A preset that cannot be read is found by its test.
        let changed: Chords = serde_json::from_str(file).unwrap_or_default();
        let of = |action: &ActionDef| -> Vec<Chord> {
            match own.get(action.id).or_else(|| changed.get(action.id)) {
                Some(texts) => texts.iter().filter_map(|t| t.parse().ok()).collect(),
                None => action
                    .keys
                    .split_whitespace()
                    .filter_map(|t| t.parse().ok())
                    .collect(),
            }
        };
        let chords = ACTIONS.iter().map(of).collect();
        Self {
            preset: name.to_owned(),
            own,
            chords,
        }
    }

    /// The action of a chord among those that apply; the one with the most specific place wins.
    pub fn action(&self, chord: Chord, applies: impl Fn(When) -> bool) -> Option<&'static ActionDef> {
        let mut found: Option<&'static ActionDef> = None;
        for (action, chords) in ACTIONS.iter().zip(&self.chords) {
            let better = found.is_none_or(|f| action.when > f.when);
            if better && chords.contains(&chord) && applies(action.when) {
                found = Some(action);
            }
        }
        found
    }

    /// Chords of an action as text, for example `Ctrl+Shift+Z, Ctrl+Y`.
    pub fn text(&self, id: &str) -> String {
        let of = ACTIONS.iter().position(|a| a.id == id);
        let chords = of.map_or(&[][..], |i| &self.chords[i]);
        let texts: Vec<String> = chords.iter().map(Chord::to_string).collect();
        texts.join(", ")
    }

    /// The first chord of an action as text, for a menu.
    pub fn first(&self, id: &str) -> String {
        let of = ACTIONS.iter().position(|a| a.id == id);
        let chord = of.and_then(|i| self.chords[i].first());
        chord.map_or_else(String::new, Chord::to_string)
    }

    /// Gives an action a chord in place of its old ones. Other actions with that chord in the same place lose it;
    /// returns their titles.
    pub fn rebind(&mut self, id: &str, chord: Chord) -> Vec<&'static str> {
        let mut losers = Vec::new();
        let Some(index) = ACTIONS.iter().position(|a| a.id == id) else {
            return losers;
        };
        for (i, action) in ACTIONS.iter().enumerate() {
            let clashes = i != index && action.when.meets(ACTIONS[index].when);
            if clashes && self.chords[i].contains(&chord) {
                self.chords[i].retain(|c| *c != chord);
                let left = self.chords[i].iter().map(Chord::to_string).collect();
                self.own.insert(action.id.to_owned(), left);
                losers.push(action.title);
            }
        }
        self.chords[index] = vec![chord];
        self.own.insert(id.to_owned(), vec![chord.to_string()]);
        losers
    }

    /// True if the user changed the chords of an action.
    pub fn is_changed(&self, id: &str) -> bool {
        self.own.contains_key(id)
    }

    /// Resets the chords of an action to those of the preset.
    pub fn reset_one(&mut self, id: &str) {
        let mut own = self.own.clone();
        own.remove(id);
        *self = Self::new(&self.preset.clone(), own);
    }

    /// Resets all chords to those of the preset.
    pub fn reset(&mut self) {
        *self = Self::new(&self.preset.clone(), Chords::new());
    }

    /// Chords that two actions share in the same place.
    pub fn conflicts(&self) -> Vec<(Chord, &'static str, &'static str)> {
        let mut out = Vec::new();
        for (i, a) in ACTIONS.iter().enumerate() {
            for (j, b) in ACTIONS.iter().enumerate().skip(i + 1) {
                let shared = self.chords[i].iter().find(|c| self.chords[j].contains(c));
                if let (true, Some(chord)) = (a.when.meets(b.when), shared) {
                    out.push((*chord, a.id, b.id));
                }
            }
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chords_read_as_they_are_shown() {
        for text in [
            "Ctrl+Alt+Shift+Z",
            "V",
            "[",
            "?",
            "Del",
            "F12",
            "Ctrl+Space",
            "PgUp",
            "Ctrl+[",
        ] {
            assert_eq!(text.parse::<Chord>().map(|c| c.to_string()), Ok(text.to_owned()));
        }
        for bad in ["", "Ctrl+", "Hyper+A", "Ctrl+Nothing"] {
            assert!(bad.parse::<Chord>().expect_err("bad").contains("is no chord"));
        }
    }

    /// In every preset each chord has one action in one place, and every chord and id in the files is valid.
    #[test]
    fn no_preset_holds_a_conflict() {
        for action in ACTIONS.iter() {
            for text in action.keys.split_whitespace() {
                assert!(text.parse::<Chord>().is_ok(), "{}: {text}", action.id);
            }
        }
        for (name, file) in PRESETS {
            let changed: Chords = serde_json::from_str(file).expect("an object of lists");
            for (id, chords) in &changed {
                assert!(
                    ACTIONS.iter().any(|a| a.id == id),
                    "{name}: there is no action {id}"
                );
                for text in chords {
                    assert!(text.parse::<Chord>().is_ok(), "{name}: {id}: {text}");
                }
            }
            let map = Keymap::new(name, Chords::new());
            assert_eq!(map.preset, name);
            assert!(map.conflicts().is_empty(), "{name}: {:?}", map.conflicts());
        }
        let mut ids: Vec<&str> = ACTIONS.iter().map(|a| a.id).collect();
        ids.sort_unstable();
        ids.dedup();
        assert_eq!(ids.len(), ACTIONS.len(), "an id twice");
    }

    #[test]
    fn a_chord_given_away_is_lost_by_its_old_action() {
        let mut map = Keymap::default();
        let chord: Chord = "V".parse().expect("a chord");
        map.rebind("add_box_tool", chord);
        assert_eq!(map.text("add_box_tool"), "V");
        assert_eq!(map.text("select_tool"), "");
        assert!(map.conflicts().is_empty());
        let again = Keymap::new("Default", map.own.clone());
        assert_eq!(again.text("select_tool"), "");
        map.reset();
        assert_eq!(map.text("select_tool"), "V");
    }
}
