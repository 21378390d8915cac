//! `vae/config.json`.

use std::path::Path;

use serde::Deserialize;
use serde_json::{Map, Value};

use super::{check_plain, check_range, check_widths, read_config};
use crate::StableError;

/// Sizes of the autoencoder.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct VaeConfig {
    /// Channels of each level, from the finest to the coarsest.
    pub block_out_channels: Vec<usize>,
    /// Residual blocks of each level on the way down; the way up has one more.
    #[serde(default = "one")]
    pub layers_per_block: usize,
    /// Channels of a latent.
    #[serde(default = "four")]
    pub latent_channels: usize,
    /// Groups of the norms.
    #[serde(default = "groups")]
    pub norm_num_groups: usize,
    /// Factor of latents for the UNet.
    #[serde(default = "scale")]
    pub scaling_factor: f64,
    #[serde(flatten)]
    rest: Map<String, Value>,
}

fn one() -> usize {
    1
}
fn four() -> usize {
    4
}
fn groups() -> usize {
    32
}
fn scale() -> f64 {
    0.18215
}

/// Fields that change the network, and the values that are known here.
const PLAIN: [(&str, &[&str]); 9] = [
    ("act_fn", &["\"silu\"", "\"swish\""]),
    ("in_channels", &["3"]),
    ("out_channels", &["3"]),
    ("mid_block_add_attention", &["true"]),
    ("use_quant_conv", &["true"]),
    ("use_post_quant_conv", &["true"]),
    ("shift_factor", &["null"]),
    ("latents_mean", &["null"]),
    ("latents_std", &["null"]),
];

impl VaeConfig {
    /// Reads a configuration file. Errors in one line if a value is not known here.
    pub fn read(path: &Path) -> Result<Self, StableError> {
        read_config(path, |c: &Self| {
            check_plain(&c.rest, &PLAIN)?;
            for (field, kind) in [
                ("down_block_types", "DownEncoderBlock2D"),
                ("up_block_types", "UpDecoderBlock2D"),
            ] {
                let levels = vec![Value::from(kind); c.block_out_channels.len()];
                if c.rest.get(field).is_some_and(|v| v.as_array() != Some(&levels)) {
                    return Err(format!("{field}: expected {} times {kind}", levels.len()));
                }
            }
            check_widths(&c.block_out_channels, c.norm_num_groups)?;
            check_range("layers_per_block", c.layers_per_block, 1..=16)?;
            check_range("latent_channels", c.latent_channels, 1..=64)?;
            if !(c.scaling_factor.is_finite() && c.scaling_factor > 0.0) {
                return Err(format!(
                    "scaling_factor is {}, expected more than 0",
                    c.scaling_factor
                ));
            }
            Ok(())
        })
    }

    /// Pixels of a latent cell along a side.
    pub fn cell(&self) -> usize {
        1 << (self.block_out_channels.len() - 1)
    }
}
