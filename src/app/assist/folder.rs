//! The one folder that a session may read and write. Names come from outside: nothing above the folder is reached, whatever a
//! name holds and wherever a link leads.

use std::fs::{self, Metadata};
use std::io::ErrorKind;
use std::path::{Component, Path, PathBuf};

use anyhow::{Context, bail};
use schemars::JsonSchema;
use serde::Serialize;
use tempfile::TempDir;

use scene::message::quoted;
use scene::plain_name::check_file;

/// Longest name, bytes.
const LONGEST_NAME: usize = 240;
/// Files that a list holds at most.
const MOST_LISTED: usize = 1000;
/// Depth of folders that a list goes into.
const DEEPEST: usize = 4;

/// A folder whose files a session may read and write.
#[derive(Clone, Debug)]
pub struct Folder {
    /// Without links and dots.
    root: PathBuf,
}

/// A file of the folder.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct FileEntry {
    /// Its name from the folder, with `/` between folders.
    pub name: String,
    /// Its size, bytes.
    pub bytes: u64,
}

impl Folder {
    /// Opens a folder. Errors if the path is none.
    pub fn new(path: &Path) -> anyhow::Result<Self> {
        let root = fs::canonicalize(path).with_context(|| format!("folder {}", path.display()))?;
        if !root.is_dir() {
            bail!("folder {}: not a folder", path.display());
        }
        Ok(Self { root })
    }

    /// Path of the folder.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// The path of a file or folder that is to be read. Errors if there is none, if it is no file or folder (a pipe, a
    /// device), or if it is outside after links are followed.
    pub fn existing(&self, name: &str) -> anyhow::Result<PathBuf> {
        let path = self.root.join(parts(name)?.iter().collect::<PathBuf>());
        let real = fs::canonicalize(&path).map_err(|e| match e.kind() {
            ErrorKind::NotFound => anyhow::anyhow!("{name}: no such file in the folder of this session"),
            _ => anyhow::Error::new(e).context(name.to_owned()),
        })?;
        if !real.starts_with(&self.root) {
            bail!("{name}: leads out of the folder of this session");
        }
        let is = fs::metadata(&real).with_context(|| name.to_owned())?;
        if !(is.is_file() || is.is_dir()) {
            bail!("{name}: neither a file nor a folder");
        }
        Ok(real)
    }

    /// Checks that a file of that name may be written, and makes nothing. Errors for a name that is refused, that leads out of
    /// the folder or is a link or folder, and, unless `replace`, for one that is there.
    pub fn may_write(&self, name: &str, replace: bool) -> anyhow::Result<()> {
        self.place(&parts_of_new(name)?, name, replace, false).map(drop)
    }

    /// The path of a file that is to be written now: as [`Self::may_write`], and folders above it are made.
    pub fn target(&self, name: &str, replace: bool) -> anyhow::Result<PathBuf> {
        self.place(&parts_of_new(name)?, name, replace, true)
    }

    /// Checks each folder above the file; makes those that are missing, if it may.
    fn place(&self, parts: &[&str], name: &str, replace: bool, make: bool) -> anyhow::Result<PathBuf> {
        let (file, folders) = parts.split_last().context("the name is empty")?;
        let mut at = self.root.clone();
        for folder in folders {
            at.push(folder);
            match look(&at, name)? {
                Some(is) if is.is_dir() => {}
                Some(is) if is.is_symlink() => {
                    let real = fs::canonicalize(&at).unwrap_or_default();
                    if !(real.starts_with(&self.root) && real.is_dir()) {
                        bail!("{name}: leads out of the folder of this session");
                    }
                    at = real;
                }
                Some(_) => bail!("{name}: {} is a file, expected a folder", quoted(folder, 60)),
                None if make => fs::create_dir(&at).with_context(|| name.to_owned())?,
                // (below it nothing is there either)
                None => return Ok(at.join(file)),
            }
        }
        at.push(file);
        match look(&at, name)? {
            Some(is) if is.is_symlink() => bail!("{name}: is a link, and links are not written through"),
            Some(is) if is.is_dir() => bail!("{name}: is a folder, expected a file"),
            Some(is) if !is.is_file() => bail!("{name}: is a pipe or a device, expected a file"),
            Some(_) if !replace => bail!("{name}: is there already; \"replace\": true writes over it"),
            _ => Ok(at),
        }
    }

