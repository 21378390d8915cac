//! Checks that the parts of a model fit each other, and that a request fits the model.

use super::{PictureRequest, Pipeline};
use crate::config::{ControlConfig, MpiConfig, TextConfig, UnetConfig, VaeConfig};
use crate::text::Words;
use crate::{StableError, check_finite, check_length, wrong};

/// Most pictures of a request.
const MOST_PICTURES: usize = 1024;
/// Most pixels of a picture along a side.
const MOST_PX: usize = 8192;

fn same(what: &'static str, found: usize, expected: usize, of: &str) -> Result<(), StableError> {
    match found == expected {
        true => Ok(()),
        false => Err(wrong(what, found, format!("{expected}, that of {of}"))),
    }
}

pub(super) fn fit_text(words: &Words, text: &TextConfig, unet: &UnetConfig) -> Result<(), StableError> {
    same(
        "cross_attention_dim",
        unet.cross_attention_dim,
        text.hidden_size,
        "the text encoder",
    )?;
    let largest = words.largest() as usize;
    if largest >= text.vocab_size {
        let expected = format!("less than {}, the words of the encoder", text.vocab_size);
        return Err(wrong("largest token id", largest, expected));
    }
    Ok(())
}

pub(super) fn fit_latents(vae: &VaeConfig, unet: &UnetConfig) -> Result<(), StableError> {
    // Nine channels would be a network that is trained for inpainting.
    same(
        "in_channels of the UNet",
        unet.in_channels,
        vae.latent_channels,
        "a latent",
    )?;
    same(
        "out_channels of the UNet",
        unet.out_channels,
        vae.latent_channels,
        "a latent",
    )
}

pub(super) fn fit_control(control: &ControlConfig, unet: &UnetConfig) -> Result<(), StableError> {
    let own = &control.unet;
    same(
        "cross_attention_dim of a ControlNet",
        own.cross_attention_dim,
        unet.cross_attention_dim,
        "the UNet",
    )?;
    same(
        "in_channels of a ControlNet",
        own.in_channels,
        unet.in_channels,
        "the UNet",
    )?;
    if own.block_out_channels != unet.block_out_channels || own.layers_per_block != unet.layers_per_block {
        let found = format!("{:?} x {}", own.block_out_channels, own.layers_per_block);
        let expected = format!("{:?} x {}", unet.block_out_channels, unet.layers_per_block);
        return Err(wrong("block_out_channels of a ControlNet", found, expected));
    }
    Ok(())
}

pub(super) fn fit_mpi(mpi: &MpiConfig, unet: &UnetConfig) -> Result<(), StableError> {
    let expected = unet.block_out_channels[0];
    same(
        "embedding_channels of the MPI encoder",
        mpi.embedding_channels,
        expected,
        "the UNet",
    )
}

/// Fails unless the sizes of a request fit the model and each other, and its numbers are finite.
pub(super) fn request(pipeline: &Pipeline, request: &PictureRequest<'_>) -> Result<(), StableError> {
    let (pictures, cell) = (request.pictures(), pipeline.cell());
    if !(1..=MOST_PICTURES).contains(&pictures) {
        return Err(wrong(
            "number of pictures",
            pictures,
            format!("1 to {MOST_PICTURES}"),
        ));
    }
    let together = pipeline.unet.views();
    if together > 1 && request.views != together {
        return Err(wrong(
            "number of views",
            request.views,
            format!("{together}, those of the UNet"),
        ));
    }
    for side in request.size {
        if side == 0 || side > MOST_PX || !side.is_multiple_of(cell) {
            let expected = format!("a multiple of {cell} px up to {MOST_PX}");
            return Err(wrong("side of a picture", side, expected));
        }
    }
    if !matches!(request.prompts.len(), 1) {
        check_length("prompts", request.prompts.len(), pictures)?;
    }
    let weight = request.guidance.weight;
    if !weight.is_finite() || weight.abs() > 1e4 || !(0.0..=1.0).contains(&request.guidance.rescale) {
        let found = format!("{weight} and {}", request.guidance.rescale);
        return Err(wrong(
            "guidance",
            found,
            "a weight up to 10000 and a rescale of 0 to 1",
        ));
    }
    let size = pipeline.latent_size(pictures, request.size);
    if let Some(noise) = &request.noise {
        check_length("noise", noise.len(), crate::noise::count(size))?;
        check_finite("noise", noise)?;
    }
    let pixels = pictures * request.size[0] * request.size[1];
    if let Some(start) = &request.start {
        check_length("pictures to go out from", start.pictures.count(), pictures)?;
        if start.pictures.size() != request.size {
            let found = format!("{:?}", start.pictures.size());
            return Err(wrong(
                "size of the pictures to go out from",
                found,
                format!("{:?}", request.size),
            ));
        }
        if let Some(mask) = start.mask {
            check_length("mask", mask.len(), pixels)?;
        }
    }
    for control in &request.controls {
        let Some(net) = pipeline.controls.get(control.net) else {
            let expected = format!(
                "less than {}, the ControlNets of the model",
                pipeline.controls.len()
            );
            return Err(wrong("ControlNet", control.net, expected));
        };
        if net.takes_planes() {
            return Err(wrong(
                "condition of a ControlNet that takes planes",
                "a picture",
                "planes",
            ));
        }
        let expected = net.config().conditioning_channels * pixels;
        check_length("picture of a ControlNet", control.picture.len(), expected)?;
        check_finite("picture of a ControlNet", control.picture)?;
        check_finite("scale of a ControlNet", &[control.scale as f32])?;
    }
    if let Some(planes) = &request.planes {
        let Some(channels) = pipeline.plane_channels() else {
            let expected = "none: the model has no encoder of planes";
            return Err(wrong("multi-plane images", planes.ids.len(), expected));
        };
        check_length(
            "multi-plane images",
            planes.ids.len(),
            pictures * channels * size[2] * size[3],
        )?;
        check_finite("multi-plane image", planes.ids)?;
        check_finite("scale of planes", &[planes.scale as f32])?;
    }
    Ok(())
}
