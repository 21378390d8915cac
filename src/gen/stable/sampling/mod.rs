//! From noise to latents: the steps of a scheduler's file, and how a prediction becomes the next state.
//!
//! Schedules, DDIM steps, DPM-Solver++ and UniPC are those of [`diffusion`], in 64 bits. What is here is where diffusers 0.42
//! puts its timesteps, which differs from method to method; PNDM, which no other network of this program uses; and Euler,
//! which is DDIM with noise levels between two training steps.

mod plan;
mod solver;

pub use plan::{Call, Plan};
pub(crate) use solver::Solver;
