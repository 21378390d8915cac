//! `unet/config.json`.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Deserialize;
use serde_json::{Map, Value};

use super::{Each, check_plain, check_range, check_widths, read_config};
use crate::StableError;

/// Kind of a level: with or without attention to the text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub enum UnetBlockKind {
    /// Convolutions with transformer blocks.
    #[serde(rename = "CrossAttnDownBlock2D", alias = "CrossAttnUpBlock2D")]
    Listens,
    /// Convolutions alone.
    #[serde(rename = "DownBlock2D", alias = "UpBlock2D")]
    Plain,
}

/// Way to join the attention to several neighbours (`neighboring_attn_type`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum NeighbourFusion {
    /// One attention for each neighbour; their sum.
    #[default]
    Add,
    /// One attention over the tokens of all neighbours.
    Concat,
}

/// Layer between that attention and the block it adds to (`zero_module_type`); zero before training.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
pub enum Connector {
    /// A linear layer.
    #[default]
    #[serde(rename = "zero_linear")]
    Linear,
    /// A factor tanh(alpha) for each channel.
    #[serde(rename = "gated")]
    Gated,
    /// No layer.
    #[serde(rename = "none")]
    None,
}

/// Sizes of a UNet.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct UnetConfig {
    /// Channels of its input: 4, those of a latent.
    #[serde(default = "four")]
    pub in_channels: usize,
    /// Channels of its output.
    #[serde(default = "four")]
    pub out_channels: usize,
    /// Whether the cosines of a timestep come before its sines.
    #[serde(default = "yes")]
    pub flip_sin_to_cos: bool,
    /// Shift of the number of frequencies.
    #[serde(default)]
    pub freq_shift: f64,
    /// Levels on the way down.
    pub down_block_types: Vec<UnetBlockKind>,
    /// Levels on the way up; a ControlNet has none.
    #[serde(default)]
    pub up_block_types: Vec<UnetBlockKind>,
    /// Channels of each level, from the finest to the coarsest.
    pub block_out_channels: Vec<usize>,
    /// Residual blocks of each level on the way down.
    #[serde(default = "two")]
    pub layers_per_block: usize,
    /// Groups of the norms.
    #[serde(default = "groups")]
    pub norm_num_groups: usize,
    /// Epsilon of the norms of residual blocks.
    #[serde(default = "epsilon")]
    pub norm_eps: f64,
    /// Width of the text's tokens.
    #[serde(default = "context")]
    pub cross_attention_dim: usize,
    /// Transformer blocks in each place.
    #[serde(default = "one")]
    pub transformer_layers_per_block: Each,
    /// Number of heads, in spite of its name.
    #[serde(default = "heads")]
    pub attention_head_dim: Each,
    /// Number of heads, if it is given.
    #[serde(default)]
    pub num_attention_heads: Option<Each>,
    /// Whether tokens enter and leave transformers through linear layers instead of 1x1 convolutions.
    #[serde(default)]
    pub use_linear_projection: bool,
    /// SyntheOcc: neighbours of each view. If present, every transformer block has attention to them.
    #[serde(default)]
    pub neighboring_view_pair: Option<BTreeMap<String, Vec<usize>>>,
    /// SyntheOcc: way to join them.
    #[serde(default)]
    pub neighboring_attn_type: NeighbourFusion,
    /// SyntheOcc: layer behind that attention.
    #[serde(default)]
    pub zero_module_type: Connector,
    /// Attention to the frames before and after, an addition of this program; `"add"` is the only kind.
    #[serde(default)]
    pub cross_frame_attn_type: Option<NeighbourFusion>,
    #[serde(flatten)]
    rest: Map<String, Value>,
}

fn four() -> usize {
    4
}
fn yes() -> bool {
    true
}
fn two() -> usize {
    2
}
fn groups() -> usize {
    32
}
fn epsilon() -> f64 {
    1e-5
}
fn context() -> usize {
    1280
}
fn one() -> Each {
    Each::All(1)
}
fn heads() -> Each {
    Each::All(8)
}

