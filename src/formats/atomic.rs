//! Writing files whole or not at all: beside the final name, flushed to disk, then renamed.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Replaces the file at `path` by `bytes`. Whatever happens, the path holds either the old file or
/// the new one, whole. A symbolic link is followed; an existing file's permissions are kept.
pub fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    // A rename would replace a link instead of what it points to.
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
    if target.is_dir() {
        return Err(io::Error::new(io::ErrorKind::IsADirectory, "is a directory"));
    }
    let folder = match target.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent.to_path_buf(),
        _ => PathBuf::from("."),
    };
    let mut builder = tempfile::Builder::new();
    builder.prefix(".sceneloom-").suffix(".tmp");
    let old = fs::metadata(&target).ok().map(|m| m.permissions());
    if let Some(permissions) = old {
        builder.permissions(permissions);
    } else {
        use_default_permissions(&mut builder);
    }
    let mut file = builder.tempfile_in(&folder)?;
    file.write_all(bytes)?;
    file.as_file().sync_all()?;
    file.persist(&target).map_err(|e| e.error)?;
    sync_folder(&folder)
}

/// What any new file gets; temporary files are private otherwise.
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
    }
}
