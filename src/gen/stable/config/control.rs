//! `controlnet/config.json` and `mpi_encoder/config.json`.

use std::path::Path;

use serde::Deserialize;
use serde_json::{Map, Value};

use super::{MOST_BYTES, UnetConfig, check_plain, check_range, read_config, read_json, refused};
use crate::StableError;

/// Sizes of a ControlNet.
#[derive(Clone, Debug, PartialEq)]
pub struct ControlConfig {
    /// Sizes of the half UNet.
    pub unet: UnetConfig,
    /// Channels of its input picture: 3, or the planes of SyntheOcc.
    pub conditioning_channels: usize,
    /// Channels of the convolutions that embed the picture.
    pub embedding: Vec<usize>,
    /// Whether the picture's colours are expected in the order blue, green, red.
    pub is_bgr: bool,
}

#[derive(Deserialize)]
struct Own {
    #[serde(default = "three")]
    conditioning_channels: usize,
    #[serde(default = "embedding")]
    conditioning_embedding_out_channels: Vec<usize>,
    #[serde(default)]
    controlnet_conditioning_channel_order: Option<String>,
    #[serde(flatten)]
    rest: Map<String, Value>,
}

fn three() -> usize {
    3
}
fn embedding() -> Vec<usize> {
    vec![16, 32, 96, 256]
}

impl ControlConfig {
    /// Reads a configuration file. Errors in one line if a value is not known here.
    pub fn read(path: &Path) -> Result<Self, StableError> {
        let value: Value = read_json(path, MOST_BYTES)?;
        Self::from_json(value).map_err(|reason| refused(path, reason))
    }

    fn from_json(value: Value) -> Result<Self, String> {
        let own: Own = serde_json::from_value(value.clone()).map_err(|e| e.to_string())?;
        let unet: UnetConfig = serde_json::from_value(value).map_err(|e| e.to_string())?;
        unet.check()?;
        check_plain(&own.rest, &[("global_pool_conditions", &["false"])])?;
        check_range("conditioning_channels", own.conditioning_channels, 1..=4096)?;
        let embedding = own.conditioning_embedding_out_channels;
        check_range(
            "the number of conditioning_embedding_out_channels",
            embedding.len(),
            1..=8,
        )?;
        for width in &embedding {
            check_range("conditioning_embedding_out_channels", *width, 1..=8192)?;
        }
        let is_bgr = match own.controlnet_conditioning_channel_order.as_deref() {
            None | Some("rgb") => false,
            Some("bgr") => true,
            Some(other) => {
                return Err(format!(
                    "controlnet_conditioning_channel_order is {other:?}, expected \"rgb\" or \"bgr\""
                ));
            }
        };
        Ok(Self {
            unet,
            conditioning_channels: own.conditioning_channels,
            embedding,
            is_bgr,
        })
    }
}

/// Sizes of the encoder of multi-plane images.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
pub struct MpiConfig {
    /// Number of planes, plus one channel for the first visible class: 257 in SyntheOcc.
    pub conditioning_channels: usize,
    /// Channels of the UNet's first level.
    pub embedding_channels: usize,
}

impl MpiConfig {
    /// Reads a configuration file. Errors in one line if a size is out of range.
    pub fn read(path: &Path) -> Result<Self, StableError> {
        read_config(path, |c: &Self| {
            check_range("conditioning_channels", c.conditioning_channels, 1..=4096)?;
            check_range("embedding_channels", c.embedding_channels, 1..=8192)
        })
    }
}
