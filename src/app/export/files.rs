//! Writes the files of an export to the disk.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::{Context, anyhow, bail};

use super::Format;
use formats::atomic;
use formats::export::OutFile;
use formats::out_folder::OutFolder;
use scene::plain_name::folded;

/// Files that were written, with their sizes in bytes.
type WrittenFiles = Vec<(PathBuf, u64)>;

/// Writes the files of the formats: one file to `path`, or all of them into the folder `path`. Before the first is
/// written, all names are checked.
pub(super) fn write(formats: &[Format], ready: &[Vec<OutFile>], path: &Path) -> anyhow::Result<WrittenFiles> {
    if !fills_a_folder(formats, path) {
        return write_one(path, ready);
    }
    let laid = laid(formats, ready).map_err(|e| anyhow!("{}: {e}", path.display()))?;
    let mut folder = OutFolder::make(path)?;
    laid.iter().try_for_each(|(name, _)| folder.check(name))?;
    let mut one = |(name, bytes): &(String, &[u8])| Ok((folder.write(name, bytes)?, bytes.len() as u64));
    laid.iter().map(&mut one).collect()
}

/// True unless there is one format of one file and the path is not a folder.
fn fills_a_folder(formats: &[Format], path: &Path) -> bool {
    match formats {
        [format] if format.file_name.is_some() => {
            path.is_dir() || path.as_os_str().to_string_lossy().ends_with(['/', '\\'])
        }
        _ => true,
    }
}

/// Writes the file of a format. No folder is made.
fn write_one(path: &Path, ready: &[Vec<OutFile>]) -> anyhow::Result<WrittenFiles> {
    let one = |file: &OutFile| {
        atomic::write(path, &file.bytes).with_context(|| format!("write {}", path.display()))?;
        Ok((path.to_path_buf(), file.bytes.len() as u64))
    };
    ready.iter().flatten().map(one).collect()
}

/// Path of each file in the common folder, with its bytes. A file that formats share, such as the calibration, is there
/// once. A format that would give other contents to a file of an earlier one gets a folder of its own, named after the
/// format. Errors if two different files of one format have one name, or if a file of that folder is taken.
fn laid<'a>(formats: &[Format], ready: &'a [Vec<OutFile>]) -> anyhow::Result<Vec<(String, &'a [u8])>> {
    let mut known: BTreeMap<String, (&str, &[u8])> = BTreeMap::new();
    let mut out = Vec::new();
    for (format, files) in formats.iter().zip(ready) {
        differ(files)?;
        let taken = |folder: &str| {
            files.iter().find_map(|file| {
                let name = format!("{folder}{}", file.name);
                let (by, bytes) = known.get(&folded(&name))?;
                (*bytes != file.bytes).then_some((name, *by))
            })
        };
        let own = format!("{}/", format.id);
        let folder = if taken("").is_some() { own.as_str() } else { "" };
        if let Some((name, by)) = taken(folder) {
            let id = format.id;
            bail!(
                "{name} would be a file of {by} and another one of {id}, expected one of the two at a time"
            );
        }
        for file in files {
            let name = format!("{folder}{}", file.name);
            if known.insert(folded(&name), (format.id, &file.bytes)).is_none() {
                out.push((name, &*file.bytes));
            }
        }
    }
    Ok(out)
}

/// Errors if two different files have one name.
fn differ(files: &[OutFile]) -> anyhow::Result<()> {
    let mut known: BTreeMap<String, &OutFile> = BTreeMap::new();
    for file in files {
        let first = known.entry(folded(&file.name)).or_insert(file);
        if first.bytes != file.bytes {
            bail!(
                "two different files would be called {}, expected sensors of less like names",
                file.name
            );
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(name: &str, text: &str) -> OutFile {
        OutFile {
            name: name.into(),
            bytes: text.into(),
        }
    }

    fn formats_of<const N: usize>(ids: [&str; N]) -> [Format; N] {
        ids.map(|id| formats::export::from_id(id).expect("a format"))
    }

    #[test]
    fn what_formats_share_lies_once_and_what_differs_in_a_folder_of_its_own() {
        let dir = tempfile::tempdir().expect("a folder");
        let path = dir.path().join("out");
        let formats = formats_of(["depth", "pictures", "truth"]);
        let ready = [
            vec![file("FRONT_depth.png", "of rays"), file("calibration.json", "{}")],
            vec![file("FRONT.png", "seen"), file("calibration.json", "{}")],
            vec![
                file("FRONT.png", "seen"),
                file("front_Depth.png", "of hits"),
                file("truth.json", "[]"),
            ],
        ];
        let written = write(&formats, &ready, &path).expect("written");
        let expected = [
            ("FRONT_depth.png", "of rays"),
            ("calibration.json", "{}"),
            ("FRONT.png", "seen"),
            ("truth/FRONT.png", "seen"),
            ("truth/front_Depth.png", "of hits"),
            ("truth/truth.json", "[]"),
        ];
        assert_eq!(written.len(), expected.len(), "{written:?}");
        for ((place, bytes), (name, text)) in written.iter().zip(expected) {
            assert_eq!(place, &path.join(name));
            assert_eq!(*bytes, text.len() as u64);
            assert_eq!(std::fs::read_to_string(place).expect("there"), text);
        }
    }

    #[test]
    fn nothing_is_written_where_two_files_want_one_name() {
        let dir = tempfile::tempdir().expect("a folder");
        let path = dir.path().join("out");
        let refused = |formats: &[Format], ready: &[Vec<OutFile>]| {
            let error = write(formats, ready, &path).expect_err("two files of one name");
            assert!(!path.exists());
            error.to_string()
        };
        let alike = [vec![file("A.png", "a"), file("a.png", "b")]];
        let line = refused(&formats_of(["depth"]), &alike);
        assert!(
            line.contains("called a.png, expected sensors of less like names"),
            "{line}"
        );
        let ready = [
            vec![file("a.png", "a"), file("truth/a.png", "b")],
            vec![file("a.png", "c")],
        ];
        let line = refused(&formats_of(["depth", "truth"]), &ready);
        assert!(
            line.contains("truth/a.png would be a file of depth and another one of truth")
                && !line.contains('\n'),
            "{line}"
        );
    }
}
