//! A folder that files are written into. Their names come from scenes, so no name and no link in the folder may lead to
//! a file outside of it.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use scene::message::quoted;
use scene::plain_name::{self, NotPlain};

use super::atomic;

/// Why a file was not written into a folder. Each is one line.
#[derive(Debug, thiserror::Error)]
pub enum OutError {
    /// A part of the name is no plain one.
    #[error("{folder}: {problem}")]
    Name {
        /// The folder.
        folder: String,
        /// The problem with the name.
        problem: NotPlain,
    },
    /// A link on the way leads out of the folder, or to a path that does not exist.
    #[error("{path}: a link that leads out of the folder or to nothing, expected a file or folder in it")]
    LeadsOut {
        /// The link.
        path: String,
    },
    /// A thing of another kind has the name.
    #[error("{path}: found {found}, expected {expected}")]
    Taken {
        /// Path of that thing.
        path: String,
        /// Its kind.
        found: &'static str,
        /// The kinds that may be there.
        expected: &'static str,
    },
    /// Two files of one name, on systems that do not look at the case of letters at least.
    #[error(
        "{path}: two different files of this name, expected names of their own: cameras are called alike"
    )]
    Twice {
        /// The second.
        path: String,
    },
    /// The file system refused.
    #[error("{what} {path}: {source}")]
    Io {
        /// The action that was tried.
        what: &'static str,
        /// The file or folder.
        path: String,
        /// Error of the system.
        source: io::Error,
    },
}

/// A folder, and the files written into it.
#[derive(Debug)]
pub struct OutFolder {
    /// Path as the user named it.
    named: PathBuf,
    /// Path without links.
    root: PathBuf,
    /// Where each file went, by its name without the case of letters.
    written: BTreeMap<String, PathBuf>,
}

impl OutFolder {
    /// Makes the folder, where it is missing with those above it.
    pub fn make(path: &Path) -> Result<Self, OutError> {
        fs::create_dir_all(path).map_err(failed("create", path))?;
        let root = fs::canonicalize(path).map_err(failed("open", path))?;
        Ok(Self {
            named: path.to_path_buf(),
            root,
            written: BTreeMap::new(),
        })
    }

    /// The folder as the user named it.
    pub fn path(&self) -> &Path {
        &self.named
    }

    /// Errors if a file of that name (with `/` between folders in this one) may not be written. Does not make the file.
    pub fn check(&self, name: &str) -> Result<(), OutError> {
        self.place(name).map(drop)
    }

    /// Writes a file of that name (with `/` between folders in this one, which are made), whole or not at all; an older one is
    /// replaced. Returns its path below the folder as it was named. Errors for a name that is not plain, a link that leads
    /// out, and a second file of one name that holds something else.
    pub fn write(&mut self, name: &str, bytes: &[u8]) -> Result<PathBuf, OutError> {
        let (named, place) = (self.named.join(name), self.place(name)?);
        if let Some(before) = self.written.get(&plain_name::folded(name)) {
            return match fs::read(before).map_err(failed("read", before))? == bytes {
                true => Ok(named),
                false => Err(OutError::Twice { path: shown(&named) }),
            };
        }
        if let Some(above) = place.parent() {
            fs::create_dir_all(above).map_err(failed("create", above))?;
        }
        atomic::write(&place, bytes).map_err(failed("write", &named))?;
        self.written.insert(plain_name::folded(name), place);
        Ok(named)
    }

    /// Where a name leads; links within the folder are followed.
    fn place(&self, name: &str) -> Result<PathBuf, OutError> {
        let parts: Vec<&str> = name.split('/').collect();
        let mut at = self.root.clone();
        for (i, part) in parts.iter().enumerate() {
            plain_name::check_file(part).map_err(|problem| OutError::Name {
                folder: shown(&self.named),
                problem,
            })?;
            at.push(part);
            let mut is = match fs::symlink_metadata(&at) {
                Ok(is) => is,
                Err(error) if error.kind() == io::ErrorKind::NotFound => continue,
                Err(source) => return Err(failed("open", &at)(source)),
            };
            if is.is_symlink() {
                let leads_out = || OutError::LeadsOut { path: shown(&at) };
                let real = fs::canonicalize(&at).map_err(|_| leads_out())?;
                if !real.starts_with(&self.root) {
                    return Err(leads_out());
                }
                is = fs::metadata(&real).map_err(failed("open", &real))?;
                at = real;
            }
            let is_last = i + 1 == parts.len();
            let (is_right, expected) = match is_last {
                true => (is.is_file(), "a file or nothing"),
                false => (is.is_dir(), "a folder"),
            };
            if !is_right {
                return Err(OutError::Taken {
                    path: shown(&at),
                    found: if is.is_dir() {
                        "a folder"
                    } else if is.is_file() {
                        "a file"
                    } else {
                        "a pipe or device"
                    },
                    expected,
                });
            }
        }
        Ok(at)
    }
}

