//! From an older version of the project file to the present one, a step per version. A new version is one file here and one
//! line in [`ALL`]; `tests/reference/loom/` keeps a file of every version, which a test opens.

mod old_prompt;
mod v1;
mod v10;
mod v11;
mod v2;
mod v3;
mod v4;
mod v5;
mod v6;
mod v7;
mod v8;
mod v9;

use std::io::{Read, Seek};

use serde_json::Value;

use super::archive::{MAX_JSON, Reader, parse};
use super::{ProjectError, SCENE};

/// The step from one version to the next.
pub struct Migration {
    /// The version that it takes.
    pub from: u32,
    /// Additions of the next version over this one, for a person.
    pub what: &'static str,
    /// The change that is made to a file.
    pub change: MigrationChange,
}

/// Change that a step makes.
#[derive(Clone, Copy)]
pub enum MigrationChange {
    /// The next version only added keys and entries that may be absent: no change is needed.
    Added,
    /// `scene.json` or other entries change. Errors say in one line which part cannot be converted.
    Rewrites(fn(&mut dyn Entries) -> Result<(), ProjectError>),
}

/// Every step, oldest first, each to the version that the next one takes.
pub const ALL: [Migration; 11] = [
    v1::TO_V2,
    v2::TO_V3,
    v3::TO_V4,
    v4::TO_V5,
    v5::TO_V6,
    v6::TO_V7,
    v7::TO_V8,
    v8::TO_V9,
    v9::TO_V10,
    v10::TO_V11,
    v11::TO_V12,
];

/// The entries of a file that a step may change.
pub trait Entries {
    /// `scene.json`.
    fn scene(&mut self) -> Result<&mut Value, ProjectError>;
    /// How many frames the manifest counts; none from version 5 on.
    fn frames(&self) -> Option<u64>;
    /// Takes an entry of at most `limit` bytes out of the file.
    fn take(&mut self, entry: &str, limit: u64) -> Result<Vec<u8>, ProjectError>;
    /// Puts an entry into the file, in place of one of that name.
    fn put(&mut self, entry: &str, bytes: Vec<u8>);
}

/// A file on its way to the present version. `scene.json` is kept as text until a step asks for it.
pub(super) struct Old<'a, R> {
    file: &'a mut Reader<R>,
    frames: Option<u64>,
    scene: Option<Value>,
}

impl<'a, R: Read + Seek> Old<'a, R> {
    pub(super) fn new(file: &'a mut Reader<R>, frames: Option<u64>) -> Self {
        Self {
            file,
            frames,
            scene: None,
        }
    }

    pub(super) fn migrate(&mut self, step: &Migration) -> Result<(), ProjectError> {
        match step.change {
            MigrationChange::Added => Ok(()),
            MigrationChange::Rewrites(change) => change(self),
        }
    }

    /// `scene.json` of the present version.
    pub(super) fn finish(self) -> Result<Vec<u8>, ProjectError> {
        match self.scene {
            None => self.file.bytes(SCENE, MAX_JSON),
            Some(scene) => serde_json::to_vec(&scene).map_err(|e| ProjectError::Json {
                entry: SCENE.into(),
                detail: e.to_string(),
            }),
        }
    }
}

impl<R: Read + Seek> Entries for Old<'_, R> {
    fn scene(&mut self) -> Result<&mut Value, ProjectError> {
        let scene = match self.scene.take() {
            Some(scene) => scene,
            None => parse(SCENE, &self.file.bytes(SCENE, MAX_JSON)?)?,
        };
        Ok(self.scene.insert(scene))
    }

    fn frames(&self) -> Option<u64> {
        self.frames
    }

    fn take(&mut self, entry: &str, limit: u64) -> Result<Vec<u8>, ProjectError> {
        self.file.bytes(entry, limit)
    }

    fn put(&mut self, entry: &str, bytes: Vec<u8>) {
        self.file.put(entry, bytes);
    }
}
