//! Stable Diffusion 1.5 and 2.1 in candle, from public weights in folders as diffusers writes them, for pictures of
//! driving scenes: text encoder, autoencoder, UNet, ControlNet, schedulers, and SyntheOcc's additions: planes of
//! classes through 1x1 convolutions, and attention to the neighbouring views and frames.
//!
//! [`Pipeline::open`] checks every name and shape before it reads a number. [`Pipeline::draw`] is a pure function of its
//! [`PictureRequest`]. Sources: Rombach et al. 2022 (arXiv 2112.10752), Zhang et al. 2023 (ControlNet, arXiv 2302.05543), Li et al.
//! 2024 (SyntheOcc, arXiv 2410.00337), and the layout of weights of diffusers 0.42.

#![forbid(unsafe_code)]

pub mod config;
mod control;
mod error;
mod layers;
mod machine;
pub mod noise;
mod pictures;
mod pipeline;
pub mod planes;
pub mod sampling;
#[cfg(test)]
mod tests;
mod text;
mod unet;
mod vae;
mod weights;

pub use control::{ControlNet, MpiEncoder};
pub use error::StableError;
pub(crate) use error::{check_finite, check_length, wrong};
pub use machine::Machine;
pub use pictures::PictureBatch;
pub use pipeline::{
    Control, DenoisingStep, Folders, GeneratedPictures, PictureRequest, Pipeline, SemanticPlanes,
    StartPictures,
};
pub use text::{TextEncoder, Words};
pub use unet::{Extra, Unet};
pub use vae::Vae;
pub use weights::Weights;