    /// Files of the folder and of folders in it, in the order of their names; true if there are more than are listed. Hidden
    /// ones and links are left out.
    pub fn list(&self) -> anyhow::Result<(Vec<FileEntry>, bool)> {
        let (mut found, mut more) = (Vec::new(), false);
        let mut open = vec![(self.root.clone(), String::new(), 0)];
        while let Some((path, prefix, depth)) = open.pop() {
            let entries = fs::read_dir(&path).with_context(|| format!("read {prefix:?}"))?;
            for entry in entries {
                let entry = entry.with_context(|| format!("read {prefix:?}"))?;
                let (Ok(kind), Ok(name)) = (entry.file_type(), entry.file_name().into_string()) else {
                    continue;
                };
                let is_plain = parts(&name).is_ok();
                let named = format!("{prefix}{name}");
                if kind.is_dir() && is_plain && depth < DEEPEST {
                    open.push((entry.path(), format!("{named}/"), depth + 1));
                } else if kind.is_file() && is_plain {
                    let bytes = entry.metadata().map_or(0, |m| m.len());
                    found.push(FileEntry { name: named, bytes });
                }
                // (enough of them to sort: a folder of millions is not read to its end)
                if found.len() > 20 * MOST_LISTED {
                    more = true;
                    break;
                }
            }
        }
        found.sort_by(|a, b| a.name.cmp(&b.name));
        more |= found.len() > MOST_LISTED;
        found.truncate(MOST_LISTED);
        Ok((found, more))
    }

    /// A hidden folder in this one, in which files are made before they go to their places. It goes when it is dropped.
    pub fn staging(&self) -> anyhow::Result<TempDir> {
        let staging = tempfile::Builder::new()
            .prefix(".sceneloom-")
            .tempdir_in(&self.root);
        staging.context("make a folder for new files")
    }

    /// Moves every file below a staging folder into the folder `name`, after it was checked that all of them may be written.
    /// With `main`, the file of that name there gets the name itself instead, and the others go beside it.
    pub fn publish(
        &self,
        staging: &Path,
        (name, main): (&str, Option<&str>),
        replace: bool,
    ) -> anyhow::Result<Vec<FileEntry>> {
        let mut above = parts_of_new(name)?;
        if main.is_some() {
            above.pop();
        }
        let files = files_below(staging)?;
        let named = |relative: &str| match main == Some(relative) {
            true => name.to_owned(),
            false => above
                .iter()
                .copied()
                .chain([relative])
                .collect::<Vec<_>>()
                .join("/"),
        };
        let place = |relative: &str, make: bool| {
            let named = named(relative);
            self.place(&named.split('/').collect::<Vec<_>>(), &named, replace, make)
        };
        for (relative, _) in &files {
            place(relative, false)?;
        }
        let mut published = Vec::new();
        for (relative, bytes) in files {
            let (to, name) = (place(&relative, true)?, named(&relative));
            fs::rename(staging.join(&relative), to).with_context(|| name.clone())?;
            published.push(FileEntry { name, bytes });
        }
        Ok(published)
    }
}

/// The metadata of a path, links not followed; `None` if nothing is there.
fn look(path: &Path, name: &str) -> anyhow::Result<Option<Metadata>> {
    match fs::symlink_metadata(path) {
        Ok(is) => Ok(Some(is)),
        Err(e) if e.kind() == ErrorKind::NotFound => Ok(None),
        Err(e) => Err(anyhow::Error::new(e).context(name.to_owned())),
    }
}

/// Files below a folder that this program has just written, with `/` between names, sorted; and their sizes.
fn files_below(root: &Path) -> anyhow::Result<Vec<(String, u64)>> {
    let (mut found, mut open) = (Vec::new(), vec![String::new()]);
    while let Some(prefix) = open.pop() {
        for entry in fs::read_dir(root.join(&prefix))? {
            let entry = entry?;
            let named = format!("{prefix}{}", entry.file_name().to_string_lossy());
            let is = entry.metadata()?;
            match is.is_dir() {
                true => open.push(format!("{named}/")),
                false => found.push((named, is.len())),
            }
        }
    }
    found.sort();
    Ok(found)
}

/// The parts of a name. Refused: empty names, absolute ones, `..` and `.`, hidden files, backslashes, drives, control
/// characters, and names that are too long.
fn parts(name: &str) -> anyhow::Result<Vec<&str>> {
    let shown = quoted(name, 80);
    if name.is_empty() || name.len() > LONGEST_NAME {
        let found = name.len();
        bail!("the name {shown:?} has {found} bytes, expected 1 to {LONGEST_NAME}");
    }
    let parts: Vec<&str> = name.split('/').collect();
    let sound = |part: &&str| {
        let alone = matches!(
            Path::new(part).components().collect::<Vec<_>>()[..],
            [Component::Normal(_)]
        );
        let refused = |c: char| c.is_control() || matches!(c, '\\' | ':' | '\0');
        alone && !part.starts_with('.') && !part.contains(refused)
    };
    match parts.iter().all(sound) {
        true => Ok(parts),
        false => bail!(
            "the name {shown:?} is refused, expected one below the folder of this session: no leading /, no .., no hidden files"
        ),
    }
}

