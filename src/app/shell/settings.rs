//! Settings that are kept between sessions: theme, keys, panes, recent files. They are never part of a scene.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::Context;
use egui_tiles::Tree;
use serde::{Deserialize, Serialize};

use super::bookmarks::Bookmark;
use super::keymap::Chords;
use super::workspace::Workspace;
use crate::painting::PaintWish;
use crate::panes::id::PaneId;
use editor::Document;
use editor::tools::saved::SavedBrush;
use scene::classes::Palette;
use scene::message::one_line;
use widgets::theme::Theme;

/// Most recent files that are kept.
const RECENT: usize = 12;

/// The settings. Unknown keys, from a newer version, are ignored.
#[derive(Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Settings {
    /// Theme: dark or light.
    #[serde(rename = "look")]
    pub theme: Theme,
    /// Language of the texts; empty means English.
    pub language: String,
    /// Colours of the classes.
    pub classes: Palette,
    /// Scale of the interface, 1 = normal.
    pub ui_scale: f32,
    /// True: shows the start screen at the start.
    pub start_screen: bool,
    /// Name of the preset of keys.
    pub key_preset: String,
    /// Chords that the user changed.
    pub keys: Chords,
    /// The workspace chosen last.
    pub workspace: Workspace,
    /// Name of the preset of the quality slider.
    pub quality: String,
    /// The arrangement of the panes.
    pub dock: Option<Tree<PaneId>>,
    /// Panes that existed when the dock was saved; newer ones are added.
    pub panes_known: Vec<PaneId>,
    /// Kept viewpoints, by number.
    pub bookmarks: BTreeMap<u8, Bookmark>,
    /// Brushes saved by the user.
    pub brushes: Vec<SavedBrush>,
    /// Prompts that the user keeps, the newest first.
    pub kept_words: Vec<String>,
    /// True if learned camera pictures, an experiment, are offered among the views.
    pub learned_pictures: bool,
    /// How learned camera pictures are painted.
    pub painting: PaintWish,
    /// Limit of the history's memory, MB.
    pub history_mb: u32,
    /// True: assistants on this machine may drive the editor, if they present the token.
    pub assistants: bool,
    /// Files opened or saved, the newest first.
    pub recent: Vec<PathBuf>,
}

/// The preset that the window begins with: the fastest one whose inverted noise resembles a random draw.
pub const QUALITY: &str = "careful";

impl Default for Settings {
    fn default() -> Self {
        Self {
            theme: Theme::default(),
            language: String::new(),
            classes: Palette::default(),
            ui_scale: 1.0,
            start_screen: true,
            key_preset: "Default".into(),
            keys: Chords::new(),
            workspace: Workspace::default(),
            quality: QUALITY.into(),
            dock: None,
            panes_known: Vec::new(),
            bookmarks: BTreeMap::new(),
            brushes: Vec::new(),
            kept_words: Vec::new(),
            learned_pictures: false,
            painting: PaintWish::default(),
            history_mb: (Document::LIMIT_BYTES >> 20) as u32,
            assistants: false,
            recent: Vec::new(),
        }
    }
}

impl Settings {
    /// File of the settings: `settings.json` in `SCENELOOM_CONFIG_DIR`, else in the user's folder for settings; `None`
    /// without such a folder.
    pub fn file() -> Option<PathBuf> {
        Some(super::folders::settings()?.join("settings.json"))
    }

    /// Settings as a file holds them. Errors in one line.
    pub fn read(text: &str) -> Result<Self, String> {
        serde_json::from_str(text).map_err(|e| one_line(&e))
    }

    /// Reads settings; default settings if there is no file. Errors in one line if the file cannot be read; it is then
    /// left as it is, and the default settings are used.
    pub fn load(path: &Path) -> anyhow::Result<Self> {
        let text = match formats::input::read_text(path, formats::input::LARGEST_TEXT) {
            Ok(text) => text,
            Err(error) if error.is_not_found() => return Ok(Self::default()),
            Err(error) => return Err(error).context("settings"),
        };
        let read = Self::read(&text).map_err(anyhow::Error::msg);
        let mut read = read.with_context(|| format!("settings {}", path.display()))?;
        let scale = read.ui_scale;
        read.ui_scale = if scale.is_finite() {
            scale.clamp(0.5, 3.0)
        } else {
            1.0
        };
        read.history_mb = read
            .history_mb
            .clamp(*Self::HISTORY_MB.start(), *Self::HISTORY_MB.end());
        Ok(read)
    }

    /// Writes the settings, whole or not at all. Errors name the file.
    pub fn save(&self, path: &Path) -> anyhow::Result<()> {
        let folder = path.parent().unwrap_or(Path::new("."));
        let write = || -> anyhow::Result<()> {
            std::fs::create_dir_all(folder)?;
            Ok(formats::atomic::write(path, &serde_json::to_vec_pretty(self)?)?)
        };
        write().with_context(|| format!("settings {}", path.display()))
    }

    /// Limits of [`Self::history_mb`].
    pub const HISTORY_MB: std::ops::RangeInclusive<u32> = 16..=8192;

    /// Limit of the history's memory, bytes.
    pub fn history_bytes(&self) -> usize {
        (self.history_mb as usize) << 20
    }

    /// Puts a file at the front of the recent files.
    pub fn remember(&mut self, path: &Path) {
        let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        self.recent.retain(|p| *p != path);
        self.recent.insert(0, path);
        self.recent.truncate(RECENT);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shell::dock::Dock;

    #[test]
    fn settings_come_back_and_bad_ones_are_named() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("below").join("settings.json");
        assert!(Settings::load(&path).expect("a new user") == Settings::default());
        let mut settings = Settings {
            theme: Theme::Light,
            dock: Some(Dock::workspace(Workspace::Sensors).tree().clone()),
            ..Settings::default()
        };
        for i in 0..20 {
            settings.remember(Path::new(&format!("/scenes/{i}.loom")));
        }
        settings.remember(Path::new("/scenes/15.loom"));
        assert_eq!(settings.recent.len(), RECENT);
        assert_eq!(
            settings.recent[..2],
            ["/scenes/15.loom", "/scenes/19.loom"].map(PathBuf::from)
        );
        settings.save(&path).expect("written");
        assert!(Settings::load(&path).expect("read") == settings);
        std::fs::write(
            &path,
            "{\"ui_scale\": 1e9, \"history_mb\": 1, \"of_a_newer_version\": 3}",
        )
        .expect("written");
        let read = Settings::load(&path).expect("read");
        assert_eq!((read.ui_scale, read.history_mb), (3.0, 16));
        std::fs::write(&path, "{ \"ui_scale\": ").expect("written");
        let error = format!("{:#}", Settings::load(&path).err().expect("cut off"));
        assert!(error.contains("settings.json"), "{error}");
        let quoted = Settings::read("{\"look\": \"da\\nrk\"}").err().expect("no theme");
        assert!(
            quoted.contains("unknown variant") && !quoted.contains('\n'),
            "{quoted:?}"
        );
    }
}
