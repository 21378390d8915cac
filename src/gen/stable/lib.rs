//! Stable Diffusion 1.5 and 2.1 in candle, from public weights in folders as diffusers writes them, for pictures of
//! driving scenes: text encoder, autoencoder, UNet, ControlNet, schedulers, and SyntheOcc's additions: planes of
//! classes through 1x1 convolutions, and attention to the neighbouring views and frames.
//!
//! [`Pipeline::open`] checks every name and shape before it reads a number. [`Pipeline::draw`] is a pure function of its
//! [`PictureRequest`]. Sources: Rombach et al. 2022 (arXiv 2112.10752), Zhang et al. 2023 (ControlNet, arXiv 2302.05543), Li et al.
//! 2024 (SyntheOcc, arXiv 2410.00337), and the layout of weights of diffusers 0.42.

//!
//! Without the feature `networks` the room has the same face, and [`Pipeline::open`] says how to get a program with them.

#![forbid(unsafe_code)]

#[cfg(not(feature = "networks"))]
mod absent;
pub mod config;
#[cfg(feature = "networks")]
mod control;
mod error;
mod folders;
#[cfg(feature = "networks")]
mod layers;
#[cfg(feature = "networks")]
mod machine;
pub mod noise;
mod pictures;
#[cfg(feature = "networks")]
mod pipeline;
pub mod planes;
mod request;
pub mod sampling;
#[cfg(all(test, feature = "networks"))]
mod tests;
#[cfg(feature = "networks")]
mod text;
#[cfg(feature = "networks")]
mod unet;
#[cfg(feature = "networks")]
mod vae;
#[cfg(feature = "networks")]
mod weights;

#[cfg(not(feature = "networks"))]
pub use absent::{ControlNet, DenoisingStep, GeneratedPictures, Machine, Pipeline, Unet};
#[cfg(feature = "networks")]
pub use control::{ControlNet, MpiEncoder};
pub use error::StableError;
pub(crate) use error::{check_finite, check_length, wrong};
pub use folders::Folders;
#[cfg(feature = "networks")]
pub use machine::Machine;
pub use pictures::PictureBatch;
#[cfg(feature = "networks")]
pub use pipeline::{DenoisingStep, GeneratedPictures, Pipeline};
pub use request::{Control, PictureRequest, SemanticPlanes, StartPictures};
#[cfg(feature = "networks")]
pub use text::{TextEncoder, Words};
#[cfg(feature = "networks")]
pub use unet::{Extra, Unet};
#[cfg(feature = "networks")]
pub use vae::Vae;
#[cfg(feature = "networks")]
pub use weights::Weights;
