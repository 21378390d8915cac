//! Numbers that every room shares: random numbers, hashes, quantiles.

pub mod rng;
