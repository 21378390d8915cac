//! Why a project file could not be read or written.

use std::io;
use std::path::{Path, PathBuf};

use super::{FORMAT, VERSION};
use crate::input::InputError;

/// Why a project could not be read or written. One line each; nothing was written, nothing opened.
#[derive(Debug, thiserror::Error)]
pub enum ProjectError {
    /// A problem with a certain file.
    #[error("{}: {problem}", path.display())]
    InFile {
        /// The file.
        path: PathBuf,
        /// The problem.
        problem: Box<ProjectError>,
    },
    /// The file was not read: there is none, it is no regular file, or too large.
    #[error(transparent)]
    Input(#[from] InputError),
    /// The file system refused.
    #[error("{0}")]
    Io(#[from] io::Error),
    /// Not a zip, or one that was cut short.
    #[error("not a .loom project, or cut short ({0})")]
    NotAProject(String),
    /// Made by another program or for another purpose.
    #[error("manifest.json: format is {found:?}, expected {FORMAT:?}")]
    Format {
        /// The format that the manifest names.
        found: String,
    },
    /// Made by a newer version of sceneloom, or one that never was.
    #[error(
        "manifest.json: version is {found}, expected {VERSION}; open it with the sceneloom that wrote it"
    )]
    Version {
        /// The version that the manifest names.
        found: u64,
    },
    /// An entry that belongs to the scene is missing.
    #[error("entry {entry:?} is missing")]
    MissingEntry {
        /// Name within the zip.
        entry: String,
    },
    /// An entry that does not belong to the scene is there.
    #[error("entry {entry:?} is not known")]
    UnknownEntry {
        /// Name within the zip.
        entry: String,
    },
    /// Does not unpack or fails its check sum.
    #[error("entry {entry:?} is damaged ({detail})")]
    Damaged {
        /// Name within the zip.
        entry: String,
        /// Message of the zip reader.
        detail: String,
    },
    /// JSON that is not as it must be: syntax, an unknown key, a missing one, a wrong type.
    #[error("entry {entry:?}: {detail}")]
    Json {
        /// Name within the zip.
        entry: String,
        /// Names the key and the place.
        detail: String,
    },
    /// A grid of another size.
    #[error("entry {entry:?} has the wrong size: expected {expected} {unit}, found {found}")]
    Size {
        /// Name within the zip.
        entry: String,
        /// Number needed.
        expected: u64,
        /// Number found, in whole units.
        found: u64,
        /// Cells or voxels.
        unit: &'static str,
    },
    /// A value that a cell or voxel cannot have.
    #[error("entry {entry:?}: {cell} holds {found}, expected {expected}")]
    Cell {
        /// Name within the zip.
        entry: String,
        /// Which cell or voxel.
        cell: String,
        /// Its value.
        found: u32,
        /// The values that are accepted.
        expected: &'static str,
    },
    /// A number, box or line that is not sound.
    #[error("{0}")]
    Unsound(String),
    /// More than is read or written, so that no file can fill the memory.
    #[error("{what} is {found}, expected at most {limit}")]
    TooLarge {
        /// The size or number that is too large.
        what: String,
        /// How large.
        found: u64,
        /// How large it may be.
        limit: u64,
    },
}

impl ProjectError {
    pub(super) fn at(self, path: &Path) -> Self {
        Self::InFile {
            path: path.to_path_buf(),
            problem: Box::new(self),
        }
    }
}
