//! The scene's file, and all data on its way to or from the disk.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crossbeam_channel::Receiver;

use scene::{Scene, SceneRev};

use super::batching::Batching;
use super::exporting::Exporting;
use super::file_dialogs::FileDialogs;
use super::recovery::Recovery;
use super::versions::VersionedScene;
use crate::windows::place_picker::PlacePicker;

/// Reads a scene from a file of any kind that can be opened.
pub type OpenScene = Arc<dyn Fn(&Path) -> anyhow::Result<authoring::open::OpenedScene> + Send + Sync>;
/// Writes a scene to a `.loom` file.
pub type SaveScene = Arc<dyn Fn(&Scene, &Path) -> anyhow::Result<()> + Send + Sync>;
/// Makes a new scene.
pub type NewScene = Arc<dyn Fn() -> anyhow::Result<Scene> + Send + Sync>;

/// Functions that read, write and make scenes.
pub struct Disk {
    /// Opens files.
    pub open: OpenScene,
    /// Saves files.
    pub save: SaveScene,
    /// Makes new scenes.
    pub new_scene: NewScene,
}

/// Action to continue with after the question about unsaved changes.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Next {
    New,
    NewFrom(&'static str, scene::Lattice),
    AskOpen,
    Open(PathBuf),
    /// A variant of a batch of the queue.
    Variant(u64, usize),
    /// Shows the scene that was read while this one was edited.
    Arrived,
    Quit,
}

/// A state that another scene will replace.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Left {
    pub content: SceneRev,
    /// True if it had unsaved changes that the user gave up.
    pub unsaved: bool,
}

/// A scene that is being read or made.
pub(crate) struct Opening {
    pub path: Option<PathBuf>,
    pub what: String,
    /// True if the file is not a scene; its occupancy is then a draft.
    pub is_import: bool,
    /// True if it is a copy of unsaved work from a session that died.
    pub recovers: bool,
    /// Name of the undo step that it becomes; `None` if it becomes a document of its own.
    pub step: Option<&'static str>,
    /// The state that it replaces. Later edits of that state are asked about.
    pub leaves: Left,
    pub scene: Receiver<anyhow::Result<VersionedScene>>,
}

/// A scene that was read while the one in the window was edited.
pub(crate) struct Arrived {
    pub opening: Opening,
    pub opened: VersionedScene,
}

/// Roads from a file, on which a scene will stand.
pub(crate) enum Picking {
    /// The roads are being read.
    Reading(Receiver<anyhow::Result<PlacePicker>>),
    /// A place is being chosen.
    Choosing(Box<PlacePicker>),
}

/// Owner of the scene's file, and of all reading and writing.
pub struct Files {
    /// The scene's file, if it has one.
    pub(crate) path: Option<PathBuf>,
    pub(crate) disk: Disk,
    pub(crate) dialogs: FileDialogs,
    pub(crate) opening: Option<Opening>,
    /// A scene that waits until the user is asked about edits made meanwhile.
    pub(crate) arrived: Option<Box<Arrived>>,
    /// The state that the user agreed to leave for a scene that is being chosen or read.
    pub(crate) leaves: Option<Left>,
    /// Roads on which a place is chosen.
    pub(crate) picking: Option<Picking>,
    /// A model that is being read.
    pub(crate) model: Option<super::models::Reading>,
    /// Action that waits for the answer about unsaved changes.
    pub(crate) unsaved: Option<Next>,
    /// Action to continue with after the scene is saved.
    pub(crate) after_save: Option<Next>,
    pub(crate) may_close: bool,
    /// Copies of unsaved work; `None` in tests.
    pub recovery: Option<Recovery>,
    pub(crate) exporting: Exporting,
    pub(crate) batching: Batching,
}

impl Files {
    /// Files with no reading or writing under way. `native_dialogs`: uses the system's file dialogs.
    pub fn new(path: Option<PathBuf>, disk: Disk, native_dialogs: bool) -> Self {
        Self {
            path,
            disk,
            dialogs: FileDialogs::new(native_dialogs),
            opening: None,
            arrived: None,
            leaves: None,
            picking: None,
            model: None,
            unsaved: None,
            after_save: None,
            may_close: false,
            recovery: None,
            exporting: Exporting::default(),
            batching: Batching::default(),
        }
    }

    /// The name of the scene: the stem of its file, else its own name.
    pub(crate) fn called(&self, scene_name: &str) -> String {
        let stem = self.path.as_ref().and_then(|p| p.file_stem());
        stem.map_or_else(|| scene_name.to_owned(), |s| s.to_string_lossy().into_owned())
    }

    /// A path beside the scene's file, or in the working folder, named after the scene.
    pub(crate) fn suggested(&self, scene_name: &str, extension: &str) -> PathBuf {
        match &self.path {
            Some(path) => path.with_extension(extension),
            None => {
                let tidy: String = scene_name
                    .chars()
                    .map(|c| if c.is_alphanumeric() || c == '-' { c } else { '_' })
                    .collect();
                let folder = std::env::current_dir().unwrap_or_default();
                folder.join(format!("{tidy}.{extension}"))
            }
        }
    }
}
