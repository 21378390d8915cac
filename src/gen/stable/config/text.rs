//! `text_encoder/config.json`, and the needed part of the tokenizer's configuration.

use std::path::Path;

use serde::Deserialize;
use serde_json::Value;

use super::{MOST_BYTES, check_range, read_config, read_json};
use crate::StableError;

/// The activation of the text encoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Activation {
    /// x sigmoid(1.702 x), in 1.5.
    QuickGelu,
    /// x Phi(x), in 2.1.
    Gelu,
}

/// Sizes of the text encoder.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct TextConfig {
    /// Size of the vocabulary.
    pub vocab_size: usize,
    /// Width of a token.
    pub hidden_size: usize,
    /// Width inside its multilayer perceptrons.
    pub intermediate_size: usize,
    /// Layers. Files of 2.1 have one less than the network they were cut from, so the last layer of the file is the one
    /// to take.
    pub num_hidden_layers: usize,
    /// Heads.
    pub num_attention_heads: usize,
    /// Number of tokens of a text.
    #[serde(default = "tokens")]
    pub max_position_embeddings: usize,
    /// Epsilon of its norms.
    #[serde(default = "epsilon")]
    pub layer_norm_eps: f64,
    /// Its activation.
    #[serde(default = "quick")]
    pub hidden_act: Activation,
}

fn tokens() -> usize {
    77
}
fn epsilon() -> f64 {
    1e-5
}
fn quick() -> Activation {
    Activation::QuickGelu
}

impl TextConfig {
    /// Reads a configuration file. Errors in one line if a value is not known here.
    pub fn read(path: &Path) -> Result<Self, StableError> {
        read_config(path, |c: &Self| {
            check_range("vocab_size", c.vocab_size, 2..=1_000_000)?;
            check_range("hidden_size", c.hidden_size, 1..=16384)?;
            check_range("intermediate_size", c.intermediate_size, 1..=65536)?;
            check_range("num_hidden_layers", c.num_hidden_layers, 1..=128)?;
            check_range("max_position_embeddings", c.max_position_embeddings, 2..=4096)?;
            if c.num_attention_heads == 0 || !c.hidden_size.is_multiple_of(c.num_attention_heads) {
                return Err(format!(
                    "num_attention_heads is {}, expected a divisor of {}",
                    c.num_attention_heads, c.hidden_size
                ));
            }
            if !(c.layer_norm_eps > 0.0 && c.layer_norm_eps < 1.0) {
                return Err(format!("layer_norm_eps is {}, expected 0 to 1", c.layer_norm_eps));
            }
            Ok(())
        })
    }
}

/// Settings of the tokenizer in a folder.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TokenizerConfig {
    /// The token that pads short texts.
    pub pad: Option<String>,
}

impl TokenizerConfig {
    /// Reads `tokenizer_config.json` and `special_tokens_map.json` in a folder, either of which may be absent. Errors
    /// if one cannot be read.
    pub fn read(folder: &Path) -> Result<Self, StableError> {
        for name in ["tokenizer_config.json", "special_tokens_map.json"] {
            let path = folder.join(name);
            if !path.exists() {
                continue;
            }
            let value: Value = read_json(&path, MOST_BYTES)?;
            // A token is written as a text, or as a text with its properties.
            let pad = &value["pad_token"];
            if let Some(pad) = pad.as_str().or_else(|| pad["content"].as_str()) {
                return Ok(Self {
                    pad: Some(pad.to_owned()),
                });
            }
        }
        Ok(Self { pad: None })
    }
}
