//! Diffusion without a network inside: schedules, samplers, inversion, replay. Tables and states are f64.

pub mod inversion;
pub mod replay;
pub mod schedule;
pub mod solver;
