//! Scene graphs and layouts: graphs of scenes, placement of a graph's objects by diffusion, repair, a memory of scenes.

pub mod describe;
pub mod diffuse;
pub mod facts;
pub mod graph_of;
pub mod memory;
pub mod project;

#[cfg(test)]
mod tests;
