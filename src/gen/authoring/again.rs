//! A scene made again from the recipe in a file.

use std::path::Path;
use std::sync::Arc;

use anyhow::{Context, bail};

use super::new_ground::with_scenery;
use super::prompting::How;
use super::{open, text};
use editor::{Edit, apply_all};
use formats::import::{self, Content};
use formats::recipe::Recipe;
use scene::Scene;
use scene::message::quoted;

/// The scene that the words of a recipe make, in the same order and from the same seed, under its light and air.
/// Changes by hand are not in a recipe. Errors if there are no words, or they cannot be carried out.
pub fn again(recipe: &Recipe) -> anyhow::Result<Scene> {
    let Some((first, rest)) = recipe.words.split_first() else {
        bail!("the recipe has no words");
    };
    let read = text::read(first)?;
    let mut scene = text::make(first, &read.described.description, recipe.seed, &How::default()).scene;
    scene.words = Arc::new(vec![first.clone()]);
    for words in rest {
        let mut edits = text::read_edit(words, &scene, recipe.seed)?.edits();
        edits.push(Edit::KeepWords { words: words.clone() });
        let edits = with_scenery(&scene, edits);
        apply_all(&edits, &mut scene).with_context(|| format!("{words:?}"))?;
    }
    scene.conditions = recipe.conditions;
    scene.name = quoted(&recipe.scene, Scene::LONGEST_NAME).into();
    scene.touch();
    Ok(scene)
}

/// A scene from a file of any format that is read; from a picture that has only words, the scene that they make again.
pub fn scene_of(path: &Path) -> anyhow::Result<Scene> {
    Ok(file(path)?.scene)
}

/// The scene of [`scene_of`], with notes on how it was read.
pub fn file(path: &Path) -> anyhow::Result<open::OpenedScene> {
    match import::format_of(path).map(|importer| importer.id) {
        Ok("picture") => match import::read(path)?.1 {
            Content::Recipe(recipe) => again(&recipe)
                .map(Into::into)
                .with_context(|| path.display().to_string()),
            Content::Scene(loaded) => Ok(loaded.scene.into()),
            Content::Roads(_) => bail!("{}: roads in a picture", path.display()),
        },
        _ => open::file(path),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_and_seed_make_the_same_scene_again() {
        let recipe = Recipe {
            words: vec!["two parked cars and a bus ahead".into(), "remove the bus".into()],
            seed: 5,
            scene: "a street".into(),
            ..Recipe::default()
        };
        let (a, b) = (again(&recipe).expect("made"), again(&recipe).expect("made"));
        assert!(a.canvas() == b.canvas() && a.words.len() == 2);
        assert_eq!((a.frame().boxes.len(), &*a.name), (2, "a street"));
        let line = again(&Recipe::default()).expect_err("no words").to_string();
        assert!(line.contains("no words"), "{line}");
    }
}
