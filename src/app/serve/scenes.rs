//! The scenes that a server offers: files by their names, read when they are first asked for.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use anyhow::{Context, bail};
use tonic::Status;

use crate::limits::MOST_SCENES;
use crate::recent::Recent;
use scene::resample::shared_in;
use scene::{Lattice, Scene};

/// Files of scenes by their ids, and the scenes used last.
pub struct Scenes {
    files: BTreeMap<String, PathBuf>,
    kept: Recent<String, Arc<Scene>>,
    /// Held while a file is read: one at a time, and none twice.
    reading: Mutex<()>,
}

impl Scenes {
    /// Lists files, and the `.loom` files of folders; at most `kept` scenes stay in memory. A scene's id is its file's
    /// name without the ending. Errors in one line if there is no such file, or two have the same id.
    pub fn list(paths: &[PathBuf], kept: usize) -> anyhow::Result<Self> {
        let mut files = BTreeMap::new();
        for path in paths {
            let found = match path.is_dir() {
                true => in_folder(path)?,
                false => vec![path.clone()],
            };
            for file in found {
                if !file.is_file() {
                    bail!(
                        "{}: no such file, expected a scene or a folder of scenes",
                        file.display()
                    );
                }
                let id = file.file_stem().map(|stem| stem.to_string_lossy().into_owned());
                let id = id.unwrap_or_default();
                if let Some(other) = files.insert(id.clone(), file.clone()) {
                    bail!(
                        "{} and {} are both the scene {id:?}, expected different names",
                        other.display(),
                        file.display()
                    );
                }
            }
        }
        if files.is_empty() {
            bail!("no scene to serve, expected .loom files or a folder that holds some");
        }
        if files.len() > MOST_SCENES {
            bail!("{} scenes, expected at most {MOST_SCENES}", files.len());
        }
        Ok(Self {
            files,
            kept: Recent::new(kept),
            reading: Mutex::default(),
        })
    }

    /// The ids, in the order of the alphabet.
    pub fn ids(&self) -> Vec<String> {
        self.files.keys().cloned().collect()
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.files.len()
    }

    /// A scene. Errors in one line if there is none of that id, or its file cannot be read.
    pub fn get(&self, id: &str) -> Result<Arc<Scene>, Status> {
        let Some(path) = self.files.get(id) else {
            let some: Vec<&str> = self.files.keys().take(5).map(String::as_str).collect();
            let more = if self.files.len() > 5 { ", …" } else { "" };
            let shown: String = id.chars().take(80).collect();
            return Err(Status::not_found(format!(
                "no scene {shown:?}, expected one of {}{more}",
                some.join(", ")
            )));
        };
        let id = id.to_owned();
        if let Some(scene) = self.kept.get(&id) {
            return Ok(scene);
        }
        let _one = self.reading.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(scene) = self.kept.get(&id) {
            return Ok(scene);
        }
        let unread = |e| Status::failed_precondition(one_line(&format!("scene {id:?}: {e}")));
        let scene = formats::loom::load(path).map_err(unread)?;
        let scene = shared_in(&Arc::new(scene), Lattice::OCC3D);
        self.kept.put(id, scene.clone());
        Ok(scene)
    }
}

/// The `.loom` files of a folder, by name.
fn in_folder(folder: &Path) -> anyhow::Result<Vec<PathBuf>> {
    let read = || -> std::io::Result<Vec<PathBuf>> {
        let entries = std::fs::read_dir(folder)?.collect::<Result<Vec<_>, _>>()?;
        Ok(entries.into_iter().map(|entry| entry.path()).collect())
    };
    let mut files = read().with_context(|| format!("read {}", folder.display()))?;
    files.retain(|path| path.extension().is_some_and(|e| e == "loom") && path.is_file());
    files.sort();
    Ok(files)
}

/// A text without line breaks.
pub fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_are_files_by_name() {
        let folder = tempfile::tempdir().expect("a folder");
        let write = |name: &str| {
            let path = folder.path().join(name);
            std::fs::write(&path, "no scene").expect("written");
            path
        };
        let other = tempfile::tempdir().expect("a folder");
        assert!(Scenes::list(&[other.path().into()], 1).is_err(), "nothing there");
        let b = write("b.loom");
        write("a.loom");
        write("notes.txt");
        let scenes = Scenes::list(&[folder.path().into()], 1).expect("two files");
        assert_eq!(scenes.ids(), ["a", "b"]);
        let unknown = scenes.get("c").map(|_| ()).expect_err("no such scene");
        assert_eq!(unknown.code(), tonic::Code::NotFound);
        assert!(unknown.message().contains("a, b"), "{unknown}");
        let broken = scenes.get("a").map(|_| ()).expect_err("a broken file");
        assert_eq!(broken.code(), tonic::Code::FailedPrecondition);
        assert!(!broken.message().contains('\n'), "{broken}");
        let twice = Scenes::list(&[folder.path().into(), b], 1).map(|_| ());
        assert!(
            twice
                .expect_err("twice")
                .to_string()
                .contains("both the scene \"b\"")
        );
        assert!(Scenes::list(&[folder.path().join("none.loom")], 1).is_err());
    }
}