/// The parts of the name of a new file: names that other systems refuse are refused here too.
fn parts_of_new(name: &str) -> anyhow::Result<Vec<&str>> {
    let parts = parts(name)?;
    parts.iter().try_for_each(|part| check_file(part))?;
    Ok(parts)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder() -> (TempDir, Folder) {
        let dir = tempfile::tempdir().expect("a folder");
        let inner = dir.path().join("in");
        fs::create_dir(&inner).expect("a folder");
        fs::write(dir.path().join("secret.loom"), "s").expect("a file");
        let folder = Folder::new(&inner).expect("a folder");
        (dir, folder)
    }

    #[test]
    fn names_that_lead_out_are_refused() {
        let (_dir, folder) = folder();
        let long = "x".repeat(LONGEST_NAME + 1);
        let bad = [
            "",
            "/etc/passwd",
            "../secret.loom",
            "a/../../secret.loom",
            "..",
            ".",
            "a//b",
            "a/",
            "./a",
            ".bashrc",
            "a/.ssh/key",
            "C:\\x",
            "C:x",
            "a\\..\\b",
            "a\nb",
            "a\0b",
            long.as_str(),
        ];
        for name in bad {
            let read = folder.existing(name).expect_err(name).to_string();
            assert!(!read.contains("no such file"), "{name}: {read}");
            let write = folder.target(name, true).expect_err(name).to_string();
            assert!(write.lines().count() == 1 && write.len() < 300, "{write}");
        }
        assert_eq!(fs::read_dir(folder.root()).expect("a folder").count(), 0);
        for name in ["NUL.loom", "a/con/b.loom", "a*.loom", "a./b.loom"] {
            assert!(folder.target(name, true).is_err(), "{name}");
        }
        assert!(folder.target("a/b/c.loom", false).is_ok());
        assert!(folder.existing("a/b").is_ok());
    }

    #[cfg(unix)]
    #[test]
    fn links_are_not_followed_out() {
        use std::os::unix::fs::symlink;
        let (dir, folder) = folder();
        let root = folder.root().to_owned();
        symlink(dir.path(), root.join("up")).expect("a link");
        symlink(dir.path().join("secret.loom"), root.join("file.loom")).expect("a link");
        symlink(dir.path().join("new.loom"), root.join("dangling.loom")).expect("a link");
        for name in ["up/secret.loom", "file.loom"] {
            let error = folder.existing(name).expect_err(name).to_string();
            assert!(error.contains("leads out"), "{error}");
        }
        for name in ["up/x.loom", "file.loom", "dangling.loom", "up/new/x.loom"] {
            assert!(folder.target(name, true).is_err(), "{name}");
        }
        let staging = folder.staging().expect("a folder");
        fs::write(staging.path().join("x.png"), "x").expect("a file");
        assert!(folder.publish(staging.path(), ("up", None), true).is_err());
        let names = |path: &Path| fs::read_dir(path).expect("a folder").count();
        assert_eq!(names(dir.path()), 2, "nothing was written outside");
        // A link within the folder may be used.
        fs::create_dir(root.join("real")).expect("a folder");
        symlink(root.join("real"), root.join("also")).expect("a link");
        let path = folder.target("also/x.loom", false).expect("inside");
        assert_eq!(path, root.join("real/x.loom"));
    }

    #[test]
    fn what_is_there_is_replaced_only_if_that_was_said() {
        let (_dir, folder) = folder();
        let path = folder.target("a.loom", false).expect("a place");
        fs::write(path, "a").expect("a file");
        assert!(folder.may_write("a.loom", false).is_err());
        assert!(folder.may_write("a.loom", true).is_ok());
        assert!(folder.target("a.loom/b", true).is_err(), "a file is no folder");
        let staging = folder.staging().expect("a folder");
        fs::create_dir(staging.path().join("t")).expect("a folder");
        for name in ["x.png", "t/.hidden"] {
            fs::write(staging.path().join(name), name).expect("a file");
        }
        let written = folder
            .publish(staging.path(), ("out", None), false)
            .expect("published");
        let names: Vec<&str> = written.iter().map(|f| f.name.as_str()).collect();
        assert_eq!(names, ["out/t/.hidden", "out/x.png"]);
        let (listed, more) = folder.list().expect("a list");
        let names: Vec<&str> = listed.iter().map(|f| f.name.as_str()).collect();
        assert_eq!((names, more), (vec!["a.loom", "out/x.png"], false));
    }
}
