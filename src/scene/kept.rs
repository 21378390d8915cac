//! Parts of a project beside its scene: versions to return to, the texts that were typed, the log of its changes, and the sweeps
//! that it was imported from.

use std::sync::Arc;

use crate::{OpLog, SweepRecording};

/// Versions, typed words, the log, and the recording that the scene came from. They belong to a file, not to a state of the scene: undo leaves them as they are.
#[derive(Clone, Debug, Default)]
pub struct ProjectHistory {
    /// The versions, the oldest first.
    pub versions: Vec<KeptVersion>,
    /// Texts typed in the prompt field, the oldest first, whether or not they had an effect.
    pub typed: Vec<String>,
    /// Changes that led to the state of the file: undo goes on from them.
    pub log: Option<Arc<OpLog>>,
    /// Reason why the file's log cannot be used, in one line; the scene is whole all the same.
    pub log_problem: Option<Arc<str>>,
    /// The recorded sweeps that the scene was imported from, by time.
    pub sweeps: Vec<Arc<SweepRecording>>,
}

impl ProjectHistory {
    /// Most versions of a file.
    pub const MAX_VERSIONS: usize = 1000;
    /// Most texts that were typed.
    pub const MAX_TYPED: usize = 1000;

    /// True if there is nothing beside the scene.
    pub fn is_empty(&self) -> bool {
        let no_log = self.log.is_none() && self.log_problem.is_none();
        self.versions.is_empty() && self.typed.is_empty() && no_log && self.sweeps.is_empty()
    }
}

/// A state of the scene that is kept.
#[derive(Clone, Debug, PartialEq)]
pub struct KeptVersion {
    /// Name given by the user; empty if none was.
    pub name: String,
    /// The edit that led to it.
    pub label: String,
    /// Note on what generating it took; on a second line the settings it was made with, as JSON.
    pub note: String,
    /// True if the user wants to keep it.
    pub starred: bool,
    /// The scene as a `.loom` file that has no versions and texts itself.
    pub loom: Arc<Vec<u8>>,
}

impl KeptVersion {
    /// The note on what generating it took, for a person.
    pub fn said(&self) -> &str {
        self.note.lines().next().unwrap_or_default()
    }

    /// The settings it was made with, as JSON, if they are known.
    pub fn made(&self) -> Option<&str> {
        self.note.lines().nth(1)
    }

    /// Its title: its name, else the edit that led to it.
    pub fn title(&self) -> &str {
        if self.name.is_empty() {
            &self.label
        } else {
            &self.name
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_note_says_what_it_took_and_what_it_was_made_with() {
        let of = |note: &str| KeptVersion {
            name: String::new(),
            label: "Generate".into(),
            note: note.into(),
            starred: false,
            loom: Arc::default(),
        };
        let both = of("0.4 s\n{\"seed\":3}");
        assert_eq!((both.said(), both.made()), ("0.4 s", Some("{\"seed\":3}")));
        assert_eq!((of("").said(), of("0.4 s").made()), ("", None));
        assert_eq!((of("\n{}").said(), of("\n{}").made()), ("", Some("{}")));
    }
}
