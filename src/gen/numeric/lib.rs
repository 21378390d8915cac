//! Numbers that every room shares: random draws, hashes, quantiles. It knows no other room.
//!
//! Which generator: [`philox`] gives a number for a place (seed, purpose, cell), whoever asks and in whatever order: noise of
//! the samplers. [`splitmix`] gives one number after another: worlds, tests.

pub mod hash;
pub mod philox;
pub mod quantile;
pub mod splitmix;
