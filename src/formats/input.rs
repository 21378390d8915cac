//! The one way in for files that a user names: regular files of a bounded size, never a pipe, a device or a folder.

use std::fs::{self, File, FileType, Metadata};
use std::io::{self, Read};
use std::path::Path;

use scene::message::shortened;

/// Largest text that a person or a program writes for us (sensors, edits, settings), bytes.
pub const LARGEST_TEXT: u64 = 64 << 20;

/// Characters of a path in a message.
const LONGEST_PATH: usize = 160;

/// Largest file of networks' weights, bytes.
pub const LARGEST_WEIGHTS: u64 = 4 << 30;

/// Why a file was not read. Each is one line and names the file.
#[derive(Debug, thiserror::Error)]
pub enum InputError {
    /// The file system refused.
    #[error("{path}: {source}")]
    Io {
        /// The file.
        path: String,
        /// Error of the system.
        source: io::Error,
    },
    /// No regular file: reading it might never end.
    #[error("{path}: {found}, expected a regular file")]
    NotAFile {
        /// Path as the user named it.
        path: String,
        /// Kind of the thing there.
        found: &'static str,
    },
    /// More than is read.
    #[error("{path}: {found} bytes, expected at most {limit}")]
    TooLarge {
        /// The file.
        path: String,
        /// Its size, or one more than the limit if it grew while it was read.
        found: u64,
        /// The most that is read.
        limit: u64,
    },
    /// Bytes that are no text.
    #[error("{path}: byte {at} is not UTF-8, expected text")]
    NotText {
        /// The file.
        path: String,
        /// Bytes before the first one that is wrong.
        at: usize,
    },
}

impl InputError {
    /// True if there is no such file.
    pub fn is_not_found(&self) -> bool {
        matches!(self, Self::Io { source, .. } if source.kind() == io::ErrorKind::NotFound)
    }
}

/// Reads all of a file of at most `limit` bytes. A larger one is refused before it is read.
pub fn read(path: &Path, limit: u64) -> Result<Vec<u8>, InputError> {
    let (file, size) = open(path, limit)?;
    let mut bytes = Vec::with_capacity(size as usize);
    // A file may grow meanwhile, and some (below /proc) do not know their size.
    let read = file.take(limit.saturating_add(1)).read_to_end(&mut bytes);
    read.map_err(|source| failed(path, source))?;
    match bytes.len() as u64 {
        found if found > limit => Err(InputError::TooLarge {
            path: shown(path),
            found,
            limit,
        }),
        _ => Ok(bytes),
    }
}

/// Reads all of a file of at most `limit` bytes as UTF-8 text.
pub fn read_text(path: &Path, limit: u64) -> Result<String, InputError> {
    String::from_utf8(read(path, limit)?).map_err(|error| InputError::NotText {
        path: shown(path),
        at: error.utf8_error().valid_up_to(),
    })
}

/// The first `most` bytes of a file of any size, all of a shorter one: enough to tell what it is.
pub fn head(path: &Path, most: u64) -> Result<Vec<u8>, InputError> {
    let (file, _) = open(path, u64::MAX)?;
    let mut bytes = Vec::new();
    let read = file.take(most).read_to_end(&mut bytes);
    read.map_err(|source| failed(path, source))?;
    Ok(bytes)
}

/// Whether a file that others open would be read: it is regular and not too large.
pub fn check(path: &Path, limit: u64) -> Result<(), InputError> {
    open(path, limit).map(|_| ())
}

fn open(path: &Path, limit: u64) -> Result<(File, u64), InputError> {
    let regular = |found: Metadata| match kind(found.file_type()) {
        None if found.len() <= limit => Ok(found.len()),
        None => Err(InputError::TooLarge {
            path: shown(path),
            found: found.len(),
            limit,
        }),
        Some(found) => Err(InputError::NotAFile {
            path: shown(path),
            found,
        }),
    };
    // Before it is opened: opening a pipe waits for one who writes.
    regular(fs::metadata(path).map_err(|source| failed(path, source))?)?;
    let file = File::open(path).map_err(|source| failed(path, source))?;
    let size = regular(file.metadata().map_err(|source| failed(path, source))?)?;
    Ok((file, size))
}

fn failed(path: &Path, source: io::Error) -> InputError {
    InputError::Io {
        path: shown(path),
        source,
    }
}

fn shown(path: &Path) -> String {
    shortened(
        &path.display().to_string().replace(char::is_control, " "),
        LONGEST_PATH,
    )
}

/// Kind of a thing that is no regular file; `None` for a regular file.
fn kind(of: FileType) -> Option<&'static str> {
    if of.is_file() {
        return None;
    }
    if of.is_dir() {
        return Some("a folder");
    }
    Some(special(of))
}

#[cfg(unix)]
fn special(of: FileType) -> &'static str {
    use std::os::unix::fs::FileTypeExt;
    if of.is_fifo() {
        "a pipe"
    } else if of.is_char_device() || of.is_block_device() {
        "a device"
    } else if of.is_socket() {
        "a socket"
    } else {
        "no regular file"
    }
}

#[cfg(not(unix))]
fn special(_: FileType) -> &'static str {
    "no regular file"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_read_up_to_its_limit() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a");
        fs::write(&path, b"four").expect("written");
        assert_eq!(read(&path, 4).expect("fits"), b"four");
        assert_eq!(read_text(&path, 4).expect("text"), "four");
        assert_eq!(head(&path, 2).expect("there"), b"fo");
        let line = read(&path, 3).expect_err("too large").to_string();
        assert!(line.ends_with("a: 4 bytes, expected at most 3"), "{line}");
        fs::write(&path, b"a\xff").expect("written");
        let line = read_text(&path, 4).expect_err("no text").to_string();
        assert!(line.ends_with("byte 1 is not UTF-8, expected text"), "{line}");
        let none = read(&folder.path().join("b"), 4).expect_err("no such file");
        assert!(none.is_not_found(), "{none}");
        let line = read(folder.path(), 4).expect_err("a folder").to_string();
        assert!(line.ends_with("a folder, expected a regular file"), "{line}");
    }

    /// A sparse file of a terabyte is refused by its size, and costs nothing.
    #[test]
    fn a_sparse_file_is_refused_before_it_is_read() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("sparse");
        let file = File::create(&path).expect("made");
        if file.set_len(1 << 40).is_err() {
            return println!("this file system has no sparse files of this size");
        }
        let line = read(&path, 1 << 30).expect_err("too large").to_string();
        assert!(
            line.contains("1099511627776 bytes, expected at most 1073741824"),
            "{line}"
        );
        assert_eq!(head(&path, 3).expect("zeros"), [0; 3]);
        assert!(check(&path, 1 << 30).is_err() && check(&path, 1 << 41).is_ok());
    }

    #[cfg(unix)]
    #[test]
    fn pipes_and_devices_are_refused_and_nobody_waits() {
        let folder = tempfile::tempdir().expect("a folder");
        let pipe = folder.path().join("pipe");
        let made = std::process::Command::new("mkfifo").arg(&pipe).status();
        assert!(made.expect("mkfifo").success());
        for (path, found) in [(pipe.as_path(), "a pipe"), (Path::new("/dev/zero"), "a device")] {
            for line in [read(path, 10), head(path, 10)].map(|r| r.expect_err("refused").to_string()) {
                assert_eq!(
                    line,
                    format!("{}: {found}, expected a regular file", path.display())
                );
            }
        }
    }
}
