//! A renderer for simulators: scenes, poses and times in, camera pictures and LiDAR sweeps out, over gRPC. The protocol
//! is the one by which AlpaSim's runtime asks its sensor simulation; `docs/serve.md` says which part of it is served,
//! `docs/sensorsim.proto` what its fields mean.
//!
//! A request is read, let in by a gate, and rendered on a thread that may block. Each wait (for a first request, for
//! the rest of a body, for a client that takes its answer) has a deadline and a bound of its own (`limits::CALLERS`),
//! so that idle clients take no place from those that ask. Only scenes and prepared moments are kept between requests:
//! the same request gives the same bytes.

mod encode;
#[cfg(test)]
mod error_tests;
#[cfg(test)]
mod fixture;
mod gate;
#[cfg(test)]
mod grpc_tests;
mod lens;
mod lidar;
pub mod limits;
mod moment;
mod offers;
mod picture;
mod polynomial;
mod poses;
mod recent;
mod renderer;
mod scenes;
mod server;
mod service;
mod several;
#[cfg(test)]
mod tests;
pub mod wire;

pub use renderer::ServerLidarModel;
pub use sensors::pictures::appearance::Quality;
pub use server::{Options, Server};
