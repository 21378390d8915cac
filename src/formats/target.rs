//! Target of a path that is to be written: a file, which is replaced whole, or a stream, which takes bytes as they
//! come.

use std::fs::{self, File, FileType, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

/// Most links that are followed, as many as systems follow.
const MOST_LINKS: usize = 40;

/// True once bytes of a file went to standard output.
static INTO_STDOUT: AtomicBool = AtomicBool::new(false);

/// Where bytes go.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum WriteTarget {
    /// A file, which may not exist yet. No link is left in its last name.
    File(PathBuf),
    /// A pipe, or a device that takes bytes one after the other: `/dev/null`, a terminal.
    Stream(PathBuf),
    /// A file that this process has open already: `/dev/stdout`, `/dev/fd/3`.
    Open(u32, PathBuf),
}

impl WriteTarget {
    /// The target of a path. Errors for folders, for block devices (a disk's contents would be lost), for sockets, and
    /// if links lead in a circle.
    pub(crate) fn from_path(path: &Path) -> io::Result<Self> {
        let path = match followed(path)? {
            Self::File(path) => path,
            open => return Ok(open),
        };
        match fs::metadata(&path) {
            Ok(is) if is.is_file() => Ok(Self::File(path)),
            Ok(is) if is.is_dir() => Err(io::Error::new(io::ErrorKind::IsADirectory, "is a directory")),
            Ok(is) if takes_a_stream(is.file_type()) => Ok(Self::Stream(path)),
            Ok(_) => Err(io::Error::new(
                io::ErrorKind::InvalidInput,
                "is a disk or a socket, expected a file or a pipe",
            )),
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(Self::File(path)),
            Err(error) => Err(error),
        }
    }

    /// Writes bytes into a pipe or device. Opening a pipe waits for its reader.
    pub(crate) fn stream(number: Option<u32>, path: &Path, bytes: &[u8]) -> io::Result<()> {
        match number {
            Some(1) => {
                INTO_STDOUT.store(true, Ordering::Relaxed);
                let mut out = io::stdout().lock();
                out.write_all(bytes)?;
                out.flush()
            }
            Some(2) => io::stderr().lock().write_all(bytes),
            // (a file that is open keeps its content)
            Some(_) => appended(OpenOptions::new().append(true).open(path)?, bytes),
            None => appended(OpenOptions::new().write(true).open(path)?, bytes),
        }
    }
}

fn appended(mut to: File, bytes: &[u8]) -> io::Result<()> {
    to.write_all(bytes)?;
    to.flush()
}

/// True once a file was written to standard output: messages for people must not go there too.
pub fn stdout_holds_a_file() -> bool {
    INTO_STDOUT.load(Ordering::Relaxed)
}

/// Follows links to the last name, where no file may exist yet.
fn followed(path: &Path) -> io::Result<WriteTarget> {
    let mut path = path.to_path_buf();
    for _ in 0..MOST_LINKS {
        if let Some(number) = descriptor(&path) {
            return Ok(WriteTarget::Open(number, path));
        }
        let Ok(to) = fs::read_link(&path) else {
            return Ok(WriteTarget::File(path));
        };
        path = path.parent().unwrap_or(Path::new("")).join(to);
    }
    Err(io::Error::new(
        io::ErrorKind::InvalidInput,
        "links lead in a circle",
    ))
}

/// The number of the file descriptor that such a path names; `None` for other paths.
fn descriptor(path: &Path) -> Option<u32> {
    let own = format!("/proc/{}/fd", std::process::id());
    let folder = path.parent()?.to_str()?;
    let is_own = ["/dev/fd", "/proc/self/fd", "/proc/thread-self/fd", &own].contains(&folder);
    path.file_name()?
        .to_str()?
        .parse()
        .ok()
        .filter(|_| is_own && cfg!(unix))
}

#[cfg(unix)]
fn takes_a_stream(kind: FileType) -> bool {
    use std::os::unix::fs::FileTypeExt;
    kind.is_fifo() || kind.is_char_device()
}

#[cfg(not(unix))]
fn takes_a_stream(_: FileType) -> bool {
    false
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::os::unix::fs::symlink;

    #[test]
    fn paths_of_what_is_open_are_known() {
        for (path, number) in [
            ("/dev/fd/7", Some(7)),
            ("/proc/self/fd/1", Some(1)),
            ("/dev/fdx/1", None),
            ("/dev/fd/x", None),
        ] {
            assert_eq!(descriptor(Path::new(path)), number, "{path}");
        }
        // (looked at only: nothing here is written)
        if Path::new("/dev/stdout").is_symlink() {
            assert!(matches!(
                WriteTarget::from_path(Path::new("/dev/stdout")),
                Ok(WriteTarget::Open(1, _))
            ));
        }
        assert_eq!(
            WriteTarget::from_path(Path::new("/dev/null")).ok(),
            Some(WriteTarget::Stream("/dev/null".into()))
        );
    }

    #[test]
    fn links_lead_to_what_they_name_and_no_circle_is_walked() {
        let folder = tempfile::tempdir().expect("a folder");
        let at = |name: &str| folder.path().join(name);
        symlink("new", at("dangling")).expect("a link");
        symlink("dangling", at("twice")).expect("a link");
        symlink("round", at("about")).expect("a link");
        symlink("about", at("round")).expect("a link");
        assert_eq!(
            WriteTarget::from_path(&at("twice")).expect("a file"),
            WriteTarget::File(at("new"))
        );
        let line = WriteTarget::from_path(&at("round"))
            .expect_err("a circle")
            .to_string();
        assert_eq!(line, "links lead in a circle");
        let _socket = std::os::unix::net::UnixListener::bind(at("socket")).expect("a socket");
        let line = WriteTarget::from_path(&at("socket"))
            .expect_err("a socket")
            .to_string();
        assert!(line.contains("expected a file or a pipe"), "{line}");
    }
}
