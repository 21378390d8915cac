//! Meshes as glTF 2.0: scenes of ours, foreign scenes and single models; see [`crate::glb`].

use super::{Content, ImportFile, ImportedScene, Importer};
use crate::glb::document::GltfDocument;
use crate::glb::{container, foreign, own};
use crate::{FormatError, Holds};

/// See the module.
pub const IMPORTER: Importer = Importer {
    id: "glb",
    title: "glTF meshes",
    extensions: &["glb", "gltf"],
    holds: &[Holds::Occupancy, Holds::Boxes],
    largest: 512 << 20,
    recognises: |head| {
        let text = String::from_utf8_lossy(head);
        let has = |key: &str| text.contains(key);
        let lists = [
            "\"accessors\"",
            "\"nodes\"",
            "\"scenes\"",
            "\"meshes\"",
            "\"extensionsUsed\"",
        ];
        container::is_glb(head)
            || (text.trim_start().starts_with('{') && has("\"asset\"") && lists.iter().any(|key| has(key)))
    },
    in_folder: None,
    read: |source| Ok(Content::Scene(Box::new(read(source)?))),
    #[cfg(test)]
    sample: || {
        let scene = crate::table_tests::scene();
        crate::export::glb::to_bytes(&scene, &crate::recipe::Recipe::of(&scene)).expect("a small scene")
    },
};

fn read(source: &ImportFile<'_>) -> Result<ImportedScene, FormatError> {
    let document = GltfDocument::read(source)?;
    document.check_size()?;
    match own::extras(&document)? {
        Some(extras) => own::scene(&document, &extras, source.name),
        None => foreign::scene(&document, source.name),
    }
}
