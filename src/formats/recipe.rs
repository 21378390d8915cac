//! How a file came to be: the words, the seed, the parameters, the scene itself. Pictures carry it as text (and the whole scene
//! beside it), archives of arrays as an entry, JSON files under a key; so that any of them leads back to its scene.

use std::sync::Arc;

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use scene::{Conditions, Scene};

use crate::{loom, png};

/// Keyword of the text in a PNG, name of the entry in an npz, key in JSON.
pub const NAME: &str = "recipe";

/// How a file came to be. Unknown keys are read over.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Recipe {
    /// `sceneloom`.
    pub software: String,
    /// Version of the program.
    pub version: String,
    /// Name of the scene.
    pub scene: String,
    /// SHA-256 of the scene as a `.loom` file that keeps nothing beside it, hexadecimal; empty if it could not be made.
    pub scene_sha256: String,
    /// The moment, s.
    pub time_s: f64,
    /// Free text that describes the style.
    pub prompt: String,
    /// Texts that were typed to make the scene and to change it, in order.
    pub words: Vec<String>,
    /// Fixes every draw.
    pub seed: u64,
    /// Light and air.
    pub conditions: Conditions,
    /// Other parameters that the file was made with: knobs of a generation, a plan's variant.
    #[serde(default, skip_serializing_if = "serde_json::Value::is_null")]
    pub parameters: serde_json::Value,
    /// The scene as a `.loom` file, for pictures to carry; not in the text.
    #[serde(skip)]
    pub loom: Option<Arc<Vec<u8>>>,
}

/// Largest scene that a picture carries, bytes.
const LARGEST_INSIDE: usize = 4 << 20;

impl Recipe {
    /// The recipe of a scene as a whole, at the moment that it shows.
    pub fn of(scene: &Scene) -> Self {
        let loom = loom::alone_to_bytes(scene).ok();
        let hash = loom.as_deref().map(hex_of).unwrap_or_default();
        Self {
            software: "sceneloom".into(),
            version: env!("CARGO_PKG_VERSION").into(),
            scene: scene.name.to_string(),
            scene_sha256: hash,
            time_s: scene.time_s(),
            prompt: scene.prompt.to_string(),
            words: scene.words.to_vec(),
            seed: scene.seed,
            conditions: scene.conditions,
            parameters: serde_json::Value::Null,
            loom: loom.filter(|bytes| bytes.len() <= LARGEST_INSIDE).map(Arc::new),
        }
    }

    /// Takes the scene out, for files that do not carry it.
    pub fn without_scene(mut self) -> Self {
        self.loom = None;
        self
    }

    /// The recipe as JSON on one line.
    pub fn to_json(&self) -> String {
        serde_json::to_string(self).unwrap_or_default()
    }

    /// Calls `encode` with the notes that a PNG gets of it. Only pictures for viewing carry the scene (`whole`).
    pub fn in_png<T>(&self, whole: bool, encode: impl FnOnce(&png::Notes<'_>) -> T) -> T {
        let (seed, json) = (self.seed.to_string(), self.to_json());
        let software = format!("{} {}", self.software, self.version);
        encode(&png::Notes {
            text: &[
                ("Prompt", &self.prompt),
                ("Seed", &seed),
                ("Scene", &self.scene),
                ("Software", &software),
                (NAME, &json),
            ],
            scene: self.loom.as_ref().filter(|_| whole).map(|l| l.as_slice()),
        })
    }
}

/// Gives a scene the words, style, light and air and the seed of a recipe that a file carries, as far as they can be read: other
/// programs may have changed the text, which is no reason to refuse the file.
pub fn restore(recipe: &serde_json::Value, scene: &mut Scene) {
    if let Some(prompt) = recipe["prompt"].as_str() {
        scene.prompt = prompt.into();
    }
    let words = recipe["words"].as_array().into_iter().flatten();
    scene.words = Arc::new(words.filter_map(|w| w.as_str().map(str::to_owned)).collect());
    if let Some(seed) = recipe["seed"].as_u64() {
        scene.seed = seed;
    }
    let conditions = serde_json::from_value::<Conditions>(recipe["conditions"].clone());
    if let Some(conditions) = conditions.ok().filter(|c| c.problem().is_none()) {
        scene.conditions = conditions;
    }
}

/// SHA-256, hexadecimal.
pub fn hex_of(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|b| format!("{b:02x}")).collect()
}
