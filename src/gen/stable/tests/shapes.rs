//! Names and shapes of the real models, as diffusers and transformers have them: a file of such a header fits. No weights.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::PathBuf;

use super::folder;
use crate::config::{ControlConfig, TextConfig, UnetConfig, VaeConfig};
use crate::{ControlNet, StableError, TextEncoder, Unet, Vae, Weights};

#[derive(serde::Deserialize)]
struct Listed {
    config: serde_json::Value,
    shapes: BTreeMap<String, Vec<usize>>,
}

/// A folder with a configuration and a file that has a header and a hole behind it.
fn hollow(listed: &Listed) -> (tempfile::TempDir, PathBuf, Weights) {
    let at = tempfile::tempdir().expect("a folder");
    let (mut header, mut end) = (serde_json::Map::new(), 0);
    for (name, shape) in &listed.shapes {
        let bytes = 2 * shape.iter().product::<usize>();
        let entry = serde_json::json!({"dtype": "F16", "shape": shape, "data_offsets": [end, end + bytes]});
        header.insert(name.clone(), entry);
        end += bytes;
    }
    let header = serde_json::Value::Object(header).to_string();
    let path = at.path().join("model.safetensors");
    let mut file = std::fs::File::create(path).expect("a file");
    file.write_all(&(header.len() as u64).to_le_bytes())
        .expect("written");
    file.write_all(header.as_bytes()).expect("written");
    file.set_len((8 + header.len() + end) as u64).expect("a hole");
    let config = at.path().join("config.json");
    std::fs::write(&config, listed.config.to_string()).expect("written");
    let weights = Weights::of_folder(at.path()).expect("a header");
    (at, config, weights)
}

#[test]
fn real_models_fit() {
    let bytes = std::fs::read(folder("shapes.json")).expect("the shapes");
    let all: BTreeMap<String, Listed> = serde_json::from_slice(&bytes).expect("shapes");
    assert!(all.len() >= 8, "{}", all.len());
    for (name, listed) in &all {
        let (_at, config, weights) = hollow(listed);
        let fits = || -> Result<(), StableError> {
            match name.split_once('.').expect("a model and a part").1 {
                "unet" => Unet::check(&UnetConfig::read(&config)?, &weights),
                "vae" => Vae::check(&VaeConfig::read(&config)?, &weights),
                "text_encoder" => TextEncoder::check(&TextConfig::read(&config)?, &weights),
                _ => ControlNet::check(&ControlConfig::read(&config)?, &weights),
            }
        };
        let count: usize = listed.shapes.values().map(|s| s.iter().product::<usize>()).sum();
        fits().unwrap_or_else(|e| panic!("{name}: {e}"));
        println!("| {name} | {} tensors | {count} numbers |", listed.shapes.len());
    }
}

/// The same for one of them: its folder and its configuration.
pub(super) fn hollow_folder(name: &str) -> (tempfile::TempDir, PathBuf) {
    let bytes = std::fs::read(folder("shapes.json")).expect("the shapes");
    let all: BTreeMap<String, Listed> = serde_json::from_slice(&bytes).expect("shapes");
    let (at, config, _) = hollow(&all[name]);
    (at, config)
}
