//! Sampling from noise to latents: the steps of a scheduler's file, and the way from a prediction to the next state.
//!
//! Schedules, DDIM steps, DPM-Solver++ and UniPC are those of [`diffusion`], in 64 bits. This module adds the timesteps
//! of diffusers 0.42, which differ from method to method; PNDM, which no other network of this program uses; and Euler,
//! which is DDIM with noise levels between two training steps.

mod plan;
#[cfg(feature = "networks")]
mod solver;

pub use plan::{Call, SamplingPlan};
#[cfg(feature = "networks")]
pub(crate) use solver::Solver;
