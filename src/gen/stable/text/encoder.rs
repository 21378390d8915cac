//! CLIP's text encoder: a transformer in which each token attends to itself and those before it.

use candle_core::{Device, Tensor};

use crate::config::{Activation, TextConfig};
use crate::layers::{Attention, LayerNorm, TransposedLinear, causal_mask, quick_gelu};
use crate::weights::{Names, Weights};
use crate::{Machine, StableError, wrong};

/// Tensors that are ignored: old files hold a table of positions, and some files the projection of the whole network.
const IGNORED: [&str; 2] = ["position_ids", "text_projection.weight"];

struct TextEncoderLayer {
    norms: [LayerNorm; 2],
    attention: Attention,
    widen: TransposedLinear,
    narrow: TransposedLinear,
}

/// Encoder of token ids to the text input of the UNet.
pub struct TextEncoder {
    config: TextConfig,
    words: Tensor,     // [vocab, width]
    positions: Tensor, // [tokens, width]
    layers: Vec<TextEncoderLayer>,
    norm: LayerNorm,
    mask: Tensor,
    device: Device,
}

impl TextEncoder {
    /// Loads the network from weights; their names may begin with `text_model.` or not. Errors if they do not fit the
    /// configuration.
    pub fn load(config: TextConfig, weights: &Weights, machine: &Machine) -> Result<Self, StableError> {
        weights.build(machine, &IGNORED, |names| Self::of(&config, names, machine))
    }

    /// Checks that weights fit a configuration, by names, shapes and types alone. Errors list the first few that do
    /// not.
    pub fn check(config: &TextConfig, weights: &Weights) -> Result<(), StableError> {
        weights.check(&IGNORED, |names| Self::of(config, names, &Machine::cpu()))
    }

    fn of(config: &TextConfig, names: &Names<'_>, machine: &Machine) -> Result<Self, StableError> {
        const PREFIX: &str = "text_model";
        let embeddings = "embeddings.token_embedding.weight";
        let names = match names.at(PREFIX).has(embeddings) || !names.has(embeddings) {
            true => names.at(PREFIX),
            false => names.clone(),
        };
        let (width, epsilon) = (config.hidden_size, config.layer_norm_eps);
        let layer = |i: usize| {
            let names = names.at("encoder.layers").at(i);
            let attention: [&[&str]; 4] = [&["q_proj"], &["k_proj"], &["v_proj"], &["out_proj"]];
            Ok(TextEncoderLayer {
                norms: [
                    LayerNorm::load(&names.at("layer_norm1"), width, epsilon)?,
                    LayerNorm::load(&names.at("layer_norm2"), width, epsilon)?,
                ],
                attention: Attention::load_named(
                    &names.at("self_attn"),
                    attention,
                    width,
                    config.num_attention_heads,
                )?,
                widen: TransposedLinear::load(&names.at("mlp.fc1"), width, config.intermediate_size)?,
                narrow: TransposedLinear::load(&names.at("mlp.fc2"), config.intermediate_size, width)?,
            })
        };
        let at = names.at("embeddings");
        let tokens = config.max_position_embeddings;
        Ok(Self {
            words: at.tensor("token_embedding.weight", &[config.vocab_size, width])?,
            positions: at.tensor("position_embedding.weight", &[tokens, width])?,
            layers: (0..config.num_hidden_layers)
                .map(layer)
                .collect::<Result<_, StableError>>()?,
            norm: LayerNorm::load(&names.at("final_layer_norm"), width, epsilon)?,
            mask: causal_mask(tokens, &machine.device)?,
            device: machine.device.clone(),
            config: config.clone(),
        })
    }

    /// Sizes of the network.
    pub fn config(&self) -> &TextConfig {
        &self.config
    }

    /// The last hidden states `[1, tokens, width]` of one text's ids, after the final norm. Errors if an id is out of
    /// range or the number of ids is not that of the positions.
    pub fn encode(&self, ids: &[u32]) -> Result<Tensor, StableError> {
        crate::check_length("token ids", ids.len(), self.config.max_position_embeddings)?;
        if let Some(id) = ids.iter().find(|id| **id as usize >= self.config.vocab_size) {
            let expected = format!("less than {}, the words of the encoder", self.config.vocab_size);
            return Err(wrong("token id", id, expected));
        }
        let ids = Tensor::from_slice(ids, ids.len(), &self.device)?;
        let mut x = (self.words.index_select(&ids, 0)? + &self.positions)?.unsqueeze(0)?;
        for layer in &self.layers {
            let y = layer.norms[0].forward(&x)?;
            x = (&x + layer.attention.forward(&y, &y, Some(&self.mask))?)?;
            let y = layer.widen.forward(&layer.norms[1].forward(&x)?)?;
            let y = match self.config.hidden_act {
                Activation::QuickGelu => quick_gelu(&y)?,
                Activation::Gelu => y.gelu_erf()?,
            };
            x = (&x + layer.narrow.forward(&y)?)?;
        }
        Ok(self.norm.forward(&x)?)
    }
}
