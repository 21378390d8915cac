//! A picture that the program wrote: reads the scene inside it, or the recipe that it was made with.

use super::{Content, ImportedScene, Importer};
use crate::recipe::{NAME, Recipe};
use crate::{FormatError, Holds, loom, png};

/// See [`Recipe`].
pub const IMPORTER: Importer = Importer {
    id: "picture",
    title: "pictures that carry their scene",
    extensions: &["png"],
    holds: &[Holds::Scene],
    largest: 256 << 20,
    recognises: |head| head.starts_with(png::SIGNATURE),
    in_folder: None,
    read: |source| {
        let inside = png::notes_inside(source.bytes).map_err(FormatError::new)?;
        if let Some(bytes) = inside.scene {
            let scene = loom::from_bytes(bytes).map_err(FormatError::new)?;
            return Ok(Content::Scene(Box::new(ImportedScene {
                sweep: None,
                scene,
                inferred: &[],
                skipped: Default::default(),
                notes: Vec::new(),
            })));
        }
        let text = inside.text.iter().find(|(keyword, _)| keyword == NAME);
        let Some((_, json)) = text else {
            return Err(FormatError::new(
                "a picture without a scene inside, expected one that sceneloom wrote",
            ));
        };
        let recipe: Recipe = serde_json::from_str(json).map_err(FormatError::new)?;
        match recipe.words.is_empty() {
            true => Err(FormatError::new(format!(
                "a picture of the scene {:?} without words to make it again: open the scene itself",
                scene::message::quoted(&recipe.scene, 80)
            ))),
            false => Ok(Content::Recipe(Box::new(recipe))),
        }
    },
    #[cfg(test)]
    sample: || {
        let recipe = Recipe::of(&crate::table_tests::scene());
        recipe
            .in_png(true, |notes| png::rgba(1, 1, &[1, 2, 3, 255], notes))
            .expect("a picture")
    },
};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::import::ImportFile;
    use crate::table_tests::scene;

    fn read(bytes: &[u8]) -> Result<Content, FormatError> {
        (IMPORTER.read)(&ImportFile {
            bytes,
            name: "p",
            path: None,
            options: Default::default(),
        })
    }

    #[test]
    fn a_picture_leads_back_to_its_scene_or_its_words() {
        let mut scene = scene();
        scene.words = std::sync::Arc::new(vec!["two cars, Übersee".into()]);
        let recipe = Recipe::of(&scene);
        assert_eq!(recipe.scene_sha256.len(), 64);
        let picture = |whole| {
            let bytes = recipe.in_png(whole, |notes| png::grey16(2, 1, &[1, 2], notes));
            bytes.expect("a picture")
        };
        let Ok(Content::Scene(loaded)) = read(&picture(true)) else {
            panic!("no scene");
        };
        assert!(loaded.scene.canvas() == scene.canvas() && loaded.scene.words == scene.words);
        let Ok(Content::Recipe(back)) = read(&picture(false)) else {
            panic!("no recipe");
        };
        assert_eq!(*back, recipe.clone().without_scene());
        // Other people's pictures, and ours without words.
        let foreign = png::grey16(2, 1, &[1, 2], &Default::default()).expect("a picture");
        assert!(
            read(&foreign)
                .expect_err("none")
                .to_string()
                .contains("without a scene")
        );
        scene.words = Default::default();
        let bare = Recipe::of(&scene).in_png(false, |notes| png::grey16(2, 1, &[1, 2], notes));
        assert!(read(&bare.expect("a picture")).is_err());
    }
}