fn shown(path: &Path) -> String {
    quoted(&path.display().to_string(), 160)
}

fn failed(what: &'static str, path: &Path) -> impl FnOnce(io::Error) -> OutError {
    let path = shown(path);
    move |source| OutError::Io { what, path, source }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_lead_nowhere_else() {
        let dir = tempfile::tempdir().expect("a folder");
        let mut out = OutFolder::make(&dir.path().join("a/out")).expect("made");
        let elsewhere = dir.path().join("x.png").display().to_string();
        for name in [
            "../x.png",
            "../../x.png",
            &elsewhere,
            "a/../../x.png",
            "",
            ".",
            "a//b",
            "a/",
            "C:x",
            "..\\x",
            "a\nb",
        ] {
            let line = out.write(name, b"x").expect_err(name).to_string();
            assert!(line.lines().count() == 1, "{line}");
        }
        assert_eq!(fs::read_dir(dir.path().join("a/out")).expect("there").count(), 0);
        let path = out.write("sweeps/CAM/1.png", b"x").expect("written");
        assert_eq!(path, dir.path().join("a/out/sweeps/CAM/1.png"));
        assert_eq!(fs::read(path).expect("there"), b"x");
        let line = out.write("sweeps", b"x").expect_err("a folder").to_string();
        assert!(
            line.contains("found a folder, expected a file or nothing"),
            "{line}"
        );
    }

    #[test]
    fn two_files_of_one_name_are_told_unless_they_are_equal() {
        let dir = tempfile::tempdir().expect("a folder");
        fs::write(dir.path().join("a.png"), "of before").expect("written");
        let mut out = OutFolder::make(dir.path()).expect("made");
        out.write("a.png", b"1").expect("an older one is replaced");
        out.write("a.png", b"1").expect("the same again");
        for name in ["a.png", "A.PNG"] {
            let line = out.write(name, b"2").expect_err(name).to_string();
            assert!(line.contains("two different files"), "{line}");
        }
        assert_eq!(fs::read(dir.path().join("a.png")).expect("there"), b"1");
    }

    #[cfg(unix)]
    #[test]
    fn links_in_the_folder_lead_no_write_out() {
        use std::os::unix::fs::symlink;
        let dir = tempfile::tempdir().expect("a folder");
        let (root, at) = (dir.path().join("out"), |name: &str| dir.path().join(name));
        fs::create_dir_all(root.join("real")).expect("a folder");
        fs::create_dir(at("other")).expect("a folder");
        fs::write(at("secret"), "s").expect("a file");
        symlink(at("secret"), root.join("file.png")).expect("a link");
        symlink(at("new"), root.join("dangling.png")).expect("a link");
        symlink("../other", root.join("up")).expect("a link");
        symlink("real", root.join("also")).expect("a link");
        let mut out = OutFolder::make(&root).expect("made");
        for name in ["file.png", "dangling.png", "up/x.png", "up/deep/x.png"] {
            let line = out.write(name, b"x").expect_err(name).to_string();
            assert!(line.contains("leads out"), "{line}");
        }
        out.write("also/x.png", b"x").expect("a link within the folder");
        assert_eq!(fs::read(root.join("real/x.png")).expect("there"), b"x");
        assert_eq!(fs::read(at("secret")).expect("there"), b"s");
        assert!(!at("new").exists() && fs::read_dir(at("other")).expect("there").count() == 0);
        // The folder itself may be a link: the user named it.
        symlink(&root, at("link")).expect("a link");
        let mut out = OutFolder::make(&at("link")).expect("made");
        assert_eq!(
            out.write("y.png", b"y").expect("written"),
            at("link").join("y.png")
        );
    }
}
