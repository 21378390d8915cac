//! Documents of commands: opened with the history of their file, and saved with it.

use std::path::Path;

use editor::Document;
use formats::loom;
use scene::Scene;

/// The document of a scene that was read. Says on standard error why its history cannot be used, if so.
pub(super) fn opened(scene: Scene) -> Document {
    let (document, note) = Document::open(scene);
    if let Some(note) = note {
        eprintln!("sceneloom: {note}");
    }
    document
}

/// Writes the state shown with the history that led to it.
pub(super) fn save(path: &Path, document: &Document) -> anyhow::Result<()> {
    loom::save(path, &document.to_save())?;
    Ok(())
}
