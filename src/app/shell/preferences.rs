//! Settings and keys, and when they are written to the file.

use std::path::PathBuf;

use super::app::one_line;
use super::dock::Dock;
use super::keymap::Keymap;
use super::settings::Settings;
use crate::panes;
use language::tf;

/// Time between two writes of changed settings, s.
const EVERY_S: f64 = 2.0;

/// Owner of the data that is kept between sessions.
pub struct Preferences {
    /// The settings.
    pub settings: Settings,
    /// The chords of all actions.
    pub keymap: Keymap,
    file: Option<PathBuf>,
    /// The settings as in the file.
    kept: Settings,
    /// Time at which the two were last compared, s.
    compared_s: f64,
}

impl Preferences {
    /// Preferences with settings that were read from a file; `None` if they have no file.
    pub fn new(file: Option<PathBuf>, settings: Settings) -> Self {
        Self {
            keymap: Keymap::new(&settings.key_preset, settings.keys.clone()),
            file,
            kept: settings.clone(),
            settings,
            compared_s: 0.0,
        }
    }

    /// True once after theme, colours or language have changed. They are then written soon.
    pub(crate) fn looks_changed(&mut self) -> bool {
        let (now, kept) = (&self.settings, &mut self.kept);
        if now.theme == kept.theme && now.classes == kept.classes && now.language == kept.language {
            return false;
        }
        (kept.theme, kept.classes) = (now.theme, now.classes);
        kept.language.clone_from(&now.language);
        self.write_soon();
        true
    }

    /// Makes the next call of [`Self::write`] due at once, and lets it write even if no value differs.
    pub(crate) fn write_soon(&mut self) {
        self.compared_s = f64::NEG_INFINITY;
    }

    /// True if it is time to write.
    pub(crate) fn is_due(&self, now_s: f64) -> bool {
        now_s - self.compared_s >= EVERY_S
    }

    /// Writes changed settings. Returns the reason if that fails, once.
    pub(crate) fn write(&mut self, ui_scale: f32, dock: &Dock, now_s: f64) -> Option<String> {
        let settings = &mut self.settings;
        settings.ui_scale = ui_scale;
        settings.dock = Some(dock.tree().clone());
        settings.panes_known = panes::infos().iter().map(|p| p.id).collect();
        settings.key_preset.clone_from(&self.keymap.preset);
        settings.keys.clone_from(&self.keymap.own);
        let forced = self.compared_s == f64::NEG_INFINITY;
        self.compared_s = now_s;
        let path = self.file.as_deref()?;
        let mut complaint = None;
        if (forced || self.kept != self.settings)
            && let Err(error) = self.settings.save(path)
        {
            complaint = Some(tf!("Settings are not kept: {error}", error = one_line(&error)));
            self.file = None; // the error is reported once
        }
        self.kept = self.settings.clone();
        complaint
    }
}
