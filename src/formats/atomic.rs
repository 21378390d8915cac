//! Writing files whole or not at all: beside the final name, flushed to disk, then renamed. A pipe or a device is no
//! file; its bytes are written directly.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::target::WriteTarget;

pub use super::target::stdout_holds_a_file;

/// Replaces the file at `path` by `bytes`. Whatever happens, the path holds either the old file or the new one, whole.
/// A symbolic link is followed and stays; an existing file's permissions are kept. A pipe, `/dev/null`, `/dev/stdout`
/// and similar paths are written to directly; opening a pipe waits for its reader. Errors for folders, disks and
/// sockets.
pub fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    match WriteTarget::from_path(path)? {
        WriteTarget::File(file) => replace(&file, bytes),
        WriteTarget::Stream(path) => WriteTarget::stream(None, &path, bytes),
        WriteTarget::Open(number, path) => WriteTarget::stream(Some(number), &path, bytes),
    }
}

/// Puts a file in place of an old file of that name, if there is one.
fn replace(target: &Path, bytes: &[u8]) -> io::Result<()> {
    let folder = match target.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent.to_path_buf(),
        _ => PathBuf::from("."),
    };
    let mut builder = tempfile::Builder::new();
    builder.prefix(".sceneloom-").suffix(".tmp");
    let old = fs::metadata(target).ok().map(|m| m.permissions());
    if let Some(permissions) = old {
        builder.permissions(permissions);
    } else {
        use_default_permissions(&mut builder);
    }
    let mut file = builder.tempfile_in(&folder)?;
    file.write_all(bytes)?;
    file.as_file().sync_all()?;
    file.persist(target).map_err(|e| e.error)?;
    sync_folder(&folder)
}

/// Gives a file the permissions that any new file gets; a temporary file would be private otherwise.
#[cfg(unix)]
fn use_default_permissions(builder: &mut tempfile::Builder<'_, '_>) {
    use std::os::unix::fs::PermissionsExt;
    builder.permissions(fs::Permissions::from_mode(0o666)); // less the umask
}

#[cfg(not(unix))]
fn use_default_permissions(_: &mut tempfile::Builder<'_, '_>) {}

/// Makes the rename itself durable, where folders can be flushed.
fn sync_folder(folder: &Path) -> io::Result<()> {
    if cfg!(unix) {
        // Some network file systems refuse to flush a folder; the file itself is safe by now.
        let _ = File::open(folder)?.sync_all();
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn replaces_whole_and_leaves_nothing_beside() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("a.loom");
        write(&path, b"one").expect("written");
        write(&path, b"two, longer").expect("replaced");
        assert_eq!(fs::read(&path).expect("there"), b"two, longer");
        write(&path, b"").expect("emptied");
        assert_eq!(fs::read(&path).expect("there"), b"");
        assert_eq!(fs::read_dir(folder.path()).expect("there").count(), 1);
    }

    #[test]
    fn a_place_that_cannot_be_written_is_an_error_and_leaves_nothing() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        write(&folder.path().join("no/such/a.loom"), b"x").expect_err("no such folder");
        write(folder.path(), b"x").expect_err("a folder");
        assert_eq!(fs::read_dir(folder.path()).expect("there").count(), 0);
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed_and_permissions_kept() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().expect("a temporary folder");
        let (real, link) = (folder.path().join("real"), folder.path().join("link"));
        fs::write(&real, b"old").expect("written");
        fs::set_permissions(&real, fs::Permissions::from_mode(0o640)).expect("set");
        std::os::unix::fs::symlink(&real, &link).expect("linked");
        write(&link, b"new").expect("written");
        assert!(fs::symlink_metadata(&link).expect("there").is_symlink());
        assert_eq!(fs::read(&real).expect("there"), b"new");
        let mode = fs::metadata(&real).expect("there").permissions().mode();
        assert_eq!(mode & 0o777, 0o640);
        // A link to nothing yet makes what it names.
        let dangling = folder.path().join("dangling");
        std::os::unix::fs::symlink("made", &dangling).expect("linked");
        write(&dangling, b"first").expect("written");
        assert!(fs::symlink_metadata(&dangling).expect("there").is_symlink());
        assert_eq!(fs::read(folder.path().join("made")).expect("there"), b"first");
    }

    #[cfg(unix)]
    #[test]
    fn pipes_and_devices_are_written_to_and_stay() {
        use std::os::unix::fs::FileTypeExt;
        use std::process::Command;
        let folder = tempfile::tempdir().expect("a temporary folder");
        let (pipe, link) = (folder.path().join("pipe"), folder.path().join("link"));
        assert!(
            Command::new("mkfifo")
                .arg(&pipe)
                .status()
                .expect("mkfifo")
                .success()
        );
        std::os::unix::fs::symlink(&pipe, &link).expect("linked");
        let long = vec![7; 1 << 20];
        for path in [&pipe, &link] {
            let reader = {
                let pipe = pipe.clone();
                std::thread::spawn(move || fs::read(pipe))
            };
            write(path, &long).expect("written");
            assert!(reader.join().expect("no panic").expect("read") == long);
            assert!(fs::symlink_metadata(&pipe).expect("there").file_type().is_fifo());
        }
        // A device of its own, as the machine's must not be tried on.
        let null = folder.path().join("null");
        let made = Command::new("mknod").arg(&null).args(["c", "1", "3"]).output();
        match made.is_ok_and(|m| m.status.success()) && File::options().write(true).open(&null).is_ok() {
            true => {
                write(&null, b"gone").expect("written");
                assert!(
                    fs::symlink_metadata(&null)
                        .expect("there")
                        .file_type()
                        .is_char_device()
                );
            }
            false => println!("no device can be made here"),
        }
        let left = fs::read_dir(folder.path()).expect("there").count();
        assert!(left <= 3, "{left} names, nothing beside");
    }
}