/// Fields that change the network, and the values that are known here.
const PLAIN: [(&str, &[&str]); 23] = [
    ("act_fn", &["\"silu\"", "\"swish\""]),
    ("addition_embed_type", &["null"]),
    ("attention_type", &["\"default\""]),
    ("center_input_sample", &["false"]),
    ("class_embed_type", &["null"]),
    ("conv_in_kernel", &["3"]),
    ("conv_out_kernel", &["3"]),
    ("cross_attention_norm", &["null"]),
    ("crossview_attn_type", &["\"basic\""]),
    ("downsample_padding", &["1"]),
    ("dual_cross_attention", &["false"]),
    ("encoder_hid_dim", &["null"]),
    ("encoder_hid_dim_type", &["null"]),
    ("mid_block_scale_factor", &["1", "1.0"]),
    ("mid_block_type", &["\"UNetMidBlock2DCrossAttn\""]),
    ("num_class_embeds", &["null"]),
    ("only_cross_attention", &["false"]),
    ("resnet_out_scale_factor", &["1", "1.0"]),
    ("resnet_skip_time_act", &["false"]),
    ("resnet_time_scale_shift", &["\"default\""]),
    ("time_cond_proj_dim", &["null"]),
    ("time_embedding_type", &["\"positional\"", "null"]),
    ("timestep_post_act", &["null"]),
];

impl UnetConfig {
    /// Reads a configuration file. Errors in one line if a value is not known here.
    pub fn read(path: &Path) -> Result<Self, StableError> {
        read_config(path, |c: &Self| {
            c.check()?;
            let (down, up) = (c.down_block_types.len(), c.up_block_types.len());
            if up != down {
                return Err(format!("up_block_types has {up} entries, expected {down}"));
            }
            Ok(())
        })
    }

    /// Fails at values that no network of this crate has.
    pub(super) fn check(&self) -> Result<(), String> {
        check_plain(&self.rest, &PLAIN)?;
        let levels = self.block_out_channels.len();
        check_widths(&self.block_out_channels, self.norm_num_groups)?;
        if self.down_block_types.len() != levels {
            let found = self.down_block_types.len();
            return Err(format!("down_block_types has {found} entries, expected {levels}"));
        }
        check_range("in_channels", self.in_channels, 1..=64)?;
        check_range("out_channels", self.out_channels, 1..=64)?;
        check_range("layers_per_block", self.layers_per_block, 1..=16)?;
        check_range("cross_attention_dim", self.cross_attention_dim, 1..=65536)?;
        if !(self.norm_eps > 0.0 && self.norm_eps < 1.0) {
            return Err(format!("norm_eps is {}, expected 0 to 1", self.norm_eps));
        }
        let half = self.block_out_channels[0] as f64 / 2.0;
        if !(self.block_out_channels[0].is_multiple_of(2) && (0.0..half).contains(&self.freq_shift)) {
            return Err(format!(
                "freq_shift is {}, expected 0 to {half} and an even width",
                self.freq_shift
            ));
        }
        for depth in self
            .depths()
            .ok_or("transformer_layers_per_block: expected one number per level")?
        {
            check_range("transformer_layers_per_block", depth, 1..=32)?;
        }
        let heads = self
            .heads()
            .ok_or("attention_head_dim: expected one number per level")?;
        for (heads, width) in heads.into_iter().zip(&self.block_out_channels) {
            if heads == 0 || !width.is_multiple_of(heads) {
                return Err(format!(
                    "attention_head_dim is {heads}, expected a divisor of {width}"
                ));
            }
        }
        if self.cross_frame_attn_type == Some(NeighbourFusion::Concat) {
            return Err("cross_frame_attn_type is \"concat\", expected \"add\"".into());
        }
        self.neighbours().map(|_| ())
    }

    /// Number of heads of each level.
    pub(crate) fn heads(&self) -> Option<Vec<usize>> {
        let heads = self
            .num_attention_heads
            .as_ref()
            .unwrap_or(&self.attention_head_dim);
        heads.of(self.block_out_channels.len())
    }

    /// Number of transformer blocks in each place of each level.
    pub(crate) fn depths(&self) -> Option<Vec<usize>> {
        self.transformer_layers_per_block
            .of(self.block_out_channels.len())
    }

    /// The neighbours of each view; empty if the network draws views one by one.
    pub(crate) fn neighbours(&self) -> Result<Vec<Vec<usize>>, String> {
        let Some(pairs) = &self.neighboring_view_pair else {
            return Ok(Vec::new());
        };
        let views = pairs.len();
        check_range("the number of views of neighboring_view_pair", views, 1..=64)?;
        (0..views)
            .map(|view| {
                let found = pairs.get(&view.to_string());
                let found = found
                    .ok_or_else(|| format!("neighboring_view_pair: view {view} of {views} is missing"))?;
                if found.is_empty() || found.len() > views || found.iter().any(|n| *n >= views) {
                    return Err(format!(
                        "neighboring_view_pair: view {view} has {found:?}, expected views below {views}"
                    ));
                }
                Ok(found.clone())
            })
            .collect()
    }
}
