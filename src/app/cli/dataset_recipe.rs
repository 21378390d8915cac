//! Recipe of a folder of training data, so that a resumed run does not mix two.

use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use serde_json::{Map, Value, json};

use app::open;
use formats::input;
use formats::out_folder::OutFolder;
use formats::recipe::hex_of;

/// Name of the recipe's file.
const FILE: &str = "recipe.json";

/// A source folder as the recipe notes it: its own name, and a hash that tells its files from those of another folder.
/// Its place on this machine stays private.
pub(super) struct SourceFolder {
    /// Path without links and dots; recipes of older programs noted it.
    place: PathBuf,
    name: String,
    files: usize,
    /// SHA-256 of the names below the folder and the sizes of its files, hexadecimal.
    sha256: String,
}

impl SourceFolder {
    /// Reads the files of an extension below a folder, without recipes of data that were written into it. Errors if
    /// there is none.
    pub(super) fn read_from(dir: &Path, extension: &str, what: &str) -> anyhow::Result<Self> {
        let place = dir.canonicalize().unwrap_or_else(|_| dir.into());
        let mut files = open::files_below(&place, extension, what)?;
        files.retain(|file| !file.ends_with(FILE));
        let mut told = String::new();
        for file in &files {
            let size = file.metadata().with_context(|| file.display().to_string())?.len();
            let below = file.strip_prefix(&place).unwrap_or(file);
            let parts: Vec<_> = below.iter().map(|part| part.to_string_lossy()).collect();
            told += &format!("{} {size}\n", parts.join("/"));
        }
        Ok(Self {
            name: place
                .file_name()
                .unwrap_or_default()
                .to_string_lossy()
                .into_owned(),
            files: files.len(),
            sha256: hex_of(told.as_bytes()),
            place,
        })
    }

    /// The folder as the recipe's JSON.
    pub(super) fn to_json(&self) -> Value {
        json!({ "name": self.name, "files": self.files, "names_and_sizes_sha256": self.sha256 })
    }

    /// True if a recipe means this folder: by its files, whatever its name is now, or by its path in recipes of older
    /// programs.
    fn is_meant_by(&self, noted: &Value) -> bool {
        match noted.as_str() {
            Some(path) => Path::new(path) == self.place,
            None => noted["names_and_sizes_sha256"] == *self.sha256,
        }
    }
}

/// All inputs that the data of a folder depend on.
pub(super) struct Recipe {
    /// Arguments by name.
    pub(super) arguments: Map<String, Value>,
    /// Source folders of the data, by the name of the argument.
    pub(super) folders: Vec<(&'static str, Option<SourceFolder>)>,
}

impl Recipe {
    fn to_json(&self) -> Map<String, Value> {
        let of = |(what, made): &(&str, Option<SourceFolder>)| {
            (
                (*what).to_owned(),
                made.as_ref().map_or(Value::Null, SourceFolder::to_json),
            )
        };
        let folders = self.folders.iter().map(of);
        self.arguments.clone().into_iter().chain(folders).collect()
    }

    /// The first argument of which a recipe says something else.
    fn differs_from(&self, before: &Map<String, Value>) -> Option<String> {
        let noted = |what: &str| before.get(what).unwrap_or(&Value::Null).clone();
        let argument = self.arguments.iter().find(|(what, here)| noted(what) != **here);
        let folder = self.folders.iter().find(|(what, made)| match made {
            Some(made) => !made.is_meant_by(&noted(what)),
            None => !noted(what).is_null(),
        });
        argument
            .map(|(what, _)| what.clone())
            .or(folder.map(|(what, _)| (*what).to_owned()))
    }
}

/// Notes the recipe in a folder. Errors if data that were made with another are there.
pub(super) fn claim(dir: &Path, recipe: &Recipe) -> anyhow::Result<()> {
    let file = dir.join(FILE);
    let before = match input::read(&file, input::LARGEST_TEXT) {
        Ok(bytes) => bytes,
        Err(error) if error.is_not_found() => {
            OutFolder::make(dir)?.write(FILE, &serde_json::to_vec_pretty(&recipe.to_json())?)?;
            return Ok(());
        }
        Err(error) => return Err(error.into()),
    };
    let before: Map<String, Value> =
        serde_json::from_slice(&before).with_context(|| file.display().to_string())?;
    if let Some(what) = recipe.differs_from(&before) {
        let (there, here) = (
            before.get(&what).unwrap_or(&Value::Null),
            &recipe.to_json()[&what],
        );
        bail!(
            "{}: its data were made with {what} {there}, found {here}; expected the same, or another folder",
            dir.display()
        );
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn recipe(from: &Path) -> Recipe {
        let arguments = Map::from_iter([("seed".to_owned(), json!(3))]);
        let made = SourceFolder::read_from(from, "npz", "labels").expect("files");
        Recipe {
            arguments,
            folders: vec![("from", Some(made)), ("roads", None)],
        }
    }

    #[test]
    fn a_recipe_tells_folders_apart_and_not_where_they_lie() {
        let dir = tempfile::tempdir().expect("a folder");
        let at = |name: &str| dir.path().join(name);
        for name in ["a", "b", "c"] {
            std::fs::create_dir_all(at(name).join("deep")).expect("made");
            std::fs::write(at(name).join("deep/1.npz"), "labels").expect("written");
        }
        std::fs::write(at("c").join("2.npz"), "more").expect("written");
        claim(&at("out"), &recipe(&at("a"))).expect("noted");
        let text = std::fs::read_to_string(at("out").join(FILE)).expect("there");
        let place = dir.path().canonicalize().expect("there");
        assert!(
            !text.contains(&*place.to_string_lossy()) && !text.contains('/'),
            "{text}"
        );
        claim(&at("out"), &recipe(&at("b"))).expect("the same files elsewhere");
        let line = claim(&at("out"), &recipe(&at("c")))
            .expect_err("others")
            .to_string();
        assert!(
            line.contains("made with from") && line.contains("another folder"),
            "{line}"
        );
        let mut other = recipe(&at("a"));
        other.arguments.insert("seed".into(), json!(4));
        let line = claim(&at("out"), &other).expect_err("another seed").to_string();
        assert!(line.contains("made with seed 3, found 4"), "{line}");
        // Recipes of older programs hold the path.
        let old = json!({ "seed": 3, "from": at("a").canonicalize().expect("there"), "roads": null });
        std::fs::write(at("out").join(FILE), old.to_string()).expect("written");
        claim(&at("out"), &recipe(&at("a"))).expect("the same folder");
        assert!(claim(&at("out"), &recipe(&at("b"))).is_err());
    }
}
