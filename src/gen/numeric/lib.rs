//! Numerics that every room shares: random draws, hashes, quantiles, small systems of equations. It knows no other
//! room.
//!
//! Choice of generator: [`philox`] computes a number from (seed, purpose, cell), in any order; the samplers take their
//! noise from it. [`splitmix`] gives one number after another; worlds and tests use it.

pub mod decimal;
pub mod hash;
pub mod linear;
pub mod philox;
pub mod quantile;
pub mod splitmix;
